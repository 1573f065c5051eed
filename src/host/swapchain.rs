//! Pictures in a window: a surface, and the swapchain that shows what is drawn, one frame after the other.

use std::time::Duration;

use ash::{khr, vk};

use crate::error::{Error, Result};
use crate::gpu::failed;
use crate::gpu::features::has_extension;
use crate::host::instance::unavailable;
use crate::host::{Device, DeviceInfo, Instance};

/// How long [`Swapchain::wait`] waits: as [`Device::submit`].
const PATIENCE: Duration = Duration::from_secs(300);

/// What a window shows Vulkan's pictures in. Destroyed when it is dropped; the window must outlive it.
pub struct WindowSurface {
    instance: Instance,
    functions: khr::surface::Instance,
    raw: vk::SurfaceKHR,
}

impl WindowSurface {
    /// Takes over a surface.
    ///
    /// # Safety
    /// `raw` was made from `instance`, which has `VK_KHR_surface`; nobody else destroys it, and its window lives longer than this.
    pub unsafe fn new(instance: &Instance, raw: vk::SurfaceKHR) -> WindowSurface {
        WindowSurface {
            functions: khr::surface::Instance::new(instance.entry(), instance.raw()),
            instance: instance.clone(),
            raw,
        }
    }

    /// What a device lacks to show pictures in it, in words.
    pub(super) fn missing(&self, device: &DeviceInfo) -> Result<Vec<String>> {
        let (physical, name) = (device.physical, khr::swapchain::NAME);
        let mut missing = Vec::new();
        // SAFETY: the device was listed by this live instance, here and below.
        let has = unsafe { has_extension(self.instance.raw(), physical, name) };
        if !has.map_err(unavailable("vkEnumerateDeviceExtensionProperties"))? {
            missing.push(name.to_string_lossy().into_owned());
        }
        if let Some(family) = device.support.graphics_family {
            // SAFETY: as above; the family is one of the device's.
            let shows = unsafe {
                let functions = &self.functions;
                functions.get_physical_device_surface_support(physical, family, self.raw)
            };
            if !shows.map_err(failed("vkGetPhysicalDeviceSurfaceSupportKHR"))? {
                missing.push("a queue that draws and shows pictures in this window".into());
            }
        }
        Ok(missing)
    }
}

impl Drop for WindowSurface {
    fn drop(&mut self) {
        // SAFETY: it is ours, and its swapchain has gone: see `Swapchain::drop`.
        unsafe { self.functions.destroy_surface(self.raw, None) };
    }
}

/// How pictures follow one another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pacing {
    /// With the display: no picture is torn, none is made that is not shown. Every device has it.
    #[default]
    Display,
    /// The latest picture at each refresh, where the device can; else with the display.
    Latest,
    /// At once, and perhaps torn, where the device can; else with the display.
    Immediate,
}

impl Pacing {
    fn mode(self, able: &[vk::PresentModeKHR]) -> vk::PresentModeKHR {
        let wanted = match self {
            Pacing::Display => vk::PresentModeKHR::FIFO,
            Pacing::Latest => vk::PresentModeKHR::MAILBOX,
            Pacing::Immediate => vk::PresentModeKHR::IMMEDIATE,
        };
        if able.contains(&wanted) {
            wanted
        } else {
            vk::PresentModeKHR::FIFO
        }
    }
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// It is on its way to the display.
    Yes,
    /// Nothing was recorded: an earlier frame is still drawn, or the display has no image to spare. Try again a little later.
    NotYet,
    /// Nothing was recorded, or it may not be seen: the window has changed. Call [`Swapchain::resize`] and draw again.
    WindowChanged,
    /// Nothing was recorded: the window has no area, for it is minimised.
    Hidden,
}

/// What a frame is drawn into.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// The image of the display. Its contents are undefined when recording begins, and it is to be in the layout `PRESENT_SRC_KHR` when it ends.
    pub raw: vk::Image,
    /// A view of it.
    pub view: vk::ImageView,
    /// Which of the swapchain's images it is.
    pub number: usize,
    /// Its size in pixels.
    pub extent: vk::Extent2D,
}

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
    /// [`Error::NoDisplay`] when none of the window's formats has 8 bits a channel and sRGB's colours; Vulkan's own.
    pub fn new(
        device: &Device,
        surface: WindowSurface,
        size: [u32; 2],
        pacing: Pacing,
    ) -> Result<Swapchain> {
        let physical = device.info().physical;
        // SAFETY: the device is one of the surface's instance.
        let formats = unsafe {
            let functions = &surface.functions;
            functions.get_physical_device_surface_formats(physical, surface.raw)
        };
        let formats = formats.map_err(failed("vkGetPhysicalDeviceSurfaceFormatsKHR"))?;
        let mut swapchain = Swapchain {
            functions: khr::swapchain::Device::new(device.instance().raw(), device.raw()),
            format: choose(&formats)?,
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
        let nanoseconds = PATIENCE.as_nanos() as u64;
        // SAFETY: as above.
        let waited = unsafe {
            let device = self.device.raw();
            device.wait_for_fences(&[self.fence], true, nanoseconds)
        };
        waited.map_err(failed("vkWaitForFences"))
    }

    /// Makes the images anew for a window of this size in pixels, after the last frame. What was made of the old images is of no use afterwards,
    /// and must not be destroyed later than this: framebuffers go first.
    ///
    /// # Errors
    /// Vulkan's own; `ERROR_SURFACE_LOST_KHR` among them, after which surface and swapchain are to be made again.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<()> {
        self.wait()?;
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
        if old != vk::SwapchainKHR::null() {
            // Of what the display still does with the old images nothing tells but an idle queue.
            let queue = self.device.queue();
            // SAFETY: the queue is ours for now; the old swapchain is ours, retired, and in no use any more.
            unsafe {
                let _ = self.device.raw().queue_wait_idle(*queue);
                self.functions.destroy_swapchain(old, None);
            }
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
    /// `record` gets a command buffer outside of any render pass. If it fails nothing is shown, and the error comes back.
    ///
    /// # Errors
    /// Vulkan's own; those of `record`.
    pub fn frame(
        &mut self,
        record: impl FnOnce(vk::CommandBuffer, Image) -> Result<()>,
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
        record: impl FnOnce(vk::CommandBuffer, Image) -> Result<()>,
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
            if let Err(code) = device.queue_submit(*queue, &[submit], self.fence) {
                drop(queue);
                self.renew_fence();
                return Err(failed("vkQueueSubmit")(code));
            }
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
        let device = self.device.raw();
        let queue = self.device.queue();
        // SAFETY: the queue is ours for now; once it is idle nothing uses the old one.
        unsafe {
            let _ = device.queue_wait_idle(*queue);
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

impl Drop for Swapchain {
    fn drop(&mut self) {
        let waited = self.wait();
        if self.device.is_hung() || waited.is_err() && !self.is_lost() {
            return;
        }
        {
            let queue = self.device.queue();
            // SAFETY: the queue is ours for now.
            let _ = unsafe { self.device.raw().queue_wait_idle(*queue) };
        }
        self.destroy_views();
        let device = self.device.raw();
        // SAFETY: all of it is ours, and nothing is in use any more; null handles are allowed.
        unsafe {
            for &semaphore in &self.drawn {
                device.destroy_semaphore(semaphore, None);
            }
            device.destroy_semaphore(self.acquired, None);
            device.destroy_fence(self.fence, None);
            device.destroy_command_pool(self.pool, None);
            self.functions.destroy_swapchain(self.raw, None);
        }
    }
}

impl Swapchain {
    fn is_lost(&self) -> bool {
        matches!(self.is_busy(), Err(Error::DeviceLost { .. }))
    }
}

/// The best of a window's formats: one whose bytes are written as they are, since what is composed in a window (text above all) is made for blending
/// of encoded colours.
fn choose(formats: &[vk::SurfaceFormatKHR]) -> Result<vk::SurfaceFormatKHR> {
    let wanted = [
        vk::Format::B8G8R8A8_UNORM,
        vk::Format::R8G8B8A8_UNORM,
        vk::Format::A8B8G8R8_UNORM_PACK32,
        vk::Format::B8G8R8A8_SRGB,
        vk::Format::R8G8B8A8_SRGB,
        vk::Format::A8B8G8R8_SRGB_PACK32,
    ];
    let srgb = vk::ColorSpaceKHR::SRGB_NONLINEAR;
    let has = |format: &vk::Format| {
        let is = |able: &&vk::SurfaceFormatKHR| able.format == *format && able.color_space == srgb;
        formats.iter().find(is).copied()
    };
    wanted.iter().find_map(has).ok_or_else(|| {
        let names = formats.iter().map(|able| format!("{:?}", able.format));
        let names: Vec<String> = names.collect();
        Error::NoDisplay(format!(
            "the display has no format with 8 bits a channel in sRGB, only {}",
            names.join(", ")
        ))
    })
}

/// What images are used for: drawn to, copied to, and where the display allows it copied from.
fn usage(able: vk::ImageUsageFlags) -> Result<vk::ImageUsageFlags> {
    let needed = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST;
    if !able.contains(needed) {
        return Err(Error::NoDisplay(format!(
            "the display's images can be used for {able:?} alone, not for {needed:?}"
        )));
    }
    Ok(needed | able & vk::ImageUsageFlags::TRANSFER_SRC)
}

/// The size that images must have, or the window's own where the window system leaves it to us.
fn extent(able: &vk::SurfaceCapabilitiesKHR, [width, height]: [u32; 2]) -> vk::Extent2D {
    // "0xFFFFFFFF: the surface size will be determined by the extent of a swapchain" (Vulkan spec, VkSurfaceCapabilitiesKHR).
    if able.current_extent.width != u32::MAX {
        return able.current_extent;
    }
    if width == 0 || height == 0 {
        return vk::Extent2D::default();
    }
    let (least, most) = (able.min_image_extent, able.max_image_extent);
    vk::Extent2D {
        width: width.clamp(least.width, most.width.max(least.width)),
        height: height.clamp(least.height, most.height.max(least.height)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn format(format: vk::Format) -> vk::SurfaceFormatKHR {
        vk::SurfaceFormatKHR {
            format,
            color_space: vk::ColorSpaceKHR::SRGB_NONLINEAR,
        }
    }

    #[test]
    fn formats_that_store_bytes_as_they_are_come_first_and_none_is_an_error() {
        let both = [vk::Format::B8G8R8A8_SRGB, vk::Format::R8G8B8A8_UNORM].map(format);
        let chosen = choose(&both).map(|chosen| chosen.format);
        assert_eq!(chosen.ok(), Some(vk::Format::R8G8B8A8_UNORM));
        let deep = [format(vk::Format::A2B10G10R10_UNORM_PACK32)];
        let words = choose(&deep).expect_err("no format will do").to_string();
        assert!(words.contains("A2B10G10R10_UNORM_PACK32"), "{words}");
    }

    #[test]
    fn the_window_system_knows_the_size_or_leaves_it_within_bounds() {
        let mut able = vk::SurfaceCapabilitiesKHR {
            current_extent: vk::Extent2D {
                width: 7,
                height: 5,
            },
            min_image_extent: vk::Extent2D {
                width: 1,
                height: 1,
            },
            max_image_extent: vk::Extent2D {
                width: 100,
                height: 100,
            },
            ..Default::default()
        };
        assert_eq!(extent(&able, [50, 60]), able.current_extent);
        able.current_extent.width = u32::MAX;
        assert_eq!(extent(&able, [50, 600]).height, 100);
        assert_eq!(extent(&able, [0, 600]), vk::Extent2D::default());
    }

    #[test]
    fn every_display_can_pace_pictures() {
        let fifo = vk::PresentModeKHR::FIFO;
        assert_eq!(Pacing::Latest.mode(&[fifo]), fifo);
        let mailbox = vk::PresentModeKHR::MAILBOX;
        assert_eq!(Pacing::Latest.mode(&[fifo, mailbox]), mailbox);
    }
}
