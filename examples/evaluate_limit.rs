//! The limit surface at one point, on the CPU: position, tangents and normal.
//!
//! ```sh
//! cargo run --example evaluate_limit --no-default-features -- builtin:cube 0 0.5 0.5
//! cargo run --example evaluate_limit --no-default-features -- model.obj 17 0 1
//! ```
//!
//! No Vulkan is needed: what the shaders are measured against is plain f64 code. This is the code to copy for everything that asks about
//! single points of a surface: picking, placing objects, collision, or checking an evaluator of one's own.

use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;

use hullform::mesh::{ControlMesh, builtin, read_obj};
use hullform::subdivision::LimitSurface;

const USAGE: &str = "\
usage: evaluate_limit MODEL FACE U V

  MODEL  OBJ file, or builtin:NAME (builtin:hull, builtin:cube, ...)
  FACE   ptex face, from 0: in file order a quad takes one number, an n-gon n of them, one a corner
  U V    where in the face, each from 0 to 1";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        // Everything that can go wrong here is the input's fault: 2, as the `hullform` program has it.
        Err(problem) => {
            eprintln!("evaluate_limit: {problem}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<String, String> {
    let [model, face, u, v] = arguments else {
        return Err(format!(
            "four arguments are needed, not {}\n\n{USAGE}",
            arguments.len()
        ));
    };
    let face: usize = number("FACE", face, "a whole number")?;
    let (u, v) = (coordinate("U", u)?, coordinate("V", v)?);
    // Errors of the library say what is wrong in the user's own terms, with the line of the file: they are printed as they are.
    let mesh = load(model).map_err(|error| error.to_string())?;

    // The surface keeps the topology and copies the positions: build it once and ask it as often as you like, from any thread.
    let surface = LimitSurface::new(&mesh);
    if face >= surface.ptex_count() {
        return Err(format!(
            "FACE {face} is out of range: the model has the ptex faces 0 to {}",
            surface.ptex_count() - 1
        ));
    }
    // A hole has no limit surface, and neither has a face at a boundary that is not interpolated.
    let sample = surface
        .evaluate(face, u, v)
        .ok_or_else(|| format!("FACE {face} is a hole: there is no surface"))?;

    // `du` and `dv` are derivatives by u and v, except at an extraordinary vertex: there only the plane that they span has a meaning.
    // The normal is right everywhere, and zero where the surface has none.
    let lines = [
        ("position", sample.position),
        ("du", sample.du),
        ("dv", sample.dv),
        ("normal", sample.normal()),
    ];
    let lines = lines.map(|(name, value)| {
        // The shortest digits that read back as the same f64.
        format!("{name:8}  {} {} {}", value.x, value.y, value.z)
    });
    Ok(lines.join("\n"))
}

fn load(model: &str) -> hullform::Result<ControlMesh> {
    match model.strip_prefix("builtin:") {
        Some(name) => builtin(name),
        None => read_obj(Path::new(model)),
    }
}

fn number<T: FromStr + Display>(name: &str, text: &str, expected: &str) -> Result<T, String> {
    text.parse()
        .map_err(|_| format!("{name} is '{text}', expected {expected}\n\n{USAGE}"))
}

fn coordinate(name: &str, text: &str) -> Result<f64, String> {
    const EXPECTED: &str = "a number from 0 to 1";
    let value = number(name, text, EXPECTED)?;
    // Written so that NaN is refused as well. `evaluate` itself would clamp.
    if (0.0..=1.0).contains(&value) {
        Ok(value)
    } else {
        Err(format!("{name} is {text}, expected {EXPECTED}"))
    }
}
