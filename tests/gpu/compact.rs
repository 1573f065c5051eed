//! What the device makes of its decisions: lists of what is drawn, batches and slots by real needs, the same as the twin's to the bit, and no more work than that.

use std::ops::Range;

use ash::vk;
use hullform::abi;
use hullform::frame::Compacted;
use hullform::gpu::{
    Backend, Cut, DecidePipeline, Decided, Decision, DrawList, Fill, FrameSlot, Layout, Metric,
    PipelineOptions, Pipelines, Residence, Samples, Shading, SurfaceOptions, Target, View,
};
use hullform::host::{Owned, Shot};
use hullform::mesh::Model;
use hullform::method::{METHODS, Prepared};
use hullform::tessellation::Spacing;

use crate::canvas::{Canvas, Part};
use crate::common::gpu::{Gpu, Loaded, SIDE, cut, prepare};
use crate::decide::{options, radius, views};
use crate::instances::grid;
use crate::shapes;
use crate::targets::{COLOURED, ONE, covered, open, single_draws};

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

/// A frame that is decided by `decision` in its views, whose eyes go together, and drawn in ranges of them.
struct Scene<'a> {
    gpu: &'a Gpu,
    loaded: Loaded<'a>,
    list: DrawList,
    deciding: Owned<DecidePipeline>,
}

impl<'a> Scene<'a> {
    fn new(gpu: &'a Gpu, decision: Decision) -> Scene<'a> {
        let model = shapes::built_in("hull");
        let options = SurfaceOptions {
            views: 18,
            ..options(Residence::Cache)
        };
        let mut loaded = load(gpu, &model, options);
        loaded.decision = decision;
        let list = loaded.draw_list(cut(6.0, Spacing::Equal)).expect("a cut");
        let (device, none) = (gpu.device.raw(), vk::PipelineCache::null());
        // SAFETY: all of one live device.
        let deciding = unsafe {
            let made = DecidePipeline::new(device, gpu.layout(), none);
            Owned::new(
                &gpu.device,
                made.expect("the shipped modules make pipelines"),
            )
        };
        Scene {
            gpu,
            loaded,
            list,
            deciding,
        }
    }

    /// Draws the ranges of views between `begin` and `end`, by pipelines for a target.
    fn draw(
        &self,
        layout: &Layout,
        target: Target<'_>,
        (views, ranges): (&[View], &[Range<u32>]),
        begin: impl Fn(vk::CommandBuffer),
        end: impl Fn(vk::CommandBuffer),
    ) {
        let device = self.gpu.device.raw();
        let options = PipelineOptions {
            target,
            backend: Backend::Tessellator,
            residence: Residence::Cache,
            spacing: Spacing::Equal,
            fill: Fill::Solid(Shading::Lit),
            fragment: None,
            sub_patches: false,
            layout: None,
        };
        let eyes = target.view_mask.count_ones().max(1);
        let decided = Decided {
            views: 0..views.len() as u32,
            eyes,
        };
        let (cache, surface) = (vk::PipelineCache::null(), self.loaded.surface());
        // SAFETY: all of one live device.
        let pipelines =
            unsafe { Pipelines::new(device, layout, cache, surface.prepared(), &options) };
        let pipelines = pipelines.expect("it can");
        // SAFETY: recording on the device that made everything, in the order that the calls ask for.
        let drawn = self.gpu.device.submit(|cmd| unsafe {
            surface.cmd_prepare(device, cmd, views)?;
            let (list, decision) = (&self.list, &self.loaded.decision);
            surface.cmd_decide(
                device,
                cmd,
                layout,
                &self.deciding,
                list,
                decision,
                &decided,
            )?;
            begin(cmd);
            for batch in list.batches() {
                for views in ranges {
                    let drawing = surface.drawing();
                    drawing.cmd_draw(device, cmd, layout, &pipelines, views.clone(), batch)?;
                }
            }
            end(cmd);
            surface.cmd_read_back(device, cmd);
            Ok(())
        });
        drawn.expect("it is executed");
        // SAFETY: every submission has been waited for.
        unsafe { pipelines.destroy(device) };
    }
}

/// Nine views at once or some at a time, in one call or one each where the device has no `multiDrawIndirect`: each draws what was decided for it.
#[test]
fn views_are_drawn_together_one_by_one_and_in_any_ranges() {
    let Some(gpu) = Gpu::open() else { return };
    let single = single_draws(&gpu);
    let decision = Decision {
        metric: Metric::Screen {
            pixels: 2.0,
            size: [SIDE as f32 / 3.0; 2],
        },
        frustum: true,
        ..Decision::default()
    };
    let scene = Scene::new(&gpu, decision);
    let mut views = grid(3);
    // One of which nothing is seen.
    views[4].clip_from_model[3][0] += 100.0;
    let whole = std::slice::from_ref(&(0..9));
    let all: [&[Range<u32>]; 3] = [whole, &[0..2, 2..7, 7..9], &[5..9, 0..5]];
    let mut right = Vec::new();
    for (layout, ranges) in [gpu.layout(), &single]
        .into_iter()
        .flat_map(|l| all.map(|r| (l, r)))
    {
        let target = gpu.target();
        // SAFETY: `draw` records on the device that made the target, here and below.
        let begin = |cmd| unsafe { target.begin(cmd, [0.0; 4]) };
        // SAFETY: as above.
        let end = |cmd| unsafe {
            target.end(cmd);
            target.cmd_copy_to_host(cmd);
        };
        let pass = Target::render_pass(target.render_pass());
        scene.draw(layout, pass, (&views, ranges), begin, end);
        let pixels = scene.loaded.pixels();
        assert!(covered(&pixels) > 200);
        if right.is_empty() {
            right.clone_from(&pixels);
            let slot = scene.loaded.surface().drawing().slot;
            let prepared = scene.loaded.prepared();
            let drawn = (0..9).map(|view| {
                let made = hold_to_twin(slot, prepared, &scene.list, view);
                made.iter().map(|own| own.list.len()).sum::<usize>()
            });
            let drawn: Vec<usize> = drawn.collect();
            assert!(drawn[4] == 0 && drawn[0] > 0, "{drawn:?}");
        }
        assert!(pixels == right, "{ranges:?}");
    }
    // SAFETY: every submission has been waited for.
    unsafe { single.destroy(gpu.device.raw()) };
    drop(scene);
    gpu.finish();
}

const NONE: vk::RenderingFlags = vk::RenderingFlags::empty();

/// Two eyes an instance have one list, that of the first.
#[test]
fn with_multiview_eyes_have_one_list() {
    let Some(gpu) = open() else { return };
    if !gpu.device.info().support.optional.multiview {
        println!("skipped: no multiview");
        return gpu.finish();
    }
    let scene = Scene::new(&gpu, Decision::default());
    let left = grid(3);
    let half = |view: &View| View {
        clip_from_model: view.clip_from_model.map(|[x, y, z, w]| [0.5 * x, y, z, w]),
        ..*view
    };
    let right: Vec<View> = left.iter().map(half).collect();
    let mut alone = Vec::new();
    for views in [&left, &right] {
        let canvas = Canvas::new(&gpu, ONE, 1);
        let parts = [Part::Colour, Part::Depth];
        // SAFETY: `draw` records on the device that made the canvas, here and below.
        let begin = |cmd| unsafe { canvas.begin(cmd, &parts, 1.0, 0, NONE) };
        // SAFETY: as above.
        let end = |cmd| unsafe { canvas.end(cmd, Part::Colour) };
        let target = Target::new(COLOURED);
        scene.draw(
            gpu.layout(),
            target,
            (views, std::slice::from_ref(&(0..9))),
            begin,
            end,
        );
        alone.extend(canvas.pixels());
    }
    let both: Vec<View> = left
        .into_iter()
        .zip(right)
        .flat_map(<[View; 2]>::from)
        .collect();
    let canvas = Canvas::new(&gpu, ONE, 2);
    let target = Target {
        view_mask: 0b11,
        ..Target::new(COLOURED)
    };
    let parts = [Part::Colour, Part::Depth];
    // SAFETY: as above.
    let begin = |cmd| unsafe { canvas.begin(cmd, &parts, 1.0, 0b11, NONE) };
    // SAFETY: as above.
    let end = |cmd| unsafe { canvas.end(cmd, Part::Colour) };
    scene.draw(gpu.layout(), target, (&both, &[4..18, 0..4]), begin, end);
    assert!(covered(&alone) > 500);
    assert!(canvas.pixels() == alone, "an eye sees something else");
    let slot = scene.loaded.surface().drawing().slot;
    hold_to_twin(slot, scene.loaded.prepared(), &scene.list, 2);
    drop(canvas);
    drop(scene);
    gpu.finish();
}
