//! Vulkan's result codes as this crate's errors.

use crate::error::Error;
use ash::vk;

/// For `map_err`: the error of `call` (its name as the specification writes it).
pub(crate) fn failed(call: &'static str) -> impl Fn(vk::Result) -> Error {
    move |code| {
        // Debug prints the code's name; Display would print a sentence that nobody can search for.
        let result = format!("{code:?}");
        match code {
            vk::Result::ERROR_OUT_OF_HOST_MEMORY | vk::Result::ERROR_OUT_OF_DEVICE_MEMORY => {
                Error::OutOfMemory { call, result }
            }
            vk::Result::ERROR_DEVICE_LOST => Error::DeviceLost { call, result },
            vk::Result::ERROR_SURFACE_LOST_KHR => Error::SurfaceLost { call, result },
            _ => Error::Vulkan { call, result },
        }
    }
}
