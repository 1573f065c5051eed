//! The camera of a picture: it turns around what is drawn, which fills the frame.

use glam::{DMat3, DVec2, DVec3, DVec4, Mat4, UVec2, Vec3};
use hullform::host::Area;
use std::str::FromStr;

/// How far beyond the points that are framed something may yet be drawn, as a share of the picture that they take: what the frame leaves free
/// on either side of them, see [`FILL`].
const BEYOND: f64 = 0.5 * (1.0 / FILL - 1.0);

/// Half the angle under which the eye sees a sphere around all that is drawn.
const HALF_VIEW: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// How much of the picture's tighter side is filled.
const FILL: f64 = 0.9;

/// The room before and behind what is drawn, in radii of that sphere: more than rounding needs, and near what is drawn, so that depths keep
/// their digits.
const ROOM: f64 = 0.02;

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

/// What a camera sees of one model in one picture.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// From model space to Vulkan's clip space: y down, depth 0 to 1.
    pub clip_from_model: Mat4,
    /// The eye in model space.
    pub eye: Vec3,
}

impl View {
    /// The part of a picture of this size in which these points lie, with some room around them; all of it when a point is nowhere.
    pub fn area(&self, points: &[Vec3], [width, height]: [u32; 2]) -> Area {
        let whole = Area {
            x: 0,
            y: 0,
            width,
            height,
        };
        let size = UVec2::new(width, height).as_dvec2();
        let from_model = self.clip_from_model.as_dmat4();
        let seen = points.iter().map(|point| {
            let clip = from_model * point.as_dvec3().extend(1.0);
            (0.5 * (clip.truncate().truncate() / clip.w + 1.0) * size).extend(clip.w)
        });
        let (low, high) = bounds(seen);
        // Of a sum everything shows that was no number, which least and greatest leave out.
        let sum: Vec3 = points.iter().sum();
        if !sum.is_finite() || !(high - low).is_finite() || low.z <= 0.0 {
            return whole;
        }
        let [low, high] = [low, high].map(|corner| corner.truncate());
        // A line over an edge is a pixel wide.
        let beyond = BEYOND * (high - low).max_element() + 2.0;
        let low = (low - beyond).floor().clamp(DVec2::ZERO, size).as_uvec2();
        let high = (high + beyond).ceil().clamp(DVec2::ZERO, size).as_uvec2();
        Area {
            x: low.x,
            y: low.y,
            width: high.x - low.x,
            height: high.y - low.y,
        }
    }
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
    /// The view in which the projected box of `points` stands in the middle and fills [`FILL`] of the tighter side of a picture whose width
    /// is `aspect` times its height. Zoom enlarges that and leaves the eye where it is, outside of a sphere around all points: no point is
    /// ever clipped by its depth.
    ///
    /// Everything is measured in radii of that sphere, so that a model of any size gets the same picture. Points that are none, by an
    /// infinite or undefined coordinate, do not count.
    pub fn frame(&self, points: &[Vec3], aspect: f32) -> View {
        let finite = || points.iter().filter(|point| point.is_finite());
        let points = || finite().map(|point| point.as_dvec3());
        let (low, high) = bounds(points());
        let centre = 0.5 * (low + high);
        let radius = points().map(|point| point.distance(centre));
        let radius = match radius.fold(0.0, f64::max) {
            // A single point looks the same from everywhere.
            0.0 => 1.0,
            radius => radius,
        };
        let distance = 1.0 / HALF_VIEW.sin();
        let turn = DMat3::from_rotation_x(f64::from(self.pitch).to_radians())
            * DMat3::from_rotation_y(-f64::from(self.yaw).to_radians());
        let away = distance * DVec3::Z;
        let seen = points().map(|point| {
            let at = turn * ((point - centre) / radius) - away;
            (at.truncate() / -at.z).extend(-at.z)
        });
        let lens = Lens::around(bounds(seen), f64::from(aspect), f64::from(self.zoom));
        let rows = lens.rows().map(|row| {
            let axis = turn.transpose() * row.truncate() / radius;
            axis.extend(row.w - row.z * distance - axis.dot(centre))
        });
        View {
            clip_from_model: Mat4::from_cols_array_2d(&rows.map(|row| row.as_vec4().to_array()))
                .transpose(),
            eye: (centre + turn.transpose() * away * radius).as_vec3(),
        }
    }
}

/// What is seen of the space before an eye that looks along -z, y up.
struct Lens {
    /// From slopes, x and y over depth, to the picture's -1..1.
    scale: DVec2,
    /// The slopes in the middle of the picture.
    middle: DVec2,
    /// The least depth.
    near: f64,
    /// The greatest.
    far: f64,
}

impl Lens {
    /// What shows a box of slopes and depths.
    fn around((low, high): (DVec3, DVec3), aspect: f64, zoom: f64) -> Lens {
        let size = (high - low).truncate();
        let fitting = (2.0 * FILL * DVec2::new(aspect, 1.0) / size).min_element();
        // What has no extent at all fills no picture.
        let scale = if fitting.is_finite() {
            fitting
        } else {
            1.0 / HALF_VIEW.tan()
        };
        Lens {
            scale: zoom * scale / DVec2::new(aspect, 1.0),
            middle: 0.5 * (low + high).truncate(),
            near: low.z - ROOM,
            far: high.z + ROOM,
        }
    }

    /// The rows of the matrix that leads from there to clip space.
    fn rows(&self) -> [DVec4; 4] {
        let depth = self.far / (self.far - self.near);
        [
            self.scale.x * DVec4::new(1.0, 0.0, self.middle.x, 0.0),
            // Vulkan's y points down.
            -self.scale.y * DVec4::new(0.0, 1.0, self.middle.y, 0.0),
            -depth * DVec4::new(0.0, 0.0, 1.0, self.near),
            -DVec4::Z,
        ]
    }
}

/// The least and the greatest of each coordinate; zeros where there is no point.
fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points
        .map(|point| (point, point))
        .reduce(|(low, high), (point, _)| (low.min(point), high.max(point)))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_has_the_points_and_no_more_than_the_room_that_the_frame_leaves() {
        let view = camera("40,22,1").frame(&corners(), 2.0);
        let Area {
            x, width, height, ..
        } = view.area(&corners(), [1000, 500]);
        assert!(height >= 499 && width < 700, "{width} {height}");
        assert!(x > 100 && x + width < 900);
        let lost = [Vec3::ZERO, Vec3::NAN];
        assert_eq!(view.area(&lost, [10, 20]).width, 10);
    }

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
        let view = camera.frame(&corners(), aspect);
        view.clip_from_model.project_point3(point)
    }

    /// The corners of a box, and what else makes framing hard: a plane, a pole, a crowd far from the origin.
    fn shapes() -> Vec<Vec<Vec3>> {
        let shaped = |by: Vec3, to: Vec3| corners().iter().map(|&p| p * by + to).collect();
        vec![
            corners(),
            shaped(Vec3::new(1.0, 0.0, 1.0), Vec3::ZERO),
            shaped(Vec3::new(0.01, 7.0, 0.01), Vec3::ZERO),
            shaped(Vec3::ONE, Vec3::new(-3e3, 2e3, 1e3)),
        ]
    }

    fn cameras() -> impl Iterator<Item = Camera> {
        let yaws = (-180..180).step_by(30);
        yaws.flat_map(|yaw| {
            [-90, -77, -45, 0, 22, 80, 90].map(|pitch| camera(&format!("{yaw},{pitch},1")))
        })
    }

    #[test]
    fn the_projected_box_stands_in_the_middle_and_fills_the_tighter_side() {
        for (points, camera) in shapes()
            .into_iter()
            .flat_map(|points| cameras().map(move |camera| (points.clone(), camera)))
        {
            for aspect in [0.3, 1.0, 2.5] {
                let view = camera.frame(&points, aspect);
                let seen = points
                    .iter()
                    .map(|&p| view.clip_from_model.project_point3(p).as_dvec3());
                let (low, high) = bounds(seen);
                let place = format!("{camera:?} {aspect} {low} {high}");
                assert!(low.z > 0.0 && high.z < 1.0, "{place}");
                let middle = 0.5 * (low + high).truncate();
                assert!(middle.abs().max_element() < 2e-3, "{place}");
                let tighter = 0.5 * (high - low).truncate().max_element();
                assert!((tighter - FILL).abs() < 2e-3, "{place}");
            }
        }
    }

    #[test]
    fn models_of_any_size_have_the_same_picture() {
        for camera in cameras() {
            let view = camera.frame(&corners(), 1.6);
            let seen = corners()
                .into_iter()
                .map(|p| view.clip_from_model.project_point3(p));
            let seen: Vec<Vec3> = seen.collect();
            for scale in [1e-30f32, 1e-6, 1e6, 1e30].map(|scale| scale.log2().round().exp2()) {
                let scaled: Vec<Vec3> = corners().into_iter().map(|p| p * scale).collect();
                let view = camera.frame(&scaled, 1.6);
                let again = scaled
                    .iter()
                    .map(|&p| view.clip_from_model.project_point3(p));
                assert_eq!(again.collect::<Vec<Vec3>>(), seen, "{camera:?} {scale}");
            }
        }
    }

    #[test]
    fn what_has_no_extent_or_is_no_point_has_a_view_all_the_same() {
        for points in [
            vec![],
            vec![Vec3::ONE],
            vec![Vec3::X, 2.0 * Vec3::X],
            vec![Vec3::NAN],
        ] {
            let view = camera("90,0,1").frame(&points, 1.0);
            assert!(view.clip_from_model.is_finite() && view.eye.is_finite());
        }
        let mut points = corners();
        points.push(Vec3::new(0.0, f32::INFINITY, 0.0));
        let view = camera("30,20,1").frame(&points, 1.0);
        let right = camera("30,20,1").frame(&corners(), 1.0);
        assert_eq!(view.clip_from_model, right.clip_from_model);
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
    fn the_eye_projects_to_nowhere() {
        for camera in cameras() {
            let view = camera.frame(&corners(), 1.0);
            let clip = view.clip_from_model * view.eye.extend(1.0);
            assert!(clip.truncate().truncate().abs().max_element() < 1e-5);
            assert!(clip.w.abs() < 1e-5 && clip.z < 0.0, "{clip}");
        }
    }

    #[test]
    fn zoom_magnifies_about_the_middle_and_clips_no_depth() {
        for camera in cameras() {
            let near = camera.frame(&corners(), 1.0).clip_from_model;
            let zoomed = Camera {
                zoom: 3.0,
                ..camera
            };
            let far = zoomed.frame(&corners(), 1.0).clip_from_model;
            for point in corners() {
                let (once, thrice) = (near.project_point3(point), far.project_point3(point));
                let moved = 3.0 * once.truncate() - thrice.truncate();
                assert!(moved.abs().max_element() < 1e-4);
                assert_eq!(once.z, thrice.z);
            }
        }
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
