//! Another surface of the same window, when the first one was lost.

use ash::vk;

use super::choice::choose;
use super::{Swapchain, WindowSurface};
use crate::error::{Error, Result};
use crate::gpu::failed;
use crate::host::Device;

impl Swapchain {
    /// Makes the images anew after the surface was lost, in one that `surface` makes of the same window once the old one has gone. Everything as after
    /// [`resize`](Self::resize).
    ///
    /// # Errors
    /// Those of `surface`; [`Error::NoDisplay`] when the device cannot show pictures of the [format](Self::format) in it any more; Vulkan's own,
    /// [`Error::SurfaceLost`] once more among them.
    pub fn renew(
        &mut self,
        size: [u32; 2],
        surface: impl FnOnce() -> Result<WindowSurface>,
    ) -> Result<()> {
        self.wait()?;
        self.destroy_views();
        if !self.comes_to_rest() {
            return Err(failed("vkQueueWaitIdle")(vk::Result::ERROR_UNKNOWN));
        }
        let device = self.device.raw();
        // SAFETY: nothing uses what is destroyed any more, all of which is ours. Null handles are allowed.
        unsafe {
            for semaphore in self.drawn.drain(..) {
                device.destroy_semaphore(semaphore, None);
            }
            self.functions.destroy_swapchain(self.raw, None);
        }
        self.raw = vk::SwapchainKHR::null();
        self.stale = true;
        // A frame that was given up may have left it signalled.
        self.renew_semaphore();
        self.surface.destroy();
        self.surface = surface()?;
        let missing = self.surface.missing(self.device.info())?;
        if !missing.is_empty() || format(&self.device, &self.surface)? != self.format {
            let words = "the display has changed, and the device does not draw to it as before";
            return Err(Error::NoDisplay(words.into()));
        }
        self.resize(size)
    }
}

/// The format of a surface's images.
pub(super) fn format(device: &Device, surface: &WindowSurface) -> Result<vk::SurfaceFormatKHR> {
    let physical = device.info().physical;
    // SAFETY: the device is one of the surface's instance.
    let formats = unsafe {
        let functions = &surface.functions;
        functions.get_physical_device_surface_formats(physical, surface.raw)
    };
    choose(&formats.map_err(failed("vkGetPhysicalDeviceSurfaceFormatsKHR"))?)
}
