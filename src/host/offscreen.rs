//! A picture to draw into without a window, and to read back.

mod slices;

use crate::error::{Error, Result};
use crate::gpu::memory::free;
use crate::gpu::{Buffer, failed};
use crate::host::Device;
use crate::host::area::Area;
use crate::host::image::Image;
use crate::host::render_pass::{self, Formats, Slice};
use ash::vk;
use gpu_allocator::MemoryLocation;

/// What the bytes of a picture mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Shaders write linear light, the bytes are sRGB: for pictures that people look at.
    #[default]
    Srgb,
    /// Bytes are what shaders write, times 255: for numbers.
    Unorm,
}

impl Encoding {
    /// A format of it that every device draws to (Vulkan, "Required Format Support").
    pub fn format(self) -> vk::Format {
        match self {
            Encoding::Srgb => vk::Format::R8G8B8A8_SRGB,
            Encoding::Unorm => vk::Format::R8G8B8A8_UNORM,
        }
    }
}

/// Colour and depth images with a render pass that allows the ring barrier
/// ([`cmd_ring_barrier`](crate::gpu::ring::cmd_ring_barrier)), and a buffer that the picture is copied to.
///
/// To draw: [`begin`](Self::begin), draws, [`end`](Self::end), [`cmd_copy_to_host`](Self::cmd_copy_to_host) in one command
/// buffer; then, when that has finished, [`read_pixels`](Self::read_pixels).
pub struct OffscreenTarget {
    device: Device,
    extent: vk::Extent2D,
    /// What there are images of.
    part: Area,
    /// What is drawn of that.
    area: Area,
    formats: Formats,
    render_pass: vk::RenderPass,
    framebuffer: vk::Framebuffer,
    /// For pictures that are drawn in several passes.
    slices: Option<slices::Slices>,
    /// Colour, depth, and with several samples the resolved colour, as the render pass numbers them.
    images: Vec<Image>,
    pixels: Option<Buffer>,
}

impl OffscreenTarget {
    /// An sRGB picture of `width` x `height` with 1, 2, 4 ... `samples` a pixel.
    ///
    /// # Errors
    /// [`Error::Option`] if the device cannot hold such a picture.
    pub fn new(device: &Device, width: u32, height: u32, samples: u32) -> Result<OffscreenTarget> {
        OffscreenTarget::with_encoding(device, width, height, samples, Encoding::Srgb)
    }

    /// A picture whose bytes mean what `encoding` says.
    ///
    /// # Errors
    /// As [`OffscreenTarget::new`].
    pub fn with_encoding(
        device: &Device,
        width: u32,
        height: u32,
        samples: u32,
        encoding: Encoding,
    ) -> Result<OffscreenTarget> {
        OffscreenTarget::with_format(device, width, height, samples, encoding.format())
    }

    /// A picture in a format of 4 bytes a pixel that every device draws to (Vulkan, "Required Format Support"): `R8G8B8A8`, `B8G8R8A8` or
    /// `A8B8G8R8`, `SRGB` or `UNORM`. For copies to images of such a format.
    ///
    /// # Errors
    /// As [`OffscreenTarget::new`].
    pub fn with_format(
        device: &Device,
        width: u32,
        height: u32,
        samples: u32,
        format: vk::Format,
    ) -> Result<OffscreenTarget> {
        let whole = Area::whole([width, height]);
        OffscreenTarget::cropped(device, [width, height], whole, samples, format)
    }

    /// The same picture, of which there are images of a part alone, as after [`crop`](Self::crop).
    ///
    /// # Errors
    /// As [`OffscreenTarget::new`].
    pub fn cropped(
        device: &Device,
        [width, height]: [u32; 2],
        part: Area,
        samples: u32,
        format: vk::Format,
    ) -> Result<OffscreenTarget> {
        check_size(device.limits(), width, height)?;
        let formats = Formats {
            colour: format,
            depth: depth_format(device),
            samples: check_samples(device.limits(), samples)?,
        };
        // Null handles until made: if a step fails, what was made before it goes with `target`.
        let extent = vk::Extent2D { width, height };
        let mut target = OffscreenTarget {
            device: device.clone(),
            extent,
            part: part.within(Area::whole([width, height])),
            area: part.within(Area::whole([width, height])),
            formats,
            render_pass: vk::RenderPass::null(),
            framebuffer: vk::Framebuffer::null(),
            slices: None,
            images: Vec::new(),
            pixels: None,
        };
        // SAFETY: the device is live; formats and samples were checked against its limits.
        target.render_pass = unsafe { render_pass::create(device.raw(), formats, Slice::Whole) }?;
        target.make()?;
        Ok(target)
    }

    /// The device that it is on.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The render pass; pipelines are made for its subpass 0.
    pub fn render_pass(&self) -> vk::RenderPass {
        self.render_pass
    }

    /// The image that has the picture when the pass has ended, one sample a pixel, in the layout `TRANSFER_SRC_OPTIMAL`, to be copied by later
    /// commands of the same queue: the pass makes its writes visible to copies, and the next pass waits for these.
    pub fn image(&self) -> vk::Image {
        self.picture().raw
    }

    /// Samples a pixel, for the pipeline's multisample state.
    pub fn samples(&self) -> vk::SampleCountFlags {
        self.formats.samples
    }

    /// Width and height.
    pub fn extent(&self) -> vk::Extent2D {
        self.extent
    }

    /// The part that is drawn: at first the whole picture.
    pub fn area(&self) -> Area {
        self.area
    }

    /// Draws only a part from now on, where all that is to be seen lies: nothing else is cleared, resolved and copied, and memory beside it
    /// is not touched. What lies there has the very pixels that it has in the whole.
    pub fn confine(&mut self, area: Area) {
        self.area = area.within(self.part);
    }

    /// Makes images of a part alone, and draws that from now on; small images are cleared at once by drivers that clear parts of large ones slowly.
    /// What lies there is seen as in the whole, but for the rounding of where a vertex falls. Pipelines for the target stay what they are.
    ///
    /// # Errors
    /// Vulkan's own. Then nothing can be drawn before another call succeeds.
    pub fn crop(&mut self, part: Area) -> Result<()> {
        self.part = part.within(Area::whole([self.extent.width, self.extent.height]));
        self.area = self.part;
        self.free();
        self.make()
    }

    /// Begins the render pass: in the [`area`](Self::area) colour becomes `clear` (linear, whatever the encoding), depth 1. The viewport covers
    /// the picture and the scissor the area (for pipelines that leave them dynamic).
    ///
    /// # Safety
    /// `cmd` is recording on this target's device, outside of a render pass, and of a graphics queue.
    pub unsafe fn begin(&self, cmd: vk::CommandBuffer, clear: [f32; 4]) {
        // SAFETY: this function's contract.
        unsafe {
            self.begin_with(cmd, clear, self.whole(), vk::SubpassContents::INLINE);
            self.cmd_set_view(cmd);
        }
    }

    /// The same for draws in secondary command buffers, each of which begins with [`cmd_set_view`](Self::cmd_set_view).
    ///
    /// # Safety
    /// As [`begin`](Self::begin).
    pub unsafe fn begin_for_secondary(&self, cmd: vk::CommandBuffer, clear: [f32; 4]) {
        let contents = vk::SubpassContents::SECONDARY_COMMAND_BUFFERS;
        // SAFETY: this function's contract.
        unsafe { self.begin_with(cmd, clear, self.whole(), contents) };
    }

    /// # Safety
    /// As [`begin`](Self::begin).
    unsafe fn begin_with(
        &self,
        cmd: vk::CommandBuffer,
        clear: [f32; 4],
        (render_pass, framebuffer): (vk::RenderPass, vk::Framebuffer),
        contents: vk::SubpassContents,
    ) {
        let colour = vk::ClearColorValue { float32: clear };
        let depth = vk::ClearDepthStencilValue {
            depth: 1.0,
            stencil: 0,
        };
        let clears = [
            vk::ClearValue { color: colour },
            vk::ClearValue {
                depth_stencil: depth,
            },
        ];
        let area = self.area.rect(self.part);
        let info = vk::RenderPassBeginInfo::default()
            .render_pass(render_pass)
            .framebuffer(framebuffer)
            .render_area(area)
            .clear_values(&clears);
        // SAFETY: this function's contract; pass and framebuffer are of this device and match.
        unsafe {
            self.device
                .raw()
                .cmd_begin_render_pass(cmd, &info, contents)
        };
    }

    /// Sets the viewport and the scissor: those of [`begin`](Self::begin).
    ///
    /// # Safety
    /// `cmd` is recording on this target's device.
    pub unsafe fn cmd_set_view(&self, cmd: vk::CommandBuffer) {
        let viewport = vk::Viewport::default()
            .x(-(self.part.x as f32))
            .y(-(self.part.y as f32))
            .width(self.extent.width as f32)
            .height(self.extent.height as f32)
            .max_depth(1.0);
        let device = self.device.raw();
        // SAFETY: this function's contract.
        unsafe {
            device.cmd_set_viewport(cmd, 0, &[viewport]);
            device.cmd_set_scissor(cmd, 0, &[self.area.rect(self.part)]);
        }
    }

    /// Ends the render pass.
    ///
    /// # Safety
    /// `cmd` is recording and inside the render pass that [`OffscreenTarget::begin`] began.
    pub unsafe fn end(&self, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe { self.device.raw().cmd_end_render_pass(cmd) };
    }

    /// Copies the area to where [`OffscreenTarget::read_pixels`] finds it.
    ///
    /// # Safety
    /// `cmd` is recording on this target's device, outside of a render pass, after a pass of this target that comes earlier in
    /// the same command buffer or in one submitted before. Nobody reads the pixels before the commands have finished.
    pub unsafe fn cmd_copy_to_host(&self, cmd: vk::CommandBuffer) {
        let pixels = self.pixels().raw();
        let region = vk::BufferImageCopy::default()
            .image_subresource(
                vk::ImageSubresourceLayers::default()
                    .aspect_mask(vk::ImageAspectFlags::COLOR)
                    .layer_count(1),
            )
            .image_offset(vk::Offset3D {
                x: (self.area.x - self.part.x) as i32,
                y: (self.area.y - self.part.y) as i32,
                z: 0,
            })
            .image_extent(self.area.extent().into());
        // To the host, and to the next copy into the same buffer.
        let written = vk::BufferMemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ | vk::AccessFlags::TRANSFER_WRITE)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .buffer(pixels)
            .size(vk::WHOLE_SIZE);
        let picture = self.picture().raw;
        let device = self.device.raw();
        // SAFETY: this function's contract; the render pass leaves the picture in this layout and orders its writes before the
        // copy; the buffer holds the whole picture.
        unsafe {
            device.cmd_copy_image_to_buffer(
                cmd,
                picture,
                vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
                pixels,
                &[region],
            );
            device.cmd_pipeline_barrier(
                cmd,
                vk::PipelineStageFlags::TRANSFER,
                vk::PipelineStageFlags::HOST | vk::PipelineStageFlags::TRANSFER,
                vk::DependencyFlags::empty(),
                &[],
                &[written],
                &[],
            );
        }
    }

    /// What was copied last, the [`area`](Self::area) alone: 8 bits a channel in the format's order (RGBA, unless another was asked for), rows from the top. Unspecified before the first copy.
    pub fn read_pixels(&self) -> &[u8] {
        let Area { width, height, .. } = self.area;
        &self.pixels().bytes()[..4 * width as usize * height as usize]
    }

    fn pixels(&self) -> &Buffer {
        let pixels = self.pixels.as_ref();
        pixels.expect("a finished target has its pixel buffer")
    }

    /// The image with one sample a pixel.
    fn picture(&self) -> &Image {
        &self.images[if self.formats.resolves() { 2 } else { 0 }]
    }

    /// Images, framebuffer and pixels of the part.
    fn make(&mut self) -> Result<()> {
        self.make_images()?;
        self.make_framebuffer()?;
        self.make_pixels()
    }

    /// Gives them back.
    fn free(&mut self) {
        self.slices = None;
        let device = self.device.raw();
        let mut allocator = self.device.allocator();
        // SAFETY: all of it was made from this device; the device waits for each submission, so nothing is in use.
        unsafe {
            device.destroy_framebuffer(std::mem::take(&mut self.framebuffer), None);
            for image in self.images.drain(..) {
                device.destroy_image_view(image.view, None);
                device.destroy_image(image.raw, None);
                if let Some(allocation) = image.allocation {
                    free(&mut allocator, allocation);
                }
            }
            if let Some(pixels) = self.pixels.take() {
                pixels.destroy(device, &mut allocator);
            }
        }
    }

    fn make_images(&mut self) -> Result<()> {
        use vk::ImageUsageFlags as Usage;
        let Formats {
            colour,
            depth,
            samples,
        } = self.formats;
        let drawn = Usage::COLOR_ATTACHMENT;
        let picture = drawn | Usage::TRANSFER_SRC;
        let one = vk::SampleCountFlags::TYPE_1;
        let first = if self.formats.resolves() {
            drawn
        } else {
            picture
        };
        self.make_image("colour", colour, samples, first)?;
        self.make_image("depth", depth, samples, Usage::DEPTH_STENCIL_ATTACHMENT)?;
        if self.formats.resolves() {
            self.make_image("resolved colour", colour, one, picture)?;
        }
        Ok(())
    }

    fn make_image(
        &mut self,
        name: &str,
        format: vk::Format,
        samples: vk::SampleCountFlags,
        usage: vk::ImageUsageFlags,
    ) -> Result<()> {
        // In the list before it is complete, so that a failure leaves nothing behind.
        self.images.push(Image::default());
        let image = self.images.last_mut().expect("just pushed");
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(self.part.extent().into())
            .mip_levels(1)
            .array_layers(1)
            .samples(samples)
            .usage(usage);
        image.make(&self.device, name, &info)
    }

    fn make_framebuffer(&mut self) -> Result<()> {
        let device = self.device.raw();
        let views: Vec<_> = self.images.iter().map(|image| image.view).collect();
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(self.render_pass)
            .attachments(&views)
            .width(self.part.width)
            .height(self.part.height)
            .layers(1);
        // SAFETY: the views are of this device, in the order and of the formats that the pass declares.
        self.framebuffer = unsafe { device.create_framebuffer(&info, None) }
            .map_err(failed("vkCreateFramebuffer"))?;
        Ok(())
    }

    fn make_pixels(&mut self) -> Result<()> {
        let size = u64::from(self.part.width) * u64::from(self.part.height) * 4;
        let usage = vk::BufferUsageFlags::TRANSFER_DST;
        let location = MemoryLocation::GpuToCpu;
        let mut allocator = self.device.allocator();
        let device = self.device.raw();
        // SAFETY: device and allocator belong together; the usage needs no feature.
        let pixels =
            unsafe { Buffer::new(device, &mut allocator, "pixels", size, usage, location) };
        self.pixels = Some(pixels?);
        Ok(())
    }
}

impl Drop for OffscreenTarget {
    fn drop(&mut self) {
        if self.device.is_hung() {
            return;
        }
        self.free();
        // SAFETY: it was made from this device, and nothing is in use.
        unsafe {
            self.device
                .raw()
                .destroy_render_pass(self.render_pass, None)
        };
    }
}

fn check_size(limits: &vk::PhysicalDeviceLimits, width: u32, height: u32) -> Result<()> {
    let widest = limits
        .max_framebuffer_width
        .min(limits.max_image_dimension2_d);
    let tallest = limits
        .max_framebuffer_height
        .min(limits.max_image_dimension2_d);
    if (1..=widest).contains(&width) && (1..=tallest).contains(&height) {
        return Ok(());
    }
    Err(Error::Option {
        option: "size",
        problem: format!("this device cannot hold a picture of {width}x{height}"),
        remedy: format!("choose one from 1x1 to {widest}x{tallest}"),
    })
}

fn check_samples(limits: &vk::PhysicalDeviceLimits, samples: u32) -> Result<vk::SampleCountFlags> {
    let possible = limits.framebuffer_color_sample_counts & limits.framebuffer_depth_sample_counts;
    // VkSampleCountFlagBits: the bit's value is the number of samples.
    let asked = vk::SampleCountFlags::from_raw(samples);
    if samples.is_power_of_two() && possible.contains(asked) {
        return Ok(asked);
    }
    let able = (0..7).map(|bit| 1 << bit);
    let able = able.filter(|&count| possible.contains(vk::SampleCountFlags::from_raw(count)));
    let able: Vec<_> = able.map(|count: u32| count.to_string()).collect();
    Err(Error::Option {
        option: "samples",
        problem: format!("this device cannot take {samples} samples a pixel"),
        remedy: format!("choose one of {}", able.join(", ")),
    })
}

/// 32-bit depth, or 24-bit where that is all there is: every device has one of the two.
fn depth_format(device: &Device) -> vk::Format {
    let instance = device.instance().raw();
    let format = vk::Format::D32_SFLOAT;
    // SAFETY: the physical device belongs to this live instance.
    let properties =
        unsafe { instance.get_physical_device_format_properties(device.info().physical, format) };
    let needed = vk::FormatFeatureFlags::DEPTH_STENCIL_ATTACHMENT;
    if properties.optimal_tiling_features.contains(needed) {
        format
    } else {
        vk::Format::X8_D24_UNORM_PACK32
    }
}
