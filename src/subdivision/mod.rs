//! The truth, in f64: Catmull and Clark's rules with boundaries, creases and corners, and the limits they lead to.

mod curve;
mod limit;
mod limit_surface;
mod masks;
mod refine;
mod regular;

pub use crate::mesh::Scheme;
pub use curve::{EdgeCurve, edge_curve};
pub use limit::{LimitStencil, TangentPlane, limit_stencil, tangent_plane};
pub use limit_surface::{LimitSample, LimitSurface};
pub use masks::{Blend, Mask, edge_point, face_point, vertex_point};
pub use refine::{Refinement, refine, refine_edge};
pub use regular::{BsplinePatch, ControlPoint, bspline_patch};
