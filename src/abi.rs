//! Every constant and struct that host and shaders share, declared once.
//!
//! `glsl/abi.glsl` is generated from here ([`glsl`]); a test holds the committed file to it, another holds the members' offsets in the
//! compiled SPIR-V to those of the Rust structs. All blocks have scalar layout (`VK_EXT_scalar_block_layout`, core in Vulkan 1.2).

#[macro_use]
mod declare;

use bytemuck::{Pod, Zeroable};

use declare::{Shared, constant};

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
    /// Frame, binding: `PatchDraw` records, what the host decides about each patch.
    BINDING_DRAWS = 8;
    /// Frame, binding: the number of captured vertices, then the `Captured` records; where vertices are counted, one a patch.
    BINDING_CAPTURE = 9;
    /// Frame, binding: the patch of each instance, where patterns are drawn.
    BINDING_INSTANCES = 10;
    /// Frame, binding: `View` records.
    BINDING_VIEWS = 11;
    /// How many tables a method may have of its own.
    TABLES = 8;
    /// Behind these, how many tables control points have that are cached.
    CACHED_TABLES = 3;

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
    /// Row flag: the ring of faces is open, its first and last vertex belong to one face each.
    ROW_OPEN = 0x8000_0000;
    /// Row flag: tangents that are nearly parallel give no normal.
    ROW_FIRM = 0x4000_0000;
    /// Invocations of a workgroup of the shader that computes points.
    POINT_INVOCATIONS = 64;

    /// Invocations of a control shader that runs stencils; also its greatest number of control points.
    CONTROL_INVOCATIONS = 32;
    /// The deepest level of a plan.
    HIGHEST_LEVEL = 10;
    /// What a patch is evaluated by: the inside, its four edges, its four corners.
    USES = 9;
    /// So many products of a weight and a vertex the points of a use take at most, for each word of all tables.
    PRODUCTS_A_WORD = 16;
    /// Instead of the number of a pair of tangents: there is none.
    NO_TANGENTS = 0xffff_ffff;
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
    /// Use flag: which side of an infinite crease an edge is seen from, or which pair of tangents.
    USE_SIDE_SHIFT = 10;
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
    /// Points in a level of a terminal node: sixteen for each of its children x + 2 y.
    TERMINAL_POINTS = 64;

    /// Patch flag, shifted by the edge's number: an n-gon lies beyond the edge, which therefore gets an even number of segments.
    PATCH_EVEN_EDGE = 1;
    /// Patch flag: part of an n-gon, with half the tess level of a quad.
    PATCH_HALF = 16;
    /// Patch flag: where the corner of the ptex face that is corner 0 of the patch stands; two bits.
    PATCH_TURN_SHIFT = 5;

    /// Patch flag of a triangle, shifted by the edge's number, or 3 and the corner's: the surface has several normals there.
    PATCH_CREASED = 0x1_0000;

    /// Patch flag: it is the mirror image of what its plan is for, with u and v exchanged.
    PATCH_MIRRORED = 0x40_0000;
    /// Patch flag: the slot is vacant. Nothing is drawn of it, until an edit gives it a patch.
    PATCH_VACANT = 0x8000_0000;
    /// Patch flag: how many vertices the ring of a patch with a plan has, 32 for more; six bits.
    PATCH_RING_SHIFT = 23;

    /// Patch flag: a face of the mesh refined once. All edges have half the tess level, and the neighbours' do too.
    PATCH_REFINED = 0x8000;
    /// Patch flag: which child of its ptex face a patch is; four bits. 0 is the whole face.
    PATCH_CHILD_SHIFT = 11;
    /// The child of a quad at corner 0; those at the other corners follow.
    CHILD_OF_QUAD = 1;
    /// The child of a triangle at corner 0; those at the other corners follow, then the one in the middle.
    CHILD_OF_TRIANGLE = 5;
    /// Flag of a `TablePlace`: the edge runs against the direction of that face.
    PLACE_FLIPPED = 0x8000_0000;
    /// Flag of a `TableFace`'s normals: the weights there are two rows a point, of the limit's tangents.
    TABLE_TANGENTS = 0x8000_0000;

    /// Frame flag: spacing is fractional-even, else equal.
    FRAME_FRACTIONAL_EVEN = 1;
    /// Frame flag: slots come from the host, else from the batch's counter.
    FRAME_HOST_SLOTS = 2;
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
    /// Flag of a `Decision`: rows of samples in a pixel, and columns; four bits.
    DECIDE_ROWS_SHIFT = 8;
    /// In the number of a patch's vertices that bound it: they are the control points of a bicubic B-spline.
    HULL_SPLINE = 0x8000_0000;
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

structs! {
    /// What is decided about a patch before it is drawn.
    PatchDraw {
        /// Where its slot in the scratch ring begins, when the host gives slots. Where the device decides, the `DECIDE_...` flag by which it is not drawn,
        /// or 0.
        slot: u32,
        /// Levels of its edges from corner i to corner i + 1, when it has levels of its own.
        edges: [f32; 4],
        /// The level of its inside.
        inside: f32,
    }

    /// A patch: a triangle, a quad, or the part of an n-gon at one of its corners.
    Patch {
        /// Its ptex face.
        ptex: u32,
        /// `PATCH_...` flags.
        flags: u32,
        /// Where its control vertices begin.
        controls: u32,
        /// Its border, or whatever the method keeps for it.
        plan: u32,
        /// The valences of its corners, a byte each, 255 for more; triangles have none at corner 3.
        valences: u32,
    }

    /// What a patch is evaluated by: numbers of `Use` records, number 0 inside, 1..=4 on its edges, 5..=8 at its corners.
    Border {
        /// These.
        uses: [u32; 9],
        /// Where the places of those vertices of the 1-ring stand that are evaluated themselves.
        plain: u32,
        /// How many these are.
        plain_count: u32,
        /// Its `Ends` record.
        ends: u32,
    }

    /// What a patch is evaluated by at some place.
    Use {
        /// How many vertices the plan's ring has; 0 where there is no plan.
        size: u32,
        /// Where the plan's stencils begin, two words each: where the set of weights begins and `STENCIL_...` << 28; and where the pattern begins, which
        /// has the number of a weight for each vertex of the ring, counted in units of four bits, and the width of a number << 30.
        rows: u32,
        /// The node that walks begin with. Of a corner with a plan, the number, among the stencils of the inside, of the first of two tangents near it;
        /// or `NO_TANGENTS`.
        root: u32,
        /// Where in the list of control vertices the places of the plan's ring in the patch's stand, the corner's first. Of the inside, whose ring is the patch's, they
        /// stand behind that, in the order in which stencils are summed.
        ring: u32,
        /// `USE_...` flags.
        flags: u32,
    }

    /// Where in a patch's slot the points of each use end. The slot ends where the last do.
    Ends {
        /// At level 0..=10, nine numbers, two 16-bit halves a word, the lower first.
        levels: [[u32; 5]; 11],
    }

    /// By what a patch's levels are decided.
    PatchSides {
        /// Where, in a list of lists, the control vertices of the side stand to which each of its edges belongs, behind their number: two of an edge of the mesh;
        /// all of a face for what lies within it.
        sides: [u32; 4],
        /// So many of its control vertices, the first, have the surface in their convex hull, and perhaps `HULL_SPLINE`; 0 where none are known to.
        hull: u32,
    }

    /// What is decided of all patches in each of some views; push constants.
    Decision {
        /// The first view that is decided for.
        view: u32,
        /// The first view that is decided by, another where a frozen one is looked at.
        seen: u32,
        /// `DECIDE_...` flags.
        flags: u32,
        /// By distance: up to where the level is full, in local units. By what is seen: pixels of a segment. By curvature: radians of a segment.
        measure: f32,
        /// The greatest level.
        level: f32,
        /// The picture in pixels.
        size: [f32; 2],
    }

    /// A point that is computed from control vertices.
    Point {
        /// Position in local units.
        position: [f32; 3],
        /// Unit normal, or zero.
        normal: [f32; 3],
    }

    /// What a point is computed from in a step.
    PointRow {
        /// Its first term.
        first: u32,
        /// How many terms, and `ROW_...` flags.
        count: u32,
    }

    /// A term of a sum: a control vertex or point, and its weights. Of a ring the first term is the point itself, the others the far ends of
    /// its edges, counter-clockwise; their weights do not count.
    PointTerm {
        /// Control vertex or point.
        source: u32,
        /// Weight in the position, or normal.
        position: f32,
        /// Weight in the first tangent.
        du: f32,
        /// Weight in the second tangent.
        dv: f32,
    }

    /// A step of computing points; push constants.
    PointStep {
        /// `POINTS_...`
        kind: u32,
        /// Its first row.
        first_row: u32,
        /// The point that the first row computes; row i computes the ith after it.
        first_point: u32,
        /// How many points.
        count: u32,
    }

    /// A face whose limit is a table of weights: what is summed, and with which weights.
    TableFace {
        /// Where the numbers of its points begin.
        controls: u32,
        /// How many points, and weights a row.
        count: u32,
        /// Where its weights begin.
        weights: u32,
        /// Corners of the face, 3 or 4.
        corners: u32,
        /// Segments of an edge: a power of two.
        segments: u32,
        /// The face, with the same lattice, whose points and weights give normals: itself where they are those of positions. With
        /// `TABLE_TANGENTS`, which give the limit's own.
        normals: u32,
    }

    /// Where an edge or a vertex is evaluated: on a face that all who share it agree upon.
    TablePlace {
        /// The face, by its number in the table.
        face: u32,
        /// The face's own edge or corner, and `PLACE_FLIPPED`.
        side: u32,
    }

    /// A node of a quadtree.
    Node {
        /// `NODE_...`, then the corner or edge << 4, then the number of levels << 8, and what the points are relative to.
        kind: u32,
        /// Internal: the first child. Otherwise where its points begin, counted in 16-bit halves.
        points: u32,
        /// What is left of the sharpness of a crease.
        sharpness: f32,
    }

    /// Where the tables of a pass begin in its buffer, each in elements of its own; patches begin at 0.
    Bases {
        /// The numbers of the control vertices of each patch.
        controls: u32,
        /// Texture coordinates, four a patch.
        texture: u32,
        /// The method's own tables; of control points that are cached, behind eight of these, where the places of each patch's points begin, these places,
        /// and the jobs that compute points; behind these, where the device decides, `PatchSides`, the lists that these point into, and the faces around each vertex.
        own: [u32; 14],
        /// How many patches there are.
        patches: u32,
    }

    /// What a surface is seen with.
    View {
        /// From local units to clip space.
        clip_from_model: [[f32; 4]; 4],
        /// The eye in local units.
        eye: [f32; 3],
        /// To the picture's right: a unit vector, or zero where the view has none.
        right: [f32; 3],
        /// Out of the picture towards who looks, likewise.
        back: [f32; 3],
        /// Displacement along the normal: its height, and its waves per unit of length. No height, no displacement.
        displacement: [f32; 2],
    }

    /// What changes from draw to draw; push constants.
    Frame {
        /// The tess level of a quad, 1..=64.
        level: f32,
        /// `FRAME_...` flags.
        flags: u32,
        /// The first patch of the draw; where patterns are drawn, the first entry of the table of instances.
        first_patch: u32,
        /// The patch behind the last of the draw.
        end_patch: u32,
        /// Patches an instance of the draw; one where patterns are drawn.
        patches_per_instance: u32,
        /// The batch's counter.
        counter: u32,
        /// Instances of the draw that one view has: those of a view come in a row.
        instances: u32,
        /// The first view.
        view: u32,
    }

    /// A vertex as an evaluation shader produced it.
    Captured {
        /// The patch.
        patch_number: u32,
        /// Where in the patch's own domain.
        uv: [f32; 2],
        /// Position in local units.
        position: [f32; 3],
        /// Unit normal.
        normal: [f32; 3],
    }
}

/// The text of `glsl/abi.glsl`.
pub fn glsl() -> String {
    format!(
        "// Generated from src/abi.rs; do not edit. HULLFORM_UPDATE=1 cargo test --test abi writes it anew.\n\
         #ifndef ABI_GLSL\n#define ABI_GLSL\n\n\
         // The first of our three descriptor sets; an engine that has them elsewhere compiles its own shaders with another.\n\
         #ifndef HULLFORM_SET\n#define HULLFORM_SET 0\n#endif\n\n{}{}\n#endif\n",
        glsl_constants(),
        glsl_structs()
    )
}
