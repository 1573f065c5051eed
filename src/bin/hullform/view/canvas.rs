//! The window's picture: the scene, which is drawn when it has changed, and the panels over it.

use ash::vk;
use egui_ash_renderer::{Options, Renderer};
use hullform::ash;
use hullform::host::{Device, OffscreenTarget, Pacing, Shown, Swapchain, WindowSurface};
use hullform::{Error, Result};

use super::picture::swizzled;
use super::shot::Shot;
use super::viewport::Area;

/// How panels find the image, with the scene in it.
const DRAWN: vk::ImageLayout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;

/// What records the scene.
pub type Record<'r> = dyn FnMut(vk::CommandBuffer, &OffscreenTarget) -> Result<()> + 'r;

/// What egui wants drawn.
#[derive(Default)]
pub struct Panels {
    /// What changed of its textures.
    pub textures: egui::TexturesDelta,
    /// Triangles.
    pub primitives: Vec<egui::ClippedPrimitive>,
    /// Pixels of a point.
    pub scale: f32,
}

/// A window's images, the scene's picture, and what draws panels.
pub struct Canvas {
    /// First to go: it is made of the device.
    panels: Option<Renderer>,
    pass: vk::RenderPass,
    framebuffers: Vec<vk::Framebuffer>,
    /// For egui's textures.
    pool: vk::CommandPool,
    target: Option<OffscreenTarget>,
    /// Where the target has a picture; it has none at first.
    seen: Option<Area>,
    samples: u32,
    /// A picture of the window that was asked for.
    shot: Option<Shot>,
    /// Whether the last frame took it.
    taken: bool,
    /// Textures that egui has given up, and that the last frame may still show.
    unused: Vec<egui::TextureId>,
    swapchain: Swapchain,
    device: Device,
}

impl Canvas {
    /// The canvas of a window of this size in pixels, with so many samples a pixel.
    pub fn new(
        device: &Device,
        surface: WindowSurface,
        size: [u32; 2],
        samples: u32,
    ) -> Result<Canvas> {
        let swapchain = Swapchain::new(device, surface, size, Pacing::Display)?;
        let mut canvas = Canvas {
            panels: None,
            pass: vk::RenderPass::null(),
            framebuffers: Vec::new(),
            pool: vk::CommandPool::null(),
            target: None,
            seen: None,
            samples,
            shot: None,
            taken: false,
            unused: Vec::new(),
            swapchain,
            device: device.clone(),
        };
        canvas.make_pass()?;
        canvas.make_pool()?;
        canvas.make_panels()?;
        canvas.make_images()?;
        Ok(canvas)
    }

    /// The images' size in pixels; zero while the window is minimised.
    pub fn size(&self) -> [u32; 2] {
        let extent = self.swapchain.extent();
        [extent.width, extent.height]
    }

    /// The format of the scene's picture: the window's, encoded by the device.
    pub fn scene_format(&self) -> vk::Format {
        self.swapchain.picture_format()
    }

    /// Whether a scene that is drawn over several frames leaves the last one to be seen.
    pub fn keeps_scene(&self) -> bool {
        let target = self.target.as_ref();
        target.is_some_and(OffscreenTarget::keeps_picture)
    }

    /// Draws only a part of the scene's picture from now on.
    pub fn confine(&mut self, area: Area) {
        if let Some(target) = &mut self.target {
            target.confine(area.in_picture());
        }
    }

    /// How the display is paced.
    pub fn mode(&self) -> vk::PresentModeKHR {
        self.swapchain.mode()
    }

    /// Changes that, at once.
    pub fn pace(&mut self, pacing: Pacing) {
        self.swapchain.pace(pacing);
    }

    /// Whether the window has changed, so that [`resize`](Self::resize) is due.
    pub fn is_stale(&self) -> bool {
        self.swapchain.is_stale()
    }

    /// Whether a frame is being drawn.
    pub fn is_busy(&self) -> Result<bool> {
        self.swapchain.is_busy()
    }

    /// Waits for it.
    pub fn wait(&self) -> Result<()> {
        self.swapchain.wait()
    }

    /// Goes along with a window of this size.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<()> {
        self.swapchain.wait()?;
        self.destroy_framebuffers();
        self.shot = None;
        self.swapchain.resize(size)?;
        self.make_images()
    }

    /// Goes on in another surface of the window, since the old one was lost.
    pub fn renew(
        &mut self,
        size: [u32; 2],
        surface: impl FnOnce() -> Result<WindowSurface>,
    ) -> Result<()> {
        self.swapchain.wait()?;
        self.destroy_framebuffers();
        self.shot = None;
        self.swapchain.renew(size, surface)?;
        self.make_images()
    }

    /// Draws something of the scene, if `scene` is given with the area that has it once it is whole, where this is the last of it; then the window: the
    /// last whole scene, and panels over it. Only when it is not busy.
    pub fn show(
        &mut self,
        panels: &Panels,
        scene: Option<(&mut Record<'_>, Option<Area>)>,
    ) -> Result<Shown> {
        self.take_textures(panels)?;
        let (Some(target), Some(renderer)) = (&self.target, &mut self.panels) else {
            return Ok(Shown::Hidden);
        };
        let (device, pass, shot) = (self.device.raw(), self.pass, self.shot.as_ref());
        let framebuffers = &self.framebuffers;
        let (last, taken) = (&mut self.seen, &mut self.taken);
        self.swapchain.frame(|swapchain, cmd, image| {
            if let Some((scene, whole)) = scene {
                scene(cmd, target)?;
                *last = whole.or(*last);
            }
            let seen = last.filter(|area| !area.is_empty());
            let seen = seen.map(|area| (target, area.in_picture()));
            // SAFETY: recording on the device that made everything; the target's pass has ended, and left its picture to be copied.
            unsafe {
                swapchain.cmd_copy(cmd, image, seen, DRAWN);
                cmd_begin(device, cmd, pass, framebuffers[image.number], image.extent);
            }
            let drawn = renderer.cmd_draw(cmd, image.extent, panels.scale, &panels.primitives);
            // SAFETY: inside the pass that began above, which leaves the image to the display.
            unsafe {
                device.cmd_end_render_pass(cmd);
                if let Some(shot) = shot.filter(|shot| shot.fits(image.extent)) {
                    shot.cmd_take(device, cmd, image);
                    *taken = true;
                }
            }
            drawn.map_err(of_panels)
        })
    }

    /// Has the next frame taken as a picture; whether the display allows it.
    pub fn shoot(&mut self) -> Result<bool> {
        let extent = self.swapchain.extent();
        if !self.swapchain.can_be_read() || extent.width == 0 || extent.height == 0 {
            return Ok(false);
        }
        self.shot = Some(Shot::new(&self.device, extent)?);
        self.taken = false;
        Ok(true)
    }

    /// The picture that was taken, RGBA with its size; once its frame is done.
    pub fn take_shot(&mut self) -> Option<([u32; 2], Vec<u8>)> {
        let shot = self.shot.take_if(|_| std::mem::take(&mut self.taken))?;
        let pixels = swizzled(shot.bytes(), self.swapchain.format());
        Some((self.size(), pixels))
    }

    /// Whether one is under way.
    pub fn is_shooting(&self) -> bool {
        self.shot.is_some()
    }

    /// Brings egui's textures to the device, and gives those back that no frame shows any more.
    fn take_textures(&mut self, panels: &Panels) -> Result<()> {
        let Some(renderer) = &mut self.panels else {
            return Ok(());
        };
        let unused = std::mem::take(&mut self.unused);
        renderer.free_textures(&unused).map_err(of_panels)?;
        self.unused.clone_from(&panels.textures.free);
        if panels.textures.set.is_empty() {
            return Ok(());
        }
        let queue = self.device.queue();
        let set = renderer.set_textures(*queue, self.pool, &panels.textures.set);
        set.map_err(of_panels)
    }

    fn make_images(&mut self) -> Result<()> {
        let [width, height] = self.size();
        (self.target, self.seen) = (None, None);
        if width == 0 || height == 0 {
            return Ok(());
        }
        let (device, format) = (&self.device, self.scene_format());
        let target = OffscreenTarget::with_format(device, width, height, self.samples, format);
        self.target.insert(target?).allow_slices()?;
        for view in self.swapchain.views() {
            let views = [view];
            let info = vk::FramebufferCreateInfo::default()
                .render_pass(self.pass)
                .attachments(&views)
                .width(width)
                .height(height)
                .layers(1);
            // SAFETY: pass and view are of this device, and of one format.
            let made = unsafe { self.device.raw().create_framebuffer(&info, None) };
            self.framebuffers
                .push(made.map_err(vulkan("vkCreateFramebuffer"))?);
        }
        Ok(())
    }

    fn make_pool(&mut self) -> Result<()> {
        let info = vk::CommandPoolCreateInfo::default()
            .queue_family_index(self.device.queue_family())
            .flags(vk::CommandPoolCreateFlags::TRANSIENT);
        // SAFETY: the device is live.
        self.pool = unsafe { self.device.raw().create_command_pool(&info, None) }
            .map_err(vulkan("vkCreateCommandPool"))?;
        Ok(())
    }

    fn make_panels(&mut self) -> Result<()> {
        let format = self.swapchain.format();
        let options = Options {
            srgb_framebuffer: self.swapchain.picture_format() == format,
            ..Options::default()
        };
        let info = self.device.info();
        let made = Renderer::with_default_allocator(
            self.device.instance().raw(),
            info.physical,
            self.device.raw().clone(),
            self.pass,
            options,
        );
        self.panels = Some(made.map_err(of_panels)?);
        Ok(())
    }

    fn make_pass(&mut self) -> Result<()> {
        let colour = vk::AttachmentDescription::default()
            .format(self.swapchain.format())
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::LOAD)
            .store_op(vk::AttachmentStoreOp::STORE)
            .initial_layout(DRAWN)
            .final_layout(vk::ImageLayout::PRESENT_SRC_KHR);
        let attachments = [colour];
        let references = [vk::AttachmentReference {
            attachment: 0,
            layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        }];
        let subpasses = [vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&references)];
        let info = vk::RenderPassCreateInfo::default()
            .attachments(&attachments)
            .subpasses(&subpasses);
        // SAFETY: the device is live.
        self.pass = unsafe { self.device.raw().create_render_pass(&info, None) }
            .map_err(vulkan("vkCreateRenderPass"))?;
        Ok(())
    }

    fn destroy_framebuffers(&mut self) {
        for framebuffer in self.framebuffers.drain(..) {
            // SAFETY: ours; the last frame is done.
            unsafe { self.device.raw().destroy_framebuffer(framebuffer, None) };
        }
    }
}

impl Drop for Canvas {
    fn drop(&mut self) {
        if self.swapchain.wait().is_err() && self.device.is_hung() {
            return;
        }
        self.panels = None;
        self.shot = None;
        self.destroy_framebuffers();
        // SAFETY: ours, and in no use any more.
        unsafe {
            self.device.raw().destroy_render_pass(self.pass, None);
            self.device.raw().destroy_command_pool(self.pool, None);
        }
    }
}

/// # Safety
/// `cmd` is recording on `device` outside of a render pass; pass and framebuffer belong together.
unsafe fn cmd_begin(
    device: &ash::Device,
    cmd: vk::CommandBuffer,
    pass: vk::RenderPass,
    framebuffer: vk::Framebuffer,
    extent: vk::Extent2D,
) {
    let info = vk::RenderPassBeginInfo::default()
        .render_pass(pass)
        .framebuffer(framebuffer)
        .render_area(vk::Rect2D {
            offset: vk::Offset2D::default(),
            extent,
        });
    // SAFETY: this function's contract.
    unsafe { device.cmd_begin_render_pass(cmd, &info, vk::SubpassContents::INLINE) };
}

/// What drawing panels ran into.
fn of_panels(error: egui_ash_renderer::RendererError) -> Error {
    use egui_ash_renderer::RendererError;
    match error {
        RendererError::Vulkan(code) => vulkan("drawing panels")(code),
        other => Error::Refused(format!("panels cannot be drawn: {other}")),
    }
}

/// For `map_err`: a failure of a Vulkan call.
pub fn vulkan(call: &'static str) -> impl Fn(vk::Result) -> Error {
    move |code| {
        let result = format!("{code:?}");
        match code {
            vk::Result::ERROR_DEVICE_LOST => Error::DeviceLost { call, result },
            vk::Result::ERROR_OUT_OF_HOST_MEMORY | vk::Result::ERROR_OUT_OF_DEVICE_MEMORY => {
                Error::OutOfMemory { call, result }
            }
            _ => Error::Vulkan { call, result },
        }
    }
}
