//! The program behind the window: it starts what is needed of what the viewer wants, takes what is ready, and draws what has changed.

mod drawing;
mod saves;
mod shaders;
mod start;
mod state;

pub use saves::Changes;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec2;
use hullform::gpu::Cut;
use hullform::host::{Shown, WindowSurface};
use hullform::mesh::{ControlMesh, Model};
use hullform::{Error, Result};

use super::canvas::{Canvas, Panels};
use super::clipboard::Clipboard;
use super::command::of_event;
use super::context::{Context, Drawn, Key};
use super::errors::{Measured, Subject};
use super::haste::Haste;
use super::panels::{self, Status};
use super::part::Wanted;
use super::piece::Piece;
use super::probe::{Found, Ray};
use super::readings::Readings;
use super::stage::{Side, Stage, Staged};
use super::viewer::{Viewer, Wish};
use super::watch::{self, Watch};
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

    /// Takes what workers have brought, when nothing is drawn; whether there was anything.
    pub fn take(&mut self) -> Result<bool> {
        self.take_changes();
        let done = self.workers.done();
        let any = !done.is_empty();
        for done in done {
            self.take_one(done)?;
        }
        Ok(any)
    }

    /// Has models read again whose files have changed.
    fn take_changes(&mut self) {
        let changed = self.watch.changed();
        for part in &mut self.viewer.parts {
            let place = part.file().and_then(watch::place);
            if place.is_none_or(|place| !changed.contains(&place)) {
                continue;
            }
            match part.is_changed() {
                false => part.unread = true,
                true => self.viewer.notices.tell(format!(
                    "{} has changed on the disk; F5 reads it, without what was changed here",
                    part.name()
                )),
            }
        }
        if let Some(folder) = &self.live.folder {
            self.live.due |= changed.iter().any(|place| place.starts_with(folder));
        }
        let files = self.viewer.parts.iter().filter_map(|part| part.file());
        self.watch.look_after(files);
    }

    fn take_one(&mut self, done: Done) -> Result<()> {
        match done {
            Done::Read(number, result) => self.take_mesh(number, result),
            Done::Built(number, wanted, result) => return self.take_built(number, wanted, result),
            Done::Piped(key, result) => {
                self.running.piped.retain(|other| *other != key);
                if let Err(error) = result {
                    self.failed.piped.push(key);
                    return self.fails(error);
                }
            }
            Done::Measured(subject, result) => {
                self.running.measured = None;
                match result {
                    Ok(measured) => {
                        self.kept.insert(0, measured);
                        self.kept.truncate(6);
                    }
                    Err(error) => {
                        self.failed.measured.push(*subject);
                        return self.fails(error);
                    }
                }
            }
            Done::Compiled(result) => return self.take_compiled(result),
            Done::Compared(result) => {
                self.running.compared = None;
                result.or_else(|error| self.fails(error))?;
            }
            Done::Written(written, result) => return self.take_written(&written, result),
            Done::Saved(result) => {
                self.running.saved -= 1;
                match result {
                    Ok(words) => self.viewer.notices.tell(words),
                    Err(error) => return self.fails(error),
                }
            }
        }
        Ok(())
    }

    /// What went wrong is told; a device that was lost ends the work with it.
    fn fails(&mut self, error: Error) -> Result<()> {
        if error.is_of_device() {
            return Err(error);
        }
        let error = crate::refused::in_words_of_options(error);
        self.viewer.notices.warn(error.to_string());
        Ok(())
    }

    fn take_mesh(&mut self, number: u64, result: Result<ControlMesh>) {
        self.running.read.retain(|other| *other != number);
        let Some(part) = self
            .viewer
            .parts
            .iter_mut()
            .find(|part| part.number() == number)
        else {
            return;
        };
        match result {
            Ok(mesh) => {
                part.loaded(mesh);
                if self.viewer.selection.part() == Some(number) {
                    self.viewer.selection.clear();
                }
                let unread = self
                    .viewer
                    .parts
                    .iter()
                    .any(|part| part.history().is_none());
                if self.viewer.fit_pending && !unread {
                    self.viewer.fit();
                }
            }
            Err(error) => part.error = Some(error.to_string()),
        }
    }

    fn take_built(
        &mut self,
        number: u64,
        wanted: Wanted,
        result: Result<(Arc<Model>, Vec<Drawn>)>,
    ) -> Result<()> {
        self.running.built.retain(|(other, _)| *other != number);
        let parts = &mut self.viewer.parts;
        let Some(part) = parts.iter_mut().find(|part| part.number() == number) else {
            return Ok(());
        };
        match result {
            Ok((model, sides)) => {
                part.error = None;
                part.model = Some(model.clone());
                for refusal in sides.iter().flat_map(|drawn| &drawn.refusals) {
                    self.viewer.notices.warn(refusal.clone());
                }
                self.stage.parts.retain(|staged| staged.number != number);
                self.stage
                    .parts
                    .push(Staged::new(number, model, wanted, sides));
                self.stage.parts.sort_by_key(|staged| staged.number);
                self.fresh = true;
                Ok(())
            }
            Err(error) if error.is_of_device() => Err(error),
            Err(error) => {
                let error = crate::refused::in_words_of_options(error);
                let error = error.in_file(&part.name()).to_string();
                part.error = Some(error.clone());
                self.failed.built.push((number, wanted));
                self.viewer.notices.warn(error);
                Ok(())
            }
        }
    }

    /// What is under the cursor.
    fn look_under_cursor(&mut self) {
        self.found = self.probe.and_then(|at| {
            let sides = Stage::sides(&self.viewer);
            let (side, at) = under(&self.viewer, &sides, at)?;
            let eye = self.viewer.orbit.eye();
            let ray = Ray::new(&eye, at, side.viewport.aspect());
            let parts = self.stage.parts.iter();
            let all = parts.filter_map(|staged| {
                let found = self.measured(staged, side.recipe)?.find(ray)?;
                Some((staged, found))
            });
            let (staged, mut found) = all.min_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance))?;
            found.piece = staged.sides.get(side.recipe).and_then(|drawn| {
                let uv = found.uv.map(|x| x as f32);
                Piece::new(drawn.surface.prepared(), drawn.list.as_ref()?, found.face, uv)
            });
            Some(found)
        });
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
            && !self.live.running
            && !(self.live.due && !self.stage.parts.is_empty())
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
        let is_tab = |event: &egui::Event| matches!(event, egui::Event::Key { key: egui::Key::Tab, .. });
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
        let drawing = self.drawing();
        let area = self.viewer.area;
        let rested = self.haste.left().is_some_and(|left| left.is_zero());
        let moved = self.fresh || self.drawn.as_ref() != Some(&drawing);
        let changed = moved || rested;
        let running = |key: &Key| self.running.piped.contains(key);
        // The last picture stays meanwhile, if it still is one of this window.
        let waits = !self.anew && self.stage.waits(&self.viewer, &self.context, running);
        // Of edits the panels tell at once.
        let last = self.drawn.as_ref().filter(|_| !self.fresh);
        let held = last.is_some_and(|last| drawing.is_edit_of(last))
            && self.haste.breather().is_some();
        let mut scene = changed && !area.is_empty() && !waits && !held;
        let full = self.viewer.cutting.cut();
        let cut = match moved && !self.anew {
            true => Cut { level: self.haste.level(full.level), ..full },
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
        let unread = viewer.parts.iter_mut().filter(|part| part.history().is_none());
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

/// The side at a place of the picture (-1..1, y up), and the place in that side's own view.
fn under<'s>(viewer: &Viewer, sides: &'s [Side], at: [f64; 2]) -> Option<(&'s Side, DVec2)> {
    let area = viewer.area;
    let pixel = f64::from(area.x) + 0.5 * (at[0] + 1.0) * f64::from(area.width);
    let inside = |side: &&Side| {
        let left = f64::from(side.scissor.x);
        (left..left + f64::from(side.scissor.width)).contains(&pixel)
    };
    let side = sides.iter().find(inside)?;
    let port = side.viewport;
    let x = 2.0 * (pixel - f64::from(port.x)) / f64::from(port.width.max(1)) - 1.0;
    Some((side, DVec2::new(x, at[1])))
}
