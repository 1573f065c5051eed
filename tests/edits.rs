//! Edited models: what is prepared again draws what a fresh preparation draws, bit for bit.

mod common;

use std::time::Instant;

use common::meshes::{cases, wild};
use glam::Vec2;
use hullform::mesh::{BoundaryInterpolation, ControlMesh, CreaseMethod, Edit, Model, builtin};
use hullform::method::{
    Controls, Editable, METHODS, Method, Pass, Prepared, SurfacePoint, from_ptex,
};
use hullform::plan::{Database, PlanOptions};
use proptest::prelude::*;

/// Where patches are evaluated: corners, edges and inside, as deep as [`shallow`] plans go.
const PLACES: [f32; 6] = [0.0, 1.0 / 16.0, 0.3, 0.5, 0.8125, 1.0];

/// Numbers without a pattern (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    fn below(&mut self, count: usize) -> u32 {
        (self.next() % count as u64) as u32
    }
}

/// A random step; most are creases. What holes there were are mostly closed again, so that something is left.
fn step(edit: &mut Edit, model: &Model, random: &mut Random) {
    let sharpness = [0.0, 0.0, 0.5, 1.0, 2.0, 3.5, 10.0][random.below(7) as usize];
    let topology = model.topology();
    match random.below(8) {
        0 => edit.corner(random.below(topology.vertex_count()), sharpness),
        1 => edit.hole(random.below(topology.face_count()), true),
        2 => match model.mesh().holes() {
            [] => edit.hole(0, false),
            holes => edit.hole(holes[random.below(holes.len()) as usize], false),
        },
        _ => {
            let edge = random.below(topology.edge_count());
            let [a, b] = topology.edges()[edge as usize].vertices;
            edit.crease(a, b, sharpness)
        }
    };
}

/// Where each ptex face is drawn: its pass and patch.
fn places(prepared: &Prepared) -> Vec<Option<(usize, usize)>> {
    let mut places = Vec::new();
    for (number, pass) in prepared.passes.iter().enumerate() {
        for patch in (0..pass.patches.len()).filter(|&patch| !pass.is_vacant(patch)) {
            let ptex = pass.patches[patch].ptex as usize;
            places.resize(places.len().max(ptex + 1), None);
            assert!(
                places[ptex].replace((number, patch)).is_none(),
                "it is drawn once"
            );
        }
    }
    places
}

fn bits(point: SurfacePoint) -> [u32; 6] {
    let [x, y, z] = point.position.to_array();
    let [nx, ny, nz] = point.normal.to_array();
    [x, y, z, nx, ny, nz].map(f32::to_bits)
}

/// All that can be seen of a patch at some places of its ptex face.
fn seen(pass: &Pass, controls: &Controls, patch: usize) -> Vec<[u32; 6]> {
    let record = &pass.patches[patch];
    let all = PLACES
        .iter()
        .flat_map(|&v| PLACES.iter().map(move |&u| [u, v]));
    let evaluate = |uv| {
        let uv = from_ptex(record, uv);
        bits(pass.evaluate(controls, patch, Vec2::from(uv)))
    };
    all.map(evaluate).collect()
}

/// Holds what was edited against a fresh preparation: of each ptex face that is asked for.
fn hold(
    edited: &Prepared,
    fresh: &Prepared,
    model: &Model,
    what: &str,
    asks: impl Fn(u32) -> bool,
) {
    let [own, right] = [edited, fresh].map(places);
    let controls = fresh.controls(model.positions());
    for ptex in 0..own.len().max(right.len()) {
        let [own, right] = [&own, &right].map(|of| of.get(ptex).copied().flatten());
        assert_eq!(own.is_some(), right.is_some(), "{what}: ptex face {ptex}");
        let (Some((pass, patch)), Some((other, at))) = (own, right) else {
            continue;
        };
        let [own, right] = [&edited.passes[pass], &fresh.passes[other]];
        assert_eq!(own.shader, right.shader, "{what}: ptex face {ptex}");
        let [one, two] = [own.patches[patch], right.patches[at]];
        assert_eq!(
            (one.flags, one.valences),
            (two.flags, two.valences),
            "{what}: ptex face {ptex}"
        );
        assert_eq!(
            own.sides[patch], right.sides[at],
            "{what}: ptex face {ptex}"
        );
        assert_eq!(own.texture[patch], right.texture[at]);
        for level in 0..=10 {
            assert_eq!(
                own.points(patch, level),
                right.points(at, level),
                "{what}: ptex face {ptex}"
            );
        }
        if asks(ptex as u32) {
            let [own, right] =
                [(own, patch), (right, at)].map(|(pass, patch)| seen(pass, &controls, patch));
            let differing = own.iter().zip(&right).position(|(own, right)| own != right);
            if let Some(place) = differing {
                let [u, v] = [place % PLACES.len(), place / PLACES.len()].map(|i| PLACES[i]);
                panic!(
                    "{what}: ptex face {ptex} at {u} {v}: {:x?} {:x?}",
                    own[place], right[place]
                );
            }
        }
    }
}

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
            for number in 0..8 {
                let mut edit = model.mesh().edit();
                (0..1 + number % 4).for_each(|_| step(&mut edit, &model, &mut random));
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
            (0..1 + number % 3).for_each(|_| step(&mut edit, &model, &mut random));
            let changes = model.apply(&edit).expect("all of it is there");
            editable.update(&model, &changes, &database).expect("it goes");
            let fresh = in_place().prepare_with(&model, shallow(), &database);
            let fresh = fresh.expect("sound options");
            hold(editable.prepared(), &fresh, &model, &format!("{number} {edit:?}"), |_| true);
        }
    }
}

/// So many edits in a run by hand: `HULLFORM_EDITS=10000`, where every one is held against a fresh preparation.
#[test]
fn after_many_edits_of_two_thousand_faces_nothing_differs_and_nothing_has_grown_but_plans() {
    let wanted = std::env::var("HULLFORM_EDITS").ok();
    let edits: u32 = wanted
        .as_ref()
        .map_or(60, |edits| edits.parse().expect("a number"));
    let every = if wanted.is_some() { 1 } else { 20 };
    let mut database = Database::default();
    let mesh = sheet(45, 45);
    let mut model = Model::new(mesh);
    let editable = in_place().prepare_editable(&model, shallow(), &database);
    let mut editable = editable.expect("sound options");
    let capacities: Vec<usize> = editable
        .prepared()
        .passes
        .iter()
        .map(|pass| pass.patches.len())
        .collect();
    let controls = |editable: &Editable| -> usize {
        editable
            .prepared()
            .passes
            .iter()
            .map(|pass| pass.controls.len())
            .sum()
    };
    let before = controls(&editable);
    let mut random = Random(2000);
    let (mut whole, mut touched) = (0, 0);
    for number in 0..edits {
        if number % 1000 == 999 {
            // What nobody uses goes, and all plans are built once more.
            database = Database::default();
        }
        let mut edit = model.mesh().edit();
        step(&mut edit, &model, &mut random);
        // No more creases than a model has, so that smooth places come back.
        if let Some(crease) = model.mesh().creases().get(400) {
            edit.crease(crease.vertices[0], crease.vertices[1], 0.0);
        }
        let changes = model.apply(&edit).expect("all of it is there");
        let update = editable
            .update(&model, &changes, &database)
            .expect("it goes");
        whole += u32::from(update.is_whole);
        touched += changes.faces().len();
        if number % every == every - 1 || number + 1 == edits {
            let fresh = in_place()
                .prepare_with(&model, shallow(), &database)
                .expect("sound options");
            // All of it from time to time, else what the edit influences and some of the rest.
            let all = number % 500 == 499 || number + 1 == edits || every > 1;
            let near =
                |ptex: u32| all || changes.faces().contains(&ptex) || ptex % 97 == number % 97;
            hold(
                editable.prepared(),
                &fresh,
                &model,
                &format!("{number}: {edit:?}"),
                near,
            );
        }
    }
    println!(
        "{edits} edits: {touched} faces, {whole} times all anew, {before} controls and now {}",
        controls(&editable)
    );
    assert!(
        touched < 40 * edits as usize,
        "what is far away is left alone"
    );
    let passes = &editable.prepared().passes;
    if whole == 0 {
        assert!(
            passes.iter().map(|pass| pass.patches.len()).eq(capacities),
            "patches take each other's slots"
        );
    }
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
        let [own, right] = [editable.prepared(), &fresh].map(places);
        assert_eq!(own.iter().flatten().count(), right.iter().flatten().count());
    }
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

/// One crease of a model of thousands of faces: a few faces are planned again. `HULLFORM_TIMES=1` prints what that takes on one thread.
#[test]
fn one_crease_of_a_large_model_takes_its_surroundings_alone() {
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
    let mut random = Random(3);
    let plans = database.len();
    let (mut fastest, mut faces, mut words) = (f64::INFINITY, 0, 0);
    let mut one = || {
        let edge = random.below(model.topology().edge_count());
        let [a, b] = model.topology().edges()[edge as usize].vertices;
        let mut edit = model.mesh().edit();
        edit.crease(a, b, 1.0 + 0.01 * random.below(300) as f32);
        let started = Instant::now();
        let changes = model.apply(&edit).expect("there is such an edge");
        let update = editable
            .update(&model, &changes, &database)
            .expect("it goes");
        fastest = fastest.min(started.elapsed().as_secs_f64());
        assert!(!update.is_whole && changes.faces().len() < 100);
        faces += changes.faces().len();
        words += update.words();
    };
    let ran = pool.expect("a thread").install(|| {
        let before = run_time();
        (0..EDITS).for_each(|_| one());
        Some((run_time()? - before?) as f64 / 1e6)
    });
    let each = |all: usize| all as f64 / f64::from(EDITS);
    if std::env::var_os("HULLFORM_TIMES").is_some() {
        println!(
            "an edit: {:?} ms of one thread, {} ms for the fastest; {} faces, {} plans, {} words",
            ran.map(|ran| ran / f64::from(EDITS)),
            1e3 * fastest,
            each(faces),
            each(database.len() - plans),
            each(words),
        );
    }
    assert!(each(words) < 20_000.0, "what is uploaded is little");
    let fresh = in_place().prepare_with(&model, options, &database);
    let fresh = fresh.expect("sound options");
    hold(editable.prepared(), &fresh, &model, "creases", |ptex| {
        ptex % 7 == 0
    });
}
