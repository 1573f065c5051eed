//! The layer over a borrowed Vulkan device.
//!
//! The engine owns instance, device, queue and allocator; nothing here submits or waits.

mod arrival;
mod backend;
mod barrier;
mod bound;
pub mod buffer;
mod cache;
mod cached;
mod call;
mod changes;
mod compact;
mod decide;
mod draw;
pub mod driver;
pub mod features;
mod frame_slot;
mod indirect;
mod kept_cache;
mod layout;
mod lists;
pub mod memory;
mod patterns;
mod pipeline;
mod points;
mod pose;
mod retired;
pub mod ring;
mod sets;
pub mod shaders;
mod staging;
mod surface;
mod tables;
mod target;
mod view;
pub mod workaround;

pub use crate::frame::{
    Backend, Batch, Cut, Decides, Decision, DrawList, Metric, Outcome, Residence, Samples, Slots,
    SurfaceOptions,
};
pub use arrival::Arrival;
pub use buffer::Buffer;
pub use cache::{CachePipelines, Filling};
pub(crate) use call::failed;
pub use decide::{DecidePipeline, Decided};
pub use draw::Drawing;
pub use driver::{Driver, Version};
pub use features::{Enabled, ExtraFeatures, FeatureChain, OptionalFeatures, Support};
pub use frame_slot::{Counters, FrameSlot};
pub use indirect::{Indirect, IndirectCommands};
pub use layout::Layout;
pub use memory::{Memory, MemoryBlock, MemoryRequest};
pub use pipeline::Pipelines;
pub use points::PointPipeline;
pub use pose::Pose;
pub use retired::Retired;
pub use staging::Handover;
pub use surface::TessellatedSurface;
pub use tables::Tables;
pub use target::{
    Attachments, DepthBias, Fill, Fragment, OwnLayout, PipelineOptions, Shading, Target,
};
pub use view::View;
pub use workaround::{Remedy, Workaround, workarounds};
