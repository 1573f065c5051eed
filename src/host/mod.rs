//! Instance, device and a picture to draw into, for those who have no engine.

mod bench;
mod choice;
mod coloured;
mod device;
mod instance;
mod offscreen;
mod owned;
mod render_pass;
mod statistics;
mod storage_set;
mod swapchain;
mod timestamps;

pub use bench::{Bench, Frame, Loaded, Shot, Style, vertex_bits, vertex_key};
pub use choice::{DeviceInfo, devices};
pub use coloured::{ColouredTriangles, ColouredVertex};
pub use device::Device;
pub use instance::Instance;
pub use offscreen::{Area, Encoding, OffscreenTarget};
pub use owned::{Destroy, Owned};
pub use statistics::StatisticsQuery;
pub(crate) use storage_set::StorageSet;
pub use swapchain::{Image, Pacing, Shown, Swapchain, WindowSurface};
pub use timestamps::TimestampQuery;
