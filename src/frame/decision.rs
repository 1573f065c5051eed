//! What the device decides about patches in each frame: their levels, and which are not drawn at all.

use glam::{BVec3, Mat4, Vec3, Vec4, Vec4Swizzles};

use crate::abi;
use crate::frame::culling::{Culled, are_within_cells, is_back, is_outside, is_small};
use crate::frame::{Cut, Seen};
use crate::method::{Outline, Pass, depth_at};
#[cfg(feature = "vulkan")]
use crate::tessellation::Spacing;
use crate::tessellation::{Levels, levels_of_edges};

/// By what the device decides about patches, in each view by itself. A level belongs to an edge of the mesh and depends on nothing but the limits of its ends
/// ([`Outline::limits`]), so both sides agree to the bit; where levels are not whole, spacing is fractional and nothing pops.
///
/// What is left out is left out before its control points are computed, and conservatively: pictures stay the same, pixel by pixel; but where
/// [`back`](Self::back) says otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decision {
    /// Levels; none is above the cut's.
    pub metric: Metric,
    /// Whether patches outside of the picture are left out. By the convex hull of their control vertices, with displacement; methods that do not keep
    /// within it are drawn as they are.
    pub frustum: bool,
    /// Whether patches are left out that show nothing but their backs, for pipelines that cull these (`gpu::Target::cull`), in a
    /// viewport whose height is no negative one. By the cone of normals of B-spline patches, and of macro faces of such; all others, and what is displaced, are drawn as they are.
    /// Triangles much smaller than a pixel that rounding turns at a silhouette are not seen then.
    pub back: bool,
    /// Whether patches are left out that no sample can be in, for pipelines that fill triangles. By the hull, as beyond the picture.
    pub small: Option<Samples>,
    /// The first of as many views to decide by, instead of those that are drawn: a frozen camera that another one looks at.
    pub seen_from: Option<u32>,
}

/// Where samples are: in the standard places of 1, 2, 4 or 8 a pixel (`standardSampleLocations`), of a viewport that begins with a whole pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Samples {
    /// Samples a pixel: 1, 2, 4 or 8.
    pub a_pixel: u32,
    /// Width and height of the viewport in pixels; that of [`Metric::Screen`], where levels go by that.
    pub size: [f32; 2],
}

/// What levels go by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Metric {
    /// All have the cut's level.
    #[default]
    Cut,
    /// The distance of an edge's nearer end from the eye (Brainerd et al. 2016, section 9.3): the cut's level up to this one, in local units, and half of it
    /// at twice as much.
    Distance(f32),
    /// What can be seen of an edge, wherever it points to: segments of at most so many pixels, greater than 0, in a picture of this width and height.
    Screen {
        /// Pixels of a segment.
        pixels: f32,
        /// Width and height of the picture in pixels.
        size: [f32; 2],
    },
    /// The curvature, whatever the view: from one end of a segment to the other normals turn by at most so many degrees. Those of a vertex are the
    /// directions of the corners of the faces around, by their areas.
    Curvature(f32),
}

/// The record of a patch at the depth that all irregularities have where the device decides.
fn at_cut(pass: &Pass, patch: usize, cut: Cut) -> Option<abi::Patch> {
    pass.at_depths(patch, |_| depth_at(cut.level))
}

impl Decision {
    /// As shaders have it, for views from `view` on, of which `eyes` are decided for together.
    #[cfg(feature = "vulkan")]
    pub(crate) fn record(
        &self,
        view: u32,
        eyes: u32,
        cut: Cut,
        max_level: u32,
        vertices: u32,
    ) -> abi::Decision {
        let (metric, measure, size) = match self.metric {
            Metric::Cut => (0, 1.0, [1.0; 2]),
            Metric::Distance(near) => (abi::DECIDE_DISTANCE, near, [1.0; 2]),
            Metric::Screen { pixels, size } => (abi::DECIDE_SCREEN, pixels, size),
            Metric::Curvature(degrees) => (abi::DECIDE_CURVATURE, degrees.to_radians(), [1.0; 2]),
        };
        let flag = |on: bool, flag: u32| if on { flag } else { 0 };
        let rows = self.small.map_or(0, |samples| samples.a_pixel);
        let flags = flag(
            cut.spacing == Spacing::FractionalEven,
            abi::FRAME_FRACTIONAL_EVEN,
        ) | flag(self.frustum, abi::DECIDE_FRUSTUM)
            | flag(self.back, abi::DECIDE_BACK)
            | flag(self.small.is_some(), abi::DECIDE_SMALL);
        abi::Decision {
            view,
            seen: self.seen_from.unwrap_or(view),
            flags: metric | flags | rows << abi::DECIDE_ROWS_SHIFT | eyes << abi::FRAME_EYES_SHIFT,
            measure,
            level: cut.spacing.clamp(cut.level, max_level),
            size: self.small.map_or(size, |samples| samples.size),
            vertices,
        }
    }

    /// What the device decides about a patch in one view: its levels, all zero where it is not drawn. Twin of `glsl/decide.comp`, up to what devices may
    /// round differently. None where there is no such patch.
    pub fn levels(
        &self,
        outline: &Outline,
        pass: &Pass,
        patch: usize,
        vertices: &[Vec3],
        cut: Cut,
        seen: &Seen,
    ) -> Option<Levels> {
        let none = Levels {
            domain: pass.domain,
            cells: [1; 2],
            edges: [0.0; 4],
            inside: 0.0,
        };
        let is_drawn = !pass.is_vacant(patch) && at_cut(pass, patch, cut).is_some();
        if patch < pass.patches.len() && !is_drawn {
            return Some(none);
        }
        let decided = self.decide(outline, pass, patch, vertices, cut, seen)?;
        Some(decided.unwrap_or(none))
    }

    /// The same, or why the patch is not drawn; None also where its slot is vacant, or it is not drawn at the depth of the cut.
    pub fn decide(
        &self,
        outline: &Outline,
        pass: &Pass,
        patch: usize,
        vertices: &[Vec3],
        cut: Cut,
        seen: &Seen,
    ) -> Option<Result<Levels, Culled>> {
        let record = &at_cut(pass, patch, cut).filter(|_| !pass.is_vacant(patch))?;
        let sides = pass.sides.get(patch)?;
        let place = |&vertex: &u32| vertices[vertex as usize];
        let points: Vec<Vec3> = pass.hull(patch).iter().map(place).collect();
        let own = pass.own_vertices(outline, patch);
        let own: Vec<Vec3> = own.iter().map(place).collect();
        if self.frustum && !points.is_empty() && is_outside(&own, &points, seen) {
            return Some(Err(Culled::Frustum));
        }
        if let Some(Samples { a_pixel, size }) = self.small.filter(|_| !points.is_empty())
            && is_small(&points, seen, size, a_pixel as f32)
        {
            return Some(Err(Culled::Small));
        }
        let level = |&side: &u32| self.level_of_side(outline, side, vertices, cut, seen);
        let edges = sides.each_ref().map(level);
        let levels = levels_of_edges(pass.domain, record, edges, cut.spacing, pass.max_level);
        let splines = match self.back && are_within_cells(&levels) {
            true => pass.splines(patch),
            false => Vec::new(),
        };
        let is_back = |points: &[u32; 16]| {
            let points = points.each_ref().map(place);
            is_back(&points, seen, &levels, cut.spacing)
        };
        if !splines.is_empty() && splines.iter().all(is_back) {
            return Some(Err(Culled::Back));
        }
        Some(Ok(levels))
    }

    /// Whether anything of an instance may be seen, all of whose control vertices are in a box from `low` to `high`, in local units: of one that is not, no
    /// patch would be drawn by methods that keep within hulls. So a frame can go without its views, before anything is decided about its patches.
    pub fn may_show(&self, [low, high]: [Vec3; 2], seen: &Seen) -> bool {
        let corners: [Vec3; 8] = std::array::from_fn(|i| {
            let is_high = BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0);
            Vec3::select(is_high, high, low)
        });
        let outside = self.frustum && is_outside(&corners, &corners, seen);
        let is_small = |Samples { a_pixel, size }| is_small(&corners, seen, size, a_pixel as f32);
        !outside && !self.small.is_some_and(is_small)
    }

    /// The level of an edge, or the greatest of a face's.
    fn level_of_side(
        &self,
        outline: &Outline,
        side: u32,
        vertices: &[Vec3],
        cut: Cut,
        seen: &Seen,
    ) -> f32 {
        if self.metric == Metric::Cut {
            return cut.level;
        }
        let list = outline.side(side);
        let edges = if list.len() == 2 { 1 } else { list.len() };
        let ends = |edge: usize| [edge, (edge + 1) % list.len()].map(|i| list[i]);
        let levels = (0..edges).map(|edge| match self.metric {
            Metric::Curvature(degrees) => {
                turn(outline, ends(edge), vertices) / degrees.to_radians()
            }
            _ => self.level_of_ends(
                ends(edge).map(|end| outline.limit(end, vertices)),
                cut,
                seen,
            ),
        });
        levels.fold(cut.spacing.least(), f32::max).min(cut.level)
    }

    fn level_of_ends(&self, [a, b]: [Vec3; 2], cut: Cut, seen: &Seen) -> f32 {
        match self.metric {
            Metric::Cut | Metric::Curvature(_) => cut.level,
            Metric::Distance(near) => {
                let eye = Vec3::from(seen.eye);
                let away = a.distance_squared(eye).min(b.distance_squared(eye)).sqrt();
                cut.level * (near / away.max(near))
            }
            Metric::Screen { pixels, size } => {
                let clip = Mat4::from_cols_array_2d(&seen.clip_from_model);
                let scale = |row: Vec4, size: f32| 0.5 * size * row.xyz().length();
                let scale = scale(clip.row(0), size[0]).max(scale(clip.row(1), size[1]));
                let depth = |point: Vec3| clip.row(3).dot(point.extend(1.0));
                let away = depth(a).min(depth(b)).max(1e-37);
                a.distance(b) * scale / away / pixels
            }
        }
    }
}

/// By how many radians normals turn between the ends of an edge.
fn turn(outline: &Outline, ends: [u32; 2], vertices: &[Vec3]) -> f32 {
    let [a, b] = ends.map(|vertex| {
        let at = |vertex: u32| vertices[vertex as usize];
        let corner = |sum: Vec3, &[next, before]: &[u32; 2]| {
            sum + (at(next) - at(vertex)).cross(at(before) - at(vertex))
        };
        let sum = outline.star(vertex).iter().fold(Vec3::ZERO, corner);
        sum / sum.length().max(1e-37)
    });
    2.0 * (a - b).length().atan2((a + b).length())
}
