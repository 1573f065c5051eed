//! Every constant that host and shaders share.

use super::declare::constant;

constants! {
    /// The descriptor set of what topology decides: tables. Binding numbers are unique over all sets.
    SET_TABLES = 0;
    /// The descriptor set of what positions decide: control vertices, and the points that are computed from them.
    SET_POSE = 1;
    /// The descriptor set of what a frame decides, and of what the device writes in it.
    SET_FRAME = 2;
    /// Tables, binding: one buffer a pass, of `Patch` records, then the tables of which `Bases` tells where they begin.
    BINDING_TABLES = 0;
    /// Tables, binding, uniform: `Bases`.
    BINDING_BASES = 1;
    /// Tables, binding: `PointRow` records, one a point and step.
    BINDING_POINT_ROWS = 2;
    /// Tables, binding: `PointTerm` records.
    BINDING_POINT_TERMS = 3;
    /// Pose, binding: control vertices, three floats each, in local units.
    BINDING_POSITIONS = 4;
    /// Pose, binding: what is computed from the control vertices before patches are drawn, `Point` records or the cache: where each patch's slot
    /// begins, then the control points, one vec4 each.
    BINDING_POINTS = 5;
    /// Frame, binding: the scratch ring, one vec4 a point.
    BINDING_SCRATCH = 6;
    /// Frame, binding: one allocation counter a batch, behind `COUNTER_OVERFLOWS`.
    BINDING_COUNTERS = 7;
    /// Frame, binding: `PatchDraw` records, what is decided about each patch, or, where patches are cut before they are drawn, `SubPatch` records. Where the device
    /// decides, behind those of all views the patches that are drawn in each: `DrawnBatch` records, numbers of patches, and what workgroups of patches need.
    BINDING_DRAWS = 8;
    /// Frame, binding: the number of captured vertices, then the `Captured` records; where vertices are counted, one a patch.
    BINDING_CAPTURE = 9;
    /// Frame, binding: the patch of each instance, where patterns are drawn.
    BINDING_INSTANCES = 10;
    /// Frame, binding: `View` records.
    BINDING_VIEWS = 11;
    /// Pose, binding: `Point` records of the control vertices, where they are on the surface and their normals; behind them boxes, the least and the greatest place: around all, and around as many vertices as a workgroup has. Where the device decides.
    BINDING_LIMITS = 12;
    /// How many tables a method may have of its own.
    TABLES = 8;
    /// Behind these, how many tables control points have that are cached.
    CACHED_TABLES = 3;

    /// Specialization constant: what colours mean, `SHADING_...`, in fragment shaders.
    CONSTANT_ID_SHADING = 0;
    /// Specialization constant: whether tangents are asked for, where patches are evaluated.
    CONSTANT_ID_TANGENTS = 1;
    /// Specialization constant: whether what is drawn may be sub-patches.
    CONSTANT_ID_SUB_PATCHES = 2;
    /// Specialization constant: the invocations of control shaders that share their work among them.
    CONSTANT_ID_INVOCATIONS = 3;

    /// Step of points: positions are sums of weighted control vertices.
    POINTS_BLEND = 0;
    /// Step of points: the same, and normals are perpendicular to two more such sums, the tangents.
    POINTS_LIMIT = 1;
    /// Step of points: normals are those of the ring of faces around each point.
    POINTS_RING = 2;
    /// Step of points: normals are sums of weighted normals of other points.
    POINTS_NORMALS = 3;
    /// Kind of a step: normals from tangents, where a point has none yet.
    POINTS_SPARE = 4;
    /// Kind of a step: normals from those nearby, where a point's own is none, or another.
    POINTS_NEARBY = 5;
    /// Kind of a step: normals from those nearby, unless these cancel.
    POINTS_CUSP = 6;
    /// Kind of a step: positions are sums of weighted positions of earlier points.
    POINTS_REFINE = 7;
    /// Kind of a step: positions are sums of weighted control vertices relative to the first of them, whose position stands in place of a normal.
    POINTS_HUB = 8;
    /// Row flag: the ring of faces is open, its first and last vertex belong to one face each.
    ROW_OPEN = 0x8000_0000;
    /// Row flag: tangents that are nearly parallel give no normal.
    ROW_FIRM = 0x4000_0000;
    /// Invocations of a workgroup of the shader that computes points.
    POINT_INVOCATIONS = 64;

    /// The greatest number of control points of a patch whose control shader runs stencils, and of that shader's invocations.
    CONTROL_INVOCATIONS = 32;
    /// The deepest level of a plan.
    HIGHEST_LEVEL = 10;
    /// Binary logarithm of the greatest tess level that every tessellator does (Vulkan spec, `maxTessellationGenerationLevel`).
    TESSELLATED_LEVEL = 6;
    /// What a patch is evaluated by: the inside, its four edges, its four corners.
    USES = 9;
    /// So many products of a weight and a vertex the points of a use take at most, for each word of all tables.
    PRODUCTS_A_WORD = 16;
    /// Instead of the number of a pair of tangents: there is none.
    NO_TANGENTS = 0xffff_ffff;
    /// How often a patch is halved towards an extraordinary vertex before it is taken for that: tess coordinates are whole steps of 2^-16.
    EIGEN_LEVELS = 17;
    /// Among the numbers of a patch at an extraordinary vertex: the point of that vertex' limit.
    EIGEN_LIMIT = 0;
    /// Behind it: before the point of the patch's second eigenvector.
    EIGEN_VECTORS = 1;
    /// Behind it: the same of the next face around the vertex, or `EIGEN_HOLE`.
    EIGEN_NEXT = 2;
    /// Behind it: the sixteen points around the face, number x + 4 y.
    EIGEN_GRID = 3;
    /// Instead of the next face's: it is a hole.
    EIGEN_HOLE = 0xffff_ffff;
    /// Use flag: the edge runs against the patch's own direction, which is counter-clockwise.
    USE_FLIPPED = 1;
    /// Use flag: the patch has the first half of the edge.
    USE_FIRST_HALF = 2;
    /// Use flag: the patch has the second half of the edge.
    USE_SECOND_HALF = 4;
    /// Use flag: limit position and normal of a vertex.
    USE_LIMIT = 8;
    /// Use flag: the limit has several normals there.
    USE_CREASED = 64;
    /// Use flag: by how many quarters its frame is turned against the patch's; two bits.
    USE_TURN_SHIFT = 4;
    /// Use flag: where the vertex's pair of tangents cancels, the next pair is taken.
    USE_SPARE = 128;
    /// Use flag: the vertex has no tangents for the face, only those nearby.
    USE_CUSP = 256;
    /// Use flag: the edge has no plan; it is evaluated with the points of the inside, as on its other side.
    USE_INSIDE = 512;
    /// Use flag: limit and normal are points that are computed beforehand: the use's `rows` is the number of the limit, `root` that of the normal.
    USE_HUB = 1024;
    /// Use flag: the plan of the edge has the face as in a mirror: the derivative along the edge is turned round.
    USE_REFLECTED = 2048;
    /// Among the control vertices of patches with long rings: the number behind this flag is that of a `Point` of a `POINTS_HUB` step.
    HUB_POINT = 0x8000_0000;
    /// Use flag: which side of an infinite crease an edge is seen from, or which pair of tangents.
    USE_SIDE_SHIFT = 12;
    /// Patch flag, shifted by the corner's number: of a plain patch, sums at the corner go along v first.
    PATCH_TURNED_CORNER = 128;

    /// Node kind: has four children.
    NODE_INTERNAL = 0;
    /// Node kind: a B-spline.
    NODE_REGULAR = 1;
    /// Node kind: a B-spline with mirrored control points.
    NODE_BOUNDARY = 2;
    /// Node kind: a B-spline with one semi-sharp crease.
    NODE_CREASE = 3;
    /// Node kind: levels around an extraordinary vertex.
    NODE_TERMINAL = 4;
    /// Node kind: an extraordinary vertex.
    NODE_EXTRAORDINARY = 5;
    /// Node kind: a stretch of an edge; rows 1 and 2 are its position, and that plus the derivative across.
    NODE_CURVE = 6;
    /// Node kind, of a face's edge: levels towards an extraordinary vertex at its end, a B-spline each.
    NODE_CURVE_TERMINAL = 7;
    /// In a node's kind, the number of the stencil that its points are relative to, plus 1; 0 without one. Four bits.
    NODE_BASE_SHIFT = 16;
    /// In a node's kind, the use of the corner whose vertex that stencil is relative to; 0 where it is relative to the ring's first. Four bits.
    NODE_ORIGIN_SHIFT = 20;
    /// In a job, which use a point is of; below it the row of a stencil, or a place in the patch's ring.
    JOB_USE_SHIFT = 16;
    /// In a job, which of these it is.
    JOB_KIND_SHIFT = 20;
    /// Job: a stencil.
    JOB_STENCIL = 0;
    /// Job: a vertex of the ring.
    JOB_VERTEX = 1;
    /// Job: the limit at a corner.
    JOB_LIMIT = 2;
    /// Job: the normal at a corner.
    JOB_NORMAL = 3;
    /// In its place where points are the vertices themselves.
    ORIGIN_NONE = 15;
    /// In the first word of a stencil: its sum is relative to the ring's first vertex.
    STENCIL_OWN = 0;
    /// Where it stands there, above the place of the set of weights.
    STENCIL_SHIFT = 28;
    /// In the second word of a stencil, above the place of the pattern: binary logarithm of the bits of a number, less 2.
    WIDTH_SHIFT = 30;
    /// Such a width of stencils that have no pattern: there is a weight for each vertex of the ring. Those of vertices, and of tangents near corners.
    DENSE = 3;
    /// Lists of places in a patch's ring have so many bits a place, as many places as a word holds, the first lowest. In rings of up to 32 vertices.
    PLACE_BITS = 5;
    /// The same in longer rings.
    LONG_PLACE_BITS = 16;
    /// In the first word of a stencil whose sum is relative to the vertex of corner 0; 1 to 3 more, to those of the others. These are the corners' uses.
    STENCIL_CORNER = 5;
    /// Points in a level of a terminal node: sixteen for each of three children, which follow that at the extraordinary vertex in the order x + 2 y, all around.
    TERMINAL_POINTS = 48;

    /// Patch flag, shifted by the edge's number: beyond it lie two patches, of an n-gon or a finer level: so it gets an even number of segments.
    PATCH_EVEN_EDGE = 1;
    /// Patch flag: part of an n-gon, with half the tess level of a quad.
    PATCH_HALF = 16;
    /// Patch flag: where the corner of the ptex face that is corner 0 of the patch stands; two bits.
    PATCH_TURN_SHIFT = 5;

    /// Patch flag of a triangle or a piece, shifted by the edge's number, or that of all edges and the corner's: the surface has several normals there.
    PATCH_CREASED = 0x1_0000;

    /// Patch flag: it is the mirror image of what its plan is for, with u and v exchanged.
    PATCH_MIRRORED = 0x40_0000;
    /// Patch flag: the slot is vacant. Nothing is drawn of it, until an edit gives it a patch.
    PATCH_VACANT = 0x8000_0000;
    /// Patch flag: how many vertices the ring of a patch with a plan has, 32 for more; six bits.
    PATCH_RING_SHIFT = 23;

    /// Patch flag: on all edges vertices are counted, since macro faces may lie beyond: their sides have the vertices of several edges.
    PATCH_COUNTED = 0x2000_0000;
    /// Patch flag: a macro face, of several faces. Levels are those of each of its cells.
    PATCH_MACRO = 0x4000_0000;
    /// Patch flag of a macro face: its columns less 1; five bits.
    MACRO_COLUMNS_SHIFT = 16;
    /// Patch flag of a macro face: its rows less 1; five bits.
    MACRO_ROWS_SHIFT = 21;
    /// The words that a macro face's control vertices stand behind: the slot of its first cell, one over its columns and one over its rows, both floats, and how many
    /// cells have plans. Row by row come (columns + 3) times (rows + 3) vertices, then a word a cell: how many cells with plans are before it, and its turn; and the
    /// slots of the cells with plans.
    MACRO_HEADER = 4;
    /// In a cell's word: the corner of the face's own patch that is at the cell's (0, 0); two bits.
    MACRO_TURN_SHIFT = 16;
    /// Where in a cell a vertex can be: in so many steps a cell.
    MACRO_STEPS = 0x1_0000;

    /// Patch flag: a face of the mesh refined once. All edges have half the tess level, and the neighbours' do too.
    PATCH_REFINED = 0x8000;
    /// Patch flag: which child of its ptex face a patch is; four bits. 0 is the whole face.
    PATCH_CHILD_SHIFT = 11;
    /// The child of a quad at corner 0; those at the other corners follow.
    CHILD_OF_QUAD = 1;
    /// The child of a triangle at corner 0; those at the other corners follow, then the one in the middle.
    CHILD_OF_TRIANGLE = 5;
    /// Patch flag of a piece, shifted by the corner's number: its normal there counts only if that nearby is like it.
    PATCH_NEARBY_CORNER = 128;
    /// A piece of a quad, which its `plan` tells: its column and, 12 bits higher, its row among as many as there are at its depth.
    CHILD_PIECE = 9;
    /// In a piece's `plan`: its row; its column is below.
    PIECE_ROW_SHIFT = 12;
    /// In a piece's `plan`: its edge with a crease plus 1, or 0; three bits.
    PIECE_CREASE_SHIFT = 24;
    /// In a piece's `plan`: its depth, how often the ptex face is halved.
    PIECE_DEPTH_SHIFT = 28;
    /// Flag of a `TablePlace`: the edge runs against the direction of that face.
    PLACE_FLIPPED = 0x8000_0000;
    /// Flag of a `TableFace`'s normals: the weights there are two rows a point, of the limit's tangents.
    TABLE_TANGENTS = 0x8000_0000;

    /// Frame flag: spacing is fractional-even, else equal.
    FRAME_FRACTIONAL_EVEN = 1;
    /// Frame flag: slots come from the host, or where the device decides from there, else from the batch's counter.
    FRAME_GIVEN_SLOTS = 2;
    /// Frame flag: the evaluation shader records what it produces.
    FRAME_CAPTURE = 4;
    /// Frame flag: vertices whose position has an odd number of bits are drawn elsewhere, so that cracks show.
    FRAME_PARITY = 8;
    /// Frame flag: patches have levels of their own, else all the frame's.
    FRAME_ADAPTIVE = 16;
    /// Frame flag: the evaluation shader counts the vertices of each patch: in the `patch_number` of that patch's `Captured` record.
    FRAME_COUNT = 32;
    /// Frame flag: patches have levels of their own in each view, as the device decided.
    FRAME_DECIDED = 64;
    /// Frame flag: numbers of patches are those of sub-patches, which patches are cut into before they are drawn.
    FRAME_SUB_PATCHES = 128;
    /// Frame flag: where patterns are drawn, the segments of an edge of their lattice; seven bits.
    FRAME_SEGMENTS_SHIFT = 8;
    /// Frame flag: views an instance, 1 but with multiview; six bits.
    FRAME_EYES_SHIFT = 16;

    /// Flag of a `Decision`: by the distance from the eye. `FRAME_FRACTIONAL_EVEN` and the views an instance stand there as in a frame.
    DECIDE_DISTANCE = 2;
    /// Flag of a `Decision`: by what is seen of edges.
    DECIDE_SCREEN = 4;
    /// Flag of a `Decision`: patches outside of the picture are not drawn. The culling flags also tell, in a patch's decision, why it is not.
    DECIDE_FRUSTUM = 8;
    /// Flag of a `Decision`: patches of which only the back is seen are not drawn.
    DECIDE_BACK = 16;
    /// Flag of a `Decision`: patches between samples are not drawn.
    DECIDE_SMALL = 32;
    /// Flag of a `Decision`: by how far normals turn.
    DECIDE_CURVATURE = 64;
    /// Flag of a `Decision`, for the shader that finds limits: only the box around all vertices is to be found.
    DECIDE_BOX = 128;
    /// Flag of a `Decision`: rows of samples in a pixel, and columns; four bits.
    DECIDE_ROWS_SHIFT = 8;
    /// Flag of a `Compaction`, where spacing is fractional: the same as a frame's. Windows are of points.
    COMPACT_POINTS = 2;
    /// Flag of a `Compaction`: commands begin with any instance (`drawIndirectFirstInstance`).
    COMPACT_FIRST_INSTANCE = 4;
    /// Flag of a `Compaction`: which step, two bits.
    COMPACT_STEP_SHIFT = 4;
    /// Step: what workgroups of patches need.
    COMPACT_COUNT = 0;
    /// Step: the same summed up.
    COMPACT_SUM = 1;
    /// Step: the list of what is drawn, slots, and where batches begin.
    COMPACT_LIST = 2;
    /// Step: the commands of batches.
    COMPACT_COMMANDS = 3;
    /// Flag of a `Compaction`: control points a patch; six bits. Views an instance stand there as in a frame.
    COMPACT_CONTROLS_SHIFT = 8;
    /// Words of a `DrawnBatch`.
    BATCH_WORDS = 7;
    /// Word of a `DrawnBatch`: its first patch in the list.
    BATCH_FIRST = 4;
    /// Word of a `DrawnBatch`: how many patches.
    BATCH_PATCHES = 5;
    /// Word of a `DrawnBatch`: patches an instance.
    BATCH_PER_INSTANCE = 6;
    /// Words of what a workgroup's patches need together: how many are drawn, their points, the most segments of an edge.
    NEEDS_WORDS = 3;
    /// Instead of the number of a patch: behind the last that is drawn.
    NOT_DRAWN = 0xffff_ffff;
    /// In the number of a patch's vertices that bound it: they are the control points of a bicubic B-spline.
    HULL_SPLINE = 0x8000_0000;
    /// There: it is drawn from the depth on that it lies at, see `method/depths.rs`.
    HULL_DYNAMIC = 0x4000_0000;
    /// There: it is drawn at that depth alone.
    HULL_SHALLOW = 0x2000_0000;
    /// There: it is of a macro face, and the rest is where its list stands, as for sides: how many vertices are its faces', and how many bound it; then these, its faces' first.
    HULL_LISTED = 0x1000_0000;
    /// How often is refined around what is irregular at least, by methods that go as deep as a frame needs.
    LEAST_DEPTH = 1;
    /// And at most.
    GREATEST_DEPTH = 6;
    /// In a term of a limit: the number behind this flag is that of a list of vertices, of whose sum the weight is; on the host, of a face.
    LIMIT_FACE = 0x8000_0000;
    /// Invocations of a workgroup of the shader that decides.
    DECIDE_INVOCATIONS = 64;

    /// The index of a pattern's vertex is i + (j << this), where (i, j) is its place on the pattern's lattice.
    PATTERN_SHIFT = 7;
    /// Rows of a patch's lattice that the geometry shader can make: one an invocation.
    GEOMETRY_ROWS = 32;
    /// The same where it hands on tangents.
    TANGENT_ROWS = 16;

    /// Counter: patches that found no room in the ring and were not drawn.
    COUNTER_OVERFLOWS = 0;
    /// Counter: points computed, over all batches.
    COUNTER_POINTS = 1;
    /// Counter: the first batch's allocation.
    COUNTER_BATCHES = 2;

    /// Shading: lit.
    SHADING_LIT = 0;
    /// Shading: the normal as a colour.
    SHADING_NORMAL = 1;
    /// Shading: a colour a patch.
    SHADING_PATCH = 2;
    /// Shading: a colour a node kind, as in the figures of Brainerd et al. 2016.
    SHADING_NODE = 3;
    /// Shading: the valence of the nearest corner.
    SHADING_VALENCE = 4;
    /// Shading: one dark colour, for lines.
    SHADING_LINES = 5;
    /// Shading: the tess level of the patch, of an edge near it.
    SHADING_LEVEL = 6;
    /// Shading: squares of texture coordinates, eight a unit.
    SHADING_CHECKER = 7;
    /// Shading: how deep in the quadtree a point was evaluated.
    SHADING_DEPTH = 8;
    /// Shading: the height of the displacement.
    SHADING_HEIGHT = 9;
}
