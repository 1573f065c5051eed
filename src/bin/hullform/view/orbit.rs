//! The camera of the window: it turns around a point, comes nearer, and moves along the picture.

use glam::{DMat3, DVec2, DVec3};

use crate::eye::{Eye, Lens};

/// How much of the picture's tighter side is filled when all is shown.
const FILL: f64 = 0.86;
/// Degrees a point of the mouse's way.
const TURN: f64 = 0.35;
/// The steepest look: straight down, sideways would have no meaning.
const STEEPEST: f64 = 89.9;
/// The usual angle from the lower to the upper side, in degrees.
const ANGLE: f64 = 32.0;

/// A camera that looks at a point. Angles are as `--camera` has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// What it turns around, in units of the scene.
    pub target: DVec3,
    /// Degrees around the y axis.
    pub yaw: f64,
    /// Degrees above the horizon.
    pub pitch: f64,
    /// From the eye to the target.
    pub distance: f64,
    /// From the lower to the upper side, in degrees.
    pub angle: f64,
    /// Whether lines of sight are parallel, with the same size at the target.
    pub orthographic: bool,
}

/// A direction to look from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Along -z.
    Front,
    /// Along -x.
    Side,
    /// Along -y.
    Top,
    /// From above the right, as pictures are by default.
    ThreeQuarter,
}

impl Preset {
    /// Degrees around y and above the horizon.
    fn angles(self) -> [f64; 2] {
        match self {
            Preset::Front => [0.0, 0.0],
            Preset::Side => [90.0, 0.0],
            Preset::Top => [0.0, STEEPEST],
            Preset::ThreeQuarter => [40.0, 22.0],
        }
    }
}

impl Default for Orbit {
    fn default() -> Orbit {
        let [yaw, pitch] = Preset::ThreeQuarter.angles();
        Orbit {
            target: DVec3::ZERO,
            yaw,
            pitch,
            distance: 5.0,
            angle: ANGLE,
            orthographic: false,
        }
    }
}

impl Orbit {
    /// The eye.
    pub fn eye(&self) -> Eye {
        let turn = DMat3::from_rotation_y(self.yaw.to_radians())
            * DMat3::from_rotation_x(-self.pitch.to_radians());
        let lens = if self.orthographic {
            Lens::Orthographic(self.height())
        } else {
            Lens::Perspective(self.angle)
        };
        Eye {
            from: self.target + self.distance * (turn * DVec3::Z),
            to: self.target,
            lens,
        }
    }

    /// Units from the lower to the upper side of the picture, at the target.
    fn height(&self) -> f64 {
        2.0 * self.distance * (0.5 * self.angle).to_radians().tan()
    }

    /// Turns as the mouse moves so many points.
    pub fn turn(&mut self, by: DVec2) {
        self.yaw = (self.yaw - TURN * by.x + 180.0).rem_euclid(360.0) - 180.0;
        self.pitch = (self.pitch + TURN * by.y).clamp(-STEEPEST, STEEPEST);
    }

    /// Moves such that what is at the target follows the mouse, in a picture that is so many points high.
    pub fn pan(&mut self, by: DVec2, height: f64) {
        let units = self.height() / height.max(1.0);
        let [right, up, _] = self.eye().axes();
        let moved = self.target + units * (by.y * up - by.x * right);
        if moved.is_finite() {
            self.target = moved;
        }
    }

    /// Comes nearer by a factor above 1, such that what is at a place of the picture (-1..1, y up) stays there. Within bounds of what there is to
    /// be seen: `radius` is that of all.
    pub fn dolly(&mut self, factor: f64, at: DVec2, aspect: f64, radius: f64) {
        let old = self.height();
        let distance = self.distance / factor;
        self.distance = distance.clamp(1e-4 * radius, 1e3 * radius);
        let shift = 0.5 * (old - self.height()) * at * DVec2::new(aspect, 1.0);
        let [right, up, _] = self.eye().axes();
        let moved = self.target + shift.x * right + shift.y * up;
        // What went far away comes back to the middle.
        if moved.is_finite() && self.distance < 1e3 * radius {
            self.target = moved;
        }
    }

    /// Looks from a direction.
    pub fn look(&mut self, preset: Preset) {
        [self.yaw, self.pitch] = preset.angles();
    }

    /// Shows all points, as large as they fit into a picture whose width is `aspect` times its height.
    pub fn fit(&mut self, points: impl Iterator<Item = DVec3> + Clone, aspect: f64) {
        let [right, up, back] = self.eye().axes();
        let points = points.filter(|point| point.is_finite());
        let seen = points.map(|p| DVec3::new(p.dot(right), p.dot(up), p.dot(back)));
        let range = |axis: usize| {
            let along = seen.clone().map(|point| point[axis]);
            let both = along.map(|x| (x, x));
            let range = both.reduce(|(low, high), (x, _)| (low.min(x), high.max(x)));
            range.unwrap_or((-1.0, 1.0))
        };
        let middle = DVec3::from([0, 1, 2].map(|axis| {
            let (low, high) = range(axis);
            0.5 * (low + high)
        }));
        let mut at = middle;
        let slope = FILL * (0.5 * self.angle).to_radians().tan();
        let slopes = DVec2::new(slope * aspect, slope);
        // Where the eye must at least be for a point: each is seen under less than the slopes. Centring shifts that, so again.
        for _ in 0..4 {
            let ahead = if self.orthographic { 0.0 } else { 1.0 };
            let greatest = |at: DVec3, side: usize, sign: f64| {
                let needs = |p: DVec3| {
                    sign * (p[side] - at[side]) / slopes[side] + ahead * (p.z - middle.z)
                };
                seen.clone().map(needs).fold(f64::NEG_INFINITY, f64::max)
            };
            let mut distance = f64::MIN_POSITIVE;
            for side in 0..2 {
                let (plus, minus) = (greatest(at, side, 1.0), greatest(at, side, -1.0));
                if plus.is_finite() && minus.is_finite() {
                    at[side] += 0.5 * (plus - minus) * slopes[side];
                    distance = distance.max(0.5 * (plus + minus));
                }
            }
            self.distance = distance;
        }
        if self.distance <= f64::MIN_POSITIVE {
            self.distance = 1.0;
        }
        self.target = at.x * right + at.y * up + at.z * back;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::Sphere;

    fn corners() -> Vec<DVec3> {
        let corner = |i: usize| {
            DVec3::new(
                if i & 1 == 0 { 1.0 } else { 3.0 },
                if i & 2 == 0 { 2.0 } else { 6.0 },
                if i & 4 == 0 { 3.0 } else { 11.0 },
            )
        };
        (0..8).map(corner).collect()
    }

    fn reach(orbit: &Orbit, aspect: f64) -> DVec2 {
        let all = Sphere::around(corners().into_iter());
        let clip = orbit.eye().clip_from_world(aspect, all);
        let seen = corners().into_iter().map(|p| clip.project_point3(p));
        seen.fold(DVec2::ZERO, |most, p| most.max(p.truncate().abs()))
    }

    #[test]
    fn what_is_fitted_fills_the_tighter_side_and_nothing_is_cut_off() {
        for orthographic in [false, true] {
            for (yaw, pitch, aspect) in [(0.0, 0.0, 1.0), (40.0, 22.0, 1.8), (-120.0, -60.0, 0.4)] {
                let mut orbit = Orbit {
                    yaw,
                    pitch,
                    orthographic,
                    ..Orbit::default()
                };
                orbit.fit(corners().into_iter(), aspect);
                let most = reach(&orbit, aspect).max_element();
                assert!(
                    (FILL - 0.03..=FILL + 0.01).contains(&most),
                    "{most} {orbit:?}"
                );
            }
        }
    }

    #[test]
    fn what_is_under_the_mouse_stays_there_when_one_comes_nearer() {
        let mut orbit = Orbit::default();
        let [right, up, _] = orbit.eye().axes();
        let at = DVec2::new(0.5, -0.25);
        let half = 0.5 * orbit.height();
        let point = orbit.target + half * (at.x * 1.5 * right + at.y * up);
        orbit.dolly(1.7, at, 1.5, 1.0);
        let clip = orbit.eye().clip_from_world(
            1.5,
            Sphere {
                centre: DVec3::ZERO,
                radius: 1.0,
            },
        );
        let seen = clip.project_point3(point).truncate();
        assert!(
            (seen - at * DVec2::new(1.0, -1.0)).length() < 1e-9,
            "{seen}"
        );
    }

    #[test]
    fn what_is_dragged_follows_the_mouse() {
        let mut orbit = Orbit::default();
        let point = orbit.target;
        orbit.pan(DVec2::new(30.0, -40.0), 400.0);
        let all = Sphere {
            centre: point,
            radius: 1.0,
        };
        let seen = orbit.eye().clip_from_world(1.0, all).project_point3(point);
        let moved = 200.0 * seen.truncate();
        assert!((moved - DVec2::new(30.0, -40.0)).length() < 1e-9, "{moved}");
    }

    #[test]
    fn angles_and_distances_stay_within_bounds_whatever_comes() {
        let mut orbit = Orbit::default();
        for step in 0..1000 {
            orbit.turn(DVec2::new(1e4, if step % 2 == 0 { 1e6 } else { -3e5 }));
            orbit.dolly(if step < 500 { 1e3 } else { 1e-3 }, DVec2::ONE, 1.0, 2.0);
            orbit.pan(DVec2::splat(1e3), 1.0);
            assert!(orbit.eye().from.is_finite() && orbit.pitch.abs() <= STEEPEST);
        }
        orbit.fit(std::iter::empty(), 1.0);
        assert!(orbit.eye().from.is_finite() && orbit.distance > 0.0);
    }
}
