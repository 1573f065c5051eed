//! What the suite found in drivers: a minimal case, the cause as far as public sources tell, and a text to file upstream.

/// More than 65,536 vertices in a batch.
pub mod vertices_per_batch {
    #![doc = include_str!("bugs/vertices_per_batch.md")]
}

/// The number of a patch starts again inside of a draw.
pub mod primitive_id {
    #![doc = include_str!("bugs/primitive_id.md")]
}
