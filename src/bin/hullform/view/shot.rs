//! A picture of the window, as the display gets it.

use gpu_allocator::MemoryLocation;
use hullform::Result;
use hullform::ash::{self, vk};
use hullform::gpu::Buffer;
use hullform::gpu_allocator;
use hullform::host::{Device, Image, Owned};

/// Where a frame is copied to.
pub struct Shot {
    pixels: Owned<Buffer>,
    extent: vk::Extent2D,
}

impl Shot {
    /// Room for a frame of this size.
    pub fn new(device: &Device, extent: vk::Extent2D) -> Result<Shot> {
        let size = 4 * u64::from(extent.width) * u64::from(extent.height);
        let usage = vk::BufferUsageFlags::TRANSFER_DST;
        let location = MemoryLocation::GpuToCpu;
        // SAFETY: device and allocator belong together; the usage needs no feature.
        let buffer = unsafe {
            let allocator = &mut *device.allocator();
            Buffer::new(device.raw(), allocator, "screenshot", size, usage, location)
        }?;
        Ok(Shot {
            // SAFETY: it was just made by this device.
            pixels: unsafe { Owned::new(device, buffer) },
            extent,
        })
    }

    /// Whether frames are of its size.
    pub fn fits(&self, extent: vk::Extent2D) -> bool {
        self.extent == extent
    }

    /// The bytes, once the frame is done.
    pub fn bytes(&self) -> &[u8] {
        self.pixels.bytes()
    }

    /// Copies a frame that is ready for the display.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this, outside of a render pass; the image is in the layout `PRESENT_SRC_KHR`, of this size, and can
    /// be copied from. This lives until the commands have been executed.
    pub unsafe fn cmd_take(&self, device: &ash::Device, cmd: vk::CommandBuffer, image: Image) {
        use vk::{AccessFlags as Access, ImageLayout as Layout, PipelineStageFlags as Stage};
        let range = vk::ImageSubresourceRange::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .level_count(1)
            .layer_count(1);
        let barrier = |[from, to]: [Layout; 2], [before, after]: [Access; 2]| {
            [vk::ImageMemoryBarrier::default()
                .src_access_mask(before)
                .dst_access_mask(after)
                .old_layout(from)
                .new_layout(to)
                .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .image(image.raw)
                .subresource_range(range)]
        };
        let shown = Layout::PRESENT_SRC_KHR;
        let source = Layout::TRANSFER_SRC_OPTIMAL;
        let first = barrier(
            [shown, source],
            [Access::COLOR_ATTACHMENT_WRITE, Access::TRANSFER_READ],
        );
        let last = barrier([source, shown], [Access::empty(), Access::empty()]);
        let layers = vk::ImageSubresourceLayers::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .layer_count(1);
        let region = vk::BufferImageCopy::default()
            .image_subresource(layers)
            .image_extent(self.extent.into());
        let read = [vk::MemoryBarrier::default()
            .src_access_mask(Access::TRANSFER_WRITE)
            .dst_access_mask(Access::HOST_READ)];
        let none = vk::DependencyFlags::empty();
        let drawn = Stage::COLOR_ATTACHMENT_OUTPUT;
        let (copy, end) = (Stage::TRANSFER, Stage::BOTTOM_OF_PIPE | Stage::HOST);
        // SAFETY: this function's contract.
        unsafe {
            device.cmd_pipeline_barrier(cmd, drawn, copy, none, &[], &[], &first);
            let pixels = self.pixels.raw();
            device.cmd_copy_image_to_buffer(cmd, image.raw, source, pixels, &[region]);
            device.cmd_pipeline_barrier(cmd, copy, end, none, &read, &[], &last);
        }
    }
}
