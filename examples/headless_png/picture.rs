//! A picture with its depths to draw into, and a buffer for its pixels: what an engine has anyway.

use std::error::Error;

use ash::vk;
use gpu_allocator::MemoryLocation;
use hullform::gpu::{Attachments, Buffer};

use crate::gpu::{Gpu, Held};
use crate::image::{Image, extent, image, range, write_png};

pub const WIDTH: u32 = 960;
pub const HEIGHT: u32 = 600;

/// What pipelines draw into.
pub const ATTACHMENTS: Attachments<'static> = Attachments::Dynamic {
    colours: &[vk::Format::R8G8B8A8_SRGB],
    depth: vk::Format::D16_UNORM, // the one depth format that every device has
    stencil: vk::Format::UNDEFINED,
};

pub struct Picture<'g> {
    gpu: &'g Gpu,
    colour: Held<'g, Image>,
    depth: Held<'g, Image>,
    pixels: Held<'g, Buffer>,
}

impl<'g> Picture<'g> {
    pub fn new(gpu: &'g Gpu) -> Result<Picture<'g>, Box<dyn Error>> {
        use vk::ImageUsageFlags as Usage;
        let (size, one) = ([WIDTH, HEIGHT], vk::SampleCountFlags::TYPE_1);
        let (colour, copied) = (vk::Format::R8G8B8A8_SRGB, Usage::TRANSFER_SRC);
        let (depth, tested) = (vk::Format::D16_UNORM, Usage::DEPTH_STENCIL_ATTACHMENT);
        let bytes = u64::from(WIDTH * HEIGHT * 4);
        let (to, location) = (vk::BufferUsageFlags::TRANSFER_DST, MemoryLocation::GpuToCpu);
        Ok(Picture {
            gpu,
            colour: image(gpu, colour, size, one, Usage::COLOR_ATTACHMENT | copied)?,
            depth: image(gpu, depth, size, one, tested)?,
            pixels: gpu.buffer("pixels", bytes, to, location)?,
        })
    }

    /// Begins rendering, over the whole picture.
    ///
    /// # Safety
    /// `cmd` is recording on the device, outside of rendering.
    pub unsafe fn begin(&self, cmd: vk::CommandBuffer) {
        let float32 = [0.02, 0.02, 0.025, 1.0];
        let (depth, stencil) = (1.0, 0);
        let colours = [attachment(&self.colour, DRAWN).clear_value(vk::ClearValue {
            color: vk::ClearColorValue { float32 },
        })];
        let depth = attachment(&self.depth, TESTED).clear_value(vk::ClearValue {
            depth_stencil: vk::ClearDepthStencilValue { depth, stencil },
        });
        let (width, height) = (WIDTH, HEIGHT);
        let area = vk::Rect2D::default().extent(vk::Extent2D { width, height });
        let info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&colours)
            .depth_attachment(&depth);
        let viewport = vk::Viewport::default()
            .width(WIDTH as f32)
            .height(HEIGHT as f32)
            .max_depth(1.0);
        let device = &self.gpu.device;
        // SAFETY: this function's contract. Viewport and scissor are dynamic states of the pipelines.
        unsafe {
            self.cmd_turn(cmd, &self.colour, vk::ImageLayout::UNDEFINED, DRAWN);
            self.cmd_turn(cmd, &self.depth, vk::ImageLayout::UNDEFINED, TESTED);
            device.cmd_begin_rendering(cmd, &info);
            device.cmd_set_viewport(cmd, 0, &[viewport]);
            device.cmd_set_scissor(cmd, 0, &[area]);
        }
    }

    /// Ends rendering, and copies the picture to where the host sees it.
    ///
    /// # Safety
    /// `cmd` is recording on the device, inside what [`begin`](Self::begin) began.
    pub unsafe fn end(&self, cmd: vk::CommandBuffer) {
        let layers = vk::ImageSubresourceLayers::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .layer_count(1);
        let copy = vk::BufferImageCopy::default()
            .image_subresource(layers)
            .image_extent(extent([WIDTH, HEIGHT]));
        let visible = [vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ)];
        let (transfer, host) = (
            vk::PipelineStageFlags::TRANSFER,
            vk::PipelineStageFlags::HOST,
        );
        let (device, none) = (&self.gpu.device, vk::DependencyFlags::empty());
        let (from, to) = (self.colour.raw, self.pixels.raw());
        // SAFETY: this function's contract.
        unsafe {
            device.cmd_end_rendering(cmd);
            self.cmd_turn(cmd, &self.colour, DRAWN, COPIED);
            device.cmd_copy_image_to_buffer(cmd, from, COPIED, to, &[copy]);
            device.cmd_pipeline_barrier(cmd, transfer, host, none, &visible, &[], &[]);
        }
    }

    /// Writes what was copied.
    pub fn write(&self, path: &str) -> Result<(), Box<dyn Error>> {
        write_png(path, WIDTH, self.pixels.bytes())
    }

    /// A single picture waits for all of it: an engine with more to do names stages.
    ///
    /// # Safety
    /// `cmd` is recording on the device, outside of rendering, and the image is in the first layout.
    unsafe fn cmd_turn(
        &self,
        cmd: vk::CommandBuffer,
        image: &Image,
        from: vk::ImageLayout,
        to: vk::ImageLayout,
    ) {
        let every = vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE;
        let barrier = vk::ImageMemoryBarrier::default()
            .src_access_mask(every)
            .dst_access_mask(every)
            .old_layout(from)
            .new_layout(to)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(image.raw)
            .subresource_range(range(to == TESTED));
        let all = vk::PipelineStageFlags::ALL_COMMANDS;
        let (device, none) = (&self.gpu.device, vk::DependencyFlags::empty());
        // SAFETY: this function's contract.
        unsafe { device.cmd_pipeline_barrier(cmd, all, all, none, &[], &[], &[barrier]) };
    }
}

const DRAWN: vk::ImageLayout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
const TESTED: vk::ImageLayout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
const COPIED: vk::ImageLayout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;

fn attachment(image: &Image, layout: vk::ImageLayout) -> vk::RenderingAttachmentInfo<'static> {
    vk::RenderingAttachmentInfo::default()
        .image_view(image.view)
        .image_layout(layout)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
}
