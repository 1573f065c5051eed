//! Faces that are lifted out of a surface, cut out of it and creased, while it is drawn with two frames in flight.
//!
//! ```sh
//! cargo run --release --example edit_topology -- [MODEL.obj]
//! ```
//!
//! It writes the first frame and the last, and tells what each edit took along and whether the surface is, bit for bit, the one that a fresh preparation gives. Device and
//! commands are those of the example `engine`, the picture is that of `headless_png`: read these first.

#[path = "engine/commands.rs"]
mod commands;
#[path = "engine/gpu.rs"]
#[allow(dead_code)] // The engine has shaders of its own.
mod gpu;
#[path = "engine/image.rs"]
mod image;
#[path = "headless_png/picture.rs"]
mod picture;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use ash::vk;
use commands::{Commands, Idle};
use glam::camera::rh::proj::vulkan::perspective;
use glam::{DVec3, Mat4, Vec2, Vec3};
use gpu::{Gpu, Held};
use hullform::gpu::{
    Cut, Drawing, Fill, FrameSlot, Layout, PipelineOptions, Pipelines, Pose, Residence, Retired,
    Shading, SurfaceOptions, Tables, Target, View,
};
use hullform::mesh::{Edit, Model, builtin, read_obj};
use hullform::method::{Displacement, METHODS, Prepared};
use hullform::plan::{Database, PlanOptions};
use hullform::tessellation::Spacing;
use picture::{ATTACHMENTS, HEIGHT, Picture, WIDTH};

/// Frames in flight.
const SLOTS: usize = 2;
/// Frames in all; each but the first comes after an edit.
const FRAMES: usize = 24;

/// What a frame in flight has of its own.
struct Frame<'g> {
    commands: Commands<'g>,
    picture: Picture<'g>,
    slot: Held<'g, FrameSlot>,
    /// What the edit before this frame has replaced: the frames before it may still read that.
    retired: Retired,
}

fn main() -> ExitCode {
    let Err(error) = run() else {
        return ExitCode::SUCCESS;
    };
    eprintln!("edit_topology: {error}");
    ExitCode::FAILURE
}

fn run() -> Result<(), Box<dyn Error>> {
    // 1. A model that will be edited, and what the method that edits in place makes of it. The database keeps plans for edits to come.
    let mesh = match std::env::args().nth(1) {
        Some(path) => read_obj(Path::new(&path))?,
        None => builtin("creased-torus")?,
    };
    let mut model = Model::new(mesh);
    let database = Database::default();
    let mut able = METHODS.iter().filter(|method| method.edits_in_place());
    let method = able.next().ok_or("no method edits in place")?;
    let mut editable = method.prepare_editable(&model, PlanOptions::default(), &database)?;

    // 2. Device, layout, pipelines. These last: an editable preparation has all passes that may be needed.
    let gpu = Gpu::new()?;
    let (device, cache) = (&gpu.device, vk::PipelineCache::null());
    let options = SurfaceOptions {
        residence: Residence::Ring,
        ..SurfaceOptions::default()
    };
    let cut = Cut {
        level: 8.0,
        spacing: Spacing::Equal,
    };
    // SAFETY: the device has what `enabled` is the proof of.
    let layout = unsafe { Layout::new(device, gpu.enabled)? };
    let layout = gpu.hold(layout, |gpu, layout| {
        // SAFETY: nothing is in use when what is held goes, here and in all such functions below: see `Idle`.
        unsafe { layout.destroy(&gpu.device) };
    });
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
    let pipelines = unsafe { Pipelines::new(device, &layout, cache, editable.prepared(), &drawn)? };
    let pipelines = gpu.hold(pipelines, |gpu, pipelines| {
        // SAFETY: as above.
        unsafe { pipelines.destroy(&gpu.device) };
    });

    // 3. Tables and a pose with room for what edits append, and a slot for each frame in flight.
    // SAFETY: allocator and layout are this device's, here and below.
    let tables =
        unsafe { Tables::editable(device, &mut gpu.allocator(), &layout, &editable, &options)? };
    let mut tables = gpu.hold(tables, |gpu, tables| {
        // SAFETY: as above.
        unsafe { tables.destroy(&gpu.device, &mut gpu.allocator()) };
    });
    let positions = model.positions();
    // SAFETY: as above.
    let pose = unsafe {
        let allocator = &mut gpu.allocator();
        Pose::new(device, allocator, &layout, &tables, &positions, &options)?
    };
    let mut pose = gpu.hold(pose, |gpu, pose| {
        // SAFETY: as above.
        unsafe { pose.destroy(&gpu.device, &mut gpu.allocator()) };
    });
    let mut frames: Vec<Frame<'_>> = Vec::new();
    for _ in 0..SLOTS {
        // SAFETY: as above.
        let slot = unsafe {
            let (allocator, known) = (&mut gpu.allocator(), &gpu.workarounds);
            FrameSlot::new(device, allocator, &layout, &tables, known, options)?
        };
        frames.push(Frame {
            commands: Commands::new(&gpu)?,
            picture: Picture::new(&gpu)?,
            slot: gpu.hold(slot, |gpu, slot| {
                // SAFETY: as above.
                unsafe { slot.destroy(&gpu.device, &mut gpu.allocator()) };
            }),
            retired: Retired::default(),
        });
    }

    // 4. Frames. Whoever edits waits for nobody: what the queue has before draws the surface that there was.
    let idle = Idle(&gpu);
    let view = view(&model);
    for number in 0..FRAMES {
        let frame = &mut frames[number % SLOTS];
        frame.commands.begin()?;
        if number == SLOTS {
            frame.picture.write("edit_topology-first.png")?;
        }
        // SAFETY: the frames before the edit that replaced it have ended: this slot's own came behind all of them.
        unsafe { std::mem::take(&mut frame.retired).destroy(device, &mut gpu.allocator()) };
        if number > 0 {
            let mut edit = model.mesh().edit();
            let what = change(&mut edit, &model, number);
            let changes = model.apply(&edit)?;
            let update = editable.update(&model, &changes, &database)?;
            if update.is_whole {
                return Err(
                    "everything was prepared anew: an engine makes tables, pose and slots again"
                        .into(),
                );
            }
            // SAFETY: as above.
            unsafe {
                let allocator = &mut gpu.allocator();
                frame.retired = tables.edit(device, allocator, &layout, &editable, &update)?;
                let replaced = pose.edit(device, allocator, &layout, &tables, &model, &changes)?;
                frame.retired.extend(replaced);
            }
            println!(
                "frame {number}: {what}; {} faces planned again, {:.1} KB of tables",
                changes.faces().len(),
                4.0 * update.words() as f64 / 1000.0
            );
        }
        let list = frame.slot.draw_list(&tables, cut, None)?;
        let cmd = frame.commands.cmd;
        // SAFETY: recording on the device that made everything, inside and outside of rendering as each asks; all of it lives until the device is idle.
        unsafe {
            tables.cmd_upload(device, cmd);
            pose.cmd_upload(device, cmd);
            frame.slot.cmd_prepare(device, cmd, &[view])?;
            frame.picture.begin(cmd);
            let drawing = Drawing {
                tables: &tables,
                pose: &pose,
                slot: &frame.slot,
                sets: &[],
            };
            for batch in list.batches() {
                drawing.cmd_draw(device, cmd, &layout, &pipelines, 0..1, batch)?;
            }
            frame.picture.end(cmd);
        }
        frame.commands.submit()?;
    }
    drop(idle);
    frames[(FRAMES - 1) % SLOTS]
        .picture
        .write("edit_topology-last.png")?;
    for frame in &mut frames {
        // SAFETY: the device is idle.
        unsafe { std::mem::take(&mut frame.retired).destroy(device, &mut gpu.allocator()) };
    }

    // 5. The same as if nothing had been kept.
    let fresh = method.prepare_with(&model, PlanOptions::default(), &database)?;
    println!(
        "{} of {} ptex faces differ from a fresh preparation",
        differing(editable.prepared(), &fresh, &model),
        model.mesh().ptex_count()
    );
    Ok(())
}

/// One edit after another: a face is lifted out of the surface on new vertices, one is cut out, an edge becomes sharper.
fn change(edit: &mut Edit, model: &Model, number: usize) -> &'static str {
    let mesh = model.mesh();
    // Faces far from one another, and only those that are there.
    let there = (0..mesh.face_count()).cycle().skip(17 * number);
    let mut there = there.filter(|&face| !mesh.is_removed(face));
    let face = there.next().expect("a mesh has a face") as u32;
    let corners = mesh.face(face as usize).to_vec();
    match number % 3 {
        1 => {
            lift(edit, model, face);
            "a face is lifted"
        }
        2 => {
            edit.remove_face(face);
            "a face is cut out"
        }
        _ => {
            edit.crease(corners[0], corners[1], 3.0);
            "an edge is creased"
        }
    }
}

/// Lifts a face by about the length of its edges, smaller than it was: its corners get new vertices, and new faces fill what lies between.
fn lift(edit: &mut Edit, model: &Model, face: u32) {
    let mesh = model.mesh();
    let corners = mesh.face(face as usize);
    let places: Vec<DVec3> = corners
        .iter()
        .map(|&vertex| mesh.positions()[vertex as usize])
        .collect();
    let n = corners.len();
    let middle = places.iter().sum::<DVec3>() / n as f64;
    let area = (0..n).map(|i| (places[i] - middle).cross(places[(i + 1) % n] - middle));
    let area: DVec3 = area.sum();
    let height = area.normalize_or_zero() * 0.5 * area.length().sqrt();
    let first = mesh.vertex_count() as u32;
    let lifted: Vec<u32> = (first..first + n as u32).collect();
    for place in places {
        edit.add_vertex((place.lerp(middle, 0.3) + height).to_array());
    }
    for i in 0..n {
        let j = (i + 1) % n;
        edit.add_face(&[corners[i], corners[j], lifted[j], lifted[i]]);
    }
    edit.reconnect_face(face, &lifted);
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
    let pairs = drawn(edited).into_iter().zip(drawn(fresh));
    pairs.filter(|(one, other)| one != other).count()
}

/// From the front, a little from the right and from above, far enough for what will be lifted.
fn view(model: &Model) -> View {
    let radius = 0.65 * model.diagonal() as f32;
    let distance = 2.0 * radius;
    let eye_from_model = Mat4::from_translation(Vec3::new(0.0, 0.0, -distance))
        * Mat4::from_rotation_x(0.6)
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
