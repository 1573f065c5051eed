//! A model of the scene: where it is from, and how far it has come.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use hullform::mesh::{ControlMesh, Model, Scheme};

use super::context::Recipe;
use super::draft::{Change, History};

/// What is to be on the device of a part: when it differs, it is prepared anew.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Counts loads, and changes that plans depend on.
    pub version: [u64; 2],
    /// Counts changes of the shaders that fill caches.
    pub filling: u64,
    /// The scheme, where another than the model's own.
    pub scheme: Option<Scheme>,
    /// A recipe a side.
    pub recipes: Vec<Recipe>,
}

impl Wanted {
    /// Whether an edit leads from another to this.
    pub fn is_edit_of(&self, other: &Wanted) -> bool {
        let version = [self.version[0], other.version[1]];
        let before = Wanted {
            version,
            ..self.clone()
        };
        before == *other && self != other
    }
}

/// A model of the scene.
pub struct Part {
    number: u64,
    path: Option<PathBuf>,
    /// Whether its file is to be read, and has not been.
    pub unread: bool,
    loads: u64,
    history: Option<History>,
    /// Places as they are shown, deformed.
    shown: Arc<Vec<DVec3>>,
    /// Grows with each change of `shown`.
    moves: u64,
    /// As it was prepared last.
    pub model: Option<Arc<Model>>,
    /// What was wrong with what was wanted last.
    pub error: Option<String>,
}

impl Part {
    /// A model that has yet to be read; None for the first built-in one.
    pub fn new(number: u64, path: Option<PathBuf>) -> Part {
        Part {
            number,
            path,
            unread: true,
            loads: 0,
            history: None,
            shown: Arc::default(),
            moves: 0,
            model: None,
            error: None,
        }
    }

    /// A number that no other part has.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// As the command line has it; None for the default.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Its file, unless it is built in.
    pub fn file(&self) -> Option<&Path> {
        crate::model::file(self.path())
    }

    /// A short name.
    pub fn name(&self) -> String {
        match (self.file(), &self.path) {
            (Some(file), _) => {
                let name = file.file_name().unwrap_or(file.as_os_str());
                name.to_string_lossy().into_owned()
            }
            (None, Some(path)) => path.to_string_lossy().into_owned(),
            (None, None) => crate::model::name(None),
        }
    }

    /// Takes what was read. What was changed is gone.
    pub fn loaded(&mut self, mesh: ControlMesh) {
        self.loads += 1;
        self.error = None;
        self.shown = Arc::new(mesh.positions().to_vec());
        self.moves += 1;
        self.history = Some(History::new(mesh));
    }

    /// The mesh with its past, once it has been read.
    pub fn history(&self) -> Option<&History> {
        self.history.as_ref()
    }

    /// Whether something was changed that is in no file.
    pub fn is_changed(&self) -> bool {
        self.history.as_ref().is_some_and(History::is_changed)
    }

    /// Says that all is in a file, if it is still as it was at a revision.
    pub fn was_saved(&mut self, revision: u64) {
        if let Some(history) = &mut self.history {
            history.was_saved(revision);
        }
    }

    /// Changes it.
    pub fn change(&mut self, change: Change, dragging: bool) {
        if let Some(history) = &mut self.history {
            history.change(change, dragging);
        }
    }

    /// What was dragged is let go.
    pub fn drop_it(&mut self) {
        if let Some(history) = &mut self.history {
            history.drop_it();
        }
    }

    /// A step back, or ahead again.
    pub fn step(&mut self, back: bool) -> bool {
        let step = |history: &mut History| if back { history.undo() } else { history.redo() };
        self.history.as_mut().is_some_and(step)
    }

    /// What is to be on the device; None before it is read.
    pub fn wanted(
        &self,
        filling: u64,
        scheme: Option<Scheme>,
        recipes: Vec<Recipe>,
    ) -> Option<Wanted> {
        let history = self.history.as_ref()?;
        Some(Wanted {
            version: [self.loads, history.topology()],
            filling,
            scheme,
            recipes,
        })
    }

    /// Control vertices as they are shown.
    pub fn points(&self) -> &[DVec3] {
        &self.shown
    }

    /// Grows with each change of these.
    pub fn moves(&self) -> u64 {
        self.moves
    }

    /// Shows control vertices elsewhere; the same places change nothing.
    pub fn show(&mut self, points: Vec<DVec3>) {
        if *self.shown != points {
            self.shown = Arc::new(points);
            self.moves += 1;
        }
    }
}
