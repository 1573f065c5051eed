//! The camera of a picture: it turns around the model, which fills the frame.

use glam::camera::rh::proj::vulkan;
use glam::{DVec3, Mat4, Vec3};
use std::str::FromStr;

/// Half the angle of view over the shorter side, at zoom 1.
const HALF_VIEW: f32 = 20.0 * std::f32::consts::PI / 180.0;

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
    /// Frames the ball around the box `bounds` in a picture whose width is `aspect` times its height.
    pub fn frame(&self, bounds: (DVec3, DVec3), aspect: f32) -> View {
        let centre = ((bounds.0 + bounds.1) * 0.5).as_vec3();
        // A single point still needs near < far.
        let radius = ((bounds.1 - bounds.0).length() * 0.5).max(1e-6) as f32;
        let distance = radius / HALF_VIEW.sin();
        let eye_from_model = Mat4::from_translation(Vec3::new(0.0, 0.0, -distance))
            * Mat4::from_rotation_x(self.pitch.to_radians())
            * Mat4::from_rotation_y(-self.yaw.to_radians())
            * Mat4::from_translation(-centre);
        View {
            eye_from_model,
            clip_from_eye: self.projection(radius, distance, aspect),
        }
    }

    /// Zoom narrows the angle of view and leaves the eye outside of the ball, whatever it is: nothing is ever clipped.
    fn projection(&self, radius: f32, distance: f32, aspect: f32) -> Mat4 {
        let shorter = HALF_VIEW.tan() / self.zoom;
        let vertical = if aspect < 1.0 {
            shorter / aspect
        } else {
            shorter
        };
        let near = (distance - radius) * 0.9;
        let far = (distance + radius) * 1.1;
        vulkan::perspective(2.0 * vertical.atan(), aspect, near, far)
    }
}

impl View {
    /// From model to clip space.
    pub fn clip_from_model(&self) -> Mat4 {
        self.clip_from_eye * self.eye_from_model
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: (DVec3, DVec3) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(3.0, 6.0, 11.0));

    fn camera(text: &str) -> Camera {
        text.parse().expect("a camera")
    }

    fn project(camera: &Camera, aspect: f32, point: DVec3) -> Vec3 {
        let view = camera.frame(BOX, aspect);
        view.clip_from_model().project_point3(point.as_vec3())
    }

    #[test]
    fn every_corner_is_in_the_picture_from_everywhere() {
        for yaw in (-180..180).step_by(30) {
            for pitch in [-90, -45, 0, 45, 90] {
                for aspect in [0.3, 1.0, 2.5] {
                    let camera = camera(&format!("{yaw},{pitch},1"));
                    for corner in 0..8 {
                        let pick = |axis: usize| {
                            if corner >> axis & 1 == 0 {
                                BOX.0[axis]
                            } else {
                                BOX.1[axis]
                            }
                        };
                        let corner = DVec3::new(pick(0), pick(1), pick(2));
                        let p = project(&camera, aspect, corner);
                        assert!(p.x.abs() <= 1.001 && p.y.abs() <= 1.001, "{p}");
                        assert!((0.0..=1.0).contains(&p.z), "{p}");
                    }
                }
            }
        }
    }

    #[test]
    fn up_is_up_and_right_is_right() {
        let front = camera("0,0,1");
        let centre = (BOX.0 + BOX.1) * 0.5;
        assert!(project(&front, 1.0, centre).truncate().length() < 1e-5);
        // Vulkan's y points down.
        assert!(project(&front, 1.0, centre + DVec3::Y).y < 0.0);
        assert!(project(&front, 1.0, centre + DVec3::X).x > 0.0);
        let nearer = project(&front, 1.0, centre + DVec3::Z);
        assert!(nearer.z < project(&front, 1.0, centre).z);
        // From the right, and from above.
        assert!(project(&camera("90,0,1"), 1.0, centre + DVec3::Z).x < 0.0);
        assert!(project(&camera("0,90,1"), 1.0, centre + DVec3::Z).y > 0.0);
    }

    #[test]
    fn zoom_magnifies() {
        let point = (BOX.0 + BOX.1) * 0.5 + DVec3::X;
        let once = project(&camera("0,0,1"), 1.0, point).x;
        let thrice = project(&camera("0,0,3"), 1.0, point).x;
        assert!((thrice / once - 3.0).abs() < 1e-4);
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
