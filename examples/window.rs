//! The shortest honest program with a window: a surface that turns, drawn when the display is ready for it.
//!
//!     cargo run --release --example window [-- FRAMES]
//!
//! It ends when the window is closed, or after so many frames.
//! `src/bin/hullform/view` is the long one: panels, models that are prepared beside the window, and a window that may come and go.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use hullform::ash::vk;
use hullform::glam::Vec3;
use hullform::gpu::{Cut, DrawList, Fill, Pipelines, Shading, SurfaceOptions, View};
use hullform::gpu::{Layout, TessellatedSurface};
use hullform::host::{Area, Device, Instance, OffscreenTarget, Owned, Pacing, Style};
use hullform::host::{Shown, Swapchain, WindowSurface};
use hullform::mesh::{Model, builtin};
use hullform::method::{Displacement, MethodOptions, method_for};
use hullform::tessellation::Spacing;
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};
use winit::window::{Window, WindowId};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    let Err(error) = run() else {
        return ExitCode::SUCCESS;
    };
    eprintln!("window: {error}");
    ExitCode::FAILURE
}

fn run() -> Result<()> {
    let mut app = App {
        frames: match std::env::args().nth(1) {
            Some(frames) => frames.parse()?,
            None => u32::MAX,
        },
        ..App::default()
    };
    EventLoop::new()?.run_app(&mut app)?;
    app.result.unwrap_or(Ok(()))
}

#[derive(Default)]
struct App {
    open: Option<Open>,
    /// How many are left to be shown.
    frames: u32,
    result: Option<Result<()>>,
}

/// What there is while the window is open. Dropped from top to bottom: first what the last frame uses has been waited for, and the window goes last.
struct Open {
    swapchain: Swapchain,
    target: OffscreenTarget,
    pipelines: Owned<Pipelines>,
    surface: Owned<TessellatedSurface>,
    list: DrawList,
    layout: Owned<Layout>,
    began: Instant,
    window: Window,
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        match Open::new(events) {
            Ok(open) => self.open = Some(open),
            Err(error) => self.end(events, Err(error)),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        if let WindowEvent::CloseRequested = event {
            self.end(events, Ok(()));
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        match self.open.as_mut().map(Open::draw) {
            Some(Ok(true)) => self.frames = self.frames.saturating_sub(1),
            Some(Err(error)) => self.end(events, Err(error)),
            _ => {}
        }
        if self.frames == 0 {
            self.end(events, Ok(()));
        }
        // The display sets the pace; the host looks after it now and then, and never waits.
        let soon = Instant::now() + Duration::from_millis(2);
        events.set_control_flow(ControlFlow::WaitUntil(soon));
    }
}

impl App {
    fn end(&mut self, events: &ActiveEventLoop, result: Result<()>) {
        self.result = Some(result);
        events.exit();
    }
}

impl Open {
    fn new(events: &ActiveEventLoop) -> Result<Open> {
        let window = events.create_window(Window::default_attributes().with_title("hullform"))?;
        let size = <[u32; 2]>::from(window.inner_size());

        // 1. An instance, a surface, and a device that shows pictures in it.
        let (display, handle) = (
            window.display_handle()?.as_raw(),
            window.window_handle()?.as_raw(),
        );
        let names = ash_window::enumerate_required_extensions(display)?.iter();
        // SAFETY: ash-window's names are static C strings.
        let names = names.map(|&name| unsafe { std::ffi::CStr::from_ptr(name) });
        let instance = Instance::with_extensions(false, &names.collect::<Vec<_>>())?;
        // SAFETY: the instance has the extensions of this display; the window outlives the surface.
        let raw = unsafe {
            ash_window::create_surface(instance.entry(), instance.raw(), display, handle, None)
        };
        let raw = raw.map_err(|code| format!("no surface for the window: {code:?}"))?;
        // SAFETY: it was just made from this instance.
        let window_surface = unsafe { WindowSurface::new(&instance, raw) };
        let device = Device::open_for(&instance, None, &window_surface)?;
        let swapchain = Swapchain::new(&device, window_surface, size, Pacing::Display)?;

        // 2. A model, prepared and brought to the device.
        let model = Model::new(builtin("hull")?);
        let prepared = method_for(&model).prepare(&model, MethodOptions::default())?;
        let options = SurfaceOptions::default();
        let workarounds = &device.info().workarounds;
        // SAFETY: all of one live device, which was opened with every feature that `Support` asks for; `Owned` destroys it.
        let (layout, mut surface) = unsafe {
            let layout = Owned::new(&device, Layout::new(device.raw(), device.enabled())?);
            let allocator = &mut *device.allocator();
            let raw = device.raw();
            let surface = TessellatedSurface::new(
                raw,
                allocator,
                &layout,
                &model,
                prepared,
                workarounds,
                options,
            )?;
            (layout, Owned::new(&device, surface))
        };
        device.submit(|cmd| {
            // SAFETY: recording on the device that made it, outside of a render pass.
            unsafe { surface.cmd_upload(device.raw(), cmd) };
            Ok(())
        })?;

        // 3. What is drawn, into what, and by which pipelines.
        let cut = Cut {
            level: 8.0,
            spacing: Spacing::Equal,
        };
        let list = surface.draw_list(cut, None)?;
        let target = target(&swapchain)?;
        let style = Style::new(options, cut.spacing, Fill::Solid(Shading::Lit));
        let how = style.options(&target);
        let cache = vk::PipelineCache::null();
        // SAFETY: all of one live device; `Owned` destroys them.
        let pipelines = unsafe {
            let made = Pipelines::new(device.raw(), &layout, cache, surface.prepared(), &how)?;
            Owned::new(&device, made)
        };
        Ok(Open {
            swapchain,
            target,
            pipelines,
            surface,
            list,
            layout,
            began: Instant::now(),
            window,
        })
    }

    /// Draws a frame, if the one before it is done; whether it did.
    fn draw(&mut self) -> Result<bool> {
        let size = <[u32; 2]>::from(self.window.inner_size());
        let extent = self.swapchain.extent();
        if self.swapchain.is_stale() || size != [extent.width, extent.height] {
            self.swapchain.resize(size)?;
            if self.swapchain.extent().width == 0 {
                return Ok(false);
            }
            // Pipelines stay what they are: the pass of the new target is compatible with that of the old.
            self.target = target(&self.swapchain)?;
        }
        let view = self.view();
        let Open {
            target,
            pipelines,
            surface,
            list,
            layout,
            ..
        } = self;
        // Where the window has changed meanwhile, the next call sees to it.
        let shown = self.swapchain.frame(|swapchain, cmd, image| {
            let device = swapchain.device().raw();
            // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for; all of it lives until the frame is done.
            unsafe {
                surface.cmd_prepare(device, cmd, &[view])?;
                target.begin(cmd, [0.3, 0.32, 0.35, 1.0]);
                for batch in list.batches() {
                    surface.cmd_draw(device, cmd, layout, pipelines, 0..1, batch)?;
                }
                target.end(cmd);
                let whole = Area::whole([image.extent.width, image.extent.height]);
                let display = vk::ImageLayout::PRESENT_SRC_KHR;
                swapchain.cmd_copy(cmd, image, Some((target, whole)), display);
            }
            Ok(())
        })?;
        Ok(matches!(shown, Shown::Yes))
    }

    /// What is seen now: the model turns once in twelve seconds.
    fn view(&self) -> View {
        let extent = self.target.extent();
        let aspect = extent.width as f32 / extent.height as f32;
        let turn = self.began.elapsed().as_secs_f32() * std::f32::consts::TAU / 12.0;
        let eye = 6.0 * Vec3::new(turn.sin(), 0.45, turn.cos());
        let look = hullform::glam::camera::rh::view::look_at_mat4(eye, Vec3::ZERO, Vec3::Y);
        let lens = hullform::glam::camera::rh::proj::vulkan::perspective(0.7, aspect, 0.5, 20.0);
        // In local units, in which every model is of about unit size around the origin.
        let clip = lens * look;
        View {
            clip_from_model: clip.to_cols_array_2d(),
            eye: eye.to_array(),
            displacement: Displacement::default(),
        }
    }
}

/// A picture as large as the window, whose bytes the window shows as they are.
fn target(swapchain: &Swapchain) -> Result<OffscreenTarget> {
    let (device, format) = (swapchain.device(), swapchain.picture_format());
    let vk::Extent2D { width, height } = swapchain.extent();
    Ok(OffscreenTarget::with_format(
        device,
        width.max(1),
        height.max(1),
        4,
        format,
    )?)
}
