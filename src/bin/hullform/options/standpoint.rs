//! A place to look from that somebody chose, instead of one from which all is seen.

use clap::{Args, ValueEnum};
use hullform::ash::vk;

use crate::eye::{Eye, Lens, Point};

/// The usual angle from the picture's lower to its upper side, in degrees.
const FOV: f64 = 32.0;

/// Where a picture is taken from, in the model's own coordinates: an option of `render`.
#[derive(Args, Clone)]
pub struct Standpoint {
    /// Look from this place of the model's own space, instead of --camera; with --to
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        requires = "to"
    )]
    from: Option<Point>,
    /// What --from looks at; it stands in the middle of the picture
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        requires = "from"
    )]
    to: Option<Point>,
    /// Angle from the lower to the upper side of what --from sees, in degrees [default: 32]
    #[arg(long, value_name = "DEGREES", requires = "from", conflicts_with = "parallel", value_parser = angle)]
    fov: Option<f64>,
    /// Parallel lines of sight, for --from: the height of the picture in units of the model
    #[arg(long, value_name = "HEIGHT", requires = "from", value_parser = height)]
    parallel: Option<f64>,
}

impl Standpoint {
    /// The eye that is asked for.
    pub fn eye(&self) -> Option<Eye> {
        let (from, to) = (self.from?.0, self.to?.0);
        let lens = match self.parallel {
            Some(height) => Lens::Orthographic(height),
            None => Lens::Perspective(self.fov.unwrap_or(FOV)),
        };
        Some(Eye { from, to, lens })
    }

    /// The words that ask for an eye. Numbers are the shortest that read back as the same bits.
    #[cfg(feature = "view")]
    pub fn words(eye: &Eye) -> Vec<String> {
        let point = |p: glam::DVec3| format!("{},{},{}", p.x, p.y, p.z);
        let lens = match eye.lens {
            Lens::Perspective(degrees) => format!("--fov={degrees}"),
            Lens::Orthographic(height) => format!("--parallel={height}"),
        };
        vec![
            format!("--from={}", point(eye.from)),
            format!("--to={}", point(eye.to)),
            lens,
        ]
    }
}

fn angle(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(degrees) if (0.1..=170.0).contains(&degrees) => Ok(degrees),
        _ => Err("expected an angle from 0.1 to 170"),
    }
}

fn height(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(height) if height > 0.0 && f64::is_finite(height) => Ok(height),
        _ => Err("expected a number greater than 0"),
    }
}

/// Which triangles are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Cull {
    /// None
    #[default]
    None,
    /// Those that are seen from behind
    Back,
    /// Those that are seen from the front
    Front,
}

impl Cull {
    /// As Vulkan has it.
    pub fn mode(self) -> vk::CullModeFlags {
        match self {
            Cull::None => vk::CullModeFlags::NONE,
            Cull::Back => vk::CullModeFlags::BACK,
            Cull::Front => vk::CullModeFlags::FRONT,
        }
    }
}
