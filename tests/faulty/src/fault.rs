//! What goes wrong.

use std::sync::OnceLock;

/// What says it to the layer.
pub const VARIABLE: &str = "WRONG_DRIVER_FAULT";

macro_rules! faults {
    ($($(#[$what:meta])* $fault:ident = $name:literal;)*) => {
        /// A rule that is broken.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Fault {
            $($(#[$what])* $fault,)*
        }

        impl Fault {
            /// All of them.
            pub const ALL: &[Fault] = &[$(Fault::$fault,)*];

            /// Its name, as the layer is told it.
            pub fn name(self) -> &'static str {
                match self {
                    $(Fault::$fault => $name,)*
                }
            }
        }
    };
}

faults! {
    /// A draw lacks its last vertex.
    DrawsOneLess = "draws_one_less";
    /// A draw of nothing draws a patch.
    DrawsNothing = "draws_nothing";
    /// Instances begin at 0, whatever a draw says.
    ForgetsFirstInstance = "forgets_first_instance";
    /// Vertices of draws begin at 0, whatever they say.
    ForgetsFirstVertex = "forgets_first_vertex";
    /// What is added to indices is not.
    ForgetsOffset = "forgets_offset";
    /// Indices of 32 bits are read as of 16.
    ShortIndices = "short_indices";
    /// Of indirect commands in one call only the first is drawn.
    DrawsFirstCommand = "draws_first_command";
    /// Patches beyond 128 Ki in a draw are not drawn.
    DropsManyPatches = "drops_many_patches";
    /// Patches have as many control points as the first draw said.
    KeepsPatchSize = "keeps_patch_size";
    /// The last of several secondary command buffers is not executed.
    LosesSecondary = "loses_secondary";
    /// A rendering that goes on begins anew.
    ClearsRenderings = "clears_renderings";
    /// A command buffer keeps its first pipeline.
    KeepsPipeline = "keeps_pipeline";
    /// A command buffer keeps its first push constants.
    KeepsConstants = "keeps_constants";
    /// Passes draw the first view alone.
    DrawsFirstView = "draws_first_view";
    /// Transform feedback writes behind its buffer's part.
    FeedbackBeyond = "feedback_beyond";
    /// Queries count one more.
    CountsOneMore = "counts_one_more";
    /// The domain's origin is always above.
    OriginAbove = "origin_above";
    /// The other order of vertices is the front.
    FrontsAreBacks = "fronts_are_backs";
    /// Nothing is culled.
    CullsNothing = "culls_nothing";
    /// Patches of several control points have one more.
    PatchesAreLarger = "patches_are_larger";
    /// `fractional_odd_spacing` is `equal_spacing`.
    EqualSpacing = "equal_spacing";
    /// Evaluation shaders have the other order.
    OtherOrder = "other_order";
    /// Points are triangles or lines.
    ForgetsPoints = "forgets_points";
    /// Invocations do not wait for each other.
    ForgetsBarriers = "forgets_barriers";
    /// Geometry shaders run once.
    InvokesOnce = "invokes_once";
    /// `gl_PrimitiveID` of tessellation shaders is the number of control points.
    WrongPatchNumber = "wrong_patch_number";
    /// `gl_PrimitiveID` of fragment shaders is the layer.
    WrongFragmentNumber = "wrong_fragment_number";
    /// `gl_PatchVerticesIn` of control shaders is the number of the invocation.
    WrongPatchVertices = "wrong_patch_vertices";
    /// Distances clip where they should cull, and the other way round.
    ClipsForCulls = "clips_for_culls";
    /// a + b + c is a + (b + c).
    Reassociates = "reassociates";
    /// Loops of control and evaluation shaders take a turn more.
    OneTurnMore = "one_turn_more";
    /// Control shaders store nothing in buffers.
    ControlStoresNothing = "control_stores_nothing";
    /// Compute shaders store nothing in buffers.
    ComputeStoresNothing = "compute_stores_nothing";
    /// The number of the view is that of the patch in tessellation shaders.
    WrongViewNumber = "wrong_view_number";
}

/// Whether this is the fault that the process was started with.
pub fn is(fault: Fault) -> bool {
    static NAME: OnceLock<String> = OnceLock::new();
    let name = NAME.get_or_init(|| std::env::var(VARIABLE).unwrap_or_default());
    name == fault.name()
}
