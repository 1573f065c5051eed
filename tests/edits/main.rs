//! Edited models: what is prepared again draws what a fresh preparation draws, bit for bit.

#[path = "../common/mod.rs"]
mod common;

mod held;
mod random;

use std::time::Instant;

use common::meshes::{cases, wild};
use held::{all_places, hold, hold_compacted};
use hullform::mesh::{
    BoundaryInterpolation, ControlMesh, CreaseMethod, Edit, Model, Scheme, Triangulation, builtin,
    triangulated,
};
use hullform::method::{METHODS, Method, Pass, Prepared};
use hullform::plan::{Database, PlanOptions};
use proptest::prelude::*;
use random::{Random, reshape, step};

/// A method that plans again what edits influence.
fn in_place() -> &'static Method {
    let mut able = METHODS.iter().filter(|method| method.edits_in_place());
    able.next().expect("one does")
}

/// A mesh with other rules of boundaries and creases.
fn under(
    mesh: &ControlMesh,
    boundary: BoundaryInterpolation,
    creasing: CreaseMethod,
) -> ControlMesh {
    let sizes: Vec<u32> = mesh.faces().map(|face| face.len() as u32).collect();
    let faces: Vec<u32> = mesh.faces().flatten().copied().collect();
    let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
    let mut builder = ControlMesh::builder(&positions, &sizes, &faces);
    let mut options = mesh.options();
    (options.boundary, options.creasing) = (boundary, creasing);
    for crease in mesh.creases() {
        let [a, b] = crease.vertices;
        builder = builder.crease(a, b, crease.sharpness);
    }
    builder.options(options).build().expect("a sound mesh")
}

fn shallow() -> PlanOptions {
    PlanOptions {
        max_level: 4,
        ..PlanOptions::default()
    }
}

#[test]
fn what_edits_influence_is_planned_again_and_draws_what_a_fresh_preparation_draws() {
    let database = Database::default();
    let mut random = Random(11);
    let mut whole = 0;
    for name in ["hull", "ngons", "sheet", "cubes-2x2x2", "pole-12"] {
        for (boundary, creasing) in [
            (BoundaryInterpolation::EdgeOnly, CreaseMethod::Uniform),
            (BoundaryInterpolation::EdgeAndCorner, CreaseMethod::Chaikin),
            (BoundaryInterpolation::None, CreaseMethod::Uniform),
        ] {
            let mesh = builtin(name).expect("it is built in");
            let mut model = Model::new(under(&mesh, boundary, creasing));
            let editable = in_place().prepare_editable(&model, shallow(), &database);
            let mut editable = editable.expect("sound options");
            for number in 0..12 {
                let mut edit = model.mesh().edit();
                match number % 2 {
                    0 => (0..1 + number % 4).for_each(|_| step(&mut edit, &model, &mut random)),
                    _ => reshape(
                        &mut edit,
                        &model,
                        &mut random,
                        [model.mesh().face_count() + 8, 400],
                    ),
                }
                let changes = model.apply(&edit).expect("all of it is there");
                let update = editable
                    .update(&model, &changes, &database)
                    .expect("it goes");
                if update.is_whole {
                    println!("{name} {boundary:?} {number}: all anew");
                    whole += 1;
                }
                let what = format!(
                    "{name} {boundary:?} {number} {edit:?} {:?}",
                    changes.faces()
                );
                let fresh = in_place().prepare_with(&model, shallow(), &database);
                hold(
                    editable.prepared(),
                    &fresh.expect("sound options"),
                    &model,
                    &what,
                    |_| true,
                );
                assert!(editable.prepared().is_of(&model), "{what}");
            }
            let what = format!("{name} {boundary:?}");
            hold_compacted(in_place(), editable.prepared(), &model, shallow(), &what);
        }
    }
    assert!(
        whole < 4,
        "most is planned again where it has changed alone"
    );
}

proptest! {
    #![proptest_config(cases(24))]

    /// Meshes of any kind: open, non-manifold, with n-gons, poles and lenses, under any options.
    #[test]
    fn edits_of_random_meshes_draw_what_fresh_preparations_draw(recipe in wild(), seed in any::<u64>()) {
        let database = Database::default();
        let mut random = Random(seed);
        let mut model = Model::new(recipe.mesh());
        let editable = in_place().prepare_editable(&model, shallow(), &database);
        let mut editable = editable.expect("sound options");
        for number in 0..6 {
            let mut edit = model.mesh().edit();
            match number % 2 {
                0 => (0..1 + number % 3).for_each(|_| step(&mut edit, &model, &mut random)),
                _ => reshape(&mut edit, &model, &mut random, [model.mesh().face_count() + 8, 400]),
            }
            let changes = model.apply(&edit).expect("all of it is there");
            editable.update(&model, &changes, &database).expect("it goes");
            let fresh = in_place().prepare_with(&model, shallow(), &database);
            let fresh = fresh.expect("sound options");
            hold(editable.prepared(), &fresh, &model, &format!("{number} {edit:?}"), |_| true);
        }
    }
}

/// The words of what was prepared.
fn words(prepared: &Prepared) -> usize {
    let words = |pass: &Pass| {
        let own = pass.tables.iter().map(|table| table.len());
        pass.controls.len() + own.sum::<usize>()
    };
    prepared.passes.iter().map(words).sum()
}

/// So many edits in a run by hand: `HULLFORM_EDITS=10000`. Each is held against a fresh preparation: whether the same faces are drawn by as many points, and at the faces that it
/// influences and some others every bit of the surface; of all faces after every hundredth, and at the end.
#[test]
fn after_many_edits_of_two_thousand_faces_nothing_differs_and_nothing_has_grown_but_plans() {
    let wanted = std::env::var("HULLFORM_EDITS").ok();
    let edits: u32 = wanted
        .as_ref()
        .map_or(60, |edits| edits.parse().expect("a number"));
    let every = if wanted.is_some() { 1 } else { 10 };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread").install(|| edit_many(edits, every));
}

fn edit_many(edits: u32, every: u32) {
    let mut database = Database::default();
    let mut model = Model::new(sheet(45, 45));
    let most = [model.mesh().face_count(), model.mesh().vertex_count() + 200];
    let editable = in_place().prepare_editable(&model, shallow(), &database);
    let mut editable = editable.expect("sound options");
    let mut random = Random(2000);
    let (mut whole, mut touched, mut shaped) = (0, 0, 0);
    let started = Instant::now();
    for number in 0..edits {
        if number % 1000 == 999 {
            // What nobody uses goes, and all plans are built once more.
            database = Database::default();
        }
        let mut edit = model.mesh().edit();
        match random.below(2) {
            0 => {
                step(&mut edit, &model, &mut random);
                // No more creases than a model has, so that smooth places come back.
                if let Some(crease) = model.mesh().creases().get(400) {
                    edit.crease(crease.vertices[0], crease.vertices[1], 0.0);
                }
            }
            _ => reshape(&mut edit, &model, &mut random, most),
        }
        let changes = model.apply(&edit).expect("all of it is there");
        let update = editable.update(&model, &changes, &database);
        let update = update.expect("it goes");
        let influenced = changes.faces();
        whole += u32::from(update.is_whole);
        shaped += u32::from(changes.is_reconnected());
        touched += influenced.len();
        let is_last = number + 1 == edits;
        if number % every == every - 1 || is_last {
            let fresh = in_place().prepare_with(&model, shallow(), &database);
            let fresh = fresh.expect("sound options");
            let all = number % 100 == 99 || is_last;
            let offsets = model.mesh().ptex_offsets();
            let near: std::collections::HashSet<u32> = influenced
                .iter()
                .flat_map(|&face| {
                    let n = model.mesh().face(face as usize).len() as u32;
                    offsets[face as usize]..offsets[face as usize] + n
                })
                .collect();
            let sample = random.below(97);
            let what = format!("{number}: {edit:?}");
            hold(editable.prepared(), &fresh, &model, &what, |ptex| {
                all || near.contains(&ptex) || ptex % 97 == sample
            });
        }
        if number % 500 == 499 {
            let faces =
                (0..model.mesh().face_count()).filter(|&face| !model.mesh().is_removed(face));
            println!(
                "{} edits after {:?}, {} faces",
                number + 1,
                started.elapsed(),
                faces.count()
            );
        }
    }
    hold_compacted(
        in_place(),
        editable.prepared(),
        &model,
        shallow(),
        "at the end",
    );
    let faces = (0..model.mesh().face_count()).filter(|&face| !model.mesh().is_removed(face));
    let (faces, grown) = (faces.count(), words(editable.prepared()));
    assert!(faces + 100 > most[0], "faces stay about as many");
    println!(
        "{edits} edits, {shaped} of faces: {touched} faces planned again, {whole} times all anew; {faces} faces of {}, {} vertices, {grown} words",
        model.mesh().face_count(),
        model.mesh().vertex_count(),
    );
    assert!(
        touched < 40 * edits as usize,
        "what is far away is left alone"
    );
    assert!(
        model.mesh().vertex_count() <= most[1],
        "vertices are used again"
    );
    // A face finds the number of another of as many corners, or else there is none to spare.
    assert!(model.mesh().face_count() < 4 * most[0]);
    editable.renew(&model, &database).expect("it goes");
    let fresh = in_place().prepare_editable(&model, shallow(), &database);
    let fresh = fresh.expect("sound options");
    assert_eq!(
        words(editable.prepared()),
        words(fresh.prepared()),
        "nothing is left behind"
    );
}

/// A sheet of quads with an n-gon and a pole in it.
fn sheet(columns: u32, rows: u32) -> ControlMesh {
    let vertex = |x: u32, y: u32| x + (columns + 1) * y;
    let mut positions = Vec::new();
    for y in 0..=rows {
        for x in 0..=columns {
            let [u, v] = [x, y].map(f64::from);
            positions.push([u, v, (0.7 * u).sin() + (0.4 * v).cos()]);
        }
    }
    let (mut sizes, mut faces) = (Vec::new(), Vec::new());
    for y in 0..rows {
        for x in 0..columns {
            let corners = [
                vertex(x, y),
                vertex(x + 1, y),
                vertex(x + 1, y + 1),
                vertex(x, y + 1),
            ];
            if (x + 3 * y) % 41 == 5 {
                let [a, b, c, d] = corners;
                sizes.extend([3, 3]);
                faces.extend([a, b, c, a, c, d]);
            } else {
                sizes.push(4);
                faces.extend(corners);
            }
        }
    }
    ControlMesh::builder(&positions, &sizes, &faces)
        .build()
        .expect("a sound mesh")
}

#[test]
fn methods_that_cannot_edit_in_place_say_so_and_prepare_all_anew() {
    let database = Database::default();
    let mut model = Model::new(builtin("cube").expect("it is built in"));
    for method in METHODS {
        if method.check_model(&model).is_err() {
            continue;
        }
        let editable = method.prepare_editable(&model, PlanOptions::default(), &database);
        let mut editable = editable.expect("it draws the model");
        let mut edit = model.mesh().edit();
        edit.crease(0, 1, 1.0 + model.mesh().creases().len() as f32)
            .hole(2, true);
        let changes = model.apply(&edit).expect("there is such an edge");
        let update = editable
            .update(&model, &changes, &database)
            .expect("it goes");
        assert_eq!(update.is_whole, !method.edits_in_place(), "{}", method.name);
        let fresh = method.prepare_with(&model, PlanOptions::default(), &database);
        let fresh = fresh.expect("it draws the model");
        assert!(editable.prepared().is_of(&model));
        let [own, right] = [editable.prepared(), &fresh].map(all_places);
        assert_eq!(own.iter().flatten().count(), right.iter().flatten().count());
    }
}

/// Whatever prepares all anew knows of faces that were removed: in quads and in triangles, with holes between them.
#[test]
fn all_methods_draw_what_is_left_when_faces_were_removed() {
    let quads = builtin("creased-torus").expect("it is built in");
    let quads = quads.with_scheme(Scheme::CatmullClark);
    let triangles = triangulated(
        &builtin("sheet").expect("it is built in"),
        Triangulation::Fan,
    );
    let triangles = triangles.expect("a sound mesh");
    let of = |scheme: Scheme| triangles.clone().with_scheme(scheme);
    let meshes = [quads, of(Scheme::Loop), of(Scheme::LoopStam)];
    let mut drawn = 0;
    for mesh in meshes {
        let mesh = mesh.expect("a sound mesh");
        for method in METHODS {
            let mut model = Model::new(mesh.clone());
            if method.check(mesh.options().scheme).is_err() {
                continue;
            }
            let corners = mesh.face(5).to_vec();
            let mut edit = model.mesh().edit();
            edit.hole(9, true);
            // Some methods know no creases.
            for crease in mesh.creases() {
                edit.crease(crease.vertices[0], crease.vertices[1], 0.0);
            }
            model.apply(&edit).expect("all of it is there");
            let mut edit = model.mesh().edit();
            edit.remove_face(1)
                .remove_face(5)
                .remove_face(7)
                .add_face(&corners);
            let changes = model.apply(&edit).expect("all of it is there");
            assert_eq!(changes.added(), [1]);
            let Ok(prepared) = method.prepare(&model, shallow()) else {
                continue;
            };
            let what = format!("{} {}", method.name, mesh.options().scheme);
            hold_compacted(method, &prepared, &model, shallow(), &what);
            drawn += 1;
        }
    }
    assert!(drawn >= METHODS.len(), "most draw them: {drawn}");
}

#[test]
fn changes_of_another_model_are_refused_and_one_left_out_prepares_all_anew() {
    let database = Database::default();
    let mut model = Model::new(builtin("hull").expect("it is built in"));
    let mut editable = in_place()
        .prepare_editable(&model, shallow(), &database)
        .expect("sound options");
    let mut crease = |sharpness: f32| {
        let [a, b] = model.topology().edges()[40].vertices;
        let mut edit = model.mesh().edit();
        edit.crease(a, b, sharpness);
        let changes = model.apply(&edit).expect("there is such an edge");
        (model.clone(), changes)
    };
    let [(first, one), (second, two)] = [crease(2.0), crease(3.0)];
    assert!(editable.update(&first, &two, &database).is_err());
    assert!(
        editable
            .update(&second, &two, &database)
            .expect("it goes")
            .is_whole
    );
    assert!(
        editable
            .update(&first, &one, &database)
            .expect("it goes")
            .is_whole,
        "back again"
    );
    let update = editable.update(&second, &two, &database).expect("it goes");
    assert!(!update.is_whole && update.words() > 0);
}

/// Nanoseconds that this thread has been running for, as the scheduler counts them.
fn run_time() -> Option<u64> {
    let counts = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    counts.split_whitespace().next()?.parse().ok()
}

/// One edit of a model of thousands of faces: a few faces are planned again. `HULLFORM_TIMES=1` prints what that takes on one thread, and what of it the mesh and its topology.
fn takes_its_surroundings_alone(what: &str, change: impl Fn(&mut Edit, &Model, u32) + Sync) {
    const EDITS: u32 = 40;
    let Some(mesh) = common::model("armorguy") else {
        return;
    };
    let database = Database::default();
    let mut model = Model::new(mesh);
    let options = PlanOptions::default();
    let editable = in_place().prepare_editable(&model, options, &database);
    let mut editable = editable.expect("sound options");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let plans = database.len();
    let (mut applied, mut faces, mut words) = (0, 0, 0);
    let mut one = |number: u32| {
        let mut edit = model.mesh().edit();
        change(&mut edit, &model, number);
        let before = run_time();
        let changes = model.apply(&edit).expect("all of it is there");
        applied += run_time()
            .zip(before)
            .map_or(0, |(now, before)| now - before);
        let update = editable
            .update(&model, &changes, &database)
            .expect("it goes");
        assert!(!update.is_whole && changes.faces().len() < 100);
        faces += changes.faces().len();
        words += update.words();
    };
    let ran = pool.expect("a thread").install(|| {
        let before = run_time();
        (0..EDITS).for_each(&mut one);
        Some((run_time()? - before?) as f64 / 1e6)
    });
    let each = |all: usize| all as f64 / f64::from(EDITS);
    if std::env::var_os("HULLFORM_TIMES").is_some() {
        println!(
            "{what}: {:?} ms of one thread, {} of them the mesh and its topology; {} faces, {} plans, {} words",
            ran.map(|ran| ran / f64::from(EDITS)),
            applied as f64 / 1e6 / f64::from(EDITS),
            each(faces),
            each(database.len() - plans),
            each(words),
        );
    }
    assert!(each(words) < 20_000.0, "what is uploaded is little");
    let fresh = in_place().prepare_with(&model, options, &database);
    let fresh = fresh.expect("sound options");
    hold(editable.prepared(), &fresh, &model, what, |ptex| {
        ptex % 7 == 0
    });
}

#[test]
fn one_crease_of_a_large_model_takes_its_surroundings_alone() {
    takes_its_surroundings_alone("a crease", |edit, model, number| {
        let mut random = Random(number.into());
        let edge = random.below(model.topology().edge_count());
        let [a, b] = model.topology().edges()[edge as usize].vertices;
        edit.crease(a, b, 1.0 + 0.01 * random.below(300) as f32);
    });
}

/// Removed, and put back as another one beside it goes.
#[test]
fn one_face_of_a_large_model_takes_its_surroundings_alone() {
    takes_its_surroundings_alone("a face", |edit, model, number| {
        let mut random = Random(number.into());
        let face = random.below(model.mesh().face_count()) as usize;
        let vertices = model.mesh().face(face);
        match number % 2 {
            _ if vertices.is_empty() => {}
            0 => _ = edit.remove_face(face as u32),
            _ => {
                _ = edit
                    .remove_face(face as u32)
                    .add_face(&[vertices[0], vertices[1], vertices[2]])
            }
        }
    });
}
