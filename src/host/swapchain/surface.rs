//! What a window shows pictures in.

use ash::{khr, vk};

use crate::error::Result;
use crate::gpu::failed;
use crate::gpu::features::extension::has_extension;
use crate::host::instance::unavailable;
use crate::host::{DeviceInfo, Instance};

/// What a window shows Vulkan's pictures in. Destroyed when it is dropped; the window must outlive it.
pub struct WindowSurface {
    instance: Instance,
    pub(super) functions: khr::surface::Instance,
    pub(super) raw: vk::SurfaceKHR,
}

impl WindowSurface {
    /// Takes over a surface.
    ///
    /// # Safety
    /// `raw` was made from `instance`, which has `VK_KHR_surface`; nobody else destroys it, and its window lives longer than this.
    pub unsafe fn new(instance: &Instance, raw: vk::SurfaceKHR) -> WindowSurface {
        WindowSurface {
            functions: khr::surface::Instance::new(instance.entry(), instance.raw()),
            instance: instance.clone(),
            raw,
        }
    }

    /// What a device lacks to show pictures in it, in words.
    pub(in crate::host) fn missing(&self, device: &DeviceInfo) -> Result<Vec<String>> {
        let (physical, name) = (device.physical, khr::swapchain::NAME);
        let mut missing = Vec::new();
        // SAFETY: the device was listed by this live instance, here and below.
        let has = unsafe { has_extension(self.instance.raw(), physical, name) };
        if !has.map_err(unavailable("vkEnumerateDeviceExtensionProperties"))? {
            missing.push(name.to_string_lossy().into_owned());
        }
        if let Some(family) = device.support.graphics_family {
            // SAFETY: as above; the family is one of the device's.
            let shows = unsafe {
                let functions = &self.functions;
                functions.get_physical_device_surface_support(physical, family, self.raw)
            };
            if !shows.map_err(failed("vkGetPhysicalDeviceSurfaceSupportKHR"))? {
                missing.push("a queue that draws and shows pictures in this window".into());
            }
        }
        Ok(missing)
    }
}

impl WindowSurface {
    /// Destroys it before it is dropped: a window has one surface at a time that is drawn to.
    pub(super) fn destroy(&mut self) {
        // SAFETY: it is ours, and its swapchain has gone: see `Swapchain`; null handles are allowed.
        unsafe { self.functions.destroy_surface(self.raw, None) };
        self.raw = vk::SurfaceKHR::null();
    }
}

impl Drop for WindowSurface {
    fn drop(&mut self) {
        self.destroy();
    }
}
