//! The modified butterfly (Zorin, Schröder, Sweldens 1996, "Interpolating subdivision for meshes with arbitrary topology").
//!
//! Vertices stay; every edge gets a point. Between regular vertices it comes from eight points (their w = 0), beside an interior vertex of valence
//! other than 6 from that vertex and its neighbours, and between two such vertices it is the mean of both. A boundary or an infinitely sharp crease
//! has the four-point rule along itself; a curve that ends there (at a sharp vertex, or where other than two sharp edges meet) has the parabola
//! through its last three points.
//!
//! The paper leaves open what an edge beside a boundary sees beyond it, and implementations differ. Here a missing point is mirrored, a + b - c beyond the edge
//! a-b of triangle a b c, and every vertex on a boundary or crease counts as regular. The surface passes smoothly along the boundary; at boundary
//! vertices of other than three triangles a tangent plane is not promised.

use std::f64::consts::TAU;

use smallvec::SmallVec;

use crate::mesh::sharpness::{is_infinite, is_sharp};
use crate::mesh::topology::{Fan, Topology};
use crate::subdivision::limit::LimitStencil;
use crate::subdivision::masks::Mask;

use super::loops::apex;

/// The mask of an edge point.
pub(super) fn edge_point(topology: &Topology, edge: u32) -> Mask {
    let [a, b] = topology.edge(edge).vertices;
    if is_infinite(topology.edge(edge).sharpness) {
        return on_curve(topology, edge);
    }
    let &[first, second] = topology.edge_faces(edge) else {
        // The rim of a partial topology, whose points nobody asks for.
        return Mask::from_slice(&[(a, 0.5), (b, 0.5)]);
    };
    let ends = [a, b].map(|vertex| extraordinary(topology, first, vertex));
    let share = if ends.iter().all(Option::is_some) {
        0.5
    } else {
        1.0
    };
    let mut mask = Mask::new();
    for fan in ends.iter().flatten() {
        add_one_sided(topology, fan, edge, share, &mut mask);
    }
    if mask.is_empty() {
        mask.extend([(a, 0.5), (b, 0.5)]);
        add_wing(topology, first, edge, &mut mask);
        add_wing(topology, second, edge, &mut mask);
    }
    mask
}

/// The fan of an interior vertex on no crease, as seen from one of its faces.
fn closed_fan(topology: &Topology, face: u32, vertex: u32) -> Option<Fan> {
    let corner = topology.face(face).iter().position(|&v| v == vertex)?;
    let fan = topology.fan(face, corner as u32);
    fan.closed.then_some(fan)
}

/// The fan of a vertex that has rules of its own.
fn extraordinary(topology: &Topology, face: u32, vertex: u32) -> Option<Fan> {
    closed_fan(topology, face, vertex).filter(|fan| fan.faces.len() != 6)
}

/// Zorin's weights of the n neighbours, the first on the edge itself; the vertex has 3/4. They make 1/2 the double second eigenvalue and 1/4 the third.
/// For n = 2, which the paper leaves out, the two weights that do the same.
fn one_sided(n: usize, i: usize) -> f64 {
    match (n, i) {
        (2, 0) => 3.0 / 8.0,
        (2, _) => -1.0 / 8.0,
        (3, 0) => 5.0 / 12.0,
        (3, _) => -1.0 / 12.0,
        (4, 0) => 3.0 / 8.0,
        (4, 2) => -1.0 / 8.0,
        (4, _) => 0.0,
        _ => {
            let angle = TAU * i as f64 / n as f64;
            (0.25 + angle.cos() + 0.5 * (2.0 * angle).cos()) / n as f64
        }
    }
}

fn add_one_sided(topology: &Topology, fan: &Fan, edge: u32, share: f64, mask: &mut Mask) {
    let n = fan.faces.len();
    let at = fan.edges.iter().position(|&e| e == edge);
    let at = at.expect("the edge ends in the fan's vertex");
    mask.push((fan.vertex, 0.75 * share));
    mask.extend((0..n).map(|i| {
        let end = topology.edge(fan.edges[(at + i) % n]).other(fan.vertex);
        (end, one_sided(n, i) * share)
    }));
}

/// One side of the eight points: 1/8 of the triangle's apex and -1/16 of what lies beyond its two other edges.
fn add_wing(topology: &Topology, face: u32, edge: u32, mask: &mut Mask) {
    mask.push((apex(topology, face, edge), 0.125));
    for &side in topology
        .face_edges(face)
        .iter()
        .filter(|&&side| side != edge)
    {
        let beyond = match topology.edge_faces(side) {
            &[a, b] if !is_infinite(topology.edge(side).sharpness) => {
                Some(if a == face { b } else { a })
            }
            _ => None,
        };
        match beyond {
            Some(beyond) => mask.push((apex(topology, beyond, side), -0.0625)),
            None => {
                mask.extend(topology.edge(side).vertices.map(|vertex| (vertex, -0.0625)));
                mask.push((apex(topology, face, side), 0.0625));
            }
        }
    }
}

/// The four-point rule, and at the ends of a curve its quadratic relatives.
fn on_curve(topology: &Topology, edge: u32) -> Mask {
    let [a, b] = topology.edge(edge).vertices;
    match [a, b].map(|vertex| next_on_curve(topology, edge, vertex)) {
        [Some(before), Some(after)] => Mask::from_slice(&[
            (before, -0.0625),
            (a, 0.5625),
            (b, 0.5625),
            (after, -0.0625),
        ]),
        [None, Some(after)] => Mask::from_slice(&[(a, 0.375), (b, 0.75), (after, -0.125)]),
        [Some(before), None] => Mask::from_slice(&[(before, -0.125), (a, 0.75), (b, 0.375)]),
        [None, None] => Mask::from_slice(&[(a, 0.5), (b, 0.5)]),
    }
}

/// Where the curve goes on beyond an end of its edge.
fn next_on_curve(topology: &Topology, edge: u32, vertex: u32) -> Option<u32> {
    if is_sharp(topology.vertex_sharpness(vertex)) {
        return None;
    }
    let sharp: SmallVec<[u32; 4]> = topology
        .sharp_edges(vertex)
        .filter(|&e| e != edge)
        .collect();
    match sharp[..] {
        [next] => Some(topology.edge(next).other(vertex)),
        _ => None,
    }
}

/// The limit at an interior vertex without creases, once its neighbours are regular: the vertex itself, and the tangents of the double eigenvalue
/// 1/2. Beside boundaries and creases no mask is given.
pub(super) fn limit(topology: &Topology, face: u32, corner: u32) -> Option<LimitStencil> {
    let &vertex = topology.face(face).get(corner as usize)?;
    let fan = closed_fan(topology, face, vertex)?;
    let n = fan.faces.len();
    let [next, previous] = if n == 6 {
        [0, 1].map(|i| regular_tangent(topology, &fan, fan.at + i))
    } else {
        let regular = |i: usize| {
            let end = topology.edge(fan.edges[i]).other(vertex);
            extraordinary(topology, fan.faces[i], end).is_none()
        };
        if n < 3 || !(0..n).all(regular) {
            return None;
        }
        [0, 1].map(|i| Some(harmonic(topology, &fan, fan.at + i)))
    };
    let position = Mask::from_slice(&[(vertex, 1.0)]);
    Some(LimitStencil::of_triangle(
        position, next?, previous?, corner,
    ))
}

/// With the one-sided rules the neighbours depend on themselves alone, and their waves once around are eigenvectors.
fn harmonic(topology: &Topology, fan: &Fan, towards: usize) -> Mask {
    let n = fan.faces.len();
    let wave = |i: usize| (TAU * (i as f64 - towards as f64) / n as f64).cos();
    let end = |i: usize| topology.edge(fan.edges[i]).other(fan.vertex);
    (0..n).map(|i| (end(i), wave(i) * 2.0 / n as f64)).collect()
}

/// The tangent among six triangles towards edge `towards`, when their far corners are regular too: the left eigenvector of 1/2, with weights 1 for
/// the neighbours, -sqrt(3) / 6 for the corners beyond two of them and 1 / 16 for those straight beyond one; scaled by 8/15 it is the derivative.
fn regular_tangent(topology: &Topology, fan: &Fan, towards: usize) -> Option<Mask> {
    let wave = |i: f64| 8.0 / 15.0 * (TAU * (i - towards as f64) / 6.0).cos();
    let mut mask = Mask::new();
    for i in 0..6 {
        let end = topology.edge(fan.edges[i]).other(fan.vertex);
        let around = closed_fan(topology, fan.faces[i], end).filter(|fan| fan.faces.len() == 6)?;
        let from = around.edges.iter().position(|&edge| edge == fan.edges[i])?;
        let other = |step: usize| topology.edge(around.edges[(from + step) % 6]).other(end);
        mask.push((end, wave(i as f64)));
        mask.push((other(3), wave(i as f64) / 16.0));
        // Around the neighbour, counter-clockwise from the middle: the neighbour before, the corner before, straight on.
        mask.push((other(2), -(3f64.sqrt()) / 6.0 * wave(i as f64 - 0.5)));
    }
    Some(mask)
}
