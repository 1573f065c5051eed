//! The program behind the window: it starts what is needed of what the viewer wants, takes what is ready, and draws what has changed.

mod cursor;
mod drawing;
mod input;
mod saves;
mod shaders;
mod showing;
mod start;
mod state;
mod takes;

pub use saves::Changes;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use hullform::Result;
use hullform::host::{Shown, WindowSurface};
use hullform::mesh::ControlMesh;
use hullform::plan::Database;

use super::canvas::Canvas;
use super::clipboard::Clipboard;
use super::context::{Context, Key};
use super::errors::{Measured, Subject};
use super::haste::Haste;
use super::live::{Followed, Live};
use super::panels;
use super::part::Wanted;
use super::probe::Found;
use super::readings::Readings;
use super::stage::{Built, Stage};
use super::viewer::{Viewer, Wish};
use super::watch::Watch;
use super::workers::{Wake, Workers};
use crate::options::Shape;

/// How long what uses the device, or is being written, is waited for in the end.
const PATIENCE: Duration = Duration::from_secs(60);

/// What workers bring.
pub enum Done {
    /// A mesh was read.
    Read(u64, Result<ControlMesh>),
    /// A part was brought to the device.
    Built(u64, Wanted, Result<Built>),
    /// What was prepared of a part was brought up to an edit.
    Edited(u64, Wanted, Result<(Live, Followed)>),
    /// Pipelines were made.
    Piped(Key, Result<()>),
    /// A surface was captured.
    Measured(Box<Subject>, Result<Arc<Measured>>),
    /// Its errors are known.
    Compared(Result<()>),
    /// What pipelines are made of was written.
    Kept,
    /// Shaders were compiled.
    Compiled(Result<shaders::Compiled>),
    /// Something was saved, in words.
    Saved(Result<String>),
    /// Models were saved: their numbers and revisions, and in words.
    Written(Vec<(u64, u64)>, Result<String>),
}

/// What is being worked on.
#[derive(Default)]
struct Running {
    read: Vec<u64>,
    built: Vec<(u64, Wanted)>,
    /// By part, from what its surfaces are brought up to an edit.
    edited: Vec<(u64, Wanted)>,
    piped: Vec<Key>,
    measured: Option<Subject>,
    compared: Option<Arc<Measured>>,
    saved: usize,
}

/// What failed, and is not tried again before something changes.
#[derive(Default)]
struct Failed {
    built: Vec<(u64, Wanted)>,
    piped: Vec<Key>,
    measured: Vec<Subject>,
}

/// The program behind a window.
pub struct Program {
    /// What is shown.
    pub viewer: Viewer,
    /// What was measured.
    pub readings: Readings,
    /// egui's own state.
    pub egui: egui::Context,
    pub(super) stage: Stage,
    pub(super) canvas: Canvas,
    pub(super) context: Arc<Context>,
    pub(super) workers: Workers<Context, Done>,
    pub(super) shape: Shape,
    watch: Watch,
    running: Running,
    failed: Failed,
    kept: Vec<Arc<Measured>>,
    clipboard: Clipboard,
    /// The command line that was copied last.
    pub copied: Option<String>,
    probe: Option<[f64; 2]>,
    found: Option<Found>,
    live: shaders::Live,
    began: Instant,
    haste: Haste,
    /// Edits that are not seen yet.
    asked: Vec<takes::Asked>,
    /// What was brought while a scene was being drawn that it would change.
    waiting: Vec<Done>,
    /// Whether a picture of the window is to be taken, once it shows the full scene.
    shooting: bool,
    /// Whether the scene has changed and nothing is drawn of that yet.
    undrawn: bool,
    /// Whether a measurement that is asked for waits until nobody is at work.
    unmeasured: bool,
    /// Whether there is no picture of the scene yet.
    anew: bool,
    /// What the scene's picture shows.
    drawn: Option<drawing::Drawing>,
    fresh: bool,
    /// Plans of what is dragged.
    sketch: Option<Arc<Database>>,
    /// When what pipelines are made of was written last, and how many there had been.
    saved: Option<Instant>,
    saved_pipelines: u64,
}

impl Running {
    /// Whether nothing is prepared, and no pipeline made.
    fn is_idle(&self) -> bool {
        let builds = !(self.built.is_empty() && self.edited.is_empty());
        self.read.is_empty() && !builds && self.piped.is_empty()
    }
}

/// What a program is to know besides.
#[derive(Clone)]
pub struct Setting {
    /// How models are read.
    pub shape: Shape,
    /// Where the shaders' text is.
    pub glsl: Option<PathBuf>,
    /// What wakes the window.
    pub wake: Wake,
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Whether it was shown.
    pub shown: Shown,
    /// Whether the scene was drawn anew.
    pub scene: bool,
}

impl Program {
    /// A program that shows these models.
    pub fn new(
        viewer: Viewer,
        canvas: Canvas,
        context: Context,
        setting: Setting,
    ) -> Result<Program> {
        let Setting { shape, glsl, wake } = setting;
        let egui = egui::Context::default();
        panels::dress(&egui);
        let mut watch = Watch::new(wake.clone());
        if let Some(folder) = &glsl {
            watch.look_into(folder);
        }
        let context = Arc::new(context);
        let is_software = context.device().info().is_software();
        Ok(Program {
            stage: Stage::new(&context)?,
            workers: Workers::new(context.clone(), wake),
            context,
            readings: Readings::default(),
            running: Running::default(),
            failed: Failed::default(),
            kept: Vec::new(),
            clipboard: Clipboard::default(),
            copied: None,
            probe: None,
            found: None,
            drawn: None,
            fresh: true,
            sketch: None,
            saved: None,
            saved_pipelines: 0,
            began: Instant::now(),
            haste: Haste::new(is_software),
            asked: Vec::new(),
            waiting: Vec::new(),
            shooting: false,
            undrawn: false,
            unmeasured: false,
            anew: true,
            live: shaders::Live {
                due: glsl.is_some(),
                folder: glsl.clone(),
                ..Default::default()
            },
            egui,
            viewer,
            canvas,
            shape,
            watch,
        })
    }

    /// What is being worked on, in words.
    pub fn busy(&self) -> Vec<String> {
        let mut words = Vec::new();
        if !self.running.read.is_empty() {
            words.push("reading".to_string());
        }
        if !self.running.built.is_empty() {
            words.push("preparing".to_string());
        }
        if !self.running.piped.is_empty() {
            words.push("building pipelines".to_string());
        }
        if self.live.running {
            words.push("compiling shaders".to_string());
        }
        if self.running.saved > 0 {
            words.push("saving".to_string());
        }
        if let Some(measured) = &self.running.compared {
            let (done, all) = (measured.progress.position(), measured.progress.length());
            let share = 100 * done / all.unwrap_or(0).max(1);
            words.push(format!("asking the truth, {share} %"));
        } else if self.running.measured.is_some() && self.viewer.compare.map.is_some() {
            words.push("capturing".to_string());
        }
        words
    }

    /// Whether all is there that is wanted.
    pub fn is_settled(&self) -> bool {
        let running = &self.running;
        running.is_idle()
            && running.compared.is_none()
            && running.measured.is_none()
            && running.saved == 0
            && !self.unmeasured
            && !self.shooting
            && self.waiting.is_empty()
            && self.is_whole()
            && !self.live.running
            && (!self.live.due || self.stage.parts.is_empty())
    }

    /// Goes along with a window of this size.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<()> {
        self.begins_anew();
        self.canvas.resize(size)
    }

    /// Shows pictures in another surface of the window, since the old one was lost.
    pub fn renew(
        &mut self,
        size: [u32; 2],
        surface: impl FnOnce() -> Result<WindowSurface>,
    ) -> Result<()> {
        self.begins_anew();
        self.canvas.renew(size, surface)
    }

    /// Has nothing of a picture yet.
    fn begins_anew(&mut self) {
        self.stage.abandon();
        (self.fresh, self.anew) = (true, true);
        self.shooting |= self.canvas.is_shooting();
    }

    /// Ends a program whose device was lost: what it showed.
    pub fn give_up(mut self) -> Viewer {
        if !self.workers.finish(PATIENCE) {
            std::mem::forget(self.context.clone());
        }
        let _ = self.canvas.wait();
        let mut viewer = std::mem::take(&mut self.viewer);
        viewer.wishes.clear();
        // What was being read is read again.
        let unread = viewer
            .parts
            .iter_mut()
            .filter(|part| part.history().is_none());
        unread.for_each(|part| part.unread = part.error.is_none());
        viewer
    }

    /// Ends the work and gives everything back.
    pub fn close(mut self) -> Result<()> {
        let _ = self.canvas.wait();
        self.context.save_cache();
        if !self.workers.finish(PATIENCE) {
            // What still works uses the device: it goes with the process.
            std::mem::forget(self.context.clone());
        }
        Ok(())
    }

    /// Does what is wished of the program; whether it is to end.
    pub fn grant(&mut self) -> Result<bool> {
        for wish in self.viewer.take_wishes() {
            match wish {
                Wish::Probe(at) => self.probe = Some(at),
                Wish::Quit => return Ok(true),
                Wish::Screenshot => self.shooting = true,
                Wish::Render => self.render()?,
                Wish::CopyCommand => self.copy(),
                Wish::Save => self.save()?,
                Wish::SaveAll => self.save_all()?,
            }
        }
        Ok(false)
    }
}
