//! The layer over a borrowed Vulkan device.

pub mod shaders;
