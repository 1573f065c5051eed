//! Which patches are not drawn, before anything of them is computed. Twin of `glsl/lib/culling.glsl`.
//!
//! All of it is conservative. A surface lies in the convex hull of the control vertices that it is a sum of, since masks have no negative weights, and a
//! displaced one within its height of that.

use glam::{Mat4, Vec2, Vec3, Vec4, Vec4Swizzles};

use crate::abi;
use crate::frame::Seen;
use crate::tessellation::{Levels, Spacing};

/// Why a patch is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Culled {
    /// It is outside of the picture.
    Frustum,
    /// All of it is seen from behind.
    Back,
    /// It lies between samples.
    Small,
}

impl Culled {
    /// What the record of a patch tells.
    pub(super) fn of(flag: u32) -> Option<Culled> {
        match flag {
            abi::DECIDE_FRUSTUM => Some(Culled::Frustum),
            abi::DECIDE_BACK => Some(Culled::Back),
            abi::DECIDE_SMALL => Some(Culled::Small),
            _ => None,
        }
    }
}

/// The share of a limit that vertices have which are not the face's own: 11/36 at most for a bicubic B-spline, at its corners, where the limit's mask is
/// (1 4 1) x (1 4 1) / 36; and more than a third for no face that was met, with whatever valences, creases and n-gons (`tests/deciding.rs`).
const FOREIGN: f32 = 0.35;
/// A thousandth of the picture, on either side.
const BESIDE: f32 = 0.002;
/// What sums of products may round, as a share of their summands.
const ROUNDING: f32 = 1e-6;
/// By how much the sine of the angle to a triangle's plane has to tell: positions are rounded to 1/16 pixel at worst.
const EDGEWISE: f32 = 0.02;
/// Pixels by which positions are off where they are rasterised: devices have 4 bits below the pixel at least (Vulkan spec, "Required Limits",
/// `subPixelPrecisionBits`).
const BETWEEN: f32 = 1.0 / 16.0;

/// Whether a patch is outside of one side of the picture: `own` vertices are those of its face, and its hull is around `points`.
///
/// On the far side of a plane is what is a sum of points there. The own vertices have a share of 1 - [`FOREIGN`] at least in each limit, so that others count
/// by the rest alone.
pub(super) fn is_outside(own: &[Vec3], points: &[Vec3], seen: &Seen) -> bool {
    let clip = Mat4::from_cols_array_2d(&seen.clip_from_model);
    let [x, y, z, depth] = [0, 1, 2, 3].map(|row| clip.row(row));
    let planes = [depth + x, depth - x, depth + y, depth - y, z, depth - z];
    planes.into_iter().any(|plane| {
        let reach = seen.height.abs() * plane.xyz().length();
        let inside = |&point: &Vec3| {
            let summands = (plane.xyz() * point).abs();
            let rounding = ROUNDING * (summands.element_sum() + plane.w.abs());
            let beside = BESIDE * depth.dot(point.extend(1.0)).abs();
            plane.dot(point.extend(1.0)) + reach + rounding + beside
        };
        let greatest = |points: &[Vec3]| points.iter().map(inside).fold(f32::MIN, f32::max);
        let own = greatest(own);
        own < 0.0 && own + FOREIGN * (greatest(points) - own).max(0.0) < 0.0
    })
}

/// Whether no sample is in the box around the picture of a patch, where each pixel has `rows` rows and as many columns of samples: of 1, 2, 4 and 8 samples in
/// their standard places each has a row and a column of its own, evenly spaced (Vulkan spec, "Standard sample locations").
pub(super) fn is_small(points: &[Vec3], seen: &Seen, size: [f32; 2], rows: f32) -> bool {
    let clip = Mat4::from_cols_array_2d(&seen.clip_from_model);
    let depth = clip.row(3);
    let away = seen.height.abs() * depth.xyz().length();
    (0..2).any(|axis| {
        let row = clip.row(axis);
        let reach = seen.height.abs() * row.xyz().length();
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for &point in points {
            let at = row.dot(point.extend(1.0));
            let w = depth.dot(point.extend(1.0));
            let [near, far] = [w - away, w + away];
            // What is no number is nowhere.
            if near <= 1e-3 * w.abs() || !at.is_finite() || !w.is_finite() {
                return false;
            }
            low = low.min((at - reach) / if at < reach { near } else { far });
            high = high.max((at + reach) / if at > -reach { near } else { far });
        }
        let pixels = Vec2::new(low, high) * (0.5 * size[axis]) + 0.5 * size[axis];
        let low = (pixels.x - BETWEEN) * rows - 0.5;
        let high = (pixels.y + BETWEEN) * rows - 0.5;
        // In floats that tell pixels apart.
        high - low < 1.0 && low.abs() < 65536.0 * rows && low.floor() == high.floor()
    })
}

/// Whether each triangle of a patch with these levels is within one of its cells, so that cells tell by themselves which side it shows. Of macro faces triangles between an edge and
/// an inside of other levels may be in two; and where one of a single row has one segment across, the tessellator makes two of it, but on the row's ends.
pub(super) fn are_within_cells(levels: &Levels) -> bool {
    let is_row = levels.cells.contains(&1);
    let is_grid = levels.edges == [levels.inside; 4] && (levels.inside >= 2.0 || !is_row);
    levels.cells == [1; 2] || is_grid
}

/// Whether all triangles of a bicubic B-spline patch with these levels show their backs.
///
/// From the eye, the null vector of what makes x, y and w in clip space, a triangle shows its back if that is below its plane. Its sides are sums of mean
/// derivatives, which lie in the hulls of the differences of the patch's Bezier points, times three. Where two sides lie along u and v, as in all of a
/// regular grid, its normal is the product of one of each hull: normals are around the product of the hulls' axes within the angle of Sederberg and Meyers
/// 1988 (section 3): with a unit normal n, |n u| <= sin a and |n v| <= sin b, so that its part in their plane is at most
/// sqrt(sin^2 a + 2 sin a sin b |cos t| + sin^2 b) / sin t long. Where levels differ, triangles between an edge and the inside are slanted: by at most
/// 1 + inside / edge of their height, which turns the other side by at most that times the change of the derivative within two of the edge's segments.
/// How high they are is not known where spacing is fractional: the short segments stand anywhere.
pub(super) fn is_back(points: &[Vec3; 16], seen: &Seen, levels: &Levels, spacing: Spacing) -> bool {
    // Bumps have normals of their own.
    if seen.height != 0.0 {
        return false;
    }
    let points = bezier(points);
    let mut slants = [0.0; 2];
    if levels.edges != [levels.inside; 4] {
        if spacing == Spacing::FractionalEven {
            return false;
        }
        let least = levels.edges.into_iter().fold(f32::MAX, f32::min).ceil();
        let inside = levels.inside.ceil();
        let slant = 1.0 + inside / least;
        let [uu, uv, vv] = second_differences(&points);
        // Second derivatives are six and nine of these, and all is over three.
        slants = [uu, vv].map(|own| slant * (4.0 / least * own + 3.0 * uv / inside));
    }
    let point = |x: usize, y: usize| points[x + 4 * y];
    let along_u = std::array::from_fn(|i| point(i % 3 + 1, i / 3) - point(i % 3, i / 3));
    let along_v = std::array::from_fn(|i| point(i / 3, i % 3 + 1) - point(i / 3, i % 3));
    let [by_u, by_v] = slants;
    let (Some((u, a)), Some((v, b))) = (cone(along_u, by_v), cone(along_v, by_u)) else {
        return false;
    };
    let normal = u.cross(v);
    let (sine, cosine) = (normal.length(), u.dot(v).abs());
    let spread = (a * a + 2.0 * a * b * cosine + b * b).sqrt() / sine + EDGEWISE;
    let eye = eye_of(seen);
    let is_below = |&point: &Vec3| {
        let to_eye = eye.xyz() - eye.w * point;
        normal.dot(to_eye) < -spread * sine * to_eye.length()
    };
    // What is no number is not below either.
    spread < 1.0 && points.iter().all(is_below)
}

/// The Bezier points of a bicubic B-spline patch (Farin 2002, section 8.1): a smaller hull of the same surface.
pub(super) fn bezier(points: &[Vec3; 16]) -> [Vec3; 16] {
    let mut points = *points;
    for (step, other) in [(1, 4), (4, 1)] {
        for first in (0..4).map(|i| i * other) {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| points[first + i * step]);
            points[first] = ((a + c) + 4.0 * b) / 6.0;
            points[first + step] = (2.0 * b + c) / 3.0;
            points[first + 2 * step] = (b + 2.0 * c) / 3.0;
            points[first + 3 * step] = ((b + d) + 4.0 * c) / 6.0;
        }
    }
    points
}

/// The lengths of the second differences of control points: the greatest along u twice, along both, along v twice.
fn second_differences(points: &[Vec3; 16]) -> [f32; 3] {
    let at = |x: usize, y: usize| points[x + 4 * y];
    let twice = |a: Vec3, b: Vec3, c: Vec3| ((a - b) - (b - c)).length();
    let mut greatest = [0.0f32; 3];
    for i in 0..4 {
        for k in 0..2 {
            greatest[0] = greatest[0].max(twice(at(k, i), at(k + 1, i), at(k + 2, i)));
            greatest[2] = greatest[2].max(twice(at(i, k), at(i, k + 1), at(i, k + 2)));
        }
    }
    for (x, y) in (0..9).map(|i| (i % 3, i / 3)) {
        let across = (at(x + 1, y + 1) - at(x, y + 1)) - (at(x + 1, y) - at(x, y));
        greatest[1] = greatest[1].max(across.length());
    }
    greatest
}

/// The axis of the cone around vectors and all that is within `slant` of their hull, and the sine of the angle to its side; None where it is no cone.
fn cone(vectors: [Vec3; 12], slant: f32) -> Option<(Vec3, f32)> {
    let sum: Vec3 = vectors.into_iter().sum();
    let axis = sum / sum.length();
    let mut tangent = 0.0f32;
    for vector in vectors {
        let along = axis.dot(vector);
        let across = (vector - along * axis).length() + slant;
        let rest = along - slant;
        // Not what is no number.
        if rest.is_nan() || rest <= 0.0 {
            return None;
        }
        tangent = tangent.max(across / rest);
    }
    Some((axis, tangent / (1.0 + tangent * tangent).sqrt()))
}

/// Where everything is seen from, homogeneous: what x, y and w of clip space are zero for, and such that what is turned to it runs counter-clockwise.
fn eye_of(seen: &Seen) -> Vec4 {
    let clip = Mat4::from_cols_array_2d(&seen.clip_from_model);
    let scaled = |row: Vec4| row / row.abs().max_element();
    let [a, b, c] = [0, 1, 3].map(|row| scaled(clip.row(row)));
    let [bc, ca, ab] = [
        b.xyz().cross(c.xyz()),
        c.xyz().cross(a.xyz()),
        a.xyz().cross(b.xyz()),
    ];
    let eye = -(a.w * bc + b.w * ca + c.w * ab);
    eye.extend(a.xyz().dot(bc))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the front, 100 pixels a unit around the middle of a picture of 200.
    fn seen() -> Seen {
        Seen {
            clip_from_model: Mat4::from_scale(Vec3::new(1.0, -1.0, 0.1)).to_cols_array_2d(),
            eye: [0.0, 0.0, 10.0],
            height: 0.0,
        }
    }

    fn sheet(bend: f32) -> [Vec3; 16] {
        std::array::from_fn(|i| {
            let [x, y] = [i % 4, i / 4].map(|k| 0.1 * k as f32);
            Vec3::new(x, y, bend * x * x)
        })
    }

    fn uniform(level: f32) -> Levels {
        Levels {
            domain: crate::tessellation::Domain::Quads,
            cells: [1; 2],
            edges: [level; 4],
            inside: level,
        }
    }

    #[test]
    fn sheets_show_their_backs_from_behind_and_bent_ones_when_nothing_of_them_is_turned() {
        let behind = |bend: f32| {
            let turned = sheet(bend).map(|p| Vec3::new(-p.x, p.y, p.z));
            is_back(&turned, &seen(), &uniform(8.0), Spacing::Equal)
        };
        assert!(behind(0.0) && behind(0.5));
        assert!(!is_back(
            &sheet(0.0),
            &seen(),
            &uniform(8.0),
            Spacing::Equal
        ));
        assert!(!behind(1e3));
    }

    #[test]
    fn where_levels_differ_more_has_to_be_turned_away() {
        let turned = sheet(1.2).map(|p| Vec3::new(-p.x, p.y, p.z));
        let mut levels = uniform(16.0);
        assert!(is_back(&turned, &seen(), &levels, Spacing::Equal));
        levels.edges[0] = 2.0;
        assert!(!is_back(&turned, &seen(), &levels, Spacing::Equal));
        assert!(!is_back(&turned, &seen(), &levels, Spacing::FractionalEven));
    }

    #[test]
    fn between_samples_is_what_reaches_no_row_or_no_column() {
        // Some pixels high.
        let at = |low: f32, high: f32| {
            let at = |x: f32, y: f32| Vec3::new((x - 100.0) / 100.0, y, 0.0);
            [at(low, -0.02), at(high, 0.02)]
        };
        let small = |low, high, rows| is_small(&at(low, high), &seen(), [200.0; 2], rows);
        assert!(small(10.6, 11.4, 1.0));
        assert!(!small(10.6, 11.49, 1.0) && !small(10.4, 10.6, 1.0));
        assert!(!small(10.6, 11.4, 4.0) && small(10.7, 10.8, 4.0));
        assert!(!small(-1e9, 1e9, 1.0) && !small(f32::NAN, 1.0, 1.0));
    }

    #[test]
    fn an_instance_may_show_where_a_part_of_its_box_is_in_the_picture() {
        let decision = crate::frame::Decision {
            frustum: true,
            ..Default::default()
        };
        let shows = |x: f32| {
            let at = |x: f32| Vec3::new(x, 0.0, 1.0);
            decision.may_show([at(x), at(x + 1.0)], &seen())
        };
        assert!(shows(-1.9) && shows(0.0) && shows(0.9));
        assert!(!shows(-2.1) && !shows(1.1));
        assert!(crate::frame::Decision::default().may_show([Vec3::X * 7.0; 2], &seen()));
    }

    #[test]
    fn what_is_foreign_to_a_face_counts_less_than_its_own() {
        let far = |x: f32| Vec3::new(x, 0.0, 0.0);
        let out =
            |own: f32, foreign: f32| is_outside(&[far(own)], &[far(own), far(foreign)], &seen());
        assert!(out(1.1, 1.0) && out(1.1, 0.9));
        assert!(!out(1.1, 0.8) && !out(0.9, 2.0));
    }
}
