//! How an engine brings hullform into its renderer: a picture, drawn with a device of the example's own, to `headless.png`.
//!
//! ```sh
//! cargo run --release --example headless_png -- [MODEL.obj]
//! VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation cargo run --release --example headless_png
//! ```
//!
//! Read it from top to bottom. What an engine has anyway is elsewhere: instance, device, queue, allocator and commands are those of the example `engine`,
//! the picture is in `picture.rs`. The library never submits and never waits; everything is `cmd_*` calls into a command buffer that is recording
//! anyway. One place asks something of the engine: the features that the device is created with (`open` in `engine/gpu.rs`: `Support` tells
//! whether a physical device will do and why not, `FeatureChain` switches on what is needed).
//!
//! Everything that is made is held by a `Held`, which destroys it at the end of its scope: in the opposite order, and after an error as well.

#[path = "../engine/commands.rs"]
mod commands;
#[path = "../engine/gpu.rs"]
#[allow(dead_code)] // The engine has shaders of its own.
mod gpu;
#[path = "../engine/image.rs"]
mod image;
mod picture;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use ash::vk;
use commands::{Commands, Idle};
use glam::camera::rh::proj::vulkan::perspective;
use glam::{Mat4, Vec3};
use gpu::Gpu;
use hullform::gpu::{
    CachePipelines, Cut, Fill, Layout, PipelineOptions, Pipelines, Residence, Shading,
    SurfaceOptions, Target, TessellatedSurface, View,
};
use hullform::mesh::{DEFAULT_BUILTIN, Model, builtin, read_obj};
use hullform::method::{Displacement, MethodOptions, method};
use hullform::tessellation::Spacing;
use picture::{ATTACHMENTS, HEIGHT, Picture, WIDTH};

fn main() -> ExitCode {
    let Err(error) = run() else {
        return ExitCode::SUCCESS;
    };
    eprintln!("headless_png: {error}");
    ExitCode::FAILURE
}

fn run() -> Result<(), Box<dyn Error>> {
    // 1. The CPU's part: a control mesh, and what the quadtree method makes of it. Nothing of this needs a device, so it may run on a loader
    //    thread, or once in a tool. `Prepared` holds plain tables; the plans in it depend on the connectivity and the sharpness alone.
    let mesh = match std::env::args().nth(1) {
        Some(path) => read_obj(Path::new(&path))?,
        None => builtin(DEFAULT_BUILTIN)?,
    };
    let model = Model::new(mesh);
    let prepared = method("quadtree")?.prepare(&model, MethodOptions::default())?;

    // 2. The device, something to draw into, and a command buffer. One `Layout` serves all surfaces of a device.
    let gpu = Gpu::new()?;
    let picture = Picture::new(&gpu)?;
    let (device, cache) = (&gpu.device, vk::PipelineCache::null());
    // SAFETY: the device has what `enabled` is the proof of.
    let layout = unsafe { Layout::new(device, gpu.enabled)? };
    let layout = gpu.hold(layout, |gpu, layout| {
        // SAFETY: nothing is in use when what is held goes, here and in all such functions below: see `Idle`.
        unsafe { layout.destroy(&gpu.device) };
    });

    // 3. The model on the device: buffers and descriptor sets, no commands yet. Control points live in a cache, which compute shaders fill once. (In a
    //    `Residence::Ring` control shaders would compute them as they go, in bounded memory; batches then wait for one another, which asks for a
    //    dependency in the render pass: see `SurfaceOptions::barriers`.) Vertices are counted, so that step 6 can tell whether all have come.
    //    That is for a picture that must be right; a game would not.
    let options = SurfaceOptions {
        residence: Residence::Cache,
        count_vertices: true,
        ..SurfaceOptions::default()
    };
    // SAFETY: allocator and layout are this device's. Workarounds for driver faults are a list: look at it, log it, or hand over an empty one.
    let surface = unsafe {
        let (allocator, known) = (&mut gpu.allocator(), &gpu.workarounds);
        TessellatedSurface::new(device, allocator, &layout, &model, prepared, known, options)?
    };
    let mut surface = gpu.hold(surface, |gpu, surface| {
        // SAFETY: as above.
        unsafe { surface.destroy(&gpu.device, &mut gpu.allocator()) };
    });

    // 4. Pipelines: one a pass of the prepared model, from the modules that the crate brings, for any target: here dynamic rendering. An engine's own
    //    fragment shader goes into `fragment`; hand over a pipeline cache where you have one.
    let cut = Cut {
        level: 8.0,
        spacing: Spacing::FractionalEven,
    };
    let drawn = PipelineOptions {
        target: Target::new(ATTACHMENTS),
        backend: options.backend,
        residence: options.residence,
        spacing: cut.spacing,
        fill: Fill::Solid(Shading::Lit),
        fragment: None,
        sub_patches: false,
        layout: None,
    };
    // SAFETY: all of one live device.
    let pipelines = unsafe { Pipelines::new(device, &layout, cache, surface.prepared(), &drawn)? };
    let pipelines = gpu.hold(pipelines, |gpu, pipelines| {
        // SAFETY: as above.
        unsafe { pipelines.destroy(&gpu.device) };
    });
    // SAFETY: as above.
    let caching = unsafe { CachePipelines::new(device, &layout, cache, surface.prepared())? };
    let caching = gpu.hold(caching, |gpu, caching| {
        // SAFETY: as above.
        unsafe { caching.destroy(&gpu.device) };
    });

    // 5. What is drawn at this cut, a plain value: keep it while the level stays. Then the order is: upload (once), cache (where something moved) and
    //    prepare (a frame), outside of rendering; draws, inside; read-back (optional). Copies and points are made visible by the functions
    //    themselves. Your other objects can be drawn in between: bind their pipelines and sets again, `cmd_draw` has bound its own.
    let list = surface.draw_list(cut, None)?;
    let commands = Commands::new(&gpu)?;
    let cmd = commands.cmd;
    let idle = Idle(&gpu);
    commands.begin()?;
    // SAFETY: recording on the device that made everything, inside and outside of rendering as each asks; all of it lives until the device is idle.
    let points = unsafe {
        surface.cmd_upload(device, cmd);
        let points = surface.cmd_cache(device, cmd, &layout, &caching, &list)?;
        surface.cmd_prepare(device, cmd, &[view(&model)])?;
        picture.begin(cmd);
        for batch in list.batches() {
            surface.cmd_draw(device, cmd, &layout, &pipelines, 0..1, batch)?;
        }
        picture.end(cmd);
        surface.cmd_read_back(device, cmd);
        points
    };

    // 6. Submitting and waiting are the engine's business. The memory that tables were staged in can go once they have been copied. A driver that loses
    //    draws says nothing: whether all vertices came that were predicted is known because they were counted.
    commands.submit()?;
    commands.wait()?;
    // Nothing else was submitted.
    std::mem::forget(idle);
    // SAFETY: the device is idle.
    unsafe { surface.finish_upload(device, &mut gpu.allocator()) };
    surface.arrival(list.batches())?.check()?;
    picture.write("headless.png")?;
    println!(
        "headless.png: {} batches, {points} points in the cache, on {}",
        list.batches().len(),
        gpu.name
    );
    Ok(())
}

/// From the front, a little from the right and from above. Positions on the GPU are in local units, so that f32 is enough whatever the mesh's
/// size and far from the origin too: an engine puts `model.placement().matrix()` into its object matrix, in f64.
fn view(model: &Model) -> View {
    let radius = 0.5 * model.diagonal() as f32;
    let distance = 2.0 * radius;
    let eye_from_model = Mat4::from_translation(Vec3::new(0.0, 0.0, -distance))
        * Mat4::from_rotation_x(0.35)
        * Mat4::from_rotation_y(-0.6);
    let (aspect, near) = (WIDTH as f32 / HEIGHT as f32, distance - radius);
    let clip_from_eye = perspective(0.7, aspect, near, distance + radius);
    let eye = eye_from_model.inverse().transform_point3(Vec3::ZERO);
    View {
        clip_from_model: (clip_from_eye * eye_from_model).to_cols_array_2d(),
        eye: eye.to_array(),
        displacement: Displacement::default(),
    }
}
