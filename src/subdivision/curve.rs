//! Which edges are cubic B-spline curves, and the derivative of the surface across them.
//!
//! The limit along an edge, and its derivative across, depend on the faces around the edge's two ends alone: where both ends are regular,
//! on three rows of four points. With b the basis along the edge,
//!
//! ```text
//! position b . (row-1 + 4 row0 + row1) / 6    along b' . the same    across b . (row1 - row-1) / 2
//! ```
//!
//! A semi-sharp crease along the edge changes the weights of the rows (Nießner et al. 2012), an infinite one has a derivative on each side.

use crate::mesh::sharpness::{is_infinite, is_semi_sharp};
use crate::mesh::topology::Topology;
use crate::patch::crease::crease_basis;
use crate::subdivision::masks::Mask;
use crate::subdivision::regular::{ControlPoint, CornerPoints, corner_points};

/// The limit along an edge as a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeCurve {
    /// The control points of the position.
    pub position: [Mask; 4],
    /// The control points of position plus derivative across; one set for an edge that is smooth or will become so, and one a side for an
    /// infinite crease. The derivative along times the one across points to where the faces' vertices run counter-clockwise.
    pub beside: Vec<[Mask; 4]>,
    /// A semi-sharp crease that crosses the edge at an end: 0 or 1, and its sharpness.
    pub crossing: Option<(u32, f32)>,
}

/// Three rows of four points beside an edge, as a face on it sees them.
struct Rows {
    /// For each column the points of row -1, 0 and 1.
    columns: [[ControlPoint; 3]; 4],
    /// The semi-sharp creases at both ends, and whether each follows the edge.
    creases: [Option<(bool, f32)>; 2],
}

/// The edge from `a` to its other end as a curve, or None when it has to be refined first. `sides` are all faces on it.
pub fn edge_curve(topology: &Topology, edge: u32, a: u32, sides: &[u32]) -> Option<EdgeCurve> {
    let b = topology.edge(edge).other(a);
    let sharpness = topology.edge(edge).sharpness;
    if is_infinite(sharpness) {
        return sharp_curve(topology, a, b, sides);
    }
    let Rows { columns, creases } = sides.iter().find_map(|&face| rows(topology, face, a, b))?;
    let smooth = !is_semi_sharp(sharpness);
    let sixth = 1.0 / 6.0;
    let (share, crossing) = match creases {
        [None, None] if smooth => (sixth, None),
        [Some((false, crease)), None] if smooth => (sixth, Some((0, crease))),
        [None, Some((false, crease))] if smooth => (sixth, Some((1, crease))),
        [Some((true, near)), Some((true, far))] if near == far => {
            (crease_basis(0.0f64, near).value[0], None)
        }
        _ => return None,
    };
    let middle = 1.0 - 2.0 * share;
    Some(EdgeCurve {
        position: weighted(&columns, [share, middle, share]),
        beside: vec![weighted(&columns, [share - 0.5, middle, share + 0.5])],
        crossing,
    })
}

/// An infinite crease or a boundary: the crease's own B-spline, and the derivative across on each side.
fn sharp_curve(topology: &Topology, a: u32, b: u32, sides: &[u32]) -> Option<EdgeCurve> {
    let mut position = None;
    let mut beside = Vec::with_capacity(sides.len());
    for &face in sides {
        // A face that runs the other way turns its derivative round.
        let (columns, weights) = match rows(topology, face, a, b) {
            Some(rows) => (rows.columns, [0.0, 0.0, 1.0]),
            None => {
                let mut columns = rows(topology, face, b, a)?.columns;
                columns.reverse();
                (columns, [0.0, 2.0, -1.0])
            }
        };
        beside.push(weighted(&columns, weights));
        position.get_or_insert_with(|| weighted(&columns, [0.0, 1.0, 0.0]));
    }
    Some(EdgeCurve {
        position: position?,
        beside,
        crossing: None,
    })
}

/// A weighted sum of the rows, column by column.
fn weighted(columns: &[[ControlPoint; 3]; 4], weights: [f64; 3]) -> [Mask; 4] {
    columns.map(|rows| {
        rows.into_iter()
            .zip(weights)
            .filter(|&(_, weight)| weight != 0.0)
            .flat_map(|(point, weight)| {
                let mask = point.mask().into_iter();
                mask.map(move |(vertex, share)| (vertex, weight * share))
            })
            .collect()
    })
}

/// The rows beside the edge from `a` to `b` as seen from a quad whose vertices run that way; None for other faces and irregular ends.
fn rows(topology: &Topology, face: u32, a: u32, b: u32) -> Option<Rows> {
    let vertices: [u32; 4] = topology.face(face).try_into().ok()?;
    let first = (0..4).find(|&i| vertices[i] == a && vertices[(i + 1) % 4] == b)?;
    let vertex = |i: usize| ControlPoint::Vertex(vertices[(first + i) % 4]);
    let at_a: CornerPoints = corner_points(topology, face, first as u32)?;
    let at_b = corner_points(topology, face, (first as u32 + 1) % 4)?;
    Some(Rows {
        columns: [
            [at_a.diagonal, at_a.along, at_a.past_previous],
            [at_a.beside, vertex(0), vertex(3)],
            [at_b.along, vertex(1), vertex(2)],
            [at_b.diagonal, at_b.beside, at_b.past_next],
        ],
        creases: [
            at_a.crease,
            at_b.crease.map(|(next, sharpness)| (!next, sharpness)),
        ],
    })
}
