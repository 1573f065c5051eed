//! Refinement patterns and geometry shaders, and depth tags on random meshes. That all backends draw the same bits is the suite's
//! (`hullform::conformance::backends`).

use std::collections::BTreeSet;

use ash::vk;
use glam::Vec3;
use hullform::conformance::backends::Drawn;
use hullform::conformance::{Context, Settings};
use hullform::gpu::{Backend, Cut, Fill, Residence, Shading, SurfaceOptions};
use hullform::mesh::{Model, Scheme, builtin};
use hullform::method::{DepthTags, METHODS, Method, Prepared};
use hullform::plan::PlanOptions;
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse, abi};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;

use crate::common::gpu::{Gpu, Loaded, SPACINGS, capturing, cut};
use crate::common::meshes::{manifold, scatter};
use crate::shapes;

/// What methods make of a model that a backend can draw.
fn drawable<'a>(
    model: &'a Model,
    backend: Backend,
) -> impl Iterator<Item = (&'static Method, Prepared)> + 'a {
    let able = METHODS
        .iter()
        .filter(|method| method.check_model(model).is_ok());
    let prepared = able.map(|method| {
        let prepared = method.prepare(model, PlanOptions::default());
        (method, prepared.expect("it was checked"))
    });
    prepared.filter(move |(_, prepared)| backend.check(prepared, Residence::Ring, 1.0).is_ok())
}

fn load<'a>(
    gpu: &'a Gpu,
    model: &Model,
    prepared: Prepared,
    backend: Backend,
    cut: Cut,
) -> Loaded<'a> {
    let options = SurfaceOptions {
        backend,
        ..capturing(&prepared, &[cut])
    };
    let workarounds = &gpu.device.info().workarounds;
    gpu.load(model, prepared, workarounds, options)
        .expect("it can be drawn")
}

#[test]
fn patterns_are_n_times_4_to_the_depth_triangles() {
    let Some(gpu) = Gpu::open() else { return };
    let mesh = builtin("pole-7").expect("built in");
    let model = shapes::under(&mesh, Scheme::Loop).expect("it has no tags");
    let faces = model.topology().face_count() as u64;
    for backend in [Backend::Pattern, Backend::Geometry] {
        for depth in 0..=6u32 {
            let cut = cut((1 << depth) as f32, Spacing::Equal);
            for (method, prepared) in drawable(&model, backend) {
                // What is refined first has four patches a face, of a triangle each at least.
                let patches = prepared.passes.iter().flat_map(|pass| &pass.patches);
                let refined = patches
                    .clone()
                    .any(|patch| patch.flags & abi::PATCH_REFINED != 0);
                if backend
                    .check(&prepared, Residence::Ring, cut.level)
                    .is_err()
                    || refined && depth == 0
                {
                    continue;
                }
                let mut loaded = load(&gpu, &model, prepared, backend, cut);
                let frame = loaded
                    .capture(cut, Fill::Solid(Shading::Patch))
                    .expect("it is drawn");
                let Some([_, _, triangles]) = frame.statistics else {
                    return;
                };
                let what = format!("{} {backend:?} {depth}", method.name);
                assert_eq!(triangles, faces << (2 * depth), "{what}");
            }
        }
    }
    gpu.finish();
}

#[test]
fn pictures_of_all_backends_are_alike() {
    let Some(gpu) = Gpu::open() else { return };
    let mesh = builtin("pole-7").expect("built in");
    let model = shapes::under(&mesh, Scheme::Loop).expect("it has no tags");
    let cut = cut(16.0, Spacing::Equal);
    for (method, prepared) in drawable(&model, Backend::Geometry) {
        let pictures = Backend::ALL.map(|backend| {
            let mut loaded = load(&gpu, &model, prepared.clone(), backend, cut);
            loaded
                .capture(cut, Fill::Solid(Shading::Patch))
                .expect("it is drawn");
            loaded.pixels()
        });
        for other in &pictures[1..] {
            let pairs = pictures[0].chunks(4).zip(other.chunks(4));
            let far = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 8);
            let differing = pairs.filter(far).count();
            assert!(
                differing * 100 < pictures[0].len() / 4,
                "{}: {differing}",
                method.name
            );
        }
        assert!(pictures[0].chunks(4).any(|pixel| pixel[3] > 0));
    }
    gpu.finish();
}

/// Of a closed surface one sees the front alone.
#[test]
fn the_front_is_where_faces_are_counter_clockwise() {
    let Some(gpu) = Gpu::open() else { return };
    let cut = cut(8.0, Spacing::Equal);
    for name in ["cube", "ngons"] {
        let model = shapes::built_in(name);
        for backend in Backend::ALL {
            for (method, prepared) in drawable(&model, backend) {
                let [all, front, back] = [
                    vk::CullModeFlags::NONE,
                    vk::CullModeFlags::BACK,
                    vk::CullModeFlags::FRONT,
                ]
                .map(|cull| {
                    let mut loaded = load(&gpu, &model, prepared.clone(), backend, cut);
                    loaded.cull = cull;
                    let picture = loaded.picture(cut, Fill::Solid(Shading::Patch));
                    picture.expect("it is drawn").to_vec()
                });
                let differing = |a: &[u8], b: &[u8]| {
                    let pairs = a.chunks(4).zip(b.chunks(4));
                    pairs.filter(|(a, b)| a != b).count()
                };
                let drawn = all.chunks(4).filter(|pixel| pixel[3] > 0).count();
                let what = format!("{name} {} {backend:?}", method.name);
                assert!(differing(&all, &front) * 50 < drawn, "{what}");
                assert!(differing(&all, &back) * 2 > drawn, "{what}");
            }
        }
    }
    gpu.finish();
}

#[test]
fn what_a_backend_cannot_do_is_refused() {
    let Some(gpu) = Gpu::open() else { return };
    let refused = |model: &Model, method: &Method, backend, level| {
        let prepared = method
            .prepare(model, PlanOptions::default())
            .expect("sound");
        let options = SurfaceOptions {
            backend,
            greatest_level: level,
            ..SurfaceOptions::default()
        };
        let workarounds = &gpu.device.info().workarounds;
        match gpu.load(model, prepared, workarounds, options) {
            Err(Error::Misuse(misuse)) => Some(misuse),
            _ => None,
        }
    };
    let cube = shapes::built_in("cube");
    let flat = METHODS.last().expect("there are methods");
    let ring = &METHODS[0];
    for backend in [Backend::Pattern, Backend::Geometry] {
        let misuse = refused(&cube, ring, backend, 8.0);
        assert!(matches!(misuse, Some(Misuse::BackendWithoutRing { .. })));
    }
    let misuse = refused(&cube, flat, Backend::Geometry, 33.0);
    assert!(matches!(misuse, Some(Misuse::BackendLevel { .. })));
    assert_eq!(refused(&cube, flat, Backend::Geometry, 32.0), None);
    assert_eq!(refused(&cube, flat, Backend::Pattern, 64.0), None);
    // Regular faces need no ring.
    assert_eq!(
        refused(&shapes::torus(), ring, Backend::Pattern, 64.0),
        None
    );
    gpu.finish();
}

/// As tags grow past a level where the tessellator adds vertices, none appears far from the vertices that were there before. (Beside n-gons,
/// whose halves of edges must have half the segments, levels go in steps.)
#[test]
fn tags_that_grow_a_little_move_the_surface_a_little() {
    let Some(gpu) = Gpu::open() else { return };
    let mesh = builtin("pole-7").expect("built in");
    let model = shapes::under(&mesh, Scheme::Loop).expect("it has no tags");
    let cut = cut(64.0, Spacing::FractionalEven);
    let diagonal = model.diagonal() as f32;
    {
        let (_, prepared) = drawable(&model, Backend::Tessellator)
            .next()
            .expect("some do");
        let mut loaded = load(&gpu, &model, prepared, Backend::Tessellator, cut);
        let mut at = |depth: f32| {
            let count = model.mesh().vertex_count();
            let tags = (0..count).map(|vertex| depth + 0.3 * (vertex % 3) as f32);
            loaded.tags = Some(DepthTags::new(tags));
            let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
            frame.passes.concat()
        };
        let mut counts = BTreeSet::new();
        for step in 0..12 {
            let depth = 1.5 + 0.1 * step as f32;
            let (before, after) = (at(depth), at(depth + 1e-4));
            counts.insert(after.len());
            for vertex in &after {
                let nearest = before
                    .iter()
                    .filter(|other| other.patch_number == vertex.patch_number)
                    .map(|other| Vec3::from(other.position).distance(vertex.position.into()))
                    .fold(f32::INFINITY, f32::min);
                assert!(nearest < 1e-3 * diagonal, "{depth}: {nearest} {vertex:?}");
            }
        }
        assert!(counts.len() > 3, "vertices were added: {counts:?}");
    }
    gpu.finish();
}

/// Triangles of different faces can have the same diagonal.
fn is_manifold(model: &Model) -> bool {
    let topology = model.topology();
    let mut edges = 0..topology.edge_count() as u32;
    edges.all(|edge| topology.edge_faces(edge).len() <= 2)
}

#[test]
fn depth_tags_leave_no_crack_in_random_meshes() {
    let Some(gpu) = Gpu::open() else { return };
    gpu.finish();
    let settings = Settings {
        validation: true,
        ..Settings::default()
    };
    let context = Context::new(settings, Vec::new());
    let mut runner = TestRunner::deterministic();
    let mut looked_at = 0;
    for number in 0..40 {
        let recipe = manifold().new_tree(&mut runner);
        let mesh = recipe.expect("recipes are not filtered").current().mesh();
        let scheme = Scheme::ALL[number % Scheme::ALL.len()];
        let model = shapes::under(&mesh, scheme).filter(is_manifold);
        let Some(model) = model else { continue };
        let (backend, spacing) = (Backend::ALL[number % 3], SPACINGS[number % 2]);
        let cut = cut(16.0, spacing);
        let tags = (0..model.mesh().vertex_count() as u64)
            .map(|vertex| 2.0 + 3.0 * scatter(1000 * number as u64 + vertex).x as f32);
        let tags = DepthTags::new(tags);
        let whole = drawable(&model, backend).filter(|(method, _)| method.contract.watertight);
        for (method, prepared) in whole {
            let drawn = Drawn::new(&context, &model, prepared, backend, Some(tags.clone()), cut);
            let drawn = drawn.expect("it is drawn");
            let what = format!("{number} {scheme} {} {backend:?} {spacing:?}", method.name);
            assert_eq!(drawn.open_edges(), drawn.boundary, "{what}");
            looked_at += 1;
        }
    }
    assert!(looked_at > 20, "{looked_at}");
    let messages = context.validation_messages();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
}
