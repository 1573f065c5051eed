//! What the driver counts, against what was predicted.

use hullform::abi;
use hullform::gpu::{Cut, Fill, Shading};
use hullform::mesh::{Model, builtin};
use hullform::method::{METHODS, Pass, Prepared};

use crate::common::gpu::{Gpu, Loaded, SPACINGS, capturing, cut, over_patches, prepare, vertices};
use crate::shapes;

/// One patch a face that the scheme takes whole, or four where the method refines first, and one a corner of other faces; none in holes. Where faces are in
/// pieces, all that there are; where a frame decides how deep is refined, of each pass those from the first that is drawn to the last.
fn patches(model: &Model, prepared: &Prepared, cut: Cut) -> u64 {
    if prepared.is_dynamic() {
        let of_pass = |pass: &Pass| {
            let all = 0..pass.patches.len();
            let mut drawn = all.filter(|&patch| cut.levels(pass, patch).is_some());
            let first = drawn.next();
            first.map_or(0, |first| drawn.next_back().unwrap_or(first) - first + 1)
        };
        return prepared.passes.iter().map(of_pass).sum::<usize>() as u64;
    }
    let mut all = prepared.passes.iter().flat_map(|pass| &pass.patches);
    if all
        .clone()
        .any(|patch| patch.flags >> abi::PATCH_CHILD_SHIFT & 15 == abi::CHILD_PIECE)
    {
        return all.count() as u64;
    }
    let refined = all.any(|patch| patch.flags & abi::PATCH_REFINED != 0);
    let scheme = model.mesh().options().scheme;
    let faces = model.mesh().faces().enumerate();
    let drawn = faces.filter(|&(face, _)| !model.topology().is_hole(face as u32));
    drawn
        .map(|(_, vertices)| match vertices.len() {
            n if scheme.is_whole(n) => 1 + 3 * u64::from(refined),
            n => n as u64,
        })
        .sum()
}

/// Draws at a cut and compares patches, evaluations, triangles and points with their prediction.
fn assert_predicted(name: &str, model: &Model, loaded: &mut Loaded<'_>, cut: Cut) {
    let frame = loaded
        .capture(cut, Fill::Solid(Shading::Patch))
        .expect("it is drawn");
    let prepared = loaded.prepared();
    let points = over_patches(prepared, |pass, patch| {
        cut.points(&prepared.passes[pass], patch)
    });
    assert_eq!(frame.counters.overflows, 0);
    assert_eq!(frame.counters.points, points, "{name} {cut:?}: points");
    let triangles = over_patches(prepared, |pass, patch| {
        let levels = cut.levels(&prepared.passes[pass], patch);
        levels.map_or(0, |levels| levels.triangles(cut.spacing))
    });
    let predicted = [
        patches(model, prepared, cut),
        u64::from(vertices(prepared, cut)),
        u64::from(triangles),
    ];
    match frame.statistics {
        Some(counted) => assert_eq!(
            counted, predicted,
            "{name} {cut:?}: patches, evaluations, triangles"
        ),
        None => println!("not counted: this device has no pipeline statistics"),
    }
}

#[test]
fn the_drivers_counts_are_the_predicted_ones() {
    let Some(gpu) = Gpu::open() else { return };
    let workarounds = &gpu.device.info().workarounds;
    let levels = [1.0, 2.0, 3.0, 4.0, 7.0, 16.0];
    let cuts = levels.map(|level| SPACINGS.map(|spacing| cut(level, spacing)));
    for name in ["cube", "ngons", "sheet", "creased-torus", "hull", "pole-64"] {
        let whole = shapes::built_in(name);
        for method in METHODS {
            let model =
                shapes::under(whole.mesh(), method.schemes[0]).expect("the scheme knows its tags");
            if method.check_model(&model).is_err() {
                continue;
            }
            let prepared = prepare(&model, method.name);
            let options = capturing(&prepared, cuts.as_flattened());
            let loaded = gpu.load(&model, prepared, workarounds, options);
            let mut loaded = loaded.expect("the ring holds a patch");
            for &cut in cuts.as_flattened() {
                assert_predicted(name, &model, &mut loaded, cut);
            }
        }
    }
    gpu.finish();
}

#[test]
fn a_mesh_of_regular_faces_needs_no_ring() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::torus();
    let prepared = prepare(&model, "quadtree");
    let shaders: Vec<&str> = prepared.passes.iter().map(|pass| pass.shader).collect();
    assert_eq!(shaders, ["quadtree_regular"]);
    let options = hullform::gpu::SurfaceOptions {
        ring_bytes: 16,
        ..capturing(&prepared, &[cut(8.0, SPACINGS[0])])
    };
    let loaded = gpu.load(&model, prepared, &gpu.device.info().workarounds, options);
    let mut loaded = loaded.expect("no patch needs the ring");
    let frame = loaded.capture(cut(8.0, SPACINGS[0]), Fill::Solid(Shading::Patch));
    let frame = frame.expect("it is drawn");
    assert_eq!(frame.counters, Default::default());
    assert_eq!(frame.passes[0].len(), 40 * 81);
    assert!(loaded.pixels().iter().any(|&byte| byte != 0));
    drop(loaded);
    gpu.finish();
}

#[test]
fn a_mesh_without_regular_faces_has_one_pass() {
    let prepared = prepare(&shapes::built_in("cube"), "quadtree");
    let shaders: Vec<&str> = prepared.passes.iter().map(|pass| pass.shader).collect();
    assert_eq!(shaders, ["quadtree"]);
    assert_eq!(prepared.passes[0].patches.len(), 6);
}

#[test]
fn holes_are_not_drawn() {
    let Some(gpu) = Gpu::open() else { return };
    let whole = builtin("cube").expect("it is built in");
    let sizes = [4; 6];
    let faces: Vec<u32> = whole.faces().flatten().copied().collect();
    let positions: Vec<[f64; 3]> = whole.positions().iter().map(|p| p.to_array()).collect();
    let mesh = hullform::mesh::ControlMesh::builder(&positions, &sizes, &faces).hole(3);
    let mesh = mesh.build().expect("a cube with a hole is sound");
    let at = cut(4.0, SPACINGS[0]);
    for method in METHODS {
        let model = shapes::under(&mesh, method.schemes[0]).expect("it has no tags");
        let prepared = prepare(&model, method.name);
        let options = capturing(&prepared, &[at]);
        let loaded = gpu.load(&model, prepared, &gpu.device.info().workarounds, options);
        let mut loaded = loaded.expect("the ring holds a patch");
        assert_predicted("cube with a hole", &model, &mut loaded, at);
        let frame = loaded.capture(at, Fill::Discard).expect("it is drawn");
        let patches = &loaded.prepared().passes[0].patches;
        let faces = frame.passes[0]
            .iter()
            .map(|vertex| patches[vertex.patch_number as usize].ptex);
        let faces: std::collections::BTreeSet<u32> = faces.collect();
        // A face of the cube is two triangles where the scheme takes nothing else.
        let parts = (model.mesh().face_count() / 6) as u32;
        let faces: Vec<u32> = faces.into_iter().map(|face| face / parts).collect();
        let drawn: Vec<u32> = [0, 1, 2, 4, 5]
            .iter()
            .flat_map(|&f| vec![f; parts as usize])
            .collect();
        assert_eq!(faces, drawn);
    }
    gpu.finish();
}
