//! What is under the cursor.

use glam::DVec2;
use hullform::tessellation::Levels;

use super::Program;
use crate::view::piece::Piece;
use crate::view::probe::Ray;
use crate::view::stage::{Side, Stage};
use crate::view::viewer::Viewer;

impl Program {
    /// What is under the cursor.
    pub(super) fn look_under_cursor(&mut self) {
        self.found = self.probe.and_then(|at| {
            let sides = Stage::sides(&self.viewer);
            let (side, at) = under(&self.viewer, &sides, at)?;
            let eye = self.viewer.orbit.eye();
            let ray = Ray::new(&eye, at, side.viewport.aspect());
            let parts = self.stage.parts.iter();
            let all = parts.filter_map(|staged| {
                let found = self.measured(staged, side.recipe)?.find(ray)?;
                Some((staged, found))
            });
            let (staged, mut found) =
                all.min_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance))?;
            found.piece = staged.sides.get(side.recipe).and_then(|drawn| {
                let uv = found.uv.map(|x| x as f32);
                let prepared = drawn.surface.prepared();
                let decided = |pass: usize, patch: usize| {
                    let there = drawn.is_decided_there();
                    let record = drawn
                        .surface
                        .decided(pass, 0)
                        .get(patch)
                        .filter(|_| there)?;
                    Some(Levels {
                        domain: prepared.passes[pass].domain,
                        cells: [1; 2],
                        edges: record.edges,
                        inside: record.inside,
                    })
                };
                Piece::new(prepared, drawn.list.as_ref()?, decided, found.face, uv)
            });
            Some(found)
        });
    }
}

/// The side at a place of the picture (-1..1, y up), and the place in that side's own view.
fn under<'s>(viewer: &Viewer, sides: &'s [Side], at: [f64; 2]) -> Option<(&'s Side, DVec2)> {
    let area = viewer.area;
    let pixel = f64::from(area.x) + 0.5 * (at[0] + 1.0) * f64::from(area.width);
    let inside = |side: &&Side| {
        let left = f64::from(side.scissor.x);
        (left..left + f64::from(side.scissor.width)).contains(&pixel)
    };
    let side = sides.iter().find(inside)?;
    let port = side.viewport;
    let x = 2.0 * (pixel - f64::from(port.x)) / f64::from(port.width.max(1)) - 1.0;
    Some((side, DVec2::new(x, at[1])))
}
