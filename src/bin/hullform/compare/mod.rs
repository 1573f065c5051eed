//! `hullform compare`: methods side by side, with maps of their errors.

mod costs;
pub(crate) mod errors;
pub(crate) mod page;
pub(crate) mod picture;
pub(crate) mod scale;

use std::path::{Path, PathBuf};

use clap::Args;
use glam::Vec3;
use hullform::host::{Area, OffscreenTarget};
use hullform::mesh::{Model, Scheme};
use hullform::method::{METHODS, Method, Prepared, method};
use hullform::subdivision::LimitSurface;
use hullform::{Error, Result};
use serde_json::{Value, json};

use crate::camera::View;
use crate::capture::capture;
use crate::gpu::Gpu;
use crate::options::{self, Chosen, Cutting, Global, Size};
use crate::output::{self, Contents, Format, Surface, picture as composed, png, wrote};
use crate::{model, print, print_json, progress, render};
use errors::{Errors, Known, Reference, Twin};
use page::Page;
use scale::Scale;

/// What `--against` calls the limit in f64.
const TRUTH: &str = "truth";

/// The greatest range of the scales, in powers of ten, of positions over the diagonal and of normals in degrees. Below it only rounding is
/// left; above it no angle is, and nothing that would still be recognised.
const RANGES: [[i32; 2]; 2] = [[-9, 3], [-5, 2]];

/// Options of `compare`.
#[derive(Args)]
pub struct Arguments {
    /// OBJ file, or builtin:NAME
    pub model: PathBuf,
    /// Methods, from the top of the picture [default: all that can draw the model]
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    methods: Vec<String>,
    /// What to measure errors against: `truth`, the limit in f64, or a method
    #[arg(long, value_name = "NAME", default_value = TRUTH)]
    against: String,
    /// Picture to write
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    #[command(flatten)]
    shape: options::Shape,
    #[command(flatten)]
    steps: options::Steps,
    #[command(flatten)]
    tables: options::Tables,
    /// Size in pixels of each of the three pictures of a method
    #[arg(long, value_name = "WxH", default_value = "480x360")]
    size: Size,
    /// Draw so many frames of each method, and tell the least time
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=1000))]
    costs: Option<u32>,
    #[command(flatten)]
    sight: options::Sight,
}

/// A method that could draw the model: what it made, and how far off that is.
struct Column {
    chosen: Chosen,
    patches: usize,
    surface: Surface,
    errors: Errors,
    /// The least seconds of a frame, where they are asked for.
    seconds: Option<f64>,
}

/// A method that can draw the model, and the number of its patches.
type Able = (Chosen, usize);

/// A method that could not, and why.
struct Refusal {
    name: &'static str,
    reason: String,
}

/// Compares, and writes picture and numbers.
///
/// The picture comes last: what the validation layer complained about is not written.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    Format::of(&arguments.output, &[Format::Png])?;
    let against = against(&arguments.against)?;
    let model = Model::new(model::load(Some(&arguments.model), &arguments.shape)?);
    let asked = asked(&arguments.methods, model.mesh().options().scheme)?;
    let all: Vec<&Method> = asked.iter().copied().chain(against).collect();
    let options = arguments
        .tables
        .options(&all, arguments.steps.cutting().cut.level)?;
    let chosen = |method| Chosen {
        method,
        options,
        by_default: false,
        replaceable: false,
    };
    let asked: Vec<Chosen> = asked.into_iter().map(chosen).collect();
    let reads = model::file(Some(&arguments.model));
    let writes = [("--output", arguments.output.as_path())];
    let files = output::create(reads.as_slice(), &writes)?;
    let (able, refusals) = sort_out(&arguments.model, &model, &asked, arguments.steps.cutting())?;
    let mut known = Known::new(reference(&model, against.map(chosen))?);
    let gpu = Gpu::open(global)?;
    let mut columns = Vec::new();
    for (chosen, patches) in able {
        columns.push(measure(
            &gpu, &model, chosen, patches, &mut known, arguments, global,
        )?);
    }
    if let Some(frames) = arguments.costs {
        let all: Vec<Chosen> = columns.iter().map(|column| column.chosen).collect();
        let cutting = arguments.steps.cutting();
        let seconds = progress::during("drawing frames", |_| {
            costs::seconds(&gpu, &model, &all, cutting, frames, global)
        })?;
        for (column, seconds) in columns.iter_mut().zip(seconds) {
            column.seconds = Some(seconds);
        }
    }
    let scales = scales(&columns);
    let page = progress::during("drawing", |_| {
        draw(&gpu, &model, &columns, &refusals, scales, arguments, global)
    })?;
    gpu.finish()?;
    let contents: &Contents = &|out| png::write(out, page.width, page.height, &page.pixels);
    output::write(files.into_iter().zip([contents]))?;
    report(arguments, global, &columns, &refusals)
}

/// The methods of `--methods`, each once; all that do the scheme if none is named.
fn asked(names: &[String], scheme: Scheme) -> Result<Vec<&'static Method>> {
    if names.is_empty() {
        let able = METHODS.iter().filter(|method| method.check(scheme).is_ok());
        return Ok(able.collect());
    }
    let mut methods: Vec<&'static Method> = Vec::new();
    for name in names {
        let method = method(name).map_err(|error| renamed(error, "--methods", ""))?;
        if !methods.iter().any(|other| other.name == method.name) {
            methods.push(method);
        }
    }
    Ok(methods)
}

/// The method of `--against`; None for the truth.
fn against(name: &str) -> Result<Option<&'static Method>> {
    if name == TRUTH {
        return Ok(None);
    }
    let also = format!(", or {TRUTH}");
    method(name)
        .map(Some)
        .map_err(|error| renamed(error, "--against", &also))
}

/// The same complaint about the option that has the name here.
fn renamed(error: Error, option: &'static str, also: &str) -> Error {
    match error {
        Error::Option {
            problem, remedy, ..
        } => Error::Option {
            option,
            problem,
            remedy: remedy + also,
        },
        other => other,
    }
}

/// The methods that can draw the model, with the number of their patches, and those that refuse.
fn sort_out(
    path: &Path,
    model: &Model,
    asked: &[Chosen],
    cutting: Cutting,
) -> Result<(Vec<Able>, Vec<Refusal>)> {
    let (mut able, mut refusals) = (Vec::new(), Vec::new());
    for &chosen in asked {
        match progress::during("planning", |_| {
            let (prepared, _) = chosen.prepare(model)?;
            cutting
                .backend
                .check(&prepared, cutting.residence, cutting.cut.level)?;
            Ok::<_, Error>(prepared)
        }) {
            Ok(prepared) => able.push((chosen, patches(&prepared))),
            Err(error) => {
                let name = chosen.method.name;
                tracing::warn!("{}: {name} cannot draw it: {error}", path.display());
                refusals.push(Refusal {
                    name,
                    reason: error.to_string(),
                });
                if refusals.len() == asked.len() {
                    // With the exit code of the last refusal.
                    return Err(error);
                }
            }
        }
    }
    Ok((able, refusals))
}

fn patches(prepared: &Prepared) -> usize {
    prepared.passes.iter().map(|pass| pass.patches.len()).sum()
}

fn reference(model: &Model, against: Option<Chosen>) -> Result<Reference> {
    Ok(match against {
        None => {
            let limit = Box::new(LimitSurface::new(model.mesh()));
            Reference::Truth(limit, model.placement())
        }
        Some(chosen) => {
            let (prepared, _) = chosen.prepare(model)?;
            Reference::Method(Box::new(Twin::new(model, prepared)))
        }
    })
}

/// Captures what a method makes of the model and compares it.
fn measure(
    gpu: &Gpu,
    model: &Model,
    chosen: Chosen,
    patches: usize,
    known: &mut Known,
    arguments: &Arguments,
    global: &Global,
) -> Result<Column> {
    let cutting = arguments.steps.cutting();
    let surface = progress::during("tessellating", |_| {
        capture(gpu, model, chosen, cutting, None, global)
    })?;
    progress::during("evaluating the reference", |bar| known.learn(&surface, bar));
    Ok(Column {
        chosen,
        patches,
        errors: Errors::new(&surface, known, model),
        surface,
        seconds: None,
    })
}

/// The scales of positions and normals, one for all methods so that they compare.
fn scales(columns: &[Column]) -> [Scale; 2] {
    let kinds: [fn(&Column) -> errors::Summary; 2] = [|c| c.errors.position, |c| c.errors.normal];
    let scale = |kind: usize| {
        let summaries: Vec<_> = columns.iter().map(kinds[kind]).collect();
        let means: Vec<f64> = summaries.iter().map(|summary| summary.mean).collect();
        let maxima: Vec<f64> = summaries.iter().map(|summary| summary.maximum).collect();
        Scale::over(&means, &maxima, RANGES[kind])
    };
    [scale(0), scale(1)]
}

fn draw(
    gpu: &Gpu,
    model: &Model,
    columns: &[Column],
    refusals: &[Refusal],
    scales: [Scale; 2],
    arguments: &Arguments,
    global: &Global,
) -> Result<Page> {
    let Size { width, height } = arguments.size;
    let (mut bench, factor) = render::bench(gpu, width, height)?;
    let cutting = arguments.steps.cutting();
    let seen = view(model, columns, arguments);
    let finish = |target: &OffscreenTarget| {
        composed::compose(target.read_pixels(), target.area(), width, height, factor)
    };
    let mut rows = Vec::new();
    for column in columns {
        let chosen = column.chosen;
        let drawn = (&mut bench, factor);
        render::draw_lit(gpu, drawn, model, chosen, cutting, seen, global)?;
        let mut tiles = vec![finish(bench.target())];
        let maps = [&column.errors.positions, &column.errors.normals];
        for (errors, scale) in maps.into_iter().zip(scales) {
            picture::draw_map(
                gpu,
                bench.target(),
                model,
                &column.surface,
                errors,
                scale,
                &seen.0,
            )?;
            tiles.push(finish(bench.target()));
        }
        rows.push((column, tiles));
    }
    Ok(picture::lay_out(arguments, &rows, refusals, scales))
}

/// One view for all, which has all that any method draws in it, and where in the picture that is.
fn view(model: &Model, columns: &[Column], arguments: &Arguments) -> (View, Area) {
    let points = columns.iter().flat_map(|column| &column.surface.points);
    let points = points.map(|point| picture::local(model, point));
    let Size { width, height } = arguments.size;
    let aspect = width as f32 / height as f32;
    let points: Vec<Vec3> = points.collect();
    let view = arguments.sight.camera.frame(&points, aspect);
    (view, view.area(&points, [width, height]))
}

fn report(
    arguments: &Arguments,
    global: &Global,
    columns: &[Column],
    refusals: &[Refusal],
) -> Result<()> {
    if !global.prints_json() {
        return print(&as_text(arguments, columns, refusals));
    }
    let methods: Vec<Value> = columns.iter().map(facts).collect();
    let refused = refusals
        .iter()
        .map(|refusal| json!({ "method": refusal.name, "reason": refusal.reason }));
    let report = json!({
        "output": arguments.output.display().to_string(),
        "model": arguments.model.display().to_string(),
        "against": arguments.against,
        "level": arguments.steps.level,
        "backend": arguments.steps.cutting().backend.name(),
        "methods": methods,
        "refused": refused.collect::<Vec<_>>(),
    });
    print_json(&report)
}

fn facts(column: &Column) -> Value {
    json!({
        "method": column.chosen.method.name,
        "triangles": column.surface.triangles.len(),
        "patches": column.patches,
        "vertices": column.surface.points.len(),
        "position_error": column.errors.position.json(),
        "normal_error_degrees": column.errors.normal.json(),
        "seconds_per_frame": column.seconds,
    })
}

/// A line a method.
fn as_text(arguments: &Arguments, columns: &[Column], refusals: &[Refusal]) -> String {
    let frame = match arguments.costs {
        None => ["", ""],
        Some(_) => ["            frame", "        ms"],
    };
    let mut lines = vec![format!(
        "{:16} {:>10}   position error / diagonal        normal error, degrees{}\n{:16} {:>10}   maximum    mean       RMS        maximum    mean       RMS{}",
        "", "", frame[0], "method", "triangles", frame[1]
    )];
    lines.extend(columns.iter().map(|column| {
        let numbers = [column.errors.position, column.errors.normal]
            .iter()
            .flat_map(|summary| [summary.maximum, summary.mean, summary.rms])
            .map(|number| format!("{number:<9.2e}"))
            .collect::<Vec<_>>();
        let triangles = column.surface.triangles.len();
        let time = column
            .seconds
            .map(|seconds| format!("  {:.1}", 1e3 * seconds));
        let line = format!(
            "{:16} {triangles:>10}   {}{}",
            column.chosen.method.name,
            numbers.join("  "),
            time.unwrap_or_default()
        );
        line.trim_end().to_string()
    }));
    lines.extend(
        refusals
            .iter()
            .map(|refusal| format!("{:16}    refused", refusal.name)),
    );
    lines.push(wrote(&arguments.output));
    lines.join("\n")
}
