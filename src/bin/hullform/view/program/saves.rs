//! What is written: pictures, models, and the clipboard.

use std::path::Path;

use hullform::Result;
use hullform::mesh::Scheme;

use super::{Done, Program};
use crate::view::picture;

impl Program {
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
    pub(super) fn render(&mut self) -> Result<()> {
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
        let Some(part) = self.viewer.edited() else {
            return Ok(());
        };
        let Some(draft) = part.history().map(|history| history.draft().clone()) else {
            return Ok(());
        };
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
        let file = picture::free_name(&format!("{prefix}{stem}"), "obj");
        part.was_saved();
        self.running.saved += 1;
        let work = move || picture::save_model(&file, &draft);
        self.workers.start("save", work, Done::Saved)
    }
}
