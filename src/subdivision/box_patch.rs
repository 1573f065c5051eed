//! Which triangles are quartic box splines, and of which twelve control points.
//!
//! Beside a boundary or an infinite crease the points beyond it are mirrored, a + b - c beyond edge a-b of triangle a b c: then the smooth rules
//! give the sharp ones at the edge. Beyond a sharp corner a with one triangle a b c, 2a - b and 2a - c do the same.

use crate::mesh::sharpness::{Rule, is_semi_sharp, rule};
use crate::mesh::topology::Topology;
use crate::subdivision::masks::Mask;

/// The control points of a triangle in the order of [`LATTICE`](crate::patch::boxspline::LATTICE), as masks over the topology's vertices, or None
/// when it has to be refined first.
pub fn box_spline_patch(topology: &Topology, face: u32) -> Option<[Mask; 12]> {
    if topology.face(face).len() != 3 {
        return None;
    }
    let mut points: [Mask; 12] = std::array::from_fn(|_| Mask::new());
    for corner in 0..3 {
        let [_, _, before, far, near, beyond] = neighbours(topology, face, corner as u32)?;
        points[corner] = Mask::from_slice(&[(topology.face(face)[corner], 1.0)]);
        points[3 + corner] = beyond;
        points[3 + (corner + 2) % 3] = before;
        points[6 + 2 * corner] = far;
        points[7 + 2 * corner] = near;
    }
    Some(points)
}

/// The six neighbours of a corner, counter-clockwise from the face's next vertex on; None when there are not six and no way to mirror them.
fn neighbours(topology: &Topology, face: u32, corner: u32) -> Option<[Mask; 6]> {
    let vertex = topology.face(face)[corner as usize];
    let mut sharp = 0;
    for edge in topology.sharp_edges(vertex) {
        if is_semi_sharp(topology.edge(edge).sharpness) {
            return None;
        }
        sharp += 1;
    }
    let sharpness = topology.vertex_sharpness(vertex);
    let fan = topology.fan(face, corner);
    if is_semi_sharp(sharpness) || fan.faces.iter().any(|&face| topology.face(face).len() != 3) {
        return None;
    }
    let end = |i: usize| topology.edge(fan.edges[i]).other(vertex);
    let single = |i: usize| Mask::from_slice(&[(end(i), 1.0)]);
    // Beyond the sharp edge to `edge`, seen from `inner`.
    let mirrored = |edge: usize, inner: usize| {
        Mask::from_slice(&[(vertex, 1.0), (end(edge), 1.0), (end(inner), -1.0)])
    };
    let opposite = |edge: usize| Mask::from_slice(&[(vertex, 2.0), (end(edge), -1.0)]);
    let mut around = match (rule(sharpness, sharp), fan.faces.len()) {
        (Rule::Smooth, 6) if fan.closed => std::array::from_fn(single),
        (Rule::Crease, 3) if !fan.closed => [
            single(0),
            single(1),
            single(2),
            single(3),
            mirrored(3, 2),
            mirrored(0, 1),
        ],
        (Rule::Corner, 1) if !fan.closed => [
            single(0),
            single(1),
            mirrored(1, 0),
            opposite(0),
            opposite(1),
            mirrored(0, 1),
        ],
        _ => return None,
    };
    around.rotate_left(fan.at);
    Some(around)
}
