//! What edits have changed of the picture: where that is a part of it, only that is drawn, and the rest stays.
//!
//! A surface lies in the convex hull of the control vertices that it is a sum of, or of its Bezier points ([`hull_points`]). So what an edit has changed lies around the
//! picture of these points of the patches that it has changed, as they were and as they are; and what is drawn there are the patches whose points have a picture that meets that.

use glam::{Mat4, Vec2, Vec3};
use hullform::Result;
use hullform::frame::hull_points;
use hullform::gpu::{Cut, Decides, Residence};
use hullform::method::Update;

use super::scene::{work, work_of};
use super::{Side, Stage, Staged, view};
use crate::view::context::{Context, Drawn, Few};
use crate::view::viewer::Viewer;
use crate::view::viewport::Area;

/// Points of the window around what has changed of the cage in which its lines and dots lie: half of the widest.
const LINES: f32 = 6.0;
/// Pixels around a patch in which its triangles, and the lines of these, leave anything: rounding, and half a line.
const BESIDE: f32 = 3.0;
/// A share of the vertices, beyond which what moves is taken for all.
const MANY: usize = 8;

/// What has changed of a part.
#[derive(Default)]
pub(super) struct Amends {
    /// Points around the patches of it, before and after, in local units.
    points: Vec<Vec3>,
    /// Vertices around what has changed of the cage.
    lined: Vec<Vec3>,
    /// Whether nobody knows where it is.
    is_anywhere: bool,
}

/// A part of the picture that is another one.
struct Amended {
    /// Where it is in the window.
    area: Area,
    /// By part and side, the patches that may be seen there.
    few: Vec<Vec<Option<Few>>>,
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
                let hull = hull_points(pass, slot as usize, placed);
                self.is_anywhere |= hull.is_empty() && !pass.is_vacant(slot as usize);
                self.points.extend(hull);
            }
        }
    }

    /// Vertices around lines of the cage, at these places.
    pub fn add_lines(&mut self, vertices: &[u32], placed: &[Vec3]) {
        let places = vertices.iter().filter_map(|&v| placed.get(v as usize));
        self.lined.extend(places);
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
                .for_each(|placed| self.add_lines(&[vertex], placed));
        }
        for pass in &drawn.surface.prepared().passes {
            for patch in 0..pass.extent() {
                let hull = pass.hull(patch);
                self.is_anywhere |= hull.is_empty() && !pass.is_vacant(patch);
                if hull.iter().any(has_moved) {
                    places
                        .iter()
                        .for_each(|placed| self.add_lines(&hull, placed));
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
    /// Where a point is seen, in pixels; None where it is not before the eye.
    fn at(&self, point: Vec3) -> Option<Vec2> {
        let port = self.viewport;
        let corner = Vec2::new(port.x as f32, port.y as f32);
        let half = 0.5 * Vec2::new(port.width as f32, port.height as f32);
        let clip = self.clip * point.extend(1.0);
        let at = corner + half * (Vec2::ONE + Vec2::new(clip.x, clip.y) / clip.w);
        (clip.w > 0.0 && at.is_finite()).then_some(at)
    }

    /// The box around the picture of points; None where one is not before the eye.
    fn frame(&self, points: &[Vec3]) -> Option<[Vec2; 2]> {
        bounds(points.iter().map(|&point| self.at(point)))
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

    /// Begins a scene of what edits have changed since the picture was drawn at this level, when all has been decided; whether that could be, and is done sooner than
    /// another picture of all, which may be coarser.
    ///
    /// # Errors
    /// What the library refuses.
    pub fn amend(
        &mut self,
        viewer: &Viewer,
        level: f32,
        is_soon: impl FnOnce(f64, &Stage) -> Result<bool>,
        context: &Context,
    ) -> Result<bool> {
        let Some(amended) = self.amended(viewer)? else {
            return Ok(false);
        };
        let few = amended.few.iter().flatten().flatten();
        let work = few.flat_map(|few| few.works.iter()).sum();
        if !is_soon(work, self)? {
            return Ok(false);
        }
        let device = context.device();
        for (staged, all) in self.parts.iter_mut().zip(amended.few) {
            // What was decided for all is not on the device any more.
            staged.decided = None;
            for (drawn, few) in staged.sides.iter_mut().zip(all) {
                let Some(few) = few else { continue };
                let memory = &mut device.memory();
                // SAFETY: nothing is drawn at this time; device and memory made the surface.
                unsafe { drawn.surface.write_draws(device.raw(), memory, &few.list) }?;
                drawn.few = Some(few);
            }
        }
        self.begin_of(viewer, level, Some(amended.area), context)?;
        Ok(true)
    }

    /// The work that all surfaces are at a cut.
    ///
    /// # Errors
    /// What the library refuses.
    pub fn work(&self, cut: Cut) -> Result<f64> {
        let mut work = 0.0;
        for drawn in self.parts.iter().flat_map(|part| &part.sides) {
            let list = drawn.surface.draw_list(cut, None)?;
            work += list.batches().map(work_of).sum::<f64>();
        }
        Ok(work)
    }

    /// What has changed of the picture; None where that may be all.
    fn amended(&self, viewer: &Viewer) -> Result<Option<Amended>> {
        let sides = Stage::sides(viewer);
        let Some(frame) = self.changed(viewer, &sides) else {
            return Ok(None);
        };
        let area = around(frame, viewer.area);
        let mut few = Vec::new();
        for (number, staged) in self.parts.iter().enumerate() {
            let mut own: Vec<Option<Few>> = staged.sides.iter().map(|_| None).collect();
            for side in sides.iter().filter(|s| s.recipe < staged.sides.len()) {
                let lens = self.lens(viewer, number, side);
                own[side.recipe] = staged.few(side.recipe, &lens, area)?;
            }
            few.push(own);
        }
        Ok(Some(Amended { area, few }))
    }

    /// The box around what has changed in the window, and leaves anything beside it; None where that may be anywhere.
    fn changed(&self, viewer: &Viewer, sides: &[Side]) -> Option<[Vec2; 2]> {
        let mut all = NOTHING;
        for (number, staged) in self.parts.iter().enumerate() {
            let amends = &staged.amends;
            let lines = LINES * viewer.scale + BESIDE;
            for lens in sides.iter().map(|side| self.lens(viewer, number, side)) {
                for (points, beside) in [(&amends.points, BESIDE), (&amends.lined, lines)] {
                    let [low, high] = lens.frame(points).filter(|_| !amends.is_anywhere)?;
                    all = [all[0].min(low - beside), all[1].max(high + beside)];
                }
            }
        }
        Some(all)
    }
}

impl Staged {
    /// What of a side may be seen in an area.
    fn few(&self, recipe: usize, lens: &Lens, area: Area) -> Result<Option<Few>> {
        let drawn = &self.sides[recipe];
        let Some(list) = &drawn.list else {
            return Ok(None);
        };
        let (prepared, cut) = (drawn.surface.prepared(), list.cut());
        let places: Vec<Option<Vec2>> = self.placed.iter().map(|&at| lens.at(at)).collect();
        let may_be_seen = |pass: usize, patch: u32| {
            let (pass, patch) = (&prepared.passes[pass], patch as usize);
            let hull = pass.hull(patch);
            // What is not known is anywhere, and so is what may be behind the eye.
            let meets = |frame: Option<_>| frame.is_none_or(|frame| meets(frame, area));
            let is_near =
                hull.is_empty() || meets(bounds(hull.iter().map(|&v| places[v as usize])));
            let is_there = || meets(lens.frame(&hull_points(pass, patch, &self.placed)));
            is_near && (pass.spline(patch).is_none() || is_there())
        };
        let list = list.clone().only(prepared, may_be_seen)?;
        let mut all = 0;
        let works = list.batches().map(|batch| {
            let pass = batch.pass();
            let own = batch.patches().map(|patch| {
                let vertices = list.vertices(prepared, pass, patch);
                all += u64::from(vertices);
                match vertices {
                    0 => 0.0,
                    _ => work(vertices, cut.points(&prepared.passes[pass], patch as usize)),
                }
            });
            own.sum()
        });
        let works = works.collect();
        Ok(Some(Few {
            works,
            vertices: all,
            list,
        }))
    }
}

/// The box around nothing.
const NOTHING: [Vec2; 2] = [Vec2::INFINITY, Vec2::NEG_INFINITY];

/// The box around places; None where one is not known.
fn bounds(mut places: impl Iterator<Item = Option<Vec2>>) -> Option<[Vec2; 2]> {
    places.try_fold(NOTHING, |[low, high], at| {
        at.map(|at| [low.min(at), high.max(at)])
    })
}

/// The pixels around a frame within an area; one at least.
fn around([low, high]: [Vec2; 2], within: Area) -> Area {
    let first = |at: f32, first: u32, length: u32| {
        let last = first + length.saturating_sub(1);
        (at.floor().max(0.0) as u32).clamp(first, last)
    };
    let end = |at: f32, start: u32, first: u32, length: u32| {
        (at.ceil().max(0.0) as u32).clamp(start + 1, (first + length).max(start + 1))
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
            } = around([low.into(), high.into()], WINDOW);
            [x, y, width, height]
        };
        assert_eq!(area([48.0, 38.2], [62.5, 47.0]), [48, 38, 15, 9]);
        assert_eq!(area([-9e9, 0.0], [9e9, 1e30]), [10, 20, 100, 50]);
        assert_eq!(area([300.0, 300.0], [400.0, 400.0]), [109, 69, 1, 1]);
        let Area { width, height, .. } = around(NOTHING, WINDOW);
        assert_eq!([width, height], [1, 1]);
    }

    #[test]
    fn what_lies_behind_the_eye_is_anywhere_and_what_touches_meets() {
        let lens = Lens {
            // The eye looks along -z: w is the distance before it.
            clip: Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::NEG_W, Vec4::Z),
            viewport: WINDOW,
        };
        let ahead = lens.frame(&[Vec3::NEG_Z]).expect("it is seen");
        assert_eq!(ahead, [Vec2::new(60.0, 45.0); 2]);
        assert!(lens.frame(&[Vec3::NEG_Z, Vec3::Z]).is_none());
        let at = |x: f32| [Vec2::new(x, 45.0), Vec2::new(x + 5.0, 46.0)];
        assert!(meets(at(107.0), WINDOW) && meets(at(112.0), WINDOW));
        assert!(!meets(at(114.0), WINDOW) && !meets(at(0.0), WINDOW));
    }
}
