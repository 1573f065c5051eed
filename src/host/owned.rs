//! What is destroyed by hand elsewhere, and here at the end of its scope.

use std::ops::{Deref, DerefMut};

use crate::gpu::{
    Buffer, CachePipelines, DecidePipeline, FrameSlot, Layout, Memory, Pipelines, PointPipeline,
    Pose, Tables, TessellatedSurface,
};
use crate::host::Device;

/// What a device has made, and takes back.
pub trait Destroy {
    /// Destroys it.
    ///
    /// # Safety
    /// `device` and `allocator` made it, no submitted command still uses it, and no recorded one will be submitted.
    unsafe fn destroy(self, device: &ash::Device, allocator: &mut dyn Memory);
}

macro_rules! destroyed {
    ($($of_device:ty),*; $($with_memory:ty),*) => {
        $(impl Destroy for $of_device {
            unsafe fn destroy(self, device: &ash::Device, _: &mut dyn Memory) {
                // SAFETY: this function's contract.
                unsafe { <$of_device>::destroy(self, device) };
            }
        })*
        $(impl Destroy for $with_memory {
            unsafe fn destroy(self, device: &ash::Device, allocator: &mut dyn Memory) {
                // SAFETY: this function's contract.
                unsafe { <$with_memory>::destroy(self, device, allocator) };
            }
        })*
    };
}

destroyed!(
    CachePipelines, DecidePipeline, Layout, Pipelines, PointPipeline;
    Buffer, FrameSlot, Pose, Tables, TessellatedSurface
);

/// Something with its device, which destroys it when it is dropped: whatever fails in between. [`Device::submit`] waits, so nothing is in use
/// then; what a device that [is hung](Device::is_hung) may still use stays. Not to be dropped while the caller holds the device's
/// [`allocator`](Device::allocator).
pub struct Owned<T: Destroy> {
    device: Device,
    made: Option<T>,
}

impl<T: Destroy> Owned<T> {
    /// Takes over what a device has made.
    ///
    /// # Safety
    /// `device` and its allocator made it, and only [`Device::submit`] and [`Swapchain::frame`](crate::host::Swapchain::frame) submit what uses it;
    /// the latter's frame is done when it is dropped.
    pub unsafe fn new(device: &Device, made: T) -> Owned<T> {
        Owned {
            device: device.clone(),
            made: Some(made),
        }
    }
}

impl<T: Destroy> Deref for Owned<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.made.as_ref().expect("there until it is dropped")
    }
}

impl<T: Destroy> DerefMut for Owned<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.made.as_mut().expect("there until it is dropped")
    }
}

impl<T: Destroy> Drop for Owned<T> {
    fn drop(&mut self) {
        if let Some(made) = self.made.take().filter(|_| !self.device.is_hung()) {
            // SAFETY: the contract of `new`: whatever used it has been waited for.
            unsafe { made.destroy(self.device.raw(), &mut self.device.memory()) };
        }
    }
}
