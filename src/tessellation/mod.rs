//! Tess levels that agree on every edge, what the tessellator makes of them, and triangles from its vertices.

mod coordinates;
mod levels;
mod pattern;
mod rings;
mod triangulate;

pub use coordinates::coordinates;
pub(crate) use levels::cells;
pub use levels::{Domain, Levels, Spacing, levels, levels_of_edges, required_level};
pub use pattern::{lattice_rows, lattice_segments, lattice_vertices, pattern};
pub use triangulate::triangulate;
pub(crate) use triangulate::triangulate_levels;
