//! Instance, device and a picture to draw into, for those who have no engine.

mod choice;
mod coloured;
mod device;
mod instance;
mod offscreen;
mod render_pass;
mod statistics;
mod storage_set;
mod timestamps;

pub use choice::{DeviceInfo, devices};
pub use coloured::{ColouredTriangles, ColouredVertex};
pub use device::Device;
pub use instance::Instance;
pub use offscreen::{Area, Encoding, OffscreenTarget};
pub use statistics::StatisticsQuery;
pub(crate) use storage_set::StorageSet;
pub use timestamps::TimestampQuery;
