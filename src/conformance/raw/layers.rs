//! A picture with a layer a view, drawn in a multiview pass or in dynamic rendering.

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};

use super::Scope;
use super::program::Destination;
use crate::error::Result;
use crate::gpu::memory::{free, out_of_memory};
use crate::gpu::{Buffer, failed};
use crate::host::Device;

/// How a picture is drawn: views are bits, and 0 is one picture without any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawing {
    /// In a render pass of one subpass.
    Pass(u32),
    /// In dynamic rendering.
    Rendering(u32),
    /// In a render pass that itself waits for what was done before: one scope of it for another.
    Behind(Scope, Scope),
}

impl Drawing {
    /// The views that are drawn.
    pub fn views(self) -> u32 {
        match self {
            Drawing::Pass(views) | Drawing::Rendering(views) => views,
            Drawing::Behind(..) => 0,
        }
    }

    /// A layer each, also for those in between that are not drawn.
    fn layers(self) -> u32 {
        (u32::BITS - self.views().leading_zeros()).max(1)
    }
}

const FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// What the first subpass waits for.
fn outside(from: Scope, to: Scope) -> vk::SubpassDependency {
    vk::SubpassDependency::default()
        .src_subpass(vk::SUBPASS_EXTERNAL)
        .dst_subpass(0)
        .src_stage_mask(from.0)
        .src_access_mask(from.1)
        .dst_stage_mask(to.0)
        .dst_access_mask(to.1)
}

/// The whole image.
fn range(layers: u32) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange::default()
        .aspect_mask(vk::ImageAspectFlags::COLOR)
        .level_count(1)
        .layer_count(layers)
}

/// The picture, and a buffer that it is copied to.
pub(super) struct Layers {
    device: Device,
    side: u32,
    drawing: Drawing,
    image: vk::Image,
    view: vk::ImageView,
    memory: Option<Allocation>,
    /// Null in dynamic rendering.
    pass: vk::RenderPass,
    framebuffer: vk::Framebuffer,
    pixels: Option<Buffer>,
}

impl Layers {
    /// A square picture of `side` pixels a layer. The device has multiview, or dynamic rendering, where that is asked for.
    pub(super) fn new(device: &Device, side: u32, drawing: Drawing) -> Result<Layers> {
        // Null handles until made: if a step fails, what was made before it goes with `layers`.
        let mut layers = Layers {
            device: device.clone(),
            side,
            drawing,
            image: vk::Image::null(),
            view: vk::ImageView::null(),
            memory: None,
            pass: vk::RenderPass::null(),
            framebuffer: vk::Framebuffer::null(),
            pixels: None,
        };
        layers.make_image()?;
        if !matches!(drawing, Drawing::Rendering(_)) {
            layers.make_pass()?;
        }
        let size = u64::from(drawing.layers()) * layers.bytes() as u64;
        let usage = vk::BufferUsageFlags::TRANSFER_DST;
        let location = MemoryLocation::GpuToCpu;
        // SAFETY: device and allocator belong together; the usage needs no feature.
        let pixels = unsafe {
            let allocator = &mut device.allocator();
            Buffer::new(device.raw(), allocator, "layers", size, usage, location)
        };
        layers.pixels = Some(pixels?);
        Ok(layers)
    }

    /// Bytes of a layer.
    fn bytes(&self) -> usize {
        4 * (self.side * self.side) as usize
    }

    fn make_image(&mut self) -> Result<()> {
        let raw = self.device.raw();
        let layers = self.drawing.layers();
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(FORMAT)
            .extent(vk::Extent3D {
                width: self.side,
                height: self.side,
                depth: 1,
            })
            .mip_levels(1)
            .array_layers(layers)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC);
        // SAFETY: the device is live; every device draws to this format, and has as many layers as it has views.
        self.image = unsafe { raw.create_image(&info, None) }.map_err(failed("vkCreateImage"))?;
        let request = AllocationCreateDesc {
            name: "layers",
            // SAFETY: the image was just made from this device.
            requirements: unsafe { raw.get_image_memory_requirements(self.image) },
            location: MemoryLocation::GpuOnly,
            linear: false,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        };
        let memory = self.device.allocator().allocate(&request);
        let memory = self.memory.insert(memory.map_err(out_of_memory)?);
        // SAFETY: the memory is bound to nothing else and outlives the image, whose own requirements it has.
        unsafe { raw.bind_image_memory(self.image, memory.memory(), memory.offset()) }
            .map_err(failed("vkBindImageMemory"))?;
        let info = vk::ImageViewCreateInfo::default()
            .image(self.image)
            .view_type(vk::ImageViewType::TYPE_2D_ARRAY)
            .format(FORMAT)
            .subresource_range(range(layers));
        // SAFETY: the image is of this device and bound to memory.
        self.view =
            unsafe { raw.create_image_view(&info, None) }.map_err(failed("vkCreateImageView"))?;
        Ok(())
    }

    fn make_pass(&mut self) -> Result<()> {
        let attachments = [vk::AttachmentDescription::default()
            .format(FORMAT)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .final_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)];
        let colours = [vk::AttachmentReference {
            attachment: 0,
            layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        }];
        let subpasses = [vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&colours)];
        let dependencies = match self.drawing {
            // The second is the one that would be there without the first, between the image's new layout and its colours.
            Drawing::Behind(from, to) => {
                let output = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT;
                let colours = vk::AccessFlags::COLOR_ATTACHMENT_READ
                    | vk::AccessFlags::COLOR_ATTACHMENT_WRITE;
                vec![
                    outside(from, to),
                    outside((output, vk::AccessFlags::empty()), (output, colours)),
                ]
            }
            _ => Vec::new(),
        };
        let masks = [self.drawing.views()];
        let mut views = vk::RenderPassMultiviewCreateInfo::default().view_masks(&masks);
        let mut info = vk::RenderPassCreateInfo::default()
            .attachments(&attachments)
            .subpasses(&subpasses)
            .dependencies(&dependencies);
        if masks != [0] {
            info = info.push_next(&mut views);
        }
        let raw = self.device.raw();
        // SAFETY: the device has multiview where views are asked for.
        self.pass =
            unsafe { raw.create_render_pass(&info, None) }.map_err(failed("vkCreateRenderPass"))?;
        let attachments = [self.view];
        // With views a framebuffer has one layer (VUID-VkFramebufferCreateInfo-renderPass-02531).
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(self.pass)
            .attachments(&attachments)
            .width(self.side)
            .height(self.side)
            .layers(1);
        // SAFETY: the view is of this device, and of the pass's format.
        self.framebuffer = unsafe { raw.create_framebuffer(&info, None) }
            .map_err(failed("vkCreateFramebuffer"))?;
        Ok(())
    }

    /// What pipelines are made for.
    pub(super) fn destination(&self) -> Destination {
        match self.drawing {
            Drawing::Pass(_) | Drawing::Behind(..) => Destination::Pass(self.pass),
            Drawing::Rendering(views) => Destination::Rendering(FORMAT, views),
        }
    }

    fn area(&self) -> vk::Rect2D {
        vk::Rect2D::default().extent(vk::Extent2D {
            width: self.side,
            height: self.side,
        })
    }

    /// The viewport and the scissor: all of it.
    pub(super) fn look(&self) -> (vk::Viewport, vk::Rect2D) {
        let viewport = vk::Viewport::default()
            .width(self.side as f32)
            .height(self.side as f32)
            .max_depth(1.0);
        (viewport, self.area())
    }

    /// Begins the pass or a rendering, over black or, the latter, over what is there.
    ///
    /// # Safety
    /// `cmd` is recording on this device outside of a pass.
    pub(super) unsafe fn cmd_begin(&self, cmd: vk::CommandBuffer, anew: bool) {
        let raw = self.device.raw();
        let (viewport, scissor) = self.look();
        // SAFETY: this function's contract; pass, framebuffer and image are of this device.
        unsafe {
            match self.drawing {
                Drawing::Pass(_) | Drawing::Behind(..) => {
                    let clears = [vk::ClearValue::default()];
                    let info = vk::RenderPassBeginInfo::default()
                        .render_pass(self.pass)
                        .framebuffer(self.framebuffer)
                        .render_area(self.area())
                        .clear_values(&clears);
                    raw.cmd_begin_render_pass(cmd, &info, vk::SubpassContents::INLINE);
                }
                Drawing::Rendering(views) => self.cmd_begin_rendering(cmd, views, anew),
            }
            raw.cmd_set_viewport(cmd, 0, &[viewport]);
            raw.cmd_set_scissor(cmd, 0, &[scissor]);
        }
    }

    /// # Safety
    /// As [`cmd_begin`](Self::cmd_begin).
    unsafe fn cmd_begin_rendering(&self, cmd: vk::CommandBuffer, views: u32, anew: bool) {
        use vk::{AccessFlags as Access, ImageLayout as Layout, PipelineStageFlags as Stage};
        let drawn = Layout::COLOR_ATTACHMENT_OPTIMAL;
        let both = Access::COLOR_ATTACHMENT_READ | Access::COLOR_ATTACHMENT_WRITE;
        let colours = [vk::RenderingAttachmentInfo::default()
            .image_view(self.view)
            .image_layout(drawn)
            .load_op(if anew {
                vk::AttachmentLoadOp::CLEAR
            } else {
                vk::AttachmentLoadOp::LOAD
            })
            .store_op(vk::AttachmentStoreOp::STORE)];
        let info = vk::RenderingInfo::default()
            .render_area(self.area())
            .layer_count(1)
            .view_mask(views)
            .color_attachments(&colours);
        let from = if anew { Layout::UNDEFINED } else { drawn };
        // SAFETY: this function's contract; the barrier stands before the rendering. Vulkan 1.3, or the caller has its extension.
        unsafe {
            let output = Stage::COLOR_ATTACHMENT_OUTPUT;
            let written = Access::COLOR_ATTACHMENT_WRITE;
            self.cmd_turn(cmd, [from, drawn], (output, written), (output, both));
            self.device.raw().cmd_begin_rendering(cmd, &info);
        }
    }

    /// Ends a rendering, so that another may go on.
    ///
    /// # Safety
    /// `cmd` is recording in a rendering of this.
    pub(super) unsafe fn cmd_pause(&self, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe { self.device.raw().cmd_end_rendering(cmd) };
    }

    /// Ends the pass or the rendering, and copies the picture to the host.
    ///
    /// # Safety
    /// `cmd` is recording in a pass or a rendering of this.
    pub(super) unsafe fn cmd_end(&self, cmd: vk::CommandBuffer) {
        use vk::{AccessFlags as Access, ImageLayout as Layout, PipelineStageFlags as Stage};
        let raw = self.device.raw();
        let Some(pixels) = &self.pixels else { return };
        let layers = self.drawing.layers();
        let region = vk::BufferImageCopy::default()
            .image_subresource(
                vk::ImageSubresourceLayers::default()
                    .aspect_mask(vk::ImageAspectFlags::COLOR)
                    .layer_count(layers),
            )
            .image_extent(vk::Extent3D {
                width: self.side,
                height: self.side,
                depth: 1,
            });
        let copied = vk::MemoryBarrier::default()
            .src_access_mask(Access::TRANSFER_WRITE)
            .dst_access_mask(Access::HOST_READ);
        // SAFETY: this function's contract; the buffer holds all layers, and the barriers order drawing, copying and reading.
        unsafe {
            match self.drawing {
                Drawing::Rendering(_) => raw.cmd_end_rendering(cmd),
                _ => raw.cmd_end_render_pass(cmd),
            }
            let (drawn, copy) = (
                Layout::COLOR_ATTACHMENT_OPTIMAL,
                Layout::TRANSFER_SRC_OPTIMAL,
            );
            let output = (
                Stage::COLOR_ATTACHMENT_OUTPUT,
                Access::COLOR_ATTACHMENT_WRITE,
            );
            let read = (Stage::TRANSFER, Access::TRANSFER_READ);
            self.cmd_turn(cmd, [drawn, copy], output, read);
            raw.cmd_copy_image_to_buffer(cmd, self.image, copy, pixels.raw(), &[region]);
            let none = vk::DependencyFlags::empty();
            let (copies, host) = (Stage::TRANSFER, Stage::HOST);
            raw.cmd_pipeline_barrier(cmd, copies, host, none, &[copied], &[], &[]);
        }
    }

    /// # Safety
    /// `cmd` is recording on this device outside of a pass, and the image has the first of the layouts.
    unsafe fn cmd_turn(
        &self,
        cmd: vk::CommandBuffer,
        [from, to]: [vk::ImageLayout; 2],
        before: Scope,
        behind: Scope,
    ) {
        let barrier = [vk::ImageMemoryBarrier::default()
            .old_layout(from)
            .new_layout(to)
            .src_access_mask(before.1)
            .dst_access_mask(behind.1)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(self.image)
            .subresource_range(range(self.drawing.layers()))];
        let none = vk::DependencyFlags::empty();
        // SAFETY: this function's contract.
        unsafe {
            self.device.raw().cmd_pipeline_barrier(
                cmd,
                before.0,
                behind.0,
                none,
                &[],
                &[],
                &barrier,
            );
        }
    }

    /// The bytes of a layer, as they were copied last.
    pub(super) fn read(&self, layer: u32) -> &[u8] {
        let bytes = self.pixels.as_ref().map_or(&[][..], Buffer::bytes);
        let (first, count) = (layer as usize * self.bytes(), self.bytes());
        &bytes[first..first + count]
    }
}

impl Drop for Layers {
    fn drop(&mut self) {
        if self.device.is_hung() {
            return;
        }
        let (raw, mut allocator) = (self.device.raw(), self.device.allocator());
        // SAFETY: all of it was made from this device; each submission was waited for. Null handles are allowed.
        unsafe {
            raw.destroy_framebuffer(self.framebuffer, None);
            raw.destroy_render_pass(self.pass, None);
            raw.destroy_image_view(self.view, None);
            raw.destroy_image(self.image, None);
            if let Some(memory) = self.memory.take() {
                free(&mut allocator, memory);
            }
            if let Some(pixels) = self.pixels.take() {
                pixels.destroy(raw, &mut allocator);
            }
        }
    }
}
