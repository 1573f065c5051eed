//! What both papers promise, on meshes of quads, of triangles and of both.

use glam::{DVec3, Vec2};

use crate::mesh::{ControlMesh, Model, Scheme, Triangulation, builtin, triangulated};
use crate::method::{METHODS, Method};
use crate::subdivision::{LimitSurface, refine_all};
use crate::tessellation::Domain;

/// The methods whose patches are made of spokes.
fn methods() -> impl Iterator<Item = &'static Method> {
    let made =
        |method: &&Method| std::ptr::fn_addr_eq(method.covers, super::check as fn(&Model) -> _);
    METHODS.iter().filter(made)
}

/// A closed ball of quads of valences 3 to 6, all unlike.
pub fn ball() -> Model {
    let mesh = builtin("ngons").expect("it is built in");
    let model = Model::new(mesh);
    let refined = refine_all(model.topology(), Scheme::CatmullClark);
    let positions: Vec<[f64; 3]> = (0u32..)
        .zip(&refined.masks)
        .map(|(number, mask)| {
            let of =
                |&(vertex, weight): &(u32, f64)| weight * model.mesh().positions()[vertex as usize];
            let position: DVec3 = mask.iter().map(of).sum();
            let turn = f64::from(number % 7) - 3.0;
            ((1.0 + 0.02 * turn) * position).to_array()
        })
        .collect();
    let faces = 0..refined.topology.face_count() as u32;
    let faces: Vec<u32> = faces
        .flat_map(|face| refined.topology.face(face).to_vec())
        .collect();
    let sizes = vec![4; refined.topology.face_count()];
    Model::new(
        ControlMesh::builder(&positions, &sizes, &faces)
            .build()
            .expect("it is sound"),
    )
}

/// The same cut into triangles, under Loop's scheme.
pub fn triangular_ball() -> Model {
    let mesh = triangulated(ball().mesh(), Triangulation::default()).expect("it is sound");
    Model::new(mesh.with_scheme(Scheme::Loop).expect("it has no tags"))
}

/// A wavy torus of nothing but regular faces.
fn torus() -> Model {
    let (around, across) = (7u32, 5u32);
    let at = |i: u32, j: u32| i % around * across + j % across;
    let places = || (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let positions: Vec<[f64; 3]> = places()
        .map(|(i, j)| {
            let [a, b] = [(i, around), (j, across)]
                .map(|(i, n)| std::f64::consts::TAU * f64::from(i) / f64::from(n));
            let radius = 2.0 + (1.0 + 0.2 * (3.0 * a).sin()) * b.cos();
            [radius * a.cos(), radius * a.sin(), b.sin()]
        })
        .collect();
    let faces: Vec<u32> = places()
        .flat_map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
        .collect();
    let sizes = vec![4; places().count()];
    Model::new(
        ControlMesh::builder(&positions, &sizes, &faces)
            .build()
            .expect("it is sound"),
    )
}

fn built_in(name: &str, scheme: Scheme) -> Model {
    let mesh = builtin(name).expect("it is built in");
    let mesh = match scheme {
        Scheme::Loop => triangulated(&mesh, Triangulation::default()).expect("it is sound"),
        _ => mesh,
    };
    Model::new(mesh.with_scheme(scheme).expect("it knows the tags"))
}

/// Quads with and without boundaries, triangles, and both.
fn models() -> Vec<(&'static str, Model)> {
    let pole = |name, scheme| (name, built_in(name, scheme));
    vec![
        ("ball", ball()),
        ("torus", torus()),
        pole("cube", Scheme::CatmullClark),
        pole("sheet", Scheme::CatmullClark),
        ("ball", triangular_ball()),
        pole("sheet", Scheme::Loop),
        pole("pole-5", Scheme::LoopStam),
        pole("pole-18", Scheme::LoopStam),
    ]
}

/// What a method has at places of each patch against the limit: the worst distance over the diagonal and the worst angle in degrees.
fn worst(
    method: &Method,
    model: &Model,
    at: &[[f32; 2]],
    counts: impl Fn(u32, [f32; 2]) -> bool,
) -> [f64; 2] {
    let truth = LimitSurface::new(model.mesh());
    let prepared = method.prepare(model, crate::plan::PlanOptions::default());
    let prepared = prepared.expect("it covers the model");
    let controls = prepared.controls(model.positions());
    let (mut worst, mut compared) = ([0.0; 2], 0);
    for pass in &prepared.passes {
        let corners = pass.domain.corners();
        for (number, patch) in pass.patches.iter().enumerate() {
            for &uv in at.iter().filter(|[u, v]| corners == 4 || u + v <= 1.0) {
                if !counts(patch.ptex, uv) {
                    continue;
                }
                let point = pass.evaluate(&controls, number, Vec2::from(uv));
                let [u, v] = uv.map(f64::from);
                let right = truth.evaluate(patch.ptex as usize, u, v).expect("no hole");
                let position = model.placement().local(right.position);
                let off = point.position.as_dvec3().distance(position) / model.diagonal();
                let angle = point.normal.as_dvec3().angle_between(right.normal());
                assert!(
                    off.is_finite() && angle.is_finite(),
                    "{} {uv:?}",
                    method.name
                );
                worst = [
                    f64::max(worst[0], off),
                    f64::max(worst[1], angle.to_degrees()),
                ];
                compared += 1;
            }
        }
    }
    assert!(compared > 8, "{compared} points");
    worst
}

const CORNERS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

#[test]
fn corners_have_the_limit_and_its_tangent_plane() {
    for method in methods() {
        for (name, model) in models() {
            if method.check_model(&model).is_err() {
                continue;
            }
            let scheme = model.mesh().options().scheme;
            let topology = model.topology();
            let truth = LimitSurface::new(model.mesh());
            let around = |ptex: u32, uv: [f32; 2]| {
                let (face, _) = truth.face_corner(ptex as usize).expect("a face");
                let vertices = topology.face(face);
                let corner = CORNERS.iter().position(|&corner| corner == uv);
                let corner = match (corner.expect("a corner"), vertices.len()) {
                    (3, 3) => 2,
                    (corner, _) => corner,
                };
                topology.vertex_faces(vertices[corner])
            };
            // Among triangles and quads the plane is the paper's, and beside the corner of a smooth boundary there is none.
            let promised = |ptex: u32, uv: [f32; 2]| {
                let faces = around(ptex, uv);
                let sizes: Vec<usize> = faces
                    .iter()
                    .map(|at| topology.face(at.face).len())
                    .collect();
                sizes.iter().all(|&size| size == sizes[0]) && sizes.len() > 1
            };
            let [off, _] = worst(method, &model, &CORNERS, |_, _| true);
            let [_, angle] = worst(method, &model, &CORNERS, promised);
            println!("{} {name} {scheme}: {off:.1e} {angle:.1e}", method.name);
            assert!(
                off <= 1e-6 && angle <= 0.01,
                "{} {name}: {off} {angle}",
                method.name
            );
        }
    }
}

/// Inside, at boundaries and at sharp corners.
#[test]
fn regular_quads_have_the_limit() {
    let grid: Vec<[f32; 2]> = (0..=4)
        .flat_map(|i| (0..=4).map(move |j| [i as f32 / 4.0, j as f32 / 4.0]))
        .collect();
    for method in methods() {
        for model in [torus(), built_in("sheet", Scheme::CatmullClark)] {
            let topology = model.topology();
            let truth = LimitSurface::new(model.mesh());
            let is_regular = |ptex: u32, _: [f32; 2]| {
                let (face, _) = truth.face_corner(ptex as usize).expect("a face");
                topology.face(face).iter().all(|&vertex| {
                    let edges = topology.vertex_edges(vertex).len();
                    let sharp = topology.vertex_sharpness(vertex) > 0.0;
                    match topology.vertex_faces(vertex).len() {
                        4 => edges == 4,
                        2 => edges == 3 && !sharp,
                        1 => sharp,
                        _ => false,
                    }
                })
            };
            let [off, angle] = worst(method, &model, &grid, is_regular);
            println!(
                "{}: {off:.1e} of the diagonal, {angle:.1e} degrees",
                method.name
            );
            assert!(
                off <= 1e-6 && angle <= 0.01,
                "{}: {off} {angle}",
                method.name
            );
        }
    }
}

/// What the surface has just beside an edge is what the edge has, which both of its faces have: G1, of the normals at least.
#[test]
fn planes_beside_an_edge_are_the_edges_own() {
    const BESIDE: f32 = 1.0 / (1 << 14) as f32;
    for method in methods() {
        for (name, model) in models() {
            let Ok(prepared) = method.prepare(&model, crate::plan::PlanOptions::default()) else {
                continue;
            };
            let controls = prepared.controls(model.positions());
            let mut worst: f64 = 0.0;
            for pass in &prepared.passes {
                for number in 0..pass.patches.len() {
                    for step in 1..8 {
                        let t = step as f32 / 8.0;
                        let pairs = match pass.domain {
                            Domain::Quads => vec![
                                ([t, 0.0], [t, BESIDE]),
                                ([1.0, t], [1.0 - BESIDE, t]),
                                ([t, 1.0], [t, 1.0 - BESIDE]),
                                ([0.0, t], [BESIDE, t]),
                            ],
                            Domain::Triangles => vec![
                                ([t, 0.0], [t, BESIDE]),
                                ([1.0 - t, t], [1.0 - t - BESIDE, t - BESIDE]),
                                ([0.0, t], [BESIDE, t]),
                            ],
                        };
                        for (on, beside) in pairs {
                            let [on, beside] = [on, beside].map(|uv| {
                                let point = pass.evaluate(&controls, number, Vec2::from(uv));
                                point.normal.as_dvec3()
                            });
                            let angle = on.angle_between(beside).to_degrees();
                            assert!(angle.is_finite(), "{} {name}", method.name);
                            worst = worst.max(angle);
                        }
                    }
                }
            }
            println!("{} {name}: {worst:.1e} degrees", method.name);
            assert!(worst <= 0.05, "{} {name}: {worst}", method.name);
        }
    }
}

#[test]
fn what_is_not_smooth_is_refused_by_its_place() {
    let refusal = |model: &Model| {
        let method = methods().next().expect("there are some");
        method
            .check_model(model)
            .expect_err("it is refused")
            .to_string()
    };
    let creased = refusal(&built_in("creased-torus", Scheme::CatmullClark));
    assert!(
        creased.contains("edge") && creased.contains("crease"),
        "{creased}"
    );
    let polygons = refusal(&built_in("ngons", Scheme::CatmullClark));
    assert!(polygons.contains("face"), "{polygons}");
    let pole = refusal(&built_in("pole-600", Scheme::LoopStam));
    assert!(pole.contains("vertex") && pole.contains("600"), "{pole}");
}
