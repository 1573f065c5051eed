//! What the device makes of its decisions: lists of what is drawn, batches and slots by real needs, the same as the twin's to the bit, and no more work than that.

use ash::vk;
use hullform::abi;
use hullform::frame::Compacted;
use hullform::gpu::{
    Backend, Cut, Decision, DrawList, Fill, FrameSlot, Metric, Residence, Samples, Shading,
    SurfaceOptions, View,
};
use hullform::host::Shot;
use hullform::mesh::Model;
use hullform::method::{METHODS, Prepared};
use hullform::tessellation::Spacing;

use crate::common::gpu::{Gpu, Loaded, SIDE, cut, prepare};
use crate::decide::{options, radius, views};
use crate::shapes;

/// Holds what a slot has of a view to the twin, by the decisions of the device; what that is, by pass.
pub fn hold_to_twin(
    slot: &FrameSlot,
    prepared: &Prepared,
    list: &DrawList,
    view: u32,
) -> Vec<Compacted> {
    let of_pass = |number: usize| {
        let decided = slot.decided(number, view);
        let twin = list.compacted(prepared, number, decided)?;
        let (batches, drawn) = slot.compacted(list, number, view);
        assert_eq!(drawn, twin.list);
        let slots = drawn.iter().map(|&patch| decided[patch as usize].slot);
        assert!(slots.eq(twin.slots.iter().copied()));
        let pass = &prepared.passes[number];
        let controls = match pass.cached {
            Some(_) if list.options().residence == Residence::Cache => 1,
            _ => pass.control_points,
        };
        // The words that commands alone need.
        let expected = twin.batches.iter().map(|batch| abi::DrawnBatch {
            vertices: controls * batch.per_instance,
            first_instance: view * pass.patches.len() as u32,
            ..*batch
        });
        assert!(expected.eq(batches.iter().copied()), "{batches:?} {twin:?}");
        Some(twin)
    };
    (0..prepared.passes.len()).filter_map(of_pass).collect()
}

/// A picture, the control points that it took, and how often control shaders ran.
type Drawn = (Vec<u8>, u32, Option<u64>);

fn draw(gpu: &Gpu, loaded: &mut Loaded<'_>, list: &DrawList, view: View) -> Drawn {
    let pipelines = gpu.build(
        loaded.prepared(),
        (Backend::Tessellator, list.options().residence),
        list.cut().spacing,
        Fill::Solid(Shading::Patch),
        vk::CompareOp::LESS_OR_EQUAL,
    );
    let shot = Shot {
        pipelines: &pipelines,
        view,
        instances: 1,
        batches: list.batches().collect(),
    };
    let counted = hullform::host::Loaded::draw(loaded, &[shot]).expect("it is executed");
    let counters = loaded.surface().counters().expect("it was read back");
    assert_eq!(counters.overflows, 0);
    let patches = counted.map(|[patches, ..]| patches);
    (loaded.pixels(), counters.points, patches)
}

fn load<'a>(gpu: &'a Gpu, model: &Model, options: SurfaceOptions) -> Loaded<'a> {
    let prepared = prepare(model, METHODS[0].name);
    let loaded = gpu.load(model, prepared, &gpu.device.info().workarounds, options);
    loaded.expect("the tessellator draws it")
}

/// Rings that hold all, some and a patch or two, and none; batches that are bounded by vertices.
fn kinds(prepared: &Prepared, cut: Cut) -> Vec<SurfaceOptions> {
    let most = |pass| {
        let pass: &hullform::method::Pass = pass;
        (0..pass.patches.len())
            .map(|patch| cut.points(pass, patch))
            .max()
    };
    let most = prepared.passes.iter().filter_map(most).max().unwrap_or(1);
    let ring = |patches: u32| SurfaceOptions {
        ring_bytes: 16 * u64::from(patches * most),
        greatest_level: cut.level,
        ..options(Residence::Ring)
    };
    let bounded = |residence| SurfaceOptions {
        batch_vertices: 3000,
        greatest_level: cut.level,
        ..options(residence)
    };
    vec![
        ring(1000),
        ring(20),
        ring(1),
        bounded(Residence::Ring),
        bounded(Residence::Cache),
        options(Residence::Cache),
    ]
}

#[test]
fn batches_by_real_needs_are_the_twins_and_the_picture_is_the_same() {
    let Some(gpu) = Gpu::open() else { return };
    let (mut left_over, mut several) = (0, 0);
    for (name, spacing) in [
        ("hull", Spacing::FractionalEven),
        ("ngons", Spacing::Equal),
        ("creased-torus", Spacing::Equal),
    ] {
        let model = shapes::built_in(name);
        let radius = radius(&model);
        let cut = cut(23.0, spacing);
        let decision = Decision {
            metric: Metric::Screen {
                pixels: 3.0,
                size: [SIDE as f32; 2],
            },
            frustum: true,
            back: false,
            small: Some(Samples {
                a_pixel: 1,
                size: [SIDE as f32; 2],
            }),
            seen_from: None,
        };
        let kinds = kinds(&prepare(&model, METHODS[0].name), cut);
        let mut right: Vec<Drawn> = Vec::new();
        for options in kinds {
            let mut loaded = load(&gpu, &model, options);
            loaded.decision = decision;
            let list = loaded.draw_list(cut).expect("it is a cut");
            for (number, view) in views(3, radius).enumerate() {
                let (picture, points, patches) = draw(&gpu, &mut loaded, &list, view);
                let slot = loaded.surface().drawing().slot;
                let made = hold_to_twin(slot, loaded.prepared(), &list, 0);
                let batches = made.iter().flat_map(|own| &own.batches);
                let (drawn, empty): (Vec<&abi::DrawnBatch>, Vec<_>) =
                    batches.partition(|b| b.patches > 0);
                left_over += empty.len();
                several += drawn.len().saturating_sub(made.len());
                let run = drawn
                    .iter()
                    .map(|b| u64::from(b.instances * b.per_instance));
                assert!(patches.is_none_or(|patches| patches == run.sum::<u64>()));
                let outcome = loaded.surface().outcome(&list, 0..1).expect("read back");
                let listed = made.iter().map(|own| own.list.len() as u64).sum::<u64>();
                assert_eq!(outcome.drawn, listed);
                if options.residence == Residence::Ring {
                    assert_eq!(u64::from(points), outcome.points, "{name} {number}");
                }
                match right.get(number) {
                    Some((same, ..)) => assert!(*same == picture, "{name} {number} {options:?}"),
                    None => right.push((picture, points, patches)),
                }
            }
        }
    }
    assert!(left_over > 20 && several > 20, "{left_over} {several}");
    gpu.finish();
}
