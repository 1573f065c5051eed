//! The rules of all schemes, chosen in one place.

mod butterfly;
mod loops;
mod mixed;

use crate::mesh::Scheme;
use crate::mesh::topology::Topology;
use crate::subdivision::limit::{Family, LimitStencil, family_stencil};
use crate::subdivision::masks::{self, Mask};
use crate::subdivision::refine::Origin;

pub(super) use loops::neighbour_weight;

/// How a scheme makes the points of the next level and what is known of its limit.
pub(super) struct Rules {
    /// The mask of a vertex point.
    pub vertex: fn(&Topology, u32) -> Mask,
    /// The mask of an edge point.
    pub edge: fn(&Topology, u32) -> Mask,
    /// The limit at a corner of a face, where a mask is known.
    pub limit: fn(&Topology, u32, u32) -> Option<LimitStencil>,
    /// How many rings of faces around a face its children depend on.
    pub rings: usize,
}

/// The rules of a scheme.
pub(super) fn rules(scheme: Scheme) -> Rules {
    match scheme {
        Scheme::CatmullClark => Rules {
            vertex: masks::vertex_point,
            edge: masks::edge_point,
            limit: |topology, face, corner| family_stencil(topology, face, corner, Family::Quads),
            rings: 1,
        },
        Scheme::Loop => Rules {
            vertex: loops::vertex_point,
            edge: loops::edge_point,
            limit: |topology, face, corner| {
                family_stencil(topology, face, corner, Family::Triangles)
            },
            rings: 1,
        },
        Scheme::Butterfly => Rules {
            vertex: |_, vertex| Mask::from_slice(&[(vertex, 1.0)]),
            edge: butterfly::edge_point,
            limit: butterfly::limit,
            rings: 2,
        },
        Scheme::LoopStam => Rules {
            vertex: mixed::vertex_point,
            edge: mixed::edge_point,
            limit: mixed::limit,
            rings: 1,
        },
        Scheme::Bilinear => Rules {
            vertex: |_, vertex| Mask::from_slice(&[(vertex, 1.0)]),
            edge: |topology, edge| {
                topology
                    .edge(edge)
                    .vertices
                    .map(|vertex| (vertex, 0.5))
                    .into_iter()
                    .collect()
            },
            limit: bilinear_limit,
            rings: 1,
        },
    }
}

/// How many rings of faces around a face its limit depends on.
pub(crate) fn rings(scheme: Scheme) -> usize {
    rules(scheme).rings
}

/// The mask of a point of the next level.
pub(super) fn point(rules: &Rules, topology: &Topology, origin: Origin) -> Mask {
    match origin {
        Origin::Vertex(vertex) => (rules.vertex)(topology, vertex),
        Origin::Edge(edge) => (rules.edge)(topology, edge),
        Origin::Face(face) => masks::face_point(topology, face),
    }
}

/// Position and two tangents of the limit at `corner` of `face`, as masks over the vertices of the topology, or None where no mask is known.
///
/// None where there is no such corner, and where something semi-sharp at the vertex or a face that is no quad (no triangle) asks for refinement first. Beyond that, after any
/// number of refinements, where a scheme's limit has no mask: see [`LimitSurface`](crate::subdivision::LimitSurface).
pub fn vertex_limit(
    topology: &Topology,
    scheme: Scheme,
    face: u32,
    corner: u32,
) -> Option<LimitStencil> {
    (rules(scheme).limit)(topology, face, corner)
}

/// The vertex itself, and the edges of a quad.
fn bilinear_limit(topology: &Topology, face: u32, corner: u32) -> Option<LimitStencil> {
    let vertices: [u32; 4] = topology.face(face).try_into().ok()?;
    let along =
        |from: usize, to: usize| Mask::from_slice(&[(vertices[to], 1.0), (vertices[from], -1.0)]);
    let [du, dv] = match corner {
        0 => [along(0, 1), along(0, 3)],
        1 => [along(0, 1), along(1, 2)],
        2 => [along(3, 2), along(1, 2)],
        _ => [along(3, 2), along(0, 3)],
    };
    let &vertex = vertices.get(corner as usize)?;
    Some(LimitStencil {
        position: Mask::from_slice(&[(vertex, 1.0)]),
        du,
        dv,
    })
}
