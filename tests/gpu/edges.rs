//! No cracks between faces: both sides of an edge have the same vertices, bit by bit.
//!
//! `hullform verify` has the cases of its own meshes (`hullform::conformance::edges`). Here are those of meshes that it does not have: the
//! shared shapes, and random ones of another kind than its own.

use glam::Vec3;
use hullform::conformance::edges::{Compared, Setup, compare};
use hullform::conformance::{Context, Settings};
use hullform::gpu::{Cut, Fill};
use hullform::mesh::Model;
use hullform::method::{Displacement, METHODS};
use hullform::plan::PlanOptions;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;

use crate::common::gpu::{Gpu, SPACINGS, capturing, cut};
use crate::common::meshes::{manifold, wild};
use crate::shapes;

/// The suite's context under validation; None where there is no device.
fn context() -> Option<Context> {
    Gpu::open()?.finish();
    let settings = Settings {
        validation: true,
        ..Settings::default()
    };
    Some(Context::new(settings, Vec::new()))
}

/// Asserts that all that is shared has the same bits.
fn hold(context: &Context, name: &str, model: &Model, setup: &Setup) -> Compared {
    let compared = compare(context, model, setup).expect("it is drawn");
    assert!(
        compared.is_same(),
        "{name}: {compared}: {:?}",
        compared.first
    );
    compared
}

fn silent(context: &Context) {
    let messages = context.validation_messages();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
}

/// Displaced along the normal, a surface with creases, n-gons and a boundary moves as the CPU says. That it is still whole is the suite's.
#[test]
fn displaced_surfaces_move_as_their_twin_says() {
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
            loaded.view.displacement = Displacement::default();
            let smooth = loaded.capture(cut, Fill::Discard).expect("it is drawn");
            let diagonal = model.diagonal() as f32;
            loaded.view.displacement = Displacement {
                height: 0.05 * diagonal,
                frequency: 20.0 / diagonal,
            };
            let bumpy = loaded.capture(cut, Fill::Discard).expect("it is drawn");
            let pairs = smooth
                .passes
                .iter()
                .flatten()
                .zip(bumpy.passes.iter().flatten());
            let mut moved = 0;
            for (before, after) in pairs {
                let twin = loaded
                    .view
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

#[test]
fn both_sides_of_every_edge_have_the_same_bits() {
    let Some(context) = context() else { return };
    let mut all = Compared::default();
    for (name, model) in shapes::catmark() {
        // 31, 63 and 64 only for those of few faces.
        let levels: &[f32] = match model.mesh().face_count() {
            0..=8 => &hullform::conformance::edges::LEVELS,
            9..=60 => &[1.0, 2.0, 3.0, 5.0, 7.0, 8.0, 11.9, 13.0],
            _ => &[1.0, 2.0, 3.0, 5.0],
        };
        all.add(hold(&context, &name, &model, &Setup::new(levels)));
    }
    println!("{all}");
    assert!(
        shapes::catmark().is_empty() || all.normals > 50_000,
        "{all}"
    );
    silent(&context);
}

#[test]
fn both_sides_have_the_same_bits_on_random_meshes() {
    let Some(context) = context() else { return };
    let mut runner = TestRunner::deterministic();
    let setup = Setup::new(&[1.0, 3.0, 7.0, 8.0]);
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
        hold(&context, &format!("{recipe:?}"), &model, &setup);
    }
    silent(&context);
}
