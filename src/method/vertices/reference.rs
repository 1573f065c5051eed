//! Faces with their vertex normals in f64, and what a method makes of them against what it should.

use std::collections::BTreeMap;

use glam::{DVec3, Vec2};

use crate::mesh::{Model, Scheme, Triangulation, builtin, triangulated};
use crate::method::Method;
use crate::plan::PlanOptions;

/// Corners and normals of a face.
pub struct Face {
    pub corners: Vec<DVec3>,
    pub normals: Vec<DVec3>,
}

/// What is the most that is forgiven: distances over the diagonal, and radians.
pub const NEAR: f64 = 1e-6;
pub const TURNED: f64 = 1e-4;

/// Meshes of triangles, of quads, and of both.
pub fn models() -> Vec<Model> {
    let of_triangles = |name: &str| {
        let mesh = builtin(name).expect("it is built in");
        triangulated(&mesh, Triangulation::default()).expect("it is sound")
    };
    let triangles = ["hull", "sheet", "ngons"].map(|name| {
        let mesh = of_triangles(name).with_scheme(Scheme::Loop);
        mesh.expect("Loop knows its tags")
    });
    let quads = ["cube", "creased-torus", "sheet"].map(|name| builtin(name).expect("built in"));
    let mixed = ["pole-7", "pole-18"].map(|name| {
        let mesh = builtin(name).expect("built in");
        mesh.with_scheme(Scheme::LoopStam).expect("it has no tags")
    });
    triangles
        .into_iter()
        .chain(quads)
        .chain(mixed)
        .map(Model::new)
        .collect()
}

/// The faces by their numbers, in local units. A vertex has the sum of the areas of all faces there.
fn faces(model: &Model) -> Vec<Face> {
    let mesh = model.mesh();
    let at = |vertex: u32| model.placement().local(mesh.positions()[vertex as usize]);
    let mut sums: BTreeMap<u32, DVec3> = BTreeMap::new();
    for face in mesh.faces() {
        let spoke = |i: usize| at(face[i]) - at(face[0]);
        let area: DVec3 = (1..face.len() - 1)
            .map(|i| spoke(i).cross(spoke(i + 1)))
            .sum();
        for &vertex in face {
            *sums.entry(vertex).or_default() += area;
        }
    }
    let face = |face: &[u32]| Face {
        corners: face.iter().map(|&vertex| at(vertex)).collect(),
        normals: face.iter().map(|vertex| sums[vertex].normalize()).collect(),
    };
    mesh.faces().map(face).collect()
}

/// The greatest distance over the diagonal, and the greatest angle, between a method and what `right` says of a face at (u, v), on all faces of
/// so many corners.
pub fn worst(
    method: &Method,
    corners: usize,
    right: impl Fn(&Face, [f64; 2]) -> (DVec3, DVec3),
) -> [f64; 2] {
    let mut worst = [0.0; 2];
    let mut compared = 0;
    for model in models() {
        let faces = faces(&model);
        let diagonal = model.diagonal();
        let prepared = method.prepare(&model, PlanOptions::default());
        let prepared = prepared.expect("all of its faces are whole");
        let controls = prepared.controls(model.positions());
        for pass in &prepared.passes {
            for (number, patch) in pass.patches.iter().enumerate() {
                // Whole faces are their own ptex faces.
                let face = &faces[patch.ptex as usize];
                if face.corners.len() != corners {
                    continue;
                }
                for uv in places(corners) {
                    let point = pass.evaluate(&controls, number, uv);
                    let (position, normal) = right(face, uv.to_array().map(f64::from));
                    let off = point.position.as_dvec3().distance(position) / diagonal;
                    let angle = point.normal.as_dvec3().angle_between(normal);
                    // A sum of normals that nearly vanishes has no direction in f32.
                    let angle = if normal.length() > 0.01 { angle } else { 0.0 };
                    worst = [f64::max(worst[0], off), f64::max(worst[1], angle)];
                    assert!(off.is_finite() && angle.is_finite(), "{position} {normal}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 1000, "{compared} points");
    worst
}

/// A grid of points of the domain: more than a cubic can pass through by chance.
fn places(corners: usize) -> impl Iterator<Item = Vec2> {
    let grid = (0..=5).flat_map(|i| (0..=5).map(move |j| (i, j)));
    let inside = grid.filter(move |(i, j)| corners == 4 || i + j <= 5);
    inside.map(|(i, j)| Vec2::new(i as f32, j as f32) / 5.0)
}
