//! What the device decides about patches: the levels that the twin finds, the same on both sides of every edge, and nothing that is seen left out.

use ash::vk;
use glam::Vec3;
use glam::camera::rh::proj::vulkan::perspective;
use glam::camera::rh::view::look_at_mat4;
use gpu_allocator::MemoryLocation;
use hullform::abi;
use hullform::frame::Seen;
use hullform::gpu::{
    Backend, Buffer, Cut, DecidePipeline, Decided, Decides, Decision, Fill, Metric, Residence,
    Samples, Shading, SurfaceOptions, View,
};
use hullform::host::{Owned, Shot};
use hullform::mesh::Model;
use hullform::method::{Displacement, METHODS};
use hullform::tessellation::{Levels, Spacing};
use hullform::{Error, Misuse};

use crate::common::gpu::{Gpu, Loaded, SIDE, SPACINGS, cut, prepare};
use crate::shapes;

pub const RESIDENCES: [Residence; 2] = [Residence::Ring, Residence::Cache];

pub fn options(residence: Residence) -> SurfaceOptions {
    SurfaceOptions {
        decides: Decides::Device,
        residence,
        ring_bytes: 1 << 22,
        ..SurfaceOptions::default()
    }
}

/// How far its farthest vertex is from the middle of local units.
pub fn radius(model: &Model) -> f32 {
    let far = model.positions().into_iter().map(Vec3::length);
    far.fold(1e-30, f32::max)
}

/// A view through a camera of some opening, in radians.
fn through(eye: Vec3, at: Vec3, opening: f32, displacement: Displacement) -> View {
    let depth = eye.length() + 1.0;
    let clip =
        perspective(opening, 1.0, 1e-3 * depth, 10.0 * depth) * look_at_mat4(eye, at, Vec3::Y);
    View {
        clip_from_model: clip.to_cols_array_2d(),
        eye: eye.to_array(),
        displacement,
    }
}

/// Views from all around, near and far, that see all of it, some, or nothing.
pub fn views(count: u32, radius: f32) -> impl Iterator<Item = View> {
    let spread = |i: u32, step: f32| (i as f32 * step).fract() - 0.5;
    (1..=count).map(move |i| {
        let direction = Vec3::new(spread(i, 0.618), 0.8 * spread(i, 0.414), spread(i, 0.732));
        let eye = direction.normalize() * radius * (1.2 + 3.0 * (i as f32 * 0.303).fract());
        let at = radius * Vec3::new(spread(i, 0.271), spread(i, 0.577), spread(i, 0.139));
        let displacement = match i % 3 {
            0 => Displacement {
                height: 0.1 * radius,
                frequency: 8.0 / radius,
            },
            _ => Displacement::default(),
        };
        through(
            eye,
            2.0 * at,
            0.3 + 0.7 * (i as f32 * 0.17).fract(),
            displacement,
        )
    })
}

pub fn seen(view: &View) -> Seen {
    Seen {
        clip_from_model: view.clip_from_model,
        eye: view.eye,
        height: view.displacement.height,
    }
}

fn load<'a>(gpu: &'a Gpu, model: &Model, options: SurfaceOptions) -> Loaded<'a> {
    let prepared = prepare(model, METHODS[0].name);
    let loaded = gpu.load(model, prepared, &[], options);
    loaded.expect("the tessellator draws it")
}

/// The picture of a view, and the points that it took.
fn picture(gpu: &Gpu, loaded: &mut Loaded<'_>, cut: Cut, view: View) -> (Vec<u8>, u32) {
    let list = loaded.draw_list(cut).expect("it is a cut");
    let residence = loaded.surface().options().residence;
    let pipelines = gpu.build(
        loaded.prepared(),
        (Backend::Tessellator, residence),
        cut.spacing,
        Fill::Solid(Shading::Patch),
        vk::CompareOp::LESS_OR_EQUAL,
    );
    let shot = Shot {
        pipelines: &pipelines,
        view,
        instances: 1,
        batches: list.batches().collect(),
    };
    hullform::host::Loaded::draw(loaded, &[shot]).expect("it is executed");
    let points = loaded
        .surface()
        .counters()
        .expect("it was read back")
        .points;
    (loaded.pixels(), points)
}

/// Whether two are the same levels, up to what devices may round differently; beside an n-gon that may be a whole step.
pub fn are_alike(device: ([f32; 4], f32), twin: &Levels, rounds: bool) -> bool {
    let ([a, b, c, d], inside) = device;
    let given = [a, b, c, d, inside];
    let [a, b, c, d] = twin.edges;
    let step = if rounds { 4.0 } else { 0.0 };
    let near = |(given, expected): (f32, f32)| (given - expected).abs() <= step + 1e-4 * expected;
    given.into_iter().zip([a, b, c, d, twin.inside]).all(near)
}

#[test]
fn the_device_decides_in_each_view_what_the_twin_does() {
    let Some(gpu) = Gpu::open() else { return };
    for name in ["hull", "ngons", "creased-torus"] {
        let model = shapes::built_in(name);
        let (vertices, radius) = (model.positions(), radius(&model));
        let metrics = [
            Metric::Cut,
            Metric::Curvature(4.0),
            Metric::Distance(0.7 * radius),
            Metric::Screen {
                pixels: 3.0,
                size: [SIDE as f32; 2],
            },
        ];
        let (mut left_out, mut lowered, mut all) = (0, 0, 0);
        for (metric, spacing) in metrics.into_iter().flat_map(|m| SPACINGS.map(|s| (m, s))) {
            let cut = cut(24.0, spacing);
            let mut loaded = load(&gpu, &model, options(Residence::Ring));
            loaded.decision = Decision {
                metric,
                frustum: true,
                back: true,
                small: Some(Samples {
                    a_pixel: 1,
                    size: [SIDE as f32; 2],
                }),
                seen_from: None,
            };
            for view in views(4, radius) {
                picture(&gpu, &mut loaded, cut, view);
                let prepared = loaded.prepared();
                for (number, pass) in prepared.passes.iter().enumerate() {
                    let decided = loaded.surface().decided(number, 0);
                    assert_eq!(decided.len(), pass.patches.len());
                    for (patch, record) in decided.iter().enumerate() {
                        let (outline, seen) = (&prepared.outline, seen(&view));
                        let twin = loaded
                            .decision
                            .levels(outline, pass, patch, &vertices, cut, &seen);
                        let twin = twin.expect("there is such a patch");
                        let same = are_alike((record.edges, record.inside), &twin, name == "ngons");
                        assert!(same, "{name} {metric:?} {patch}: {record:?}, twin {twin:?}");
                        left_out += usize::from(record.inside == 0.0);
                        lowered += usize::from(record.inside < 23.9);
                        all += 1;
                    }
                }
            }
        }
        assert!(
            left_out > all / 20 && lowered > all / 3 && left_out < all,
            "{name}"
        );
    }
    gpu.finish();
}

/// What the device went by, an [`abi::Point`] a vertex.
fn limits_on_device(gpu: &Gpu, loaded: &Loaded<'_>, vertices: usize) -> Vec<abi::Point> {
    let size = (vertices * size_of::<abi::Point>()) as u64;
    let (device, usage) = (gpu.device.raw(), vk::BufferUsageFlags::TRANSFER_DST);
    let location = MemoryLocation::GpuToCpu;
    let from = loaded.surface().limit_buffer().expect("the device decides");
    // SAFETY: all of one live device; the copy is waited for before the buffer is read and goes.
    unsafe {
        let mut memory = gpu.device.memory();
        let copied = Buffer::new(device, &mut memory, "limits", size, usage, location);
        let copied = copied.expect("it is small");
        let copy = vk::BufferCopy::default().size(size);
        let made = gpu.device.submit(|cmd| {
            device.cmd_copy_buffer(cmd, from, copied.raw(), &[copy]);
            Ok(())
        });
        made.expect("it is executed");
        let points = bytemuck::cast_slice(copied.bytes()).to_vec();
        copied.destroy(device, &mut memory);
        points
    }
}

#[test]
fn limits_have_the_same_bits_as_on_the_host_and_edges_one_level_in_all_patches() {
    let Some(gpu) = Gpu::open() else { return };
    let (mut farther, mut shared) = (0, 0);
    for name in ["hull", "ngons", "creased-torus", "pole-66"] {
        let model = shapes::built_in(name);
        let (vertices, radius) = (model.positions(), radius(&model));
        let mut loaded = load(&gpu, &model, options(Residence::Ring));
        loaded.decision.metric = Metric::Distance(0.3 * radius);
        loaded.decision.frustum = true;
        let cut = cut(29.7, Spacing::FractionalEven);
        for view in views(2, radius) {
            picture(&gpu, &mut loaded, cut, view);
            let prepared = loaded.prepared();
            let host = prepared.outline.limits(&vertices).expect("a position each");
            let device = limits_on_device(&gpu, &loaded, vertices.len() + 1);
            let is_used = |vertex: u32| !prepared.outline.star(vertex).is_empty();
            let used = (0u32..)
                .zip(&vertices)
                .filter(|(vertex, _)| is_used(*vertex));
            let around = |[low, high]: [Vec3; 2], (_, place): (u32, &Vec3)| {
                [low.min(*place), high.max(*place)]
            };
            let [low, high] = used.fold([Vec3::MAX, Vec3::MIN], around);
            // Behind them is the box around all.
            let all = device[vertices.len()];
            assert_eq!(
                (all.position, all.normal),
                (low.to_array(), high.to_array())
            );
            for (vertex, (own, right)) in device.iter().zip(&host).enumerate() {
                let [own, right] = [own.position, right.to_array()].map(|p| p.map(f32::to_bits));
                assert!(!is_used(vertex as u32) || own == right, "{name} {vertex}");
                farther += usize::from(host[vertex].distance(vertices[vertex]) > 0.05);
            }
            // Parts of n-gons have whole levels, and what lies within faces is no edge.
            let mut levels = std::collections::HashMap::<u32, u32>::new();
            let edges = prepared.outline.edges().len() as u32;
            for (number, pass) in prepared.passes.iter().enumerate() {
                let decided = loaded.surface().decided(number, 0).iter();
                for ((record, sides), patch) in decided.zip(&pass.sides).zip(&pass.patches) {
                    let whole = abi::PATCH_HALF | (15 * abi::PATCH_EVEN_EDGE);
                    // Nothing is known of what is left out.
                    if patch.flags & whole != 0 || record.inside == 0.0 {
                        continue;
                    }
                    for (&side, level) in sides.iter().zip(record.edges.map(f32::to_bits)) {
                        assert!(side < edges, "{name}");
                        let known = *levels.entry(side).or_insert(level);
                        assert_eq!(known, level, "{name} {side}");
                        shared += 1;
                    }
                }
            }
            shared -= levels.len();
        }
    }
    assert!(farther > 100 && shared > 300, "{farther} {shared}");
    gpu.finish();
}

/// Levels differ from edge to edge and are no whole numbers; where both sides of one have other vertices, a hole is seen, since each vertex with an odd number of
/// bits is drawn elsewhere.
#[test]
fn both_sides_of_every_edge_have_the_same_vertices() {
    let Some(gpu) = Gpu::open() else { return };
    for (name, spacing) in [("hull", Spacing::FractionalEven), ("ngons", Spacing::Equal)] {
        let model = shapes::built_in(name);
        let radius = radius(&model);
        let mut loaded = load(
            &gpu,
            &model,
            SurfaceOptions {
                capture_vertices: 1 << 18,
                ..options(Residence::Ring)
            },
        );
        loaded.decision.metric = Metric::Distance(0.4 * radius);
        loaded.view = through(
            Vec3::new(1.1, 0.4, 0.3) * radius,
            Vec3::ZERO,
            1.2,
            Displacement::default(),
        );
        let cut = cut(17.3, spacing);
        let list = loaded.draw_list(cut).expect("it is a cut");
        let mut ends = std::collections::HashMap::<[[u32; 3]; 2], Vec<Vec<[u32; 3]>>>::new();
        for pass in 0..loaded.prepared().passes.len() {
            let batches: Vec<_> = list
                .batches()
                .filter(|batch| batch.pass() == pass)
                .collect();
            if batches.is_empty() {
                continue;
            }
            let frame = loaded
                .draw(cut, Fill::Discard, &batches)
                .expect("it is executed");
            let mut edges = std::collections::HashMap::<(u32, u8), Vec<(f32, [u32; 3])>>::new();
            for vertex in &frame.passes[0] {
                let ([u, v], at) = (vertex.uv, vertex.position.map(f32::to_bits));
                let sides = [
                    (v == 0.0, 0, u),
                    (u == 1.0, 1, v),
                    (v == 1.0, 2, u),
                    (u == 0.0, 3, v),
                ];
                for (_, side, along) in sides.into_iter().filter(|(on, ..)| *on) {
                    edges
                        .entry((vertex.patch_number, side))
                        .or_default()
                        .push((along, at));
                }
            }
            for mut edge in edges.into_values() {
                edge.sort_by(|a, b| a.0.total_cmp(&b.0));
                let mut edge: Vec<[u32; 3]> = edge.into_iter().map(|(_, at)| at).collect();
                if edge.first() > edge.last() {
                    edge.reverse();
                }
                let key = [edge[0], edge[edge.len() - 1]];
                ends.entry(key).or_default().push(edge);
            }
        }
        let shared: Vec<_> = ends.values().filter(|sides| sides.len() > 1).collect();
        assert!(shared.len() > 20, "{name}: {}", shared.len());
        for sides in shared {
            assert!(
                sides.iter().all(|side| *side == sides[0]),
                "{name}: {sides:?}"
            );
        }
        drop(loaded);
    }
    gpu.finish();
}

/// Decided by one camera, seen by another: what the frozen one does not see is missing.
#[test]
fn a_frozen_view_decides_for_another() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let radius = radius(&model);
    let mut loaded = load(&gpu, &model, options(Residence::Cache));
    let cut = cut(8.0, Spacing::Equal);
    let far = through(
        Vec3::Z * 4.0 * radius,
        Vec3::ZERO,
        0.8,
        Displacement::default(),
    );
    let aside = through(
        Vec3::Z * 2.0 * radius,
        Vec3::X * 3.0 * radius,
        0.5,
        Displacement::default(),
    );
    loaded.decision.frustum = true;
    let (all, _) = picture(&gpu, &mut loaded, cut, far);
    let list = loaded.draw_list(cut).expect("it is a cut");
    let (device, layout) = (gpu.device.raw(), gpu.layout());
    let pipelines = gpu.build(
        loaded.prepared(),
        (Backend::Tessellator, Residence::Cache),
        cut.spacing,
        Fill::Solid(Shading::Patch),
        vk::CompareOp::LESS_OR_EQUAL,
    );
    // SAFETY: all of one live device, in the order that the calls ask for.
    let decide = unsafe {
        let made = DecidePipeline::new(device, layout, vk::PipelineCache::null());
        Owned::new(
            &gpu.device,
            made.expect("the shipped module makes a pipeline"),
        )
    };
    let draw = |seen_from: Option<u32>| {
        // SAFETY: as above.
        let drawn = gpu.device.submit(|cmd| unsafe {
            let surface = loaded.surface();
            let decision = Decision {
                seen_from,
                ..loaded.decision
            };
            surface.cmd_prepare(device, cmd, &[far, aside])?;
            let batch = list.batches().next().expect("there are patches");
            let early = surface.cmd_draw(device, cmd, layout, &pipelines, 0..1, batch);
            assert!(matches!(early, Err(Error::Misuse(Misuse::NotDecided))));
            let decided = Decided {
                views: 0..1,
                eyes: 1,
            };
            surface.cmd_decide(device, cmd, layout, &decide, &list, &decision, &decided)?;
            gpu.target().begin(cmd, [0.0; 4]);
            for batch in list.batches() {
                surface.cmd_draw(device, cmd, layout, &pipelines, 0..1, batch)?;
            }
            gpu.target().end(cmd);
            gpu.target().cmd_copy_to_host(cmd);
            Ok(())
        });
        drawn.expect("it is executed");
        loaded.pixels()
    };
    let covered = |picture: &[u8]| picture.chunks(4).filter(|pixel| pixel[3] != 0).count();
    assert!(draw(None) == all);
    let frozen = draw(Some(1));
    assert!(
        covered(&frozen) < covered(&all) / 2,
        "{} of {}",
        covered(&frozen),
        covered(&all)
    );
    drop((pipelines, decide, loaded));
    gpu.finish();
}

#[test]
fn what_does_not_go_together_with_decisions_of_the_device_is_refused() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("cube");
    let refused = |options: SurfaceOptions| {
        let prepared = prepare(&model, METHODS[0].name);
        let made = gpu.load(&model, prepared, &[], options);
        matches!(
            made.err(),
            Some(Error::Misuse(Misuse::DecidedByDevice { .. }))
        )
    };
    let own = options(Residence::Cache);
    assert!(refused(SurfaceOptions {
        backend: Backend::Pattern,
        ..own
    }));
    assert!(refused(SurfaceOptions {
        count_vertices: true,
        ..own
    }));
    let mut loaded = load(&gpu, &model, options(Residence::Ring));
    let tags = hullform::method::DepthTags::new([1.0; 8]);
    let tagged = loaded
        .surface()
        .draw_list(cut(4.0, Spacing::Equal), Some(&tags));
    assert!(matches!(
        tagged.err(),
        Some(Error::Misuse(Misuse::DecidedByDevice { .. }))
    ));
    for near in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        loaded.decision.metric = Metric::Distance(near);
        let list = loaded.draw_list(cut(4.0, Spacing::Equal)).expect("a cut");
        let batches: Vec<_> = list.batches().collect();
        let drawn = loaded.draw(cut(4.0, Spacing::Equal), Fill::Discard, &batches);
        let error = drawn.err();
        assert!(
            matches!(error, Some(Error::Misuse(Misuse::Measure { .. }))),
            "{error:?}"
        );
    }
    drop(loaded);
    gpu.finish();
}
