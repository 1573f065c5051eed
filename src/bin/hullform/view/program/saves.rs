//! What is written: pictures, models, and the clipboard.

use std::path::Path;

use hullform::Result;
use hullform::mesh::Scheme;

use super::{Done, Program};
use crate::view::context::Context;
use crate::view::draft::Draft;
use crate::view::part::Part;
use crate::view::picture;
use crate::view::viewer::Viewer;
use crate::view::workers::Entrance;

impl Program {
    /// Saves the picture of the window that was taken, when its frame is done.
    pub fn take_shot(&mut self) -> Result<()> {
        let Some((size, pixels)) = self.canvas.take_shot() else {
            return Ok(());
        };
        self.running.saved += 1;
        let file = picture::free_name("hullform", "png");
        let work = move |entrance: &Entrance<Context>| {
            // What is written is waited for.
            entrance.enter()?;
            picture::save(&file, size, &pixels)
        };
        self.workers.start("save", work, Done::Saved)
    }

    fn words(&self, file: &Path) -> Vec<String> {
        picture::words(&self.viewer, &self.shape, &self.context.global, file)
    }

    /// Has `render` draw what is seen.
    pub(super) fn render(&mut self) -> Result<()> {
        let file = picture::free_name("hullform", "png");
        let words = self.words(&file);
        let scheme = self.viewer.cutting.scheme;
        let history = self.viewer.parts.first().and_then(|part| part.history());
        let Some(draft) = history.map(|history| history.draft().clone()) else {
            return Ok(());
        };
        self.running.saved += 1;
        let how = self.shape.triangulate;
        let work = move |entrance: &Entrance<Context>| {
            let context = entrance.enter()?;
            picture::render(&context, &draft, how, scheme, &words, &file)
        };
        self.workers.start("render", work, Done::Saved)
    }

    pub(super) fn copy(&mut self) {
        let line = picture::line(&self.words(Path::new("hullform.png")));
        let left_out = picture::left_out(&self.viewer);
        let without = match left_out.is_empty() {
            true => String::new(),
            false => format!(" (without {})", left_out.join(", ")),
        };
        match self.clipboard.copy(&line) {
            Ok(()) => self.viewer.notices.tell(format!("copied{without}: {line}")),
            Err(words) => self
                .viewer
                .notices
                .tell(format!("{words}{without}: {line}")),
        }
        self.copied = Some(line);
    }

    /// Saves the model that is edited, beside its file under a name of its own.
    pub(super) fn save(&mut self) -> Result<()> {
        let number = self.viewer.edited().map(|part| part.number());
        self.save_those(|part| Some(part.number()) == number)
    }

    /// Saves all that were changed.
    pub(super) fn save_all(&mut self) -> Result<()> {
        self.save_those(Part::is_changed)
    }

    fn save_those(&mut self, which: impl Fn(&Part) -> bool) -> Result<()> {
        let parts = self.viewer.parts.iter().filter(|part| which(part));
        let all: Vec<Copy> = parts.filter_map(Copy::of).collect();
        if all.is_empty() {
            return Ok(());
        }
        self.running.saved += 1;
        let told: Vec<(u64, u64)> = all
            .iter()
            .map(|copy| (copy.number, copy.revision))
            .collect();
        let work = move |entrance: &Entrance<Context>| {
            entrance.enter()?;
            all.iter().map(Copy::write).collect::<Result<Vec<String>>>()
        };
        let told = move |result: Result<Vec<String>>| {
            Done::Written(told, result.map(|words| words.join("\n")))
        };
        self.workers.start("save", work, told)
    }

    pub(super) fn take_written(
        &mut self,
        written: &[(u64, u64)],
        result: Result<String>,
    ) -> Result<()> {
        self.running.saved -= 1;
        match result {
            Ok(words) => {
                for &(number, revision) in written {
                    let mut parts = self.viewer.parts.iter_mut();
                    if let Some(part) = parts.find(|part| part.number() == number) {
                        part.was_saved(revision);
                    }
                }
                self.viewer.notices.tell(words);
                self.viewer.saved();
                Ok(())
            }
            Err(error) => {
                self.viewer.saving = false;
                self.fails(error)
            }
        }
    }
}

/// What was changed and is in no file, to be written when there is no window any more.
pub struct Changes(Vec<Copy>);

impl Changes {
    /// All of a viewer's.
    pub fn of(viewer: &Viewer) -> Changes {
        let changed = viewer.parts.iter().filter(|part| part.is_changed());
        Changes(changed.filter_map(Copy::of).collect())
    }

    /// Writes them; in words, where to.
    pub fn save(&self) -> Vec<String> {
        let saved = self.0.iter().map(|copy| {
            let lost = |error| format!("what was changed of {} is lost: {error}", copy.stem);
            match copy.write() {
                Ok(words) => format!("what was changed is not lost: {words}"),
                Err(error) => lost(error),
            }
        });
        saved.collect()
    }
}

/// A model as it is when it is saved.
struct Copy {
    number: u64,
    revision: u64,
    stem: String,
    draft: Draft,
}

impl Copy {
    fn of(part: &Part) -> Option<Copy> {
        let history = part.history()?;
        let draft = history.draft().clone();
        let stem = part
            .file()
            .and_then(Path::file_stem)
            .map(|stem| stem.to_string_lossy());
        let stem = format!("{}-edited", stem.unwrap_or("hullform".into()));
        // Names tell schemes: one that says another would be read as that.
        let prefix = match draft.scheme() {
            Scheme::CatmullClark => "",
            scheme if Scheme::of_file(format!("{stem}.obj")) == Some(scheme) => "",
            Scheme::Loop => "loop_",
            Scheme::Bilinear => "bilinear_",
            _ => "",
        };
        Some(Copy {
            number: part.number(),
            revision: history.revision(),
            stem: format!("{prefix}{stem}"),
            draft,
        })
    }

    /// Under a name that no file has.
    fn write(&self) -> Result<String> {
        picture::save_model(&picture::free_name(&self.stem, "obj"), &self.draft)
    }
}
