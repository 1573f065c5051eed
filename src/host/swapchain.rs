//! Pictures in a window: a surface, and the swapchain that shows what is drawn, one frame after the other.

mod choice;
mod copy;
mod end;
mod frame;
mod renew;
mod surface;

use std::time::Duration;

use ash::{khr, vk};

use crate::error::Result;
use crate::gpu::failed;
use crate::host::Device;
use choice::{extent, usage};
use renew::format;

pub use choice::Pacing;
pub use frame::{Image, Shown};
pub use surface::WindowSurface;

/// How long [`Swapchain::wait`] waits: as [`Device::submit`].
const PATIENCE: Duration = Duration::from_secs(300);

/// The images of a window, and what it takes to draw them one at a time: a frame is recorded when the one before it is done, so whatever it uses
/// may be written by the host without a copy a frame. The host never waits for it: [`Swapchain::frame`] says when it is too early.
///
/// Not dropped before everything that its frames use; it waits for the last of them.
pub struct Swapchain {
    device: Device,
    functions: khr::swapchain::Device,
    format: vk::SurfaceFormatKHR,
    pacing: Pacing,
    mode: vk::PresentModeKHR,
    extent: vk::Extent2D,
    /// Null while the window has no area.
    raw: vk::SwapchainKHR,
    images: Vec<(vk::Image, vk::ImageView)>,
    /// Whether images can be copied elsewhere.
    readable: bool,
    /// Whether the images must be made anew before the next frame.
    stale: bool,
    pool: vk::CommandPool,
    cmd: vk::CommandBuffer,
    /// Signalled when no frame is in flight.
    fence: vk::Fence,
    acquired: vk::Semaphore,
    /// One an image: it is waited for by the display, of whose end nothing tells but the image's return.
    drawn: Vec<vk::Semaphore>,
    surface: WindowSurface,
}

impl Swapchain {
    /// The swapchain of a window of this size in pixels (where the window system does not know better).
    ///
    /// # Errors
    /// [`Error::NoDisplay`](crate::Error::NoDisplay) when none of the window's formats has 8 bits a channel and sRGB's colours; Vulkan's own.
    pub fn new(
        device: &Device,
        surface: WindowSurface,
        size: [u32; 2],
        pacing: Pacing,
    ) -> Result<Swapchain> {
        let mut swapchain = Swapchain {
            functions: khr::swapchain::Device::new(device.instance().raw(), device.raw()),
            format: format(device, &surface)?,
            pacing,
            mode: vk::PresentModeKHR::FIFO,
            extent: vk::Extent2D::default(),
            raw: vk::SwapchainKHR::null(),
            images: Vec::new(),
            readable: false,
            stale: true,
            pool: vk::CommandPool::null(),
            cmd: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            acquired: vk::Semaphore::null(),
            drawn: Vec::new(),
            surface,
            device: device.clone(),
        };
        swapchain.make_commands()?;
        swapchain.resize(size)?;
        Ok(swapchain)
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The format of the images: 8 bits a channel, which are sRGB's as they are (`UNORM`: shaders write encoded colours) unless the window
    /// has only formats that encode (`SRGB`: shaders write linear light).
    pub fn format(&self) -> vk::Format {
        self.format.format
    }

    /// The size of the images in pixels; zero while the window has no area.
    pub fn extent(&self) -> vk::Extent2D {
        self.extent
    }

    /// Views of all images, for framebuffers; others after each [`resize`](Self::resize).
    pub fn views(&self) -> impl ExactSizeIterator<Item = vk::ImageView> + '_ {
        self.images.iter().map(|&(_, view)| view)
    }

    /// How pictures follow one another, as the device can.
    pub fn mode(&self) -> vk::PresentModeKHR {
        self.mode
    }

    /// Changes how pictures follow one another, from the next [`resize`](Self::resize) on.
    pub fn pace(&mut self, pacing: Pacing) {
        self.stale |= self.pacing != pacing;
        self.pacing = pacing;
    }

    /// Whether the images no longer suit the window, so that [`resize`](Self::resize) is due.
    pub fn is_stale(&self) -> bool {
        self.stale
    }

    /// Whether the last frame is still drawn.
    ///
    /// # Errors
    /// Vulkan's own, a device that was lost among them.
    pub fn is_busy(&self) -> Result<bool> {
        // SAFETY: the fence is of this device.
        let done = unsafe { self.device.raw().get_fence_status(self.fence) };
        done.map(|done| !done).map_err(failed("vkGetFenceStatus"))
    }

    /// Waits until the last frame is done.
    ///
    /// # Errors
    /// Vulkan's own.
    pub fn wait(&self) -> Result<()> {
        let waited = self.device.wait(self.fence, PATIENCE);
        waited.map_err(|unfinished| unfinished.error)
    }

    /// Makes the images anew for a window of this size in pixels, after the last frame. What was made of the old images is of no use afterwards,
    /// and must not be destroyed later than this: framebuffers go first.
    ///
    /// # Errors
    /// [`Error::SurfaceLost`](crate::Error::SurfaceLost), after which [`renew`](Self::renew) is due; Vulkan's own.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<()> {
        self.wait()?;
        // Whatever fails below, it is due again.
        self.stale = true;
        let physical = self.device.info().physical;
        let (functions, surface) = (&self.surface.functions, self.surface.raw);
        // SAFETY: device and surface are of one instance, here and below.
        let able = unsafe { functions.get_physical_device_surface_capabilities(physical, surface) };
        let able = able.map_err(failed("vkGetPhysicalDeviceSurfaceCapabilitiesKHR"))?;
        // SAFETY: as above.
        let modes =
            unsafe { functions.get_physical_device_surface_present_modes(physical, surface) };
        let modes = modes.map_err(failed("vkGetPhysicalDeviceSurfacePresentModesKHR"))?;
        self.mode = self.pacing.mode(&modes);
        self.destroy_views();
        let old = std::mem::take(&mut self.raw);
        self.extent = extent(&able, size);
        self.readable = able
            .supported_usage_flags
            .contains(vk::ImageUsageFlags::TRANSFER_SRC);
        let made = if self.extent.width == 0 || self.extent.height == 0 {
            Ok(vk::SwapchainKHR::null())
        } else {
            self.create(&able, old)
        };
        if old != vk::SwapchainKHR::null() && self.comes_to_rest() {
            // SAFETY: the old swapchain is ours, retired, and in no use any more.
            unsafe { self.functions.destroy_swapchain(old, None) };
        }
        self.raw = made?;
        if self.raw != vk::SwapchainKHR::null() {
            self.make_images()?;
        }
        self.stale = false;
        Ok(())
    }

    /// Records a frame and sends it to the display, if the one before it is done and the display has an image to spare. Nothing waits.
    ///
    /// `record` gets this, a command buffer outside of any render pass, and the image. If it fails nothing is shown, and the error comes back.
    ///
    /// # Errors
    /// [`Error::SurfaceLost`](crate::Error::SurfaceLost), after which [`renew`](Self::renew) is due; Vulkan's own; those of `record`.
    pub fn frame(
        &mut self,
        record: impl FnOnce(&Swapchain, vk::CommandBuffer, Image) -> Result<()>,
    ) -> Result<Shown> {
        if self.stale {
            return Ok(Shown::WindowChanged);
        }
        if self.raw == vk::SwapchainKHR::null() {
            return Ok(Shown::Hidden);
        }
        if self.is_busy()? {
            return Ok(Shown::NotYet);
        }
        let none = vk::Fence::null();
        // SAFETY: the semaphore is unsignalled: the last frame, which waited for it, is done.
        let next = unsafe {
            let functions = &self.functions;
            functions.acquire_next_image(self.raw, 0, self.acquired, none)
        };
        let number = match next {
            Ok((number, suboptimal)) => {
                self.stale = suboptimal;
                number as usize
            }
            Err(vk::Result::NOT_READY | vk::Result::TIMEOUT) => return Ok(Shown::NotYet),
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                self.stale = true;
                return Ok(Shown::WindowChanged);
            }
            Err(code) => return Err(failed("vkAcquireNextImageKHR")(code)),
        };
        let recorded = self.record(number, record);
        let shown = recorded.and_then(|()| self.submit_and_show(number));
        if shown.is_err() {
            // The image and its semaphore stay acquired: both go with the swapchain.
            self.renew_semaphore();
            self.stale = true;
        }
        shown
    }

    fn record(
        &self,
        number: usize,
        record: impl FnOnce(&Swapchain, vk::CommandBuffer, Image) -> Result<()>,
    ) -> Result<()> {
        let device = self.device.raw();
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the last frame is done, so that the buffer is in no use.
        unsafe {
            device
                .reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())
                .map_err(failed("vkResetCommandPool"))?;
            device
                .begin_command_buffer(self.cmd, &begin)
                .map_err(failed("vkBeginCommandBuffer"))?;
        }
        let (raw, view) = self.images[number];
        let extent = self.extent;
        record(
            self,
            self.cmd,
            Image {
                raw,
                view,
                number,
                extent,
            },
        )?;
        // SAFETY: it is recording since the call above.
        unsafe { device.end_command_buffer(self.cmd) }.map_err(failed("vkEndCommandBuffer"))
    }

    fn submit_and_show(&mut self, number: usize) -> Result<Shown> {
        let device = self.device.raw();
        let (acquired, drawn) = ([self.acquired], [self.drawn[number]]);
        // Where an image is first used, by a copy or as an attachment.
        let stages =
            [vk::PipelineStageFlags::TRANSFER | vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT];
        let buffers = [self.cmd];
        let submit = vk::SubmitInfo::default()
            .wait_semaphores(&acquired)
            .wait_dst_stage_mask(&stages)
            .command_buffers(&buffers)
            .signal_semaphores(&drawn);
        let (swapchains, numbers) = ([self.raw], [number as u32]);
        let present = vk::PresentInfoKHR::default()
            .wait_semaphores(&drawn)
            .swapchains(&swapchains)
            .image_indices(&numbers);
        let queue = self.device.queue();
        // SAFETY: the queue is ours for now; the fence's last use is done; the image was acquired with the semaphore.
        let presented = unsafe {
            device
                .reset_fences(&[self.fence])
                .map_err(failed("vkResetFences"))?;
            let span = tracing::debug_span!("submit").entered();
            if let Err(code) = device.queue_submit(*queue, &[submit], self.fence) {
                drop(queue);
                self.renew_fence();
                return Err(failed("vkQueueSubmit")(code));
            }
            drop(span);
            let _span = tracing::debug_span!("present").entered();
            self.functions.queue_present(*queue, &present)
        };
        match presented {
            Ok(suboptimal) => {
                self.stale |= suboptimal;
                Ok(Shown::Yes)
            }
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                self.stale = true;
                Ok(Shown::WindowChanged)
            }
            Err(code) => Err(failed("vkQueuePresentKHR")(code)),
        }
    }

    /// A signalled fence in the place of one that nothing will signal.
    fn renew_fence(&mut self) {
        let info = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
        // SAFETY: nothing was submitted with the old one.
        unsafe {
            if let Ok(fence) = self.device.raw().create_fence(&info, None) {
                self.device.raw().destroy_fence(self.fence, None);
                self.fence = fence;
            }
        }
    }

    /// A semaphore in the place of one that is signalled, and that nothing waits for.
    fn renew_semaphore(&mut self) {
        if !self.comes_to_rest() {
            return;
        }
        let device = self.device.raw();
        // SAFETY: nothing uses the old one any more.
        unsafe {
            if let Ok(new) = device.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) {
                device.destroy_semaphore(self.acquired, None);
                self.acquired = new;
            }
        }
    }

    /// Whether images can be copied elsewhere.
    pub fn can_be_read(&self) -> bool {
        self.readable
    }

    fn create(
        &self,
        able: &vk::SurfaceCapabilitiesKHR,
        old: vk::SwapchainKHR,
    ) -> Result<vk::SwapchainKHR> {
        // One to draw while others are shown.
        let most = match able.max_image_count {
            0 => u32::MAX,
            most => most,
        };
        let usage = usage(able.supported_usage_flags)?;
        let alpha = [
            vk::CompositeAlphaFlagsKHR::OPAQUE,
            vk::CompositeAlphaFlagsKHR::INHERIT,
            vk::CompositeAlphaFlagsKHR::PRE_MULTIPLIED,
            vk::CompositeAlphaFlagsKHR::POST_MULTIPLIED,
        ];
        let alpha = alpha
            .into_iter()
            .find(|&alpha| able.supported_composite_alpha.contains(alpha));
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(self.surface.raw)
            .min_image_count((able.min_image_count + 1).min(most))
            .image_format(self.format.format)
            .image_color_space(self.format.color_space)
            .image_extent(self.extent)
            .image_array_layers(1)
            .image_usage(usage)
            .image_sharing_mode(vk::SharingMode::EXCLUSIVE)
            .pre_transform(able.current_transform)
            .composite_alpha(alpha.unwrap_or(vk::CompositeAlphaFlagsKHR::OPAQUE))
            .present_mode(self.mode)
            .clipped(true)
            .old_swapchain(old);
        // SAFETY: all is as the surface can; the old swapchain is its last one.
        unsafe { self.functions.create_swapchain(&info, None) }
            .map_err(failed("vkCreateSwapchainKHR"))
    }

    fn make_images(&mut self) -> Result<()> {
        let device = self.device.raw();
        // SAFETY: the swapchain is live.
        let images = unsafe { self.functions.get_swapchain_images(self.raw) };
        let images = images.map_err(failed("vkGetSwapchainImagesKHR"))?;
        for &image in &images {
            let range = vk::ImageSubresourceRange::default()
                .aspect_mask(vk::ImageAspectFlags::COLOR)
                .level_count(1)
                .layer_count(1);
            let info = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(self.format.format)
                .subresource_range(range);
            // SAFETY: the image is the swapchain's, of this format.
            let view = unsafe { device.create_image_view(&info, None) };
            let view = view.map_err(failed("vkCreateImageView"))?;
            self.images.push((image, view));
        }
        while self.drawn.len() < images.len() {
            // SAFETY: the device is live.
            let made =
                unsafe { device.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) };
            self.drawn.push(made.map_err(failed("vkCreateSemaphore"))?);
        }
        Ok(())
    }

    fn make_commands(&mut self) -> Result<()> {
        let device = self.device.raw();
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(self.device.queue_family())
            .flags(vk::CommandPoolCreateFlags::TRANSIENT);
        // SAFETY: the device is live, here and below; what is made goes with the swapchain.
        self.pool = unsafe { device.create_command_pool(&pool, None) }
            .map_err(failed("vkCreateCommandPool"))?;
        let buffers = vk::CommandBufferAllocateInfo::default()
            .command_pool(self.pool)
            .command_buffer_count(1);
        // SAFETY: the pool is new and ours.
        self.cmd = unsafe { device.allocate_command_buffers(&buffers) }
            .map_err(failed("vkAllocateCommandBuffers"))?[0];
        let signalled = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
        // SAFETY: as above.
        self.fence =
            unsafe { device.create_fence(&signalled, None) }.map_err(failed("vkCreateFence"))?;
        // SAFETY: as above.
        self.acquired =
            unsafe { device.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) }
                .map_err(failed("vkCreateSemaphore"))?;
        Ok(())
    }

    fn destroy_views(&mut self) {
        for (_, view) in self.images.drain(..) {
            // SAFETY: the last frame is done.
            unsafe { self.device.raw().destroy_image_view(view, None) };
        }
    }
}
