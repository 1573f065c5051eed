//! What a program is made in: a window with its surface, a device, and again when these were lost.

use std::sync::Arc;
use std::time::{Duration, Instant};

use hullform::ash::vk;
use hullform::host::{Device, Instance, WindowSurface};
use hullform::{Error, Result};
use winit::dpi::PhysicalSize;
use winit::raw_window_handle::{
    HandleError, HasDisplayHandle, HasWindowHandle, RawDisplayHandle, RawWindowHandle,
};
use winit::window::Window;

use super::canvas::Canvas;
use super::context::Context;
use super::program::{Program, Setting};
use super::viewer::Viewer;
use crate::gpu::Gpu;
use crate::options::Global;

/// Samples a pixel.
const SAMPLES: u32 = 4;
/// What is lost so soon after it was lost before is counted as the same trouble.
const SOON: Duration = Duration::from_secs(10);
/// How often that is borne.
const LOSSES: u32 = 3;

/// What a program is made in, and made in again when the device was lost.
pub struct Surroundings {
    /// What the device is of.
    pub instance: Instance,
    /// Options of the command line.
    pub global: Global,
    /// What a program is to know.
    pub setting: Setting,
    /// The window.
    pub window: Arc<Window>,
}

impl Surroundings {
    /// The window's size in pixels.
    pub fn size(&self) -> [u32; 2] {
        let PhysicalSize { width, height } = self.window.inner_size();
        [width, height]
    }

    /// The window's surface.
    pub fn surface(&self) -> Result<WindowSurface> {
        let (display, window) = handles(&self.window)?;
        let (entry, instance) = (self.instance.entry(), self.instance.raw());
        // SAFETY: the instance has the extensions for this display; the window outlives the surface, since it is dropped last.
        let made = unsafe { ash_window::create_surface(entry, instance, display, window, None) };
        let made = made.map_err(super::canvas::vulkan("creating the window's surface"))?;
        // SAFETY: it was just made from this instance.
        Ok(unsafe { WindowSurface::new(&self.instance, made) })
    }

    /// A program that shows something in the window, and what brings it the window's events.
    pub fn program(&self, viewer: Viewer) -> Result<(Program, egui_winit::State)> {
        let (surface, global) = (self.surface()?, &self.global);
        let device = Device::open_for(&self.instance, global.device.as_deref(), &surface)?;
        let gpu = Gpu::of(self.instance.clone(), device, global)?;
        let samples = samples(&gpu.device);
        let canvas = Canvas::new(&gpu.device, surface, self.size(), samples)?;
        let format = canvas.scene_format();
        let context = Context::new(gpu, global, format, samples)?;
        let program = Program::new(viewer, canvas, context, self.setting.clone())?;
        let input = egui_winit::State::new(
            program.egui.clone(),
            egui::ViewportId::ROOT,
            &self.window,
            Some(self.window.scale_factor() as f32),
            None,
            Some(program.context.device().limits().max_image_dimension2_d as usize),
        );
        Ok((program, input))
    }
}

type Handles = (RawDisplayHandle, RawWindowHandle);

fn handles(window: &Window) -> Result<Handles> {
    let no_handle = |error: HandleError| no_display(&error.to_string());
    let display = window.display_handle().map_err(no_handle)?.as_raw();
    Ok((display, window.window_handle().map_err(no_handle)?.as_raw()))
}

/// An instance that draws to windows.
pub fn instance(window: &Window, validation: bool) -> Result<Instance> {
    let (display, _) = handles(window)?;
    let names = ash_window::enumerate_required_extensions(display);
    let names = names.map_err(|error| no_display(&error.to_string()))?;
    let names: Vec<&'static std::ffi::CStr> = names
        .iter()
        // SAFETY: ash-window's names are static C strings.
        .map(|&name| unsafe { std::ffi::CStr::from_ptr(name) })
        .collect();
    Instance::with_extensions(validation, &names)
}

/// As many samples as the device has, up to four.
fn samples(device: &Device) -> u32 {
    let limits = device.limits();
    let able = limits.framebuffer_color_sample_counts & limits.framebuffer_depth_sample_counts;
    let fits = |count: &u32| able.contains(vk::SampleCountFlags::from_raw(*count));
    [SAMPLES, 2].into_iter().find(fits).unwrap_or(1)
}

/// Why there is no window, and what to do without.
pub fn no_display(words: &str) -> Error {
    let words = words.lines().next().unwrap_or_default().trim();
    Error::NoDisplay(format!(
        "{words}; set DISPLAY or WAYLAND_DISPLAY to a display that runs, or draw into a file with `hullform render`"
    ))
}

/// When the surface or the device was lost last.
#[derive(Default)]
pub struct Losses {
    last: Option<Instant>,
    /// How often one followed soon after another.
    again: u32,
}

impl Losses {
    /// Whether it is worth beginning anew: not when it is lost again before much can have been seen.
    pub fn may_go_on(&mut self) -> bool {
        let soon = self.last.is_some_and(|last| last.elapsed() < SOON);
        self.last = Some(Instant::now());
        self.again = if soon { self.again + 1 } else { 0 };
        self.again < LOSSES
    }
}
