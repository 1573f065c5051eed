//! By what the levels of patches differ, where they do: the device's decisions, depth tags, and the same for captures of what is shown.

use glam::Vec3;
use hullform::Result;
use hullform::gpu;
use hullform::mesh::Model;
use hullform::method::DepthTags;

use super::{Stage, Staged, view};
use crate::adaptive::Seen;
use crate::capture::By;
use crate::view::context::{Context, Drawn};
use crate::view::part::Part;
use crate::view::viewer::Viewer;
use crate::view::viewport::Area;

impl Staged {
    /// What the levels of a side go by that is shown, for captures of it.
    pub fn levels_by(&self, viewer: &Viewer, recipe: usize, context: &Context) -> Result<By> {
        let number = self.number;
        let part = viewer.parts.iter().find(|part| part.number() == number);
        let sides = Stage::sides(viewer);
        let side = sides.iter().find(|side| side.recipe == recipe);
        let drawn = self.sides.get(recipe);
        let (Some(part), Some(side), Some(drawn)) = (part, side, drawn) else {
            return Ok(By::Cut);
        };
        if viewer.cutting.adaptive.is_none() {
            return Ok(By::Cut);
        }
        if !drawn.is_decided_there() {
            let tags = self.tags(viewer, viewer.cutting.cut().level, part)?;
            return Ok(tags.map_or(By::Cut, By::Tags));
        }
        let samples = context.mould().samples().as_raw();
        let decision = gpu::Decision {
            frustum: false,
            back: false,
            small: None,
            seen_from: None,
            ..self.decision(viewer, part, drawn, (side.viewport, samples))?
        };
        let eye = viewer.cutting_orbit().eye();
        let seen = view(viewer, eye, &self.model, side.viewport);
        Ok(By::Device(decision, seen))
    }

    /// Control vertices as they are shown, in local units.
    fn places(&self, part: &Part) -> Vec<Vec3> {
        let placement = self.model.placement();
        let places = part.points().iter().map(|&p| placement.local(p).as_vec3());
        match part.points().len() == self.model.mesh().vertex_count() {
            true => places.collect(),
            false => self.model.positions(),
        }
    }

    /// What the device decides about patches of what is drawn, in an area of the window with so many samples a pixel.
    pub(super) fn decision(
        &self,
        viewer: &Viewer,
        part: &Part,
        drawn: &Drawn,
        (area, a_pixel): (Area, u32),
    ) -> Result<gpu::Decision> {
        let seen = cutting_eye(viewer, &self.model, area);
        let (outline, places) = (&drawn.surface.prepared().outline, self.places(part));
        let decision = viewer.wanted().decision(outline, &places, seen, a_pixel)?;
        Ok(gpu::Decision {
            // The second view is that of the frozen camera.
            seen_from: viewer.frozen.map(|_| 1),
            ..decision
        })
    }

    /// A depth for each control vertex, by the camera that cuts.
    pub(super) fn tags(
        &self,
        viewer: &Viewer,
        level: f32,
        part: &Part,
    ) -> Result<Option<DepthTags>> {
        let Some(adaptive) = viewer.cutting.adaptive else {
            return Ok(None);
        };
        let Some(drawn) = self.sides.iter().find(|drawn| !drawn.is_decided_there()) else {
            return Ok(None);
        };
        let seen = cutting_eye(viewer, &self.model, viewer.area);
        let places = self.places(part);
        let outline = &drawn.surface.prepared().outline;
        adaptive.tags(outline, &places, level, seen).map(Some)
    }
}

/// From where patches are cut in an area of the window.
fn cutting_eye(viewer: &Viewer, model: &Model, area: Area) -> Seen {
    let placement = model.placement();
    let eye = viewer.cutting_orbit().eye();
    let view = eye.view(placement, area.aspect(), viewer.sphere());
    Seen {
        clip_from_model: view.clip_from_model,
        eye: view.eye,
        scale: placement.scale,
        size: [area.width, area.height].map(|side| side.max(1) as f32),
    }
}
