//! What the device decides about patches in each frame: their levels, and which are not drawn at all.

use glam::{Mat4, Vec3, Vec4, Vec4Swizzles};

#[cfg(feature = "vulkan")]
use crate::abi;
use crate::frame::Cut;
use crate::method::{Outline, Pass};
#[cfg(feature = "vulkan")]
use crate::tessellation::Spacing;
use crate::tessellation::{Levels, levels_of_edges};

/// By what the device decides about patches, in each view by itself. A level belongs to an edge of the mesh and depends on nothing but its ends, so both
/// sides agree to the bit; where levels are not whole, spacing is fractional and nothing pops.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decision {
    /// Levels; none is above the cut's.
    pub metric: Metric,
    /// Whether patches outside of the picture are left out, before their control points are computed. Conservative: by the convex hull of their control
    /// vertices, with displacement; methods that do not keep within it are drawn as they are.
    pub frustum: bool,
    /// The first of as many views to decide by, instead of those that are drawn: a frozen camera that another one looks at.
    pub seen_from: Option<u32>,
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
}

/// What a view is decided by: its matrix, column by column, its eye and the height of its displacement, in local units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// From local units to clip space.
    pub clip_from_model: [[f32; 4]; 4],
    /// The eye.
    pub eye: [f32; 3],
    /// The height of the displacement.
    pub height: f32,
}

impl Decision {
    /// As shaders have it, for views from `view` on, of which `eyes` are decided for together.
    #[cfg(feature = "vulkan")]
    pub(crate) fn record(&self, view: u32, eyes: u32, cut: Cut, max_level: u32) -> abi::Decision {
        let (metric, measure, size) = match self.metric {
            Metric::Cut => (0, 1.0, [1.0; 2]),
            Metric::Distance(near) => (abi::DECIDE_DISTANCE, near, [1.0; 2]),
            Metric::Screen { pixels, size } => (abi::DECIDE_SCREEN, pixels, size),
        };
        let fractional = if cut.spacing == Spacing::FractionalEven {
            abi::FRAME_FRACTIONAL_EVEN
        } else {
            0
        };
        let frustum = if self.frustum { abi::DECIDE_FRUSTUM } else { 0 };
        abi::Decision {
            view,
            seen: self.seen_from.unwrap_or(view),
            flags: metric | fractional | frustum | eyes << abi::FRAME_EYES_SHIFT,
            measure,
            level: cut.spacing.clamp(cut.level, max_level),
            size,
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
        let record = pass.patches.get(patch)?;
        let hull = pass.hull(patch).iter();
        let points: Vec<Vec3> = hull.map(|&vertex| vertices[vertex as usize]).collect();
        let is_culled = self.frustum && !points.is_empty() && is_outside(&points, seen);
        if is_culled || pass.is_vacant(patch) {
            return Some(Levels {
                domain: pass.domain,
                edges: [0.0; 4],
                inside: 0.0,
            });
        }
        let level = |&side: &u32| {
            let list = outline.side(side);
            self.level_of_side(list, vertices, cut, seen)
        };
        let edges = pass.sides.get(patch)?.each_ref().map(level);
        Some(levels_of_edges(
            pass.domain,
            record,
            edges,
            cut.spacing,
            pass.max_level,
        ))
    }

    /// The level of an edge, given by its ends, or the greatest of a face's.
    fn level_of_side(&self, list: &[u32], vertices: &[Vec3], cut: Cut, seen: &Seen) -> f32 {
        if self.metric == Metric::Cut {
            return cut.level;
        }
        let edges = if list.len() == 2 { 1 } else { list.len() };
        let ends =
            |edge: usize| [edge, (edge + 1) % list.len()].map(|i| vertices[list[i] as usize]);
        let levels = (0..edges).map(|edge| self.level_of_ends(ends(edge), cut, seen));
        levels.fold(cut.spacing.least(), f32::max).min(cut.level)
    }

    fn level_of_ends(&self, [a, b]: [Vec3; 2], cut: Cut, seen: &Seen) -> f32 {
        match self.metric {
            Metric::Cut => cut.level,
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

/// Whether all points are outside of one side of the picture.
fn is_outside(points: &[Vec3], seen: &Seen) -> bool {
    let clip = Mat4::from_cols_array_2d(&seen.clip_from_model);
    let [x, y, z, depth] = [0, 1, 2, 3].map(|row| clip.row(row));
    let planes = [depth + x, depth - x, depth + y, depth - y, z, depth - z];
    planes.into_iter().any(|plane| {
        let reach = seen.height.abs() * plane.xyz().length();
        points.iter().all(|&point| {
            let summands = (plane.xyz() * point).abs();
            let rounding = 1e-6 * (summands.element_sum() + plane.w.abs());
            let margin = reach + rounding + 0.002 * depth.dot(point.extend(1.0)).abs();
            plane.dot(point.extend(1.0)) < -margin
        })
    })
}
