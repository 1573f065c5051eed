//! What the suite found in drivers: a minimal case, the cause as far as public sources tell, and a text to file upstream. Beside each page in
//! `src/conformance/bugs` lies the case as a program in C of one file, which needs nothing but Vulkan.

/// More than 65,536 vertices in a batch.
pub mod vertices_per_batch {
    #![doc = include_str!("bugs/vertices_per_batch.md")]
}

/// The number of a patch starts again inside of a draw.
pub mod primitive_id {
    #![doc = include_str!("bugs/primitive_id.md")]
}

/// The fragment shader's number of the primitive is 0.
pub mod fragment_primitive_id {
    #![doc = include_str!("bugs/fragment_primitive_id.md")]
}

/// Components of a vector of the patch are written over.
pub mod patch_components {
    #![doc = include_str!("bugs/patch_components.md")]
}

/// What an invocation computed in its last turn of a loop is lost.
pub mod loop_exits {
    #![doc = include_str!("bugs/loop_exits.md")]
}

/// A query begins before a pipeline is bound, and the process ends.
pub mod query_without_pipeline {
    #![doc = include_str!("bugs/query_without_pipeline.md")]
}

/// Triangles are culled by the side that they show before their corners are rounded.
pub mod culled_before_rounding {
    #![doc = include_str!("bugs/culled_before_rounding.md")]
}
