//! Tess levels that agree on every edge, what the tessellator makes of them, and triangles from its vertices.

mod levels;
mod rings;
mod triangulate;

pub use levels::{Domain, Levels, Spacing, levels, required_level};
pub use triangulate::triangulate;
