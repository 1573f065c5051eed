//! What a frame decides about a surface, as plain values: who cuts patches and how finely, which are drawn together, where their points go.
//!
//! A [`DrawList`] is built and tested without a device, and valid by construction: `gpu` only brings it there and records it. The shape is that
//! of vello's `Recording`: commands as data.

mod backend;
mod batch;
mod batches;
mod chosen;
mod compacted;
mod compaction;
mod culling;
mod cut;
mod decision;
mod draw;
mod draw_list;
mod options;
mod outcome;
mod patterns;
mod residence;
mod seen;
mod sub_patches;
mod tagged;
mod tessellated;

pub use backend::Backend;
pub use chosen::hull_points;
pub use compaction::Compacted;
#[cfg(feature = "vulkan")]
pub(crate) use compaction::{Compaction, most_batches};
pub use culling::Culled;
pub use cut::Cut;
pub use decision::{Decision, Metric, Samples};
pub use draw::Draw;
pub use draw_list::{Batch, DrawList};
pub use options::{Decides, Slots, SurfaceOptions};
pub use outcome::Outcome;
#[cfg(feature = "vulkan")]
pub(crate) use patterns::{Key, key};
pub use residence::Residence;
pub use seen::Seen;
pub use tessellated::{Tessellated, TessellatedPoint};
