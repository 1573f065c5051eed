//! `hullform plan`: how the faces of a model are planned.

mod drawing;
mod face;

use crate::db::database;
use crate::options::{self, Global};
use crate::output::{self, Contents, Format};
use crate::{model, print, print_json, progress};
use clap::Args;
use face::FacePlan;
use hullform::abi::Patch;
use hullform::mesh::{ControlMesh, Model, replicated};
use hullform::method::{MacroFaces, Prepared, method};
use hullform::plan::{PlanOptions, Ring};
use hullform::{Error, Result};
use serde_json::{Map, Value, json};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Options of `plan`.
#[derive(Args)]
pub struct Arguments {
    /// OBJ file, or builtin:NAME
    pub model: PathBuf,
    #[command(flatten)]
    shape: options::Shape,
    /// Deepest level of a plan's quadtree, 1 to 10
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u8).range(1..=10))]
    max_level: u8,
    /// Refine along creases instead of evaluating them directly
    #[arg(long)]
    no_direct_creases: bool,
    #[command(flatten)]
    macro_faces: options::Macro,
    /// Plan so many copies of the model on a grid: how cost grows with size
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    replicate: u32,
    /// Threads to plan with [default: one a core]
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Draw the quadtree of this face, by its number from 0
    #[arg(long, value_name = "F", requires = "output")]
    face: Option<u32>,
    /// Where to draw it: a picture, or its nodes and where they are
    #[arg(short, long, value_name = "FILE.svg|json", requires = "face")]
    output: Option<PathBuf>,
}

impl Arguments {
    fn options(&self) -> PlanOptions {
        PlanOptions {
            max_level: self.max_level.into(),
            direct_creases: !self.no_direct_creases,
        }
    }
}

/// Plans the model's faces and prints what came out; or draws the plan of one of them.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    if let (Some(face), Some(path)) = (arguments.face, &arguments.output) {
        return draw(arguments, face, path);
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| Error::Refused(format!("{error}; choose fewer --threads")))?;
    let facts = pool.install(|| {
        let started = Instant::now();
        let mesh = model::load(Some(&arguments.model), &arguments.shape)?;
        let read = started.elapsed().as_secs_f64();
        let mesh = match arguments.replicate {
            1 => mesh,
            copies => replicated(&mesh, copies)?,
        };
        let named = |result| model::named(Some(&arguments.model), result);
        progress::during("planning", |_| named(facts(mesh, arguments, read)))
    })?;
    if global.prints_json() {
        print_json(&Value::Object(facts))
    } else {
        print(&as_text(&facts))
    }
}

/// Draws the quadtree of a face.
fn draw(arguments: &Arguments, face: u32, path: &Path) -> Result<()> {
    let format = Format::of(path, &[Format::Svg, Format::Json])?;
    let reads = model::file(Some(&arguments.model));
    let files = output::create(reads.as_slice(), &[("--output", path)])?;
    let model = Model::new(model::load(Some(&arguments.model), &arguments.shape)?);
    let name = model::name(Some(&arguments.model));
    let plans = method("quadtree")?
        .check_model(&model)
        .and_then(|()| face::plans(&model, face, arguments.options()));
    let plans = model::named(Some(&arguments.model), plans)?;
    let text = match format {
        Format::Svg => drawing::svg(&format!("Face {face} of {name}"), &plans),
        _ => {
            let parts: Vec<Value> = plans.iter().map(FacePlan::json).collect();
            format!("{:#}\n", json!({"face": face, "plans": parts}))
        }
    };
    let contents: &Contents = &|out| out.write_all(text.as_bytes());
    output::write(files.into_iter().map(|file| (file, contents)))?;
    print(&output::wrote(path))
}

/// The most memory that the program had so far; None where the system does not tell.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kibibytes * 1024)
}

/// A line a fact, the values in a column; what belongs together stands below its heading.
fn as_text(facts: &Map<String, Value>) -> String {
    let line = |(name, value): (&String, &Value)| match value {
        Value::Object(parts) => {
            let parts: Vec<String> = parts
                .iter()
                .map(|(part, value)| format!("  {:20}  {value}", part.replace('_', " ")))
                .collect();
            format!("{}\n{}", name.replace('_', " "), parts.join("\n"))
        }
        value => format!("{:22}  {value}", name.replace('_', " ")),
    };
    facts.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// So many faces at a vertex, or corners of a face, are listed in rings as a whole.
const FEW: usize = 64;

/// How many plans there would be of insides, if a face could not be turned or mirrored to have that of another. Where very many faces meet each way in which a plan
/// is turned counts as one: rings that list all there are of the square of their number.
fn plans_without_sharing(model: &Model, prepared: &Prepared) -> usize {
    let (topology, offsets) = (model.topology(), model.mesh().ptex_offsets());
    let planned = prepared.passes.iter().filter(|pass| pass.cached.is_some());
    // Patches of one plan, turned and mirrored alike, are alike.
    let alike = planned.flat_map(|pass| {
        let mut seen = HashSet::new();
        let is_new = move |patch: &&Patch| seen.insert((patch.plan, patch.flags));
        pass.patches.iter().filter(is_new)
    });
    let mut many = 0;
    let mut configurations = HashSet::new();
    for patch in alike {
        let face = offsets.partition_point(|&first| first <= patch.ptex) - 1;
        let vertices = topology.face(face as u32);
        let mut around = vertices.iter().map(|&vertex| topology.vertex_faces(vertex));
        if vertices.len() > FEW || around.any(|faces| faces.len() > FEW) {
            many += 1;
            continue;
        }
        let ring = Ring::from_corner(topology, face as u32, patch.ptex - offsets[face]);
        configurations.extend(ring.map(|ring| ring.configuration));
    }
    configurations.len() + many
}

/// What there is to tell about macro faces.
fn macro_facts(faces: MacroFaces, model: &Model) -> Value {
    let started = Instant::now();
    let counts = faces.count(model);
    let [longer, shorter] = counts.largest;
    json!({
        "span": faces.span(),
        "macro_faces": counts.macro_faces,
        "faces_in_them": counts.faces,
        "largest": format!("{longer}x{shorter}"),
        "other_irregular": counts.irregular,
        "other_regular": counts.regular,
        "greatest_level": faces.greatest_level(),
        "seconds": started.elapsed().as_secs_f64(),
    })
}

/// What there is to tell about the plans of `mesh`, in the order to tell it.
fn facts(mesh: ControlMesh, arguments: &Arguments, read: f64) -> Result<Map<String, Value>> {
    let options = arguments.options();
    let started = Instant::now();
    let model = Model::new(mesh);
    let connected = started.elapsed().as_secs_f64();
    let prepared = method("quadtree")?.prepare_with(&model, options, database()?)?;
    let seconds = started.elapsed().as_secs_f64();
    let mesh = model.mesh();
    let without_sharing = plans_without_sharing(&model, &prepared);
    let plans = prepared.plans.unwrap_or_default();
    let [internal, regular, boundary, crease, terminal, extraordinary] = plans.nodes;
    let levels = (0..=options.max_level).map(|level| {
        (
            level.to_string(),
            plans.control_points[level as usize].into(),
        )
    });
    let mut facts = json!({
        "vertices": mesh.vertex_count(),
        "faces": mesh.face_count(),
        "patches": plans.regular + plans.irregular,
        "regular": plans.regular,
        "irregular": plans.irregular,
        "plans": plans.plans,
        "plans_without_sharing": without_sharing,
        "edge_plans": plans.edge_plans,
        "vertex_plans": plans.vertex_plans,
        "nodes": {
            "internal": internal,
            "regular": regular,
            "boundary": boundary,
            "crease": crease,
            "terminal": terminal,
            "extraordinary": extraordinary,
        },
        "stencils": plans.stencils,
        "bytes": {
            "vertices": plans.vertex_bytes,
            "indices": plans.index_bytes,
            "quadtree": plans.quadtree_bytes,
            "borders": plans.border_bytes,
            "stencils": plans.stencil_bytes,
            "scratch_worst_case": plans.scratch_worst_case_bytes,
        },
        "control_points": levels.collect::<Map<String, Value>>(),
        "build_seconds": seconds,
        "seconds": {
            "reading": read,
            "topology": connected,
            "preparing": seconds - connected,
        },
        "faces_per_second": mesh.face_count() as f64 / seconds.max(f64::MIN_POSITIVE),
        "threads": rayon::current_num_threads(),
        "peak_bytes": peak_bytes(),
    });
    // As for the lowest level.
    let faces = arguments.macro_faces.faces(1.0).check()?;
    if faces != MacroFaces::None {
        facts["macro_faces"] = macro_facts(faces, &model);
    }
    let Value::Object(facts) = facts else {
        unreachable!("an object was written")
    };
    Ok(facts)
}
