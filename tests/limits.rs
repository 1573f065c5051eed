//! Facts about the truth that need no reference: limits over random meshes are continuous, smooth, affine, and know no order of vertices.

mod common;

use common::meshes::{Recipe, cases, manifold, scatter, tagged_as, wild};
use glam::{DMat3, DVec3};
use hullform::mesh::ControlMesh;
use hullform::mesh::sharpness::is_infinite;
use hullform::subdivision::{LimitSample, LimitSurface};
use proptest::prelude::*;

/// A limit surface that can be asked along the edges of its mesh.
struct Limits {
    surface: LimitSurface,
    offsets: Vec<u32>,
    diagonal: f64,
}

impl Limits {
    fn of(mesh: &ControlMesh) -> Limits {
        Limits {
            surface: LimitSurface::new(mesh),
            offsets: mesh.ptex_offsets(),
            diagonal: common::diagonal(mesh),
        }
    }

    /// The limit at `t` along edge `edge` of a face, from the edge's own first vertex on; with two tangents, as the face sees it.
    fn along(&self, face: u32, edge: u32, t: f64) -> Option<LimitSample> {
        let topology = self.surface.topology();
        let edges = topology.face_edges(face);
        let corner = edges.iter().position(|&e| e == edge).expect("on the face");
        let forward = topology.face(face)[corner] == topology.edges()[edge as usize].vertices[0];
        self.on_side(face, corner, if forward { t } else { 1.0 - t })
    }

    /// The limit at `t` along the side of a face from corner `corner` to the next.
    fn on_side(&self, face: u32, corner: usize, t: f64) -> Option<LimitSample> {
        let arity = self.surface.topology().face(face).len();
        let ptex = self.offsets[face as usize] as usize;
        let at = |ptex, u, v| self.surface.evaluate(ptex, u, v);
        match (arity, corner) {
            (4, 0) => at(ptex, t, 0.0),
            (4, 1) => at(ptex, 1.0, t),
            (4, 2) => at(ptex, 1.0 - t, 1.0),
            (4, _) => at(ptex, 0.0, 1.0 - t),
            _ if t <= 0.5 => at(ptex + corner, 2.0 * t, 0.0),
            _ => at(ptex + (corner + 1) % arity, 0.0, 2.0 - 2.0 * t),
        }
    }

    /// Every pair of limits that two faces have of one point: of each edge with two faces at least, and of each n-gon's inner edges.
    /// Tells the edge's number and `t`.
    fn shared_points(&self) -> Vec<(Option<u32>, f64, [LimitSample; 2])> {
        let topology = self.surface.topology();
        let mut pairs = Vec::new();
        let ts = [0.0, 0.03, 1.0 / 3.0, 0.5, 0.77, 1.0];
        for edge in 0..topology.edge_count() as u32 {
            for pair in topology.edge_faces(edge).windows(2) {
                for t in ts {
                    let [a, b] = [pair[0], pair[1]].map(|face| self.along(face, edge, t));
                    pairs.extend(a.zip(b).map(|(a, b)| (Some(edge), t, [a, b])));
                }
            }
        }
        for face in 0..topology.face_count() as u32 {
            let (arity, first) = (topology.face(face).len(), self.offsets[face as usize]);
            for (corner, t) in (0..arity).flat_map(|i| ts.map(|t| (i, t))) {
                if arity != 4 {
                    let [a, b] = [corner, (corner + 1) % arity].map(|i| first as usize + i);
                    let sides = (
                        self.surface.evaluate(a, 1.0, t),
                        self.surface.evaluate(b, t, 1.0),
                    );
                    pairs.extend(sides.0.zip(sides.1).map(|(a, b)| (None, t, [a, b])));
                }
            }
        }
        pairs
    }
}

/// Whether the tangents span a plane well enough for a normal to be compared; where a surface folds flat they are rounding errors.
fn has_normal(sample: &LimitSample) -> bool {
    let (du, dv) = (sample.du.normalize_or_zero(), sample.dv.normalize_or_zero());
    du.cross(dv).length() > 1e-3 && sample.du.length().min(sample.dv.length()) > 1e-9
}

/// The mesh with other positions.
fn moved(mesh: &ControlMesh, to: impl Fn(DVec3) -> DVec3) -> ControlMesh {
    rebuilt(mesh, to, |_| 0)
}

/// The mesh with other positions and each face beginning at another corner.
fn rebuilt(
    mesh: &ControlMesh,
    to: impl Fn(DVec3) -> DVec3,
    turn: impl Fn(usize) -> usize,
) -> ControlMesh {
    let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|&p| to(p).to_array()).collect();
    let faces: Vec<Vec<u32>> = mesh
        .faces()
        .enumerate()
        .map(|(number, face)| {
            let mut face = face.to_vec();
            let arity = face.len();
            face.rotate_left(turn(number) % arity);
            face
        })
        .collect();
    let sizes: Vec<u32> = faces.iter().map(|face| face.len() as u32).collect();
    tagged_as(
        mesh,
        ControlMesh::builder(&positions, &sizes, &faces.concat()),
    )
}

const PLACES: [(f64, f64); 7] = [
    (0.0, 0.0),
    (1.0, 1.0),
    (0.5, 0.5),
    (0.01, 0.7),
    (0.3, 0.999),
    (0.0, 0.4),
    (0.26, 1.0),
];

fn continuous(recipe: &Recipe) -> Result<(), TestCaseError> {
    let limits = Limits::of(&recipe.mesh());
    for (edge, t, [a, b]) in limits.shared_points() {
        let distance = a.position.distance(b.position) / limits.diagonal;
        prop_assert!(distance <= 1e-12, "edge {edge:?} at {t}: {distance:.1e}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn faces_meet_on_their_edges(recipe in manifold()) {
        continuous(&recipe)?;
    }

    #[test]
    fn faces_meet_on_their_edges_when_flipped_or_non_manifold(recipe in wild()) {
        continuous(&recipe)?;
    }

    #[test]
    fn normals_agree_across_every_edge_that_is_not_infinitely_sharp(recipe in wild()) {
        let limits = Limits::of(&recipe.mesh());
        for (edge, t, [a, b]) in limits.shared_points() {
            let sharp = |edge| is_infinite(limits.surface.topology().edges()[edge as usize].sharpness);
            let at_end = edge.is_some() && (t == 0.0 || t == 1.0);
            if edge.is_some_and(sharp) || at_end || !has_normal(&a) || !has_normal(&b) {
                continue;
            }
            let angle = a.normal().angle_between(b.normal()).to_degrees();
            prop_assert!(angle < 1e-4, "edge {edge:?} at {t}: {angle} degrees");
        }
    }

    #[test]
    fn limits_move_with_the_mesh_under_affine_maps(recipe in wild(), seed in any::<u32>()) {
        let mesh = recipe.mesh();
        let point = |i| scatter(4 * u64::from(seed) + i);
        let (linear, shift) = (DMat3::from_cols(point(0), point(1), point(2)), 5.0 * point(3));
        let (before, after) = (
            LimitSurface::new(&mesh),
            LimitSurface::new(&moved(&mesh, |p| linear * p + shift)),
        );
        for (ptex, (u, v)) in (0..before.ptex_count()).flat_map(|i| PLACES.map(|at| (i, at))) {
            let (Some(a), Some(b)) = (before.evaluate(ptex, u, v), after.evaluate(ptex, u, v)) else {
                continue;
            };
            prop_assert!((linear * a.position + shift).distance(b.position) < 1e-12);
            // Derivatives at semi-sharp vertices grow out of up to ten levels.
            let scale = 1e-11 * (1.0 + a.du.length() + a.dv.length());
            prop_assert!((linear * a.du).distance(b.du) < scale);
            prop_assert!((linear * a.dv).distance(b.dv) < scale);
        }
    }

    #[test]
    fn limits_do_not_depend_on_where_a_face_begins(recipe in wild(), seed in any::<u32>()) {
        let mesh = recipe.mesh();
        let turn = |face: usize| ((seed as usize) >> (face % 16)) % mesh.face(face).len();
        let turned = rebuilt(&mesh, |p| p, turn);
        let (before, after) = (LimitSurface::new(&mesh), LimitSurface::new(&turned));
        let offsets = mesh.ptex_offsets();
        for (ptex, (u, v)) in (0..before.ptex_count()).flat_map(|i| PLACES.map(|at| (i, at))) {
            let (face, corner) = before.face_corner(ptex).expect("it is a ptex face");
            let (arity, turn) = (mesh.face(face as usize).len(), turn(face as usize));
            let (ptex_after, [x, y]) = if arity == 4 {
                (ptex, turned_uv([u, v], turn))
            } else {
                let corner = (corner as usize + arity - turn) % arity;
                (offsets[face as usize] as usize + corner, [u, v])
            };
            let (a, b) = (before.evaluate(ptex, u, v), after.evaluate(ptex_after, x, y));
            prop_assert_eq!(a.is_some(), b.is_some());
            let Some((a, b)) = a.zip(b) else { continue };
            prop_assert!(a.position.distance(b.position) < 1e-12, "face {face} at {u}, {v}");
            if has_normal(&a) {
                let angle = a.normal().angle_between(b.normal());
                prop_assert!(angle < 1e-6, "face {face} at {u}, {v}: {angle}");
            }
        }
    }
}

/// Where (u, v) of a quad lies in the quad that begins `turn` corners later.
fn turned_uv([u, v]: [f64; 2], turn: usize) -> [f64; 2] {
    match turn {
        0 => [u, v],
        1 => [v, 1.0 - u],
        2 => [1.0 - u, 1.0 - v],
        _ => [1.0 - v, u],
    }
}
