//! Facts about all schemes over random meshes: refinement does not change the limit, neighbours agree, and schemes agree where they should.

mod common;

use common::meshes::{Recipe, cases, manifold, wild};
use hullform::mesh::{ControlMesh, INFINITE_SHARPNESS, Scheme, Triangulation, triangulated};
use hullform::subdivision::{LimitSample, LimitSurface, refine_all, vertex_limit};
use proptest::prelude::*;

/// The random mesh under a scheme, triangulated where that asks for it, without semi-sharp tags under the butterfly.
fn mesh(recipe: &Recipe, scheme: Scheme) -> ControlMesh {
    let mut mesh = recipe.mesh();
    if scheme.is_triangular() {
        mesh = triangulated(&mesh, Triangulation::Fan).expect("it is sound");
    }
    if scheme == Scheme::Butterfly {
        mesh = without_semi_sharp(&mesh);
    }
    mesh.with_scheme(scheme)
        .expect("it has what the scheme takes")
}

fn without_semi_sharp(mesh: &ControlMesh) -> ControlMesh {
    let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
    let sizes: Vec<u32> = mesh.faces().map(|face| face.len() as u32).collect();
    let faces: Vec<u32> = mesh.faces().flatten().copied().collect();
    let mut builder = ControlMesh::builder(&positions, &sizes, &faces).options(mesh.options());
    for crease in mesh
        .creases()
        .iter()
        .filter(|crease| crease.sharpness > 2.0)
    {
        builder = builder.crease(crease.vertices[0], crease.vertices[1], INFINITE_SHARPNESS);
    }
    builder.build().expect("it was sound before")
}

/// Points of a triangle: corners, middles, and some that no finite refinement reaches.
const TRIANGLE: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [0.5, 0.0],
    [0.25, 0.75],
    [0.3, 0.3],
    [0.01, 0.02],
    [0.7, 0.21],
    [0.1, 0.85],
];

/// The number of a triangle's child and the (u, v) there of a point of the parent, by what the documentation says.
fn child_of_triangle([u, v]: [f64; 2]) -> (usize, [f64; 2]) {
    if u >= 0.5 {
        (1, [2.0 * u - 1.0, 2.0 * v])
    } else if v >= 0.5 {
        (2, [2.0 * u, 2.0 * v - 1.0])
    } else if u + v <= 0.5 {
        (0, [2.0 * u, 2.0 * v])
    } else {
        (3, [1.0 - 2.0 * u, 1.0 - 2.0 * v])
    }
}

/// Whether refining changes no position, by more than `bound` of the diagonal.
fn hold_refined(mesh: &ControlMesh, bound: f64) -> Result<(), TestCaseError> {
    let surface = LimitSurface::new(mesh);
    let refined = surface.refined();
    prop_assert_eq!(refined.ptex_count(), 4 * surface.ptex_count());
    let diagonal = common::diagonal(mesh);
    for ptex in 0..surface.ptex_count() {
        for uv in TRIANGLE {
            let (child, at) = child_of_triangle(uv);
            let before = surface.evaluate(ptex, uv[0], uv[1]);
            let after = refined.evaluate(4 * ptex + child, at[0], at[1]);
            prop_assert_eq!(before.is_some(), after.is_some());
            let Some((before, after)) = before.zip(after) else {
                continue;
            };
            let distance = before.position.distance(after.position) / diagonal;
            prop_assert!(
                distance < bound,
                "face {} at {:?}: {:e}",
                ptex,
                uv,
                distance
            );
        }
    }
    Ok(())
}

/// The limit at `t` along side `corner` of a face that is a ptex face of its own.
fn on_side(
    surface: &LimitSurface,
    ptex: usize,
    arity: usize,
    corner: usize,
    t: f64,
) -> Option<LimitSample> {
    let s = 1.0 - t;
    let [u, v] = match (arity, corner) {
        (_, 0) => [t, 0.0],
        (3, 1) => [s, t],
        (3, _) => [0.0, s],
        (_, 1) => [1.0, t],
        (_, 2) => [s, 1.0],
        _ => [0.0, s],
    };
    surface.evaluate(ptex, u, v)
}

/// Whether both faces of every edge have the same limit along it.
fn hold_edges(mesh: &ControlMesh, bound: f64) -> Result<(), TestCaseError> {
    let surface = LimitSurface::new(mesh);
    let (topology, offsets) = (surface.topology(), mesh.ptex_offsets());
    let diagonal = common::diagonal(mesh);
    for edge in 0..topology.edge_count() as u32 {
        let sides = topology.edge_faces(edge).iter().filter_map(|&face| {
            let arity = topology.face(face).len();
            let corner = topology.face_edges(face).iter().position(|&e| e == edge)?;
            let forward =
                topology.face(face)[corner] == topology.edges()[edge as usize].vertices[0];
            (arity <= 4).then_some((offsets[face as usize] as usize, arity, corner, forward))
        });
        let sides: Vec<_> = sides.collect();
        for pair in sides.windows(2) {
            for t in [0.0, 1.0 / 3.0, 0.5, 0.77] {
                let [a, b] = [pair[0], pair[1]].map(|(ptex, arity, corner, forward)| {
                    on_side(
                        &surface,
                        ptex,
                        arity,
                        corner,
                        if forward { t } else { 1.0 - t },
                    )
                });
                if let Some((a, b)) = a.zip(b) {
                    let distance = a.position.distance(b.position) / diagonal;
                    prop_assert!(distance < bound, "edge {} at {}: {:e}", edge, t, distance);
                }
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn refinement_leaves_the_limit_of_loop_where_it_is(recipe in manifold()) {
        hold_refined(&mesh(&recipe, Scheme::Loop), 1e-12)?;
    }

    #[test]
    fn refinement_leaves_the_limit_of_loop_where_it_is_on_wild_meshes(recipe in wild()) {
        hold_refined(&mesh(&recipe, Scheme::Loop), 1e-12)?;
    }

    #[test]
    fn loop_limits_are_continuous(recipe in wild()) {
        hold_edges(&mesh(&recipe, Scheme::Loop), 1e-12)?;
    }

    #[test]
    fn loop_stam_limits_are_continuous(recipe in wild()) {
        hold_edges(&mesh(&recipe, Scheme::LoopStam), 1e-11)?;
    }

    #[test]
    fn loop_stam_is_loop_among_triangles(recipe in manifold()) {
        let mesh = mesh(&recipe, Scheme::Loop);
        let (a, b) = (LimitSurface::new(&mesh), LimitSurface::of_scheme(&mesh, Scheme::LoopStam).expect("it takes all faces"));
        for (ptex, [u, v]) in (0..a.ptex_count()).flat_map(|ptex| TRIANGLE.map(|uv| (ptex, uv))) {
            let (a, b) = (a.evaluate(ptex, u, v), b.evaluate(ptex, u, v));
            prop_assert_eq!(a.is_some(), b.is_some());
            let Some((a, b)) = a.zip(b) else { continue };
            prop_assert!(a.position.distance(b.position) < 1e-12);
        }
    }

    #[test]
    fn every_scheme_refines_to_weights_that_sum_to_one(recipe in wild()) {
        for scheme in Scheme::ALL {
            let surface = LimitSurface::new(&mesh(&recipe, scheme));
            let refined = refine_all(surface.topology(), scheme);
            for mask in &refined.masks {
                let sum: f64 = mask.iter().map(|term| term.1).sum();
                prop_assert!((sum - 1.0).abs() < 1e-12, "{}: {}", scheme, sum);
            }
            for face in 0..refined.topology.face_count() as u32 {
                let Some(limit) = vertex_limit(&refined.topology, scheme, face, 0) else { continue };
                let sum = |mask: &[(u32, f64)]| mask.iter().map(|term| term.1).sum::<f64>();
                prop_assert!((sum(&limit.position) - 1.0).abs() < 1e-12, "{}", scheme);
                prop_assert!(sum(&limit.du).abs() < 1e-9 && sum(&limit.dv).abs() < 1e-9, "{}", scheme);
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(6))]

    #[test]
    fn refinement_leaves_the_limit_of_the_butterfly_where_it_is(recipe in manifold()) {
        hold_refined(&mesh(&recipe, Scheme::Butterfly), 1e-11)?;
    }

    #[test]
    fn butterfly_limits_are_continuous_and_pass_through_the_control_vertices(recipe in wild()) {
        let mesh = mesh(&recipe, Scheme::Butterfly);
        hold_edges(&mesh, 1e-11)?;
        let surface = LimitSurface::new(&mesh);
        for (number, face) in mesh.faces().enumerate() {
            for ([u, v], &vertex) in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].into_iter().zip(face) {
                let Some(limit) = surface.evaluate(number, u, v) else { continue };
                prop_assert_eq!(limit.position, mesh.positions()[vertex as usize]);
            }
        }
    }
}

/// The models' quads under Loop-Stam and Catmull-Clark.
#[test]
fn loop_stam_is_catmull_clark_among_quads() {
    for name in ["cube", "creased-torus", "sheet"] {
        let mesh = hullform::mesh::builtin(name).expect("it is built in");
        let a = LimitSurface::new(&mesh);
        let b = LimitSurface::of_scheme(&mesh, Scheme::LoopStam).expect("it takes all faces");
        let diagonal = common::diagonal(&mesh);
        for ptex in (0..a.ptex_count()).step_by(3) {
            for [u, v] in TRIANGLE {
                let (a, b) = (a.evaluate(ptex, u, v), b.evaluate(ptex, u, v));
                assert_eq!(a.is_some(), b.is_some());
                let Some((a, b)) = a.zip(b) else { continue };
                assert!(a.position.distance(b.position) < 1e-13 * diagonal, "{name}");
                assert!(a.du.distance(b.du) < 1e-10 * diagonal, "{name}");
            }
        }
    }
}
