//! What the window shows, as a plain value: looks, cuts, cameras, models and what is wanted of them. It knows nothing of windows and devices.

use std::collections::BTreeMap;
use std::path::PathBuf;

use glam::DVec3;
use hullform::gpu::{Backend, Cut, Decides, Residence};
use hullform::host::Pacing;
use hullform::mesh::Scheme;
use hullform::method::METHODS;
use hullform::tessellation::Spacing;

use super::context::Recipe;
use super::deform::Deform;
use super::notices::Notices;
use super::orbit::Orbit;
use super::part::Part;
use super::selection::{Selection, Tool};
use super::viewport::Area;
use crate::adaptive::Adaptive;
use crate::deciding::Wanted;
use crate::eye::Sphere;
pub use crate::options::{Cull, Culling};
use crate::render::Shading;

/// What is shown of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// What colours mean.
    pub shading: Shading,
    /// Whether the edges of triangles are drawn.
    pub wireframe: bool,
    /// Whether the control cage is drawn.
    pub cage: bool,
    /// Whether its vertices and faces are numbered.
    pub numbers: bool,
    /// Bumps, as a share of the model's diagonal.
    pub displace: f32,
}

/// How surfaces are cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutting {
    /// The method; None for the model's own.
    pub method: Option<&'static str>,
    /// The scheme; None for the model's own.
    pub scheme: Option<Scheme>,
    /// Who cuts.
    pub backend: Backend,
    /// Where control points live.
    pub residence: Residence,
    /// Where vertices lie along edges.
    pub spacing: Spacing,
    /// The level, 1..=64.
    pub level: f32,
    /// What levels go by, where they differ.
    pub adaptive: Option<Adaptive>,
    /// What is left out.
    pub culling: Culling,
    /// Whether cracks are amplified.
    pub amplify: bool,
}

impl Cutting {
    /// As the library takes it.
    pub fn cut(&self) -> Cut {
        Cut {
            level: self.level.clamp(1.0, self.backend.greatest_level()),
            spacing: self.spacing,
        }
    }

    /// Whether the device can decide about patches; else levels go by depth tags, and patches are drawn wherever they are.
    pub fn may_decide(&self) -> bool {
        self.backend == Backend::Tessellator && self.residence == Residence::Cache
    }

    /// What is decided about patches.
    pub fn wanted(&self) -> Wanted {
        Wanted {
            adaptive: self.adaptive,
            culling: match self.may_decide() {
                true => self.culling,
                false => Culling {
                    triangles: self.culling.triangles,
                    ..Culling::default()
                },
            },
        }
    }

    /// Who decides.
    pub fn decides(&self) -> Decides {
        match self.may_decide() && self.wanted().is_anything() {
            true => Decides::Device,
            false => Decides::Host,
        }
    }
}

/// How two methods stand side by side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Beside {
    /// There is one.
    #[default]
    Alone,
    /// A line parts them.
    Split,
    /// Each has a half of the picture, and sees all.
    SideBySide,
}

/// Which error a map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// Distance from the truth.
    Position,
    /// Angle between normals.
    Normal,
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compare {
    /// How.
    pub beside: Beside,
    /// The other method; None for the model's own.
    pub other: Option<&'static str>,
    /// Where the line is, from 0 to 1.
    pub at: f64,
    /// The error that is shown in the place of colours.
    pub map: Option<ErrorKind>,
}

/// All that the window shows.
pub struct Viewer {
    /// What is shown.
    pub look: Look,
    /// How it is cut.
    pub cutting: Cutting,
    /// What it is compared with.
    pub compare: Compare,
    /// From where it is seen.
    pub orbit: Orbit,
    /// The camera by which it is cut, where that stands still.
    pub frozen: Option<Orbit>,
    /// The models.
    pub parts: Vec<Part>,
    /// What is picked.
    pub selection: Selection,
    /// How it moves.
    pub deform: Deform,
    /// What there is to be told.
    pub notices: Notices,
    /// Whether the keys are told.
    pub sheet: bool,
    /// Whether panels are there.
    pub panels: bool,
    /// How pictures follow one another.
    pub pacing: Pacing,
    /// The scene's area in the window.
    pub area: Area,
    /// Pixels of a point.
    pub scale: f32,
    /// Where things are in the window, by name, in points: for who drives it by script.
    pub places: BTreeMap<&'static str, egui::Rect>,
    /// What is wanted of the program.
    pub wishes: Vec<Wish>,
    /// What waits for a word about changes that are in no file.
    pub intent: Option<Intent>,
    /// Whether it is done once these are.
    pub saving: bool,
    /// Whether the camera is to show everything once it is known.
    pub fit_pending: bool,
    /// Files that were opened, the latest first.
    pub recent: Vec<PathBuf>,
    number: u64,
}

/// What the window asks of the program around it.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Saves what is seen as a picture.
    Screenshot,
    /// Saves the picture that `render` makes of it.
    Render,
    /// Copies the command line that makes it.
    CopyCommand,
    /// Saves the model with its changes.
    Save,
    /// Saves all models that were changed.
    SaveAll,
    /// Looks for what is under the cursor, at a place of the scene in -1..1, y up.
    Probe([f64; 2]),
    /// Ends.
    Quit,
}

/// What would lose changes that are in no file.
#[derive(Clone, Debug, PartialEq)]
pub enum Intent {
    /// The window goes.
    Quit,
    /// Other models come.
    Open(Vec<Option<PathBuf>>),
    /// The files are read again.
    Reload,
}

impl Default for Viewer {
    fn default() -> Viewer {
        Viewer {
            look: Look {
                shading: Shading::Lit,
                wireframe: false,
                cage: false,
                numbers: false,
                displace: 0.0,
            },
            cutting: Cutting {
                method: None,
                scheme: None,
                backend: Backend::Tessellator,
                residence: Residence::Cache,
                spacing: Spacing::FractionalEven,
                level: 8.0,
                adaptive: None,
                culling: Culling::default(),
                amplify: false,
            },
            compare: Compare {
                beside: Beside::Alone,
                // The plainest.
                other: METHODS.last().map(|method| method.name),
                at: 0.5,
                map: None,
            },
            orbit: Orbit::default(),
            frozen: None,
            parts: Vec::new(),
            selection: Selection::default(),
            deform: Deform::default(),
            notices: Notices::default(),
            sheet: false,
            panels: true,
            pacing: Pacing::Display,
            area: Area::default(),
            scale: 1.0,
            places: BTreeMap::new(),
            wishes: Vec::new(),
            intent: None,
            saving: false,
            fit_pending: true,
            recent: Vec::new(),
            number: 0,
        }
    }
}

impl Viewer {
    /// Shows these models alone.
    pub fn open(&mut self, paths: impl IntoIterator<Item = Option<PathBuf>>) {
        self.parts.clear();
        self.selection.clear();
        for path in paths {
            self.number += 1;
            if let Some(path) = &path {
                self.recent.retain(|other| other != path);
                self.recent.insert(0, path.clone());
                self.recent.truncate(12);
            }
            self.parts.push(Part::new(self.number, path));
        }
        self.fit_pending = true;
    }

    /// Does what would lose changes; where there are some, once there is a word about them.
    pub fn intend(&mut self, intent: Intent) {
        self.saving = false;
        match self.parts.iter().any(Part::is_changed) {
            true => self.intent = Some(intent),
            false => self.perform(intent),
        }
    }

    /// Does it, whatever is lost.
    pub fn perform(&mut self, intent: Intent) {
        self.intent = None;
        match intent {
            Intent::Quit => self.wishes.push(Wish::Quit),
            Intent::Open(paths) => self.open(paths),
            Intent::Reload => self.parts.iter_mut().for_each(|part| part.unread = true),
        }
    }

    /// Does what waited for changes to be saved, once they are.
    pub fn saved(&mut self) {
        if self.saving && !self.parts.iter().any(Part::is_changed) {
            self.saving = false;
            if let Some(intent) = self.intent.take() {
                self.perform(intent);
            }
        }
    }

    /// How each side is prepared.
    pub fn recipes(&self) -> Vec<Recipe> {
        let mut methods = vec![self.cutting.method];
        if self.compare.beside != Beside::Alone {
            methods.push(self.compare.other);
        }
        // What is being edited is edited in place, where all methods can; nobody knows yet which one draws a model by itself.
        let in_place = |name: &str| METHODS.iter().any(|m| m.name == name && m.edits_in_place());
        let edits = self.selection.tool != Tool::Look;
        let live = edits && methods.iter().all(|method| method.is_none_or(in_place));
        let recipe = |method| Recipe {
            live,
            method,
            backend: self.cutting.backend,
            residence: self.cutting.residence,
            amplify: self.cutting.amplify,
            decides: self.cutting.decides(),
        };
        methods.into_iter().map(recipe).collect()
    }

    /// Places of all control vertices, as they are shown.
    pub fn points(&self) -> impl Iterator<Item = DVec3> + Clone + '_ {
        self.parts
            .iter()
            .flat_map(|part| part.points().iter().copied())
    }

    /// A sphere around all that is shown, bumps included.
    pub fn sphere(&self) -> Sphere {
        let mut all = Sphere::around(self.points());
        all.radius *= 1.0 + 2.0 * f64::from(self.look.displace.abs());
        all
    }

    /// Moves the camera such that all is seen.
    pub fn fit(&mut self) {
        let mut orbit = self.orbit;
        orbit.fit(self.points(), self.area.aspect());
        self.orbit = orbit;
        self.fit_pending = false;
    }

    /// What is decided about patches: nothing that lines or moved vertices may show is left out.
    pub fn wanted(&self) -> Wanted {
        let wanted = self.cutting.wanted();
        let (moved, lines) = (self.cutting.amplify, self.look.wireframe);
        let culling = wanted.culling;
        Wanted {
            culling: Culling {
                triangles: match moved {
                    true => Cull::None,
                    false => culling.triangles,
                },
                frustum: culling.frustum && !moved,
                small: culling.small && !moved && !lines,
            },
            ..wanted
        }
    }

    /// The camera by which surfaces are cut.
    pub fn cutting_orbit(&self) -> Orbit {
        self.frozen.unwrap_or(self.orbit)
    }

    /// Takes what is to be done for it.
    pub fn take_wishes(&mut self) -> Vec<Wish> {
        std::mem::take(&mut self.wishes)
    }

    /// Whether something moves by itself, so that frames follow one another.
    pub fn is_moving(&self) -> bool {
        self.deform.is_playing()
    }

    /// The part that edits go to: the one with the selection, else the first.
    pub fn edited(&mut self) -> Option<&mut Part> {
        let number = self.selection.part();
        let at = self
            .parts
            .iter()
            .position(|part| Some(part.number()) == number);
        self.parts.get_mut(at.unwrap_or(0))
    }
}
