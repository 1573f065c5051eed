//! The truth, in f64: Catmull and Clark's rules with boundaries, creases and corners, and the limits they lead to.

mod limit;
mod limit_surface;
mod masks;
mod refine;
mod regular;

pub use limit::{LimitStencil, limit_stencil};
pub use limit_surface::{LimitSample, LimitSurface, Scheme};
pub use masks::{Blend, Mask, edge_point, face_point, vertex_point};
pub use refine::{Refinement, refine};
pub use regular::{BsplinePatch, ControlPoint, bspline_patch};
