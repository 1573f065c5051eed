//! What an engine has anyway: a picture to draw into, commands, a queue to submit them to, and something that destroys what was made.

use std::cell::RefCell;
use std::error::Error;
use std::ops::{Deref, DerefMut};

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme, Allocator};
use hullform::gpu::Buffer;

pub const WIDTH: u32 = 960;
pub const HEIGHT: u32 = 600;
const COLOUR: vk::Format = vk::Format::R8G8B8A8_SRGB;
const DEPTH: vk::Format = vk::Format::D16_UNORM; // the one depth format that every device has

/// Holds something, and destroys it at the end of its scope.
pub struct Own<T, F: FnOnce(T)>(Option<(T, F)>);

impl<T, F: FnOnce(T)> Own<T, F> {
    pub fn new(made: T, destroy: F) -> Own<T, F> {
        Own(Some((made, destroy)))
    }
}

impl<T, F: FnOnce(T)> Deref for Own<T, F> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0.as_ref().expect("there until it is dropped").0
    }
}

impl<T, F: FnOnce(T)> DerefMut for Own<T, F> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.0.as_mut().expect("there until it is dropped").0
    }
}

impl<T, F: FnOnce(T)> Drop for Own<T, F> {
    fn drop(&mut self) {
        if let Some((made, destroy)) = self.0.take() {
            destroy(made);
        }
    }
}

/// For `map_err`: which call failed, and how.
pub fn failed(call: &'static str) -> impl Fn(vk::Result) -> String {
    move |code| format!("{call} failed: {code:?}")
}

/// A picture of 8 bits a channel with its depths, a render pass and framebuffer to draw into it, and a buffer for the pixels. Null until made: if a step
/// fails, what was made before it goes all the same.
pub struct Picture<'a> {
    device: &'a ash::Device,
    allocator: &'a RefCell<Allocator>,
    colour: Image<'a>,
    _depth: Image<'a>,
    pub render_pass: vk::RenderPass,
    framebuffer: vk::Framebuffer,
    pixels: Option<Buffer>,
}

impl<'a> Picture<'a> {
    /// The subpass depends on itself as `wished`.
    pub fn new(
        device: &'a ash::Device,
        allocator: &'a RefCell<Allocator>,
        wished: vk::SubpassDependency,
    ) -> Result<Picture<'a>, Box<dyn Error>> {
        let colour_usage =
            vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC;
        let depth_usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let mut picture = Picture {
            device,
            allocator,
            colour: Image::new(device, allocator, COLOUR, colour_usage)?,
            _depth: Image::new(device, allocator, DEPTH, depth_usage)?,
            render_pass: vk::RenderPass::null(),
            framebuffer: vk::Framebuffer::null(),
            pixels: None,
        };
        picture.render_pass = render_pass(device, wished).map_err(failed("vkCreateRenderPass"))?;
        let views = [picture.colour.view, picture._depth.view];
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(picture.render_pass)
            .attachments(&views)
            .width(WIDTH)
            .height(HEIGHT)
            .layers(1);
        // SAFETY: the views are of the formats that the pass declares.
        let framebuffer = unsafe { device.create_framebuffer(&info, None) };
        picture.framebuffer = framebuffer.map_err(failed("vkCreateFramebuffer"))?;
        // SAFETY: device and allocator belong together.
        let pixels = unsafe {
            Buffer::new(
                device,
                &mut allocator.borrow_mut(),
                "pixels",
                u64::from(WIDTH * HEIGHT * 4),
                vk::BufferUsageFlags::TRANSFER_DST,
                MemoryLocation::GpuToCpu,
            )
        };
        picture.pixels = Some(pixels?);
        Ok(picture)
    }

    /// Begins the render pass, over the whole picture.
    pub fn begin(&self, cmd: vk::CommandBuffer) {
        let area = vk::Rect2D::default().extent(vk::Extent2D {
            width: WIDTH,
            height: HEIGHT,
        });
        let clears = clear_values();
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(self.render_pass)
            .framebuffer(self.framebuffer)
            .render_area(area)
            .clear_values(&clears);
        let viewport = vk::Viewport {
            width: WIDTH as f32,
            height: HEIGHT as f32,
            max_depth: 1.0,
            ..Default::default()
        };
        // SAFETY: recording, outside of a render pass. Viewport and scissor are dynamic states of the pipelines.
        unsafe {
            self.device
                .cmd_begin_render_pass(cmd, &begin, vk::SubpassContents::INLINE);
            self.device.cmd_set_viewport(cmd, 0, &[viewport]);
            self.device.cmd_set_scissor(cmd, 0, &[area]);
        }
    }

    /// Ends the render pass.
    pub fn end(&self, cmd: vk::CommandBuffer) {
        // SAFETY: it was begun.
        unsafe { self.device.cmd_end_render_pass(cmd) };
    }

    /// Copies the picture to where the host sees it.
    pub fn copy(&self, cmd: vk::CommandBuffer) {
        let copy = vk::BufferImageCopy::default()
            .image_subresource(
                vk::ImageSubresourceLayers::default()
                    .aspect_mask(vk::ImageAspectFlags::COLOR)
                    .layer_count(1),
            )
            .image_extent(extent());
        let source = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        let visible = [vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ)];
        let to = self.pixels.as_ref().map_or(vk::Buffer::null(), Buffer::raw);
        // SAFETY: the render pass left the picture in this layout and made it visible to the copy.
        unsafe {
            self.device
                .cmd_copy_image_to_buffer(cmd, self.colour.raw, source, to, &[copy]);
            self.device.cmd_pipeline_barrier(
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

    /// What was copied last: RGBA, rows from the top.
    pub fn pixels(&self) -> &[u8] {
        self.pixels.as_ref().map_or(&[], Buffer::bytes)
    }
}

impl Drop for Picture<'_> {
    fn drop(&mut self) {
        // SAFETY: nothing of it is in use any more; null handles are allowed.
        unsafe {
            self.device.destroy_framebuffer(self.framebuffer, None);
            self.device.destroy_render_pass(self.render_pass, None);
            if let Some(pixels) = self.pixels.take() {
                pixels.destroy(self.device, &mut self.allocator.borrow_mut());
            }
        }
    }
}

/// A command buffer that is recording, and the queue that it will go to.
pub struct Commands<'a> {
    device: &'a ash::Device,
    queue: vk::Queue,
    pool: vk::CommandPool,
    pub cmd: vk::CommandBuffer,
}

impl<'a> Commands<'a> {
    pub fn new(device: &'a ash::Device, family: u32) -> Result<Commands<'a>, String> {
        // SAFETY: the device was created with one queue of this family, here and below; the pool is ours, the command buffer new.
        unsafe {
            let mut commands = Commands {
                device,
                queue: device.get_device_queue(family, 0),
                pool: vk::CommandPool::null(),
                cmd: vk::CommandBuffer::null(),
            };
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(family);
            let pool = device.create_command_pool(&info, None);
            commands.pool = pool.map_err(failed("vkCreateCommandPool"))?;
            let info = vk::CommandBufferAllocateInfo::default()
                .command_pool(commands.pool)
                .command_buffer_count(1);
            let cmd = device.allocate_command_buffers(&info);
            commands.cmd = cmd.map_err(failed("vkAllocateCommandBuffers"))?[0];
            let once = vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT;
            let begin = vk::CommandBufferBeginInfo::default().flags(once);
            device
                .begin_command_buffer(commands.cmd, &begin)
                .map_err(failed("vkBeginCommandBuffer"))?;
            Ok(commands)
        }
    }

    /// Ends, submits and waits. From here on nothing may be destroyed that the queue may still use, and a wait that fails says nothing about the
    /// queue: so if one does, this waits once more. A lost device counts as idle (Vulkan spec, "Lost Device"). Where even this wait fails nothing is
    /// known, and the program leaves without destroying anything.
    pub fn submit(&self) -> Result<(), String> {
        let device = self.device;
        // SAFETY: it is recording, outside of a render pass.
        unsafe { device.end_command_buffer(self.cmd) }.map_err(failed("vkEndCommandBuffer"))?;
        let busy = Own::new((), |()| {
            // SAFETY: nobody else uses the device.
            match unsafe { device.device_wait_idle() } {
                Ok(()) | Err(vk::Result::ERROR_DEVICE_LOST) => {}
                Err(code) => {
                    eprintln!("headless_png: {}", failed("vkDeviceWaitIdle")(code));
                    std::process::exit(1)
                }
            }
        });
        let commands = [self.cmd];
        let submit = [vk::SubmitInfo::default().command_buffers(&commands)];
        // SAFETY: the command buffer has been ended; nobody else uses the queue.
        unsafe {
            device
                .queue_submit(self.queue, &submit, vk::Fence::null())
                .map_err(failed("vkQueueSubmit"))?;
            device
                .queue_wait_idle(self.queue)
                .map_err(failed("vkQueueWaitIdle"))?;
        }
        std::mem::forget(busy);
        Ok(())
    }
}

impl Drop for Commands<'_> {
    fn drop(&mut self) {
        // SAFETY: they were waited for; a null handle is allowed.
        unsafe { self.device.destroy_command_pool(self.pool, None) };
    }
}

/// One subpass with colour and depth, which depends on itself as `wished`.
fn render_pass(
    device: &ash::Device,
    wished: vk::SubpassDependency,
) -> Result<vk::RenderPass, vk::Result> {
    let attachment = |format, store, layout| {
        vk::AttachmentDescription::default()
            .format(format)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(store)
            .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
            .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
            .final_layout(layout)
    };
    let (colour, depth) = (
        vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
    );
    let copied = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
    let attachments = [
        attachment(COLOUR, vk::AttachmentStoreOp::STORE, copied),
        attachment(DEPTH, vk::AttachmentStoreOp::DONT_CARE, depth),
    ];
    let reference = |attachment, layout| vk::AttachmentReference { attachment, layout };
    let (colours, depth) = ([reference(0, colour)], reference(1, depth));
    let subpasses = [vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .color_attachments(&colours)
        .depth_stencil_attachment(&depth)];
    // Before: the transition from `UNDEFINED` waits with the attachments' own stages. After: the picture is there for the copy.
    let drawn = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT
        | vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS
        | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS;
    let written =
        vk::AccessFlags::COLOR_ATTACHMENT_WRITE | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE;
    let before = vk::SubpassDependency::default()
        .src_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(drawn)
        .dst_stage_mask(drawn)
        .dst_access_mask(written | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ);
    let after = vk::SubpassDependency::default()
        .dst_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(drawn)
        .src_access_mask(written)
        .dst_stage_mask(vk::PipelineStageFlags::TRANSFER)
        .dst_access_mask(vk::AccessFlags::TRANSFER_READ);
    let dependencies = [before, wished, after];
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
    // SAFETY: the device is live and can draw into both formats (Vulkan spec, "Required Format Support").
    unsafe { device.create_render_pass(&info, None) }
}

fn clear_values() -> [vk::ClearValue; 2] {
    let color = vk::ClearColorValue {
        float32: [0.02, 0.02, 0.025, 1.0],
    };
    let depth_stencil = vk::ClearDepthStencilValue {
        depth: 1.0,
        stencil: 0,
    };
    [vk::ClearValue { color }, vk::ClearValue { depth_stencil }]
}

fn extent() -> vk::Extent3D {
    vk::Extent3D {
        width: WIDTH,
        height: HEIGHT,
        depth: 1,
    }
}

/// An image with its memory and view. Null until made: if a step fails, what was made before it goes all the same.
struct Image<'a> {
    device: &'a ash::Device,
    allocator: &'a RefCell<Allocator>,
    raw: vk::Image,
    view: vk::ImageView,
    memory: Option<Allocation>,
}

impl<'a> Image<'a> {
    fn new(
        device: &'a ash::Device,
        allocator: &'a RefCell<Allocator>,
        format: vk::Format,
        usage: vk::ImageUsageFlags,
    ) -> Result<Image<'a>, Box<dyn Error>> {
        let mut image = Image {
            device,
            allocator,
            raw: vk::Image::null(),
            view: vk::ImageView::null(),
            memory: None,
        };
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(extent())
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        // SAFETY: the device is live and knows the format.
        let raw = unsafe { device.create_image(&info, None) };
        image.raw = raw.map_err(failed("vkCreateImage"))?;
        let memory = allocator.borrow_mut().allocate(&AllocationCreateDesc {
            name: "attachment",
            // SAFETY: the image is the device's.
            requirements: unsafe { device.get_image_memory_requirements(image.raw) },
            location: MemoryLocation::GpuOnly,
            linear: false,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        });
        let memory = memory.map_err(|error| format!("vkAllocateMemory failed: {error}"))?;
        let memory = image.memory.insert(memory);
        // SAFETY: the memory meets the image's requirements and is bound to nothing else.
        unsafe { device.bind_image_memory(image.raw, memory.memory(), memory.offset()) }
            .map_err(failed("vkBindImageMemory"))?;
        let aspect = match format {
            DEPTH => vk::ImageAspectFlags::DEPTH,
            _ => vk::ImageAspectFlags::COLOR,
        };
        let range = vk::ImageSubresourceRange::default()
            .aspect_mask(aspect)
            .level_count(1)
            .layer_count(1);
        let info = vk::ImageViewCreateInfo::default()
            .image(image.raw)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format)
            .subresource_range(range);
        // SAFETY: the image is bound; format and aspect are its own.
        let view = unsafe { device.create_image_view(&info, None) };
        image.view = view.map_err(failed("vkCreateImageView"))?;
        Ok(image)
    }
}

impl Drop for Image<'_> {
    fn drop(&mut self) {
        // SAFETY: see steps 2 and 8; null handles are allowed.
        unsafe {
            self.device.destroy_image_view(self.view, None);
            self.device.destroy_image(self.raw, None);
        }
        if let Some(memory) = self.memory.take() {
            let freed = self.allocator.borrow_mut().free(memory);
            freed.expect("memory goes back to the allocator it came from");
        }
    }
}

pub fn write_png(rgba: &[u8]) -> Result<(), Box<dyn Error>> {
    let file = std::io::BufWriter::new(std::fs::File::create("headless.png")?);
    let mut encoder = png::Encoder::new(file, WIDTH, HEIGHT);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgba)?;
    Ok(writer.finish()?)
}
