//! What edits have changed of the picture: where that is a part of it, only that is drawn, and the rest stays.
//!
//! A surface lies in the convex hull of the control vertices that it is a sum of ([`Pass::hull`](hullform::method::Pass::hull)). So what an edit has changed lies around the
//! picture of the vertices of the patches that it has changed, as they were and as they are; and what is drawn there are the patches whose vertices have a picture that meets that.

use std::sync::Arc;

use glam::{Mat4, Vec2, Vec3};
use hullform::gpu::{Decides, Residence};
use hullform::method::Update;

use super::scene::work_of;
use super::{Side, Stage, view};
use crate::view::context::{Context, Drawn};
use crate::view::viewer::Viewer;
use crate::view::viewport::Area;

/// Points of the window around what has changed in which lines and dots of the cage lie: half of the widest.
const LINES: f32 = 6.0;
/// Pixels around a patch in which its triangles, and the lines of these, leave anything: rounding, and half a line.
const BESIDE: f32 = 3.0;
/// What takes less than such a share of the whole picture's work is drawn sooner than a coarser picture, of which each patch is still to be drawn.
const FEW: f64 = 8.0;
/// A share of the vertices, beyond which what moves is taken for all.
const MANY: usize = 8;

/// What has changed of a part.
#[derive(Default)]
pub(super) struct Amends {
    /// Places of the vertices around it, before and after, in local units.
    points: Vec<Vec3>,
    /// Whether nobody knows where it is.
    is_anywhere: bool,
}

/// A part of the picture that is another one.
pub(super) struct Amended {
    /// Where it is in the window.
    pub area: Area,
    /// By part and side, the batches that may be seen there.
    pub batches: Vec<Vec<Arc<[bool]>>>,
}

impl Amends {
    /// Nothing has changed.
    pub fn clear(&mut self) {
        *self = Amends::default();
    }

    /// The patches that an edit has changed, as they are, with vertices at these places.
    pub fn add_patches(&mut self, drawn: &Drawn, update: &Update, placed: &[Vec3]) {
        self.is_anywhere |= !is_amendable(drawn);
        let prepared = drawn.surface.prepared();
        for (pass, change) in prepared.passes.iter().zip(&update.passes) {
            for &slot in change.slots() {
                let (slot, hull) = (slot as usize, pass.hull(slot as usize));
                self.is_anywhere |= hull.is_empty() && !pass.is_vacant(slot);
                self.add_vertices(hull, placed);
            }
        }
    }

    /// Vertices, at these places.
    pub fn add_vertices(&mut self, vertices: &[u32], placed: &[Vec3]) {
        let places = vertices.iter().filter_map(|&v| placed.get(v as usize));
        self.points.extend(places);
    }

    /// The patches of which vertices have moved from some places to others.
    pub fn add_moves(&mut self, drawn: &Drawn, places: [&[Vec3]; 2]) {
        let [was, is] = places;
        let moved: Vec<bool> = was.iter().zip(is).map(|(a, b)| a != b).collect();
        let count = moved.iter().filter(|moved| **moved).count();
        if self.is_anywhere || !is_amendable(drawn) || count > moved.len() / MANY {
            self.is_anywhere |= count > 0;
            return;
        }
        let has_moved = |&vertex: &u32| moved.get(vertex as usize).copied().unwrap_or(true);
        for vertex in (0..moved.len() as u32).filter(has_moved) {
            places
                .iter()
                .for_each(|placed| self.add_vertices(&[vertex], placed));
        }
        for pass in &drawn.surface.prepared().passes {
            for patch in 0..pass.extent() {
                let hull = pass.hull(patch);
                self.is_anywhere |= hull.is_empty() && !pass.is_vacant(patch);
                if hull.iter().any(has_moved) {
                    places
                        .iter()
                        .for_each(|placed| self.add_vertices(hull, placed));
                }
            }
        }
    }
}

/// Whether a part of it can be drawn: nothing of what is drawn depends on what is seen elsewhere.
fn is_amendable(drawn: &Drawn) -> bool {
    let options = drawn.surface.options();
    options.residence == Residence::Ring && options.decides == Decides::Host
}

/// Where local units are seen in the window.
struct Lens {
    clip: Mat4,
    viewport: Area,
}

impl Lens {
    /// The box around the picture of points, in pixels; None where one is not before the eye.
    fn frame(&self, points: impl Iterator<Item = Vec3>) -> Option<[Vec2; 2]> {
        let port = self.viewport;
        let corner = Vec2::new(port.x as f32, port.y as f32);
        let half = 0.5 * Vec2::new(port.width as f32, port.height as f32);
        let mut frame = [Vec2::INFINITY, Vec2::NEG_INFINITY];
        for point in points {
            let clip = self.clip * point.extend(1.0);
            let at = corner + half * (Vec2::ONE + Vec2::new(clip.x, clip.y) / clip.w);
            if !(clip.w > 0.0 && at.is_finite()) {
                return None;
            }
            frame = [frame[0].min(at), frame[1].max(at)];
        }
        Some(frame)
    }
}

impl Stage {
    fn lens(&self, viewer: &Viewer, part: usize, side: &Side) -> Lens {
        let eye = viewer.orbit.eye();
        let seen = view(viewer, eye, &self.parts[part].model, side.viewport);
        Lens {
            clip: Mat4::from_cols_array_2d(&seen.clip_from_model),
            viewport: side.viewport,
        }
    }

    /// At which level the picture is that is seen, where a part of it can be drawn anew after edits: the camera and all looks are the same.
    pub fn amendable(&self, viewer: &Viewer) -> Option<f32> {
        let (level, all) = self.shown?;
        let (look, cutting) = (&viewer.look, &viewer.cutting);
        let is_plain = look.displace == 0.0 && !cutting.amplify && cutting.adaptive.is_none();
        let is_known = viewer.compare.map.is_none() && all == viewer.sphere();
        (is_plain && is_known).then_some(level)
    }

    /// Begins a scene of what edits have changed since the picture was drawn at this level, when all has been decided; whether that could be, and is work enough for a frame.
    pub fn amend(
        &mut self,
        viewer: &Viewer,
        level: f32,
        is_quick: impl Fn(f64) -> bool,
        context: &Context,
    ) -> bool {
        let Some(amended) = self.amended(viewer) else {
            return false;
        };
        let shown = self.shown;
        let amends = self.parts.iter_mut().map(|s| std::mem::take(&mut s.amends));
        let amends: Vec<Amends> = amends.collect();
        self.begin_of(viewer, level, Some(&amended), context);
        let work = self.scene().map_or(0.0, |scene| scene.work(&self.parts));
        if is_quick(work) || work * FEW <= self.work() {
            return true;
        }
        (self.scene, self.shown) = (None, shown);
        let parts = self.parts.iter_mut().zip(amends);
        parts.for_each(|(staged, amends)| staged.amends = amends);
        false
    }

    /// The work that all surfaces are at the level that was decided.
    fn work(&self) -> f64 {
        let lists = self.parts.iter().flat_map(|part| &part.sides);
        let batches = lists.filter_map(|drawn| drawn.list.as_ref());
        batches.flat_map(|list| list.batches()).map(work_of).sum()
    }

    /// What has changed of the picture; None where that may be all.
    fn amended(&self, viewer: &Viewer) -> Option<Amended> {
        let sides = Stage::sides(viewer);
        let mut frame = [Vec2::INFINITY, Vec2::NEG_INFINITY];
        for (number, staged) in self.parts.iter().enumerate() {
            if staged.amends.is_anywhere {
                return None;
            }
            for side in &sides {
                let lens = self.lens(viewer, number, side);
                let [low, high] = lens.frame(staged.amends.points.iter().copied())?;
                frame = [frame[0].min(low), frame[1].max(high)];
            }
        }
        let area = around(frame, LINES * viewer.scale + BESIDE, viewer.area);
        let mut batches = Vec::new();
        for number in 0..self.parts.len() {
            let mut own = vec![Arc::from([]); self.parts[number].sides.len()];
            for side in &sides {
                if side.recipe < own.len() {
                    own[side.recipe] = self.batches(viewer, number, side, area)?;
                }
            }
            batches.push(own);
        }
        Some(Amended { area, batches })
    }

    /// Which batches of a part may be seen in an area.
    fn batches(
        &self,
        viewer: &Viewer,
        part: usize,
        side: &Side,
        area: Area,
    ) -> Option<Arc<[bool]>> {
        let staged = &self.parts[part];
        let (drawn, lens) = (&staged.sides[side.recipe], self.lens(viewer, part, side));
        let place = |&vertex: &u32| staged.placed[vertex as usize];
        let passes = &drawn.surface.prepared().passes;
        let batches = drawn.list.as_ref()?.batches().map(|batch| {
            let pass = &passes[batch.pass()];
            batch.patches().any(|patch| {
                let hull = pass.hull(patch as usize);
                let frame = lens.frame(hull.iter().map(place));
                let is_unknown = hull.is_empty() && !pass.is_vacant(patch as usize);
                is_unknown || frame.is_none_or(|frame| meets(frame, area))
            })
        });
        Some(batches.collect())
    }
}

/// The pixels around a frame, so many more on each side, within an area; one at least.
fn around([low, high]: [Vec2; 2], more: f32, within: Area) -> Area {
    let first = |at: f32, first: u32, length: u32| {
        let last = first + length.saturating_sub(1);
        ((at - more).floor().max(0.0) as u32).clamp(first, last)
    };
    let end = |at: f32, start: u32, first: u32, length: u32| {
        ((at + more).ceil().max(0.0) as u32).clamp(start + 1, (first + length).max(start + 1))
    };
    let (x, y) = (
        first(low.x, within.x, within.width),
        first(low.y, within.y, within.height),
    );
    Area {
        x,
        y,
        width: end(high.x, x, within.x, within.width) - x,
        height: end(high.y, y, within.y, within.height) - y,
    }
}

/// Whether anything of a patch whose vertices are seen in a frame may be seen in an area.
fn meets([low, high]: [Vec2; 2], area: Area) -> bool {
    let first = Vec2::new(area.x as f32, area.y as f32) - BESIDE;
    let end = first + Vec2::new(area.width as f32, area.height as f32) + 2.0 * BESIDE;
    low.cmple(end).all() && high.cmpge(first).all()
}

#[cfg(test)]
mod tests {
    use glam::Vec4;

    use super::*;

    const WINDOW: Area = Area {
        x: 10,
        y: 20,
        width: 100,
        height: 50,
    };

    #[test]
    fn what_changes_is_within_the_area_and_one_pixel_at_least() {
        let area = |low: [f32; 2], high: [f32; 2]| {
            let Area {
                x,
                y,
                width,
                height,
            } = around([low.into(), high.into()], 2.0, WINDOW);
            [x, y, width, height]
        };
        assert_eq!(area([50.0, 40.0], [60.5, 45.0]), [48, 38, 15, 9]);
        assert_eq!(area([-9e9, 0.0], [9e9, 1e30]), [10, 20, 100, 50]);
        assert_eq!(area([300.0, 300.0], [400.0, 400.0]), [109, 69, 1, 1]);
        let nothing = [Vec2::INFINITY, Vec2::NEG_INFINITY];
        let Area { width, height, .. } = around(nothing, 2.0, WINDOW);
        assert_eq!([width, height], [1, 1]);
    }

    #[test]
    fn what_lies_behind_the_eye_is_anywhere_and_what_touches_meets() {
        let lens = Lens {
            // The eye looks along -z: w is the distance before it.
            clip: Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::NEG_W, Vec4::Z),
            viewport: WINDOW,
        };
        let ahead = lens.frame([Vec3::NEG_Z].into_iter()).expect("it is seen");
        assert_eq!(ahead, [Vec2::new(60.0, 45.0); 2]);
        assert!(lens.frame([Vec3::NEG_Z, Vec3::Z].into_iter()).is_none());
        let at = |x: f32| [Vec2::new(x, 45.0), Vec2::new(x + 5.0, 46.0)];
        assert!(meets(at(107.0), WINDOW) && meets(at(112.0), WINDOW));
        assert!(!meets(at(114.0), WINDOW) && !meets(at(0.0), WINDOW));
    }
}
