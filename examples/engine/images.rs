//! What is drawn into: a picture with several samples and its depths, and a shadow map.

use std::error::Error;

use ash::vk;
use gpu_allocator::MemoryLocation;
use hullform::gpu::Buffer;

use crate::gpu::{Gpu, Held};
use crate::image::{Image, extent, image, range, write_png};

pub const WIDTH: u32 = 960;
pub const HEIGHT: u32 = 540;
pub const SHADOWS: u32 = 2048;
pub const SAMPLES: vk::SampleCountFlags = vk::SampleCountFlags::TYPE_4;
pub const COLOUR: vk::Format = vk::Format::R8G8B8A8_SRGB;
pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;
pub const SHADOW: vk::Format = vk::Format::D16_UNORM;

/// All images; both frames in flight use them, one after the other.
pub struct Images<'g> {
    gpu: &'g Gpu,
    colour: Held<'g, Image>,
    resolved: Held<'g, Image>,
    depth: Held<'g, Image>,
    pub shadow: Held<'g, Image>,
    pixels: Held<'g, Buffer>,
}

/// A use of an image: stage, access and layout.
type Use = (vk::PipelineStageFlags, vk::AccessFlags, vk::ImageLayout);

const TESTS: vk::PipelineStageFlags = vk::PipelineStageFlags::from_raw(
    vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS.as_raw()
        | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS.as_raw(),
);
const DEPTHS: vk::AccessFlags = vk::AccessFlags::from_raw(
    vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ.as_raw()
        | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
);
const TESTED: Use = (
    TESTS,
    DEPTHS,
    vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
);
const DRAWN: Use = (
    vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT,
    vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
    vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
);
const SAMPLED: Use = (
    vk::PipelineStageFlags::FRAGMENT_SHADER,
    vk::AccessFlags::SHADER_READ,
    vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL,
);
const COPIED: Use = (
    vk::PipelineStageFlags::TRANSFER,
    vk::AccessFlags::TRANSFER_READ,
    vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
);

impl<'g> Images<'g> {
    pub fn new(gpu: &'g Gpu) -> Result<Images<'g>, Box<dyn Error>> {
        use vk::ImageUsageFlags as Usage;
        let one = vk::SampleCountFlags::TYPE_1;
        let size = [WIDTH, HEIGHT];
        let (colour, depth) = (Usage::COLOR_ATTACHMENT, Usage::DEPTH_STENCIL_ATTACHMENT);
        Ok(Images {
            gpu,
            colour: image(gpu, COLOUR, size, SAMPLES, colour)?,
            resolved: image(gpu, COLOUR, size, one, colour | Usage::TRANSFER_SRC)?,
            depth: image(gpu, DEPTH, size, SAMPLES, depth)?,
            shadow: image(gpu, SHADOW, [SHADOWS; 2], one, depth | Usage::SAMPLED)?,
            pixels: gpu.buffer(
                "pixels",
                u64::from(WIDTH * HEIGHT * 4),
                vk::BufferUsageFlags::TRANSFER_DST,
                MemoryLocation::GpuToCpu,
            )?,
        })
    }

    /// Begins the shadow map.
    ///
    /// # Safety
    /// `cmd` is recording on the device, outside of rendering. So it is for all that follow, or inside of what the one before began.
    pub unsafe fn begin_shadows(&self, cmd: vk::CommandBuffer) {
        let depth = depth_attachment(self.shadow.view, 1.0);
        // SAFETY: this function's contract. The frame before has sampled the map.
        unsafe {
            self.cmd_turn(cmd, &self.shadow, undefined(SAMPLED), TESTED);
            self.begin(cmd, [SHADOWS; 2], &[], &depth);
        }
    }

    /// Ends the shadow map and begins the pre-pass, depths alone; they are reversed.
    ///
    /// # Safety
    /// As [`begin_shadows`](Self::begin_shadows).
    pub unsafe fn begin_depths(&self, cmd: vk::CommandBuffer) {
        let depth = depth_attachment(self.depth.view, 0.0);
        // SAFETY: this function's contract.
        unsafe {
            self.gpu.device.cmd_end_rendering(cmd);
            self.cmd_turn(cmd, &self.shadow, TESTED, SAMPLED);
            self.cmd_turn(cmd, &self.depth, undefined(TESTED), TESTED);
            self.begin(cmd, [WIDTH, HEIGHT], &[], &depth);
        }
    }

    /// Ends the pre-pass and begins the picture over its depths.
    ///
    /// # Safety
    /// As [`begin_shadows`](Self::begin_shadows).
    pub unsafe fn begin_picture(&self, cmd: vk::CommandBuffer, sky: [f32; 4]) {
        let depth = depth_attachment(self.depth.view, 0.0).load_op(vk::AttachmentLoadOp::LOAD);
        let color = vk::ClearColorValue { float32: sky };
        let colours = [vk::RenderingAttachmentInfo::default()
            .image_view(self.colour.view)
            .image_layout(DRAWN.2)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::DONT_CARE)
            .clear_value(vk::ClearValue { color })
            .resolve_mode(vk::ResolveModeFlags::AVERAGE)
            .resolve_image_view(self.resolved.view)
            .resolve_image_layout(DRAWN.2)];
        // SAFETY: this function's contract.
        unsafe {
            self.gpu.device.cmd_end_rendering(cmd);
            self.cmd_turn(cmd, &self.depth, TESTED, TESTED);
            self.cmd_turn(cmd, &self.colour, undefined(DRAWN), DRAWN);
            self.cmd_turn(cmd, &self.resolved, undefined(DRAWN), DRAWN);
            self.begin(cmd, [WIDTH, HEIGHT], &colours, &depth);
        }
    }

    /// Ends the picture. An engine with a window would present it.
    ///
    /// # Safety
    /// As [`begin_shadows`](Self::begin_shadows).
    pub unsafe fn end(&self, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe { self.gpu.device.cmd_end_rendering(cmd) };
    }

    /// Copies the picture to where the host sees it.
    ///
    /// # Safety
    /// `cmd` is recording on the device, outside of rendering, after [`end`](Self::end).
    pub unsafe fn cmd_copy(&self, cmd: vk::CommandBuffer) {
        let copy = vk::BufferImageCopy::default()
            .image_subresource(
                vk::ImageSubresourceLayers::default()
                    .aspect_mask(vk::ImageAspectFlags::COLOR)
                    .layer_count(1),
            )
            .image_extent(extent([WIDTH, HEIGHT]));
        let visible = [vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ)];
        let (transfer, host) = (COPIED.0, vk::PipelineStageFlags::HOST);
        let (none, device) = (vk::DependencyFlags::empty(), &self.gpu.device);
        // SAFETY: this function's contract.
        unsafe {
            self.cmd_turn(cmd, &self.resolved, DRAWN, COPIED);
            let (from, to) = (self.resolved.raw, self.pixels.raw());
            device.cmd_copy_image_to_buffer(cmd, from, COPIED.2, to, &[copy]);
            device.cmd_pipeline_barrier(cmd, transfer, host, none, &visible, &[], &[]);
        }
    }

    /// Writes what was copied to a file.
    pub fn write_png(&self, path: &str) -> Result<(), Box<dyn Error>> {
        write_png(path, WIDTH, self.pixels.bytes())
    }

    /// # Safety
    /// As [`begin_shadows`](Self::begin_shadows).
    unsafe fn begin(
        &self,
        cmd: vk::CommandBuffer,
        size: [u32; 2],
        colours: &[vk::RenderingAttachmentInfo<'_>],
        depth: &vk::RenderingAttachmentInfo<'_>,
    ) {
        let [width, height] = size;
        let area = vk::Rect2D::default().extent(vk::Extent2D { width, height });
        let info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(colours)
            .depth_attachment(depth);
        let viewport = vk::Viewport::default()
            .width(width as f32)
            .height(height as f32)
            .max_depth(1.0);
        let device = &self.gpu.device;
        // SAFETY: this function's contract. Viewport and scissor are dynamic states of hullform's pipelines.
        unsafe {
            device.cmd_begin_rendering(cmd, &info);
            device.cmd_set_viewport(cmd, 0, &[viewport]);
            device.cmd_set_scissor(cmd, 0, &[area]);
        }
    }

    /// # Safety
    /// `cmd` is recording on the device, outside of rendering, and the image was used so before.
    unsafe fn cmd_turn(&self, cmd: vk::CommandBuffer, image: &Image, from: Use, to: Use) {
        let barrier = vk::ImageMemoryBarrier::default()
            .src_access_mask(from.1)
            .dst_access_mask(to.1)
            .old_layout(from.2)
            .new_layout(to.2)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(image.raw)
            .subresource_range(range(to == TESTED || to == SAMPLED));
        let (none, device) = (vk::DependencyFlags::empty(), &self.gpu.device);
        // SAFETY: this function's contract.
        unsafe { device.cmd_pipeline_barrier(cmd, from.0, to.0, none, &[], &[], &[barrier]) };
    }
}

/// A use whose contents do not count any more.
fn undefined(before: Use) -> Use {
    (before.0, before.1, vk::ImageLayout::UNDEFINED)
}

fn depth_attachment(view: vk::ImageView, clear: f32) -> vk::RenderingAttachmentInfo<'static> {
    let depth_stencil = vk::ClearDepthStencilValue {
        depth: clear,
        stencil: 0,
    };
    vk::RenderingAttachmentInfo::default()
        .image_view(view)
        .image_layout(TESTED.2)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
        .clear_value(vk::ClearValue { depth_stencil })
}
