//! The normal near a corner, as two stencils.
//!
//! At a cusp, and between two sharp edges that are nearly parallel, the limit's tangent plane holds at a single point and nowhere around it. There the
//! truth takes the normal at (1/64, 1/64) from the corner, on each face for itself ([`LimitSurface`](crate::subdivision::LimitSurface)), and so do plans, whatever the level.

use crate::mesh::topology::Topology;
use crate::plan::level::Level;
use crate::plan::rows::Rows;
use crate::subdivision::{TangentPlane, limit_stencil, orthonormal, tangent_plane};

/// So many halvings lead to a child of a face whose far corner is at (1/64, 1/64).
const HALVINGS: u32 = 6;

/// The tangents near the corners of a face that ask for them; `base` is the quad itself or the n-gon's part at corner 0.
pub(super) fn tangents(whole: &Level<'_>, base: &Level<'_>) -> [Option<[Vec<f64>; 2]>; 4] {
    let topology = whole.topology();
    let quad = topology.face(0).len() == 4;
    [0, 1, 2, 3].map(|corner| {
        let asks = (quad || corner == 0) && is_asked(topology, corner);
        asks.then(|| at_corner(base, corner))
    })
}

fn is_asked(topology: &Topology, corner: u32) -> bool {
    let alone = topology.fan(0, corner).faces.len() == 1;
    alone || matches!(tangent_plane(topology, 0, corner), TangentPlane::Face(_))
}

fn at_corner(base: &Level<'_>, corner: u32) -> [Vec<f64>; 2] {
    let first = base.refined(&[(0, corner)]);
    let deepest = (1..HALVINGS).fold(first, |level, _| level.refined(&[(0, corner)]));
    let limit = limit_stencil(deepest.topology(), 0, (corner + 2) % 4);
    let limit = limit.expect("four quads meet inside of a face, and nothing there is sharp");
    let mut rows = Rows::zero(deepest.rows.width(), 0);
    rows.push(|row| deepest.rows.add_to(row, &limit.du));
    rows.push(|row| deepest.rows.add_to(row, &limit.dv));
    orthonormal(rows.row(0), rows.row(1))
}
