//! The layer over a borrowed Vulkan device.
//!
//! The engine owns instance, device, queue and allocator; nothing here submits or waits.

mod arrival;
pub mod buffer;
mod buffers;
mod call;
mod draw;
pub mod driver;
pub mod features;
mod layout;
mod patterns;
mod pipeline;
mod points;
pub mod ring;
pub mod shaders;
mod staging;
mod surface;
pub mod workaround;

pub use crate::frame::{Backend, Batch, Cut, DrawList, Slots, SurfaceOptions};
pub use arrival::Arrival;
pub use buffer::Buffer;
pub(crate) use call::failed;
pub use draw::{Counters, View};
pub use driver::{Driver, Version};
pub use features::{Enabled, ExtraFeatures, FeatureChain, OptionalFeatures, Support};
pub use layout::Layout;
pub use pipeline::{Fill, Pipelines, Shading, Target};
pub use points::PointPipeline;
pub use surface::TessellatedSurface;
pub use workaround::{Remedy, Workaround, workarounds};
