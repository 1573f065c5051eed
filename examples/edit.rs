//! Creases that are edited: what each edit costs, and that the surface is the one that a fresh preparation gives.
//!
//! ```sh
//! cargo run --release --example edit --no-default-features -- builtin:hull 100
//! ```
//!
//! No Vulkan is needed: an engine hands each `Update` to `gpu::Tables::edit` and records `cmd_upload`; see the manual, *Edits*.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use hullform::glam::Vec2;
use hullform::mesh::{ControlMesh, Model, builtin, read_obj};
use hullform::method::{METHODS, Prepared};
use hullform::plan::{Database, PlanOptions};

const USAGE: &str = "\
usage: edit MODEL EDITS

  MODEL  OBJ file, or builtin:NAME (builtin:hull, builtin:cube, ...)
  EDITS  how many creases are set, from 1";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("edit: {problem}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<(), String> {
    let [model, edits] = arguments else {
        return Err(format!("two arguments are needed\n\n{USAGE}"));
    };
    let edits: u32 = match edits.parse() {
        Ok(edits) if edits > 0 => edits,
        _ => return Err(format!("EDITS {edits} is no number from 1\n\n{USAGE}")),
    };
    let mesh = load(model).map_err(|error| error.to_string())?;
    edit(Model::new(mesh), edits).map_err(|error| error.to_string())
}

fn load(model: &str) -> hullform::Result<ControlMesh> {
    match model.strip_prefix("builtin:") {
        Some(name) => builtin(name),
        None => read_obj(Path::new(model)),
    }
}

fn edit(mut model: Model, edits: u32) -> hullform::Result<()> {
    let mut able = METHODS.iter().filter(|method| method.edits_in_place());
    let method = able.next().expect("one edits in place");
    // The database outlives edits: what was planned once is found again, and so it may be shared by many models.
    let database = Database::default();
    let started = Instant::now();
    let mut editable = method.prepare_editable(&model, PlanOptions::default(), &database)?;
    println!(
        "{} faces prepared in {:?}",
        model.mesh().face_count(),
        started.elapsed()
    );
    let (mut times, mut faces, mut words) = (Vec::<Duration>::new(), 0, 0);
    for number in 0..edits {
        // Edges far from one another, of any sharpness.
        let edges = model.topology().edges();
        let place = number as usize * 7919 % edges.len();
        let [a, b] = edges[place].vertices;
        let started = Instant::now();
        let mut edit = model.mesh().edit();
        edit.crease(a, b, 0.5 + (number % 19) as f32 / 4.0);
        let changes = model.apply(&edit)?;
        let update = editable.update(&model, &changes, &database)?;
        times.push(started.elapsed());
        faces += changes.faces().len();
        words += update.words();
        if update.is_whole {
            println!("edit {number}: everything was prepared anew");
        }
    }
    times.sort_unstable();
    println!(
        "{edits} edits: {:?} in the middle, {:?} at most; {:.1} faces and {:.1} KB each",
        times[times.len() / 2],
        times[times.len() - 1],
        f64::from(faces as u32) / f64::from(edits),
        4.0 * words as f64 / 1000.0 / f64::from(edits),
    );
    let fresh = method.prepare_with(&model, PlanOptions::default(), &database)?;
    let differing = differing(editable.prepared(), &fresh, &model);
    println!(
        "{differing} of {} ptex faces differ from a fresh preparation",
        model.mesh().ptex_count()
    );
    Ok(())
}

/// How many ptex faces are not drawn alike, to the bit, at some places.
fn differing(edited: &Prepared, fresh: &Prepared, model: &Model) -> usize {
    let controls = fresh.controls(model.positions());
    let places = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [1.0, 0.3], [0.1, 0.9]];
    let drawn = |prepared: &Prepared| -> Vec<Option<[[u32; 3]; 5]>> {
        let mut drawn = vec![None; model.mesh().ptex_count()];
        for pass in &prepared.passes {
            for patch in (0..pass.patches.len()).filter(|&patch| !pass.is_vacant(patch)) {
                let points = places.map(|uv| {
                    let point = pass.evaluate(&controls, patch, Vec2::from(uv));
                    point.position.to_array().map(f32::to_bits)
                });
                drawn[pass.patches[patch].ptex as usize] = Some(points);
            }
        }
        drawn
    };
    let [edited, fresh] = [edited, fresh].map(drawn);
    edited
        .iter()
        .zip(&fresh)
        .filter(|(one, other)| one != other)
        .count()
}
