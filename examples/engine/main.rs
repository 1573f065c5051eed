//! A small engine of its own: three models, ten moving instances of each, a sun with shadows, two frames in flight. It draws to `engine.png`.
//!
//! ```sh
//! cargo run --release --example engine -- [--frames N] [-o FILE.png] [MODEL.obj MODEL.obj MODEL.obj]
//! VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation cargo run --release --example engine
//! ```
//!
//! Where `headless_png` shows the order of calls, this shows what an engine gains from the lifetimes: `model.rs` keeps `Tables` and a `Pose` a model, and a
//! `FrameSlot` for each frame in flight; instances are views. Control points are computed once a pose, by compute, and drawn in three passes: a
//! shadow map, a pre-pass, and the picture over its depths, compared with EQUAL. The second model is skinned by a compute shader (`skin.rs`); the fragment shader
//! is the engine's own, with a set of its own (`material.rs`). Everything renders dynamically (`images.rs`). `gpu.rs` is what every engine has anyway.

mod commands;
mod gpu;
mod image;
mod images;
mod material;
mod model;
mod scene;
mod skin;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use ash::vk;
use commands::{Commands, Idle};
use gpu::Gpu;
use hullform::gpu::Layout;
use hullform::mesh::{ControlMesh, Model as Mesh, builtin, read_obj};
use images::Images;
use material::Materials;
use model::{FRAMES, Model, Pass};
use scene::{Sight, ground, place};

fn main() -> ExitCode {
    let Err(error) = run() else {
        return ExitCode::SUCCESS;
    };
    eprintln!("engine: {error}");
    ExitCode::FAILURE
}

/// What is asked for on the command line.
struct Wishes {
    frames: usize,
    picture: String,
    models: Vec<String>,
}

fn wishes() -> Result<Wishes, Box<dyn Error>> {
    let mut wishes = Wishes {
        frames: 6,
        picture: "engine.png".into(),
        models: Vec::new(),
    };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--frames" => wishes.frames = arguments.next().ok_or("how many frames?")?.parse()?,
            "-o" => wishes.picture = arguments.next().ok_or("which file?")?,
            _ => wishes.models.push(argument),
        }
    }
    let own = ["builtin:hull", PAWN, "builtin:creased-torus"].iter();
    let missing = own.skip(wishes.models.len()).map(|&name| name.to_owned());
    let missing: Vec<String> = missing.collect();
    wishes.models.extend(missing);
    Ok(wishes)
}

fn load(name: &str) -> hullform::Result<Mesh> {
    let mesh = match name.strip_prefix("builtin:") {
        _ if name == PAWN => pawn()?,
        Some(name) => builtin(name)?,
        None => read_obj(Path::new(name))?,
    };
    Ok(Mesh::new(mesh))
}

/// The name of the mesh that is made here.
const PAWN: &str = "pawn";

/// A pawn: rings of eight vertices around an axis, closed by an octagon at either end, with a sharp foot and collar.
fn pawn() -> hullform::Result<ControlMesh> {
    const AROUND: u32 = 8;
    let profile = [
        (0.62, 0.0),
        (0.62, 0.22),
        (0.36, 0.5),
        (0.24, 1.0),
        (0.22, 1.35),
        (0.40, 1.5),
        (0.22, 1.62),
        (0.48, 1.95),
        (0.30, 2.4),
    ];
    let mut positions = Vec::new();
    for (radius, height) in profile {
        for number in 0..AROUND {
            let angle = std::f64::consts::TAU * f64::from(number) / f64::from(AROUND);
            positions.push([radius * angle.cos(), height, -radius * angle.sin()]);
        }
    }
    let last = profile.len() as u32 - 1;
    let at = |ring: u32, number: u32| AROUND * ring + number % AROUND;
    let mut corners: Vec<u32> = (0..AROUND).rev().map(|number| at(0, number)).collect();
    for ring in 0..last {
        for number in 0..AROUND {
            let next = number + 1;
            corners.extend([
                at(ring, number),
                at(ring, next),
                at(ring + 1, next),
                at(ring + 1, number),
            ]);
        }
    }
    corners.extend((0..AROUND).map(|number| at(last, number)));
    let quads = vec![4; (AROUND * last) as usize];
    let sizes = [&[AROUND], &quads[..], &[AROUND]].concat();
    let mut mesh = ControlMesh::builder(&positions, &sizes, &corners);
    for number in 0..AROUND {
        for (ring, sharpness) in [(0, 3.0), (1, 1.5), (5, 2.5)] {
            mesh = mesh.crease(at(ring, number), at(ring, number + 1), sharpness);
        }
    }
    mesh.build()
}

/// A square around the origin.
fn square() -> hullform::Result<Mesh> {
    let corners = [
        [-1.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 0.0, -1.0],
        [-1.0, 0.0, -1.0],
    ];
    let mesh = ControlMesh::builder(&corners, &[4], &[0, 1, 2, 3]).build()?;
    Ok(Mesh::new(mesh))
}

fn run() -> Result<(), Box<dyn Error>> {
    let wishes = wishes()?;
    let gpu = Gpu::new()?;
    // SAFETY: the device has what `enabled` is the proof of.
    let layout = unsafe { Layout::new(&gpu.device, gpu.enabled)? };
    let layout = gpu.hold(layout, |gpu, layout| {
        // SAFETY: see `Gpu::buffer`.
        unsafe { layout.destroy(&gpu.device) };
    });
    let images = Images::new(&gpu)?;
    let count = wishes.models.len() + 1;
    let materials = Materials::new(&gpu, &layout, (count * FRAMES) as u32)?;
    let mut models = Vec::new();
    for (number, name) in wishes.models.iter().enumerate() {
        let mesh = load(name)?;
        let model = Model::new(&gpu, &layout, &materials, &images, &mesh, "quadtree")?;
        models.push(match number {
            1 => model.skinned(&mesh)?,
            _ => model,
        });
    }
    models.push(Model::new(
        &gpu,
        &layout,
        &materials,
        &images,
        &square()?,
        "flat",
    )?);
    let frames = (0..FRAMES).map(|_| Commands::new(&gpu));
    let frames = frames.collect::<Result<Vec<_>, _>>()?;
    let idle = Idle(&gpu);
    for number in 0..wishes.frames.max(1) {
        let commands = &frames[number % FRAMES];
        commands.begin()?;
        // SAFETY: recording, outside of rendering; `begin` has waited for the frame that used this slot last.
        let work = unsafe { record(commands.cmd, number, &images, &mut models)? };
        if number + 1 >= wishes.frames {
            // SAFETY: outside of rendering again.
            unsafe { images.cmd_copy(commands.cmd) };
        }
        commands.submit()?;
        println!(
            "frame {number}: {} control points computed, {} draws a model at most",
            work.points, work.draws
        );
    }
    for commands in &frames {
        commands.wait()?;
    }
    // What was drawn last has been waited for.
    std::mem::forget(idle);
    images.write_png(&wishes.picture)?;
    for model in &mut models {
        // SAFETY: the device is idle.
        unsafe { model.finish_upload() };
    }
    report(&gpu, &models, &wishes);
    Ok(())
}

/// What a frame has to do.
struct Work {
    points: u32,
    /// Of the model that has most, in all three passes.
    draws: usize,
}

/// Records a frame.
///
/// # Safety
/// `cmd` is recording on the device, outside of rendering, and the frame that used this slot last is over.
unsafe fn record(
    cmd: vk::CommandBuffer,
    number: usize,
    images: &Images<'_>,
    models: &mut [Model<'_>],
) -> Result<Work, Box<dyn Error>> {
    // The first two frames show the same moment: what does not move is not computed again.
    let time = 0.15 * number.max(1) as f32;
    let slot = number % FRAMES;
    let sight = Sight::new(time);
    let angle = (number != 1).then(|| 0.45 * (0.9 + 1.3 * time).sin());
    let last = models.len() - 1;
    let mut points = 0;
    for (place_of, model) in models.iter_mut().enumerate() {
        let placed = match place_of == last {
            true => ground(&sight, &model.shape),
            false => place(&sight, place_of, &model.shape, time),
        };
        // SAFETY: this function's contract.
        points += unsafe { model.cmd_prepare(cmd, slot, &sight.light(), &placed, angle)? };
    }
    let mut draws = vec![0; models.len()];
    let mut draw = |pass| -> hullform::Result<()> {
        for (model, draws) in models.iter().zip(&mut draws) {
            // SAFETY: inside the pass's rendering.
            *draws += unsafe { model.cmd_draw(cmd, slot, pass)? };
        }
        Ok(())
    };
    // SAFETY: this function's contract; each ends what the one before began.
    unsafe {
        images.begin_shadows(cmd);
        draw(Pass::Shadows)?;
        images.begin_depths(cmd);
        draw(Pass::Depths)?;
        images.begin_picture(cmd, [0.48, 0.60, 0.74, 1.0]);
        draw(Pass::Picture)?;
        images.end(cmd);
    }
    let draws = draws.into_iter().max().unwrap_or(0);
    Ok(Work { points, draws })
}

/// Device memory by sum.
fn report(gpu: &Gpu, models: &[Model<'_>], wishes: &Wishes) {
    let mega = |bytes: u64| bytes as f64 / 1e6;
    for (model, name) in models.iter().zip(&wishes.models) {
        let [tables, pose, slots, skin] = model.bytes().map(mega);
        println!(
            "{name}: {tables:.1} MB of tables, {pose:.1} a pose with its cache, {slots:.1} in {FRAMES} slots, {skin:.1} of skin"
        );
    }
    let ours = models.iter().flat_map(Model::bytes).sum();
    let all = gpu.allocator().generate_report().total_allocated_bytes;
    println!(
        "{}: {:.1} MB of device memory by sum, {:.1} with images, on {}",
        wishes.picture,
        mega(ours),
        mega(all),
        gpu.name
    );
}
