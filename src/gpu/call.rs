//! Vulkan's result codes as this crate's error.

use crate::error::Error;
use ash::vk;

/// For `map_err`: the error of `call` (its name as the specification writes it).
pub(crate) fn failed(call: &'static str) -> impl Fn(vk::Result) -> Error {
    move |code| Error::Vulkan {
        call,
        // Debug prints the code's name; Display would print a sentence that nobody can search for.
        result: format!("{code:?}"),
    }
}
