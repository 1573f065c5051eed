//! How fast models are prepared for the quadtree method: `cargo run --release --example plan_speed [-- MODEL ...]`.
//!
//! MODEL is an OBJ file, or a built-in model such as `hull` or `cubes-12x12x10`; without any, those two are measured. Each is prepared
//! several times, and the fastest counts: what disturbs a run only ever makes it slower. `topology` is the time for neighbourhoods and
//! sharpness, `plans` that for configurations, plans and packing. All cores take part; RAYON_NUM_THREADS=1 in the environment keeps it
//! to one, which is what figures per thread are about.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use hullform::mesh::{ControlMesh, Model, builtin, read_obj};
use hullform::method::method;
use hullform::plan::PlanOptions;

/// How often each model is prepared.
const RUNS: u32 = 7;

/// The fastest of several runs.
struct Fastest {
    /// Seconds for the topology.
    topology: f64,
    /// Seconds for configurations, plans and packing.
    plans: f64,
    /// How many plans there are.
    count: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut models: Vec<String> = std::env::args().skip(1).collect();
    if models.is_empty() {
        models = ["hull", "cubes-12x12x10"].map(String::from).into();
    }
    for model in &models {
        let mesh = load(model)?;
        let faces = mesh.face_count();
        let Fastest {
            topology,
            plans,
            count,
        } = measure(&mesh)?;
        println!(
            "{model}: {faces} faces, {count} plans; topology {:.2} ms, plans {:.2} ms; {:.0} faces/s, {:.0} plans/s",
            1e3 * topology,
            1e3 * plans,
            faces as f64 / (topology + plans),
            count as f64 / plans,
        );
    }
    Ok(())
}

fn load(model: &str) -> Result<ControlMesh, hullform::Error> {
    if model.ends_with(".obj") {
        read_obj(Path::new(model))
    } else {
        builtin(model)
    }
}

fn measure(mesh: &ControlMesh) -> Result<Fastest, Box<dyn Error>> {
    let quadtree = method("quadtree")?;
    let mut fastest = Fastest {
        topology: f64::INFINITY,
        plans: f64::INFINITY,
        count: 0,
    };
    for _ in 0..RUNS {
        let mesh = mesh.clone();
        let started = Instant::now();
        let model = Model::new(mesh);
        fastest.topology = fastest.topology.min(started.elapsed().as_secs_f64());
        let started = Instant::now();
        let prepared = quadtree.prepare(&model, PlanOptions::default())?;
        fastest.plans = fastest.plans.min(started.elapsed().as_secs_f64());
        fastest.count = prepared.plans.map_or(0, |statistics| statistics.plans);
    }
    Ok(fastest)
}
