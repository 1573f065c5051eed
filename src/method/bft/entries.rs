//! The "computational entries" of section II-B: what the refined vertices and the normals that shading begins with are computed from.
//!
//! Points 0 and up are the vertices of the mesh refined once. Those of the mesh whose normals are needed, if it is another, come after them.

use crate::abi;
use crate::mesh::topology::Topology;
use crate::method::TableNormals;
use crate::method::points::{Points, Row, ascending};
use crate::method::vertices::push_ring;
use crate::subdivision::{Blend, Mask, Refinement};

/// The points of a control mesh refined once, and `twice` where shading begins there.
pub fn points(
    control: &Topology,
    once: &Refinement,
    twice: Option<&Refinement>,
    normals: TableNormals,
) -> Points {
    let mut points = Points::default();
    points.blend(0, &once.masks);
    let others = once.masks.len() as u32;
    match (normals, twice) {
        (TableNormals::Geometric, _) => {}
        (TableNormals::Shading(0), _) => {
            let itself = |vertex| Mask::from_slice(&[(vertex, 1.0)]);
            let vertices = 0..control.vertex_count() as u32;
            points.blend(others, &vertices.map(itself).collect::<Vec<_>>());
            rings(&mut points, others, control);
            // The first step of Alexa and Boubekeur 2008, section 3: the masks of positions, then unit length.
            points.begin(abi::POINTS_NORMALS, 0);
            for mask in &once.masks {
                let shifted = ascending(mask);
                let shifted = shifted.into_iter().map(|(v, weight)| (others + v, weight));
                points.push(Row::Normals(&shifted.collect()));
            }
        }
        (_, Some(twice)) => {
            let masks = twice.masks.iter();
            let masks = masks.map(|mask| Mask::blend(mask, &once.masks));
            points.blend(others, &masks.collect::<Vec<_>>());
            rings(&mut points, others, &twice.topology);
        }
        (_, None) => rings(&mut points, 0, &once.topology),
    }
    points
}

/// Normals of the rings around all vertices of a mesh, whose vertex 0 is a point.
fn rings(points: &mut Points, first: u32, topology: &Topology) {
    points.begin(abi::POINTS_RING, first);
    for vertex in 0..topology.vertex_count() as u32 {
        push_ring(points, topology, vertex, first);
    }
}
