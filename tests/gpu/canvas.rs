//! Something to draw into by dynamic rendering, or by commands from elsewhere: what an engine has, and `host` has not.

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use hullform::gpu::Buffer;

use crate::common::gpu::{Gpu, SIDE};

pub const COLOUR: vk::Format = vk::Format::R8G8B8A8_UNORM;
pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// A colour and a depth image of [`SIDE`], in layers, and a buffer for either.
pub struct Canvas<'a> {
    gpu: &'a Gpu,
    samples: vk::SampleCountFlags,
    layers: u32,
    /// Colour, depth, and with several samples the resolved colour.
    images: Vec<Image>,
    copied: Option<Buffer>,
    /// For the render pass of the tests' own target, where there is one sample.
    framebuffer: vk::Framebuffer,
}

struct Image {
    raw: vk::Image,
    view: vk::ImageView,
    memory: Option<Allocation>,
}

/// Of what a picture is made.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Part {
    Colour,
    Depth,
}

impl<'a> Canvas<'a> {
    pub fn new(gpu: &'a Gpu, samples: vk::SampleCountFlags, layers: u32) -> Canvas<'a> {
        use vk::ImageUsageFlags as Usage;
        let mut canvas = Canvas {
            gpu,
            samples,
            layers,
            images: Vec::new(),
            copied: None,
            framebuffer: vk::Framebuffer::null(),
        };
        let one = vk::SampleCountFlags::TYPE_1;
        let colour = Usage::COLOR_ATTACHMENT | Usage::TRANSFER_SRC;
        let depth = Usage::DEPTH_STENCIL_ATTACHMENT | Usage::TRANSFER_SRC;
        canvas.add(COLOUR, samples, colour);
        canvas.add(DEPTH, samples, depth);
        canvas.add(COLOUR, one, colour);
        let device = gpu.device.raw();
        let size = u64::from(SIDE * SIDE * 4 * layers);
        let usage = vk::BufferUsageFlags::TRANSFER_DST;
        let allocator = &mut gpu.device.allocator();
        let location = MemoryLocation::GpuToCpu;
        // SAFETY: device and allocator belong together.
        let copied = unsafe { Buffer::new(device, allocator, "copied", size, usage, location) };
        canvas.copied = Some(copied.expect("it is small"));
        canvas
    }

    fn add(
        &mut self,
        format: vk::Format,
        samples: vk::SampleCountFlags,
        usage: vk::ImageUsageFlags,
    ) {
        let device = self.gpu.device.raw();
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D {
                width: SIDE,
                height: SIDE,
                depth: 1,
            })
            .mip_levels(1)
            .array_layers(self.layers)
            .samples(samples)
            .usage(usage);
        // SAFETY: all of one live device; the memory is what the image asks for.
        unsafe {
            let raw = device.create_image(&info, None).expect("it is small");
            let request = AllocationCreateDesc {
                name: "canvas",
                requirements: device.get_image_memory_requirements(raw),
                location: MemoryLocation::GpuOnly,
                linear: false,
                allocation_scheme: AllocationScheme::GpuAllocatorManaged,
            };
            let memory = self.gpu.device.allocator().allocate(&request);
            let memory = memory.expect("it is small");
            let bound = device.bind_image_memory(raw, memory.memory(), memory.offset());
            bound.expect("it was just made");
            let kind = match self.layers {
                1 => vk::ImageViewType::TYPE_2D,
                _ => vk::ImageViewType::TYPE_2D_ARRAY,
            };
            let info = vk::ImageViewCreateInfo::default()
                .image(raw)
                .view_type(kind)
                .format(format)
                .subresource_range(range(format, self.layers));
            let view = device.create_image_view(&info, None).expect("as above");
            self.images.push(Image {
                raw,
                view,
                memory: Some(memory),
            });
        }
    }

    /// Begins dynamic rendering with colours, or with depths alone, that become `clear`.
    ///
    /// # Safety
    /// `cmd` is recording on the device, outside of rendering.
    pub unsafe fn begin(
        &self,
        cmd: vk::CommandBuffer,
        parts: &[Part],
        clear: f32,
        view_mask: u32,
        flags: vk::RenderingFlags,
    ) {
        let device = self.gpu.device.raw();
        let depth_layout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
        let layouts = [vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, depth_layout];
        for (image, layout) in [(0, layouts[0]), (1, layouts[1]), (2, layouts[0])] {
            // SAFETY: this function's contract.
            unsafe { self.cmd_turn(cmd, image, vk::ImageLayout::UNDEFINED, layout) };
        }
        let attachment = |image: usize, clear_value| {
            vk::RenderingAttachmentInfo::default()
                .image_view(self.images[image].view)
                .image_layout(layouts[image])
                .load_op(vk::AttachmentLoadOp::CLEAR)
                .store_op(vk::AttachmentStoreOp::STORE)
                .clear_value(clear_value)
        };
        let mut colour = attachment(0, vk::ClearValue::default());
        if self.samples != vk::SampleCountFlags::TYPE_1 {
            colour = colour
                .resolve_mode(vk::ResolveModeFlags::AVERAGE)
                .resolve_image_view(self.images[2].view)
                .resolve_image_layout(layouts[0]);
        }
        let colours = [colour];
        let depth_stencil = vk::ClearDepthStencilValue {
            depth: clear,
            stencil: 0,
        };
        let depth = attachment(1, vk::ClearValue { depth_stencil });
        let area = area();
        let mut info = vk::RenderingInfo::default()
            .flags(flags)
            .render_area(area)
            .layer_count(1)
            .view_mask(view_mask)
            .depth_attachment(&depth);
        if parts.contains(&Part::Colour) {
            info = info.color_attachments(&colours);
        }
        // SAFETY: this function's contract; the images are in these layouts.
        unsafe {
            device.cmd_begin_rendering(cmd, &info);
            if flags.is_empty() {
                self.cmd_look(cmd);
            }
        }
    }

    /// Viewport and scissor.
    ///
    /// # Safety
    /// `cmd` is recording on the device.
    pub unsafe fn cmd_look(&self, cmd: vk::CommandBuffer) {
        let device = self.gpu.device.raw();
        let viewport = vk::Viewport::default()
            .width(SIDE as f32)
            .height(SIDE as f32)
            .max_depth(1.0);
        // SAFETY: this function's contract.
        unsafe {
            device.cmd_set_viewport(cmd, 0, &[viewport]);
            device.cmd_set_scissor(cmd, 0, &[area()]);
        }
    }

    /// Ends rendering and copies a part.
    ///
    /// # Safety
    /// `cmd` is recording on the device, inside what [`begin`](Self::begin) began.
    pub unsafe fn end(&self, cmd: vk::CommandBuffer, part: Part) {
        // SAFETY: this function's contract.
        unsafe {
            self.gpu.device.raw().cmd_end_rendering(cmd);
            self.cmd_copy(cmd, part, None);
        }
    }

    /// # Safety
    /// `cmd` is recording on the device, outside of rendering; the image is in this layout, or in that of its rendering.
    unsafe fn cmd_copy(&self, cmd: vk::CommandBuffer, part: Part, layout: Option<vk::ImageLayout>) {
        let device = self.gpu.device.raw();
        let several = self.samples != vk::SampleCountFlags::TYPE_1;
        let (image, format, from) = match (part, several) {
            (Part::Colour, false) => (0, COLOUR, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL),
            (Part::Colour, true) => (2, COLOUR, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL),
            (Part::Depth, _) => (1, DEPTH, vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL),
        };
        let to = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        let range = range(format, self.layers);
        let region = vk::BufferImageCopy::default()
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: range.aspect_mask,
                mip_level: 0,
                base_array_layer: 0,
                layer_count: self.layers,
            })
            .image_extent(vk::Extent3D {
                width: SIDE,
                height: SIDE,
                depth: 1,
            });
        let visible = [vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ)];
        // SAFETY: this function's contract.
        unsafe {
            if layout != Some(to) {
                self.cmd_turn(cmd, image, layout.unwrap_or(from), to);
            }
            let raw = self.images[image].raw;
            device.cmd_copy_image_to_buffer(cmd, raw, to, self.copied().raw(), &[region]);
            device.cmd_pipeline_barrier(
                cmd,
                vk::PipelineStageFlags::TRANSFER,
                vk::PipelineStageFlags::HOST,
                vk::DependencyFlags::empty(),
                &visible,
                &[],
                &[],
            );
        }
    }

    /// # Safety
    /// As [`cmd_copy`](Self::cmd_copy).
    unsafe fn cmd_turn(
        &self,
        cmd: vk::CommandBuffer,
        image: usize,
        from: vk::ImageLayout,
        to: vk::ImageLayout,
    ) {
        let format = if image == 1 { DEPTH } else { COLOUR };
        let every = vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE;
        let barrier = vk::ImageMemoryBarrier::default()
            .src_access_mask(every)
            .dst_access_mask(every)
            .old_layout(from)
            .new_layout(to)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(self.images[image].raw)
            .subresource_range(range(format, self.layers));
        let all = vk::PipelineStageFlags::ALL_COMMANDS;
        let device = self.gpu.device.raw();
        // SAFETY: this function's contract.
        unsafe {
            let none = vk::DependencyFlags::empty();
            device.cmd_pipeline_barrier(cmd, all, all, none, &[], &[], &[barrier]);
        }
    }

    /// Begins the render pass of the tests' own target, for secondary command buffers.
    ///
    /// # Safety
    /// As [`begin`](Self::begin).
    pub unsafe fn begin_pass(&mut self, cmd: vk::CommandBuffer) -> vk::Framebuffer {
        let device = self.gpu.device.raw();
        let render_pass = self.gpu.target().render_pass();
        let views = [self.images[0].view, self.images[1].view];
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(render_pass)
            .attachments(&views)
            .width(SIDE)
            .height(SIDE)
            .layers(1);
        let depth_stencil = vk::ClearDepthStencilValue {
            depth: 1.0,
            stencil: 0,
        };
        let clears = [vk::ClearValue::default(), vk::ClearValue { depth_stencil }];
        // SAFETY: this function's contract; the formats are those of that target.
        unsafe {
            let made = device.create_framebuffer(&info, None);
            self.framebuffer = made.expect("the formats are those of the pass");
            let begin = vk::RenderPassBeginInfo::default()
                .render_pass(render_pass)
                .framebuffer(self.framebuffer)
                .render_area(area())
                .clear_values(&clears);
            let contents = vk::SubpassContents::SECONDARY_COMMAND_BUFFERS;
            device.cmd_begin_render_pass(cmd, &begin, contents);
        }
        self.framebuffer
    }

    /// Ends it and copies the colours.
    ///
    /// # Safety
    /// `cmd` is recording on the device, inside what [`begin_pass`](Self::begin_pass) began.
    pub unsafe fn end_pass(&self, cmd: vk::CommandBuffer) {
        let left = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        // SAFETY: this function's contract.
        unsafe {
            self.gpu.device.raw().cmd_end_render_pass(cmd);
            self.cmd_copy(cmd, Part::Colour, Some(left));
        }
    }

    fn copied(&self) -> &Buffer {
        self.copied.as_ref().expect("there from new to drop")
    }

    /// What was copied last, a layer after the other.
    pub fn pixels(&self) -> Vec<u8> {
        self.copied().bytes().to_vec()
    }

    /// The same as depths.
    pub fn depths(&self) -> Vec<f32> {
        let words = self.copied().bytes().chunks(4);
        words
            .map(|word| f32::from_ne_bytes([word[0], word[1], word[2], word[3]]))
            .collect()
    }
}

impl Drop for Canvas<'_> {
    fn drop(&mut self) {
        let device = self.gpu.device.raw();
        let mut allocator = self.gpu.device.allocator();
        // SAFETY: every submission has been waited for.
        unsafe {
            device.destroy_framebuffer(self.framebuffer, None);
            for image in self.images.drain(..) {
                device.destroy_image_view(image.view, None);
                device.destroy_image(image.raw, None);
                if let Some(memory) = image.memory {
                    allocator.free(memory).expect("it is the allocator's");
                }
            }
            if let Some(copied) = self.copied.take() {
                copied.destroy(device, &mut allocator);
            }
        }
    }
}

fn area() -> vk::Rect2D {
    vk::Rect2D::default().extent(vk::Extent2D {
        width: SIDE,
        height: SIDE,
    })
}

fn range(format: vk::Format, layers: u32) -> vk::ImageSubresourceRange {
    let aspect_mask = match format {
        DEPTH => vk::ImageAspectFlags::DEPTH,
        _ => vk::ImageAspectFlags::COLOR,
    };
    vk::ImageSubresourceRange {
        aspect_mask,
        base_mip_level: 0,
        level_count: 1,
        base_array_layer: 0,
        layer_count: layers,
    }
}
