//! The control mesh and what surrounds each of its faces.

mod builtin;
mod control_mesh;
mod creased_edges;
mod edit;
pub(crate) mod faces;
mod model;
mod obj;
mod placement;
pub(crate) mod places;
mod replicate;
mod scheme;
pub mod sharpness;
mod suitable;
pub mod topology;
mod triangulate;

pub use builtin::{BUILTINS, DEFAULT_BUILTIN, builtin};
pub use control_mesh::{
    BoundaryInterpolation, ControlMesh, ControlMeshBuilder, Corner, Crease, CreaseMethod,
    FaceVarying, INFINITE_SHARPNESS, SchemeOptions, TriangleSubdivision,
};
pub use edit::{ChangeSet, Edit};
pub use model::Model;
pub use obj::{read_obj, read_obj_bytes};
pub use placement::Placement;
pub use replicate::replicated;
pub use scheme::Scheme;
pub use triangulate::{Triangulation, triangulated};
