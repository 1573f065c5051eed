//! Plans lead to the limit: the method's CPU twin, in f32 on the packed bytes, against the truth.

mod common;

use common::meshes::{cases, manifold, wild};
use common::surfaces::{LEVELS, Surfaces, tess_coordinates};
use glam::DVec3;
use hullform::mesh::{ControlMesh, CreaseMethod, SchemeOptions, builtin, read_obj};
use hullform::plan::PlanOptions;
use proptest::prelude::*;

/// Holds a mesh at all levels, `count` points a level and patch.
fn hold(name: &str, mesh: ControlMesh, options: PlanOptions, count: u32) {
    let surfaces = Surfaces::of(mesh, options);
    if surfaces.prepared.passes.is_empty() {
        return;
    }
    let worst = surfaces.worst(1, |patch| tess_coordinates(&LEVELS, count, patch));
    worst.hold(name);
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn plans_of_manifold_meshes_lead_to_the_limit(recipe in manifold()) {
        hold("manifold", recipe.mesh(), PlanOptions::default(), 2);
    }

    #[test]
    fn plans_of_wild_meshes_lead_to_the_limit(recipe in wild()) {
        hold("wild", recipe.mesh(), PlanOptions::default(), 2);
    }
}

proptest! {
    #![proptest_config(cases(10))]

    #[test]
    fn creases_refined_away_lead_to_the_same_surface_by_more_nodes(recipe in manifold()) {
        let options = PlanOptions { direct_creases: false, ..PlanOptions::default() };
        let refined = Surfaces::of(recipe.mesh(), options);
        let direct = Surfaces::of(recipe.mesh(), PlanOptions::default());
        prop_assert!(nodes(&refined) >= nodes(&direct));
        if !refined.prepared.passes.is_empty() {
            refined.worst(1, |patch| tess_coordinates(&[2, 7, 64], 2, patch)).hold("refined");
        }
    }

    /// Normals count up to Vulkan's tess level of 64; beyond, f32 coordinates are too coarse for them.
    #[test]
    fn every_deepest_level_is_exact_up_to_its_own_tess_level(recipe in wild()) {
        for max_level in 1..=10 {
            let surfaces = Surfaces::of(recipe.mesh(), PlanOptions { max_level, direct_creases: true });
            let deepest = 1u32 << max_level;
            let levels = [deepest / 2 + 1, deepest - 1, deepest];
            let worst = surfaces.worst(3, |patch| tess_coordinates(&levels, 2, patch));
            prop_assert!(worst.distance <= 1e-6, "{max_level}: {worst:?}");
            prop_assert!(max_level > 6 || worst.angle <= 0.1, "{max_level}: {worst:?}");
        }
    }
}

fn nodes(surfaces: &Surfaces) -> usize {
    let plans = surfaces
        .prepared
        .plans
        .as_ref()
        .expect("the method has plans");
    plans.nodes.iter().sum()
}

#[test]
fn plans_of_every_shared_shape_lead_to_the_limit() {
    for path in common::obj_files("shapes") {
        let name = common::stem(&path);
        let (true, Ok(mesh)) = (name.starts_with("catmark"), read_obj(&path)) else {
            continue;
        };
        let surfaces = Surfaces::of(mesh, PlanOptions::default());
        let worst = surfaces.worst(1, |patch| tess_coordinates(&[1, 3, 8, 63], 2, patch));
        worst.hold(&name);
    }
}

#[test]
fn plans_of_every_shared_model_lead_to_the_limit() {
    for path in common::obj_files("models") {
        let mesh = read_obj(&path).expect("the shared models are sound");
        let surfaces = Surfaces::of(mesh, PlanOptions::default());
        let stride = 1 + surfaces.model.topology().face_count() / 60;
        let worst = surfaces.worst(stride, |patch| tess_coordinates(&LEVELS, 1, patch));
        worst.hold(&common::stem(&path));
    }
}

#[test]
fn poles_of_any_valence_lead_to_the_limit() {
    for valence in [3, 5, 64, 200, 360] {
        let mesh = builtin(&format!("pole-{valence}")).expect("a built-in shape");
        let surfaces = Surfaces::of(mesh, PlanOptions::default());
        let stride = 1 + valence / 5;
        let worst = surfaces.worst(stride, |patch| tess_coordinates(&[1, 3, 64], 1, patch));
        if valence <= 256 {
            worst.hold(&format!("pole of {valence}"));
        } else {
            // Sums of hundreds of f32 lose a little more.
            assert!(worst.distance <= 3e-6 && worst.angle <= 0.5, "{worst:?}");
        }
    }
}

/// Tori so small that a face's 1-ring meets itself.
#[test]
fn rings_that_touch_themselves_lead_to_the_limit() {
    for (width, height) in [(3, 3), (4, 3), (2, 5), (2, 2), (2, 4), (3, 2)] {
        let mesh = torus(width, height, |p| p).build().expect("sound");
        hold(
            &format!("torus {width}x{height}"),
            mesh,
            PlanOptions::default(),
            4,
        );
    }
}

/// A torus of quads; narrow ones name an edge more than once.
fn torus(
    width: u32,
    height: u32,
    to: impl Fn(DVec3) -> DVec3,
) -> hullform::mesh::ControlMeshBuilder {
    let turn = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let ((a, b), (c, d)) = (turn(x, width).sin_cos(), turn(y, height).sin_cos());
        let r = 1.0 + 0.4 * d;
        positions.push(to(DVec3::new(r * b, r * a, 0.4 * c + 0.1 * b)).to_array());
        let number = |x: u32, y: u32| x % width + width * (y % height);
        faces.extend([(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| number(x + i, y + j)));
    }
    ControlMesh::builder(&positions, &vec![4; faces.len() / 4], &faces)
}

#[test]
fn small_meshes_far_from_the_origin_keep_their_precision() {
    let far = DVec3::new(1000.0, -700.0, 300.0);
    let builder = torus(5, 4, |p| far + 0.04 * p);
    let mesh = builder.crease(0, 1, 2.5).crease(1, 2, 2.5).build();
    hold("far away", mesh.expect("sound"), PlanOptions::default(), 4);
}

#[test]
fn chaikin_creases_of_varying_sharpness_lead_to_the_limit() {
    for sharpness in [
        [0.3, 1.2, 9.5],
        [9.5, 9.5, 0.4],
        [4.0, 3.0, 2.5],
        [9.9, 10.0, 8.0],
    ] {
        let creases = sharpness.iter().enumerate().map(|(i, &s)| (i as u32, s));
        let builder = torus(5, 5, |p| p).options(SchemeOptions {
            creasing: CreaseMethod::Chaikin,
            ..SchemeOptions::default()
        });
        let builder = creases.fold(builder, |builder, (i, s)| {
            builder.crease(i, i + 1, s).crease(5 * i + 7, 5 * i + 12, s)
        });
        let mesh = builder.build().expect("sound");
        hold(&format!("{sharpness:?}"), mesh, PlanOptions::default(), 2);
    }
}

/// Found by `every_deepest_level_is_exact_up_to_its_own_tess_level`: after one level, each cell still touches a corner.
#[test]
fn deepest_level_1_is_exact_at_tess_level_2() {
    let options = PlanOptions {
        max_level: 1,
        direct_creases: true,
    };
    let surfaces = Surfaces::of(builtin("ngons").expect("a built-in shape"), options);
    let worst = surfaces.worst(1, |patch| tess_coordinates(&[2], 4, patch));
    worst.hold("level 1");
}

#[test]
fn direct_creases_save_nodes() {
    let built = |direct_creases| {
        let mesh = builtin("creased-torus").expect("a built-in shape");
        let options = PlanOptions {
            direct_creases,
            ..PlanOptions::default()
        };
        nodes(&Surfaces::of(mesh, options))
    };
    assert!(built(false) > 2 * built(true));
}
