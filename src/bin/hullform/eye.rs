//! An eye at a place of its own, and what it sees: for pictures whose view somebody chose by hand.

use std::str::FromStr;

use glam::{DMat4, DVec3, DVec4};
use hullform::mesh::Placement;

use crate::camera::View;

/// The room before and behind what is seen, as a share of its radius; bumps and rounding stay within.
const ROOM: f64 = 0.1;
/// The nearest that anything is seen, as a share of the farthest: depths keep their digits.
const NEAREST: f64 = 1e-4;
/// How far away an orthographic eye stands for shading, in radii.
const FAR_AWAY: f64 = 1e4;

/// Where somebody looks from, where to, and through which lens. Up is +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// The eye, in units of the scene.
    pub from: DVec3,
    /// What stands in the middle of the picture.
    pub to: DVec3,
    /// How directions become places in the picture.
    pub lens: Lens,
}

/// How directions become places in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// By this angle from the picture's lower to its upper side, in degrees.
    Perspective(f64),
    /// In parallel; the picture is so many units high.
    Orthographic(f64),
}

/// A sphere around all that is to be seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sphere {
    /// Its middle.
    pub centre: DVec3,
    /// Its radius.
    pub radius: f64,
}

impl Sphere {
    /// A sphere around points: the middle of their box, and the farthest of them. Points that are none, by an infinite or undefined coordinate, do
    /// not count; a single point, or none, has a sphere all the same.
    pub fn around(points: impl Iterator<Item = DVec3> + Clone) -> Sphere {
        let points = points.filter(|point| point.is_finite());
        let box_of = |(low, high): (DVec3, DVec3), point: DVec3| (low.min(point), high.max(point));
        let bounds = points.clone().map(|point| (point, point));
        let bounds = bounds.reduce(|so_far, (point, _)| box_of(so_far, point));
        let (low, high) = bounds.unwrap_or_default();
        let centre = low + 0.5 * (high - low);
        let distances = points.map(|point| point.distance(centre));
        let radius = distances.fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { 1.0 };
        Sphere { centre, radius }
    }
}

impl Eye {
    /// The directions to the right, up, and back towards the eye.
    pub fn axes(&self) -> [DVec3; 3] {
        let back = (self.from - self.to).normalize_or(DVec3::Z);
        // Straight from above or below, up is away from who stands at +z.
        let up = if back.y.abs() > 1.0 - 1e-12 {
            DVec3::NEG_Z * back.y.signum()
        } else {
            DVec3::Y
        };
        let right = up.cross(back).normalize_or(DVec3::X);
        [right, back.cross(right), back]
    }

    /// From units of the scene to Vulkan's clip space, for a picture whose width is `aspect` times its height, of what is in a sphere.
    pub fn clip_from_world(&self, aspect: f64, all: Sphere) -> DMat4 {
        let [right, up, back] = self.axes();
        let depth = (self.from - all.centre).dot(back);
        let reach = (1.0 + ROOM) * all.radius;
        let row = |axis: DVec3| axis.extend(-axis.dot(self.from));
        let (right, up, back) = (row(right), row(up), row(back));
        let rows: [DVec4; 4] = match self.lens {
            Lens::Perspective(degrees) => {
                let far = (depth + reach).max(1e-3 * all.radius);
                let near = (depth - reach).max(NEAREST * far);
                let scale = 1.0 / (0.5 * degrees).to_radians().tan();
                let share = far / (far - near);
                [
                    scale / aspect * right,
                    // Vulkan's y points down.
                    -scale * up,
                    -share * back - share * near * DVec4::W,
                    -back,
                ]
            }
            Lens::Orthographic(height) => {
                let (near, length) = (depth - reach, 2.0 * reach);
                [
                    2.0 / (height * aspect) * right,
                    -2.0 / height * up,
                    -1.0 / length * back - near / length * DVec4::W,
                    DVec4::W,
                ]
            }
        };
        DMat4::from_cols_array_2d(&rows.map(|row| row.to_array())).transpose()
    }

    /// What is seen of a model, in its local units.
    pub fn view(&self, placement: Placement, aspect: f64, all: Sphere) -> View {
        let [.., back] = self.axes();
        let place = match self.lens {
            Lens::Perspective(_) => self.from,
            Lens::Orthographic(_) => all.centre + FAR_AWAY * all.radius * back,
        };
        let clip_from_model = self.clip_from_world(aspect, all) * placement.matrix();
        View {
            clip_from_model: clip_from_model.as_mat4(),
            eye: placement.local(place).as_vec3(),
        }
    }
}

/// A place on the command line: `X,Y,Z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point(pub DVec3);

impl FromStr for Point {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Point, Self::Err> {
        let numbers: Result<Vec<f64>, _> =
            text.split(',').map(|part| part.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[x, y, z]) if [x, y, z].iter().all(|number| number.is_finite()) => {
                Ok(Point(DVec3::new(x, y, z)))
            }
            _ => Err("expected X,Y,Z: three numbers, such as 0,1.5,4"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eye(lens: Lens) -> Eye {
        Eye {
            from: DVec3::new(1.0, 2.0, 10.0),
            to: DVec3::new(1.0, 2.0, 3.0),
            lens,
        }
    }

    const ALL: Sphere = Sphere {
        centre: DVec3::new(1.0, 2.0, 3.0),
        radius: 2.0,
    };

    #[test]
    fn what_is_looked_at_is_in_the_middle_and_the_sphere_within_the_depths() {
        for lens in [Lens::Perspective(40.0), Lens::Orthographic(5.0)] {
            let clip = eye(lens).clip_from_world(1.5, ALL);
            let middle = clip.project_point3(ALL.centre);
            assert!(middle.truncate().length() < 1e-12, "{middle}");
            for z in [1.0, 5.0] {
                let depth = clip.project_point3(DVec3::new(1.0, 2.0, z)).z;
                assert!((0.0..=1.0).contains(&depth), "{depth}");
            }
            let above = clip.project_point3(ALL.centre + DVec3::Y);
            let right = clip.project_point3(ALL.centre + DVec3::X);
            let near = clip.project_point3(ALL.centre + DVec3::Z);
            assert!(above.y < 0.0 && right.x > 0.0 && near.z < middle.z);
        }
    }

    #[test]
    fn a_lens_shows_what_it_says() {
        let clip = eye(Lens::Orthographic(5.0)).clip_from_world(2.0, ALL);
        let top = clip.project_point3(ALL.centre + 2.5 * DVec3::Y);
        let side = clip.project_point3(ALL.centre + 5.0 * DVec3::X);
        assert!((top.y + 1.0).abs() < 1e-12 && (side.x - 1.0).abs() < 1e-12);
        let clip = eye(Lens::Perspective(90.0)).clip_from_world(1.0, ALL);
        let top = clip.project_point3(ALL.centre + 7.0 * DVec3::Y);
        assert!((top.y + 1.0).abs() < 1e-12);
    }

    #[test]
    fn inside_the_sphere_and_straight_above_it_there_is_a_view_too() {
        let mut inside = eye(Lens::Perspective(40.0));
        inside.from = ALL.centre;
        assert!(inside.clip_from_world(1.0, ALL).is_finite());
        let mut above = eye(Lens::Perspective(40.0));
        above.from = ALL.centre + 9.0 * DVec3::Y;
        let [right, up, back] = above.axes();
        assert_eq!((right, up, back), (DVec3::X, DVec3::NEG_Z, DVec3::Y));
        let lost = Sphere::around([DVec3::NAN].into_iter());
        assert_eq!(lost.radius, 1.0);
    }

    #[test]
    fn points_are_three_numbers() {
        assert_eq!("1, -2,3e2".parse(), Ok(Point(DVec3::new(1.0, -2.0, 300.0))));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,x", "NaN,0,0", "inf,0,0"] {
            assert!(wrong.parse::<Point>().is_err(), "{wrong}");
        }
    }
}
