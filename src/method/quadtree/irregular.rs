//! Patches that need plans.

use crate::mesh::topology::Topology;
use crate::method::patches::Part;
use crate::plan::{Plan, Ring, Strip};

/// An irregular patch: its part, its ring, and the number of its plan.
pub struct Irregular {
    pub part: Part,
    pub ring: Ring,
    pub plan: u32,
    /// The order in which stencils of the inside are summed: places in the ring, by the vertices' numbers in the mesh. So faces add what they share in
    /// the same order, whatever else there is in their rings.
    pub order: Vec<u16>,
}

impl Irregular {
    pub fn new(part: Part, ring: Ring, plan: u32) -> Irregular {
        let mut order: Vec<u16> = (0..ring.vertices.len() as u16).collect();
        order.sort_unstable_by_key(|&place| ring.vertices[place as usize]);
        Irregular {
            part,
            ring,
            plan,
            order,
        }
    }

    /// Where a vertex of the mesh stands in the ring; none where it does not.
    pub fn place(&self, vertex: u32) -> Option<u16> {
        let vertices = &self.ring.vertices;
        let of = |&place: &u16| vertices[place as usize];
        let at = self.order.binary_search_by_key(&vertex, of).ok()?;
        Some(self.order[at])
    }

    /// The corner of the quad at which the patch begins.
    pub fn turn(&self, topology: &Topology) -> u32 {
        if topology.face(self.part.face).len() == 4 {
            self.ring.start
        } else {
            0
        }
    }

    /// The corner of the patch that is corner 0..=3 of its plan, and the other way round: a mirrored plan has u and v exchanged.
    pub fn corner(&self, corner: u32) -> u32 {
        if self.ring.mirrored {
            (4 - corner) % 4
        } else {
            corner
        }
    }

    /// The edge of the patch that is edge 0..=3 of its plan, and the other way round.
    pub fn edge(&self, edge: u32) -> u32 {
        if self.ring.mirrored { 3 - edge } else { edge }
    }

    /// The cells of its plan along edge 0..=3 of the patch, in the patch's direction.
    pub fn strip(&self, plan: &Plan, edge: u32) -> Option<Strip> {
        let strip = plan.strips[self.edge(edge) as usize].as_ref()?;
        Some(if self.ring.mirrored {
            strip.mirrored()
        } else {
            strip.clone()
        })
    }

    /// Whether edge 0..=3 of a quad's patch runs against the direction of the mesh's edge.
    pub fn is_flipped(&self, topology: &Topology, edge: u32) -> bool {
        let corner = ((self.turn(topology) + edge) % 4) as usize;
        let number = topology.face_edges(self.part.face)[corner];
        topology.face(self.part.face)[corner] != topology.edge(number).vertices[0]
    }
}
