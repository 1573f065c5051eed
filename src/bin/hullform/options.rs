//! Options that several subcommands share, and how their values are read.

mod culling;
mod macro_faces;
mod standpoint;
mod steps;
mod tables;

use crate::adaptive::Adaptive;
use crate::camera::Camera;
use crate::db::database;
use clap::{Args, ValueEnum};
use hullform::Error;
use hullform::mesh::{Model, Scheme};
use hullform::method::{
    Method, MethodOptions, Prepared, method, method_for, prepare_by_default_with,
};
use std::path::PathBuf;
use std::str::FromStr;

pub use culling::Culling;
pub use macro_faces::Macro;
pub use standpoint::{Cull, Standpoint};
pub use steps::{Backend, Residence, SpacingParser, Steps};
pub use tables::Tables;

/// Options of every subcommand.
#[derive(Args, Clone)]
pub struct Global {
    /// Vulkan device: its index or a part of its name [default: the first discrete GPU that will do, else any]
    #[arg(long, global = true, value_name = "INDEX|NAME", value_parser = device)]
    pub device: Option<String>,
    /// Run under the validation layer; any message of it makes the run fail
    #[arg(long, global = true)]
    pub validation: bool,
    /// Switch off the workarounds for driver faults (see `hullform devices`)
    #[arg(long, global = true)]
    pub no_workarounds: bool,
    /// Folder in which what the driver keeps of its pipelines is kept from run to run, or `none` [default: hullform among the user's caches]
    #[arg(long, global = true, value_name = "FOLDER|none")]
    pub pipeline_cache: Option<PathBuf>,
    /// Print results as JSON
    // `verify` has an option of the same id that takes a file, hence the type.
    #[arg(long, id = "json", global = true, num_args = 0..=1, require_equals = true, default_missing_value = "-", value_name = "", hide_possible_values = true, value_parser = Json::printed)]
    json: Option<Json>,
    /// Scratch memory that control shaders share: bytes, or with KiB or MiB
    #[arg(long, global = true, value_name = "N", default_value = "1MiB", value_parser = bytes)]
    pub ring_bytes: u64,
    /// Who gives patches their slots in that memory
    #[arg(long, global = true, value_name = "WHO", default_value = "counter")]
    pub slots: Slots,
    /// Who computes the points that some methods derive from the control vertices, with the same bits
    #[arg(long, global = true, value_name = "WHO", default_value = "host")]
    pub points: Points,
    /// File that plans are kept in from run to run, or none [default: hullform/plans.db in the user's cache]
    #[arg(long, global = true, value_name = "PATH|none")]
    pub db: Option<PathBuf>,
}

impl Global {
    /// Whether results are printed as JSON.
    pub fn prints_json(&self) -> bool {
        self.json == Some(Json::Print)
    }
}

/// Who computes points from the control vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Points {
    /// The host, on all cores
    Host,
    /// A compute shader
    Device,
}

/// Where results go as JSON.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Json {
    /// To standard output.
    Print,
    /// To a file.
    File(PathBuf),
}

impl Json {
    /// `--json` of every subcommand.
    fn printed(text: &str) -> Result<Json, &'static str> {
        match text {
            "-" => Ok(Json::Print),
            _ => Err("only `verify` writes JSON into a file"),
        }
    }

    /// `--json [FILE]` of `verify`.
    pub fn anywhere(text: &str) -> Result<Json, &'static str> {
        match text {
            "-" => Ok(Json::Print),
            "" => Err("expected the name of a file"),
            file => Ok(Json::File(file.into())),
        }
    }
}

/// Who gives patches their slots in the scratch ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Slots {
    /// The control shaders, from a counter a batch
    Counter,
    /// The host, by summing up beforehand
    Host,
}

impl Slots {
    /// As the command line has it.
    pub fn name(self) -> &'static str {
        match self {
            Slots::Counter => "counter",
            Slots::Host => "host",
        }
    }
}

/// Where the vertices of a subdivided edge lie: Vulkan's spacing modes that keep them apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Spacing {
    /// Whole levels, equal steps
    Equal,
    /// Any level; vertices slide in pairs as it grows
    FractionalEven,
}

impl From<Spacing> for hullform::tessellation::Spacing {
    fn from(spacing: Spacing) -> Self {
        match spacing {
            Spacing::Equal => hullform::tessellation::Spacing::Equal,
            Spacing::FractionalEven => hullform::tessellation::Spacing::FractionalEven,
        }
    }
}

/// Which surface a model has: options of all subcommands that load one.
#[derive(Args, Clone)]
pub struct Shape {
    /// Subdivision scheme: catmull-clark, loop, butterfly, loop-stam or bilinear [default: what the file's name begins with
    /// (`loop_`, `bilinear_`, `catmark_`), else catmull-clark]
    #[arg(long, value_name = "NAME")]
    pub scheme: Option<String>,
    /// How faces are cut for a scheme that takes triangles
    #[arg(long, value_name = "HOW", default_value = "shortest-diagonal")]
    pub triangulate: Triangulate,
}

impl Shape {
    /// The options again, for a worker.
    pub fn words(&self) -> Vec<String> {
        let scheme = self
            .scheme
            .iter()
            .map(|scheme| format!("--scheme={scheme}"));
        let how = match self.triangulate {
            Triangulate::Fan => "fan",
            Triangulate::ShortestDiagonal => "shortest-diagonal",
        };
        scheme.chain([format!("--triangulate={how}")]).collect()
    }
}

/// How a polygon is cut into triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Triangulate {
    /// From the face's first vertex
    Fan,
    /// Along the shortest diagonal first
    ShortestDiagonal,
}

impl From<Triangulate> for hullform::mesh::Triangulation {
    fn from(how: Triangulate) -> Self {
        match how {
            Triangulate::Fan => hullform::mesh::Triangulation::Fan,
            Triangulate::ShortestDiagonal => hullform::mesh::Triangulation::ShortestDiagonal,
        }
    }
}

/// How a surface is cut up: options that `render` and `tessellate` share.
#[derive(Args)]
pub struct Cut {
    /// Surface method [default: one that draws the model's limit, else one that comes near]
    #[arg(long, value_name = "NAME")]
    method: Option<String>,
    #[command(flatten)]
    steps: Steps,
    /// Levels of their own for edges, up to --level: `distance[:UNITS]` (halves with the distance from the eye, beyond the
    /// nearest vertex or so many units), `screen[:PIXELS]` (segments of at most 8 pixels, or so many), `curvature[:DEGREES]` (normals
    /// turn by at most 5 degrees a segment, or so many). `render` has the device decide, but with other back-ends or --slots host
    #[arg(long, value_name = "HOW")]
    adaptive: Option<Adaptive>,
    #[command(flatten)]
    tables: Tables,
}

/// How a surface is cut up, by whom, and by what depth tags go.
#[derive(Clone, Copy, Debug)]
pub struct Cutting {
    /// How finely.
    pub cut: hullform::gpu::Cut,
    /// By whom.
    pub backend: hullform::gpu::Backend,
    /// Where control points live.
    pub residence: hullform::gpu::Residence,
    /// What depth tags go by.
    pub adaptive: Option<Adaptive>,
}

/// A method, and how it prepares.
#[derive(Clone, Copy)]
pub struct Chosen {
    /// The method.
    pub method: &'static Method,
    /// Its options.
    pub options: MethodOptions,
    /// Whether nobody asked for it.
    pub by_default: bool,
    /// Whether another may stand in for it, where it refuses the model: nobody asked for options of its own either.
    pub replaceable: bool,
}

impl Chosen {
    /// Prepares a model; with the reasons why methods that come before the one that did it refused.
    pub fn prepare(&self, model: &Model) -> hullform::Result<(Prepared, Vec<Error>)> {
        match self.replaceable {
            true => prepare_by_default_with(model, self.options, database()?),
            false => {
                let prepared = self.method.prepare_with(model, self.options, database()?)?;
                Ok((prepared, Vec::new()))
            }
        }
    }
}

impl Cut {
    /// Refuses a method that does not do a scheme, before anything is made.
    pub fn check(&self, scheme: Scheme) -> hullform::Result<()> {
        match &self.method {
            None => Ok(()),
            Some(name) => method(name)?.check(scheme),
        }
    }

    /// The method that is asked for, or else draws a model, with its options.
    pub fn chosen(&self, model: &Model) -> hullform::Result<Chosen> {
        let method = match &self.method {
            None => method_for(model),
            Some(name) => method(name)?,
        };
        method.check(model.mesh().options().scheme)?;
        let level = self.steps.cutting().cut.level;
        let options = self.tables.options(&[method], level)?;
        Ok(Chosen {
            method,
            options,
            by_default: self.method.is_none(),
            replaceable: self.method.is_none() && self.tables.asked().next().is_none(),
        })
    }

    /// As the library takes it.
    pub fn cutting(&self) -> Cutting {
        Cutting {
            adaptive: self.adaptive,
            ..self.steps.cutting()
        }
    }
}

/// Where a picture is taken from: an option of whatever draws.
#[derive(Args)]
pub struct Sight {
    /// Angles in degrees and a zoom
    #[arg(
        long,
        value_name = "YAW,PITCH,ZOOM",
        default_value = "40,22,1",
        allow_hyphen_values = true
    )]
    pub camera: Camera,
}

/// Width and height of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
}

impl FromStr for Size {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Size, Self::Err> {
        let sides = text.split_once(['x', 'X']);
        let sides = sides.and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
        match sides {
            Some((width @ 1.., height @ 1..)) => Ok(Size { width, height }),
            _ => Err("expected WIDTHxHEIGHT in pixels, such as 1280x720"),
        }
    }
}

fn device(text: &str) -> Result<String, &'static str> {
    match text.trim() {
        "" => Err("expected an index or a part of a name"),
        _ => Ok(text.into()),
    }
}

/// A tess level.
pub fn level(text: &str) -> Result<f32, &'static str> {
    match text.parse() {
        Ok(level) if (1.0..=1024.0).contains(&level) => Ok(level),
        _ => Err("expected a number from 1 to 1024"),
    }
}

/// A share of something, either way.
pub fn share(text: &str) -> Result<f32, &'static str> {
    match text.parse() {
        Ok(share) if (-1.0..=1.0).contains(&share) => Ok(share),
        _ => Err("expected a number from -1 to 1"),
    }
}

pub fn bytes(text: &str) -> Result<u64, &'static str> {
    let units = [("KiB", 1 << 10), ("MiB", 1 << 20)];
    let stripped = units
        .iter()
        .find_map(|&(name, unit)| Some((text.strip_suffix(name)?, unit)));
    let (digits, unit) = stripped.unwrap_or((text, 1));
    let count: Option<u64> = digits.trim_end().parse().ok();
    match count.and_then(|count| count.checked_mul(unit)) {
        Some(bytes @ 1..) => Ok(bytes),
        _ => Err("expected a number of bytes, such as 65536, 512KiB or 4MiB"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        let size = Size {
            width: 640,
            height: 480,
        };
        assert_eq!("640x480".parse(), Ok(size));
        for wrong in [
            "",
            "640",
            "640x",
            "0x480",
            "-1x4",
            "640x480x3",
            "9999999999x1",
        ] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn levels() {
        assert_eq!(level("1"), Ok(1.0));
        assert_eq!(level("6.5"), Ok(6.5));
        for wrong in ["0.99", "1024.01", "NaN", "inf", "x", ""] {
            assert!(level(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn byte_counts() {
        assert_eq!(bytes("4096"), Ok(4096));
        assert_eq!(bytes("3KiB"), Ok(3072));
        assert_eq!(bytes("1 MiB"), Ok(1 << 20));
        for wrong in ["0", "KiB", "1GB", "-1", "18446744073709551615MiB"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }
}
