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
mod refine;
mod regular;
mod schemes;
mod split;

pub use crate::mesh::Scheme;
pub use box_patch::box_spline_patch;
pub use curve::{EdgeCurve, edge_curve};
pub(crate) use deep::orthonormal;
pub use deep::{deep_limit, tangents_nearby};
pub use limit::{
    LimitStencil, TangentPlane, closing_tangents, is_cusp, is_unpromised, limit_stencil,
    tangent_plane,
};
pub use limit_surface::{LimitSample, LimitSurface};
pub use masks::{Blend, Mask, edge_point, face_point, vertex_point};
pub use refine::{Refinement, refine, refine_edge};
pub use regular::{BsplinePatch, ControlPoint, bspline_patch};
pub(crate) use schemes::rings as scheme_rings;
pub use schemes::vertex_limit;
pub use split::refine_all;
