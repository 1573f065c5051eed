use glam::Vec2;

use super::*;
use crate::mesh::{ControlMesh, builtin};
use crate::method::to_ptex;
use crate::subdivision::LimitSurface;

fn built_in(name: &str) -> Model {
    Model::new(builtin(name).expect("a built-in shape"))
}

/// A ball of two poles of `n` quads: rings of quads around, of which the first at a pole are `n` quads at one vertex.
fn bipole(n: usize) -> Model {
    with_holes(n, &[])
}

/// The same with holes; faces 0, 2, 4 and so on are around one of the poles.
fn with_holes(n: usize, holes: &[u32]) -> Model {
    let rings = 5;
    let mut positions = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    for ring in 0..rings {
        let height = 0.8 - 1.6 * f64::from(ring) / f64::from(rings - 1);
        let around = 0..2 * n;
        positions.extend(around.map(|i| {
            let angle = std::f64::consts::PI * i as f64 / n as f64;
            let radius = (1.0 - height * height).sqrt() * (1.0 + 0.1 * (3.0 * angle).sin());
            [radius * angle.cos(), radius * angle.sin(), height]
        }));
    }
    let at = |ring: i32, i: usize| (2 + ring as usize * 2 * n + i % (2 * n)) as u32;
    let mut faces = Vec::new();
    for i in 0..n {
        faces.push([0, at(0, 2 * i), at(0, 2 * i + 1), at(0, 2 * i + 2)]);
        let last = rings - 1;
        faces.push([1, at(last, 2 * i + 2), at(last, 2 * i + 1), at(last, 2 * i)]);
    }
    for ring in 0..rings - 1 {
        for i in 0..2 * n {
            faces.push([
                at(ring, i),
                at(ring + 1, i),
                at(ring + 1, i + 1),
                at(ring, i + 1),
            ]);
        }
    }
    let sizes = vec![4; faces.len()];
    let mesh = ControlMesh::builder(&positions, &sizes, faces.as_flattened());
    let mesh = holes.iter().fold(mesh, |mesh, &hole| mesh.hole(hole));
    Model::new(mesh.build().expect("it is sound"))
}

/// A cube whose sides are `n` times `n` quads: from 2 on no face has two of its corners.
fn block(n: u32) -> Model {
    let mut places: Vec<[u32; 3]> = Vec::new();
    let mut faces = Vec::new();
    for axis in 0..3 {
        for (side, i, j) in (0..2).flat_map(|s| (0..n * n).map(move |k| (s, k % n, k / n))) {
            let mut corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            if side == 0 {
                corners.reverse();
            }
            for [x, y] in corners {
                let mut place = [0; 3];
                place[axis] = side * n;
                place[(axis + 1) % 3] = x;
                place[(axis + 2) % 3] = y;
                let known = places.iter().position(|&known| known == place);
                faces.push(known.unwrap_or(places.len()) as u32);
                if known.is_none() {
                    places.push(place);
                }
            }
        }
    }
    let bent = |place: &[u32; 3]| {
        let [x, y, z] = place.map(f64::from);
        [
            x + 0.2 * (y * y).sin(),
            y - 0.1 * (2.0 * z).cos(),
            z + 0.1 * x * y,
        ]
    };
    let positions: Vec<[f64; 3]> = places.iter().map(bent).collect();
    let sizes = vec![4; faces.len() / 4];
    let mesh = ControlMesh::builder(&positions, &sizes, &faces);
    Model::new(mesh.build().expect("it is sound"))
}

/// The greatest distance over the diagonal, and the greatest angle in degrees, between the twin and the truth.
fn off(model: &Model) -> (f64, f64) {
    let prepared = METHOD.prepare(model, MethodOptions::default());
    let prepared = prepared.expect("it is smooth and closed");
    let truth = LimitSurface::new(model.mesh());
    let controls = prepared.controls(model.positions());
    let (mut distance, mut angle) = (0.0f64, 0.0f64);
    for pass in &prepared.passes {
        for (number, patch) in pass.patches.iter().enumerate() {
            for uv in [
                [0.0, 0.0],
                [1.0, 0.0],
                [1.0, 1.0],
                [0.0, 0.375],
                [0.625, 0.0],
                [1.0, 0.25],
                [0.5, 0.5],
                [0.3, 0.7],
                [0.015625, 0.0],
                [0.002, 0.011],
                [1e-4, 3e-5],
            ] {
                let own = pass.evaluate(&controls, number, Vec2::from(uv));
                let [u, v] = to_ptex(patch, uv).map(f64::from);
                let right = truth.evaluate(patch.ptex as usize, u, v);
                let right = right.expect("holes are not drawn");
                let position = model.placement().local(right.position);
                let apart = own.position.as_dvec3().distance(position) / model.diagonal();
                distance = distance.max(apart);
                let normal = right.normal();
                angle = angle.max(own.normal.as_dvec3().angle_between(normal).to_degrees());
            }
        }
    }
    (distance, angle)
}

#[test]
fn the_limit_and_its_normals_are_exact_at_every_valence() {
    for valence in [3, 5, 6, 7, 8, 9, 12, 17, 50] {
        let (distance, angle) = off(&bipole(valence));
        println!("{valence}: {distance:.1e}, {angle:.1e} degrees");
        assert!(distance <= 1e-6, "{valence}: {distance}");
        assert!(angle <= 0.1, "{valence}: {angle}");
    }
}

#[test]
fn beside_a_hole_a_face_is_on_its_own() {
    let (distance, angle) = off(&with_holes(5, &[0, 4]));
    assert!(distance <= 1e-6 && angle <= 0.1, "{distance} {angle}");
}

#[test]
fn meshes_whose_extraordinary_vertices_are_not_apart_are_refined_once() {
    let count = |model: &Model| {
        let prepared = METHOD.prepare(model, MethodOptions::default());
        let passes = prepared.expect("it is smooth and closed").passes;
        passes.iter().map(|pass| pass.patches.len()).sum::<usize>()
    };
    let apart = block(2);
    let cube = built_in("cube");
    for (model, patches) in [(&apart, 24), (&cube, 24)] {
        assert_eq!(count(model), patches);
        let (distance, angle) = off(model);
        assert!(distance <= 1e-6 && angle <= 0.1, "{distance} {angle}");
    }
}

#[test]
fn what_has_no_eigenbasis_is_refused_by_its_place() {
    let refusal = |name: &str| {
        let refused = METHOD.check_model(&built_in(name));
        refused.expect_err("it is refused").to_string()
    };
    assert!(refusal("creased-torus").contains("it is a crease"));
    assert!(refusal("sheet").contains("it is a boundary"));
    let tetrahedron = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let faces = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
    let mesh = ControlMesh::builder(&tetrahedron, &[3; 4], &faces);
    let model = Model::new(mesh.build().expect("it is sound"));
    let refused = METHOD
        .check_model(&model)
        .expect_err("it is refused")
        .to_string();
    assert!(refused.contains("two extraordinary vertices"), "{refused}");
    let refused = METHOD.check_model(&bipole(51)).expect_err("it is refused");
    assert!(refused.to_string().contains("51 faces"), "{refused}");
}
