//! Which faces are around the corners of a face, in the order in which a walk meets them.

use smallvec::SmallVec;

use crate::mesh::places::Places;
use crate::mesh::sharpness::is_infinite;
use crate::mesh::topology::{FaceCorner, Topology};

/// So many faces around a hub, or corners of one, to either side, has the ring of an edge or spoke. Each level of refinement needs one more, and two steps lead to
/// the first: plans are of [`HIGHEST_LEVEL`](crate::abi::HIGHEST_LEVEL) levels, those of halved edges of one more. A ring around a hub is a long one then,
/// of more vertices than the control shader has invocations.
pub(super) const EDGE_REACH: u32 = 16;
/// The ring of a face has those of its edges.
pub(super) const FACE_REACH: u32 = EDGE_REACH + 1;
/// So many corners of a hub beside the ring's own vertices, to either side: its edges there, and so many that it is neither a triangle nor a quad.
pub(super) const BESIDE: u32 = 2;

/// Where a walk begins, and which way it goes around.
#[derive(Clone, Copy)]
pub(super) struct Start {
    pub face: u32,
    pub corner: u32,
    pub mirrored: bool,
}

impl Start {
    /// The `i`th corner of a face of `arity` corners that the walk meets, of at most two rounds.
    pub fn corner(self, i: u32, arity: u32) -> u32 {
        let wrapped = |corner: u32| {
            if corner < arity {
                corner
            } else {
                corner - arity
            }
        };
        let i = wrapped(i);
        wrapped(if self.mirrored {
            self.corner + arity - i
        } else {
            self.corner + i
        })
    }

    /// The edge from that corner to the next.
    pub fn edge(self, i: u32, arity: u32) -> u32 {
        self.corner(i + u32::from(self.mirrored), arity)
    }
}

/// More faces than that around a vertex are many.
const FEW: usize = 64;

/// Where to begin, of the faces around a vertex or an edge: anywhere, so that what looks alike finds the same plan; but trying all of hundreds takes the square
/// of their number, and hardly ever are two so large.
pub(super) fn few<T>(all: &[T]) -> &[T] {
    if all.len() <= FEW { all } else { &all[..1] }
}

/// Every face that has one of the own vertices of the first one: around each corner in turn, counter-clockwise and then, where a boundary stopped the
/// walk, clockwise, or the other way around; last those that only a non-manifold vertex joins. Each with the corner at which its vertices begin. Around hubs
/// it goes so far to either side, and where faces are divided not across infinite creases.
pub(super) fn surrounding_faces(
    topology: &Topology,
    start: Start,
    own: &[u32],
    reach: u32,
) -> SmallVec<[Start; 16]> {
    let Start { face, mirrored, .. } = start;
    let arity = topology.face(face).len() as u32;
    let mut found = SmallVec::from_slice(&[start]);
    let mut known = Places::default();
    known.add(face);
    let mut add = |next: u32, vertex: u32| {
        if known.add(next) {
            found.push(Start {
                face: next,
                corner: topology.corner_of(next, vertex),
                mirrored,
            });
        }
    };
    'corners: for &i in own {
        let vertex = topology.face(face)[start.corner(i, arity) as usize];
        let edges = topology.face_edges(face);
        let around = topology.vertex_faces(vertex);
        let divides = topology.divides(vertex);
        let is_crowded = topology.is_crowded(vertex);
        let most = if is_crowded {
            reach as usize
        } else {
            usize::MAX
        };
        let ends = |edge: u32| divides && is_infinite(topology.edge(edge).sharpness);
        for i in [i + arity - 1, i] {
            let edge = edges[start.edge(i, arity) as usize];
            let mut met = 1;
            let walk = topology.walk(vertex, face, edge).take(most);
            for (next, _) in walk.take_while(|&(_, across)| !ends(across)) {
                add(next, vertex);
                met += 1;
            }
            if met == around.len() {
                continue 'corners;
            }
        }
        if !is_crowded {
            apart(topology, around).for_each(|corner| add(corner.face, vertex));
        }
    }
    found
}

/// Faces around a vertex, some of which only it joins. Copies of a face have the same plan if many others follow in an order that does not depend on
/// which copy asks.
fn apart<'a>(
    topology: &Topology,
    around: &'a [FaceCorner],
) -> impl Iterator<Item = FaceCorner> + use<'a> {
    let mut sorted = Vec::new();
    if around.len() > FEW {
        sorted.extend_from_slice(around);
        sorted.sort_by_cached_key(|at| -> SmallVec<[u32; 8]> {
            let mut vertices = SmallVec::from_slice(topology.face(at.face));
            vertices.rotate_left(at.corner as usize);
            vertices
        });
    }
    let few = if sorted.is_empty() { around } else { &[] };
    few.iter().copied().chain(sorted)
}

/// The corners of a face that a ring has, as steps from where it begins.
pub(super) enum Listed {
    /// So many: all of them.
    All(u32),
    /// Of a hub, those near the ring's own vertices.
    Near(SmallVec<[u32; 8]>),
}

impl Listed {
    pub fn len(&self) -> usize {
        match self {
            Listed::All(arity) => *arity as usize,
            Listed::Near(steps) => steps.len(),
        }
    }

    pub fn get(&self, number: usize) -> u32 {
        match self {
            Listed::All(_) => number as u32,
            Listed::Near(steps) => steps[number],
        }
    }
}

impl Start {
    /// The first corners of a face, which are the ring's own; of a hub as a whole those within reach.
    pub fn own_steps(self, topology: &Topology, corners: u32, reach: u32) -> SmallVec<[u32; 8]> {
        let arity = topology.face(self.face).len() as u32;
        if corners < arity || topology.hub_of(self.face).is_none() {
            return (0..corners).collect();
        }
        (0..=reach).chain(arity - reach..arity).collect()
    }

    /// How many steps lead to a corner.
    pub fn steps_to(self, corner: u32, arity: u32) -> u32 {
        let (from, to) = match self.mirrored {
            false => (self.corner, corner),
            true => (corner, self.corner),
        };
        if to >= from {
            to - from
        } else {
            to + arity - from
        }
    }
}
