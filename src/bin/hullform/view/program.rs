//! The program behind the window: it starts what is needed of what the viewer wants, takes what is ready, and draws what has changed.

mod cursor;
mod drawing;
mod saves;
mod shaders;
mod start;
mod state;
mod takes;

pub use saves::Changes;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use hullform::Result;
use hullform::gpu::Cut;
use hullform::host::{Shown, WindowSurface};
use hullform::mesh::{ControlMesh, Model};

use super::canvas::{Canvas, Panels};
use super::clipboard::Clipboard;
use super::command::of_event;
use super::context::{Context, Drawn, Key};
use super::errors::{Measured, Subject};
use super::haste::Haste;
use super::panels::{self, Status};
use super::part::Wanted;
use super::probe::Found;
use super::readings::Readings;
use super::stage::Stage;
use super::viewer::{Viewer, Wish};
use super::watch::Watch;
use super::workers::{Wake, Workers};
use crate::options::Shape;

/// How long what is still worked on is waited for in the end.
const PATIENCE: Duration = Duration::from_secs(3);

/// What workers bring.
pub enum Done {
    /// A mesh was read.
    Read(u64, Result<ControlMesh>),
    /// A part was brought to the device.
    Built(u64, Wanted, Result<(Arc<Model>, Vec<Drawn>)>),
    /// Pipelines were made.
    Piped(Key, Result<()>),
    /// A surface was captured.
    Measured(Box<Subject>, Result<Arc<Measured>>),
    /// Its errors are known.
    Compared(Result<()>),
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
    pub(super) workers: Workers<Done>,
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
    /// Whether the scene has changed and is not drawn yet.
    undrawn: bool,
    /// Whether there is no picture of the scene yet.
    anew: bool,
    /// What the scene's picture shows.
    drawn: Option<drawing::Drawing>,
    fresh: bool,
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
        Ok(Program {
            stage: Stage::new(&context)?,
            context: Arc::new(context),
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
            began: Instant::now(),
            haste: Haste::default(),
            undrawn: false,
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
            workers: Workers::new(wake),
        })
    }

    /// How long until another picture may be due, where there is one that is coarser or of earlier edits.
    pub fn until_full(&self) -> Option<Duration> {
        let both = [self.haste.left(), self.haste.breather()];
        both.into_iter().flatten().min()
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
        running.read.is_empty()
            && running.built.is_empty()
            && running.piped.is_empty()
            && running.compared.is_none()
            && running.measured.is_none()
            && running.saved == 0
            && self.haste.left().is_none()
            && !self.undrawn
            && !self.live.running
            && (!self.live.due || self.stage.parts.is_empty())
    }

    /// Runs the panels on what came in. What a button of the mouse does stands between what came before it and what after: else a drag that begins
    /// and ends within one slow frame would be none.
    pub fn panels(&mut self, mut input: egui::RawInput) -> egui::FullOutput {
        let _span = tracing::debug_span!("panels").entered();
        self.take_tabs(&mut input.events);
        let runs = runs(std::mem::take(&mut input.events));
        let mut output = egui::FullOutput::default();
        for events in runs {
            let one = egui::RawInput {
                events,
                ..input.take()
            };
            output.append(self.panels_once(one));
        }
        output
    }

    /// Takes Tab for our own where nothing is written: egui would give the keys to one of its widgets, and all others would be dead.
    fn take_tabs(&mut self, events: &mut Vec<egui::Event>) {
        if self.egui.wants_keyboard_input() || self.viewer.intent.is_some() {
            return;
        }
        let is_tab = |event: &egui::Event| {
            matches!(
                event,
                egui::Event::Key {
                    key: egui::Key::Tab,
                    ..
                }
            )
        };
        let tabs: Vec<egui::Event> = events.extract_if(.., |event| is_tab(event)).collect();
        for command in tabs.iter().filter_map(of_event) {
            self.viewer.obey(command);
        }
    }

    fn panels_once(&mut self, input: egui::RawInput) -> egui::FullOutput {
        self.look_under_cursor();
        let legend = self.legend();
        let egui = self.egui.clone();
        let busy = self.busy();
        let (viewer, found) = (&mut self.viewer, self.found.as_ref());
        let (readings, shaders) = (&self.readings, self.live.error.as_deref());
        egui.run(input, |ctx| {
            let status = Status {
                readings,
                busy: busy.clone(),
                probe: found,
                shaders,
                scale: legend.clone(),
            };
            panels::show(ctx, viewer, &status);
        })
    }

    /// Shows a frame, with the scene drawn anew if it has changed. Only when the canvas is not busy.
    pub fn show(&mut self, panels: &Panels) -> Result<Outcome> {
        let started = Instant::now();
        if let Some(seconds) = self.stage.device_seconds() {
            self.readings.device.add(seconds);
            self.haste.took(seconds);
        }
        // Events tell sizes that the window's images may not have yet.
        self.viewer.area = self.viewer.area.within(self.canvas.size());
        let drawing = self.drawing();
        let area = self.viewer.area;
        // A picture that is saved is the full one.
        let shooting = self.canvas.is_shooting();
        let left = self.haste.left();
        let rested = left.is_some_and(|left| left.is_zero() || shooting);
        let moved = self.fresh || self.drawn.as_ref() != Some(&drawing);
        let changed = moved || rested;
        let running = |key: &Key| self.running.piped.contains(key);
        // The last picture stays meanwhile, if it still is one of this window.
        let waits = !self.anew && self.stage.waits(&self.viewer, &self.context, running);
        // Of edits the panels tell at once.
        let last = self.drawn.as_ref().filter(|_| !self.fresh);
        let held = last.is_some_and(|last| drawing.is_edit_of(last))
            && self.haste.breather().is_some()
            && !shooting;
        let mut scene = changed && !area.is_empty() && !waits && !held;
        let full = self.viewer.cutting.cut();
        let cut = match moved && !self.anew && !shooting {
            true => Cut {
                level: self.haste.level(full.level),
                ..full
            },
            false => full,
        };
        if scene {
            let overlay = self.overlay(f64::from(panels.scale), drawing.legend());
            let stage = &mut self.stage;
            if let Err(error) = stage.decide(&self.viewer, cut, &overlay, &self.context) {
                self.fails(error)?;
                scene = false;
            }
        }
        self.canvas.confine(area);
        let (stage, viewer, context) = (&mut self.stage, &self.viewer, &self.context);
        let mut cost = None;
        let mut record = |cmd, target: &_| {
            cost = Some(stage.record(cmd, target, viewer, context)?);
            Ok(())
        };
        let shown = match scene {
            true => self.canvas.show(panels, area, Some(&mut record)),
            false => self.canvas.show(panels, area, None),
        }?;
        if shown == Shown::Yes {
            self.readings.frames[0] += 1;
            self.readings.host.add(started.elapsed().as_secs_f64());
            if let Some(cost) = cost {
                self.readings.frames[1] += 1;
                self.haste.drawn(cut.level < full.level);
                self.readings.cost = cost;
            }
        }
        self.undrawn = held || waits || scene && !matches!(shown, Shown::Yes | Shown::Hidden);
        if held {
            // It is drawn after a moment.
        } else if waits {
            // It is drawn when they are there.
            self.drawn = None;
        } else if shown == Shown::Yes || shown == Shown::Hidden || !scene {
            self.drawn = Some(drawing);
            self.fresh &= !scene && changed;
            self.anew &= !scene;
        }
        Ok(Outcome { shown, scene })
    }

    /// Goes along with a window of this size.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<()> {
        self.fresh = true;
        self.anew = true;
        self.canvas.resize(size)
    }

    /// Shows pictures in another surface of the window, since the old one was lost.
    pub fn renew(
        &mut self,
        size: [u32; 2],
        surface: impl FnOnce() -> Result<WindowSurface>,
    ) -> Result<()> {
        self.fresh = true;
        self.anew = true;
        self.canvas.renew(size, surface)
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
                Wish::Screenshot => {
                    if !self.canvas.shoot()? {
                        self.viewer
                            .notices
                            .warn("the display does not give its pictures back");
                    }
                }
                Wish::Render => self.render()?,
                Wish::CopyCommand => self.copy(),
                Wish::Save => self.save()?,
                Wish::SaveAll => self.save_all()?,
            }
        }
        Ok(false)
    }
}

/// Events in their order, those of the mouse's buttons by themselves; one run at least.
fn runs(events: Vec<egui::Event>) -> Vec<Vec<egui::Event>> {
    let mut runs = vec![Vec::new()];
    for event in events {
        let alone = matches!(event, egui::Event::PointerButton { .. });
        let last_alone = runs.last().is_some_and(|run: &Vec<egui::Event>| {
            matches!(run.last(), Some(egui::Event::PointerButton { .. }))
        });
        if (alone || last_alone) && runs.last().is_some_and(|run| !run.is_empty()) {
            runs.push(Vec::new());
        }
        runs.last_mut().expect("there is one").push(event);
    }
    runs
}
