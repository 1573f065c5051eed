//! `hullform tessellate`: the surface as points or triangles.

use crate::capture::capture;
use crate::evaluation::evaluate;
use crate::gpu::Gpu;
use crate::options::{self, Global};
use crate::output::{self, Contents, Format, Surface, csv, obj, ply};
use crate::{model, print, print_json, progress};
use clap::{Args, ValueEnum};
use hullform::Result;
use hullform::error::visible;
use hullform::mesh::Model;
use serde_json::json;
use std::path::PathBuf;

/// Options of `tessellate`.
#[derive(Args)]
pub struct Arguments {
    /// OBJ file, or builtin:NAME
    pub model: PathBuf,
    /// File to write: .csv (a line a point), .obj or .ply (triangles)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    shape: options::Shape,
    #[command(flatten)]
    cut: options::Cut,
    /// Who evaluates the surface; where coordinates are powers of two, both give the same bits
    #[arg(long, value_name = "WHO", default_value = "device")]
    on: On,
    /// Where --adaptive looks from, and at what picture
    #[command(flatten)]
    sight: options::Sight,
}

/// Who evaluates a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum On {
    /// The CPU, on all cores: no Vulkan is needed
    Cpu,
    /// The evaluation shader
    Device,
}

/// Tessellates the model and writes what came out.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    let format = Format::of(&arguments.output, &[Format::Csv, Format::Obj, Format::Ply])?;
    let model = Model::new(model::load(Some(&arguments.model), &arguments.shape)?);
    let chosen = arguments.cut.chosen(&model)?;
    let reads = model::file(Some(&arguments.model));
    let writes = [("--output", arguments.output.as_path())];
    let files = output::create(reads.as_slice(), &writes)?;
    let cutting = arguments.cut.cutting();
    let surface = match arguments.on {
        On::Cpu => progress::during("tessellating", |_| evaluate(&model, chosen, cutting))?,
        On::Device => {
            let gpu = Gpu::open(global)?;
            let camera = Some(arguments.sight.camera);
            let surface = progress::during("tessellating", |_| {
                capture(&gpu, &model, chosen, cutting, camera, global)
            })?;
            gpu.finish()?;
            surface
        }
    };
    progress::during("writing", |_| {
        let contents: &Contents = &|out| match format {
            Format::Obj => obj::write(out, &surface),
            Format::Ply => ply::write(out, &surface),
            _ => csv::write(out, &surface),
        };
        output::write(files.into_iter().zip([contents]))
    })?;
    report(arguments, global, &surface)
}

fn report(arguments: &Arguments, global: &Global, surface: &Surface) -> Result<()> {
    let (points, triangles) = (surface.points.len(), surface.triangles.len());
    let path = arguments.output.display().to_string();
    if global.prints_json() {
        let report = json!({ "output": path, "points": points, "triangles": triangles });
        print_json(&report)
    } else {
        let path = visible(&path);
        print(&format!("{path}: {points} points, {triangles} triangles"))
    }
}
