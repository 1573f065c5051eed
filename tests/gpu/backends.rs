//! Tessellator, refinement patterns and geometry shader draw one surface, and depth tags leave it whole.

use std::collections::{BTreeMap, HashMap};

use hullform::Error;
use hullform::abi::Captured;
use hullform::gpu::{Backend, Cut, Fill, SurfaceOptions};
use hullform::mesh::{Model, Scheme, builtin};
use hullform::method::{DepthTags, METHODS, Method, Prepared};
use hullform::plan::PlanOptions;
use hullform::tessellation::Spacing;

use crate::common::gpu::{Frame, Gpu, Loaded, bits, capturing, cut};
use crate::common::meshes::scatter;
use crate::precision::from_twin;
use crate::shapes;

/// Built-in shapes under every scheme, for methods of all of them.
fn models() -> Vec<(String, Model)> {
    let named = ["cube", "ngons", "sheet", "cubes-2x1x1", "pole-7"].into_iter();
    let under = named.flat_map(|name| {
        let mesh = builtin(name).expect("built in");
        let schemes = Scheme::ALL.into_iter();
        schemes.filter_map(move |scheme| {
            Some((format!("{name} {scheme}"), shapes::under(&mesh, scheme)?))
        })
    });
    under.collect()
}

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
    prepared.filter(move |(_, prepared)| backend.check(prepared, 1.0).is_ok())
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

/// What was captured, by pass, patch and place.
fn by_place(frame: &Frame) -> HashMap<(usize, u32, [u32; 2]), &Captured> {
    let passes = frame.passes.iter().enumerate();
    let all = passes.flat_map(|(pass, vertices)| {
        let place = move |v: &Captured| (pass, v.patch_number, v.uv.map(f32::to_bits));
        vertices.iter().map(move |vertex| (place(vertex), vertex))
    });
    all.collect()
}

#[test]
fn all_backends_draw_the_same_bits() {
    let Some(gpu) = Gpu::open() else { return };
    let cut = cut(8.0, Spacing::Equal);
    let mut compared = 0;
    for (name, model) in models() {
        for backend in [Backend::Pattern, Backend::Geometry] {
            for (method, prepared) in drawable(&model, backend) {
                let mut other = load(&gpu, &model, prepared.clone(), Backend::Tessellator, cut);
                let reference = other.capture(cut, Fill::Discard).expect("it is drawn");
                let reference = by_place(&reference);
                let mut loaded = load(&gpu, &model, prepared, backend, cut);
                let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
                let what = format!("{name} {} {backend:?}", method.name);
                let worst = from_twin(&model, loaded.prepared(), &frame, 1);
                assert!(worst.position <= 1e-6, "{what}: {worst:?}");
                let own = by_place(&frame);
                let expected: u32 = (0..)
                    .zip(&loaded.prepared().passes)
                    .map(|(number, pass)| {
                        let patches = 0..pass.patches.len() as u32;
                        let surface = loaded.surface();
                        patches
                            .map(|patch| surface.vertices(cut, number, patch))
                            .sum::<u32>()
                    })
                    .sum();
                assert_eq!(own.len() as u32, expected, "{what}: no vertex is missing");
                for (place, vertex) in own {
                    // Inside of triangles the tessellator has other points.
                    let Some(same) = reference.get(&place) else {
                        continue;
                    };
                    assert_eq!(bits(vertex), bits(same), "{what}: {vertex:?} {same:?}");
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} vertices have the same bits");
    assert!(compared > 10_000, "{compared}");
    gpu.finish();
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
                if backend.check(&prepared, cut.level).is_err()
                    || method.name == "bft" && depth == 0
                {
                    continue;
                }
                let mut loaded = load(&gpu, &model, prepared, backend, cut);
                let frame = loaded.capture(cut, Fill::Solid).expect("it is drawn");
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
            loaded.capture(cut, Fill::Solid).expect("it is drawn");
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
            Err(Error::Option { option, .. }) => Some(option),
            _ => None,
        }
    };
    let cube = shapes::built_in("cube");
    let flat = METHODS.last().expect("there are methods");
    let ring = &METHODS[0];
    assert_eq!(
        refused(&cube, ring, Backend::Pattern, 8.0),
        Some("--backend")
    );
    assert_eq!(
        refused(&cube, ring, Backend::Geometry, 8.0),
        Some("--backend")
    );
    assert_eq!(
        refused(&cube, flat, Backend::Geometry, 33.0),
        Some("--level")
    );
    assert_eq!(refused(&cube, flat, Backend::Geometry, 32.0), None);
    assert_eq!(refused(&cube, flat, Backend::Pattern, 64.0), None);
    // Regular faces need no ring.
    assert_eq!(
        refused(&shapes::torus(), ring, Backend::Pattern, 64.0),
        None
    );
    gpu.finish();
}

/// The edges of triangles that have no partner with the same two positions, bit by bit.
fn open_edges(loaded: &Loaded<'_>, frame: &Frame, cut: Cut) -> usize {
    let mut edges: BTreeMap<[[u32; 3]; 2], i64> = BTreeMap::new();
    for (pass, vertices) in frame.passes.iter().enumerate() {
        for of_patch in vertices.chunk_by(|a, b| a.patch_number == b.patch_number) {
            let uv: Vec<[f32; 2]> = of_patch.iter().map(|vertex| vertex.uv).collect();
            let patch = of_patch[0].patch_number;
            for triangle in loaded.surface().triangles(cut, pass, patch, &uv) {
                let at = triangle.map(|i| of_patch[i as usize].position.map(f32::to_bits));
                for [a, b] in [[at[0], at[1]], [at[1], at[2]], [at[2], at[0]]] {
                    let (key, way) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
                    if a != b {
                        *edges.entry(key).or_default() += way;
                    }
                }
            }
        }
    }
    edges.values().filter(|&&sum| sum != 0).count()
}

fn is_closed(model: &Model) -> bool {
    let topology = model.topology();
    let holes = (0..topology.face_count() as u32).any(|face| topology.is_hole(face));
    let mut edges = 0..topology.edge_count() as u32;
    !holes && edges.all(|edge| topology.edge_faces(edge).len() == 2)
}

#[test]
fn depth_tags_leave_no_crack() {
    let Some(gpu) = Gpu::open() else { return };
    let mut looked_at = 0;
    for (name, model) in models().into_iter().filter(|(_, model)| is_closed(model)) {
        let count = model.mesh().vertex_count() as u64;
        for backend in Backend::ALL {
            for spacing in [Spacing::Equal, Spacing::FractionalEven] {
                if backend != Backend::Tessellator && spacing != Spacing::Equal {
                    continue;
                }
                let cut = cut(16.0, spacing);
                for (method, prepared) in drawable(&model, backend) {
                    if !method.contract.watertight {
                        continue;
                    }
                    let mut loaded = load(&gpu, &model, prepared, backend, cut);
                    for seed in 0..2 {
                        // Between 0 and 4, and some beyond.
                        let depth = |vertex| 2.0 + 3.0 * scatter(seed * 1000 + vertex).x as f32;
                        loaded.tags = Some(DepthTags::new((0..count).map(depth)));
                        let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
                        let what = format!("{name} {} {backend:?} {spacing:?}", method.name);
                        assert_eq!(open_edges(&loaded, &frame, cut), 0, "{what}");
                        let worst = from_twin(&model, loaded.prepared(), &frame, 7);
                        assert!(worst.position <= 1e-6, "{what}: {worst:?}");
                        let levels = loaded.surface().levels(cut, 0, 0);
                        assert!(levels.greatest() <= 16.0, "{what}");
                        looked_at += 1;
                    }
                }
            }
        }
    }
    assert!(looked_at > 20, "{looked_at}");
    gpu.finish();
}

/// With whole levels a tag of its own for one vertex must show: a test that could not fail would pass this too.
#[test]
fn levels_that_do_not_agree_open_edges() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("cube");
    let cut = cut(8.0, Spacing::Equal);
    let mut prepared = METHODS[0]
        .prepare(&model, PlanOptions::default())
        .expect("sound");
    // One patch takes an edge for another.
    let sides = &mut prepared.passes[0].sides[0];
    sides[0] = sides[2];
    let mut loaded = load(&gpu, &model, prepared, Backend::Tessellator, cut);
    loaded.tags = Some(DepthTags::new((0..8).map(|vertex| vertex as f32 * 0.4)));
    let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
    assert!(open_edges(&loaded, &frame, cut) > 0);
    drop(loaded);
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
    let diagonal = crate::common::diagonal(model.mesh()) as f32;
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
        let mut counts = std::collections::BTreeSet::new();
        for step in 0..12 {
            let depth = 1.5 + 0.1 * step as f32;
            let (before, after) = (at(depth), at(depth + 1e-4));
            counts.insert(after.len());
            for vertex in &after {
                let nearest = before
                    .iter()
                    .filter(|other| other.patch_number == vertex.patch_number)
                    .map(|other| glam::Vec3::from(other.position).distance(vertex.position.into()))
                    .fold(f32::INFINITY, f32::min);
                assert!(nearest < 1e-3 * diagonal, "{depth}: {nearest} {vertex:?}");
            }
        }
        assert!(counts.len() > 3, "vertices were added: {counts:?}");
    }
    gpu.finish();
}
