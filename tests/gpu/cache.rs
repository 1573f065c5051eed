//! Control points in a pose's cache: the same bits as through the ring, by every back-end, each computed once.

use ash::vk;
use glam::Vec3;
use hullform::gpu::{Backend, CachePipelines, Cut, Fill, Filling, Residence, SurfaceOptions};
use hullform::host::Owned;
use hullform::mesh::{Model, Scheme};
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;

use crate::common;
use crate::common::gpu::{
    Frame, Gpu, Loaded, SPACINGS, bits, capturing, cut, over_patches, prepare,
};
use crate::common::meshes::wild;
use crate::shapes;

fn load<'a>(
    gpu: &'a Gpu,
    model: &Model,
    residence: Residence,
    backend: Backend,
    greatest: Cut,
) -> Loaded<'a> {
    let prepared = prepare(model, "quadtree");
    let options = SurfaceOptions {
        residence,
        backend,
        ..capturing(&prepared, &[greatest])
    };
    let loaded = gpu.load(model, prepared, &gpu.device.info().workarounds, options);
    loaded.expect("what is cached needs no ring")
}

fn assert_same_bits(what: &str, cached: &Frame, ring: &Frame) {
    for (pass, right) in cached.passes.iter().zip(&ring.passes) {
        assert_eq!(pass.len(), right.len(), "{what}");
        let differs = pass.iter().zip(right).find(|(a, b)| bits(a) != bits(b));
        assert!(differs.is_none(), "{what}: {differs:?}");
    }
}

/// Random meshes with creases, corners, boundaries and n-gons; rings that are too long for the vertex shader, and a hub; a model.
fn models() -> Vec<(String, Model)> {
    let mut runner = TestRunner::deterministic();
    let random = (0..12).filter_map(|number| {
        let recipe = wild()
            .new_tree(&mut runner)
            .expect("there are meshes")
            .current();
        let mesh = recipe.mesh().with_scheme(Scheme::CatmullClark).ok()?;
        Some((format!("random {number}"), Model::new(mesh)))
    });
    let built_in =
        ["hull", "ngons", "pole-64", "pole-66"].map(|name| (name.into(), shapes::built_in(name)));
    let shared = common::model("bigguy").map(|mesh| ("bigguy".into(), Model::new(mesh)));
    random.chain(built_in).chain(shared).collect()
}

#[test]
fn cached_points_have_the_bits_of_the_ring() {
    let Some(gpu) = Gpu::open() else { return };
    let mut vertices = 0;
    for (name, model) in models() {
        let greatest = cut(9.0, Spacing::Equal);
        let load = |residence| load(&gpu, &model, residence, Backend::Tessellator, greatest);
        let [mut ring, mut cached] = Residence::ALL.map(load);
        // The cache has what the deepest needs when the others are drawn.
        for level in [9.0, 5.0, 2.5, 1.0] {
            for cut in SPACINGS.map(|spacing| cut(level, spacing)) {
                let [right, own] = [&mut ring, &mut cached]
                    .map(|loaded| loaded.capture(cut, Fill::Discard).expect("it is drawn"));
                assert_same_bits(&format!("{name} {cut:?}"), &own, &right);
                assert_eq!(own.counters.points, 0, "no control shader computes any");
                vertices += own.passes.iter().map(Vec::len).sum::<usize>();
            }
        }
    }
    assert!(vertices > 200_000, "{vertices}");
    gpu.finish();
}

/// Where all have a vertex, at levels that are powers of two.
#[test]
fn patterns_and_geometry_shaders_draw_irregular_faces_from_the_cache() {
    let Some(gpu) = Gpu::open() else { return };
    let mut compared = 0;
    for (name, model) in models() {
        let cut = cut(4.0, Spacing::Equal);
        let draw = |backend| {
            let mut loaded = load(&gpu, &model, Residence::Cache, backend, cut);
            loaded.capture(cut, Fill::Discard).expect("it is drawn")
        };
        let right = draw(Backend::Tessellator);
        for backend in [Backend::Pattern, Backend::Geometry] {
            let own = draw(backend);
            for (own, right) in own.passes.iter().zip(&right.passes) {
                let place = |v: &hullform::abi::Captured| (v.patch_number, v.uv.map(f32::to_bits));
                let known: std::collections::HashMap<_, _> = right
                    .iter()
                    .map(|vertex| (place(vertex), bits(vertex)))
                    .collect();
                for vertex in own {
                    if let Some(right) = known.get(&place(vertex)) {
                        assert_eq!(&bits(vertex), right, "{name} {backend:?}");
                        compared += 1;
                    }
                }
            }
        }
    }
    assert!(compared > 50_000, "{compared}");
    gpu.finish();
}

#[test]
fn what_did_not_move_is_not_computed_again() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let deep = cut(8.0, Spacing::Equal);
    let shallow = cut(2.0, Spacing::Equal);
    let mut loaded = load(&gpu, &model, Residence::Cache, Backend::Tessellator, deep);
    let cached = loaded.prepared().cached_points(3);
    let [few, all] = [1, 3].map(|level| cached.count(level));
    // Faces share most of their points.
    let prepared = loaded.prepared();
    let each = over_patches(prepared, |pass, patch| {
        deep.points(&prepared.passes[pass], patch)
    });
    assert!(0 < few && few < all && 2 * all < each, "{few} {all} {each}");
    let lists = [shallow, deep].map(|cut| loaded.surface().draw_list(cut, None).expect("a cut"));
    // Each level as it is needed, and no deeper one.
    assert_eq!(loaded.cache(&lists[0]).expect("there is room"), few);
    assert_eq!(loaded.cache(&lists[0]).expect("there is room"), 0);
    assert_eq!(loaded.cache(&lists[1]).expect("there is room"), all - few);
    assert_eq!(loaded.cache(&lists[0]).expect("there is room"), 0);
    let before = loaded.capture(deep, Fill::Discard).expect("it is drawn");

    // What moves is computed again, by the positions that it has then.
    let moved: Vec<[f32; 3]> = model
        .positions()
        .iter()
        .map(|position| (*position * Vec3::new(1.0, 1.5, 0.5)).to_array())
        .collect();
    loaded
        .replace_positions(&moved)
        .expect("one a control vertex");
    assert_eq!(loaded.cache(&lists[1]).expect("there is room"), all);
    let own = loaded.capture(deep, Fill::Discard).expect("it is drawn");
    let mut ring = load(&gpu, &model, Residence::Ring, Backend::Tessellator, deep);
    ring.replace_positions(&moved)
        .expect("one a control vertex");
    let right = ring.capture(deep, Fill::Discard).expect("it is drawn");
    assert_same_bits("moved", &own, &right);
    let same = own
        .passes
        .iter()
        .flatten()
        .zip(before.passes.iter().flatten());
    assert!(same.filter(|(a, b)| bits(a) != bits(b)).count() > 1000);
    drop(ring);
    drop(loaded);
    gpu.finish();
}

/// What takes long is computed in slices, each of which is submitted by itself.
#[test]
fn a_cache_that_is_filled_in_slices_has_the_same_bits_and_each_point_once() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let [deep, shallow] = [8.0, 2.0].map(|level| cut(level, Spacing::Equal));
    let mut loaded = load(&gpu, &model, Residence::Cache, Backend::Tessellator, deep);
    let [deep_list, shallow_list] =
        [deep, shallow].map(|cut| loaded.surface().draw_list(cut, None).expect("a cut"));
    let (device, layout, cache) = (gpu.device.raw(), gpu.layout(), vk::PipelineCache::null());
    let all = loaded.surface().uncached(&deep_list);
    // SAFETY: all of one live device.
    let pipelines = unsafe { CachePipelines::new(device, layout, cache, loaded.prepared()) };
    // SAFETY: as above; they were just made.
    let pipelines = unsafe { Owned::new(&gpu.device, pipelines.expect("its method has a cache")) };
    let (mut sum, most) = (0, 777);
    // The deeper levels are asked for while those of the other list are not whole.
    for list in std::iter::once(&shallow_list).chain(std::iter::repeat(&deep_list)) {
        let left = loaded.surface().uncached(list);
        assert_eq!(left == 0, loaded.surface().is_cached(list));
        if left == 0 {
            break;
        }
        let mut points = 0;
        let fill = Filling { list, most };
        let filled = gpu.device.submit(|cmd| {
            let surface = loaded.surface_mut();
            // SAFETY: recording on the device that made everything, outside of a render pass.
            points = unsafe {
                surface.cmd_upload(device, cmd);
                surface.cmd_cache_some(device, cmd, layout, &pipelines, fill)
            }?;
            Ok(())
        });
        filled.expect("there is room");
        assert_eq!(points, left.min(most));
        assert_eq!(loaded.surface().uncached(list), left - points);
        sum += points;
    }
    assert!(sum == all && all > 3 * most, "{sum} of {all}");
    let own = loaded.capture(deep, Fill::Discard).expect("it is drawn");
    let mut whole = load(&gpu, &model, Residence::Cache, Backend::Tessellator, deep);
    let right = whole.capture(deep, Fill::Discard).expect("it is drawn");
    assert_same_bits("in slices", &own, &right);
    drop((whole, loaded, pipelines));
    gpu.finish();
}

#[test]
fn what_is_not_cached_is_not_drawn() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let deep = cut(8.0, Spacing::Equal);
    let mut loaded = load(&gpu, &model, Residence::Cache, Backend::Tessellator, deep);
    let list = loaded.surface().draw_list(deep, None).expect("a cut");
    let batches: Vec<_> = list.batches().take(1).collect();
    let not_cached =
        |result: hullform::Result<Frame>| matches!(result, Err(Error::Misuse(Misuse::NotCached)));
    assert!(not_cached(loaded.draw(deep, Fill::Discard, &batches)));
    loaded.cache(&list).expect("there is room");
    assert!(loaded.draw(deep, Fill::Discard, &batches).is_ok());
    loaded.surface_mut().positions_changed();
    assert!(not_cached(loaded.draw(deep, Fill::Discard, &batches)));

    // A pose that was made for a ring has no cache.
    let mut ring = load(&gpu, &model, Residence::Ring, Backend::Tessellator, deep);
    let own = ring.surface().draw_list(deep, None).expect("a cut");
    assert_eq!(ring.cache(&own).expect("there is nothing to do"), 0);
    let (device, layout, cache) = (gpu.device.raw(), gpu.layout(), vk::PipelineCache::null());
    // SAFETY: all of one live device; nothing is recorded.
    let refused = unsafe {
        let pipelines = CachePipelines::new(device, layout, cache, ring.prepared());
        let pipelines = Owned::new(&gpu.device, pipelines.expect("its method has a cache"));
        gpu.device.submit(|cmd| {
            let surface = ring.surface_mut();
            surface.cmd_cache(device, cmd, layout, &pipelines, &own)
        })
    };
    assert!(matches!(refused, Err(Error::Misuse(Misuse::NotCached))));
    drop(ring);
    drop(loaded);
    gpu.finish();
}
