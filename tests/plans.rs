//! What holds of every plan: weights, trees, counts, and who shares one.

mod common;

use std::sync::Arc;

use common::meshes::{cases, manifold, scatter, wild};
use common::surfaces::Surfaces;
use glam::{DVec3, Vec2};
use hullform::abi;
use hullform::frame::Cut;
use hullform::mesh::topology::Topology;
use hullform::mesh::{ControlMesh, Model, builtin, read_obj};
use hullform::method::{Cell, METHODS, Method, method};
use hullform::plan::database::{Entry, Kind};
use hullform::plan::{
    Configuration, Database, EdgeKind, EdgePlan, Node, PackedPlans, Plan, PlanOptions, Ring,
    VertexKind, VertexPlan, walk,
};
use hullform::subdivision::{Blend, LimitSurface};
use hullform::tessellation::{Domain, Levels, Spacing, required_level};
use proptest::prelude::*;

fn of_quad(topology: &Topology, face: u32) -> Ring {
    Ring::of_quad(topology, face).expect("it is a quad")
}

fn from_corner(topology: &Topology, face: u32, start: u32) -> Ring {
    Ring::from_corner(topology, face, start).expect("it is a corner")
}

/// The ring of every quad and of every n-gon's corner of a mesh, with its ptex number.
fn rings(topology: &Topology) -> Vec<(usize, Ring)> {
    let mut rings = Vec::new();
    for face in 0..topology.face_count() as u32 {
        let arity = topology.face(face).len() as u32;
        let first = rings.len();
        if arity == 4 {
            rings.push((first, of_quad(topology, face)));
        } else {
            let of_part = |i| Ring::of_part(topology, face, i).expect("it is a corner");
            rings.extend((0..arity).map(|i| (first + i as usize, of_part(i))));
        }
    }
    rings
}

/// The different plans of a mesh, with exact weights; the database's are the same, rounded.
fn plans(mesh: &ControlMesh, options: PlanOptions) -> Vec<Plan> {
    let database = Database::default();
    let rings = rings(&Topology::new(mesh));
    let all: Vec<&Configuration> = rings.iter().map(|(_, ring)| &ring.configuration).collect();
    let found = database.plans(Kind::Inside, options, &all);
    let found = found.expect("the options are sound");
    let mut found: Vec<_> = found.into_iter().zip(all).collect();
    assert!(
        found
            .iter()
            .all(|((number, _), _)| (*number as usize) < database.len())
    );
    found.sort_by_key(|((number, _), _)| *number);
    found.dedup_by_key(|((number, _), _)| *number);
    let exact = |((_, entry), configuration): &((u32, Arc<Entry>), &Configuration)| {
        let plan = Plan::build(configuration, options).expect("the options are sound");
        let kept = entry.plan();
        assert_eq!(
            (&plan.nodes, plan.stencils.len()),
            (&kept.nodes, kept.stencils.len())
        );
        for number in 0..kept.stencils.len() {
            let rounded = kept.stencils.weights(number).into_iter();
            let weights = plan.stencils.weights(number).into_iter();
            assert!(rounded.eq(weights.map(|weight| f64::from(weight as f32))));
        }
        plan
    };
    found.iter().map(exact).collect()
}

fn packed(plans: &[Plan]) -> PackedPlans {
    let mut packed = PackedPlans::default();
    for plan in plans {
        packed.push(plan).expect("it is of a size");
    }
    packed
}

/// Points are weighted means of the ring, or differences of two: those deep in the tree are relative to one of the first.
fn hold_sums(plan: &Plan) {
    for number in 0..plan.stencils.len() {
        let weights = plan.stencils.weights(number);
        let sum: f64 = weights.iter().sum();
        let size: f64 = weights.iter().map(|w| w.abs()).sum();
        let off = (sum - sum.round()).abs();
        let whole = sum.round() == 1.0 || sum.round() == 0.0 && number > 0;
        assert!(off < 1e-12 * size.max(1.0) && whole, "{number}: {sum}");
        assert_eq!(weights.len(), plan.ring_size);
    }
    let levels: Vec<u32> = (0..plan.stencils.len())
        .map(|number| plan.stencils.level(number))
        .collect();
    assert!(levels.is_sorted() && levels.iter().all(|&level| level <= plan.max_level));
}

/// Children lie behind their parents, and points are stencils there are: so every walk ends, and reads what it may.
fn hold_tree(plan: &Plan, children_each: usize) {
    let stencils = plan.stencils.len() as u32;
    for (number, node) in plan.nodes.iter().enumerate() {
        match node {
            Node::Internal { children } => {
                assert!(*children as usize > number);
                assert!(*children as usize + children_each <= plan.nodes.len());
            }
            Node::Regular { points, .. } => assert!(points.iter().all(|&p| p < stencils)),
            Node::Crease {
                points,
                edge,
                sharpness,
                ..
            } => {
                assert!(points.iter().all(|&p| p < stencils));
                assert!(*edge < 4 && *sharpness > 0.0);
            }
            Node::Terminal { corner, levels, .. } => {
                assert!(*corner < 4 && !levels.is_empty());
                assert!(levels.iter().flatten().all(|&p| p < stencils));
            }
            Node::Curve {
                points,
                edge,
                sharpness,
                ..
            } => {
                assert!(points.iter().all(|&p| p < stencils) && points.len() % 16 == 0);
                assert!([1, 3].contains(edge) && *sharpness >= 0.0);
            }
            Node::Extraordinary { corner } => assert!(*corner < 4),
        }
    }
}

/// The methods that can draw the model.
fn able(model: &Model) -> impl Iterator<Item = &'static Method> + '_ {
    METHODS
        .iter()
        .filter(|method| method.check_model(model).is_ok())
}

/// The points that the evaluation at (u, v) reads; None where it stops at an extraordinary vertex.
fn points_read(packed: &PackedPlans, plan: u32, uv: Vec2) -> Option<Vec<u32>> {
    let plans = packed.view();
    let leaf = walk(plans, packed.headers[plan as usize].root, uv).expect("it is packed");
    let point = |i: u32| {
        let point = plans.point(leaf.points + i);
        point.expect("a leaf has its points")
    };
    let base = (leaf.base > 0).then(|| leaf.base - 1);
    (leaf.kind != abi::NODE_EXTRAORDINARY).then(|| (0..16).map(point).chain(base).collect())
}

/// Every point that a coordinate reads is among those that its tess level has.
fn hold_counts(packed: &PackedPlans, plan: u32, level: f32, coordinates: &[[f32; 2]]) {
    let header = packed.headers[plan as usize];
    let levels = Levels {
        domain: Domain::Quads,
        cells: [1; 2],
        edges: [1.0; 4],
        inside: level,
    };
    let count = header.counts[required_level(&levels, header.max_level) as usize];
    for &uv in coordinates {
        let read = points_read(packed, plan, Vec2::from(uv));
        let read = read.unwrap_or_else(|| panic!("plan {plan}: no patch at {uv:?}"));
        let last = read.iter().max().expect("an evaluation reads points");
        assert!(
            *last < count,
            "plan {plan}, tess level {level}, {uv:?}: point {last} of {count}"
        );
    }
}

/// Coordinates of an equal spacing between the ends, as quotients and as what is left of 1.
fn steps(level: u32) -> Vec<f32> {
    let quotients = (1..level).map(|i| i as f32 / level as f32);
    let rests = (1..level).map(|i| 1.0 - i as f32 / level as f32);
    quotients.chain(rests).collect()
}

/// All coordinates of one level inside.
fn lattice(level: u32) -> Vec<[f32; 2]> {
    let steps = steps(level);
    let grid = steps
        .iter()
        .flat_map(|&u| steps.iter().map(move |&v| [u, v]));
    grid.collect()
}

/// Coordinates on no lattice that keep 1 / ceil(level) from the edges, as fractional spacing may make them.
fn fractional(level: f32, seed: u64) -> Vec<[f32; 2]> {
    let margin = 1.0 / level.ceil();
    let at = |x: f64| {
        (margin + (1.0 - 2.0 * margin) * (0.5 * x as f32 + 0.5)).clamp(margin, 1.0 - margin)
    };
    let points = (0..40).map(|i| scatter(40 * seed + i));
    points
        .flat_map(|p| {
            let [u, v] = [at(p.x), at(p.y)];
            [[u, v], [margin, v], [u, 1.0 - margin]]
        })
        .collect()
}

/// Holds the counts of every plan at the given levels.
fn hold_levels(packed: &PackedPlans, levels: &[u32], seed: u64) {
    let deepest = packed.headers.first().map_or(0, |header| header.max_level);
    for plan in 0..packed.headers.len() as u32 {
        assert!(packed.headers[plan as usize].counts.is_sorted());
        for &level in levels.iter().filter(|&&level| level <= 1 << deepest) {
            hold_counts(packed, plan, level as f32, &lattice(level));
            let between = level as f32 - 0.5 * (1.0 + scatter(seed + u64::from(level)).x as f32);
            if between > 1.0 {
                hold_counts(packed, plan, between, &fractional(between, seed));
            }
        }
    }
}

fn hold(mesh: &ControlMesh, options: PlanOptions, levels: &[u32]) {
    let plans = plans(mesh, options);
    for plan in &plans {
        hold_sums(plan);
        hold_tree(plan, 4);
        assert_eq!(plan.max_level, options.max_level);
    }
    hold_levels(&packed(&plans), levels, plans.len() as u64);
    hold_edges(mesh, options, levels);
}

/// What holds of plans holds of those of edges: sums, trees, and points that each level counts.
fn hold_edges(mesh: &ControlMesh, options: PlanOptions, levels: &[u32]) {
    let topology = Topology::new(mesh);
    for edge in 0..topology.edge_count() as u32 {
        let ring = Ring::of_edge(&topology, edge).expect("it is an edge");
        let EdgePlan { plan, sides } =
            EdgePlan::build(&ring.configuration, EdgeKind::Whole, options).expect("sound");
        hold_sums(&plan);
        hold_tree(&plan, 2);
        assert!(sides.is_empty() || sides.len() == topology.edge_faces(edge).len());
        let packed = packed(&[plan]);
        for &level in levels
            .iter()
            .filter(|&&level| level <= 1 << options.max_level)
        {
            let along: Vec<[f32; 2]> = steps(level).iter().map(|&t| [t, 0.0]).collect();
            hold_counts(&packed, 0, level as f32, &along);
        }
    }
}

proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn plans_of_random_meshes_are_sound_and_need_no_more_points_than_they_count(
        recipe in wild(), max_level in 1u32..=6, direct_creases in any::<bool>(), level in 3u32..64,
    ) {
        let options = PlanOptions { max_level, direct_creases };
        hold(&recipe.mesh(), options, &[1, 2, 3, 4, 8, 9, level]);
    }

    /// The topology that a configuration tells has the limits of the mesh it was taken from.
    #[test]
    fn configurations_tell_all_that_shapes_a_vertex(recipe in wild()) {
        let mesh = recipe.mesh();
        let truth = LimitSurface::new(&mesh);
        for ptex in 0..truth.ptex_count() {
            let (face, corner) = truth.face_corner(ptex).expect("it is a ptex face");
            let Some(expected) = truth.evaluate(ptex, 0.0, 0.0) else { continue };
            let vertex = mesh.face(face as usize)[corner as usize];
            let ring = Ring::of_vertex(truth.topology(), vertex).expect("a face has it");
            let VertexPlan { plan, sides, .. } = VertexPlan::build(&ring.configuration, VertexKind::Control, PlanOptions::default()).expect("sound");
            let positions: Vec<DVec3> = ring.vertices.iter().map(|&v| mesh.positions()[v as usize]).collect();
            prop_assert_eq!((plan.ring_size, sides.len()), (positions.len(), ring.faces.len()));
            let weights = plan.stencils.weights(0).into_iter().enumerate();
            let limit = DVec3::blend(&weights.map(|(i, w)| (i as u32, w)).collect::<Vec<_>>(), &positions);
            prop_assert!(limit.distance(expected.position) < 1e-12 * (1.0 + expected.position.length()));
        }
        for (_, ring) in rings(truth.topology()) {
            let again = from_corner(&ring.configuration.topology(), 0, 0).configuration;
            prop_assert_eq!(&again, &ring.configuration);
        }
    }

    /// One patch a quad, or four or as many pieces as it takes where the method refines first, and one a corner of an n-gon; none a hole.
    #[test]
    fn every_method_makes_patches_of_each_ptex_face_that_is_no_hole(recipe in manifold()) {
        let model = Model::new(recipe.mesh());
        let truth = LimitSurface::new(model.mesh());
        let is_hole = |ptex: u32| truth.face_corner(ptex as usize).is_some_and(|(face, _)| model.topology().is_hole(face));
        let expected = (0..truth.ptex_count() as u32).filter(|&ptex| !is_hole(ptex));
        let expected: Vec<u32> = expected.collect();
        for method in able(&model) {
            let prepared = method.prepare(&model, PlanOptions::default()).expect("sound options");
            for level in [1.0, 6.0, 64.0] {
                let cut = Cut { level, spacing: Spacing::Equal };
                // The share of each ptex face that is drawn.
                let mut found = std::collections::BTreeMap::new();
                for pass in &prepared.passes {
                    let drawn = (0..pass.patches.len()).filter(|&patch| cut.levels(pass, patch).is_some());
                    for patch in drawn.map(|patch| &pass.patches[patch]) {
                        *found.entry(patch.ptex).or_default() += match patch.flags >> abi::PATCH_CHILD_SHIFT & 15 {
                            0 => 1.0,
                            abi::CHILD_PIECE => 0.25f64.powi((patch.plan >> abi::PIECE_DEPTH_SHIFT) as i32),
                            _ => 0.25,
                        };
                    }
                }
                let whole = expected.iter().map(|&ptex| (ptex, 1.0)).collect();
                prop_assert_eq!(&found, &whole, "{} {}", method.name, level);
            }
        }
    }
}

#[test]
fn every_tess_level_finds_its_points_among_those_it_counts() {
    let all: Vec<u32> = (1..=64).collect();
    for (name, stride) in [
        ("hull", 3),
        ("ngons", 1),
        ("creased-torus", 1),
        ("sheet", 1),
    ] {
        let mesh = builtin(name).expect("a built-in shape");
        let plans = plans(&mesh, PlanOptions::default());
        let chosen: Vec<Plan> = plans.into_iter().step_by(stride).take(8).collect();
        hold_levels(&packed(&chosen), &all, 1);
    }
}

/// Towards an extraordinary vertex cells are ever deeper, and patches of one plan have the same.
#[test]
fn cells_tell_plans_and_nodes() {
    let model = Model::new(builtin("pole-5").expect("a built-in shape"));
    let mut plans = 0;
    for method in able(&model) {
        let prepared = method
            .prepare(&model, PlanOptions::default())
            .expect("sound options");
        for pass in &prepared.passes {
            let cells = (0..pass.patches.len()).map(|patch| {
                let at = |u: f32, v: f32| pass.cell(patch, Vec2::new(u, v));
                assert_eq!(at(f32::NAN, 0.5), None);
                // From the middle to each corner.
                let to = |corner: [f32; 2]| {
                    [0.5, 0.26, 0.126, 0.02].map(|t: f32| {
                        let [u, v] = corner.map(|end| t + end * (1.0 - 2.0 * t));
                        at(u, v)
                    })
                };
                let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(to);
                (pass.patches[patch].plan, corners)
            });
            let cells: Vec<_> = cells.collect();
            assert_eq!(pass.cell(cells.len(), Vec2::ZERO), None);
            for (plan, cell) in &cells {
                let same = cells.iter().filter(|(other, _)| other == plan);
                assert!(same.clone().all(|(_, other)| other[0][0] == cell[0][0]));
            }
            let numbers: std::collections::BTreeSet<u32> = cells
                .iter()
                .filter_map(|(_, cell)| Some(cell[0][0]?.plan))
                .collect();
            assert!(numbers.iter().copied().eq(0..numbers.len() as u32));
            plans += numbers.len();
            let deeper = |cell: &[Option<Cell>; 4]| {
                let depths = cell.iter().flatten().map(|cell| cell.depth);
                let depths: Vec<u32> = depths.collect();
                depths.is_sorted() && depths.last() >= Some(&5)
            };
            let irregular = cells.iter().any(|(_, cell)| cell.iter().any(deeper));
            assert_eq!(irregular, !numbers.is_empty(), "{}", pass.shader);
        }
    }
    assert!(plans > 0);
}

#[test]
fn plans_of_every_shared_shape_are_sound() {
    for path in common::obj_files("shapes") {
        if let (true, Ok(mesh)) = (common::stem(&path).starts_with("catmark"), read_obj(&path)) {
            hold(&mesh, PlanOptions::default(), &[1, 2, 3, 7, 33]);
        }
    }
}

/// (model, regular, irregular, most plans).
#[test]
fn shared_models_have_the_papers_numbers_of_patches() {
    for (name, regular, irregular, plans) in [
        ("bigguy", 858, 592, 19),
        ("armorguy", 962, 8409, usize::MAX),
    ] {
        let Some(mesh) = common::model(name) else {
            continue;
        };
        let surfaces = Surfaces::of(mesh, PlanOptions::default());
        let found = surfaces.prepared.plans.expect("the method has plans");
        assert_eq!(
            (found.regular, found.irregular),
            (regular, irregular),
            "{name}"
        );
        assert!(found.plans <= plans, "{name} has {} plans", found.plans);
    }
}

#[test]
fn shared_models_have_sound_plans() {
    for name in ["bigguy", "monsterfrog", "car"] {
        if let Some(mesh) = common::model(name) {
            let all = plans(&mesh, PlanOptions::default());
            assert!(!all.is_empty());
            for plan in &all {
                hold_sums(plan);
                hold_tree(plan, 4);
            }
            let some: Vec<Plan> = all.into_iter().step_by(11).collect();
            hold_levels(&packed(&some), &[1, 2, 3, 4, 5, 8, 9, 17, 64], 7);
        }
    }
}

/// A plane of quads whose middle face, with one creased edge, begins at corner `turn`.
fn creased_sheet(turn: usize) -> ControlMesh {
    let positions: Vec<[f64; 3]> = (0..36)
        .map(|i| [f64::from(i % 6), f64::from(i / 6), scatter(i as u64).z])
        .collect();
    let mut faces = Vec::new();
    for (y, x) in (0..5u32).flat_map(|y| (0..5).map(move |x| (y, x))) {
        let mut face = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| x + i + 6 * (y + j));
        if (x, y) == (2, 2) {
            face.rotate_left(turn);
        }
        faces.extend(face);
    }
    let line = [12, 13, 14, 15, 16, 17];
    let builder = ControlMesh::builder(&positions, &[4; 25], &faces);
    let builder = line
        .windows(2)
        .fold(builder, |b, edge| b.crease(edge[0], edge[1], 2.3));
    builder.build().expect("sound")
}

#[test]
fn a_creased_face_has_the_same_plan_however_it_is_turned() {
    let configuration = |turn| {
        let topology = Topology::new(&creased_sheet(turn));
        of_quad(&topology, 12).configuration
    };
    for turn in 1..4 {
        assert_eq!(configuration(turn), configuration(0));
    }
    let method = method("quadtree").expect("it is in the table");
    let [plain, turned] = [0, 1].map(|turn| {
        let model = Model::new(creased_sheet(turn));
        let prepared = method
            .prepare(&model, PlanOptions::default())
            .expect("sound");
        prepared.plans.expect("the method has plans").plans
    });
    assert_eq!(plain, turned);
}

#[test]
fn patches_of_n_gons_are_marked_as_halves_and_their_neighbours_edges_as_even() {
    let model = Model::new(builtin("ngons").expect("a built-in shape"));
    for method in able(&model) {
        let prepared = method
            .prepare(&model, PlanOptions::default())
            .expect("sound options");
        let offsets = model.mesh().ptex_offsets();
        let patches = prepared.passes.iter().flat_map(|pass| &pass.patches);
        // Edges of pieces are as the levels on both sides want them, see `method/fas/tests.rs`.
        let is_piece =
            |patch: &&abi::Patch| patch.flags >> abi::PATCH_CHILD_SHIFT & 15 == abi::CHILD_PIECE;
        for patch in patches.filter(|patch| !is_piece(patch)) {
            let face = offsets.partition_point(|&first| first <= patch.ptex) as u32 - 1;
            let quad = model.topology().face(face).len() == 4;
            assert_eq!(patch.flags & abi::PATCH_HALF == 0, quad);
            let turn = patch.flags >> abi::PATCH_TURN_SHIFT & 3;
            for edge in (0..4).filter(|_| quad) {
                let number = model.topology().face_edges(face)[(edge + turn as usize) % 4];
                let neighbours = model.topology().edge_faces(number).iter();
                let n_gon = neighbours
                    .clone()
                    .any(|&f| model.topology().face(f).len() != 4);
                let even = patch.flags & abi::PATCH_EVEN_EDGE << edge != 0;
                assert_eq!(even, n_gon, "{} patch {patch:?}", method.name);
            }
        }
    }
}
