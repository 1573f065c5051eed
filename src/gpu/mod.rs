//! The layer over a borrowed Vulkan device.
//!
//! The engine owns instance, device, queue and allocator; nothing here creates, submits or waits.

pub mod buffer;
mod call;
pub mod driver;
pub mod features;
pub mod ring;
pub mod workaround;

pub use buffer::Buffer;
pub(crate) use call::failed;
pub use driver::{Driver, Version};
pub use features::{FeatureChain, OptionalFeatures, Support};
pub use workaround::{Remedy, Workaround, workarounds};
