// Generated from src/abi.rs; do not edit. HULLFORM_UPDATE=1 cargo test --test abi writes it anew.
#ifndef ABI_GLSL
#define ABI_GLSL

// The first of our three descriptor sets; an engine that has them elsewhere compiles its own shaders with another.
#ifndef HULLFORM_SET
#define HULLFORM_SET 0
#endif

// The descriptor set of what topology decides: tables. Binding numbers are unique over all sets.
const uint SET_TABLES = HULLFORM_SET + 0u;
// The descriptor set of what positions decide: control vertices, and the points that are computed from them.
const uint SET_POSE = HULLFORM_SET + 1u;
// The descriptor set of what a frame decides, and of what the device writes in it.
const uint SET_FRAME = HULLFORM_SET + 2u;
// Tables, binding: one buffer a pass, of `Patch` records, then the tables of which `Bases` tells where they begin.
const uint BINDING_TABLES = 0u;
// Tables, binding, uniform: `Bases`.
const uint BINDING_BASES = 1u;
// Tables, binding: `PointRow` records, one a point and step.
const uint BINDING_POINT_ROWS = 2u;
// Tables, binding: `PointTerm` records.
const uint BINDING_POINT_TERMS = 3u;
// Pose, binding: control vertices, three floats each, in local units.
const uint BINDING_POSITIONS = 4u;
// Pose, binding: what is computed from the control vertices before patches are drawn, `Point` records or the cache: where each patch's slot
// begins, then the control points, one vec4 each.
const uint BINDING_POINTS = 5u;
// Frame, binding: the scratch ring, one vec4 a point.
const uint BINDING_SCRATCH = 6u;
// Frame, binding: one allocation counter a batch, behind `COUNTER_OVERFLOWS`.
const uint BINDING_COUNTERS = 7u;
// Frame, binding: `PatchDraw` records, what is decided about each patch, or, where patches are cut before they are drawn, `SubPatch` records. Where the device
// decides, behind those of all views the patches that are drawn in each: `DrawnBatch` records, numbers of patches, and what workgroups of patches need.
const uint BINDING_DRAWS = 8u;
// Frame, binding: the number of captured vertices, then the `Captured` records; where vertices are counted, one a patch.
const uint BINDING_CAPTURE = 9u;
// Frame, binding: the patch of each instance, where patterns are drawn.
const uint BINDING_INSTANCES = 10u;
// Frame, binding: `View` records.
const uint BINDING_VIEWS = 11u;
// Pose, binding: `Point` records of the control vertices, where they are on the surface and their normals; behind them boxes, the least and the greatest place: around all, and around as many vertices as a workgroup has. Where the device decides.
const uint BINDING_LIMITS = 12u;
// How many tables a method may have of its own.
const uint TABLES = 8u;
// Behind these, how many tables control points have that are cached.
const uint CACHED_TABLES = 3u;
// Specialization constant: what colours mean, `SHADING_...`, in fragment shaders.
const uint CONSTANT_ID_SHADING = 0u;
// Specialization constant: whether tangents are asked for, where patches are evaluated.
const uint CONSTANT_ID_TANGENTS = 1u;
// Specialization constant: whether what is drawn may be sub-patches.
const uint CONSTANT_ID_SUB_PATCHES = 2u;
// Specialization constant: the invocations of control shaders that share their work among them.
const uint CONSTANT_ID_INVOCATIONS = 3u;
// Step of points: positions are sums of weighted control vertices.
const uint POINTS_BLEND = 0u;
// Step of points: the same, and normals are perpendicular to two more such sums, the tangents.
const uint POINTS_LIMIT = 1u;
// Step of points: normals are those of the ring of faces around each point.
const uint POINTS_RING = 2u;
// Step of points: normals are sums of weighted normals of other points.
const uint POINTS_NORMALS = 3u;
// Kind of a step: normals from tangents, where a point has none yet.
const uint POINTS_SPARE = 4u;
// Kind of a step: normals from those nearby, where a point's own is none, or another.
const uint POINTS_NEARBY = 5u;
// Kind of a step: normals from those nearby, unless these cancel.
const uint POINTS_CUSP = 6u;
// Kind of a step: positions are sums of weighted positions of earlier points.
const uint POINTS_REFINE = 7u;
// Kind of a step: positions are sums of weighted control vertices relative to the first of them, whose position stands in place of a normal.
const uint POINTS_HUB = 8u;
// Row flag: the ring of faces is open, its first and last vertex belong to one face each.
const uint ROW_OPEN = 2147483648u;
// Row flag: tangents that are nearly parallel give no normal.
const uint ROW_FIRM = 1073741824u;
// Invocations of a workgroup of the shader that computes points.
const uint POINT_INVOCATIONS = 64u;
// The greatest number of control points of a patch whose control shader runs stencils, and of that shader's invocations.
const uint CONTROL_INVOCATIONS = 32u;
// The deepest level of a plan.
const uint HIGHEST_LEVEL = 10u;
// Binary logarithm of the greatest tess level that every tessellator does (Vulkan spec, `maxTessellationGenerationLevel`).
const uint TESSELLATED_LEVEL = 6u;
// What a patch is evaluated by: the inside, its four edges, its four corners.
const uint USES = 9u;
// So many products of a weight and a vertex the points of a use take at most, for each word of all tables.
const uint PRODUCTS_A_WORD = 16u;
// Instead of the number of a pair of tangents: there is none.
const uint NO_TANGENTS = 4294967295u;
// How often a patch is halved towards an extraordinary vertex before it is taken for that: tess coordinates are whole steps of 2^-16.
const uint EIGEN_LEVELS = 17u;
// Among the numbers of a patch at an extraordinary vertex: the point of that vertex' limit.
const uint EIGEN_LIMIT = 0u;
// Behind it: before the point of the patch's second eigenvector.
const uint EIGEN_VECTORS = 1u;
// Behind it: the same of the next face around the vertex, or `EIGEN_HOLE`.
const uint EIGEN_NEXT = 2u;
// Behind it: the sixteen points around the face, number x + 4 y.
const uint EIGEN_GRID = 3u;
// Instead of the next face's: it is a hole.
const uint EIGEN_HOLE = 4294967295u;
// Use flag: the edge runs against the patch's own direction, which is counter-clockwise.
const uint USE_FLIPPED = 1u;
// Use flag: the patch has the first half of the edge.
const uint USE_FIRST_HALF = 2u;
// Use flag: the patch has the second half of the edge.
const uint USE_SECOND_HALF = 4u;
// Use flag: limit position and normal of a vertex.
const uint USE_LIMIT = 8u;
// Use flag: the limit has several normals there.
const uint USE_CREASED = 64u;
// Use flag: by how many quarters its frame is turned against the patch's; two bits.
const uint USE_TURN_SHIFT = 4u;
// Use flag: where the vertex's pair of tangents cancels, the next pair is taken.
const uint USE_SPARE = 128u;
// Use flag: the vertex has no tangents for the face, only those nearby.
const uint USE_CUSP = 256u;
// Use flag: the edge has no plan; it is evaluated with the points of the inside, as on its other side.
const uint USE_INSIDE = 512u;
// Use flag: limit and normal are points that are computed beforehand: the use's `rows` is the number of the limit, `root` that of the normal.
const uint USE_HUB = 1024u;
// Use flag: the plan of the edge has the face as in a mirror: the derivative along the edge is turned round.
const uint USE_REFLECTED = 2048u;
// Among the control vertices of patches with long rings: the number behind this flag is that of a `Point` of a `POINTS_HUB` step.
const uint HUB_POINT = 2147483648u;
// Use flag: which side of an infinite crease an edge is seen from, or which pair of tangents.
const uint USE_SIDE_SHIFT = 12u;
// Patch flag, shifted by the corner's number: of a plain patch, sums at the corner go along v first.
const uint PATCH_TURNED_CORNER = 128u;
// Node kind: has four children.
const uint NODE_INTERNAL = 0u;
// Node kind: a B-spline.
const uint NODE_REGULAR = 1u;
// Node kind: a B-spline with mirrored control points.
const uint NODE_BOUNDARY = 2u;
// Node kind: a B-spline with one semi-sharp crease.
const uint NODE_CREASE = 3u;
// Node kind: levels around an extraordinary vertex.
const uint NODE_TERMINAL = 4u;
// Node kind: an extraordinary vertex.
const uint NODE_EXTRAORDINARY = 5u;
// Node kind: a stretch of an edge; rows 1 and 2 are its position, and that plus the derivative across.
const uint NODE_CURVE = 6u;
// Node kind, of a face's edge: levels towards an extraordinary vertex at its end, a B-spline each.
const uint NODE_CURVE_TERMINAL = 7u;
// In a node's kind, the number of the stencil that its points are relative to, plus 1; 0 without one. Four bits.
const uint NODE_BASE_SHIFT = 16u;
// In a node's kind, the use of the corner whose vertex that stencil is relative to; 0 where it is relative to the ring's first. Four bits.
const uint NODE_ORIGIN_SHIFT = 20u;
// In a job, which use a point is of; below it the row of a stencil, or a place in the patch's ring.
const uint JOB_USE_SHIFT = 16u;
// In a job, which of these it is.
const uint JOB_KIND_SHIFT = 20u;
// Job: a stencil.
const uint JOB_STENCIL = 0u;
// Job: a vertex of the ring.
const uint JOB_VERTEX = 1u;
// Job: the limit at a corner.
const uint JOB_LIMIT = 2u;
// Job: the normal at a corner.
const uint JOB_NORMAL = 3u;
// In its place where points are the vertices themselves.
const uint ORIGIN_NONE = 15u;
// In the first word of a stencil: its sum is relative to the ring's first vertex.
const uint STENCIL_OWN = 0u;
// Where it stands there, above the place of the set of weights.
const uint STENCIL_SHIFT = 28u;
// In the second word of a stencil, above the place of the pattern: binary logarithm of the bits of a number, less 2.
const uint WIDTH_SHIFT = 30u;
// Such a width of stencils that have no pattern: there is a weight for each vertex of the ring. Those of vertices, and of tangents near corners.
const uint DENSE = 3u;
// Lists of places in a patch's ring have so many bits a place, as many places as a word holds, the first lowest. In rings of up to 32 vertices.
const uint PLACE_BITS = 5u;
// The same in longer rings.
const uint LONG_PLACE_BITS = 16u;
// In the first word of a stencil whose sum is relative to the vertex of corner 0; 1 to 3 more, to those of the others. These are the corners' uses.
const uint STENCIL_CORNER = 5u;
// Points in a level of a terminal node: sixteen for each of three children, which follow that at the extraordinary vertex in the order x + 2 y, all around.
const uint TERMINAL_POINTS = 48u;
// Patch flag, shifted by the edge's number: beyond it lie two patches, of an n-gon or a finer level: so it gets an even number of segments.
const uint PATCH_EVEN_EDGE = 1u;
// Patch flag: part of an n-gon, with half the tess level of a quad.
const uint PATCH_HALF = 16u;
// Patch flag: where the corner of the ptex face that is corner 0 of the patch stands; two bits.
const uint PATCH_TURN_SHIFT = 5u;
// Patch flag of a triangle or a piece, shifted by the edge's number, or that of all edges and the corner's: the surface has several normals there.
const uint PATCH_CREASED = 65536u;
// Patch flag: it is the mirror image of what its plan is for, with u and v exchanged.
const uint PATCH_MIRRORED = 4194304u;
// Patch flag: the slot is vacant. Nothing is drawn of it, until an edit gives it a patch.
const uint PATCH_VACANT = 2147483648u;
// Patch flag: how many vertices the ring of a patch with a plan has, 32 for more; six bits.
const uint PATCH_RING_SHIFT = 23u;
// Patch flag: on all edges vertices are counted, since macro faces may lie beyond: their sides have the vertices of several edges.
const uint PATCH_COUNTED = 536870912u;
// Patch flag: a macro face, of several faces. Levels are those of each of its cells.
const uint PATCH_MACRO = 1073741824u;
// Patch flag of a macro face: its columns less 1; five bits.
const uint MACRO_COLUMNS_SHIFT = 16u;
// Patch flag of a macro face: its rows less 1; five bits.
const uint MACRO_ROWS_SHIFT = 21u;
// The words that a macro face's control vertices stand behind: the slot of its first cell, one over its columns and one over its rows, both floats, and how many
// cells have plans. Row by row come (columns + 3) times (rows + 3) vertices, then a word a cell: how many cells with plans are before it, and its turn; and the
// slots of the cells with plans.
const uint MACRO_HEADER = 4u;
// In a cell's word: the corner of the face's own patch that is at the cell's (0, 0); two bits.
const uint MACRO_TURN_SHIFT = 16u;
// Where in a cell a vertex can be: in so many steps a cell.
const uint MACRO_STEPS = 65536u;
// Patch flag: a face of the mesh refined once. All edges have half the tess level, and the neighbours' do too.
const uint PATCH_REFINED = 32768u;
// Patch flag: which child of its ptex face a patch is; four bits. 0 is the whole face.
const uint PATCH_CHILD_SHIFT = 11u;
// The child of a quad at corner 0; those at the other corners follow.
const uint CHILD_OF_QUAD = 1u;
// The child of a triangle at corner 0; those at the other corners follow, then the one in the middle.
const uint CHILD_OF_TRIANGLE = 5u;
// Patch flag of a piece, shifted by the corner's number: its normal there counts only if that nearby is like it.
const uint PATCH_NEARBY_CORNER = 128u;
// A piece of a quad, which its `plan` tells: its column and, 12 bits higher, its row among as many as there are at its depth.
const uint CHILD_PIECE = 9u;
// In a piece's `plan`: its row; its column is below.
const uint PIECE_ROW_SHIFT = 12u;
// In a piece's `plan`: its edge with a crease plus 1, or 0; three bits.
const uint PIECE_CREASE_SHIFT = 24u;
// In a piece's `plan`: its depth, how often the ptex face is halved.
const uint PIECE_DEPTH_SHIFT = 28u;
// Flag of a `TablePlace`: the edge runs against the direction of that face.
const uint PLACE_FLIPPED = 2147483648u;
// Flag of a `TableFace`'s normals: the weights there are two rows a point, of the limit's tangents.
const uint TABLE_TANGENTS = 2147483648u;
// Frame flag: spacing is fractional-even, else equal.
const uint FRAME_FRACTIONAL_EVEN = 1u;
// Frame flag: slots come from the host, or where the device decides from there, else from the batch's counter.
const uint FRAME_GIVEN_SLOTS = 2u;
// Frame flag: the evaluation shader records what it produces.
const uint FRAME_CAPTURE = 4u;
// Frame flag: vertices whose position has an odd number of bits are drawn elsewhere, so that cracks show.
const uint FRAME_PARITY = 8u;
// Frame flag: patches have levels of their own, else all the frame's.
const uint FRAME_ADAPTIVE = 16u;
// Frame flag: the evaluation shader counts the vertices of each patch: in the `patch_number` of that patch's `Captured` record.
const uint FRAME_COUNT = 32u;
// Frame flag: patches have levels of their own in each view, as the device decided.
const uint FRAME_DECIDED = 64u;
// Frame flag: numbers of patches are those of sub-patches, which patches are cut into before they are drawn.
const uint FRAME_SUB_PATCHES = 128u;
// Frame flag: where patterns are drawn, the segments of an edge of their lattice; seven bits.
const uint FRAME_SEGMENTS_SHIFT = 8u;
// Frame flag: views an instance, 1 but with multiview; six bits.
const uint FRAME_EYES_SHIFT = 16u;
// Flag of a `Decision`: by the distance from the eye. `FRAME_FRACTIONAL_EVEN` and the views an instance stand there as in a frame.
const uint DECIDE_DISTANCE = 2u;
// Flag of a `Decision`: by what is seen of edges.
const uint DECIDE_SCREEN = 4u;
// Flag of a `Decision`: patches outside of the picture are not drawn. The culling flags also tell, in a patch's decision, why it is not.
const uint DECIDE_FRUSTUM = 8u;
// Flag of a `Decision`: patches of which only the back is seen are not drawn.
const uint DECIDE_BACK = 16u;
// Flag of a `Decision`: patches between samples are not drawn.
const uint DECIDE_SMALL = 32u;
// Flag of a `Decision`: by how far normals turn.
const uint DECIDE_CURVATURE = 64u;
// Flag of a `Decision`, for the shader that finds limits: only the box around all vertices is to be found.
const uint DECIDE_BOX = 128u;
// Flag of a `Decision`: rows of samples in a pixel, and columns; four bits.
const uint DECIDE_ROWS_SHIFT = 8u;
// Flag of a `Compaction`, where spacing is fractional: the same as a frame's. Windows are of points.
const uint COMPACT_POINTS = 2u;
// Flag of a `Compaction`: commands begin with any instance (`drawIndirectFirstInstance`).
const uint COMPACT_FIRST_INSTANCE = 4u;
// Flag of a `Compaction`: which step, two bits.
const uint COMPACT_STEP_SHIFT = 4u;
// Step: what workgroups of patches need.
const uint COMPACT_COUNT = 0u;
// Step: the same summed up.
const uint COMPACT_SUM = 1u;
// Step: the list of what is drawn, slots, and where batches begin.
const uint COMPACT_LIST = 2u;
// Step: the commands of batches.
const uint COMPACT_COMMANDS = 3u;
// Flag of a `Compaction`: control points a patch; six bits. Views an instance stand there as in a frame.
const uint COMPACT_CONTROLS_SHIFT = 8u;
// Words of a `DrawnBatch`.
const uint BATCH_WORDS = 7u;
// Word of a `DrawnBatch`: its first patch in the list.
const uint BATCH_FIRST = 4u;
// Word of a `DrawnBatch`: how many patches.
const uint BATCH_PATCHES = 5u;
// Word of a `DrawnBatch`: patches an instance.
const uint BATCH_PER_INSTANCE = 6u;
// Words of what a workgroup's patches need together: how many are drawn, their points, the most segments of an edge.
const uint NEEDS_WORDS = 3u;
// Instead of the number of a patch: behind the last that is drawn.
const uint NOT_DRAWN = 4294967295u;
// In the number of a patch's vertices that bound it: they are the control points of a bicubic B-spline.
const uint HULL_SPLINE = 2147483648u;
// There: it is drawn from the depth on that it lies at, see `method/depths.rs`.
const uint HULL_DYNAMIC = 1073741824u;
// There: it is drawn at that depth alone.
const uint HULL_SHALLOW = 536870912u;
// There: it is of a macro face, and the rest is where its list stands, as for sides: how many vertices are its faces', and how many bound it; then these, its faces' first.
const uint HULL_LISTED = 268435456u;
// How often is refined around what is irregular at least, by methods that go as deep as a frame needs.
const uint LEAST_DEPTH = 1u;
// And at most.
const uint GREATEST_DEPTH = 6u;
// In a term of a limit: the number behind this flag is that of a list of vertices, of whose sum the weight is; on the host, of a face.
const uint LIMIT_FACE = 2147483648u;
// Invocations of a workgroup of the shader that decides.
const uint DECIDE_INVOCATIONS = 64u;
// The index of a pattern's vertex is i + (j << this), where (i, j) is its place on the pattern's lattice.
const uint PATTERN_SHIFT = 7u;
// Rows of a patch's lattice that the geometry shader can make: one an invocation.
const uint GEOMETRY_ROWS = 32u;
// The same where it hands on tangents.
const uint TANGENT_ROWS = 16u;
// Counter: patches that found no room in the ring and were not drawn.
const uint COUNTER_OVERFLOWS = 0u;
// Counter: points computed, over all batches.
const uint COUNTER_POINTS = 1u;
// Counter: the first batch's allocation.
const uint COUNTER_BATCHES = 2u;
// Shading: lit.
const uint SHADING_LIT = 0u;
// Shading: the normal as a colour.
const uint SHADING_NORMAL = 1u;
// Shading: a colour a patch.
const uint SHADING_PATCH = 2u;
// Shading: a colour a node kind, as in the figures of Brainerd et al. 2016.
const uint SHADING_NODE = 3u;
// Shading: the valence of the nearest corner.
const uint SHADING_VALENCE = 4u;
// Shading: one dark colour, for lines.
const uint SHADING_LINES = 5u;
// Shading: the tess level of the patch, of an edge near it.
const uint SHADING_LEVEL = 6u;
// Shading: squares of texture coordinates, eight a unit.
const uint SHADING_CHECKER = 7u;
// Shading: how deep in the quadtree a point was evaluated.
const uint SHADING_DEPTH = 8u;
// Shading: the height of the displacement.
const uint SHADING_HEIGHT = 9u;

// What is decided about a patch before it is drawn.
struct PatchDraw {
    // Where its slot in the scratch ring begins, when the host gives slots or the device decides; then, of a patch that is not drawn, the `DECIDE_...` flag that
    // says why, or 0.
    uint slot;
    // Levels of its edges from corner i to corner i + 1, when it has levels of its own.
    vec4 edges;
    // The level of its inside.
    float inside;
};

// A patch, or a piece of one, that is drawn by itself where a list has patches with more segments than a tessellator makes.
struct SubPatch {
    // The patch.
    uint patch_number;
    // Which piece: its column and, 12 bits higher, its row among as many as there are at its depth, and the depth, `PIECE_DEPTH_SHIFT`. 0 for the whole.
    uint piece;
    // Where its slot in the scratch ring begins, when the host gives slots.
    uint slot;
    // Levels of the whole patch's edges from corner i to corner i + 1.
    vec4 edges;
    // The level of the whole patch's inside: of pieces a whole number for each; 0 where nothing is drawn.
    float inside;
};

// A patch: a triangle, a quad, or the part of an n-gon at one of its corners.
struct Patch {
    // Its ptex face.
    uint ptex;
    // `PATCH_...` flags.
    uint flags;
    // Where its control vertices begin.
    uint controls;
    // Its border, or whatever the method keeps for it.
    uint plan;
    // The valences of its corners, a byte each, 255 for more; triangles have none at corner 3.
    uint valences;
};

// What a patch is evaluated by: numbers of `Use` records, number 0 inside, 1..=4 on its edges, 5..=8 at its corners.
struct Border {
    // These.
    uint uses[9];
    // Where the places of those vertices of the 1-ring stand that are evaluated themselves.
    uint plain;
    // How many these are.
    uint plain_count;
    // Its `Ends` record.
    uint ends;
};

// What a patch is evaluated by at some place.
struct Use {
    // How many vertices the plan's ring has; 0 where there is no plan.
    uint size;
    // Where the plan's stencils begin, two words each: where the set of weights begins and `STENCIL_...` << 28; and where the pattern begins, which
    // has the number of a weight for each vertex of the ring, counted in units of four bits, and the width of a number << 30.
    uint rows;
    // The node that walks begin with. Of a corner with a plan, the number, among the stencils of the inside, of the first of two tangents near it;
    // or `NO_TANGENTS`. With `USE_HUB` both are numbers of points.
    uint root;
    // Where in the list of control vertices the places of the plan's ring in the patch's stand, the corner's first. Of the inside, whose ring is the patch's, they
    // stand behind that, in the order in which stencils are summed.
    uint ring;
    // `USE_...` flags.
    uint flags;
};

// Where in a patch's slot the points of each use end. The slot ends where the last do.
struct Ends {
    // At level 0..=10, nine numbers, two 16-bit halves a word, the lower first.
    uint levels[11][5];
};

// By what a patch's levels are decided.
struct PatchSides {
    // Where, in a list of lists, the control vertices of the side stand to which each of its edges belongs, behind their number: two of an edge of the mesh;
    // all of a face for what lies within it.
    uint sides[4];
    // So many of its control vertices, the first, have the surface in their convex hull, and `HULL_...` flags; 0 where none are known to.
    uint hull;
    // Where among these lists stands how many points it needs in the ring at levels 0..=10.
    uint needs;
};

// What is decided of all patches in each of some views; push constants.
struct Decision {
    // The first view that is decided for.
    uint view;
    // The first view that is decided by, another where a frozen one is looked at.
    uint seen;
    // `DECIDE_...` flags.
    uint flags;
    // By distance: up to where the level is full, in local units. By what is seen: pixels of a segment. By curvature: radians of a segment.
    float measure;
    // The greatest level.
    float level;
    // The picture in pixels.
    vec2 size;
    // How many control vertices there are.
    uint vertices;
};

// What is made of decisions: the patches that are drawn, in batches by what they need; push constants.
struct Compaction {
    // `COMPACT_...` flags.
    uint flags;
    // The first view.
    uint view;
    // Behind the `PatchDraw` records of all views, counted in words, where the `DrawnBatch` records of view 0 stand; other views follow.
    uint batches;
    // Where the numbers of the patches that are drawn in view 0 stand.
    uint list;
    // How many batches are recorded; no view needs more.
    uint count;
    // How many points of the ring patches begin in that are drawn by one batch, or else how many these are.
    uint window;
    // Points of each slot, where windows are of patches.
    uint points;
    // Tessellated vertices an instance, on drivers that bound them; else 0.
    uint instance_vertices;
};

// What a batch draws in a view. It begins with what `vkCmdDrawIndirect` reads (`VkDrawIndirectCommand`).
struct DrawnBatch {
    // Vertices an instance.
    uint vertices;
    // Instances; none where nothing is drawn.
    uint instances;
    // 0.
    uint first_vertex;
    // Which views the instances belong to: those of each follow upon its number times the patches of the pass.
    uint first_instance;
    // Its first patch, in the list of those that are drawn.
    uint first;
    // How many patches.
    uint patches;
    // How many an instance; the last may have fewer.
    uint per_instance;
};

// A point that is computed from control vertices.
struct Point {
    // Position in local units.
    vec3 position;
    // Unit normal, or zero; of `POINTS_HUB`, what the position is relative to.
    vec3 normal;
};

// What a point is computed from in a step.
struct PointRow {
    // Its first term.
    uint first;
    // How many terms, and `ROW_...` flags.
    uint count;
};

// A term of a sum: a control vertex or point, and its weights. Of a ring the first term is the point itself, the others the far ends of
// its edges, counter-clockwise; their weights do not count.
struct PointTerm {
    // Control vertex or point.
    uint source;
    // Weight in the position, or normal.
    float position;
    // Weight in the first tangent.
    float du;
    // Weight in the second tangent.
    float dv;
};

// A step of computing points; push constants.
struct PointStep {
    // `POINTS_...`
    uint kind;
    // Its first row.
    uint first_row;
    // The point that the first row computes; row i computes the ith after it.
    uint first_point;
    // How many points.
    uint count;
};

// A face whose limit is a table of weights: what is summed, and with which weights.
struct TableFace {
    // Where the numbers of its points begin.
    uint controls;
    // How many points, and weights a row.
    uint count;
    // Where its weights begin.
    uint weights;
    // Corners of the face, 3 or 4.
    uint corners;
    // Segments of an edge: a power of two.
    uint segments;
    // The face, with the same lattice, whose points and weights give normals: itself where they are those of positions. With
    // `TABLE_TANGENTS`, which give the limit's own.
    uint normals;
};

// Where an edge or a vertex is evaluated: on a face that all who share it agree upon.
struct TablePlace {
    // The face, by its number in the table.
    uint face;
    // The face's own edge or corner, and `PLACE_FLIPPED`.
    uint side;
};

// The eigenbasis of a valence (Stam 1998), where its floats begin.
struct Eigenbasis {
    // How many eigenvectors there are: twice the valence and eight.
    uint count;
    // Of each of the three pieces of a patch, for each vector the sixteen control points of a B-spline.
    uint coefficients;
    // Of each of the `EIGEN_LEVELS`, each eigenvalue to its power.
    uint powers;
};

// A node of a quadtree.
struct Node {
    // `NODE_...`, then the corner or edge << 4, then the number of levels << 8, and what the points are relative to.
    uint kind;
    // Internal: the first child. Otherwise where its points begin, counted in 16-bit halves.
    uint points;
    // What is left of the sharpness of a crease.
    float sharpness;
};

// Where the tables of a pass begin in its buffer, each in elements of its own; patches begin at 0.
struct Bases {
    // The numbers of the control vertices of each patch.
    uint controls;
    // Texture coordinates, four a patch.
    uint texture;
    // The method's own tables; of control points that are cached, behind eight of these, where the places of each patch's points begin, these places,
    // and the jobs that compute points; behind these, where the device decides, `PatchSides`, the lists that these point into, and of the first pass what the limits and normals of vertices are made of.
    uint own[14];
    // How many patches there are.
    uint patches;
};

// What a surface is seen with.
struct View {
    // From local units to clip space.
    mat4 clip_from_model;
    // The eye in local units.
    vec3 eye;
    // To the picture's right: a unit vector, or zero where the view has none.
    vec3 right;
    // Out of the picture towards who looks, likewise.
    vec3 back;
    // Displacement along the normal: its height, and its waves per unit of length. No height, no displacement.
    vec2 displacement;
};

// What changes from draw to draw; push constants.
struct Frame {
    // The tess level of a quad, 1..=64; up to 1024 where patches are cut into pieces.
    float level;
    // `FRAME_...` flags.
    uint flags;
    // The first patch of the draw; where patterns are drawn, the first entry of the table of instances; where the device decides, the word at which the batch's
    // `DrawnBatch` of view 0 stands.
    uint first_patch;
    // The patch behind the last of the draw.
    uint end_patch;
    // Patches an instance of the draw; one where patterns are drawn; where the device decides, words from a view's batches to the next view's.
    uint patches_per_instance;
    // The batch's counter; where the device decides, the word at which the list of patches that are drawn in view 0 stands.
    uint counter;
    // Instances of the draw that one view has, or may have: those of a view come in a row.
    uint instances;
    // The first view.
    uint view;
};

// A vertex as an evaluation shader produced it.
struct Captured {
    // The patch.
    uint patch_number;
    // Where in the patch's own domain.
    vec2 uv;
    // Position in local units.
    vec3 position;
    // Unit normal.
    vec3 normal;
};

#endif
