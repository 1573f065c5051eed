//! What workers are asked for.

use std::sync::Arc;
use std::time::{Duration, Instant};

use hullform::Result;
use hullform::host::Style;
use hullform::mesh::Model;
use hullform::plan::Database;

use super::{Done, Program};
use crate::capture::By;
use crate::db::database;
use crate::model;
use crate::view::context::{Context, Readied, under_scheme};
use crate::view::errors::{self, Adapted, Measured, Subject};
use crate::view::live::Live;
use crate::view::part::{Part, Wanted};
use crate::view::readings::grouped;
use crate::view::stage::{Built, Stage, Staged, style_of};
use crate::view::workers::Entrance;

/// How many pipelines are made at once: what one looks at now comes before what one has looked at.
const MOST_PIPED: usize = 2;
/// The vertices of the greatest surface that is measured: each takes some 100 bytes.
const GREATEST_MEASURED: u64 = 4 << 20;
/// How long what pipelines are made of is not written again.
const BETWEEN_SAVES: Duration = Duration::from_secs(20);

impl Program {
    /// Starts what is needed and not under way.
    pub fn start(&mut self) -> Result<()> {
        let numbers: Vec<u64> = self.viewer.parts.iter().map(Part::number).collect();
        let gone = self.stage.keep(&numbers);
        if !gone.is_empty() {
            self.workers.let_go(gone);
        }
        self.deform();
        self.note_edits();
        for place in 0..self.viewer.parts.len() {
            self.read(place)?;
            self.build(place)?;
        }
        self.pipe()?;
        self.compile()?;
        self.keep()?;
        self.measure()
    }

    /// Shows control vertices where edits and motion have them.
    fn deform(&mut self) {
        let deform = self.viewer.deform;
        for part in &mut self.viewer.parts {
            let Some(history) = part.history() else {
                continue;
            };
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
        let told = move |result| Done::Read(number, result);
        self.workers.start("read", move |_| work(), told)
    }

    fn build(&mut self, place: usize) -> Result<()> {
        let part = &self.viewer.parts[place];
        let number = part.number();
        let recipes = self.viewer.recipes();
        let Some(wanted) = part.wanted(self.live.filling, self.viewer.cutting.scheme, recipes)
        else {
            return Ok(());
        };
        let staged = self.stage.parts.iter().find(|s| s.number == number);
        let built = self.running.built.iter().map(|(other, _)| *other);
        let edited = self.running.edited.iter().map(|(other, _)| *other);
        let runs = built.chain(edited).any(|other| other == number);
        let is_there = staged.is_some_and(|staged| staged.wanted == wanted);
        let key = (number, wanted);
        if is_there || runs || self.failed.built.contains(&key) {
            return Ok(());
        }
        if staged.is_some_and(|s| s.live.is_some() && key.1.is_edit_of(&s.wanted)) {
            return self.edit(place, key.1);
        }
        // Others of it may do now.
        self.failed.built.retain(|(other, _)| *other != number);
        let (_, wanted) = key.clone();
        self.running.built.push(key);
        let Some(history) = part.history() else {
            return Ok(());
        };
        let draft = history.draft().clone();
        let (how, styles) = (self.shape.triangulate, self.styles());
        let (asked, dragged) = (wanted.clone(), history.is_dragging());
        let database = self.database(dragged)?;
        let work = move |entrance: &Entrance<Context>| {
            let span = tracing::debug_span!("connect").entered();
            let mesh = draft.mesh()?;
            let scheme = asked.scheme.unwrap_or(mesh.options().scheme);
            let model = Model::new(under_scheme(mesh, scheme, how)?);
            drop(span);
            let (mut sides, mut editables) = (Vec::new(), Vec::new());
            for &recipe in &asked.recipes {
                let readied = Readied::new(&model, recipe, &database)?;
                let (drawn, editable) = entrance.enter()?.place(&model, readied, recipe)?;
                let options = drawn.surface.options();
                for style in &styles {
                    let style = Style {
                        backend: options.backend,
                        residence: options.residence,
                        ..*style
                    };
                    entrance.enter()?.make(drawn.surface.prepared(), style)?;
                }
                sides.push(drawn);
                editables.extend(editable);
            }
            let live = match editables.len() == sides.len() {
                true => Live::new(&model, editables, draft),
                false => None,
            };
            let model = Arc::new(model);
            Ok(Built { model, sides, live })
        };
        let told = move |result| Done::Built(number, wanted, result);
        self.workers.start("build", work, told)
    }

    /// Has what was prepared of a part brought up to an edit.
    fn edit(&mut self, place: usize, wanted: Wanted) -> Result<()> {
        let part = &self.viewer.parts[place];
        let (number, history) = (part.number(), part.history());
        let Some((draft, dragged)) = history.map(|h| (h.draft().clone(), h.is_dragging())) else {
            return Ok(());
        };
        let database = self.database(dragged)?;
        let mut parts = self.stage.parts.iter_mut();
        let staged = parts.find(|staged| staged.number == number);
        let Some((live, before)) = staged.and_then(|s| Some((s.live.take()?, s.wanted.clone())))
        else {
            return Ok(());
        };
        self.running.edited.push((number, before));
        let work = move |_: &Entrance<Context>| {
            let mut live = live;
            let updates = live.follow(&draft, &database)?;
            Ok((live, updates))
        };
        let told = move |result| Done::Edited(number, wanted, result);
        self.workers.start("edit", work, told)
    }

    /// Where plans are from: while something is dragged from one over this run's, which goes when that is over.
    fn database(&mut self, dragged: bool) -> Result<Arc<Database>> {
        let under = database()?;
        if !dragged {
            self.sketch = None;
            return Ok(under.clone());
        }
        let over = || Arc::new(Database::over(under.clone()));
        Ok(self.sketch.get_or_insert_with(over).clone())
    }

    /// How surfaces are drawn that are not there yet.
    fn styles(&self) -> Vec<Style> {
        let style = |fill| style_of(Default::default(), &self.viewer, fill);
        Stage::fills(&self.viewer).into_iter().map(style).collect()
    }

    fn pipe(&mut self) -> Result<()> {
        let wanted = self.stage.keys(&self.viewer);
        let idle = self.context.give_up_but(&wanted);
        if !idle.is_empty() {
            self.workers.let_go(idle);
        }
        for (part, side, style) in self.stage.missing(&self.viewer, &self.context) {
            let drawn = &self.stage.parts[part].sides[side];
            let key = drawn.key(style);
            let runs = self.running.piped.contains(&key) || self.failed.piped.contains(&key);
            if runs || self.running.piped.len() >= MOST_PIPED {
                continue;
            }
            self.running.piped.push(key.clone());
            let prepared = drawn.surface.prepared().clone();
            let work = move |entrance: &Entrance<Context>| {
                entrance.enter()?.make(&prepared, style).map(drop)
            };
            let told = move |result| Done::Piped(key, result);
            self.workers.start("pipelines", work, told)?;
        }
        Ok(())
    }

    /// What a measurement of a part's side would be of.
    pub(super) fn subject(&self, staged: &Staged, side: usize) -> Option<Subject> {
        let part = self
            .viewer
            .parts
            .iter()
            .find(|part| part.number() == staged.number)?;
        Some(Subject {
            part: staged.number,
            version: staged.wanted.version,
            moves: part.moves(),
            scheme: staged.wanted.scheme,
            recipe: *staged.wanted.recipes.get(side)?,
            shaders: self.context.shaders().version,
            cut: self.viewer.cutting.cut(),
            adapted: self.adapted(side),
        })
    }

    /// By what the levels of a side differ.
    fn adapted(&self, recipe: usize) -> Option<Adapted> {
        let sides = Stage::sides(&self.viewer);
        let area = sides.iter().find(|side| side.recipe == recipe)?.viewport;
        Some(Adapted {
            by: self.viewer.cutting.adaptive?,
            orbit: self.viewer.cutting_orbit(),
            size: [area.width, area.height],
            all: self.viewer.sphere(),
        })
    }

    /// The measurement of a part's side, if it is there.
    pub(super) fn measured(&self, staged: &Staged, side: usize) -> Option<&Arc<Measured>> {
        let subject = self.subject(staged, side)?;
        self.kept
            .iter()
            .find(|measured| measured.subject == subject)
    }

    /// Captures what a map or the cursor asks for, one after the other, when nothing moves.
    fn measure(&mut self) -> Result<()> {
        let asked = self.viewer.compare.map.is_some() || self.probe.is_some();
        self.unmeasured = false;
        if !asked || self.viewer.is_moving() || self.running.measured.is_some() {
            return Ok(());
        }
        if self.is_at_work() || !self.is_whole() {
            self.unmeasured = true;
            return Ok(());
        }
        let recipes = self.viewer.recipes().len();
        let sides = self
            .stage
            .parts
            .iter()
            .flat_map(|part| (0..recipes).map(move |i| (part, i)));
        let wanted: Vec<(&Staged, usize)> = sides.collect();
        for (staged, side) in wanted {
            let Some(subject) = self.subject(staged, side) else {
                continue;
            };
            match self
                .kept
                .iter()
                .find(|measured| measured.subject == subject)
            {
                Some(measured) => {
                    let mapped = self.viewer.compare.map.is_some();
                    let free = self.running.compared.is_none();
                    if mapped && free && measured.errors.get().is_none() {
                        let measured = measured.clone();
                        self.running.compared = Some(measured.clone());
                        let work = move |_: &Entrance<Context>| {
                            measured.compare();
                            Ok(())
                        };
                        return self.workers.start("compare", work, Done::Compared);
                    }
                }
                None if self.failed.measured.contains(&subject) => {}
                None if staged.vertices(side) > GREATEST_MEASURED => {
                    return self.is_too_fine(subject);
                }
                None => {
                    let by = staged.levels_by(&self.viewer, side, &self.context)?;
                    return self.start_measure(subject, by);
                }
            }
        }
        Ok(())
    }

    /// Says that something is not measured.
    fn is_too_fine(&mut self, subject: Subject) -> Result<()> {
        let most = grouped(GREATEST_MEASURED);
        let words = format!(
            "errors and what is under the cursor are told up to {most} vertices; choose a lower level"
        );
        self.failed.measured.truncate(8);
        self.failed.measured.insert(0, subject);
        self.viewer.notices.tell(words);
        Ok(())
    }

    /// Writes what pipelines are made of, where there are others by now; not more often than it is worth.
    fn keep(&mut self) -> Result<()> {
        let made = self.context.made();
        let late = self.saved.is_none_or(|last| last.elapsed() > BETWEEN_SAVES);
        if made == self.saved_pipelines || !late || !self.running.is_idle() {
            return Ok(());
        }
        (self.saved, self.saved_pipelines) = (Some(Instant::now()), made);
        let work = |entrance: &Entrance<Context>| Ok(entrance.enter()?.save_cache());
        self.workers.start("keep", work, |_| Done::Kept)
    }

    fn start_measure(&mut self, subject: Subject, by: By) -> Result<()> {
        let parts = &self.viewer.parts;
        let part = parts.iter().find(|part| part.number() == subject.part);
        let Some((part, history)) = part.and_then(|part| Some((part, part.history()?))) else {
            return Ok(());
        };
        let mut draft = history.draft().clone();
        draft.positions = Arc::new(part.points().to_vec());
        self.running.measured = Some(subject.clone());
        let (how, asked) = (self.shape.triangulate, subject.clone());
        let work = move |entrance: &Entrance<Context>| {
            errors::measure(entrance, &draft, how, asked, by).map(Arc::new)
        };
        let told = move |result| Done::Measured(Box::new(subject), result);
        self.workers.start("measure", work, told)
    }
}
