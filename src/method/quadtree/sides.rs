//! The edges and corners of patches, as what has plans of its own.

use crate::abi;
use crate::mesh::topology::Topology;
use crate::method::patches::Part;
use crate::method::quadtree::hubs::is_divided;
use crate::method::quadtree::subjects::{Line, Point};

/// A part's edges: which line it is, whether the part has a half of it, and the corner of the face that the line begins with.
pub fn lines(topology: &Topology, part: Part, turn: u32) -> [(Line, u32, u32); 4] {
    let edges = topology.face_edges(part.face);
    let n = edges.len() as u32;
    let face = part.face;
    let edge = |corner: u32| match edges[corner as usize] {
        edge if is_divided(topology, edge) => Line::Side { face, corner },
        edge => Line::Edge(edge),
    };
    if n == 4 {
        return [0, 1, 2, 3].map(|i| (edge((turn + i) % 4), 0, (turn + i) % 4));
    }
    let corner = part.corner;
    let before = (corner + n - 1) % n;
    [
        (edge(corner), abi::USE_FIRST_HALF, corner),
        (Line::Spoke { face, corner }, 0, 0),
        (
            Line::Spoke {
                face,
                corner: before,
            },
            abi::USE_FLIPPED,
            0,
        ),
        (edge(before), abi::USE_SECOND_HALF, before),
    ]
}

/// A part's corners; None for the middles of edges.
pub fn points(topology: &Topology, part: Part, turn: u32) -> [Option<Point>; 4] {
    let (face, vertices) = (part.face, topology.face(part.face));
    let point = |corner: u32| match vertices[corner as usize] {
        vertex if topology.divides(vertex) => Point::Corner { face, corner },
        vertex => Point::Vertex(vertex),
    };
    if vertices.len() == 4 {
        return [0, 1, 2, 3].map(|i| Some(point((turn + i) % 4)));
    }
    [
        Some(point(part.corner)),
        None,
        Some(Point::Centre(face)),
        None,
    ]
}
