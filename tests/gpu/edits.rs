//! Edits while frames are in flight: each frame draws the surface that there was when it was recorded.

use ash::vk;
use hullform::abi::Captured;
use hullform::gpu::{
    Backend, CachePipelines, Decides, Drawing, Fill, FrameSlot, Pose, Residence, Retired,
    SurfaceOptions, Tables, View,
};
use hullform::host::Owned;
use hullform::mesh::Model;
use hullform::method::{Displacement, METHODS, MethodOptions, Prepared};
use hullform::plan::Database;
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};

use crate::common::gpu::{Gpu, capturing, cut};
use crate::flight::Flight;
use crate::shapes;

/// Frames in flight at once.
const SLOTS: usize = 2;

/// Frames in all; between them are edits.
const FRAMES: usize = 15;

/// What is drawn, whatever the numbers of patches.
fn drawn(vertices: &[Captured]) -> Vec<[u32; 8]> {
    let bits = |vertex: &Captured| {
        let [u, v] = vertex.uv;
        let [x, y, z] = vertex.position;
        let [nx, ny, nz] = vertex.normal;
        [u, v, x, y, z, nx, ny, nz].map(f32::to_bits)
    };
    let mut drawn: Vec<[u32; 8]> = vertices.iter().map(bits).collect();
    drawn.sort_unstable();
    drawn.dedup();
    drawn
}

/// The edit before a frame: creases grow and go, a face becomes a hole and is there again, a corner, a vertex that moves; faces are removed, lifted out of the surface on new
/// vertices, and put back.
fn edit(model: &mut Model, frame: usize) -> hullform::mesh::ChangeSet {
    let edge =
        |i: usize| model.topology().edges()[(37 * i + 11) % model.topology().edge_count()].vertices;
    let mut edit = model.mesh().edit();
    let mesh = model.mesh();
    let face = mesh.face(60 + frame);
    match frame % 5 {
        4 => {
            // Lifted towards the middle, so that the bounding box stays.
            let first = mesh.vertex_count() as u32;
            let n = face.len() as u32;
            for &vertex in face {
                let place = 0.8 * mesh.positions()[vertex as usize];
                edit.add_vertex(place.to_array());
            }
            for i in 0..n {
                let [a, b] = [i, (i + 1) % n].map(|i| face[i as usize]);
                edit.add_face(&[a, b, first + (i + 1) % n, first + i]);
            }
            let lifted: Vec<u32> = (first..first + n).collect();
            edit.reconnect_face(60 + frame as u32, &lifted);
            edit.crease(first, first + 1, 2.0)
                .remove_face(30 + frame as u32);
            // More vertices than there is room for, once.
            for _ in 0..if frame == 9 { 200 } else { 0 } {
                edit.add_vertex([0.0; 3]);
            }
        }
        1 => {
            let [a, b] = edge(frame);
            edit.crease(a, b, 1.5 + frame as f32 / 8.0);
        }
        2 => {
            edit.hole(40, true).corner(100, frame as f32);
        }
        3 => {
            for i in 0..5 {
                let [a, b] = edge(frame * 5 + i);
                edit.crease(a, b, [0.0, 2.5, 10.0][(i + frame) % 3]);
            }
            // Towards the middle, so that the bounding box stays.
            let vertex = 200 + frame as u32;
            let place = 0.9 * model.mesh().positions()[vertex as usize];
            edit.position(vertex, place.to_array());
        }
        _ => {
            edit.hole(40, false).corner(100, 0.0).crease(
                mesh.face(50)[0],
                mesh.face(50)[1],
                0.25 * frame as f32,
            );
        }
    }
    model.apply(&edit).expect("all of it is there")
}

fn fresh(model: &Model, database: &Database) -> Prepared {
    let prepared = METHODS[0].prepare_with(model, MethodOptions::default(), database);
    prepared.expect("it draws the model")
}

/// With two frames that the queue has at once, each after an edit or several: what each draws is what a fresh preparation draws, to the bit, and nobody waits; whether
/// control points are computed for each frame or kept.
#[test]
fn frames_in_flight_draw_the_surface_that_there_was_when_they_were_recorded() {
    let Some(gpu) = Gpu::open() else { return };
    let database = Database::default();
    let deep = cut(8.0, Spacing::Equal);
    let workarounds = &gpu.device.info().workarounds;
    let whole = shapes::built_in("hull");
    let options = capturing(&fresh(&whole, &database), &[deep]);
    let options = SurfaceOptions {
        capture_vertices: 2 * options.capture_vertices,
        ring_bytes: 2 * options.ring_bytes,
        ..options
    };
    // What is right, each frame alone.
    let mut model = whole.clone();
    let right: Vec<Vec<[u32; 8]>> = (0..FRAMES)
        .map(|frame| {
            if frame > 0 {
                edit(&mut model, frame);
            }
            let prepared = fresh(&model, &database);
            let alone = gpu.load(&model, prepared, workarounds, options);
            let mut alone = alone.expect("it fits");
            let frame = alone.capture(deep, Fill::Discard).expect("it is drawn");
            drawn(&frame.passes.concat())
        })
        .collect();
    assert!(
        right.windows(2).all(|pair| pair[0] != pair[1]),
        "each edit is seen"
    );

    fly(&gpu, whole.clone(), &right, options);
    let options = SurfaceOptions {
        residence: Residence::Cache,
        ..options
    };
    fly(&gpu, whole, &right, options);
    gpu.finish();
}

/// Draws the frames, two in flight, with an edit before each.
fn fly(gpu: &Gpu, whole: Model, right: &[Vec<[u32; 8]>], options: SurfaceOptions) {
    let database = Database::default();
    let deep = cut(8.0, Spacing::Equal);
    let (device, layout) = (gpu.device.raw(), gpu.layout());
    let workarounds = &gpu.device.info().workarounds;
    let mut model = whole;
    let editable = METHODS[0].prepare_editable(&model, MethodOptions::default(), &database);
    let mut editable = editable.expect("it draws the model");
    // SAFETY: all of one live device, here and below.
    let (mut tables, mut pose) = unsafe {
        let allocator = &mut gpu.device.allocator();
        let tables = Tables::editable(device, allocator, layout, &editable, &options);
        let tables = Owned::new(&gpu.device, tables.expect("it fits"));
        let positions = model.positions();
        let pose = Pose::new(device, allocator, layout, &tables, &positions, &options);
        (tables, Owned::new(&gpu.device, pose.expect("it fits")))
    };
    let mut flights: Vec<(Flight<'_>, Retired)> = (0..SLOTS)
        .map(|_| {
            // SAFETY: as above.
            let slot = unsafe {
                let allocator = &mut gpu.device.allocator();
                let slot = FrameSlot::new(device, allocator, layout, &tables, workarounds, options);
                Owned::new(&gpu.device, slot.expect("it fits"))
            };
            (Flight::new(gpu, slot), Retired::default())
        })
        .collect();
    // SAFETY: as above.
    let caching = unsafe {
        let none = vk::PipelineCache::null();
        let made = CachePipelines::new(device, layout, none, editable.prepared());
        Owned::new(
            &gpu.device,
            made.expect("the shipped modules make pipelines"),
        )
    };
    let makers = (Backend::Tessellator, options.residence);
    let compare = vk::CompareOp::LESS_OR_EQUAL;
    let pipelines = gpu.build(
        editable.prepared(),
        makers,
        Spacing::Equal,
        Fill::Discard,
        compare,
    );
    let view = View {
        clip_from_model: [[0.0; 4]; 4],
        eye: [0.0; 3],
        displacement: Displacement::default(),
    };
    let (mut larger, mut computed) = (0, Vec::new());
    for frame in 0..FRAMES + SLOTS {
        let (flight, retired) = &mut flights[frame % SLOTS];
        if frame >= SLOTS {
            let landed = drawn(&flight.land());
            assert!(landed == right[frame - SLOTS], "frame {}", frame - SLOTS);
            // SAFETY: the frames that were recorded before the edit have ended.
            unsafe { std::mem::take(retired).destroy(device, &mut gpu.device.allocator()) };
        }
        if frame >= FRAMES {
            continue;
        }
        if frame > 0 {
            let allocated = gpu.device.allocated_bytes();
            let changes = edit(&mut model, frame);
            let update = editable
                .update(&model, &changes, &database)
                .expect("it goes");
            // SAFETY: as above.
            let edited = unsafe {
                let allocator = &mut gpu.device.allocator();
                tables.edit(device, allocator, layout, &editable, &update)
            };
            *retired = edited.expect("there is room");
            if frame == 9 {
                let refused = pose.move_vertices(&tables, &[]);
                let is_small = matches!(refused, Err(Error::Misuse(Misuse::Count { .. })));
                assert!(is_small, "a pose that has to grow is not drawn");
            }
            // SAFETY: as above.
            let edited = unsafe {
                let allocator = &mut gpu.device.allocator();
                pose.edit(device, allocator, layout, &tables, &model, &changes)
            };
            retired.extend(edited.expect("there is room"));
            larger += usize::from(!retired.is_empty());
            if retired.is_empty() {
                assert_eq!(gpu.device.allocated_bytes(), allocated, "nothing is copied");
            }
        }
        let list = flight.slot.draw_list(&tables, deep, None).expect("a cut");
        let (tables, pose) = (&mut *tables, &mut *pose);
        flight.send(|cmd, slot| {
            // SAFETY: all of one live device, in the order that the calls ask for.
            unsafe {
                tables.cmd_upload(device, cmd);
                pose.cmd_upload(device, cmd);
                if options.residence == Residence::Cache {
                    let points = pose.cmd_cache(device, cmd, layout, &caching, tables, &list);
                    computed.push(points.expect("there is room"));
                }
                let drawing = Drawing {
                    tables,
                    pose,
                    slot,
                    sets: &[],
                };
                slot.cmd_prepare(device, cmd, &[view])
                    .expect("there is room for a view");
                gpu.target().begin(cmd, [0.0; 4]);
                for batch in list.batches() {
                    let drawn = drawing.cmd_draw(device, cmd, layout, &pipelines, 0..1, batch);
                    drawn.expect("all belong together");
                }
                gpu.target().end(cmd);
            }
        });
    }
    assert!((1..FRAMES / 2).contains(&larger), "most edits have room");
    if let [first, rest @ ..] = &computed[..] {
        let least = rest.iter().min().expect("there are more frames");
        assert!(
            least * 10 < *first,
            "points that no edit changes stay: {computed:?}"
        );
    }
    drop((flights, pipelines, caching));
}

/// What outgrows its room, where the device decides, and what is refused.
#[test]
fn what_outgrows_its_room_moves_and_what_does_not_follow_is_refused() {
    let Some(gpu) = Gpu::open() else { return };
    let database = Database::default();
    let (device, layout) = (gpu.device.raw(), gpu.layout());
    let mut model = shapes::built_in("creased-torus");
    let editable = METHODS[0].prepare_editable(&model, MethodOptions::default(), &database);
    let mut editable = editable.expect("it draws the model");
    let options = SurfaceOptions {
        decides: Decides::Device,
        ..SurfaceOptions::default()
    };
    // SAFETY: all of one live device, here and below.
    let made = |options: &SurfaceOptions| unsafe {
        let allocator = &mut gpu.device.allocator();
        Tables::editable(device, allocator, layout, &editable, options)
    };
    // SAFETY: as above.
    let mut tables = unsafe { Owned::new(&gpu.device, made(&options).expect("it fits")) };
    let mut moved = 0;
    let mut previous = None;
    for number in 0..200u32 {
        let edge = 7 * number as usize % model.topology().edge_count();
        let [a, b] = model.topology().edges()[edge].vertices;
        let mut edit = model.mesh().edit();
        edit.crease(a, b, 0.5 + number as f32 / 128.0);
        let changes = model.apply(&edit).expect("there is such an edge");
        let update = editable
            .update(&model, &changes, &database)
            .expect("it goes");
        if update.is_whole {
            break;
        }
        // SAFETY: as above; nothing is submitted but the upload, which has ended.
        unsafe {
            let allocator = &mut gpu.device.allocator();
            let retired = tables.edit(device, allocator, layout, &editable, &update);
            let retired = retired.expect("there is memory");
            moved += u32::from(!retired.is_empty());
            retired.destroy(device, allocator);
            let again = tables.edit(device, allocator, layout, &editable, &update);
            assert!(
                matches!(again, Err(Error::Misuse(Misuse::OtherSurface))),
                "once each"
            );
            if let Some(earlier) = previous.replace(update) {
                let again = tables.edit(device, allocator, layout, &editable, &earlier);
                assert!(again.is_err(), "in their order");
            }
        }
        // SAFETY: recording on the device that made everything, outside of a render pass.
        let uploaded = gpu.device.submit(|cmd| unsafe {
            tables.cmd_upload(device, cmd);
            Ok(())
        });
        uploaded.expect("it is executed");
    }
    assert!(moved > 0, "it got larger");
    drop(tables);
    gpu.finish();
}
