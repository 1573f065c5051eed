//! The camera of a picture: it turns around the model, which fills the frame.

use glam::camera::rh::proj::vulkan;
use glam::{Mat4, Vec2, Vec3};
use std::str::FromStr;

/// Half the angle of view over the shorter side, at zoom 1.
const HALF_VIEW: f32 = 20.0 * std::f32::consts::PI / 180.0;

/// How much of the picture's shorter reach the model takes.
const MARGIN: f32 = 0.88;

/// Where the picture is taken from: `--camera YAW,PITCH,ZOOM`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Degrees around the y axis; 0 looks along -z, 90 along -x.
    pub yaw: f32,
    /// Degrees above the horizon; 90 looks straight down.
    pub pitch: f32,
    /// 1 shows all of the model, 2 shows it twice as large.
    pub zoom: f32,
}

/// The camera's matrices for one model and picture.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// From model to eye: the eye at the origin, looking along -z, y up.
    pub eye_from_model: Mat4,
    /// From eye to Vulkan's clip space: y down, depth 0 to 1.
    pub clip_from_eye: Mat4,
}

impl FromStr for Camera {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Camera, Self::Err> {
        let numbers: Result<Vec<f32>, _> =
            text.split(',').map(|part| part.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[yaw, pitch, zoom])
                if yaw.is_finite() && pitch.is_finite() && (0.01..=1000.0).contains(&zoom) =>
            {
                Ok(Camera { yaw, pitch, zoom })
            }
            _ => Err(
                "expected YAW,PITCH,ZOOM: two angles in degrees and a zoom from 0.01 to 1000, such as 30,20,1",
            ),
        }
    }
}

impl Camera {
    /// Looks at `points` from a distance at which they span twice [`HALF_VIEW`], and crops to what they cover of a picture whose width is
    /// `aspect` times its height.
    pub fn frame(&self, points: &[Vec3], aspect: f32) -> View {
        let first = points.first().copied().unwrap_or(Vec3::ZERO);
        let low = points.iter().fold(first, |low, &point| low.min(point));
        let high = points.iter().fold(first, |high, &point| high.max(point));
        let centre = 0.5 * (low + high);
        // A single point still needs near < far.
        let radius = points
            .iter()
            .map(|point| point.distance(centre))
            .fold(1e-6, f32::max);
        let distance = radius / HALF_VIEW.sin();
        let eye_from_model = Mat4::from_translation(Vec3::new(0.0, 0.0, -distance))
            * Mat4::from_rotation_x(self.pitch.to_radians())
            * Mat4::from_rotation_y(-self.yaw.to_radians())
            * Mat4::from_translation(-centre);
        let (near, far) = ((distance - radius) * 0.9, (distance + radius) * 1.1);
        let whole = vulkan::perspective(2.0 * HALF_VIEW, aspect, near, far);
        View {
            eye_from_model,
            clip_from_eye: self.crop(points, whole * eye_from_model) * whole,
        }
    }

    /// From the clip space of the whole view to that of the part that the points cover, with a margin. Zoom only enlarges that part and
    /// leaves the eye where it is, outside of the model: nothing is ever clipped.
    fn crop(&self, points: &[Vec3], clip_from_model: Mat4) -> Mat4 {
        let seen = points
            .iter()
            .map(|&point| clip_from_model.project_point3(point).truncate());
        let (low, high) = seen.fold((Vec2::MAX, Vec2::MIN), |(low, high), point| {
            (low.min(point), high.max(point))
        });
        if low.cmpgt(high).any() {
            return Mat4::IDENTITY;
        }
        let scale = self.zoom * MARGIN * 2.0 / (high - low).max_element().max(1e-6);
        let middle = 0.5 * (low + high);
        Mat4::from_scale(Vec3::new(scale, scale, 1.0))
            * Mat4::from_translation((-middle).extend(0.0))
    }
}

impl View {
    /// From model to clip space.
    pub fn clip_from_model(&self) -> Mat4 {
        self.clip_from_eye * self.eye_from_model
    }

    /// The eye in model space.
    pub fn eye(&self) -> Vec3 {
        self.eye_from_model.inverse().transform_point3(Vec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> Vec<Vec3> {
        let side = |bit: usize, low: f32, high: f32| if bit & 1 == 0 { low } else { high };
        let corner = |i: usize| {
            Vec3::new(
                side(i, 1.0, 3.0),
                side(i >> 1, 2.0, 6.0),
                side(i >> 2, 3.0, 11.0),
            )
        };
        (0..8).map(corner).collect()
    }

    const CENTRE: Vec3 = Vec3::new(2.0, 4.0, 7.0);

    fn camera(text: &str) -> Camera {
        text.parse().expect("a camera")
    }

    fn project(camera: &Camera, aspect: f32, point: Vec3) -> Vec3 {
        camera
            .frame(&corners(), aspect)
            .clip_from_model()
            .project_point3(point)
    }

    #[test]
    fn every_corner_is_in_the_picture_from_everywhere_and_fills_it() {
        for yaw in (-180..180).step_by(30) {
            for pitch in [-90, -45, 0, 45, 90] {
                for aspect in [0.3, 1.0, 2.5] {
                    let camera = camera(&format!("{yaw},{pitch},1"));
                    let seen: Vec<Vec3> = corners()
                        .into_iter()
                        .map(|p| project(&camera, aspect, p))
                        .collect();
                    assert!(
                        seen.iter().all(|p| p.truncate().abs().max_element() <= 0.9),
                        "{seen:?}"
                    );
                    assert!(seen.iter().all(|p| (0.0..=1.0).contains(&p.z)), "{seen:?}");
                    let reach = seen
                        .iter()
                        .map(|p| p.truncate().abs().max_element())
                        .fold(0.0, f32::max);
                    assert!(reach > 0.85, "{reach}");
                }
            }
        }
    }

    #[test]
    fn up_is_up_and_right_is_right() {
        let moved = |camera: &str, by: Vec3| {
            let camera = self::camera(camera);
            project(&camera, 1.0, CENTRE + by) - project(&camera, 1.0, CENTRE)
        };
        // Vulkan's y points down.
        assert!(moved("0,0,1", Vec3::Y).y < 0.0);
        assert!(moved("0,0,1", Vec3::X).x > 0.0);
        assert!(moved("0,0,1", Vec3::Z).z < 0.0);
        // From the right, and from above.
        assert!(moved("90,0,1", Vec3::Z).x < 0.0);
        assert!(moved("0,90,1", Vec3::Z).y > 0.0);
    }

    #[test]
    fn zoom_magnifies() {
        let width = |camera: &str| {
            let camera = self::camera(camera);
            (project(&camera, 1.0, CENTRE + Vec3::X) - project(&camera, 1.0, CENTRE)).x
        };
        assert!((width("0,0,3") / width("0,0,1") - 3.0).abs() < 1e-4);
    }

    #[test]
    fn nonsense_is_refused() {
        for wrong in [
            "", "1,2", "1,2,3,4", "a,2,1", "NaN,0,1", "0,inf,1", "0,0,0", "0,0,-1",
        ] {
            assert!(wrong.parse::<Camera>().is_err(), "{wrong}");
        }
        assert_eq!(camera(" 1, 2 ,0.5").zoom, 0.5);
    }
}
