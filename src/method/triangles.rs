//! What methods for triangles have in common: patches whose control points are computed points, vertex normals, weights of corners.

use glam::{Vec2, Vec3};

use crate::abi;
use crate::mesh::Model;
use crate::mesh::topology::{Fan, Topology};
use crate::method::patches::{self, Part};
use crate::method::points::{Points, Row};
use crate::method::surface::Controls;
use crate::method::{Pass, Prepared, Twin};
use crate::subdivision::Mask;
use crate::tessellation::Domain;

/// Adds the patch of a triangle, whose control points are the `points`.
pub fn add(pass: &mut Pass, model: &Model, part: Part, points: &[u32], flags: u32) {
    let mut patch = patches::patch(model, part, 0);
    patch.controls = pass.controls.len() as u32;
    patch.flags |= flags;
    pass.controls.extend_from_slice(points);
    pass.texture.push(patches::texture(model, part, 0));
    pass.patches.push(patch);
}

/// What a method needs that knows nothing but vertices and their normals: a patch a triangle, from the points of its corners.
pub fn by_vertices(model: &Model, shader: &'static str, twin: Twin) -> Prepared {
    let topology = model.topology();
    let mut pass = Pass::new(shader, Domain::Triangles, 1, twin);
    for part in patches::parts(model) {
        add(&mut pass, model, part, topology.face(part.face), 0);
    }
    Prepared {
        points: vertex_normals(topology),
        ..Prepared::of([pass])
    }
}

/// A point for each vertex: where it is, with the normal of the faces around it, each by its area (the sum of cross products of the edges).
fn vertex_normals(topology: &Topology) -> Points {
    let mut points = Points::default();
    points.begin(abi::POINTS_BLEND, 0);
    let vertices = 0..topology.vertex_count() as u32;
    for vertex in vertices.clone() {
        points.push(Row::Blend(&Mask::from_slice(&[(vertex, 1.0)])));
    }
    points.begin(abi::POINTS_RING, 0);
    for vertex in vertices {
        push_ring(&mut points, topology, vertex, 0);
    }
    points
}

/// Adds the ring of faces around a vertex. Where several fans meet, all follow one another with the vertex itself between them: faces that
/// have it twice have no area. `first` is the point of vertex 0.
pub fn push_ring(points: &mut Points, topology: &Topology, vertex: u32, first: u32) {
    let fans = fans(topology, vertex);
    let end = |&edge: &u32| first + topology.edge(edge).other(vertex);
    let middle = first + vertex;
    if let [fan] = &fans[..] {
        let ends: Vec<u32> = fan.edges.iter().map(end).collect();
        return points.push(Row::Ring {
            middle,
            ends: &ends,
            open: !fan.closed,
        });
    }
    let mut ends = Vec::new();
    for fan in &fans {
        ends.extend(fan.edges.iter().map(end));
        ends.extend(fan.edges.first().filter(|_| fan.closed).map(end));
        ends.push(middle);
    }
    let open = !ends.is_empty();
    points.push(Row::Ring {
        middle,
        ends: &ends,
        open,
    });
}

/// The fans around a vertex, by the lowest face of each: so every order of asking gives the same.
fn fans(topology: &Topology, vertex: u32) -> Vec<Fan> {
    let mut corners = topology.vertex_faces(vertex).to_vec();
    corners.sort_unstable_by_key(|corner| corner.face);
    let mut fans: Vec<Fan> = Vec::new();
    for corner in corners {
        if !fans.iter().any(|fan| fan.faces.contains(&corner.face)) {
            fans.push(topology.fan(corner.face, corner.corner));
        }
    }
    fans
}

/// The weights of corner 0, 1 and 2 at (u, v). Twin of `corner_weights` in `glsl/lib/triangle.glsl`.
pub fn corner_weights(uv: Vec2) -> [f32; 3] {
    [(1.0 - uv.x) - uv.y, uv.x, uv.y]
}

/// A weighted sum over three corners, or over three edges. On an edge only two of the corners count, or one of the edges: so both sides have the
/// same bits. Twin of `sum_of_three` in `glsl/lib/triangle.glsl`.
pub fn sum_of_three(weights: [f32; 3], points: [Vec3; 3]) -> Vec3 {
    (weights[0] * points[0] + weights[1] * points[1]) + weights[2] * points[2]
}

/// Positions and normals of a patch's control points.
pub fn control_points<const N: usize>(
    pass: &Pass,
    given: &Controls,
    patch: usize,
) -> ([Vec3; N], [Vec3; N]) {
    let controls = &pass.controls[pass.patches[patch].controls as usize..];
    let point = |i: usize| given.points[controls[i] as usize];
    (
        std::array::from_fn(|i| point(i).position.into()),
        std::array::from_fn(|i| point(i).normal.into()),
    )
}
