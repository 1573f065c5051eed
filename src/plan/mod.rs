//! Subdivision plans (Brainerd et al. 2016, sections 4 and 7.2): what a face needs to know about its limit, apart from positions.

mod base;
mod builder;
mod configuration;
pub mod database;
mod edge;
mod level;
mod lists;
mod nearby;
mod packed_rows;
mod packing;
mod quarter;
mod required;
mod row_pool;
mod rows;
mod smooth;
mod span;
mod stencil_rows;
mod stencils;
mod strip;
mod sums;
mod tree;
mod vertex;
mod walk;

pub use builder::{Plan, PlanOptions};
pub use configuration::{Configuration, Ring};
pub use database::Database;
pub use edge::{EdgeKind, EdgePlan};
pub use packed_rows::{PackedRows, Row, RowsView};
pub use packing::{PackedPlans, Plans};
pub(crate) use smooth::{SmoothQuads, SmoothRing, SmoothStart};
pub use stencils::Stencils;
pub use strip::{Crease, Stretch, Strip};
pub use tree::{Node, NodeKind};
pub use vertex::{Side, VertexKind, VertexPlan};
pub use walk::{Leaf, walk};
