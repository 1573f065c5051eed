//! An image with its memory and view.

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};

use crate::error::Result;
use crate::gpu::failed;
use crate::gpu::memory::out_of_memory;
use crate::host::Device;

/// An image with its memory and view; null until made.
#[derive(Default)]
pub(super) struct Image {
    pub raw: vk::Image,
    pub view: vk::ImageView,
    pub allocation: Option<Allocation>,
}

impl Image {
    pub fn make(
        &mut self,
        device: &Device,
        name: &str,
        info: &vk::ImageCreateInfo<'_>,
    ) -> Result<()> {
        let raw = device.raw();
        // SAFETY: the device is live; size, format and samples were checked against its limits.
        self.raw = unsafe { raw.create_image(info, None) }.map_err(failed("vkCreateImage"))?;
        let request = AllocationCreateDesc {
            name,
            // SAFETY: the image was just made from this device.
            requirements: unsafe { raw.get_image_memory_requirements(self.raw) },
            location: MemoryLocation::GpuOnly,
            linear: false,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        };
        let allocation = device.allocator().allocate(&request);
        let allocation = self.allocation.insert(allocation.map_err(out_of_memory)?);
        let (memory, offset) = {
            // SAFETY: the memory is bound to nothing else and outlives the image.
            (unsafe { allocation.memory() }, allocation.offset())
        };
        // SAFETY: size, alignment and memory type come from the image's own requirements; the image is unbound.
        unsafe { raw.bind_image_memory(self.raw, memory, offset) }
            .map_err(failed("vkBindImageMemory"))?;
        self.make_view(raw, info)
    }

    fn make_view(&mut self, device: &ash::Device, info: &vk::ImageCreateInfo<'_>) -> Result<()> {
        let depth = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let aspect = if info.usage.contains(depth) {
            vk::ImageAspectFlags::DEPTH
        } else {
            vk::ImageAspectFlags::COLOR
        };
        let view = vk::ImageViewCreateInfo::default()
            .image(self.raw)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(info.format)
            .subresource_range(
                vk::ImageSubresourceRange::default()
                    .aspect_mask(aspect)
                    .level_count(1)
                    .layer_count(1),
            );
        // SAFETY: the image is of this device and bound to memory; format and aspect are its own.
        self.view = unsafe { device.create_image_view(&view, None) }
            .map_err(failed("vkCreateImageView"))?;
        Ok(())
    }
}
