//! `hullform bench`: what a frame costs, by model, method, level and backend, in time and in work.

mod against;
mod plot;
mod row;
mod subject;

use std::path::{Path, PathBuf};

use clap::Args;
use hullform::gpu::{Backend, Decides, Residence};
use hullform::host::Bench;
use hullform::mesh::Model;
use hullform::method::{METHODS, Method, Prepared, Reproduces, method};
use hullform::{Error, Result};
use serde_json::{Value, json};

use crate::adaptive::Adaptive;
use crate::deciding::Wanted;
use crate::drawing;
use crate::gpu::Gpu;
use crate::options::{self, Chosen, Global, Json, Size};
use crate::output::{self, Contents};
use crate::{model, print, print_json, progress};
use against::Saved;
use row::Row;
use subject::Subject;

/// What ratios are to: the faces themselves.
fn yardstick() -> &'static Method {
    let is_faces = |method: &&Method| matches!(method.contract.reproduces, Reproduces::Faces(_));
    METHODS
        .iter()
        .find(is_faces)
        .expect("there is the baseline")
}

/// Options of `bench`.
#[derive(Args)]
pub struct Arguments {
    /// OBJ files, or builtin:NAME
    #[arg(required = true, value_name = "MODEL")]
    models: Vec<PathBuf>,
    #[command(flatten)]
    shape: options::Shape,
    #[command(flatten)]
    tables: options::Tables,
    /// Methods [default: all that can draw a model]; `flat`, which ratios are to, is always measured
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    methods: Vec<String>,
    /// Tessellation levels, 1 to 64; up to 1024 as for `render`
    #[arg(long, value_name = "L,M,...", value_delimiter = ',', default_value = "1,2,4,8,16,32", value_parser = options::level)]
    levels: Vec<f32>,
    /// Spacing of the vertices along an edge
    #[arg(long, default_value = "equal", value_parser = options::SpacingParser)]
    spacing: options::Spacing,
    /// Who cuts patches into triangles, one or several
    #[arg(
        long,
        value_name = "A,B,...",
        value_delimiter = ',',
        default_value = "tessellator"
    )]
    backend: Vec<options::Backend>,
    /// Where control points live, one or both; methods without a ring are measured once
    #[arg(
        long,
        value_name = "A,B",
        value_delimiter = ',',
        default_value = "ring"
    )]
    residence: Vec<options::Residence>,
    /// Nothing moves from frame to frame: what is cached is computed once. Without it caches are filled in each frame, and points computed
    #[arg(long = "static")]
    is_static: bool,
    /// How many times a frame draws the surface
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u32).range(1..=64))]
    passes: u32,
    /// How many instances each pass draws: all in one draw of a batch, but one by one where control points are in the ring
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u32).range(1..=1024))]
    instances: u32,
    /// Levels of their own for edges, up to each of --levels, decided by the device in each frame: `distance[:UNITS]`, `screen[:PIXELS]` or
    /// `curvature[:DEGREES]`, as for `render`
    #[arg(long, value_name = "HOW")]
    adaptive: Option<Adaptive>,
    /// Leave patches out before anything of them is computed, one or several: `frustum` outside of the picture, `back` that show nothing but their
    /// backs, `small` between samples, one a pixel, `all` of these, or `none`
    #[arg(long, value_name = "A,B,...", default_value = "none")]
    cull: options::Culling,
    /// Size, in pixels, of the picture that --adaptive and --cull go by
    #[arg(long, value_name = "WxH", default_value = "1280x720")]
    size: Size,
    /// From where they see it
    #[command(flatten)]
    sight: options::Sight,
    /// Frames that are measured of each, all in turn; one more warms up
    #[arg(long, value_name = "N", default_value = "20", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// Write results as JSON into a file; without FILE print them
    #[arg(long, id = "json", value_name = "FILE", num_args = 0..=1, default_missing_value = "-", value_parser = Json::anywhere)]
    json: Option<Json>,
    /// Write results as comma-separated values
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a picture of them: times over levels
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Tell what changed since a run that was saved with --json
    #[arg(long, value_name = "OLD.json")]
    against: Option<PathBuf>,
}

impl Arguments {
    /// What is to be decided about patches.
    fn wanted(&self) -> Wanted {
        Wanted {
            adaptive: self.adaptive,
            culling: self.cull,
        }
    }

    /// Whether a method is asked for whose depths the host decides: then it decides levels for all, so that they are the same.
    fn is_dynamic(&self) -> bool {
        let mut asked = self.methods.iter().map(|name| method(name));
        asked.any(|asked| asked.is_ok_and(|method| method.dynamic))
    }

    /// # Errors
    /// [`Error::Option`] for decisions that nobody takes.
    fn check(&self, global: &Global) -> Result<()> {
        let slots = drawing::slots(global.slots);
        let wanted = self.wanted();
        let greatest = self.levels.iter().copied().fold(1.0, f32::max);
        let decides = |backend| wanted.decides((backend, self.is_dynamic()), slots, greatest);
        let all: Result<Vec<Decides>> = self.backend.iter().map(|&b| decides(b.into())).collect();
        if wanted.is_anything() && all?.contains(&Decides::Host) && !self.is_dynamic() {
            return Err(Error::Option {
                option: if self.adaptive.is_some() {
                    "--adaptive"
                } else {
                    "--cull"
                },
                problem: "the device decides for the tessellator alone, with slots by counters, and up to level 64"
                    .into(),
                remedy: "leave out --backend, --slots and levels above 64, or decisions".into(),
            });
        }
        Ok(())
    }
}

/// Measures, prints a table, and writes what is asked for.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    arguments.check(global)?;
    let reads: Vec<&Path> = arguments
        .models
        .iter()
        .filter_map(|path| model::file(Some(path)))
        .chain(arguments.against.as_deref())
        .collect();
    let saved = arguments.against.as_deref().map(Saved::read).transpose()?;
    let json = match &arguments.json {
        Some(Json::File(path)) => Some(("--json", path.as_path())),
        _ => None,
    };
    let csv = arguments.csv.as_deref().map(|path| ("--csv", path));
    let plot = arguments.plot.as_deref().map(|path| ("--plot", path));
    let writes: Vec<_> = [json, csv, plot].into_iter().flatten().collect();
    let files = output::create(&reads, &writes)?;
    keep_memory();
    let gpu = Gpu::open(global)?;
    let mut rows = Vec::new();
    for path in &arguments.models {
        let measured = measure(&gpu, path, arguments, global);
        rows.extend(model::named(Some(path), measured)?);
    }
    row::set_ratios(&mut rows);
    let info = gpu.device.info();
    let mut report = json!({
        "device": info.name,
        "driver": format!("{} {}", info.driver.name, info.driver.info),
        "rows": rows.iter().map(Row::json).collect::<Vec<Value>>(),
    });
    let compared = saved.map(|saved| saved.compared(&report));
    if let Some(compared) = &compared {
        report["against"] = compared.lines().collect();
    }
    let title = format!("{}, {} {}", info.name, info.driver.name, info.driver.info);
    gpu.finish()?;
    let as_json: &Contents = &|out| writeln!(out, "{report:#}");
    let as_csv: &Contents = &|out| row::write_csv(out, &report);
    let drawn = plot::svg(&title, &rows);
    let as_plot: &Contents = &|out| out.write_all(drawn.as_bytes());
    let contents = [(json, as_json), (csv, as_csv), (plot, as_plot)];
    let contents = contents.into_iter().filter(|(file, _)| file.is_some());
    output::write(
        files
            .into_iter()
            .zip(contents.map(|(_, contents)| contents)),
    )?;
    if arguments.json == Some(Json::Print) || global.prints_json() {
        print_json(&report)
    } else {
        let table = row::as_text(&title, &rows);
        let texts: Vec<String> = [table].into_iter().chain(compared).collect();
        print(&texts.join("\n"))
    }
}

/// Has the C library keep what is given back to it. llvmpipe takes what frames need from there, and what comes fresh from the system costs page faults, for
/// some sizes and runs in every frame: frames took up to four times as long, by chance.
fn keep_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: it sets numbers of the allocator; no other thread runs yet.
    unsafe {
        libc::mallopt(libc::M_MMAP_MAX, 0);
        libc::mallopt(libc::M_TRIM_THRESHOLD, i32::MAX);
    }
}

/// Draws all frames of a model: everything in turn, so that whatever else the machine does meets all of it.
fn measure(gpu: &Gpu, path: &Path, arguments: &Arguments, global: &Global) -> Result<Vec<Row>> {
    let model = Model::new(model::load(Some(path), &arguments.shape)?);
    let methods = methods(arguments, &model)?;
    let bench = drawing::blind(gpu)?;
    let mut subjects = Vec::new();
    for &method in &methods {
        let groups = arguments
            .tables
            .by_isolation(method, &arguments.levels, &methods)?;
        for (options, levels) in groups {
            let chosen = Chosen {
                method,
                options,
                by_default: false,
                replaceable: false,
            };
            add(
                (gpu, &bench),
                (path, &model),
                (chosen, &levels),
                (arguments, global),
                &mut subjects,
            )?;
        }
    }
    progress::during("drawing frames", |bar| {
        bar.set_length(u64::from(arguments.frames) + 1);
        for _ in 0..=arguments.frames {
            for subject in &mut subjects {
                subject.draw()?;
            }
            bar.inc(1);
        }
        Ok::<_, Error>(())
    })?;
    Ok(subjects.iter().flat_map(Subject::rows).collect())
}

/// Adds a method at some levels, by all back-ends and residences.
fn add<'a>(
    (gpu, bench): (&'a Gpu, &'a Bench),
    (path, model): (&Path, &Model),
    (chosen, levels): (Chosen, &[f32]),
    (arguments, global): (&Arguments, &Global),
    subjects: &mut Vec<Subject<'a>>,
) -> Result<()> {
    let greatest = levels.iter().copied().fold(1.0, f32::max);
    let first = arguments.residence.first().copied();
    let ways = arguments.backend.iter().flat_map(|&backend| {
        let residences = arguments.residence.iter();
        residences.map(move |&residence| (Backend::from(backend), residence))
    });
    for (backend, own) in ways {
        let residence = Residence::from(own);
        let prepared = drawing::prepare(model, chosen).and_then(|prepared| {
            backend.check(&prepared, residence, greatest)?;
            Ok(prepared)
        });
        let has_cache = |prepared: &Prepared| {
            let mut passes = prepared.passes.iter();
            passes.any(|pass| pass.cached.is_some())
        };
        if Some(own) != first && prepared.as_ref().is_ok_and(|p| !has_cache(p)) {
            continue;
        }
        match prepared {
            Ok(prepared) => {
                let drawn = (chosen.method.name, backend, residence);
                subjects.push(Subject::new(
                    gpu, bench, path, model, prepared, drawn, levels, arguments, global,
                )?);
            }
            // What was not asked for by name may be refused, or left to another backend.
            Err(error) if arguments.methods.is_empty() || arguments.backend.len() > 1 => {
                let name = chosen.method.name;
                tracing::warn!("{}: {name} is left out: {error}", path.display());
            }
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// The methods of `--methods`, or all that can draw the model, and what ratios are to.
fn methods(arguments: &Arguments, model: &Model) -> Result<Vec<&'static Method>> {
    let mut methods: Vec<&'static Method> = Vec::new();
    let asked = arguments.methods.iter().map(|name| method(name));
    let able = METHODS
        .iter()
        .filter(|method| method.check_model(model).is_ok());
    let all = if arguments.methods.is_empty() {
        able.map(Ok).collect::<Vec<_>>()
    } else {
        asked.chain([Ok(yardstick())]).collect()
    };
    for method in all {
        let method = method?;
        method.check(model.mesh().options().scheme)?;
        if !methods.iter().any(|other| other.name == method.name) {
            methods.push(method);
        }
    }
    Ok(methods)
}
