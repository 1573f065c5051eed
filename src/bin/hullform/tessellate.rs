//! `hullform tessellate`: the surface as points or triangles.

use crate::capture::capture;
use crate::gpu::Gpu;
use crate::options::{self, Global};
use crate::output::{self, Contents, Format, Surface, csv, obj, ply};
use crate::{model, print, print_json, progress};
use clap::Args;
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
    /// Where --adaptive looks from, and at what picture
    #[command(flatten)]
    sight: options::Sight,
}

/// Tessellates the model on the device and writes what came out.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    let format = Format::of(&arguments.output, &[Format::Csv, Format::Obj, Format::Ply])?;
    let model = Model::new(model::load(Some(&arguments.model), &arguments.shape)?);
    let chosen = arguments.cut.chosen(&model)?;
    let reads = model::file(Some(&arguments.model));
    let writes = [("--output", arguments.output.as_path())];
    let files = output::create(reads.as_slice(), &writes)?;
    let gpu = Gpu::open(global)?;
    let surface = progress::during("tessellating", |_| {
        let camera = Some(arguments.sight.camera);
        capture(
            &gpu,
            &model,
            chosen,
            arguments.cut.cutting(),
            camera,
            global,
        )
    })?;
    gpu.finish()?;
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
