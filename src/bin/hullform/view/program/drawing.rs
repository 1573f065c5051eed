//! What the picture of the scene depends on, and what lies over it.

use std::sync::Arc;

use super::Program;
use crate::view::errors::{Legend, Measured};
use crate::view::orbit::Orbit;
use crate::view::overlay::Overlay;
use crate::view::selection::Selection;
use crate::view::stage::{Side, Stage};
use crate::view::viewer::{Compare, Cutting, Look};

/// What a picture of the scene depends on.
#[derive(Clone, PartialEq)]
pub(super) struct Drawing {
    look: Look,
    cutting: Cutting,
    compare: Compare,
    orbit: Orbit,
    frozen: Option<Orbit>,
    selection: Selection,
    sides: Vec<Side>,
    parts: Vec<(u64, u64, u64)>,
    legend: Option<Legend>,
    ready: usize,
}

impl Drawing {
    /// What the colours of its map mean.
    pub fn legend(&self) -> Option<&Legend> {
        self.legend.as_ref()
    }

    /// Whether it differs from another by edits of the same models, if at all.
    pub fn is_edited(&self, other: &Drawing) -> bool {
        let numbers = |all: &[(u64, u64, u64)]| all.iter().map(|part| part.0).collect::<Vec<_>>();
        let parts = other.parts.clone();
        numbers(&self.parts) == numbers(&parts)
            && Drawing {
                parts,
                ..self.clone()
            } == *other
    }
}

impl Program {
    /// What the colours of the map mean that is shown.
    pub(super) fn legend(&self) -> Option<Legend> {
        let kind = self.viewer.compare.map?;
        let sides = Stage::sides(&self.viewer);
        let parts = self.stage.parts.iter();
        let all = parts.flat_map(|staged| sides.iter().map(move |side| (staged, side.recipe)));
        let all = all.filter_map(|(staged, side)| self.measured(staged, side).cloned());
        let all: Vec<Arc<Measured>> = all.collect();
        Legend::of(kind, &all)
    }

    /// What the picture of the scene depends on, as it is.
    pub(super) fn drawing(&self) -> Drawing {
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

    pub(super) fn overlay(&self, scale: f64, legend: Option<&Legend>) -> Overlay {
        let sides = Stage::sides(&self.viewer);
        let area = sides.first().map_or(self.viewer.area, |side| side.viewport);
        let mut overlay = Overlay::new(&self.viewer, area, scale);
        overlay.maps = vec![Default::default(); 2];
        let Some(legend) = legend else { return overlay };
        let (eye, all) = (self.viewer.orbit.eye(), self.viewer.sphere());
        for side in &sides {
            let (vertices, triangles) = &mut overlay.maps[side.recipe];
            for staged in &self.stage.parts {
                let Some(measured) = self.measured(staged, side.recipe) else {
                    continue;
                };
                let view = eye.view(measured.model.placement(), side.viewport.aspect(), all);
                let Some(map) = measured.map(legend.kind, legend.scale, &view) else {
                    continue;
                };
                overlay.mapped.push((side.recipe, staged.number));
                let first = vertices.len() as u32;
                vertices.extend(map);
                let own = measured.surface.triangles.iter();
                triangles.extend(own.map(|triangle| triangle.map(|corner| first + corner)));
            }
        }
        overlay
    }
}
