//! Every constant and struct that host and shaders share, declared once.
//!
//! `glsl/abi.glsl` is generated from here ([`glsl`]); a test holds the committed file to it, another holds the members' offsets in the
//! compiled SPIR-V to those of the Rust structs. All blocks have scalar layout (`VK_EXT_scalar_block_layout`, core in Vulkan 1.2).

#[macro_use]
mod declare;
mod constants;

use bytemuck::{Pod, Zeroable};

use declare::Shared;

pub use constants::*;

structs! {
    /// What is decided about a patch before it is drawn.
    PatchDraw {
        /// Where its slot in the scratch ring begins, when the host gives slots or the device decides; then, of a patch that is not drawn, the `DECIDE_...` flag that
        /// says why, or 0.
        slot: u32,
        /// Levels of its edges from corner i to corner i + 1, when it has levels of its own.
        edges: [f32; 4],
        /// The level of its inside.
        inside: f32,
    }

    /// A patch, or a piece of one, that is drawn by itself where a list has patches with more segments than a tessellator makes.
    SubPatch {
        /// The patch.
        patch_number: u32,
        /// Which piece: its column and, 12 bits higher, its row among as many as there are at its depth, and the depth, `PIECE_DEPTH_SHIFT`. 0 for the whole.
        piece: u32,
        /// Where its slot in the scratch ring begins, when the host gives slots.
        slot: u32,
        /// Levels of the whole patch's edges from corner i to corner i + 1.
        edges: [f32; 4],
        /// The level of the whole patch's inside: of pieces a whole number for each; 0 where nothing is drawn.
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
        /// or `NO_TANGENTS`. With `USE_HUB` both are numbers of points.
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
        /// So many of its control vertices, the first, have the surface in their convex hull, and `HULL_...` flags; 0 where none are known to.
        hull: u32,
        /// Where among these lists stands how many points it needs in the ring at levels 0..=10.
        needs: u32,
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
        /// How many control vertices there are.
        vertices: u32,
    }

    /// What is made of decisions: the patches that are drawn, in batches by what they need; push constants.
    Compaction {
        /// `COMPACT_...` flags.
        flags: u32,
        /// The first view.
        view: u32,
        /// Behind the `PatchDraw` records of all views, counted in words, where the `DrawnBatch` records of view 0 stand; other views follow.
        batches: u32,
        /// Where the numbers of the patches that are drawn in view 0 stand.
        list: u32,
        /// How many batches are recorded; no view needs more.
        count: u32,
        /// How many points of the ring patches begin in that are drawn by one batch, or else how many these are.
        window: u32,
        /// Points of each slot, where windows are of patches.
        points: u32,
        /// Tessellated vertices an instance, on drivers that bound them; else 0.
        instance_vertices: u32,
    }

    /// What a batch draws in a view. It begins with what `vkCmdDrawIndirect` reads (`VkDrawIndirectCommand`).
    DrawnBatch {
        /// Vertices an instance.
        vertices: u32,
        /// Instances; none where nothing is drawn.
        instances: u32,
        /// 0.
        first_vertex: u32,
        /// Which views the instances belong to: those of each follow upon its number times the patches of the pass.
        first_instance: u32,
        /// Its first patch, in the list of those that are drawn.
        first: u32,
        /// How many patches.
        patches: u32,
        /// How many an instance; the last may have fewer.
        per_instance: u32,
    }

    /// A point that is computed from control vertices.
    Point {
        /// Position in local units.
        position: [f32; 3],
        /// Unit normal, or zero; of `POINTS_HUB`, what the position is relative to.
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

    /// The eigenbasis of a valence (Stam 1998), where its floats begin.
    Eigenbasis {
        /// How many eigenvectors there are: twice the valence and eight.
        count: u32,
        /// Of each of the three pieces of a patch, for each vector the sixteen control points of a B-spline.
        coefficients: u32,
        /// Of each of the `EIGEN_LEVELS`, each eigenvalue to its power.
        powers: u32,
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
        /// and the jobs that compute points; behind these, where the device decides, `PatchSides`, the lists that these point into, and of the first pass what the limits and normals of vertices are made of.
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
        /// The tess level of a quad, 1..=64; up to 1024 where patches are cut into pieces.
        level: f32,
        /// `FRAME_...` flags.
        flags: u32,
        /// The first patch of the draw; where patterns are drawn, the first entry of the table of instances; where the device decides, the word at which the batch's
        /// `DrawnBatch` of view 0 stands.
        first_patch: u32,
        /// The patch behind the last of the draw.
        end_patch: u32,
        /// Patches an instance of the draw; one where patterns are drawn; where the device decides, words from a view's batches to the next view's.
        patches_per_instance: u32,
        /// The batch's counter; where the device decides, the word at which the list of patches that are drawn in view 0 stands.
        counter: u32,
        /// Instances of the draw that one view has, or may have: those of a view come in a row.
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
        constants::glsl_constants(),
        glsl_structs()
    )
}
