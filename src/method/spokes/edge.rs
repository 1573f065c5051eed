//! An edge from vertex a to vertex b, seen from the face to its left: its points and its field, as masks.

use super::ring::Ring;
use super::{Family, sum};
use crate::mesh::topology::Topology;
use crate::subdivision::Mask;

pub struct Edge<'a> {
    family: Family,
    /// The edge's place around both ends.
    places: [usize; 2],
    ends: [&'a Ring; 2],
    /// The corners of the face where there is one alone.
    single: Option<usize>,
}

impl<'a> Edge<'a> {
    pub fn new(topology: &Topology, family: Family, edge: u32, ends: [&'a Ring; 2]) -> Edge<'a> {
        let single = match topology.edge_faces(edge) {
            &[face] => Some(topology.face(face).len()),
            _ => None,
        };
        Edge {
            family,
            places: ends.map(|ring| ring.place_of_edge(edge)),
            ends,
            single,
        }
    }

    /// In the order of its points.
    pub fn masks(&self) -> Vec<Mask> {
        let near = [0, 1].map(|end| self.near(end));
        let [first, last] = [0, 1].map(|end| self.tangent(end));
        // As the edge runs.
        let last = sum(&[(-1.0, &last)]);
        let middle = sum(&[(3.0, &near[1]), (-3.0, &near[0])]);
        let field = [
            self.outer(0),
            self.inner(0, &near[0], &first, &middle),
            self.inner(
                1,
                &near[1],
                &sum(&[(-1.0, &last)]),
                &sum(&[(-1.0, &middle)]),
            ),
            self.outer(1),
        ];
        let [near, far] = near;
        match self.family {
            Family::Gregory => [vec![near], field.to_vec(), vec![far]].concat(),
            Family::Bicubic => [vec![near, first], field.to_vec(), vec![last, far]].concat(),
        }
    }

    /// Away from an end.
    fn tangent(&self, end: usize) -> Mask {
        let ring = self.ends[end];
        let speed = match self.family {
            Family::Gregory => ring.speed,
            Family::Bicubic => 1.0,
        };
        sum(&[(speed, &ring.tangents[self.places[end]])])
    }

    /// The point next to an end.
    fn near(&self, end: usize) -> Mask {
        let ring = self.ends[end];
        match self.family {
            Family::Gregory => sum(&[(1.0, &ring.limit), (1.0 / 3.0, &self.tangent(end))]),
            Family::Bicubic => ring.on_edge(self.places[end]),
        }
    }

    /// To which side of the edge, as it leaves an end, its left lies.
    fn left(end: usize) -> isize {
        if end == 0 { 1 } else { -1 }
    }

    /// The field at an end: half of what the tangents beside it differ by; at a boundary the one that is there, without its share of the edge's own.
    fn outer(&self, end: usize) -> Mask {
        let (ring, i, left) = (self.ends[end], self.places[end], Edge::left(end));
        let own = self.tangent(end);
        let speed = match self.family {
            Family::Gregory => ring.speed,
            Family::Bicubic => 1.0,
        };
        let beside = |side: isize| {
            ring.tangent_beside(i, side)
                .filter(|_| self.has_face(end, side))
        };
        match (beside(left), beside(-left)) {
            (Some(this), Some(other)) => sum(&[(0.5 * speed, this), (-0.5 * speed, other)]),
            (this, other) => {
                let (sign, one) = match this {
                    Some(this) => (1.0, this),
                    None => (-1.0, other.expect("an edge has a face")),
                };
                sum(&[(sign * speed, one), (-sign * ring.cosine, &own)])
            }
        }
    }

    fn has_face(&self, end: usize, side: isize) -> bool {
        let step = if side > 0 { 0 } else { -1 };
        self.ends[end].face_beside(self.places[end], step).is_some()
    }

    /// The field next to an end, from its point there, its tangent away from it and the one in the middle.
    fn inner(&self, end: usize, near: &Mask, tangent: &Mask, middle: &Mask) -> Mask {
        let (ring, i, left) = (self.ends[end], self.places[end], Edge::left(end));
        let other = self.ends[1 - end].cosine;
        match (self.single, self.family) {
            (Some(4), _) => {
                // The derivative across that the bicubic point gives, without what is along the edge there.
                let face = if left > 0 { 0 } else { -1 };
                let face = ring.face_beside(i, face).expect("its face is to the left");
                let inside = ring.inner(face);
                sum(&[
                    (3.0, &inside),
                    (-3.0, near),
                    (-2.0 / 3.0 * ring.cosine, middle),
                    (1.0 / 3.0 * other, tangent),
                ])
            }
            (None, Family::Bicubic) => {
                let inside = |step: isize| {
                    let face = ring.face_beside(i, step);
                    ring.inner(face.expect("a face on either side"))
                };
                let [this, beyond] = if left > 0 { [0, -1] } else { [-1, 0] };
                sum(&[(1.5, &inside(this)), (-1.5, &inside(beyond))])
            }
            _ => sum(&[(1.0, &ring.half(i, left)), (-1.0, &ring.half(i, -left))]),
        }
    }
}
