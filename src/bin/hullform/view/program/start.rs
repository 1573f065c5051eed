//! What workers are asked for.

use std::sync::Arc;

use hullform::Result;
use hullform::host::Style;
use hullform::mesh::Model;

use super::{Done, Program};
use crate::model;
use crate::view::context::{Drawn, under_scheme};
use crate::view::errors::{self, Measured, Subject};
use crate::view::part::Part;
use crate::view::stage::{Stage, Staged};

impl Program {
    /// Starts what is needed and not under way.
    pub fn start(&mut self) -> Result<()> {
        let numbers: Vec<u64> = self.viewer.parts.iter().map(Part::number).collect();
        self.stage
            .parts
            .retain(|staged| numbers.contains(&staged.number));
        self.deform();
        for place in 0..self.viewer.parts.len() {
            self.read(place)?;
            self.build(place)?;
        }
        self.pipe()?;
        self.compile()?;
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
        self.workers
            .start("read", work, move |result| Done::Read(number, result))
    }

    fn build(&mut self, place: usize) -> Result<()> {
        let part = &self.viewer.parts[place];
        let number = part.number();
        let recipes = self.viewer.recipes();
        let Some(wanted) = part.wanted(self.live.filling, self.viewer.cutting.scheme, recipes)
        else {
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
        let Some(history) = part.history() else {
            return Ok(());
        };
        let (draft, context) = (history.draft().clone(), self.context.clone());
        let (how, styles) = (self.shape.triangulate, self.styles());
        let asked = wanted.clone();
        let work = move || {
            let span = tracing::debug_span!("connect").entered();
            let mesh = draft.mesh()?;
            let scheme = asked.scheme.unwrap_or(mesh.options().scheme);
            let model = Model::new(under_scheme(mesh, scheme, how)?);
            drop(span);
            let place = |&recipe| context.place(&model, recipe);
            let sides = asked
                .recipes
                .iter()
                .map(place)
                .collect::<Result<Vec<Drawn>>>()?;
            for (drawn, style) in sides
                .iter()
                .flat_map(|d| styles.iter().map(move |s| (d, s)))
            {
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
            tags: None,
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
        if !asked || self.viewer.is_moving() || self.running.measured.is_some() {
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
        let (context, how, asked) = (
            self.context.clone(),
            self.shape.triangulate,
            subject.clone(),
        );
        let work = move || errors::measure(&context, &draft, how, asked).map(Arc::new);
        let told = move |result| Done::Measured(Box::new(subject), result);
        self.workers.start("measure", work, told)
    }
}
