//! Loop's rules (Loop 1987; creases by Hoppe et al. 1994, in the form of OpenSubdiv's `Sdc::Scheme<SCHEME_LOOP>`).

use std::f64::consts::TAU;

use crate::mesh::topology::Topology;
use crate::subdivision::masks::{Mask, edge_point_with, vertex_point_with};

/// The mask of an edge point: 3/8 of both ends and 1/8 of the vertices opposite, the middle where the edge is sharp.
pub(super) fn edge_point(topology: &Topology, edge: u32) -> Mask {
    edge_point_with(topology, edge, add_smooth_edge)
}

/// The mask of a vertex point; creases take 1/8, 3/4, 1/8.
pub(super) fn vertex_point(topology: &Topology, vertex: u32) -> Mask {
    vertex_point_with(topology, vertex, add_smooth_vertex)
}

/// What each neighbour of a smooth vertex weighs: (5/8 - (3/8 + cos(2 pi / n) / 4)^2) / n.
pub(in crate::subdivision) fn neighbour_weight(valence: usize) -> f64 {
    let n = valence as f64;
    let mode = 0.375 + 0.25 * (TAU / n).cos();
    (0.625 - mode * mode) / n
}

pub(super) fn add_smooth_edge(topology: &Topology, edge: u32, scale: f64, mask: &mut Mask) {
    let ends = topology.edge(edge).vertices;
    let faces = topology.edge_faces(edge);
    // Only rims of partial topologies have other than two faces here, and nobody asks for their points.
    let share = if faces.len() == 2 { 0.375 } else { 0.5 };
    mask.extend(ends.map(|vertex| (vertex, share * scale)));
    if faces.len() == 2 {
        let apex = |&face: &u32| (apex(topology, face, edge), 0.125 * scale);
        mask.extend(faces.iter().map(apex));
    }
}

pub(super) fn add_smooth_vertex(topology: &Topology, vertex: u32, scale: f64, mask: &mut Mask) {
    let edges = topology.vertex_edges(vertex);
    let weight = neighbour_weight(edges.len());
    mask.push((vertex, (1.0 - edges.len() as f64 * weight) * scale));
    let others = edges.iter().map(|&edge| topology.edge(edge).other(vertex));
    mask.extend(others.map(|other| (other, weight * scale)));
}

/// The corner of a triangle that is not on one of its edges.
pub(super) fn apex(topology: &Topology, face: u32, edge: u32) -> u32 {
    let side = topology.face_edges(face).iter().position(|&e| e == edge);
    topology.face(face)[(side.expect("the edge is one of the face's") + 2) % 3]
}
