//! What was captured of the surfaces that are shown, and how far they are from the truth: computed beside the window, and kept.

use std::sync::{Arc, OnceLock};

use hullform::Result;
use hullform::gpu::Cut;
use hullform::host::ColouredVertex;
use hullform::mesh::{Model, Scheme};
use hullform::subdivision::LimitSurface;
use indicatif::ProgressBar;

use super::context::{Context, Recipe, prepare, under_scheme};
use super::draft::Draft;
use super::orbit::Orbit;
use super::probe::Boxes;
use super::viewer::ErrorKind;
use super::workers::Entrance;
use crate::adaptive::Adaptive;
use crate::camera::View;
use crate::capture;
use crate::compare::errors::{Errors, Known, Reference, Summary};
use crate::compare::picture::coloured;
use crate::compare::scale::Scale;
use crate::db::database;
use crate::drawing;
use crate::eye::Sphere;
use crate::options::{Cutting, Triangulate};
use crate::output::Surface;

/// What a measurement is of: when it differs, another is due.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    /// The part.
    pub part: u64,
    /// Its version.
    pub version: [u64; 2],
    /// Its places.
    pub moves: u64,
    /// The scheme.
    pub scheme: Option<Scheme>,
    /// How it is prepared.
    pub recipe: Recipe,
    /// The version of the shaders.
    pub shaders: u64,
    /// How it is cut.
    pub cut: Cut,
    /// By what levels differ, where they do.
    pub adapted: Option<Adapted>,
}

/// By what levels differ from patch to patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adapted {
    /// What they go by.
    pub by: Adaptive,
    /// The camera that cuts.
    pub orbit: Orbit,
    /// The size of its picture in pixels.
    pub size: [u32; 2],
    /// What else may be seen there, which planes go by.
    pub all: Sphere,
}

/// A surface as the device makes it, with what is asked of it.
pub struct Measured {
    /// Of what.
    pub subject: Subject,
    /// The model in its present pose.
    pub model: Model,
    /// Points and triangles.
    pub surface: Surface,
    /// Its triangles, to be found quickly.
    pub boxes: Boxes,
    /// The truth.
    pub limit: LimitSurface,
    /// The errors at all points, once they are known.
    pub errors: OnceLock<Errors>,
    /// How far that is.
    pub progress: ProgressBar,
}

/// Captures a surface. Takes its time: for workers.
pub fn measure(
    entrance: &Entrance<Context>,
    draft: &Draft,
    triangulate: Triangulate,
    subject: Subject,
    by: capture::By,
) -> Result<Measured> {
    let mesh = draft.mesh()?;
    let scheme = subject.scheme.unwrap_or(mesh.options().scheme);
    let model = Model::new(under_scheme(mesh, scheme, triangulate)?);
    let (prepared, _) = prepare(&model, subject.recipe.method, database()?)?;
    let context = entrance.enter()?;
    let bench = drawing::blind(&context.gpu)?;
    // SAFETY: the modules are ours, or what somebody makes of them to look at.
    let bench = unsafe { bench.with_modules(context.shaders().modules) };
    let cutting = Cutting {
        cut: subject.cut,
        backend: subject.recipe.backend,
        residence: subject.recipe.residence,
        adaptive: None,
    };
    let how = (cutting, by);
    let (gpu, global) = (&context.gpu, &context.global);
    let surface = capture::captured(gpu, &bench, &model, prepared, how, global)?;
    Ok(Measured {
        boxes: Boxes::new(&surface),
        limit: LimitSurface::new(model.mesh()),
        errors: OnceLock::new(),
        progress: ProgressBar::hidden(),
        subject,
        surface,
        model,
    })
}

impl Measured {
    /// Asks the truth at every point. Takes its time: for workers.
    pub fn compare(&self) {
        let limit = Box::new(LimitSurface::new(self.model.mesh()));
        let mut known = Known::new(Reference::Truth(limit, self.model.placement()));
        known.learn(&self.surface, &self.progress);
        let errors = Errors::new(&self.surface, &known, &self.model);
        // A second comparison of the same surface has the same errors.
        let _ = self.errors.set(errors);
    }

    /// The map of an error as seen in a view.
    pub fn map(&self, kind: ErrorKind, scale: Scale, view: &View) -> Option<Vec<ColouredVertex>> {
        let errors = self.errors.get()?;
        let errors = match kind {
            ErrorKind::Position => &errors.positions,
            ErrorKind::Normal => &errors.normals,
        };
        Some(coloured(&self.model, &self.surface, errors, scale, view))
    }

    /// What its errors amount to.
    pub fn summary(&self, kind: ErrorKind) -> Option<Summary> {
        let errors = self.errors.get()?;
        Some(match kind {
            ErrorKind::Position => errors.position,
            ErrorKind::Normal => errors.normal,
        })
    }
}

/// What the colours of a map mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// Which error.
    pub kind: ErrorKind,
    /// Its decades.
    pub scale: Scale,
    /// The greatest that there is, a side.
    pub greatest: Vec<f64>,
}

impl Legend {
    /// The scale for all that is shown; None before anything is known.
    pub fn of(kind: ErrorKind, all: &[Arc<Measured>]) -> Option<Legend> {
        let summaries: Vec<Summary> = all.iter().filter_map(|one| one.summary(kind)).collect();
        if summaries.is_empty() {
            return None;
        }
        let greatest: Vec<f64> = summaries.iter().map(|summary| summary.maximum).collect();
        let typical: Vec<f64> = summaries.iter().map(|summary| summary.rms).collect();
        let bounds = match kind {
            ErrorKind::Position => [-9, 1],
            ErrorKind::Normal => [-5, 2],
        };
        Some(Legend {
            kind,
            scale: Scale::over(&typical, &greatest, bounds),
            greatest,
        })
    }

    /// The numbers at both ends.
    pub fn ends(&self) -> (String, String) {
        let end = |power: i32| format!("1e{power}");
        (end(self.scale.low), end(self.scale.high))
    }

    /// What is shown, and the greatest of it.
    pub fn title(&self) -> String {
        let greatest = self
            .greatest
            .iter()
            .map(|greatest| format!("{greatest:.1e}"));
        let greatest: Vec<String> = greatest.collect();
        let what = match self.kind {
            ErrorKind::Position => "position error / diagonal",
            ErrorKind::Normal => "normal error in degrees",
        };
        format!("{what}, at most {}", greatest.join(" and "))
    }
}
