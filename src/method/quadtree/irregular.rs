//! Patches that need plans.

use crate::mesh::topology::Topology;
use crate::method::Pass;
use crate::method::patches::Part;
use crate::method::quadtree::places::{self, place_at};
use crate::plan::{Plan, Strip};
use crate::tessellation::Domain;

/// What an irregular patch is, apart from its ring.
#[derive(Clone, Copy, Debug)]
pub struct Record {
    pub part: Part,
    /// The number of its plan.
    pub plan: u32,
    /// The vertices of its ring.
    pub ring_size: u32,
    /// As [`Ring::start`](crate::plan::Ring::start), of quads.
    pub start: u8,
    /// As [`Ring::mirrored`](crate::plan::Ring::mirrored).
    pub mirrored: bool,
    /// Whether all around it is smooth, and no vertex met twice: then the plan tells how the vertices of its ring hang together.
    pub is_smooth: bool,
}

/// The irregular patches of a pass. A patch's control vertices are its ring and, behind that, the order in which stencils of the inside are summed: places
/// in the ring, by the vertices' numbers in the mesh. So faces add what they share in the same order, whatever else there is in their rings.
pub struct Irregulars<'a> {
    /// By patch.
    pub records: &'a [Record],
    /// By face, the patch of a quad whose ring is short; [`NONE`] of others.
    pub of_faces: &'a [u32],
    pub pass: &'a Pass,
}

/// Instead of a patch: there is none.
pub const NONE: u32 = u32::MAX;

/// An irregular patch.
#[derive(Clone, Copy)]
pub struct Irregular<'a> {
    pub record: &'a Record,
    /// Its ring.
    pub vertices: &'a [u32],
    order: &'a [u32],
}

/// Appends a ring and its order, see [`Irregulars`].
pub fn push_ring<T: Copy + Into<u32>>(controls: &mut Vec<u32>, vertices: &[u32], order: &[T]) {
    controls.extend_from_slice(vertices);
    places::push(controls, vertices.len(), order);
}

/// The order of a ring's places, see [`Irregulars`].
pub fn order(vertices: &[u32]) -> Vec<u16> {
    let mut order: Vec<u16> = (0..vertices.len() as u16).collect();
    // Around an n-gon they are a few runs, which this sort finds.
    order.sort_by_key(|&place| vertices[place as usize]);
    order
}

impl<'a> Irregulars<'a> {
    /// Patch `number`.
    pub fn get(&self, number: u32) -> Irregular<'a> {
        let record = &self.records[number as usize];
        let first = self.pass.patches[number as usize].controls as usize;
        let count = record.ring_size as usize;
        let own = &self.pass.controls[first..first + count + places::words(count, count)];
        let (vertices, order) = own.split_at(count);
        Irregular {
            record,
            vertices,
            order,
        }
    }

    /// The corner of its quad at which patch `number` begins, as one that [`Irregulars::of_face`] tells.
    pub fn turn(&self, number: u32) -> u32 {
        self.records[number as usize].start.into()
    }

    /// The patch of a face that is a quad with a short ring: one of which each invocation of the control shader can have a vertex.
    pub fn of_face(&self, face: u32) -> Option<u32> {
        self.of_faces
            .get(face as usize)
            .copied()
            .filter(|&patch| patch != NONE)
    }
}

impl Irregular<'_> {
    /// The place that comes `i`th in the order.
    fn ordered(&self, i: usize) -> u16 {
        place_at(self.vertices.len(), self.order, i) as u16
    }

    /// Where a vertex of the mesh stands in the ring; none where it does not.
    pub fn place(&self, vertex: u32) -> Option<u16> {
        let (mut low, mut high) = (0, self.vertices.len());
        while low < high {
            let middle = (low + high) / 2;
            let place = self.ordered(middle);
            match self.vertices[place as usize].cmp(&vertex) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Greater => high = middle,
                std::cmp::Ordering::Equal => return Some(place),
            }
        }
        None
    }

    /// The corner of the quad at which the patch begins.
    pub fn turn(&self, topology: &Topology) -> u32 {
        self.record.turn(topology)
    }

    /// The corner of the patch that is corner 0..=3 of its plan, and the other way round: a mirrored plan has u and v exchanged.
    pub fn corner(&self, corner: u32) -> u32 {
        if self.record.mirrored {
            (4 - corner) % 4
        } else {
            corner
        }
    }

    /// The edge of the patch that is edge 0..=3 of its plan, and the other way round.
    pub fn edge(&self, edge: u32) -> u32 {
        if self.record.mirrored { 3 - edge } else { edge }
    }

    /// The cells of its plan along edge 0..=3 of the patch, in the direction of the plan's edge.
    pub fn strip<'p>(&self, plan: &'p Plan, edge: u32) -> Option<&'p Strip> {
        plan.strips[self.edge(edge) as usize].as_ref()
    }

    /// Whether edge 0..=3 of a quad's patch runs against the direction of the mesh's edge.
    pub fn is_flipped(&self, topology: &Topology, edge: u32) -> bool {
        let corner = ((self.turn(topology) + edge) % 4) as usize;
        let face = self.record.part.face;
        let number = topology.face_edges(face)[corner];
        topology.face(face)[corner] != topology.edge(number).vertices[0]
    }
}

impl Record {
    /// Of a slot without a patch.
    pub const VACANT: Record = Record {
        part: Part {
            domain: Domain::Quads,
            face: 0,
            corner: 0,
            ptex: 0,
        },
        plan: 0,
        ring_size: 0,
        start: 0,
        mirrored: false,
        is_smooth: false,
    };

    /// The corner of the quad at which the patch begins.
    pub fn turn(&self, topology: &Topology) -> u32 {
        match topology.face(self.part.face).len() {
            4 => self.start.into(),
            _ => 0,
        }
    }
}
