//! Instance, device and a picture to draw into, for those who have no engine.

mod area;
mod bench;
mod choice;
mod coloured;
mod device;
mod image;
mod instance;
mod offscreen;
mod owned;
mod pipeline_cache;
mod render_pass;
mod statistics;
mod storage_set;
mod swapchain;
mod timestamps;

pub use area::Area;
pub use bench::{Bench, Frame, Loaded, Shot, Style, vertex_bits, vertex_key};
pub use choice::{DeviceInfo, devices, unsuitable};
pub use coloured::{ColouredTriangles, ColouredVertex};
pub use device::{Device, SharedMemory};
pub use instance::Instance;
pub use offscreen::{Encoding, OffscreenTarget};
pub use owned::{Destroy, Owned};
pub use pipeline_cache::PipelineCache;
pub use render_pass::Slice;
pub use statistics::StatisticsQuery;
pub(crate) use storage_set::StorageSet;
pub use swapchain::{Image, Pacing, Shown, Swapchain, WindowSurface};
pub use timestamps::TimestampQuery;
