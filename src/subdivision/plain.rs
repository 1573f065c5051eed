//! Where the limit is a B-spline of the control vertices themselves, whatever lies around.

use crate::mesh::sharpness::is_sharp;
use crate::mesh::topology::Topology;

/// Whether a vertex is smooth and has four quads around it: it needs no plan.
pub fn is_plain_vertex(topology: &Topology, vertex: u32) -> bool {
    let faces = topology.vertex_faces(vertex);
    faces.len() == 4
        && topology.vertex_edges(vertex).len() == 4
        && faces.iter().all(|at| topology.face(at.face).len() == 4)
        && !is_sharp(topology.vertex_sharpness(vertex))
        && topology.sharp_edges(vertex).next().is_none()
}

/// Whether both ends of an edge are plain.
pub fn is_plain_edge(topology: &Topology, edge: u32) -> bool {
    let ends = topology.edge(edge).vertices;
    ends.iter().all(|&vertex| is_plain_vertex(topology, vertex))
}
