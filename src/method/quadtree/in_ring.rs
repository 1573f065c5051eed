//! Where what a patch's edges and corners are evaluated by stands in the patch's ring.

use smallvec::SmallVec;

use crate::mesh::topology::Topology;
use crate::method::quadtree::hubs;

/// The plain vertices of a patch as they are met, as places in its ring.
pub struct Plain<'a> {
    /// Where in the patch's ring the vertices of the mesh stand that are in it.
    pub in_ring: &'a InRing,
    /// The plain vertices, as places.
    pub places: &'a mut List,
    /// Their numbers by place, once they are met.
    pub numbers: List,
}

/// Where vertices of the mesh, and points of hubs, stand in the ring of a patch.
#[derive(Default)]
pub struct InRing {
    vertices: usize,
    places: Vec<u16>,
}

impl InRing {
    /// Of a patch without a ring.
    pub fn new(topology: &Topology) -> InRing {
        let vertices = topology.vertex_count();
        InRing {
            vertices,
            places: vec![u16::MAX; vertices + topology.hubs().given()],
        }
    }

    fn slot(&self, named: u32) -> usize {
        match hubs::is_point(named) {
            true => self.vertices + hubs::number_of(named) as usize,
            false => named as usize,
        }
    }

    fn get(&self, named: u32) -> u16 {
        self.places[self.slot(named)]
    }

    /// Puts a vertex at a place; `u16::MAX` takes it away.
    pub fn set(&mut self, named: u32, place: u16) {
        let slot = self.slot(named);
        self.places[slot] = place;
    }
}

/// Places in a ring, or the words of such a list.
pub type List = SmallVec<[u32; 32]>;

impl Plain<'_> {
    /// Where a vertex stands, which must be in the ring.
    pub fn place(&self, vertex: u32) -> u32 {
        let place = self.in_ring.get(vertex);
        assert_ne!(place, u16::MAX, "what a patch shares is in its ring");
        place.into()
    }

    /// The number, among the plain points, of a vertex of the mesh.
    pub fn point(&mut self, vertex: u32) -> u32 {
        let place = self.place(vertex);
        let number = &mut self.numbers[place as usize];
        if *number == u32::MAX {
            *number = self.places.len() as u32;
            self.places.push(place);
        }
        *number
    }
}
