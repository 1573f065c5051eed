//! The truth, in f64: the rules of subdivision schemes with boundaries, creases and corners, and the limits they lead to.

mod box_patch;
mod cell;
mod curve;
mod deep;
mod jet;
mod limit;
mod limit_surface;
mod masks;
mod normals;
mod plain;
mod refine;
mod regular;
mod schemes;
mod split;

pub use crate::mesh::Scheme;
pub(crate) use box_patch::box_spline_patch;
pub(crate) use curve::{EdgeCurve, edge_curve};
pub use deep::deep_limit;
pub(crate) use deep::{orthonormal, orthonormal_masks, tangents_nearby};
pub use limit::{LimitStencil, is_cusp, limit_stencil};
pub(crate) use limit::{TangentPlane, closing_tangents, is_unpromised, tangent_plane};
pub use limit_surface::{LimitSample, LimitSurface};
pub use masks::{Blend, Mask};
pub(crate) use plain::is_plain_edge;
pub use refine::{Refinement, refine};
pub(crate) use refine::{refine_edge, refine_vertex};
pub(crate) use regular::{BsplinePatch, ControlPoint, CornerPoints, bspline_patch, corner_points};
pub(crate) use schemes::rings as scheme_rings;
pub use schemes::vertex_limit;
pub use split::refine_all;
