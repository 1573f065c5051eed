//! From a picture to the window.

use ash::vk;

use super::{Image, Swapchain};
use crate::host::{Area, OffscreenTarget};
use vk::{AccessFlags as Access, ImageLayout as Layout, PipelineStageFlags as Stage};

/// Where nothing of the picture is.
const BLACK: vk::ClearColorValue = vk::ClearColorValue {
    float32: [0.0, 0.0, 0.0, 1.0],
};

impl Swapchain {
    /// The format of pictures whose bytes windows of this one show as they are: that of its images, but such that devices encode what shaders write
    /// in linear light. For [`OffscreenTarget::with_format`].
    pub fn picture_format(&self) -> vk::Format {
        match self.format() {
            vk::Format::B8G8R8A8_UNORM => vk::Format::B8G8R8A8_SRGB,
            vk::Format::R8G8B8A8_UNORM => vk::Format::R8G8B8A8_SRGB,
            vk::Format::A8B8G8R8_UNORM_PACK32 => vk::Format::A8B8G8R8_SRGB_PACK32,
            other => other,
        }
    }

    /// Copies an area of a picture to the same place of the window, bytes as they are, black around it; None for black alone. The image is left for
    /// the display, or as what a render pass begins with: in a layout of one's own, for attachments.
    ///
    /// # Safety
    /// `cmd` is what [`frame`](Swapchain::frame) gave with `image`, outside of a render pass; `picture` has been drawn by commands that come before, is
    /// whole, of this [format](Swapchain::picture_format), and the area lies within it and the image. It lives until the frame is done.
    pub unsafe fn cmd_copy(
        &self,
        cmd: vk::CommandBuffer,
        image: Image,
        picture: Option<(&OffscreenTarget, Area)>,
        then: Layout,
    ) {
        let device = self.device().raw();
        let to = Layout::TRANSFER_DST_OPTIMAL;
        let barrier = |[old, new]: [Layout; 2], [before, after]: [Access; 2]| {
            [vk::ImageMemoryBarrier::default()
                .src_access_mask(before)
                .dst_access_mask(after)
                .old_layout(old)
                .new_layout(new)
                .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .image(image.raw)
                .subresource_range(RANGE)]
        };
        let wait = |from, to, barriers: &[vk::ImageMemoryBarrier<'_>]| {
            let none = vk::DependencyFlags::empty();
            // SAFETY: this function's contract.
            unsafe { device.cmd_pipeline_barrier(cmd, from, to, none, &[], &[], barriers) };
        };
        let write = Access::TRANSFER_WRITE;
        // With the stages that wait for the display to give the image back.
        let waited = Stage::TRANSFER | Stage::COLOR_ATTACHMENT_OUTPUT;
        let first = barrier([Layout::UNDEFINED, to], [Access::empty(), write]);
        wait(waited, Stage::TRANSFER, &first);
        // SAFETY: this function's contract; the image is in this layout.
        unsafe { device.cmd_clear_color_image(cmd, image.raw, to, &BLACK, &[RANGE]) };
        if let Some((picture, area)) = picture {
            wait(
                Stage::TRANSFER,
                Stage::TRANSFER,
                &barrier([to, to], [write, write]),
            );
            let from = Layout::TRANSFER_SRC_OPTIMAL;
            let region = region(area);
            // SAFETY: as above; passes of targets leave their pictures in this layout.
            unsafe { device.cmd_copy_image(cmd, picture.image(), from, image.raw, to, &[region]) };
        }
        let (stage, access) = match then {
            Layout::PRESENT_SRC_KHR => (Stage::BOTTOM_OF_PIPE, Access::empty()),
            _ => (
                Stage::COLOR_ATTACHMENT_OUTPUT,
                Access::COLOR_ATTACHMENT_READ | Access::COLOR_ATTACHMENT_WRITE,
            ),
        };
        wait(
            Stage::TRANSFER,
            stage,
            &barrier([to, then], [write, access]),
        );
    }
}

/// All of a swapchain's image.
const RANGE: vk::ImageSubresourceRange = vk::ImageSubresourceRange {
    aspect_mask: vk::ImageAspectFlags::COLOR,
    base_mip_level: 0,
    level_count: 1,
    base_array_layer: 0,
    layer_count: 1,
};

fn region(area: Area) -> vk::ImageCopy {
    let layers = vk::ImageSubresourceLayers::default()
        .aspect_mask(vk::ImageAspectFlags::COLOR)
        .layer_count(1);
    let offset = vk::Offset3D {
        x: area.x as i32,
        y: area.y as i32,
        z: 0,
    };
    vk::ImageCopy::default()
        .src_subresource(layers)
        .src_offset(offset)
        .dst_subresource(layers)
        .dst_offset(offset)
        .extent(area.extent().into())
}
