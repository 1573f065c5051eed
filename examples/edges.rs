//! Whether all faces have the same bits on every edge that they share: `cargo run --release --example edges -- [OPTION VALUE]... [MODEL]...`
//!
//! MODEL is an OBJ file, or a built-in model such as `hull`. Each is drawn at twelve tess levels from 1 to 64, with both spacings, and every
//! vertex of every edge and corner is compared. Options: `--random N`, so many random meshes as well, half of them manifold; `--seed S`,
//! where these begin (0); `--levels N`, only so many of the levels (12).
//!
//! `hullform verify --filter 'edges.*'` is the short form of this. A model of 10,000 faces takes minutes on a software device.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use hullform::conformance::edges::{Compared, LEVELS, Setup, compare, random_mesh};
use hullform::conformance::{Context, Settings};
use hullform::mesh::{ControlMesh, Model, builtin, read_obj};

/// What is asked for.
struct Arguments {
    random: u32,
    seed: u64,
    levels: usize,
    models: Vec<String>,
}

fn main() -> ExitCode {
    let Err(error) = run() else {
        return ExitCode::SUCCESS;
    };
    eprintln!("edges: {error}");
    ExitCode::FAILURE
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = arguments()?;
    let settings = Settings {
        seed: arguments.seed,
        ..Settings::default()
    };
    let context = Context::new(settings, Vec::new());
    let setup = Setup::new(&LEVELS[..arguments.levels]);
    let mut all = Compared::default();
    for name in &arguments.models {
        let compared = compare(&context, &Model::new(load(name)?), &setup)?;
        println!("{name}: {compared}");
        all.add(compared);
    }
    let mut random = Compared::default();
    for number in 0..arguments.random {
        let model = Model::new(random_mesh(&context, number)?);
        let compared = compare(&context, &model, &setup)?;
        if let Some(first) = &compared.first {
            println!("random mesh {number}: {first}");
        }
        random.add(compared);
        if (number + 1) % 100 == 0 || number + 1 == arguments.random {
            println!("{} random meshes: {random}", number + 1);
        }
    }
    all.add(random);
    println!("together: {all}");
    match all.first {
        None if all.positions > 0 => Ok(()),
        None => Err("nothing was compared".into()),
        Some(first) => Err(first.into()),
    }
}

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    let mut read = Arguments {
        random: 0,
        seed: 0,
        levels: LEVELS.len(),
        models: Vec::new(),
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--random" => read.random = value()?.parse()?,
            "--seed" => read.seed = value()?.parse()?,
            "--levels" => read.levels = value()?.parse::<usize>()?.clamp(1, LEVELS.len()),
            _ => read.models.push(word),
        }
    }
    Ok(read)
}

fn load(model: &str) -> Result<ControlMesh, hullform::Error> {
    if model.ends_with(".obj") {
        read_obj(Path::new(model))
    } else {
        builtin(model)
    }
}
