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
    /// The control points of the derivative across; one set for an edge that is smooth or will become so, and one a side for an infinite crease.
    /// The derivative along times this one points to where the faces' vertices run counter-clockwise.
    pub across: Vec<[Mask; 4]>,
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

/// The edge from `a` to `b` as a curve, or None when it has to be refined first. `sides` are all faces on it.
pub fn edge_curve(topology: &Topology, edge: u32, a: u32, sides: &[u32]) -> Option<EdgeCurve> {
    let b = topology.edge(edge).other(a);
    let sharpness = topology.edge(edge).sharpness;
    if is_infinite(sharpness) {
        return sharp_curve(topology, a, b, sides);
    }
    let forward = sides.iter().find_map(|&face| rows(topology, face, a, b));
    let Rows { columns, creases } = forward?;
    let (beside, crossing) = match creases {
        [None, None] if !is_semi_sharp(sharpness) => (1.0 / 6.0, None),
        [Some((false, crease)), None] if !is_semi_sharp(sharpness) => {
            (1.0 / 6.0, Some((0, crease)))
        }
        [None, Some((false, crease))] if !is_semi_sharp(sharpness) => {
            (1.0 / 6.0, Some((1, crease)))
        }
        [Some((true, first)), Some((true, second))] if first == second => {
            (crease_basis(0.0f64, first).value[0], None)
        }
        _ => return None,
    };
    Some(EdgeCurve {
        position: weighted(&columns, [beside, 1.0 - 2.0 * beside, beside]),
        across: vec![weighted(&columns, [-0.5, 0.0, 0.5])],
        crossing,
    })
}

/// An infinite crease or a boundary: the crease's own B-spline, and the derivative across on each side.
fn sharp_curve(topology: &Topology, a: u32, b: u32, sides: &[u32]) -> Option<EdgeCurve> {
    let mut position = None;
    let mut across = Vec::with_capacity(sides.len());
    for &face in sides {
        let forward = rows(topology, face, a, b);
        let (columns, sign) = match forward {
            Some(rows) => (rows.columns, 1.0),
            None => {
                let mut columns = rows(topology, face, b, a)?.columns;
                columns.reverse();
                (columns, -1.0)
            }
        };
        across.push(weighted(&columns, [0.0, -sign, sign]));
        position.get_or_insert_with(|| weighted(&columns, [0.0, 1.0, 0.0]));
    }
    Some(EdgeCurve {
        position: position?,
        across,
        crossing: None,
    })
}

/// A weighted sum of the rows, column by column.
fn weighted(columns: &[[ControlPoint; 3]; 4], weights: [f64; 3]) -> [Mask; 4] {
    std::array::from_fn(|column| {
        let rows = columns[column].iter().zip(weights);
        rows.filter(|&(_, weight)| weight != 0.0)
            .flat_map(|(point, weight)| {
                let scaled = point.mask().into_iter();
                scaled.map(move |(vertex, share)| (vertex, weight * share))
            })
            .collect()
    })
}

/// The rows beside the edge from `a` to `b` as seen from a quad whose vertices run that way; None for other faces and irregular ends.
fn rows(topology: &Topology, face: u32, a: u32, b: u32) -> Option<Rows> {
    let &[v0, v1, v2, v3] = topology.face(face) else {
        return None;
    };
    let vertices = [v0, v1, v2, v3];
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
