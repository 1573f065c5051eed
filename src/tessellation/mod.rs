//! Tess levels that agree on every edge, what the tessellator makes of them, and triangles from its vertices.

mod coordinates;
mod levels;
mod pattern;
mod piece;
mod rings;
mod sub_patch;
mod triangulate;

pub use coordinates::coordinates;
pub(crate) use levels::cells;
pub(crate) use levels::levels_of_edges_and_inside;
pub use levels::{Domain, Levels, Spacing, levels, levels_of_edges, required_level};
pub use pattern::{lattice_rows, lattice_segments, lattice_vertices, pattern};
pub(crate) use piece::{Piece, TESSELLATED};
pub(crate) use sub_patch::piece_coordinates;
pub use triangulate::triangulate;
pub(crate) use triangulate::triangulate_levels;
