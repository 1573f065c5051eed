//! What a frame decides about a surface, as plain values: who cuts patches and how finely, which are drawn together, where their points go.
//!
//! A [`DrawList`] is built and tested without a device, and valid by construction: `gpu` only brings it there and records it. The shape is that
//! of vello's `Recording`: commands as data.

mod backend;
mod batches;
mod cut;
mod decision;
mod draw;
mod draw_list;
mod options;
mod patterns;
mod residence;
mod tessellated;

pub use backend::Backend;
pub use cut::Cut;
pub use decision::{Decision, Metric, Seen};
pub use draw::Draw;
pub use draw_list::{Batch, DrawList};
pub use options::{Decides, Slots, SurfaceOptions};
#[cfg(feature = "vulkan")]
pub(crate) use patterns::{Key, key};
pub use residence::Residence;
pub use tessellated::{Tessellated, TessellatedPoint};
