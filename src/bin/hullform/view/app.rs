//! The rim: winit's events in, frames out. Everything else is in values that know nothing of windows.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use hullform::host::Shown;
use hullform::{Error, Result};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use super::canvas::Panels;
use super::log::Log;
use super::program::{Changes, Program, Setting};
use super::settings::Settings;
use super::surroundings::{Losses, Surroundings, instance, no_display};
use super::viewer::{Intent, Viewer};
use super::workers::{Wake, stand_back_in_parallel};
use crate::options::Global;
use crate::window::Arguments;

/// How often a frame that is being drawn is looked after.
const GLANCE: Duration = Duration::from_millis(2);
/// How long after a scene its costs are told.
const SETTLED: Duration = Duration::from_millis(150);
/// How often words about work are renewed.
const PROGRESS: Duration = Duration::from_millis(120);

/// Something happened beside the window.
#[derive(Clone, Copy, Debug)]
pub struct Woken;

/// Opens the window and stays until it is closed.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    stand_back_in_parallel();
    let events = EventLoop::<Woken>::with_user_event().build();
    let events = events.map_err(|error| no_display(&error.to_string()))?;
    let mut app = App {
        arguments,
        global,
        proxy: events.create_proxy(),
        open: None,
        result: Ok(()),
    };
    events
        .run_app(&mut app)
        .map_err(|error| no_display(&error.to_string()))?;
    app.finish()
}

struct App<'a> {
    arguments: &'a Arguments,
    global: &'a Global,
    proxy: EventLoopProxy<Woken>,
    open: Option<Open>,
    result: Result<()>,
}

/// What there is while the window is open. Dropped in this order: the window last.
struct Open {
    program: Program,
    input: egui_winit::State,
    panels: Panels,
    /// When something is to be shown again, whatever comes.
    due: Option<Instant>,
    /// Whether something is to be shown as soon as the last frame is done.
    wanted: bool,
    /// When motion was advanced last.
    advanced: Instant,
    log: Log,
    /// Where settings are written in the end.
    settings: Option<PathBuf>,
    /// Files that were dropped since the last frame: several are a scene.
    dropped: Vec<Option<PathBuf>>,
    losses: Losses,
    surroundings: Surroundings,
}

impl ApplicationHandler<Woken> for App<'_> {
    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &mut self.open) {
            open.wanted |= open.due.is_some_and(|due| due <= Instant::now());
        }
    }

    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match Open::new(self.arguments, self.global, events, self.proxy.clone()) {
            Ok(open) => self.open = Some(open),
            Err(error) => self.end(events, Err(error)),
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: Woken) {
        if let Some(open) = &mut self.open {
            open.wanted = true;
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match open.take(event) {
            Ok(false) => {}
            Ok(true) => self.end(events, Ok(())),
            Err(error) => self.end(events, Err(error)),
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        let advanced = match open.advance() {
            Err(error) if open.may_recover(&error) => self.recover(error),
            advanced => advanced,
        };
        match (advanced, &self.open) {
            (Ok(false), Some(open)) => events.set_control_flow(open.flow()),
            (Ok(_), _) => self.end(events, Ok(())),
            (Err(error), _) => self.end(events, Err(error)),
        }
    }
}

impl App<'_> {
    fn end(&mut self, events: &ActiveEventLoop, result: Result<()>) {
        self.result = result;
        events.exit();
    }

    /// Goes on after the surface or the device was lost; what is shown and what was changed stay.
    fn recover(&mut self, error: Error) -> Result<bool> {
        tracing::info!("{error}; beginning anew");
        let Some(mut open) = self.open.take() else {
            return Err(error);
        };
        let words = match error {
            Error::SurfaceLost { .. } => {
                let around = &open.surroundings;
                let renewed = open.program.renew(around.size(), || around.surface());
                if let Err(error) = renewed {
                    self.open = Some(open);
                    return Err(error);
                }
                "the window's surface was lost, and is made anew"
            }
            _ => {
                open = open.again()?;
                "the device was lost, and is opened anew"
            }
        };
        open.program.viewer.notices.warn(words);
        open.wanted = true;
        self.open = Some(open);
        Ok(false)
    }

    /// Closes everything, and gives the validation layer the last word.
    fn finish(self) -> Result<()> {
        let App { open, result, .. } = self;
        if let (Some(open), Err(_)) = (&open, &result) {
            let saved = Changes::of(&open.program.viewer).save();
            saved.iter().for_each(|words| tracing::warn!("{words}"));
        }
        let closed = open.map_or(Ok(()), Open::close);
        result.and(closed)
    }
}

impl Open {
    fn new(
        arguments: &Arguments,
        global: &Global,
        events: &ActiveEventLoop,
        proxy: EventLoopProxy<Woken>,
    ) -> Result<Open> {
        let file = super::settings::file().filter(|_| !arguments.fresh);
        let settings = file.as_deref().map(Settings::read).unwrap_or_default();
        let asked = arguments.size.map(|size| [size.width, size.height]);
        let size = asked.or(settings.size).unwrap_or([1280, 800]);
        let log = Log::new(arguments.log.as_deref())?;
        let attributes = Window::default_attributes()
            .with_title("hullform")
            .with_inner_size(LogicalSize::new(size[0], size[1]))
            .with_min_inner_size(LogicalSize::new(320, 240));
        let window = events.create_window(attributes);
        let window = Arc::new(window.map_err(|error| no_display(&error.to_string()))?);
        let instance = instance(&window, global.validation)?;
        let wake: Wake = Arc::new(move || {
            // The loop has ended when this fails.
            let _ = proxy.send_event(Woken);
        });
        let mut viewer = Viewer::default();
        settings.apply(&mut viewer);
        match arguments.models.is_empty() {
            true => viewer.open([None]),
            false => viewer.open(arguments.models.iter().cloned().map(Some)),
        }
        let surroundings = Surroundings {
            instance,
            global: global.clone(),
            setting: Setting {
                glsl: super::glsl::folder(arguments.glsl.as_deref())?,
                shape: arguments.shape.clone(),
                wake,
            },
            window,
        };
        let (program, input) = surroundings.program(viewer)?;
        Ok(Open {
            program,
            input,
            panels: Panels::default(),
            due: None,
            wanted: true,
            advanced: Instant::now(),
            log,
            settings: file,
            dropped: Vec::new(),
            losses: Losses::default(),
            surroundings,
        })
    }

    /// Whether an error is one after which one may go on.
    fn may_recover(&mut self, error: &Error) -> bool {
        error.is_of_device() && self.losses.may_go_on()
    }

    /// The same with another program, that shows what the old one did. Where that fails what was changed is saved.
    fn again(self) -> Result<Open> {
        let Open {
            program,
            due,
            advanced,
            log,
            settings,
            dropped,
            losses,
            surroundings,
            ..
        } = self;
        // A window has one surface at a time: the old one goes first.
        let viewer = program.give_up();
        let changes = Changes::of(&viewer);
        let made = surroundings.program(viewer);
        let (program, input) = made.inspect_err(|_| {
            let saved = changes.save();
            saved.iter().for_each(|words| tracing::warn!("{words}"));
        })?;
        Ok(Open {
            program,
            input,
            panels: Panels::default(),
            due,
            wanted: true,
            advanced,
            log,
            settings,
            dropped,
            losses,
            surroundings,
        })
    }

    /// Takes an event; whether that was the end.
    fn take(&mut self, event: WindowEvent) -> Result<bool> {
        match &event {
            WindowEvent::Destroyed => return Ok(true),
            WindowEvent::CloseRequested => {
                self.program.viewer.intend(Intent::Quit);
                self.wanted = true;
                return Ok(false);
            }
            WindowEvent::RedrawRequested => {
                self.wanted = true;
                return Ok(false);
            }
            WindowEvent::DroppedFile(path) => {
                self.dropped.push(Some(path.clone()));
                self.wanted = true;
            }
            _ => {}
        }
        let response = self
            .input
            .on_window_event(&self.surroundings.window, &event);
        self.wanted |= response.repaint || matches!(event, WindowEvent::Resized(_));
        Ok(false)
    }

    /// Shows a frame if one is wanted and the last one is done; whether the program is to end.
    fn advance(&mut self) -> Result<bool> {
        if !self.wanted || self.program.canvas.is_busy()? {
            return Ok(false);
        }
        self.wanted = false;
        self.due = None;
        let size = self.surroundings.size();
        self.program.canvas.pace(self.program.viewer.pacing);
        if self.program.canvas.is_stale() || self.program.canvas.size() != size {
            self.program.resize(size)?;
        }
        if !self.dropped.is_empty() {
            let dropped = std::mem::take(&mut self.dropped);
            self.program.viewer.intend(Intent::Open(dropped));
        }
        self.program.take_shot()?;
        self.program.take()?;
        self.program.read_off();
        self.pass_time();
        let input = self.input.take_egui_input(&self.surroundings.window);
        let output = self.program.panels(input);
        self.program.start()?;
        let delay = output
            .viewport_output
            .values()
            .map(|own| own.repaint_delay)
            .min();
        self.input
            .handle_platform_output(&self.surroundings.window, output.platform_output);
        self.panels.scale = output.pixels_per_point;
        self.panels.primitives = self
            .program
            .egui
            .tessellate(output.shapes, output.pixels_per_point);
        self.panels.textures.append(output.textures_delta);
        if self.program.grant()? {
            return Ok(true);
        }
        let outcome = self.program.show(&self.panels)?;
        tracing::trace!(tracy.frame_mark = true);
        self.panels.textures.clear();
        let program = &self.program;
        self.log.add(|| program.state());
        self.wanted |= matches!(outcome.shown, Shown::NotYet | Shown::WindowChanged);
        let moving = self.program.viewer.is_moving() || self.program.is_drawing();
        self.wanted |= moving && outcome.shown != Shown::Hidden;
        let mut soon = delay.filter(|delay| *delay < Duration::from_secs(60));
        if outcome.scene {
            // What the scene cost is told by the next frame, and what waits until it is there begins.
            soon = Some(soon.map_or(SETTLED, |delay| delay.min(SETTLED)));
        }
        if !self.program.busy().is_empty() {
            soon = Some(soon.map_or(PROGRESS, |delay| delay.min(PROGRESS)));
        }
        if let Some(left) = self.program.viewer.notices.until_change() {
            soon = Some(soon.map_or(left, |delay| delay.min(left)));
        }
        if let Some(left) = self.program.until_full() {
            soon = Some(soon.map_or(left, |delay| delay.min(left)));
        }
        self.due = soon.map(|delay| Instant::now() + delay.max(GLANCE));
        Ok(false)
    }

    fn pass_time(&mut self) {
        let now = Instant::now();
        let passed = now.duration_since(self.advanced).as_secs_f64();
        self.advanced = now;
        self.program.viewer.deform.pass(passed);
    }

    /// How long to sleep.
    fn flow(&self) -> ControlFlow {
        match (self.wanted, self.due) {
            (true, _) => ControlFlow::WaitUntil(Instant::now() + GLANCE),
            (false, Some(due)) => ControlFlow::WaitUntil(due),
            (false, None) => ControlFlow::Wait,
        }
    }

    fn close(self) -> Result<()> {
        // What is still drawn or written may take a moment, of which nobody needs to see anything.
        self.surroundings.window.set_visible(false);
        let scale = self.surroundings.window.scale_factor();
        let size: LogicalSize<u32> = self.surroundings.window.inner_size().to_logical(scale);
        let size = Some([size.width, size.height]).filter(|size| !size.contains(&0));
        if let Some(file) = &self.settings {
            let settings = Settings::of_viewer(&self.program.viewer, size);
            if let Err(error) = settings.write(file) {
                tracing::warn!(
                    "{}: {error}; the window will not be as it was left",
                    file.display()
                );
            }
        }
        let Open {
            program,
            surroundings,
            ..
        } = self;
        program.close()?;
        crate::gpu::check(&surroundings.instance)
    }
}
