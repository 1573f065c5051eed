//! What workers have brought, and files that have changed.

use std::time::Instant;

use hullform::mesh::ControlMesh;
use hullform::{Error, Result};

use super::{Done, Program};
use crate::view::live::{Followed, Live};
use crate::view::part::Wanted;
use crate::view::stage::{Built, Staged};
use crate::view::watch;

impl Program {
    /// Takes what the last frame tells and workers have brought, when nothing is drawn. What would change a scene that is not whole waits for that.
    pub fn take(&mut self) -> Result<()> {
        self.take_times();
        self.take_changes();
        let mut all = std::mem::take(&mut self.waiting);
        all.extend(self.workers.done());
        for done in all {
            match self.stage.is_drawing() && done.changes_the_stage() {
                true => self.waiting.push(done),
                false => self.take_one(done)?,
            }
        }
        Ok(())
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
            Done::Edited(number, wanted, result) => {
                return self.take_edited(number, wanted, result);
            }
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
                        let few = few(self.kept.iter().map(|kept| kept.surface.points.len()));
                        self.kept.truncate(few);
                    }
                    Err(error) => {
                        // Others than the latest are not asked for again.
                        self.failed.measured.truncate(8);
                        self.failed.measured.insert(0, *subject);
                        return self.fails(error);
                    }
                }
            }
            Done::Kept => {}
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
    pub(super) fn fails(&mut self, error: Error) -> Result<()> {
        if error.is_of_device() {
            return Err(error);
        }
        let error = crate::refused::in_words_of_options(error);
        self.viewer.notices.warn(error.to_string());
        Ok(())
    }

    fn take_mesh(&mut self, number: u64, result: Result<ControlMesh>) {
        self.running.read.retain(|other| *other != number);
        self.asked.retain(|asked| asked.part != number);
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

    fn take_built(&mut self, number: u64, wanted: Wanted, result: Result<Built>) -> Result<()> {
        self.running.built.retain(|(other, _)| *other != number);
        let parts = &mut self.viewer.parts;
        let Some(part) = parts.iter_mut().find(|part| part.number() == number) else {
            return Ok(());
        };
        match result {
            Ok(built) => {
                part.error = None;
                part.model = Some(built.model.clone());
                for refusal in built.sides.iter().flat_map(|drawn| &drawn.refusals) {
                    self.viewer.notices.warn(refusal.clone());
                }
                let old = self.stage.put(Staged::new(number, wanted, built));
                if old.is_empty() {
                    self.haste.forget();
                }
                self.workers.let_go(old);
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
}

impl Program {
    /// Brings surfaces up to an edit, unless there are others by now.
    fn take_edited(
        &mut self,
        number: u64,
        wanted: Wanted,
        result: Result<(Live, Followed)>,
    ) -> Result<()> {
        let before = self.running.edited.extract_if(.., |(of, _)| *of == number);
        let Some((_, before)) = before.last() else {
            return Ok(());
        };
        let mut parts = self.stage.parts.iter_mut();
        let same = |staged: &&mut Staged| staged.number == number && staged.wanted == before;
        let Some(staged) = parts.find(same) else {
            return Ok(());
        };
        let edited = result.and_then(|(live, followed)| {
            // Where it takes other tables, all is prepared anew.
            match followed.updates.iter().any(|update| update.is_whole) {
                true => Ok(()),
                false => {
                    staged.edit(live, &followed, &self.context)?;
                    staged.wanted = wanted;
                    let mut parts = self.viewer.parts.iter_mut();
                    let part = parts.find(|part| part.number() == number);
                    part.into_iter().for_each(|part| part.error = None);
                    Ok(())
                }
            }
        });
        self.fresh = true;
        match edited {
            Err(error) if error.is_of_device() => Err(error),
            Err(error) => {
                // What is prepared anew tells what is wrong, if it is still so.
                tracing::info!("{error}; preparing anew");
                Ok(())
            }
            Ok(()) => Ok(()),
        }
    }
}

impl Program {
    /// Notes edits that are asked for, from now on.
    pub(super) fn note_edits(&mut self) {
        for part in &self.viewer.parts {
            let Some(history) = part.history() else {
                continue;
            };
            let (number, topology) = (part.number(), history.topology());
            let of = |asked: &&Asked| asked.part == number;
            let last = self.asked.iter().rev().find(of).map(|asked| asked.topology);
            let staged = self
                .stage
                .parts
                .iter()
                .find(|staged| staged.number == number);
            let shown = staged.map(|staged| staged.wanted.version[1]);
            if last.or(shown).is_some_and(|known| known != topology) {
                let when = Instant::now();
                self.asked.push(Asked {
                    part: number,
                    topology,
                    when,
                });
            }
        }
    }

    /// Takes down how long edits took that are in the scene that is whole now.
    pub(super) fn take_followed(&mut self) {
        let stage = &self.stage;
        let seen = |asked: &mut Asked| {
            let mut all = stage.parts.iter();
            let staged = all.find(|staged| staged.number == asked.part);
            staged.is_none_or(|staged| staged.wanted.version[1] >= asked.topology)
        };
        for asked in self.asked.extract_if(.., seen) {
            self.readings.edits.add(asked.when.elapsed().as_secs_f64());
            self.readings.edited += 1;
        }
    }
}

/// An edit that is asked for and not seen yet.
pub(super) struct Asked {
    part: u64,
    topology: u64,
    when: Instant,
}

impl Done {
    /// Whether it changes what a scene is drawn of.
    fn changes_the_stage(&self) -> bool {
        matches!(
            self,
            Done::Built(..) | Done::Edited(..) | Done::Compiled(..)
        )
    }
}

/// The points of all measurements that are kept, at most.
const GREATEST_KEPT: usize = 8 << 20;
/// How many are kept, at most.
const MOST_KEPT: usize = 6;

/// How many of measurements are kept that have so many points each, the latest first: that one always.
fn few(points: impl Iterator<Item = usize>) -> usize {
    let sums = points.scan(0, |sum, points| {
        *sum += points;
        Some(*sum)
    });
    let fits = |&sum: &usize| sum <= GREATEST_KEPT;
    sums.take(MOST_KEPT).take_while(fits).count().max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_measurements_few_are_kept_and_fewer_of_great_ones() {
        assert_eq!(few([10; 9].into_iter()), MOST_KEPT);
        assert_eq!(few([GREATEST_KEPT / 3; 9].into_iter()), 3);
        assert_eq!(few([2 * GREATEST_KEPT; 2].into_iter()), 1);
    }
}
