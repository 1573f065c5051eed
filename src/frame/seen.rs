//! From where decisions see a surface.

/// What a view is decided by: its matrix, column by column, its eye and the height of its displacement, in local units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// From local units to clip space.
    pub clip_from_model: [[f32; 4]; 4],
    /// The eye.
    pub eye: [f32; 3],
    /// The height of the displacement.
    pub height: f32,
}
