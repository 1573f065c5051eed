//! Whatever numbers a caller gives, functions answer or refuse: they never panic.

use glam::{DVec3, Vec2, Vec3};
use hullform::frame::{Backend, Cut, DrawList, SurfaceOptions};
use hullform::mesh::topology::{FaceCorner, Topology};
use hullform::mesh::{ControlMesh, Model, Scheme, Triangulation, builtin, sharpness, triangulated};
use hullform::method::{
    DepthTags, Displacement, METHODS, MethodOptions, Outline, Pass, Prepared, SurfacePoint,
    TableOptions, from_ptex, is_on_hexagon, method, method_for, prepare_by_default, to_ptex,
};
use hullform::plan::database::Kind;
use hullform::plan::{
    Configuration, Database, EdgeKind, EdgePlan, PackedPlans, Plan, PlanOptions, Plans, Ring,
    VertexKind, VertexPlan, walk,
};
use hullform::subdivision::{
    Blend, LimitSurface, Mask, deep_limit, is_cusp, limit_stencil, refine, refine_all, vertex_limit,
};
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse, abi, patch};

/// Numbers that small meshes have, and numbers that no mesh has.
const NUMBERS: [u32; 7] = [0, 1, 5, 29, 4_000, u32::MAX - 1, u32::MAX];

/// Numbers that are coordinates of nothing.
const ODD: [f32; 7] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    -1.0,
    2.0,
    1e30,
    1e-40,
];

/// Small meshes, one of each kind of face, under each scheme that takes them.
fn meshes() -> Vec<ControlMesh> {
    let mut all = Vec::new();
    for name in ["cube", "ngons", "star", "sheet"] {
        let Ok(mesh) = builtin(name) else { continue };
        let triangles = triangulated(&mesh, Triangulation::default()).expect("it is sound");
        for scheme in Scheme::ALL {
            let taken = [&mesh, &triangles].map(|mesh| mesh.clone().with_scheme(scheme));
            all.extend(taken.into_iter().flatten());
        }
    }
    assert!(all.len() > 10);
    all
}

fn pairs() -> impl Iterator<Item = (u32, u32)> {
    NUMBERS.into_iter().flat_map(|a| NUMBERS.map(|b| (a, b)))
}

#[test]
fn a_topology_answers_for_every_number() {
    let empty = Topology::default();
    assert_eq!(
        (empty.face_count(), empty.edge_count(), empty.vertex_count()),
        (0, 0, 0)
    );
    for topology in meshes().iter().map(Topology::new).chain([empty]) {
        for number in NUMBERS {
            let is_face = (number as usize) < topology.face_count();
            let is_edge = (number as usize) < topology.edge_count();
            let is_vertex = (number as usize) < topology.vertex_count();
            assert_eq!(topology.face(number).is_empty(), !is_face);
            assert_eq!(topology.face_edges(number).is_empty(), !is_face);
            assert_eq!(topology.edge_faces(number).is_empty(), !is_edge);
            assert_eq!(topology.vertex_faces(number).is_empty(), !is_vertex);
            assert_eq!(topology.vertex_edges(number).is_empty(), !is_vertex);
            assert_eq!(topology.edges().get(number as usize).is_some(), is_edge);
            if !is_vertex {
                assert_eq!(topology.vertex_sharpness(number), 0.0);
                assert_eq!(topology.sharp_edges(number).count(), 0);
            }
            assert!(is_face || !topology.is_hole(number));
        }
        for (face, corner) in pairs() {
            let is_corner = (corner as usize) < topology.face(face).len();
            assert_eq!(
                topology.fan_at(FaceCorner { face, corner }).is_some(),
                is_corner
            );
        }
    }
    for mesh in meshes() {
        for face in NUMBERS
            .map(|number| number as usize)
            .into_iter()
            .chain([usize::MAX])
        {
            assert_eq!(mesh.face(face).len(), mesh.corner_range(face).len());
            assert_eq!(mesh.face(face).is_empty(), face >= mesh.face_count());
        }
    }
    for value in ODD {
        sharpness::decayed(value);
        sharpness::rule(value, usize::MAX);
        for creasing in [Default::default(), hullform::mesh::CreaseMethod::Chaikin] {
            sharpness::decayed_around_vertex(creasing, &[value, 2.0, value]);
        }
    }
}

#[test]
fn limits_are_none_where_there_is_no_corner() {
    for mesh in meshes() {
        let topology = Topology::new(&mesh);
        let own = topology.options().scheme;
        for (face, corner) in pairs() {
            let is_corner = (corner as usize) < topology.face(face).len();
            let deep = deep_limit(&topology, own, face, corner);
            assert_eq!(deep.is_some(), is_corner);
            if let Some(deep) = deep {
                let sum: f64 = deep.position.iter().map(|&(_, weight)| weight).sum();
                assert!((sum - 1.0).abs() < 1e-12);
            }
            if !is_corner {
                assert!(!is_cusp(&topology, face, corner));
                assert_eq!(limit_stencil(&topology, face, corner), None);
                for scheme in Scheme::ALL {
                    assert_eq!(vertex_limit(&topology, scheme, face, corner), None);
                }
            }
            let refined = refine(&topology, &[(face, corner), (0, 0)]);
            assert_eq!(refined.cells, 1 + u32::from(is_corner));
        }
        // Under a scheme that takes no such faces nothing is promised but an answer.
        for scheme in Scheme::ALL {
            refine_all(&topology, scheme);
            for corner in 0..topology.face(0).len() as u32 {
                vertex_limit(&topology, scheme, 0, corner);
                deep_limit(&topology, scheme, 0, corner);
            }
            let surface = LimitSurface::of_scheme(&mesh, scheme);
            assert_eq!(surface.is_ok(), scheme.check(&mesh).is_ok());
        }
    }
    let foreign = [(7, 1.0), (u32::MAX, 2.0)];
    assert_eq!(DVec3::blend(&foreign, &[DVec3::ONE]), DVec3::ZERO);
    assert_eq!(Vec::blend(&foreign, &[vec![1.0]]), [0.0]);
    assert!(Vec::blend(&foreign, &[]).is_empty());
    assert!(Mask::blend(&foreign, &[]).is_empty());
}

#[test]
fn a_surface_is_none_where_there_is_no_face() {
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh);
        for ptex in NUMBERS
            .map(|number| number as usize)
            .into_iter()
            .chain([usize::MAX])
        {
            let known = ptex < surface.ptex_count();
            assert_eq!(surface.face_corner(ptex).is_some(), known);
            assert!(known || surface.evaluate(ptex, 0.5, 0.5).is_none());
            for odd in ODD {
                let sample = surface.evaluate(ptex, odd.into(), 0.5);
                assert_eq!(sample.is_some(), known && !odd.is_nan());
            }
        }
        for vertex in NUMBERS {
            let known = (vertex as usize) < mesh.vertex_count();
            assert!(known || surface.position(vertex) == DVec3::ZERO);
        }
    }
}

/// The plans of a mesh's faces, edges and vertices, whatever the options and numbers: soundly made, or refused.
#[test]
fn plans_are_made_of_what_they_need_or_refused() {
    let mesh = builtin("ngons").expect("it is built in");
    let topology = Topology::new(&mesh);
    let mut known: Vec<Configuration> = Vec::new();
    for (number, other) in pairs() {
        let rings = [
            Ring::of_quad(&topology, number),
            Ring::from_corner(&topology, number, other),
            Ring::of_edge(&topology, number),
            Ring::of_vertex(&topology, number),
        ];
        let expected = [
            topology.face(number).len() == 4,
            (other as usize) < topology.face(number).len(),
            (number as usize) < topology.edge_count(),
            (number as usize) < topology.vertex_count(),
        ];
        assert_eq!(rings.each_ref().map(Option::is_some), expected);
        known.extend(rings.into_iter().flatten().map(|ring| ring.configuration));
    }
    known.sort();
    known.dedup();
    let mut refused = 0;
    for configuration in &known {
        let options = PlanOptions {
            max_level: 3,
            ..PlanOptions::default()
        };
        let of_edges = [EdgeKind::Whole, EdgeKind::Spoke]
            .map(|kind| EdgePlan::build(configuration, kind, options).map(|made| made.plan));
        let of_vertices = [VertexKind::Control, VertexKind::Centre]
            .map(|kind| VertexPlan::build(configuration, kind, options).map(|made| made.plan));
        let made = of_edges.into_iter().chain(of_vertices);
        for made in made.chain([Plan::build(configuration, options)]) {
            match made {
                Ok(plan) => PackedPlans::default().push(&plan).expect("it is small"),
                Err(error) => {
                    refused += 1;
                    assert!(
                        matches!(error, Error::Misuse(Misuse::Ring { .. })),
                        "{error}"
                    );
                }
            }
        }
        for max_level in [0, 11, 40, u32::MAX] {
            let options = PlanOptions {
                max_level,
                ..options
            };
            let database = Database::default();
            assert!(matches!(
                Plan::build(configuration, options),
                Err(Error::Option { .. })
            ));
            for kind in Kind::ALL {
                assert!(database.plans(kind, options, &[configuration]).is_err());
            }
            assert!(database.is_empty());
            assert!(EdgePlan::build(configuration, EdgeKind::Whole, options).is_err());
            assert!(VertexPlan::build(configuration, VertexKind::Control, options).is_err());
        }
    }
    assert!(refused > 0, "plans of faces want more than a vertex' ring");
}

#[test]
fn walks_end_whatever_the_plans() {
    let configuration = {
        let topology = Topology::new(&builtin("cube").expect("it is built in"));
        Ring::of_quad(&topology, 0)
            .expect("all its faces are")
            .configuration
    };
    let mut packed = PackedPlans::default();
    let plan = Plan::build(&configuration, PlanOptions::default()).expect("the options are sound");
    packed.push(&plan).expect("it is small");
    for root in NUMBERS {
        for (u, v) in ODD.into_iter().flat_map(|u| ODD.map(|v| (u, v))) {
            let leaf = walk(packed.view(), root, Vec2::new(u, v));
            assert_eq!(leaf.is_some(), (root as usize) < packed.nodes.len());
        }
        packed.view().point(root);
    }
    // A tree that leads back to itself.
    let loops = [abi::Node {
        kind: abi::NODE_INTERNAL,
        points: 0,
        sharpness: 0.0,
    }; 4];
    let plans = Plans {
        nodes: &loops,
        ..packed.view()
    };
    assert_eq!(walk(plans, 0, Vec2::splat(0.3)), None);
}

fn prepared(model: &Model) -> impl Iterator<Item = Prepared> + '_ {
    let able = METHODS
        .iter()
        .filter(|method| method.check_model(model).is_ok());
    able.map(|method| {
        method
            .prepare(model, MethodOptions::default())
            .expect("it can draw it")
    })
}

#[test]
fn a_method_has_no_surface_where_there_is_no_patch() {
    for model in meshes().into_iter().map(Model::new) {
        for prepared in prepared(&model) {
            let own = prepared.controls(model.positions());
            let few = prepared.controls(vec![Vec3::ONE; model.mesh().vertex_count() - 1]);
            let none = prepared.controls(Vec::new());
            for pass in &prepared.passes {
                hold_pass(pass, prepared.is_dynamic());
                for controls in [&few, &none] {
                    let point = pass.evaluate(controls, 0, Vec2::splat(0.25));
                    assert_eq!(point, SurfacePoint::default());
                }
                for number in NUMBERS.map(|number| number as usize) {
                    let point = pass.evaluate(&own, number, Vec2::splat(0.25));
                    let is_patch = number < pass.patches.len();
                    assert!(is_patch || point == SurfacePoint::default());
                    assert!(is_patch || pass.texture_coordinates(number, [0.5; 2]) == [0.0; 2]);
                    for odd in ODD {
                        pass.evaluate(&own, number, Vec2::new(odd, 0.5));
                    }
                }
            }
        }
    }
    let bumps = Displacement {
        height: 1.0,
        frequency: 1e30,
    };
    for odd in ODD {
        bumps.displace(Vec3::splat(odd), Vec3::Z);
        is_on_hexagon([odd; 2]);
    }
}

/// What a pass tells of patches that it has not, and of domains that are turned and split in any way.
fn hold_pass(pass: &Pass, is_dynamic: bool) {
    for (patch, level) in pairs() {
        let known = (patch as usize) < pass.patches.len();
        assert!(known || pass.points(patch as usize, level) == 0);
        let cut = Cut {
            level: 4.0,
            spacing: Spacing::Equal,
        };
        let drawn = cut.levels(pass, patch as usize).is_some();
        assert!(drawn == known || known && is_dynamic);
        assert_eq!(cut.vertices(pass, patch as usize) > 0, drawn);
        assert!(known || cut.points(pass, patch as usize) == 0);
    }
    for flags in 0..=255 {
        let patch = abi::Patch {
            flags: flags << abi::PATCH_TURN_SHIFT.min(abi::PATCH_CHILD_SHIFT),
            ..abi::Patch::default()
        };
        for odd in ODD {
            to_ptex(&patch, [odd, 0.5]);
            from_ptex(&patch, [odd, 0.5]);
        }
    }
}

#[test]
fn draw_lists_answer_for_every_pass_and_patch() {
    for model in meshes().into_iter().map(Model::new) {
        let [count, cut] = [model.mesh().vertex_count(), 0];
        let tags = DepthTags::new(vec![cut as f32; count]);
        for prepared in prepared(&model) {
            let options = SurfaceOptions::default();
            let cut = Cut {
                level: 2.0,
                spacing: Spacing::Equal,
            };
            for tags in [None, Some(&tags)] {
                let list = DrawList::new(&prepared, &options, None, cut, tags);
                let list = list.expect("the ring is large");
                for (pass, patch) in pairs() {
                    let pass = pass as usize;
                    let known = prepared.passes.get(pass);
                    let known = known.is_some_and(|pass| (patch as usize) < pass.patches.len());
                    let drawn = list.levels(&prepared, pass, patch).is_some();
                    assert!(drawn == known || known && prepared.is_dynamic());
                    assert_eq!(list.vertices(&prepared, pass, patch) > 0, drawn);
                    assert_eq!(list.triangles(&prepared, pass, patch, &[]), None);
                    assert!(pass < prepared.passes.len() || list.records(pass).is_empty());
                    assert!(list.instances(pass).is_empty());
                }
                assert!(list.round(u32::MAX).is_err());
            }
        }
    }
    for backend in Backend::ALL {
        for level in ODD {
            backend.cut(Cut {
                level,
                spacing: Spacing::Equal,
            });
        }
    }
}

/// Of a patch with a vertex less there are no triangles: others would cover the hole.
#[test]
fn triangles_are_of_all_vertices_or_none() {
    let model = Model::new(builtin("cube").expect("it is built in"));
    for prepared in prepared(&model) {
        let n = 4u32;
        let cut = Cut {
            level: n as f32,
            spacing: Spacing::Equal,
        };
        for backend in Backend::ALL {
            let options = SurfaceOptions {
                backend,
                greatest_level: 4.0,
                ..Default::default()
            };
            let Ok(list) = DrawList::new(&prepared, &options, None, cut, None) else {
                continue;
            };
            let levels = list.levels(&prepared, 0, 0).expect("there is a patch");
            let at = |i: u32| i as f32 / n as f32;
            let grid = (0..=n).flat_map(|j| (0..=n).map(move |i| [at(i), at(j)]));
            let uv: Vec<[f32; 2]> = grid.filter(|&uv| levels.domain.contains(uv)).collect();
            let triangles = |uv: &[[f32; 2]]| list.triangles(&prepared, 0, 0, uv);
            // The tessellator's triangles lie on rings and not on a grid.
            if levels.edges != [n as f32; 4] || levels.domain.corners() == 3 {
                continue;
            }
            let whole = triangles(&uv).expect("nothing lacks");
            assert_eq!(whole.len(), 32);
            for lost in 0..uv.len() {
                let mut rest = uv.clone();
                rest.remove(lost);
                assert_eq!(triangles(&rest), None, "{backend:?} {:?}", uv[lost]);
            }
        }
    }
}

#[test]
fn depths_want_a_tag_a_vertex() {
    let model = Model::new(builtin("cube").expect("it is built in"));
    let count = model.mesh().vertex_count();
    for prepared in prepared(&model) {
        let outline = &prepared.outline;
        let sides = outline.edges().len() + model.mesh().face_count();
        for given in [0, count - 1, count, count + 1] {
            let tags = DepthTags::new(vec![1.0; given]);
            let vertices = vec![Vec3::ONE; given];
            let depths = outline.depths(&tags.depths).map(|depths| depths.len());
            let curved = DepthTags::by_curvature(outline, &vertices, f32::NAN);
            let seen = DepthTags::by_screen(outline, &vertices, [[0.0; 4]; 4], [0.0; 2], 0.0);
            let counts = [
                depths,
                curved.map(|tags| sides * usize::from(tags.depths.len() == count)),
                seen.map(|tags| sides * usize::from(tags.depths.len() == count)),
            ];
            for counted in counts {
                match counted {
                    Ok(counted) => assert_eq!((counted, given), (sides, count)),
                    Err(Error::Misuse(Misuse::Count {
                        given: told,
                        expected,
                        ..
                    })) => {
                        assert_eq!((told, expected), (given, count));
                        assert_ne!(given, count);
                    }
                    Err(error) => panic!("{error}"),
                }
            }
        }
    }
    let outline = prepared(&model).next().expect("a method draws it").outline;
    for odd in ODD {
        let vertices = vec![Vec3::splat(odd); count];
        let tags = DepthTags::by_distance(&outline, &vertices, Vec3::ZERO, odd, odd);
        let tags = tags.expect("a position a vertex");
        let range = 0.0..=DepthTags::DEEPEST;
        assert!(tags.depths.iter().all(|depth| range.contains(depth)));
    }
    assert_eq!(Outline::default().depths(&[]).expect("no side"), []);
}

/// What the best method refuses after all, as it does tables that are too large, the next one draws.
#[test]
fn by_default_the_next_method_draws_what_the_best_refuses() {
    let cube = triangulated(
        &builtin("cube").expect("built in"),
        Triangulation::default(),
    );
    let mesh = cube.expect("it is sound").with_scheme(Scheme::Loop);
    let model = Model::new(mesh.expect("a cube has no tags"));
    let default = MethodOptions::default();
    let best = method_for(&model);
    let (prepared, refusals) = prepare_by_default(&model, default).expect("it can be drawn");
    assert_eq!((prepared.method, refusals.len()), (best.name, 0));
    let options = MethodOptions::from(TableOptions {
        level: 99,
        ..Default::default()
    });
    assert!(best.prepare(&model, options).is_err());
    let (prepared, refusals) = prepare_by_default(&model, options).expect("others have no tables");
    assert_eq!(refusals.len(), 1);
    assert!(refusals[0].to_string().starts_with("--table-level"));
    let next = method(prepared.method).expect("it is in the table");
    assert!(!next.uses_tables);
    assert!(next.check_model(&model).is_ok() && prepared.is_of(&model));
}

#[test]
fn bases_take_any_number() {
    for (a, b) in ODD.into_iter().flat_map(|a| ODD.map(|b| (a, b))) {
        patch::bspline::basis(a);
        patch::bspline::basis_of(a, b);
        patch::boxspline::basis(a, b);
        patch::crease::crease_basis(a, b);
    }
}
