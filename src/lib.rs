//! hullform turns a control mesh into plans on the CPU once, and then one patch a face through Vulkan's control and
//! evaluation shaders every frame.

pub mod abi;
pub mod error;
#[cfg(feature = "vulkan")]
pub mod gpu;
#[cfg(feature = "host")]
pub mod host;
pub mod mesh;
pub mod method;
pub mod patch;
pub mod plan;
pub mod subdivision;
pub mod tessellation;

pub use error::{Error, Place, Result};
