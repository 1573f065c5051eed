//! No cracks between faces: both sides of an edge have the same vertices, bit by bit.

use glam::Vec3;
use hullform::gpu::{Cut, Fill};
use hullform::mesh::Model;
use hullform::method::{Displacement, METHODS, Prepared};
use hullform::plan::PlanOptions;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;

use crate::common::edges::{Compared, Sample, Shared};
use crate::common::gpu::{Frame, Gpu, SPACINGS, capturing, cut};
use crate::common::meshes::{manifold, wild};
use crate::shapes;

/// Asserts that all that is shared has the same bits.
fn hold(what: &str, model: &Model, prepared: &Prepared, frame: &Frame) -> Compared {
    let mut shared = Shared::new(model);
    for (pass, vertices) in prepared.passes.iter().zip(&frame.passes) {
        for vertex in vertices {
            let sample = Sample {
                patch: vertex.patch_number,
                uv: vertex.uv,
                position: vertex.position.into(),
                normal: vertex.normal.into(),
            };
            shared.add(pass, sample);
        }
    }
    shared.hold(what)
}

/// Draws a model at many cuts with every method that promises to be watertight.
fn hold_all(gpu: &Gpu, name: &str, model: &Model, levels: &[f32]) -> Compared {
    let cuts: Vec<Cut> = levels
        .iter()
        .flat_map(|&level| SPACINGS.map(|spacing| cut(level, spacing)))
        .collect();
    let mut compared = Compared::default();
    for method in METHODS.iter().filter(|method| method.contract.watertight) {
        let prepared = method
            .prepare(model, PlanOptions::default())
            .expect("sound options");
        let options = capturing(&prepared, &cuts);
        let workarounds = &gpu.device.info().workarounds;
        let loaded = gpu.load(model, prepared, workarounds, options);
        let mut loaded = loaded.expect("the ring holds a patch");
        for &cut in &cuts {
            let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
            let what = format!("{name} {} {cut:?}", method.name);
            let Compared { positions, normals } = hold(&what, model, loaded.prepared(), &frame);
            compared.positions += positions;
            compared.normals += normals;
        }
    }
    compared
}

/// Plans that go less deep than the level asks for bound all patches alike, regular ones too.
#[test]
fn shallow_plans_leave_no_t_junctions() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let options = PlanOptions {
        max_level: 2,
        ..PlanOptions::default()
    };
    let prepared = METHODS[0].prepare(&model, options).expect("sound options");
    let cuts = SPACINGS.map(|spacing| cut(8.0, spacing));
    let workarounds = &gpu.device.info().workarounds;
    let capturing = capturing(&prepared, &cuts);
    let loaded = gpu.load(&model, prepared, workarounds, capturing);
    let mut loaded = loaded.expect("the ring holds a patch");
    for cut in cuts {
        let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
        hold("shallow", &model, loaded.prepared(), &frame);
    }
    drop(loaded);
    gpu.finish();
}

/// Displaced along the normal, a surface with creases, n-gons and a boundary is still whole, and moves as the CPU says.
#[test]
fn displaced_surfaces_have_no_cracks() {
    let Some(gpu) = Gpu::open() else { return };
    for name in ["hull", "ngons", "creased-torus", "sheet"] {
        let model = shapes::built_in(name);
        let prepared = METHODS[0]
            .prepare(&model, PlanOptions::default())
            .expect("sound");
        let cuts: Vec<Cut> = [3.0, 8.0]
            .iter()
            .flat_map(|&l| SPACINGS.map(|s| cut(l, s)))
            .collect();
        let workarounds = &gpu.device.info().workarounds;
        let capturing = capturing(&prepared, &cuts);
        let loaded = gpu.load(&model, prepared, workarounds, capturing);
        let mut loaded = loaded.expect("the ring holds a patch");
        for cut in cuts {
            loaded.displacement = Displacement::default();
            let smooth = loaded.capture(cut, Fill::Discard).expect("it is drawn");
            let diagonal = crate::common::diagonal(model.mesh()) as f32;
            loaded.displacement = Displacement {
                height: 0.05 * diagonal,
                frequency: 20.0 / diagonal,
            };
            let bumpy = loaded.capture(cut, Fill::Discard).expect("it is drawn");
            hold(
                &format!("{name} displaced"),
                &model,
                loaded.prepared(),
                &bumpy,
            );
            let pairs = smooth
                .passes
                .iter()
                .flatten()
                .zip(bumpy.passes.iter().flatten());
            let mut moved = 0;
            for (before, after) in pairs {
                let twin = loaded
                    .displacement
                    .displace(before.position.into(), before.normal.into());
                let (position, normal) = (Vec3::from(after.position), Vec3::from(after.normal));
                // Where the limit has several normals, points stay.
                if after.position != before.position {
                    assert!(
                        position.distance(twin.0) <= 1e-6 * diagonal,
                        "{name}: {before:?}, {after:?}"
                    );
                    assert!(
                        normal.distance(twin.1) <= 1e-4,
                        "{name}: {before:?}, {after:?}"
                    );
                    moved += 1;
                }
            }
            assert!(moved > smooth.passes.iter().flatten().count() / 2, "{name}");
        }
    }
    gpu.finish();
}

/// The levels that are looked at for all models; 31, 63, 64 only for those of few faces.
const LEVELS: [f32; 12] = [
    1.0, 2.0, 3.0, 5.0, 7.0, 8.0, 11.9, 13.0, 16.0, 31.0, 63.0, 64.0,
];

#[test]
fn both_sides_of_every_edge_have_the_same_bits() {
    let Some(gpu) = Gpu::open() else { return };
    let mut all = Compared::default();
    for (name, model) in shapes::all() {
        let levels = match model.mesh().face_count() {
            0..=8 => &LEVELS[..],
            9..=60 => &LEVELS[..8],
            _ => &LEVELS[..4],
        };
        let Compared { positions, normals } = hold_all(&gpu, &name, &model, levels);
        all.positions += positions;
        all.normals += normals;
    }
    println!(
        "{} positions and {} normals compared",
        all.positions, all.normals
    );
    assert!(all.positions > 100_000 && all.normals > 50_000, "{all:?}");
    gpu.finish();
}

#[test]
fn both_sides_have_the_same_bits_on_random_meshes() {
    let Some(gpu) = Gpu::open() else { return };
    let mut runner = TestRunner::deterministic();
    for number in 0..30 {
        let recipe = if number % 2 == 0 {
            manifold().boxed()
        } else {
            wild().boxed()
        };
        let recipe = recipe
            .new_tree(&mut runner)
            .expect("recipes are not filtered")
            .current();
        let model = Model::new(recipe.mesh());
        hold_all(&gpu, &format!("{recipe:?}"), &model, &[1.0, 3.0, 7.0, 8.0]);
    }
    gpu.finish();
}
