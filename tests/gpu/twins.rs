//! Captured vertices against the CPU's twins and the truth.

use hullform::gpu::{Cut, Fill};
use hullform::mesh::Model;
use hullform::method::{
    EndCaps, IsolationOptions, METHODS, Method, MethodOptions, Reproduces, TableNormals,
    TableOptions,
};
use hullform::tessellation::Spacing;

use crate::common;
use crate::common::gpu::{Frame, Gpu, SPACINGS, capturing, cut, vertices};
use crate::precision::{Worst, from_truth, from_twin};
use crate::shapes;

/// Captures all at some cuts, and hands each frame on.
fn each_cut(
    gpu: &Gpu,
    model: &Model,
    method: &Method,
    cuts: &[Cut],
    look: impl FnMut(Cut, &hullform::method::Prepared, &Frame),
) {
    each_cut_with(gpu, model, method, MethodOptions::default(), cuts, look);
}

/// The same of a model that is prepared with some options.
fn each_cut_with(
    gpu: &Gpu,
    model: &Model,
    method: &Method,
    options: MethodOptions,
    cuts: &[Cut],
    mut look: impl FnMut(Cut, &hullform::method::Prepared, &Frame),
) {
    let prepared = method.prepare(model, options);
    let prepared = prepared.expect("every sound mesh can be prepared");
    let options = capturing(&prepared, cuts);
    let workarounds = &gpu.device.info().workarounds;
    let mut loaded = gpu
        .load(model, prepared, workarounds, options)
        .expect("the ring holds a patch");
    for &cut in cuts {
        let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
        assert_eq!(frame.counters.overflows, 0);
        let captured: usize = frame.passes.iter().map(Vec::len).sum();
        assert_eq!(
            captured,
            vertices(loaded.prepared(), cut) as usize,
            "{cut:?}"
        );
        look(cut, loaded.prepared(), &frame);
    }
}

/// The methods that can draw the model.
fn able(model: &Model) -> impl Iterator<Item = &'static Method> + '_ {
    METHODS
        .iter()
        .filter(|method| method.check_model(model).is_ok())
}

fn assert_near(what: &str, worst: Worst, position: f64, normal: f64) {
    println!(
        "{what:40} {:.1e} of the diagonal, {:.1e} degrees",
        worst.position, worst.normal
    );
    assert!(
        worst.position <= position && worst.normal <= normal,
        "{what}: {worst:?}"
    );
}

#[test]
fn captured_vertices_are_those_of_the_twins() {
    let Some(gpu) = Gpu::open() else { return };
    for (name, model) in shapes::all().into_iter().chain(shapes::triangular()) {
        let levels = [1.0, 2.0, 3.0, 5.0, 8.0, 13.0];
        let small = model.mesh().face_count() <= 8;
        let levels = levels.iter().chain(small.then_some(&64.0));
        let cuts: Vec<Cut> = levels
            .flat_map(|&level| SPACINGS.map(|spacing| cut(level, spacing)))
            .collect();
        for method in able(&model) {
            let mut worst = Worst::default();
            each_cut(&gpu, &model, method, &cuts, |cut, prepared, frame| {
                let step = ((vertices(prepared, cut) / 2000) | 1) as usize;
                worst.take(from_twin(&model, prepared, frame, step));
            });
            assert_near(&format!("{name} {}", method.name), worst, 1e-6, 0.1);
        }
    }
    gpu.finish();
}

#[test]
fn tables_with_every_option_are_those_of_the_twins() {
    let Some(gpu) = Gpu::open() else { return };
    let shading = TableNormals::Shading;
    let all = [
        (1, shading(1)),
        (6, shading(1)),
        (3, shading(0)),
        (3, shading(2)),
        (3, TableNormals::Geometric),
    ];
    let cuts = [cut(8.0, Spacing::Equal), cut(5.0, Spacing::FractionalEven)];
    let quads = ("builtin:ngons".into(), shapes::built_in("ngons"));
    // Without those whose tables take long to make.
    let shapes = shapes::triangular()
        .into_iter()
        .filter(|(_, model)| model.mesh().face_count() < 300);
    for (name, model) in shapes.chain([quads]) {
        for method in able(&model).filter(|method| method.uses_tables) {
            for (level, normals) in all {
                let options = TableOptions { level, normals }.into();
                let mut worst = Worst::default();
                each_cut_with(
                    &gpu,
                    &model,
                    method,
                    options,
                    &cuts,
                    |cut, prepared, frame| {
                        let step = ((vertices(prepared, cut) / 1000) | 1) as usize;
                        worst.take(from_twin(&model, prepared, frame, step));
                    },
                );
                let what = format!("{name} {} {level} {normals:?}", method.name);
                assert_near(&what, worst, 1e-6, 0.1);
            }
        }
    }
    gpu.finish();
}

/// Levels that cut caps into several segments, so that their insides are drawn.
#[test]
fn end_caps_of_every_kind_are_those_of_the_twins() {
    let Some(gpu) = Gpu::open() else { return };
    let all = [
        EndCaps::Bicubic,
        EndCaps::Gregory,
        EndCaps::Legacy,
        EndCaps::Bspline,
    ];
    let cuts = [cut(8.0, Spacing::Equal), cut(5.0, Spacing::FractionalEven)];
    for (name, caps) in ["cube", "ngons", "hull"]
        .into_iter()
        .flat_map(|name| all.map(|caps| (name, caps)))
    {
        let model = shapes::built_in(name);
        let capped =
            |method: &&Method| matches!(method.contract.reproduces, Reproduces::LimitBesideCaps(_));
        for method in able(&model).filter(capped) {
            let options = IsolationOptions { level: 1, caps }.into();
            let (mut worst, mut inside) = (Worst::default(), 0);
            each_cut_with(
                &gpu,
                &model,
                method,
                options,
                &cuts,
                |_, prepared, frame| {
                    worst.take(from_twin(&model, prepared, frame, 1));
                    let passes = prepared.passes.iter().zip(&frame.passes);
                    let capped = passes.filter(|(pass, _)| pass.caps);
                    inside += capped.map(|(_, points)| points.len()).sum::<usize>();
                },
            );
            assert!(inside > 500, "{name} {caps:?}: {inside} vertices of caps");
            assert_near(
                &format!("{name} {} {caps:?}", method.name),
                worst,
                1e-6,
                0.1,
            );
        }
    }
    gpu.finish();
}

#[test]
fn fractional_levels_are_those_of_the_twins() {
    let Some(gpu) = Gpu::open() else { return };
    for name in ["hull", "ngons", "creased-torus"] {
        let model = shapes::built_in(name);
        let cuts = [1.5, 2.3, 4.7, 10.1, 63.3].map(|level| cut(level, Spacing::FractionalEven));
        let mut worst = Worst::default();
        each_cut(&gpu, &model, &METHODS[0], &cuts, |cut, prepared, frame| {
            let step = ((vertices(prepared, cut) / 4000) | 1) as usize;
            worst.take(from_twin(&model, prepared, frame, step));
        });
        assert_near(name, worst, 1e-6, 0.1);
    }
    gpu.finish();
}

/// The tessellator raises a level of 1 to 2 with this spacing; the points for that are there.
#[test]
fn the_least_level_of_fractional_even_keeps_the_contract() {
    let Some(gpu) = Gpu::open() else { return };
    let cuts = [cut(1.0, Spacing::FractionalEven)];
    for name in ["cube", "hull"] {
        let model = shapes::built_in(name);
        each_cut(&gpu, &model, &METHODS[0], &cuts, |_, prepared, frame| {
            let worst = from_truth(&model, &METHODS[0], prepared, frame, 7);
            assert_near(name, worst, 1e-6, 0.1);
        });
    }
    gpu.finish();
}

/// The limit for methods that promise it; linear faces for the others that this table has.
#[test]
fn captured_vertices_keep_the_contract() {
    let Some(gpu) = Gpu::open() else { return };
    let cuts = [cut(8.0, Spacing::Equal), cut(5.0, Spacing::FractionalEven)];
    for (name, model) in shapes::all() {
        for method in able(&model) {
            let mut worst = Worst::default();
            each_cut(&gpu, &model, method, &cuts, |cut, prepared, frame| {
                let step = ((vertices(prepared, cut) / 400) | 1) as usize;
                worst.take(from_truth(&model, method, prepared, frame, step));
            });
            let what = format!("{name} {}", method.name);
            assert_near(&what, worst, limit(method), normals(method));
        }
    }
    gpu.finish();
}

fn limit(method: &Method) -> f64 {
    match method.contract.reproduces {
        Reproduces::Limit(most)
        | Reproduces::LimitOnLattice(most)
        | Reproduces::LimitBesideCaps(most)
        | Reproduces::LimitOnHexagon(most)
        | Reproduces::Faces(most) => most,
        Reproduces::Itself => 1e-6,
    }
}

fn normals(method: &Method) -> f64 {
    method.contract.normals.unwrap_or(0.1)
}

#[test]
fn models_keep_the_contract_and_follow_the_twins() {
    let Some(gpu) = Gpu::open() else { return };
    for name in ["bigguy", "monsterfrog", "car", "armorguy"] {
        let Some(mesh) = common::model(name) else {
            return;
        };
        let model = Model::new(mesh);
        let method = &METHODS[0];
        let cuts = [cut(8.0, Spacing::Equal)];
        each_cut(&gpu, &model, method, &cuts, |_, prepared, frame| {
            let truth = from_truth(&model, method, prepared, frame, 1009);
            assert_near(
                &format!("{name}, limit"),
                truth,
                limit(method),
                normals(method),
            );
            let twin = from_twin(&model, prepared, frame, 53);
            assert_near(&format!("{name}, twin"), twin, 1e-6, 0.1);
        });
    }
    gpu.finish();
}

#[test]
fn a_small_mesh_far_from_the_origin_loses_nothing() {
    let Some(gpu) = Gpu::open() else { return };
    for name in ["hull", "ngons"] {
        let near = shapes::built_in(name);
        let scale = 0.1 / common::diagonal(near.mesh());
        let far = shapes::moved(near.mesh(), scale, [1000.0, -1000.0, 1000.0]);
        let model = Model::new(far);
        for method in able(&model) {
            let cuts = [cut(8.0, Spacing::Equal)];
            each_cut(&gpu, &model, method, &cuts, |_, prepared, frame| {
                let worst = from_truth(&model, method, prepared, frame, 7);
                assert_near(&format!("{name} {}", method.name), worst, 1e-6, 0.1);
            });
        }
    }
    gpu.finish();
}

/// More than 32 vertices in a ring: what the vertex shader cannot hand on, the control shader fetches.
#[test]
fn long_rings_keep_the_contract() {
    let Some(gpu) = Gpu::open() else { return };
    for name in ["pole-64", "pole-360"] {
        let model = shapes::built_in(name);
        let cuts = [cut(4.0, Spacing::Equal), cut(64.0, Spacing::FractionalEven)];
        each_cut(&gpu, &model, &METHODS[0], &cuts, |_, prepared, frame| {
            let worst = from_truth(&model, &METHODS[0], prepared, frame, 401);
            assert_near(name, worst, 1e-6, 0.1);
        });
    }
    gpu.finish();
}
