//! The program behind the window: it starts what is needed of what the viewer wants, takes what is ready, and draws what has changed.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec2;
use hullform::host::{Shown, Style};
use hullform::mesh::{ControlMesh, Model, Scheme};
use hullform::{Error, Result};

use super::canvas::{Canvas, Panels};
use super::clipboard::Clipboard;
use super::context::{Context, Drawn, Key, under_scheme};
use super::errors::{self, Legend, Measured, Subject};
use super::overlay::Overlay;
use super::panels::{self, Status};
use super::part::{Part, Wanted};
use super::picture;
use super::probe::{Found, Ray};
use super::readings::Readings;
use super::stage::{Side, Stage, Staged};
use super::viewer::{Viewer, Wish};
use super::workers::Workers;
use crate::model;
use crate::options::Shape;

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
    /// Something was saved, in words.
    Saved(Result<String>),
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
    running: Running,
    failed: Failed,
    kept: Vec<Arc<Measured>>,
    clipboard: Clipboard,
    /// The command line that was copied last.
    pub copied: Option<String>,
    probe: Option<[f64; 2]>,
    found: Option<Found>,
    /// What the scene's picture shows.
    drawn: Option<Drawing>,
    fresh: bool,
}

/// What a picture of the scene depends on.
#[derive(Clone, PartialEq)]
struct Drawing {
    look: super::viewer::Look,
    cutting: super::viewer::Cutting,
    compare: super::viewer::Compare,
    orbit: super::orbit::Orbit,
    frozen: Option<super::orbit::Orbit>,
    selection: super::selection::Selection,
    sides: Vec<Side>,
    parts: Vec<(u64, u64, u64)>,
    legend: Option<Legend>,
    ready: usize,
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
        shape: Shape,
        workers: Workers<Done>,
    ) -> Result<Program> {
        let egui = egui::Context::default();
        panels::dress(&egui);
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
            egui,
            viewer,
            canvas,
            shape,
            workers,
        })
    }

    /// Takes what workers have brought, when nothing is drawn; whether there was anything.
    pub fn take(&mut self) -> Result<bool> {
        let done = self.workers.done();
        let any = !done.is_empty();
        for done in done {
            self.take_one(done)?;
        }
        Ok(any)
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
            Done::Compared(result) => {
                self.running.compared = None;
                result.or_else(|error| self.fails(error))?;
            }
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
        if matches!(error, Error::DeviceLost { .. }) {
            return Err(error);
        }
        let error = crate::refused::in_words_of_options(error);
        self.viewer.notices.warn(error.to_string());
        Ok(())
    }

    fn take_mesh(&mut self, number: u64, result: Result<ControlMesh>) {
        self.running.read.retain(|other| *other != number);
        let Some(part) = self.viewer.parts.iter_mut().find(|part| part.number() == number) else {
            return;
        };
        match result {
            Ok(mesh) => {
                part.loaded(mesh);
                if self.viewer.selection.part() == Some(number) {
                    self.viewer.selection.clear();
                }
                let unread = self.viewer.parts.iter().any(|part| part.history().is_none());
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
                self.stage.parts.push(Staged::new(number, model, wanted, sides));
                self.stage.parts.sort_by_key(|staged| staged.number);
                self.fresh = true;
                Ok(())
            }
            Err(error @ Error::DeviceLost { .. }) => Err(error),
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

    /// Starts what is needed and not under way.
    pub fn start(&mut self) -> Result<()> {
        let numbers: Vec<u64> = self.viewer.parts.iter().map(Part::number).collect();
        self.stage.parts.retain(|staged| numbers.contains(&staged.number));
        self.deform();
        for place in 0..self.viewer.parts.len() {
            self.read(place)?;
            self.build(place)?;
        }
        self.pipe()?;
        self.measure()
    }

    /// Shows control vertices where edits and motion have them.
    fn deform(&mut self) {
        let deform = self.viewer.deform;
        for part in &mut self.viewer.parts {
            let Some(history) = part.history() else { continue };
            let positions = history.draft().positions.clone();
            let all = crate::eye::Sphere::around(positions.iter().copied());
            part.show(deform.points(&positions, all));
        }
    }

    fn read(&mut self, place: usize) -> Result<()> {
        let part = &mut self.viewer.parts[place];
        let number = part.number();
        if !part.unread || self.running.read.contains(&number) {
            return Ok(());
        }
        part.unread = false;
        self.running.read.push(number);
        let path = part.path().map(std::path::Path::to_path_buf);
        let shape = self.shape.clone();
        let work = move || model::load(path.as_deref(), &shape);
        self.workers.start("read", work, move |result| Done::Read(number, result))
    }

    fn build(&mut self, place: usize) -> Result<()> {
        let part = &self.viewer.parts[place];
        let number = part.number();
        let recipes = self.viewer.recipes();
        let Some(wanted) = part.wanted(self.viewer.cutting.scheme, recipes) else {
            return Ok(());
        };
        let same = |staged: &&Staged| staged.number == number && staged.wanted == wanted;
        let is_there = self.stage.parts.iter().any(|staged| same(&staged));
        let runs = self.running.built.iter().any(|(other, _)| *other == number);
        let key = (number, wanted);
        if is_there || runs || self.failed.built.contains(&key) {
            return Ok(());
        }
        // Others of it may do now.
        self.failed.built.retain(|(other, _)| *other != number);
        let (_, wanted) = key.clone();
        self.running.built.push(key);
        let Some(history) = part.history() else { return Ok(()) };
        let (draft, context) = (history.draft().clone(), self.context.clone());
        let (how, styles) = (self.shape.triangulate, self.styles());
        let asked = wanted.clone();
        let work = move || {
            let mesh = draft.mesh()?;
            let scheme = asked.scheme.unwrap_or(mesh.options().scheme);
            let model = Model::new(under_scheme(mesh, scheme, how)?);
            let place = |&recipe| context.place(&model, recipe);
            let sides = asked.recipes.iter().map(place).collect::<Result<Vec<Drawn>>>()?;
            for (drawn, style) in sides.iter().flat_map(|d| styles.iter().map(move |s| (d, s))) {
                let style = Style {
                    backend: drawn.surface.options().backend,
                    residence: drawn.surface.options().residence,
                    ..*style
                };
                context.make(drawn.surface.prepared(), style)?;
            }
            Ok((Arc::new(model), sides))
        };
        let told = move |result| Done::Built(number, wanted, result);
        self.workers.start("build", work, told)
    }

    /// How surfaces are drawn that are not there yet.
    fn styles(&self) -> Vec<Style> {
        let spacing = self.viewer.cutting.spacing;
        let style = |fill| Style {
            cull: self.viewer.cutting.cull.mode(),
            ..Style::new(Default::default(), spacing, fill)
        };
        Stage::fills(&self.viewer).into_iter().map(style).collect()
    }

    fn pipe(&mut self) -> Result<()> {
        for (part, side, style) in self.stage.missing(&self.viewer, &self.context) {
            let drawn = &self.stage.parts[part].sides[side];
            let key = drawn.key(style);
            if self.running.piped.contains(&key) || self.failed.piped.contains(&key) {
                continue;
            }
            self.running.piped.push(key.clone());
            let (context, prepared) = (self.context.clone(), drawn.surface.prepared().clone());
            let work = move || context.make(&prepared, style).map(drop);
            let told = move |result| Done::Piped(key, result);
            self.workers.start("pipelines", work, told)?;
        }
        Ok(())
    }

    /// What a measurement of a part's side would be of.
    fn subject(&self, staged: &Staged, side: usize) -> Option<Subject> {
        let part = self.viewer.parts.iter().find(|part| part.number() == staged.number)?;
        Some(Subject {
            part: staged.number,
            version: staged.wanted.version,
            moves: part.moves(),
            scheme: staged.wanted.scheme,
            recipe: *staged.wanted.recipes.get(side)?,
            cut: self.viewer.cutting.cut(),
            tags: None,
        })
    }

    /// The measurement of a part's side, if it is there.
    fn measured(&self, staged: &Staged, side: usize) -> Option<&Arc<Measured>> {
        let subject = self.subject(staged, side)?;
        self.kept.iter().find(|measured| measured.subject == subject)
    }

    /// Captures what a map or the cursor asks for, one after the other, when nothing moves.
    fn measure(&mut self) -> Result<()> {
        let asked = self.viewer.compare.map.is_some() || self.probe.is_some();
        if !asked || self.viewer.is_moving() || self.running.measured.is_some() {
            return Ok(());
        }
        let recipes = self.viewer.recipes().len();
        let sides = self.stage.parts.iter().flat_map(|part| (0..recipes).map(move |i| (part, i)));
        let wanted: Vec<(&Staged, usize)> = sides.collect();
        for (staged, side) in wanted {
            let Some(subject) = self.subject(staged, side) else { continue };
            match self.kept.iter().find(|measured| measured.subject == subject) {
                Some(measured) => {
                    let mapped = self.viewer.compare.map.is_some();
                    let free = self.running.compared.is_none();
                    if mapped && free && measured.errors.get().is_none() {
                        let measured = measured.clone();
                        self.running.compared = Some(measured.clone());
                        let work = move || {
                            measured.compare();
                            Ok(())
                        };
                        return self.workers.start("compare", work, Done::Compared);
                    }
                }
                None if self.failed.measured.contains(&subject) => {}
                None => return self.start_measure(subject),
            }
        }
        Ok(())
    }

    fn start_measure(&mut self, subject: Subject) -> Result<()> {
        let parts = &self.viewer.parts;
        let part = parts.iter().find(|part| part.number() == subject.part);
        let Some((part, history)) = part.and_then(|part| Some((part, part.history()?))) else {
            return Ok(());
        };
        let mut draft = history.draft().clone();
        draft.positions = Arc::new(part.points().to_vec());
        self.running.measured = Some(subject.clone());
        let (context, how, asked) = (self.context.clone(), self.shape.triangulate, subject.clone());
        let work = move || errors::measure(&context, &draft, how, asked).map(Arc::new);
        let told = move |result| Done::Measured(Box::new(subject), result);
        self.workers.start("measure", work, told)
    }

    /// What is under the cursor.
    fn look_under_cursor(&mut self) {
        self.found = self.probe.and_then(|at| {
            let sides = Stage::sides(&self.viewer);
            let (side, at) = under(&self.viewer, &sides, at)?;
            let eye = self.viewer.orbit.eye();
            let ray = Ray::new(&eye, at, side.viewport.aspect());
            let parts = self.stage.parts.iter();
            let all = parts.filter_map(|staged| self.measured(staged, side.recipe)?.find(ray));
            all.min_by(|a, b| a.distance.total_cmp(&b.distance))
        });
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
    }

    /// Runs the panels on what came in.
    pub fn panels(&mut self, input: egui::RawInput) -> egui::FullOutput {
        self.look_under_cursor();
        let legend = self.legend();
        let egui = self.egui.clone();
        let busy = self.busy();
        let (viewer, found) = (&mut self.viewer, self.found.as_ref());
        let readings = &self.readings;
        egui.run(input, |ctx| {
            let status = Status {
                readings,
                busy: busy.clone(),
                probe: found,
                scale: legend.clone(),
            };
            panels::show(ctx, viewer, &status);
        })
    }

    /// What the colours of the map mean that is shown.
    fn legend(&self) -> Option<Legend> {
        let kind = self.viewer.compare.map?;
        let sides = Stage::sides(&self.viewer);
        let parts = self.stage.parts.iter();
        let all = parts.flat_map(|staged| sides.iter().map(move |side| (staged, side.recipe)));
        let all = all.filter_map(|(staged, side)| self.measured(staged, side).cloned());
        let all: Vec<Arc<Measured>> = all.collect();
        Legend::of(kind, &all)
    }

    /// What the picture of the scene depends on, as it is.
    fn drawing(&self) -> Drawing {
        let viewer = &self.viewer;
        let ready = self.stage.missing(viewer, &self.context).len();
        Drawing {
            look: viewer.look,
            cutting: viewer.cutting,
            compare: viewer.compare,
            orbit: viewer.orbit,
            frozen: viewer.frozen,
            selection: viewer.selection.clone(),
            sides: Stage::sides(viewer),
            parts: viewer
                .parts
                .iter()
                .map(|part| {
                    let revision = part.history().map_or(0, |history| history.revision());
                    (part.number(), part.moves(), revision)
                })
                .collect(),
            legend: self.legend(),
            ready,
        }
    }

    /// Shows a frame, with the scene drawn anew if it has changed. Only when the canvas is not busy.
    pub fn show(&mut self, panels: &Panels) -> Result<Outcome> {
        let started = Instant::now();
        if let Some(seconds) = self.stage.device_seconds() {
            self.readings.device.add(seconds);
        }
        let drawing = self.drawing();
        let area = self.viewer.area;
        let changed = self.fresh || self.drawn.as_ref() != Some(&drawing);
        let mut scene = changed && !area.is_empty();
        if scene {
            let overlay = self.overlay(f64::from(panels.scale), drawing.legend.as_ref());
            if let Err(error) = self.stage.decide(&self.viewer, &overlay, &self.context) {
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
                self.readings.cost = cost;
            }
        }
        if shown == Shown::Yes || shown == Shown::Hidden || !scene {
            self.drawn = Some(drawing);
            self.fresh &= !scene && changed;
        }
        Ok(Outcome { shown, scene })
    }

    fn overlay(&self, scale: f64, legend: Option<&Legend>) -> Overlay {
        let sides = Stage::sides(&self.viewer);
        let area = sides.first().map_or(self.viewer.area, |side| side.viewport);
        let mut overlay = Overlay::new(&self.viewer, area, scale);
        overlay.maps = vec![Default::default(); 2];
        let Some(legend) = legend else { return overlay };
        let (eye, all) = (self.viewer.orbit.eye(), self.viewer.sphere());
        for side in &sides {
            let (vertices, triangles) = &mut overlay.maps[side.recipe];
            for staged in &self.stage.parts {
                let Some(measured) = self.measured(staged, side.recipe) else { continue };
                let view = eye.view(measured.model.placement(), side.viewport.aspect(), all);
                let Some(map) = measured.map(legend.kind, legend.scale, &view) else { continue };
                let first = vertices.len() as u32;
                vertices.extend(map);
                let own = measured.surface.triangles.iter();
                triangles.extend(own.map(|triangle| triangle.map(|corner| first + corner)));
            }
        }
        overlay
    }

    /// Goes along with a window of this size.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<()> {
        self.fresh = true;
        self.canvas.resize(size)
    }

    /// Ends the work and gives everything back.
    pub fn close(mut self) -> Result<()> {
        let _ = self.canvas.wait();
        self.context.save_cache();
        if !self.workers.finish(Duration::from_secs(3)) {
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
                        self.viewer.notices.warn("the display does not give its pictures back");
                    }
                }
                Wish::Render => self.render()?,
                Wish::CopyCommand => self.copy(),
                Wish::Save => self.save()?,
            }
        }
        Ok(false)
    }

    /// Saves the picture of the window that was taken, when its frame is done.
    pub fn take_shot(&mut self) -> Result<()> {
        let Some((size, pixels)) = self.canvas.take_shot() else {
            return Ok(());
        };
        self.running.saved += 1;
        let file = picture::free_name("hullform", "png");
        let work = move || picture::save(&file, size, &pixels);
        self.workers.start("save", work, Done::Saved)
    }

    fn words(&self, file: &Path) -> Vec<String> {
        picture::words(&self.viewer, &self.shape, &self.context.global, file)
    }

    /// Has `render` draw what is seen.
    fn render(&mut self) -> Result<()> {
        let file = picture::free_name("hullform", "png");
        let words = self.words(&file);
        let scheme = self.viewer.cutting.scheme;
        let history = self.viewer.parts.first().and_then(|part| part.history());
        let Some(draft) = history.map(|history| history.draft().clone()) else {
            return Ok(());
        };
        self.running.saved += 1;
        let (context, how) = (self.context.clone(), self.shape.triangulate);
        let work = move || picture::render(&context, &draft, how, scheme, &words, &file);
        self.workers.start("render", work, Done::Saved)
    }

    fn copy(&mut self) {
        let line = picture::line(&self.words(Path::new("hullform.png")));
        let left_out = picture::left_out(&self.viewer);
        let without = match left_out.is_empty() {
            true => String::new(),
            false => format!(" (without {})", left_out.join(", ")),
        };
        match self.clipboard.copy(&line) {
            Ok(()) => self.viewer.notices.tell(format!("copied{without}: {line}")),
            Err(words) => self.viewer.notices.tell(format!("{words}{without}: {line}")),
        }
        self.copied = Some(line);
    }

    /// Saves the model that is edited, beside its file under a name of its own.
    fn save(&mut self) -> Result<()> {
        let Some(part) = self.viewer.edited() else {
            return Ok(());
        };
        let Some(draft) = part.history().map(|history| history.draft().clone()) else {
            return Ok(());
        };
        let stem = part.file().and_then(Path::file_stem).map(|stem| stem.to_string_lossy());
        let stem = format!("{}-edited", stem.unwrap_or("hullform".into()));
        // Names tell schemes: one that says another would be read as that.
        let prefix = match draft.scheme() {
            Scheme::CatmullClark => "",
            scheme if Scheme::of_file(format!("{stem}.obj")) == Some(scheme) => "",
            Scheme::Loop => "loop_",
            Scheme::Bilinear => "bilinear_",
            _ => "",
        };
        let file = picture::free_name(&format!("{prefix}{stem}"), "obj");
        part.was_saved();
        self.running.saved += 1;
        let work = move || picture::save_model(&file, &draft);
        self.workers.start("save", work, Done::Saved)
    }
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
