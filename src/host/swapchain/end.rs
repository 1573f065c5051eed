//! How a swapchain comes to an end: nothing is destroyed that may still be in use.

use ash::vk;

use super::{PATIENCE, Swapchain};

impl Swapchain {
    /// Waits until nothing of it is in use, by the device or by the display, of whose end nothing tells but an idle queue. False when even that cannot be known:
    /// then the device [is hung](crate::host::Device::is_hung).
    pub(super) fn comes_to_rest(&self) -> bool {
        if self.device.is_hung() {
            return false;
        }
        let idle = {
            let queue = self.device.queue();
            // SAFETY: the queue is ours for now.
            unsafe { self.device.raw().queue_wait_idle(*queue) }
        };
        // A lost device is idle (Vulkan spec, "Lost Device"); another failure says nothing.
        let idle = matches!(idle, Ok(()) | Err(vk::Result::ERROR_DEVICE_LOST));
        let idle = idle || self.device.becomes_idle();
        if !idle {
            self.device.give_up();
        }
        idle
    }

    /// Whether the last frame is done; without a fence, the swapchain never was whole, and there was none.
    fn is_done(&self) -> bool {
        let none = self.fence == vk::Fence::null();
        none || match self.device.wait(self.fence, PATIENCE) {
            Ok(()) => true,
            Err(unfinished) => unfinished.ended,
        }
    }
}

impl Drop for Swapchain {
    fn drop(&mut self) {
        if self.device.is_hung() || !self.is_done() || !self.comes_to_rest() {
            if !self.device.is_hung() {
                self.device.give_up();
            }
            // It lasts as long as its swapchain, which stays.
            self.surface.raw = vk::SurfaceKHR::null();
            return;
        }
        self.destroy_views();
        let device = self.device.raw();
        // SAFETY: all of it is ours, and nothing is in use any more; null handles are allowed.
        unsafe {
            for &semaphore in &self.drawn {
                device.destroy_semaphore(semaphore, None);
            }
            device.destroy_semaphore(self.acquired, None);
            device.destroy_fence(self.fence, None);
            device.destroy_command_pool(self.pool, None);
            self.functions.destroy_swapchain(self.raw, None);
        }
    }
}
