//! What a caller may not do is refused with a typed error, before anything is recorded or written.

use hullform::gpu::{Backend, Batch, Cut, Fill, Slots, SurfaceOptions};
use hullform::mesh::{ControlMesh, Model};
use hullform::method::{DepthTags, METHODS, Prepared};
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};

use crate::common::gpu::{Gpu, Loaded, bits, capturing, cut, prepare};
use crate::shapes;

/// The first method, which uses the ring.
fn ringed(model: &Model) -> Prepared {
    prepare(model, METHODS[0].name)
}

fn load<'a>(gpu: &'a Gpu, model: &Model, options: SurfaceOptions) -> Loaded<'a> {
    let workarounds = &gpu.device.info().workarounds;
    let loaded = gpu.load(model, ringed(model), workarounds, options);
    loaded.expect("the ring holds a patch")
}

/// What is refused; None if nothing is.
fn misuse<T>(result: Result<T, Error>) -> Option<Misuse> {
    match result {
        Err(Error::Misuse(misuse)) => Some(misuse),
        Err(other) => panic!("{other}"),
        Ok(_) => None,
    }
}

fn draw(loaded: &Loaded<'_>, at: Cut, batches: &[Batch<'_>]) -> Option<Misuse> {
    misuse(loaded.draw(at, Fill::Discard, batches))
}

#[test]
fn options_that_draw_nothing_make_no_surface() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("cube");
    let refused = |options| misuse(gpu.load(&model, ringed(&model), &[], options));
    let rounds = SurfaceOptions {
        rounds: 0,
        ..SurfaceOptions::default()
    };
    assert_eq!(refused(rounds), Some(Misuse::NoRounds));
    for greatest_level in [f32::NAN, f32::INFINITY, 0.0, -1.0, 1024.5] {
        let levels = SurfaceOptions {
            greatest_level,
            ..SurfaceOptions::default()
        };
        let level = refused(levels);
        assert!(matches!(level, Some(Misuse::Level { .. })), "{level:?}");
    }
    let seen = u64::from(gpu.device.limits().max_storage_buffer_range);
    let ring = SurfaceOptions {
        ring_bytes: seen + 16,
        ..SurfaceOptions::default()
    };
    let large = refused(ring);
    assert!(matches!(large, Some(Misuse::BufferTooLarge { limit, .. }) if limit == seen));
    gpu.finish();
}

#[test]
fn levels_that_are_none_and_rounds_beyond_the_last_are_refused() {
    let Some(gpu) = Gpu::open() else { return };
    let options = SurfaceOptions {
        greatest_level: 8.0,
        rounds: 2,
        ..SurfaceOptions::default()
    };
    let loaded = load(&gpu, &shapes::built_in("ngons"), options);
    for spacing in [Spacing::Equal, Spacing::FractionalEven] {
        for level in [f32::NAN, f32::INFINITY, 0.0, -3.0, 0.5, 8.01, 64.0] {
            let refused = misuse(loaded.surface().draw_list(cut(level, spacing), None));
            assert!(matches!(refused, Some(Misuse::Level { .. })), "{level}");
        }
    }
    let list = loaded.surface().draw_list(cut(8.0, SPACING), None);
    let list = list.expect("it is the greatest level");
    assert!(list.round(1).is_ok());
    let (round, rounds) = (2, 2);
    let beyond = misuse(list.round(2));
    assert_eq!(beyond, Some(Misuse::Round { round, rounds }));
    drop(loaded);
    gpu.finish();
}

const SPACING: Spacing = Spacing::Equal;

/// As many vertices, faces and corners, but others; and the same ones somewhere else.
#[test]
fn tables_of_another_mesh_are_refused_and_those_of_a_deformed_one_are_not() {
    let Some(gpu) = Gpu::open() else { return };
    let cube = shapes::built_in("cube");
    let positions = cube.mesh().positions().iter().map(|p| p.to_array());
    let positions: Vec<[f64; 3]> = positions.collect();
    let faces: Vec<u32> = cube.mesh().faces().flatten().copied().collect();
    let refused = |positions: &[[f64; 3]], faces: &[u32]| {
        let built = ControlMesh::builder(positions, &[4; 6], faces).build();
        let model = Model::new(built.expect("it is sound"));
        misuse(gpu.load(&model, ringed(&cube), &[], SurfaceOptions::default()))
    };
    let swapped = faces.iter().map(|&vertex| match vertex {
        4 | 5 => 9 - vertex,
        other => other,
    });
    let swapped: Vec<u32> = swapped.collect();
    assert_eq!(refused(&positions, &swapped), Some(Misuse::OtherMesh));
    let stretched = positions.iter().map(|&[x, y, z]| [3.0 * x, y + x, z]);
    let stretched: Vec<[f64; 3]> = stretched.collect();
    assert_eq!(refused(&stretched, &faces), None);
    gpu.finish();
}

#[test]
fn nothing_is_counted_or_captured_before_it_is_read_back() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("cube");
    let at = cut(4.0, SPACING);
    let mut loaded = load(&gpu, &model, capturing(&ringed(&model), &[at]));
    let surface = loaded.surface();
    assert_eq!(misuse(surface.counters()), Some(Misuse::NotReadBack));
    assert_eq!(misuse(surface.captured()), Some(Misuse::NotReadBack));
    loaded.capture(at, Fill::Discard).expect("it is drawn");
    let counters = loaded.surface().counters().expect("it was read back");
    assert_eq!(counters.overflows, 0);
    drop(loaded);
    gpu.finish();
}

#[test]
fn lists_have_an_entry_a_control_vertex() {
    let Some(gpu) = Gpu::open() else { return };
    let mut loaded = load(&gpu, &shapes::built_in("cube"), SurfaceOptions::default());
    let count = |what, given| Misuse::Count {
        what,
        given,
        expected: 8,
    };
    let few = misuse(loaded.surface_mut().write_positions(&[[0.0; 3]; 7]));
    assert_eq!(few, Some(count("positions", 7)));
    let tagged = |depths: Vec<f32>| {
        let tags = DepthTags {
            depths,
            ..DepthTags::default()
        };
        misuse(loaded.surface().draw_list(cut(4.0, SPACING), Some(&tags)))
    };
    assert_eq!(tagged(vec![1.0; 9]), Some(count("depth tags", 9)));
    for depth in [f32::NAN, f32::INFINITY, -1.0, 10.5] {
        let mut depths = vec![1.0; 8];
        depths[5] = depth;
        let none = tagged(depths);
        assert!(matches!(none, Some(Misuse::Depth { vertex: 5, .. })));
    }
    assert_eq!(tagged(vec![6.0; 8]), None);
    drop(loaded);
    gpu.finish();
}

/// A list is of what was prepared and of the options; what the host decides must have been written; pipelines must draw what the list has.
#[test]
fn what_does_not_belong_together_is_not_drawn() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("cube");
    let (equal, even) = (cut(4.0, SPACING), cut(4.0, Spacing::FractionalEven));
    let options = SurfaceOptions::default();
    let host = SurfaceOptions {
        slots: Slots::Host,
        ..options
    };
    let (mut loaded, mut hosted) = (load(&gpu, &model, options), load(&gpu, &model, host));
    let list = loaded.draw_list(equal).expect("it can be cut");
    let own: Vec<Batch<'_>> = list.batches().collect();
    assert_eq!(draw(&loaded, equal, &own), None);
    assert_eq!(draw(&loaded, even, &own), Some(Misuse::OtherPipelines));
    assert_eq!(draw(&hosted, equal, &own), Some(Misuse::OtherSurface));
    let written = hosted.draw_list(equal).expect("it can be cut");
    let written: Vec<Batch<'_>> = written.batches().collect();
    let other = hosted.surface().draw_list(even, None);
    let other = other.expect("it can be cut");
    let other: Vec<Batch<'_>> = other.batches().collect();
    assert_eq!(draw(&hosted, equal, &written), None);
    assert_eq!(draw(&hosted, even, &other), Some(Misuse::NotWritten));
    // Another surface of the same mesh, prepared again.
    let again = load(&gpu, &model, options);
    assert_eq!(draw(&again, equal, &own), Some(Misuse::OtherSurface));
    drop((loaded, hosted, again));
    gpu.finish();
}

/// Patterns, too, are the host's decision.
#[test]
fn patterns_that_were_not_written_are_not_drawn() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("cube");
    let flat = METHODS.last().expect("there are methods");
    let options = SurfaceOptions {
        backend: Backend::Pattern,
        ..SurfaceOptions::default()
    };
    let loaded = gpu.load(&model, prepare(&model, flat.name), &[], options);
    let loaded = loaded.expect("no ring is needed");
    let at = cut(4.0, SPACING);
    let list = loaded.surface().draw_list(at, None).expect("it can be cut");
    let batches: Vec<Batch<'_>> = list.batches().collect();
    assert_eq!(draw(&loaded, at, &batches), Some(Misuse::NotWritten));
    drop(loaded);
    gpu.finish();
}

/// The tables stay where they are; positions may be replaced as often as one likes.
#[test]
fn positions_can_be_replaced_after_the_tables_staging_is_given_back() {
    let Some(gpu) = Gpu::open() else { return };
    let shape = shapes::built_in("ngons");
    for method in METHODS {
        let model = shapes::under(shape.mesh(), method.schemes[0]);
        let model = model.expect("the scheme knows its tags");
        if method.check_model(&model).is_err() {
            continue;
        }
        let at = cut(3.0, SPACING);
        let prepared = prepare(&model, method.name);
        let options = capturing(&prepared, &[at]);
        let loaded = gpu.load(&model, prepared, &[], options);
        let mut loaded = loaded.expect("the ring holds a patch");
        let still: Vec<[f32; 3]> = model.positions().iter().map(|p| p.to_array()).collect();
        let moved = still.iter().map(|&[x, y, z]| [x + y, 2.0 * z, y]);
        let moved: Vec<[f32; 3]> = moved.collect();
        let shown = [&still, &moved, &still].map(|positions| {
            loaded
                .replace_positions(positions)
                .expect("one a control vertex");
            let frame = loaded.capture(at, Fill::Discard).expect("it is drawn");
            frame.passes.concat().iter().map(bits).collect::<Vec<_>>()
        });
        assert!(shown[0] != shown[1], "{}", method.name);
        assert!(shown[0] == shown[2], "{}", method.name);
    }
    gpu.finish();
}
