//! Subdivision plans (Brainerd et al. 2016, sections 4 and 7.2): what a face needs to know about its limit, apart from positions.

mod base;
mod builder;
mod catalogue;
mod configuration;
mod edge;
mod level;
mod nearby;
mod packing;
mod rows;
mod span;
mod strip;
mod sums;
mod tree;
mod vertex;
mod walk;

pub use builder::{Plan, PlanOptions, Stencil};
pub use catalogue::Catalogue;
pub use configuration::{Configuration, Ring};
pub use edge::{EdgeKind, EdgePlan};
pub use packing::{PackedPlans, Plans};
pub use strip::{Crease, Stretch, Strip};
pub use tree::{Node, NodeKind};
pub use vertex::{Side, VertexKind, VertexPlan};
pub use walk::{Leaf, walk};
