//! What is under the cursor: the triangle that a ray meets, and what the truth says there.

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::errors::Measured;
use super::piece::Piece;
use crate::eye::{Eye, Lens};
use crate::output::Surface;

/// Triangles that one box holds: those of a patch, or as many of a large one.
const MOST: usize = 256;

/// Boxes around runs of triangles.
pub struct Boxes(Vec<(Range<usize>, DVec3, DVec3)>);

impl Boxes {
    /// The boxes of a surface: triangles of one patch follow one another.
    pub fn new(surface: &Surface) -> Boxes {
        let starts = (0..surface.triangles.len()).step_by(MOST);
        let boxes = starts.map(|start| {
            let range = start..(start + MOST).min(surface.triangles.len());
            let corners = surface.triangles[range.clone()].iter().flatten();
            let points = corners.map(|&corner| position(surface, corner));
            let empty = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
            let (low, high) = points.fold(empty, |(low, high), p| (low.min(p), high.max(p)));
            (range, low, high)
        });
        Boxes(boxes.collect())
    }
}

fn position(surface: &Surface, point: u32) -> DVec3 {
    DVec3::from(surface.points[point as usize].position)
}

/// A line of sight.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    from: DVec3,
    along: DVec3,
}

impl Ray {
    /// The line of sight through a place of the picture (-1..1, y up).
    pub fn new(eye: &Eye, at: DVec2, aspect: f64) -> Ray {
        let [right, up, back] = eye.axes();
        match eye.lens {
            Lens::Perspective(degrees) => {
                let slope = (0.5 * degrees).to_radians().tan();
                let off = slope * at * DVec2::new(aspect, 1.0);
                Ray {
                    from: eye.from,
                    along: off.x * right + off.y * up - back,
                }
            }
            Lens::Orthographic(height) => {
                let off = 0.5 * height * at * DVec2::new(aspect, 1.0);
                Ray {
                    from: eye.from + off.x * right + off.y * up,
                    along: -back,
                }
            }
        }
    }

    /// Whether it meets a box before a distance.
    fn meets(&self, low: DVec3, high: DVec3, before: f64) -> bool {
        let (a, b) = (
            (low - self.from) / self.along,
            (high - self.from) / self.along,
        );
        let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
        // Where the ray runs in a box's side, quotients are no numbers.
        !(near > far || far < 0.0 || near > before)
    }

    /// Where it meets a triangle: the distance, and the shares of the second and third corner (Möller, Trumbore 1997).
    fn hits(&self, [a, b, c]: [DVec3; 3]) -> Option<(f64, f64, f64)> {
        let (ab, ac) = (b - a, c - a);
        let across = self.along.cross(ac);
        let volume = ab.dot(across);
        if volume == 0.0 {
            return None;
        }
        let off = self.from - a;
        let u = off.dot(across) / volume;
        let aside = off.cross(ab);
        let v = self.along.dot(aside) / volume;
        let distance = ac.dot(aside) / volume;
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0;
        inside.then_some((distance, u, v))
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// How far away, in lengths of the ray.
    pub distance: f64,
    /// The ptex face.
    pub face: u32,
    /// Where in the face.
    pub uv: [f64; 2],
    /// As it is drawn.
    pub position: DVec3,
    /// As it is drawn, unit.
    pub normal: DVec3,
    /// Distance from the truth there, over the diagonal; None where there is none.
    pub error: Option<f64>,
    /// Degrees between both normals.
    pub angle: Option<f64>,
    /// By what it is evaluated; None where that is not on the device any more.
    pub piece: Option<Piece>,
}

impl Measured {
    /// What a line of sight meets first.
    pub fn find(&self, ray: Ray) -> Option<Found> {
        let surface = &self.surface;
        let mut best: Option<(f64, usize, f64, f64)> = None;
        for (range, low, high) in &self.boxes.0 {
            let before = best.map_or(f64::INFINITY, |(distance, ..)| distance);
            if !ray.meets(*low, *high, before) {
                continue;
            }
            for number in range.clone() {
                let corners = surface.triangles[number].map(|corner| position(surface, corner));
                if let Some((distance, u, v)) = ray.hits(corners)
                    && best.is_none_or(|(nearest, ..)| distance < nearest)
                {
                    best = Some((distance, number, u, v));
                }
            }
        }
        let (distance, number, u, v) = best?;
        Some(self.found(distance, surface.triangles[number], [1.0 - u - v, u, v]))
    }

    fn found(&self, distance: f64, triangle: [u32; 3], shares: [f64; 3]) -> Found {
        let corners = triangle.map(|corner| self.surface.points[corner as usize]);
        let sum = |of: &dyn Fn(usize) -> DVec3| -> DVec3 {
            (0..3).map(|corner| shares[corner] * of(corner)).sum()
        };
        let at = sum(&|corner| DVec3::from(corners[corner].position));
        let normal = sum(&|corner| DVec3::from(corners[corner].normal.map(f64::from)));
        let normal = normal.normalize_or_zero();
        let uv = sum(&|corner| {
            let [u, v] = corners[corner].uv.map(f64::from);
            DVec3::new(u, v, 0.0)
        });
        let face = corners[0].face;
        let truth = self
            .limit
            .evaluate(face as usize, uv.x.clamp(0.0, 1.0), uv.y.clamp(0.0, 1.0));
        let placement = self.model.placement();
        let diagonal = self.model.diagonal().max(f64::MIN_POSITIVE);
        let error = |truth: DVec3| placement.local(truth).distance(placement.local(at)) / diagonal;
        let angle = |truth: DVec3| {
            let both = normal != DVec3::ZERO && truth != DVec3::ZERO;
            both.then(|| {
                normal
                    .cross(truth)
                    .length()
                    .atan2(normal.dot(truth))
                    .to_degrees()
            })
        };
        Found {
            distance,
            face,
            uv: [uv.x, uv.y],
            position: at,
            normal,
            error: truth.as_ref().map(|truth| error(truth.position)),
            angle: truth.as_ref().and_then(|truth| angle(truth.normal())),
            piece: None,
        }
    }
}

impl Found {
    /// In rows.
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let three = |p: DVec3| format!("{:.4} {:.4} {:.4}", p.x, p.y, p.z);
        let or_none = |number: Option<f64>, words: &dyn Fn(f64) -> String| {
            number.map_or("–".to_string(), words)
        };
        let mut facts = vec![
            ("face", self.face.to_string()),
            ("u, v", format!("{:.4}, {:.4}", self.uv[0], self.uv[1])),
            ("position", three(self.position)),
            ("normal", three(self.normal)),
            ("error", or_none(self.error, &|e| format!("{e:.2e}"))),
            (
                "normal error",
                or_none(self.angle, &|a| format!("{a:.2e}°")),
            ),
        ];
        facts.extend(self.piece.iter().flat_map(Piece::facts));
        facts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::orbit::Orbit;

    #[test]
    fn rays_meet_what_is_seen_there() {
        for orthographic in [false, true] {
            let orbit = Orbit {
                orthographic,
                ..Orbit::default()
            };
            let eye = orbit.eye();
            let all = crate::eye::Sphere {
                centre: DVec3::ZERO,
                radius: 2.0,
            };
            let point = DVec3::new(0.3, -0.2, 0.4);
            let seen = eye.clip_from_world(1.6, all).project_point3(point);
            let ray = Ray::new(&eye, DVec2::new(seen.x, -seen.y), 1.6);
            let off = (point - ray.from).cross(ray.along).length();
            assert!(off < 1e-9, "{off}");
            let [x, y] = [DVec3::X, DVec3::Y].map(|axis| 0.1 * axis);
            let hit = ray.hits([point - x - y, point + x - y, point + y]);
            assert!(hit.is_some());
            assert!(ray.meets(point - x - y, point + x + y + DVec3::Z, f64::INFINITY));
            let [right, ..] = eye.axes();
            let aside = point + 5.0 * right;
            assert!(!ray.meets(aside - DVec3::ONE, aside + DVec3::ONE, f64::INFINITY));
        }
    }
}
