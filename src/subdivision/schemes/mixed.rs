//! Triangles beside quads (Stam, Loop 2003, "Quad/triangle subdivision").
//!
//! Their refinement is a linear one, after which each point becomes a mean with weights alpha for itself, alpha / 2 for each neighbour and alpha / 4
//! for each opposite corner of a quad, alpha = 1 / (1 + edges / 2 + quads / 4). Where four quads or six triangles meet these are the rules of Catmull
//! and Clark and of Loop. Elsewhere the bare mean has unbounded curvature, so a vertex among nothing but quads takes Catmull and Clark's
//! weights of its valence, and one among nothing but triangles takes Loop's: pure meshes have the limits of those schemes. A vertex among both
//! keeps the mean: the paper's further correction of its weights is not applied. N-gons become quads as Catmull and Clark's do.

use crate::mesh::topology::Topology;
use crate::subdivision::limit::{Family, LimitStencil, family_stencil};
use crate::subdivision::masks::{self, Mask, add_face, edge_point_with, vertex_point_with};

use super::loops;

pub(super) fn edge_point(topology: &Topology, edge: u32) -> Mask {
    edge_point_with(topology, edge, add_smooth_edge)
}

pub(super) fn vertex_point(topology: &Topology, vertex: u32) -> Mask {
    vertex_point_with(topology, vertex, add_smooth_vertex)
}

/// The masks of the scheme that the faces on this side of the vertex belong to; None among faces of both kinds.
pub(super) fn limit(topology: &Topology, face: u32, corner: u32) -> Option<LimitStencil> {
    let family = match topology.face(face).len() {
        3 => Family::Triangles,
        _ => Family::Quads,
    };
    family_stencil(topology, face, corner, family)
}

fn is_triangle(topology: &Topology, face: u32) -> bool {
    topology.face(face).len() == 3
}

/// Half of Loop's mask from a triangle, half of Catmull and Clark's from any other face.
fn add_smooth_edge(topology: &Topology, edge: u32, scale: f64, mask: &mut Mask) {
    let faces = topology.edge_faces(edge);
    let triangles = faces
        .iter()
        .filter(|&&face| is_triangle(topology, face))
        .count();
    if faces.len() != 2 || triangles == 0 {
        return masks::add_smooth_edge(topology, edge, scale, mask);
    }
    let ends = topology.edge(edge).vertices;
    for &face in faces {
        if is_triangle(topology, face) {
            mask.extend(ends.map(|vertex| (vertex, 0.1875 * scale)));
            mask.push((loops::apex(topology, face, edge), 0.125 * scale));
        } else {
            mask.extend(ends.map(|vertex| (vertex, 0.125 * scale)));
            add_face(topology, face, 0.25 * scale, mask);
        }
    }
}

fn add_smooth_vertex(topology: &Topology, vertex: u32, scale: f64, mask: &mut Mask) {
    let faces = topology.vertex_faces(vertex);
    let triangles = faces
        .iter()
        .filter(|at| is_triangle(topology, at.face))
        .count();
    if triangles == 0 {
        return masks::add_smooth_vertex(topology, vertex, scale, mask);
    }
    if triangles == faces.len() {
        return loops::add_smooth_vertex(topology, vertex, scale, mask);
    }
    let edges = topology.vertex_edges(vertex);
    let (count, quads) = (edges.len() as f64, (faces.len() - triangles) as f64);
    let alpha = scale / (1.0 + 0.5 * count + 0.25 * quads);
    // A neighbour of the linear refinement is the middle of an edge.
    mask.push((vertex, alpha * (1.0 + 0.25 * count)));
    let others = edges.iter().map(|&edge| topology.edge(edge).other(vertex));
    mask.extend(others.map(|other| (other, 0.25 * alpha)));
    for at in faces {
        if !is_triangle(topology, at.face) {
            add_face(topology, at.face, 0.25 * alpha, mask);
        }
    }
}
