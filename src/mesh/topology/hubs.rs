//! Hubs: vertices where very many faces meet, and faces of very many corners.
//!
//! What a hub becomes in refinement is a sum over all that is around it, and whoever touches it needs these sums, level by level. Where they are *given*, as
//! vertices that no face has, nobody beside a hub needs to list all others there: of the faces around it those near by are enough.

use crate::mesh::topology::Topology;

/// A vertex or face whose refined vertices are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Hub {
    /// The vertex or face.
    pub at: u32,
    /// The vertex that it becomes at the next level; those of the levels behind it follow, and last comes its limit.
    pub first: u32,
    /// How many these are, with the limit.
    pub count: u32,
}

impl Hub {
    /// All that is given.
    pub fn given(self) -> std::ops::Range<u32> {
        self.first..self.first + self.count
    }

    /// Its limit.
    pub fn limit(self) -> u32 {
        self.first + self.count - 1
    }

    /// What is given of the vertex that it becomes. Deeper than anybody asks it is the limit for ever.
    pub fn below(self) -> std::ops::Range<u32> {
        self.limit().min(self.first + 1)..self.first + self.count
    }
}

/// The hubs of a topology.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Hubs {
    /// In ascending order, and the faces as well.
    vertices: Vec<Hub>,
    faces: Vec<Hub>,
    dividing: Vec<u32>,
    /// Faces of which nothing is given but the mean of their vertices.
    means: Vec<Hub>,
}

impl Hubs {
    /// Of vertices and faces in any order.
    pub fn new(mut vertices: Vec<Hub>, mut faces: Vec<Hub>) -> Hubs {
        vertices.sort_unstable_by_key(|hub| hub.at);
        faces.sort_unstable_by_key(|hub| hub.at);
        Hubs {
            vertices,
            faces,
            ..Hubs::default()
        }
    }

    /// The same with faces, in ascending order, of which only the mean of their vertices is given: a single vertex each.
    pub fn with_means(self, means: Vec<Hub>) -> Hubs {
        Hubs { means, ..self }
    }

    /// The same with vertices, in ascending order, at which a face knows nothing of what lies beyond an infinite crease: corners for ever, which stay where they are, and
    /// those of two such creases.
    pub fn with_dividing(self, dividing: Vec<u32>) -> Hubs {
        Hubs { dividing, ..self }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty() && self.faces.is_empty() && self.dividing.is_empty()
    }

    /// The vertices.
    pub fn vertices(&self) -> &[Hub] {
        &self.vertices
    }

    /// The faces.
    pub fn faces(&self) -> &[Hub] {
        &self.faces
    }

    fn divides(&self, vertex: u32) -> bool {
        !self.dividing.is_empty() && self.dividing.binary_search(&vertex).is_ok()
    }

    /// Whether there is very much around a vertex of which faces there need only what is near.
    pub fn is_crowded(&self, vertex: u32) -> bool {
        found(&self.vertices, vertex).is_some() || self.divides(vertex)
    }

    /// All that is given, to be written down.
    pub fn lists(&self) -> [&[Hub]; 3] {
        [&self.vertices, &self.faces, &self.means]
    }

    /// How many vertices are given, those of means left out.
    pub fn given(&self) -> usize {
        let all = self.vertices.iter().chain(&self.faces);
        all.map(|hub| hub.count as usize).sum()
    }
}

fn found(hubs: &[Hub], at: u32) -> Option<Hub> {
    // Nearly always there are none.
    if hubs.is_empty() {
        return None;
    }
    let place = hubs.binary_search_by_key(&at, |hub| hub.at);
    place.ok().map(|place| hubs[place])
}

impl Topology {
    /// The same, where what hubs become is given.
    pub(crate) fn with_hubs(mut self, hubs: Hubs) -> Topology {
        self.hubs = hubs;
        self
    }

    /// Its hubs.
    pub(crate) fn hubs(&self) -> &Hubs {
        &self.hubs
    }

    /// What is given of a vertex.
    pub(crate) fn hub_at(&self, vertex: u32) -> Option<Hub> {
        found(&self.hubs.vertices, vertex)
    }

    /// Whether a vertex of very many faces divides them, see [`Hubs::with_dividing`].
    pub(crate) fn divides(&self, vertex: u32) -> bool {
        self.hubs.divides(vertex)
    }

    /// Whether there is very much around a vertex of which faces there need only what is near.
    pub(crate) fn is_crowded(&self, vertex: u32) -> bool {
        self.hubs.is_crowded(vertex)
    }

    /// The vertex at the mean of a face's, if that is given.
    pub(crate) fn mean_of(&self, face: u32) -> Option<u32> {
        let hub = self.hub_of(face).or_else(|| found(&self.hubs.means, face));
        hub.map(|hub| hub.first)
    }

    /// What is given of a face.
    pub(crate) fn hub_of(&self, face: u32) -> Option<Hub> {
        found(&self.hubs.faces, face)
    }
}
