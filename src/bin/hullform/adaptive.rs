//! `--adaptive`: what depth tags go by.

use std::fmt;
use std::str::FromStr;

use glam::{Mat4, Vec3};
use hullform::gpu::Metric;
use hullform::method::{DepthTags, Outline};

/// What depth tags go by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Adaptive {
    /// The distance from the eye: the full level up to this many units of the model, or up to the nearest limit of a vertex, and half of it at
    /// twice the distance.
    Distance(Option<f64>),
    /// The picture: segments of at most so many pixels.
    Screen(f32),
    /// The curvature: segments whose ends' normals differ by at most so many degrees.
    Curvature(f32),
}

/// Pixels of a segment when nobody says how many.
const PIXELS: f32 = 8.0;
/// Degrees of a segment.
const DEGREES: f32 = 5.0;

impl Adaptive {
    /// One of each kind, as it is when nobody says more.
    #[cfg(feature = "view")]
    pub const ALL: [Adaptive; 3] = [
        Adaptive::Screen(PIXELS),
        Adaptive::Distance(None),
        Adaptive::Curvature(DEGREES),
    ];
}

/// As the command line has it.
impl fmt::Display for Adaptive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Adaptive::Distance(None) => write!(f, "distance"),
            Adaptive::Distance(Some(units)) => write!(f, "distance:{units}"),
            Adaptive::Screen(pixels) => write!(f, "screen:{pixels}"),
            Adaptive::Curvature(degrees) => write!(f, "curvature:{degrees}"),
        }
    }
}

impl FromStr for Adaptive {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Adaptive, Self::Err> {
        let (name, number) = match text.split_once(':') {
            None => (text, None),
            Some((name, number)) => match number.parse::<f64>() {
                Ok(number) if number.is_finite() && number > 0.0 => (name, Some(number)),
                _ => return Err("expected a number greater than 0 after the colon"),
            },
        };
        match name {
            "distance" => Ok(Adaptive::Distance(number)),
            "screen" => Ok(Adaptive::Screen(
                number.map_or(PIXELS, |number| number as f32),
            )),
            "curvature" => Ok(Adaptive::Curvature(
                number.map_or(DEGREES, |number| number as f32),
            )),
            _ => Err("expected distance[:UNITS], screen[:PIXELS] or curvature[:DEGREES]"),
        }
    }
}

/// From where tags are seen.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// From local units to clip space.
    pub clip_from_model: Mat4,
    /// The eye in local units.
    pub eye: Vec3,
    /// A local unit in units of the model.
    pub scale: f64,
    /// The picture's size in pixels.
    pub size: [f32; 2],
}

impl Adaptive {
    /// The tags of control vertices in local units; `level` is the greatest level.
    pub fn tags(
        self,
        outline: &Outline,
        vertices: &[Vec3],
        level: f32,
        seen: Seen,
    ) -> hullform::Result<DepthTags> {
        match self {
            Adaptive::Distance(near) => {
                let near = full_up_to(near, outline, vertices, seen)?;
                DepthTags::by_distance(outline, vertices, seen.eye, near, level.log2())
            }
            Adaptive::Screen(pixels) => {
                let clip = seen.clip_from_model.to_cols_array_2d();
                DepthTags::by_screen(outline, vertices, clip, seen.size, pixels)
            }
            Adaptive::Curvature(degrees) => DepthTags::by_curvature(outline, vertices, degrees),
        }
    }

    /// The same in a picture whose pixels are drawn as squares of so many.
    pub fn scaled(self, factor: f32) -> Adaptive {
        match self {
            Adaptive::Screen(pixels) => Adaptive::Screen(factor * pixels),
            other => other,
        }
    }

    /// What the device goes by, of control vertices in local units.
    pub fn metric(
        self,
        outline: &Outline,
        vertices: &[Vec3],
        seen: Seen,
    ) -> hullform::Result<Metric> {
        let Seen { size, .. } = seen;
        Ok(match self {
            Adaptive::Distance(near) => {
                Metric::Distance(full_up_to(near, outline, vertices, seen)?)
            }
            Adaptive::Screen(pixels) => Metric::Screen { pixels, size },
            Adaptive::Curvature(degrees) => Metric::Curvature(degrees),
        })
    }
}

/// Up to where the level is full, in local units: so many units of the model, or where the nearest limit of a vertex is.
fn full_up_to(
    near: Option<f64>,
    outline: &Outline,
    vertices: &[Vec3],
    seen: Seen,
) -> hullform::Result<f32> {
    let nearest = || -> hullform::Result<f32> {
        let limits = outline.limits(vertices)?;
        let distances = limits.iter().map(|limit| limit.distance(seen.eye));
        Ok(distances.fold(f32::INFINITY, f32::min))
    };
    let given = near.map(|near| Ok((near / seen.scale) as f32));
    let near = given.unwrap_or_else(nearest)?;
    Ok(near.clamp(f32::MIN_POSITIVE, f32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers() {
        assert_eq!("screen:4".parse(), Ok(Adaptive::Screen(4.0)));
        assert_eq!("curvature".parse(), Ok(Adaptive::Curvature(DEGREES)));
        assert_eq!("distance".parse(), Ok(Adaptive::Distance(None)));
        for right in ["distance", "distance:2.5", "screen:4", "curvature:7.5"] {
            let read: Adaptive = right.parse().expect(right);
            assert_eq!(read.to_string(), right);
        }
        for wrong in [
            "",
            "near",
            "screen:0",
            "screen:",
            "curvature:-1",
            "distance:NaN",
        ] {
            assert!(wrong.parse::<Adaptive>().is_err(), "{wrong}");
        }
    }
}
