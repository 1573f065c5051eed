//! The scratch ring: whatever its size and whoever gives slots, the same bits; and what does not fit is never drawn wrong.

use std::collections::BTreeSet;

use ash::vk;
use hullform::abi::Captured;
use hullform::gpu::{
    Batch, Cut, Fill, Layout, Pipelines, Remedy, Slots, SurfaceOptions, Workaround, workaround,
};
use hullform::host::{self, Shot, Style, vertex_bits};
use hullform::mesh::Model;
use hullform::method::Prepared;
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};

use crate::common::gpu::{
    Frame, Gpu, Loaded, SPACINGS, bits, capturing, cut, over_patches, prepare,
};
use crate::shapes;

/// A patch an instance, as no known driver needs it.
static ONE_A_TIME: Workaround = Workaround {
    remedy: Remedy::SplitBatches { max_vertices: 1 },
    name: "one-a-time",
    ..workaround::WORKAROUNDS[0]
};

/// A ring for exactly the hungriest patch.
fn smallest_ring(prepared: &Prepared, cut: Cut) -> u64 {
    let passes = prepared.passes.iter();
    let points = passes
        .flat_map(|pass| (0..pass.patches.len()).map(move |patch| cut.points(pass, patch)))
        .max();
    16 * u64::from(points.unwrap_or(0))
}

/// A ring for everything at once.
fn whole_ring(prepared: &Prepared, cut: Cut) -> u64 {
    16 * u64::from(over_patches(prepared, |pass, patch| {
        cut.points(&prepared.passes[pass], patch)
    }))
}

fn load<'a>(
    gpu: &'a Gpu,
    model: &Model,
    workarounds: &[&'static Workaround],
    cut: Cut,
    change: impl FnOnce(&Prepared, &mut SurfaceOptions),
) -> Loaded<'a> {
    let prepared = prepare(model, "quadtree");
    let mut options = capturing(&prepared, &[cut]);
    change(&prepared, &mut options);
    let loaded = gpu.load(model, prepared, workarounds, options);
    loaded.expect("the ring holds a patch")
}

fn assert_same_bits(what: &str, frame: &Frame, reference: &Frame) {
    assert_eq!(frame.counters.overflows, 0, "{what}");
    assert_eq!(frame.passes.len(), reference.passes.len(), "{what}");
    for (pass, right) in frame.passes.iter().zip(&reference.passes) {
        assert_eq!(pass.len(), right.len(), "{what}");
        let differs = pass.iter().zip(right).find(|(a, b)| bits(a) != bits(b));
        assert!(differs.is_none(), "{what}: {differs:?}");
    }
}

#[test]
fn bits_do_not_depend_on_batches() {
    let Some(gpu) = Gpu::open() else { return };
    let known = gpu.device.info().workarounds.clone();
    for name in ["hull", "ngons", "pole-64"] {
        let model = shapes::built_in(name);
        for cut in SPACINGS.map(|spacing| cut(7.0, spacing)) {
            let reference = load(&gpu, &model, &known, cut, |_, _| ())
                .capture(cut, Fill::Discard)
                .expect("it is drawn");
            for slots in [Slots::Counter, Slots::Host] {
                for (ring, size) in [("smallest", 1), ("small", 3), ("whole", 0)] {
                    let mut loaded = load(&gpu, &model, &known, cut, |prepared, options| {
                        options.slots = slots;
                        options.ring_bytes = match size {
                            0 => whole_ring(prepared, cut),
                            times => times * smallest_ring(prepared, cut),
                        };
                    });
                    let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
                    let what = format!("{name} {cut:?} {slots:?} {ring} ring");
                    assert_same_bits(&what, &frame, &reference);
                }
            }
            // No batch but of a single patch has more vertices than it may.
            let mut loaded = load(&gpu, &model, &known, cut, |_, options| {
                options.batch_vertices = 300;
            });
            let list = loaded.draw_list(cut).expect("it fits");
            let few = |batch: Batch<'_>| batch.vertices() <= 300 || batch.patches().len() == 1;
            assert!(list.batches().all(few), "{name} {cut:?}");
            let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
            assert_same_bits("small batches", &frame, &reference);
            let mut loaded = load(&gpu, &model, &[&ONE_A_TIME], cut, |_, _| ());
            let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
            assert_same_bits("a patch an instance", &frame, &reference);
        }
    }
    gpu.finish();
}

#[test]
fn bits_do_not_depend_on_how_many_invocations_fill_the_ring() {
    let Some(gpu) = Gpu::open() else { return };
    let known = gpu.device.info().workarounds.clone();
    let device = gpu.device.raw();
    let cut = cut(7.0, Spacing::Equal);
    for name in ["hull", "ngons", "pole-64"] {
        let model = shapes::built_in(name);
        let mut loaded = load(&gpu, &model, &known, cut, |_, options| {
            options.slots = Slots::Host;
        });
        let list = loaded.draw_list(cut).expect("it fits");
        let style = Style::new(loaded.surface().options(), cut.spacing, Fill::Discard);
        // Fewer than eight, and more than the vertices of a ring, are none.
        let drawn = [4, 8, 16, 32, 64].map(|abreast| {
            let enabled = gpu.device.enabled().with_subgroup_size(abreast);
            let (cache, options) = (vk::PipelineCache::null(), style.options(gpu.target()));
            // SAFETY: all of one live device, which has executed the commands when they are destroyed.
            unsafe {
                let layout = Layout::new(device, enabled).expect("a layout");
                let made = Pipelines::new(device, &layout, cache, loaded.prepared(), &options);
                let pipelines = made.expect("pipelines");
                let shot = Shot {
                    pipelines: &pipelines,
                    view: loaded.view,
                    instances: 1,
                    batches: list.batches().collect(),
                };
                host::Loaded::draw(&loaded, &[shot]).expect("it is executed");
                pipelines.destroy(device);
                layout.destroy(device);
            }
            let counters = loaded.surface().counters().expect("counters");
            assert_eq!(counters.overflows, 0, "{name}");
            let captured = loaded.surface().captured().expect("vertices");
            let mut captured: Vec<_> = captured.iter().map(vertex_bits).collect();
            captured.sort();
            captured.dedup();
            captured
        });
        assert!(drawn[0].len() > 100, "{name}");
        for other in &drawn[1..] {
            assert!(*other == drawn[0], "{name}");
        }
    }
    gpu.finish();
}

/// Many batches, through a ring that each uses again, in a single pass of the device: the barriers hold.
#[test]
fn batches_of_one_submission_do_not_disturb_each_other() {
    let Some(gpu) = Gpu::open() else { return };
    let known = gpu.device.info().workarounds.clone();
    let model = shapes::built_in("cubes-4x4x4");
    let cut = cut(8.0, Spacing::Equal);
    let mut whole = load(&gpu, &model, &known, cut, |_, _| ());
    let reference = whole.capture(cut, Fill::Discard).expect("it is drawn");
    let mut loaded = load(&gpu, &model, &known, cut, |prepared, options| {
        options.ring_bytes = 2 * smallest_ring(prepared, cut);
    });
    let list = loaded.draw_list(cut).expect("they fit");
    assert!(list.batches().len() > 100);
    let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
    assert_same_bits("two patches a batch", &frame, &reference);
    drop((whole, loaded));
    gpu.finish();
}

#[test]
fn a_ring_too_small_for_a_patch_is_refused() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("cube");
    let prepared = prepare(&model, "quadtree");
    let cut = cut(8.0, Spacing::Equal);
    let options = SurfaceOptions {
        ring_bytes: smallest_ring(&prepared, cut) - 16,
        ..capturing(&prepared, &[cut])
    };
    let refused = gpu.load(&model, prepared, &[], options).err();
    let refused = refused.expect("no patch fits");
    assert!(
        matches!(refused, Error::Misuse(Misuse::RingTooSmall { .. })),
        "{refused}"
    );
    assert_eq!(refused.exit_code(), 2);
    gpu.finish();
}

/// A ring made for a low level is refused at a higher one instead of being overrun.
#[test]
fn a_level_above_the_promised_one_is_refused_when_the_ring_is_too_small() {
    let Some(gpu) = Gpu::open() else { return };
    let low = cut(2.0, Spacing::Equal);
    let loaded = load(
        &gpu,
        &shapes::built_in("cube"),
        &[],
        low,
        |prepared, options| {
            options.ring_bytes = smallest_ring(prepared, low);
        },
    );
    assert!(loaded.surface().draw_list(low, None).is_ok());
    let high = cut(64.0, Spacing::Equal);
    let refused = loaded.surface().draw_list(high, None);
    assert!(matches!(refused, Err(Error::Misuse(Misuse::Level { .. }))));
    drop(loaded);
    gpu.finish();
}

/// The batches once more in one frame, as for lines over a surface: the same vertices, from counters of their own.
#[test]
fn another_round_gives_the_same_bits() {
    let Some(gpu) = Gpu::open() else { return };
    let known = gpu.device.info().workarounds.clone();
    let model = shapes::built_in("cubes-2x2x2");
    let cut = cut(5.0, Spacing::FractionalEven);
    let mut loaded = load(&gpu, &model, &known, cut, |prepared, options| {
        options.ring_bytes = 3 * smallest_ring(prepared, cut);
        options.rounds = 2;
    });
    let reference = loaded.capture(cut, Fill::Discard).expect("it is drawn");
    let list = loaded.draw_list(cut).expect("they fit");
    let again = list.round(1).expect("there are two rounds");
    let both: Vec<Batch<'_>> = list.batches().chain(again).collect();
    // What is captured twice is compared bit by bit where duplicates are removed.
    let frame = loaded.draw(cut, Fill::Discard, &both).expect("it is drawn");
    assert_same_bits("two rounds", &frame, &reference);
    assert_eq!(frame.counters.points, 2 * reference.counters.points);
    drop(loaded);
    gpu.finish();
}

/// The patches that are there, each whole and right bit by bit.
fn whole_patches(captured: &[Captured], reference: &[Captured]) -> BTreeSet<u32> {
    let of = |vertices: &[Captured], patch| -> Vec<[u32; 9]> {
        let own = vertices
            .iter()
            .filter(|vertex| vertex.patch_number == patch);
        own.map(bits).collect()
    };
    let patches: BTreeSet<u32> = captured.iter().map(|vertex| vertex.patch_number).collect();
    for &patch in &patches {
        assert_eq!(of(captured, patch), of(reference, patch), "patch {patch}");
    }
    patches
}

/// A batch whose patches ask again, as they would when a control shader runs more often than once a patch.
#[test]
fn patches_without_room_are_counted_and_left_out() {
    let Some(gpu) = Gpu::open() else { return };
    let known = gpu.device.info().workarounds.clone();
    let model = shapes::built_in("cubes-2x2x2");
    let cut = cut(6.0, Spacing::Equal);
    let mut loaded = load(&gpu, &model, &known, cut, |prepared, options| {
        options.ring_bytes = whole_ring(prepared, cut) + 10 * smallest_ring(prepared, cut);
    });
    let reference = loaded.capture(cut, Fill::Discard).expect("it is drawn");
    let list = loaded.draw_list(cut).expect("they fit");
    let all: Vec<Batch<'_>> = list.batches().collect();
    assert_eq!(all.len(), 1);
    let frame = loaded.draw(cut, Fill::Discard, &[all[0], all[0]]);
    let frame = frame.expect("it is drawn");
    let there = whole_patches(&frame.passes[0], &reference.passes[0]);
    assert_eq!(there.len(), 48, "the first ones are there");
    assert!(frame.counters.overflows > 0, "{:?}", frame.counters);
    drop(loaded);
    gpu.finish();
}

/// With dynamic rendering in mind: the engine waits where a batch says so, and nowhere else. A pass of more patches than an instance may hold
/// on known drivers is several batches, so that no two draws use the ring at once: synchronization validation has nothing to say.
#[test]
fn batches_that_do_not_wait_may_be_drawn_without_a_barrier() {
    let Some(gpu) = Gpu::open() else { return };
    let known = gpu.device.info().workarounds.clone();
    let model = shapes::built_in("cubes-4x4x4");
    let cut = cut(15.0, Spacing::Equal);
    for rounds in [1, 2] {
        let mut loaded = load(&gpu, &model, &known, cut, |prepared, options| {
            options.ring_bytes = whole_ring(prepared, cut);
            options.barriers = false;
            options.capture_vertices = 0;
            options.rounds = rounds;
        });
        let list = loaded.draw_list(cut).expect("they fit");
        let batches = (0..rounds).flat_map(|round| list.round(round).expect("there are as many"));
        let batches: Vec<Batch<'_>> = batches.collect();
        let patches = batches.iter().map(|batch| batch.patches().len());
        let patches = patches.sum::<usize>();
        assert!(batches.iter().all(|batch| batch.draws().len() == 1));
        let frame = loaded.draw(cut, Fill::Discard, &batches);
        let frame = frame.expect("it is drawn");
        assert_eq!(frame.counters.overflows, 0);
        if let Some([counted, ..]) = frame.statistics {
            assert_eq!(counted, patches as u64);
        }
    }
    gpu.finish();
}

/// A second draw with counters that nobody set to zero.
#[test]
fn a_batch_drawn_again_without_preparation_overflows() {
    let Some(gpu) = Gpu::open() else { return };
    let known = gpu.device.info().workarounds.clone();
    let model = shapes::built_in("cube");
    let cut = cut(6.0, Spacing::Equal);
    let mut loaded = load(&gpu, &model, &known, cut, |prepared, options| {
        options.ring_bytes = whole_ring(prepared, cut);
    });
    let reference = loaded.capture(cut, Fill::Discard).expect("it is drawn");
    let list = loaded.draw_list(cut).expect("they fit");
    let all: Vec<Batch<'_>> = list.batches().collect();
    let frame = loaded.draw(cut, Fill::Discard, &[all[0], all[0]]);
    let frame = frame.expect("it is drawn");
    assert!(frame.counters.overflows >= 6, "{:?}", frame.counters);
    assert_eq!(
        whole_patches(&frame.passes[0], &reference.passes[0]).len(),
        6
    );
    drop(loaded);
    gpu.finish();
}
