//! Edges that the faces on both sides evaluate with points of their own plans, and get the same bits.
//!
//! A point has the same bits in both faces if it is a sum of the same weights over the same vertices in the same order, relative to the same vertex.
//! Order and origin are the mesh's own (see `Irregular::order`, `Stencil::corner`); that the weights agree in every bit is looked up, edge by edge.
//! Where they do not, or where one side has other cells than the other, the edge gets a plan of its own.

use rayon::prelude::*;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::abi;
use crate::mesh::sharpness::is_infinite;
use crate::mesh::topology::Topology;
use crate::method::quadtree::irregular::Irregular;
use crate::plan::{Plan, Stretch, Strip};

/// A patch's edge.
#[derive(Clone, Copy)]
struct Side<'a> {
    topology: &'a Topology,
    patch: &'a Irregular,
    plan: &'a Plan,
    /// The edge of the patch, 0..=3.
    edge: u32,
}

/// Whether each edge of the mesh needs no plan.
///
/// What two faces have alike depends on their plans, and on which vertices of one ring are which of the other: pairs that are alike in this are looked
/// at once.
pub fn agreed_edges(
    topology: &Topology,
    plain: &[bool],
    patches: &[Irregular],
    plans: &[&Plan],
) -> Vec<bool> {
    let pairs = pairs(topology, plain, patches, plans);
    let keys: Vec<Key> = pairs
        .par_iter()
        .map(|[one, other]| one.key(*other))
        .collect();
    let mut known: FxHashMap<&Key, usize> = FxHashMap::default();
    let mut firsts = Vec::new();
    let number = |(pair, key)| {
        *known.entry(key).or_insert_with(|| {
            firsts.push(pair);
            firsts.len() - 1
        })
    };
    let numbers: Vec<usize> = pairs.iter().zip(&keys).map(number).collect();
    let agree: Vec<bool> = firsts
        .par_iter()
        .map(|[one, other]| one.agrees(*other))
        .collect();
    let mut agreed = vec![false; topology.edge_count()];
    for ([side, _], number) in pairs.iter().zip(numbers) {
        agreed[side.number() as usize] = agree[number];
    }
    agreed
}

/// Plans, edges, and which vertices of one ring are which of the other.
type Key = SmallVec<[u8; 64]>;

/// The two sides of each edge that quads with plans have on both, and that is neither plain nor infinitely sharp.
fn pairs<'a>(
    topology: &'a Topology,
    plain: &[bool],
    patches: &'a [Irregular],
    plans: &[&'a Plan],
) -> Vec<[Side<'a>; 2]> {
    let mut sides: Vec<[Option<u32>; 2]> = vec![[None; 2]; topology.edge_count()];
    // Sums over longer rings are compensated, and so depend on the weights that are zero.
    let short = |(_, patch): &(u32, &Irregular)| {
        patch.ring.vertices.len() <= abi::CONTROL_INVOCATIONS as usize
            && topology.face(patch.part.face).len() == 4
    };
    for (number, patch) in (0..).zip(patches).filter(short) {
        let edges = topology.face_edges(patch.part.face);
        for edge in 0..4 {
            let at = edges[((patch.turn(topology) + edge) % 4) as usize];
            let [first, second] = &mut sides[at as usize];
            let free = if first.is_none() { first } else { second };
            *free = Some(4 * number + edge);
        }
    }
    let side = |number: u32| {
        let patch = &patches[number as usize / 4];
        Side {
            topology,
            patch,
            plan: plans[patch.plan as usize],
            edge: number % 4,
        }
    };
    let pair = |(edge, sides): (u32, &[Option<u32>; 2])| {
        let [Some(one), Some(other)] = *sides else {
            return None;
        };
        let own = topology.edge(edge);
        let is_plain = own.vertices.iter().all(|&vertex| plain[vertex as usize]);
        let shared = topology.edge_faces(edge).len() == 2 && !is_infinite(own.sharpness);
        (shared && !is_plain).then(|| [side(one), side(other)])
    };
    (0..).zip(&sides).filter_map(pair).collect()
}

impl Side<'_> {
    /// The edge of the mesh.
    fn number(self) -> u32 {
        let corner = (self.patch.turn(self.topology) + self.edge) % 4;
        self.topology.face_edges(self.patch.part.face)[corner as usize]
    }

    fn key(self, other: Side<'_>) -> Key {
        let mut key = Key::new();
        for side in [self, other] {
            let flags = u8::from(side.patch.ring.mirrored) | u8::from(side.is_flipped()) << 1;
            key.extend(side.patch.plan.to_le_bytes());
            key.push(side.edge as u8 | flags << 2);
        }
        // Short rings alone: a byte holds a place.
        let place = |&vertex: &u32| other.patch.place(vertex).map_or(u8::MAX, |at| at as u8);
        key.extend(self.patch.ring.vertices.iter().map(place));
        key
    }

    fn is_flipped(self) -> bool {
        self.patch.is_flipped(self.topology, self.edge)
    }

    /// The stretches in the direction of the mesh's edge.
    fn strip(self) -> Option<Strip> {
        let strip = self.patch.strip(self.plan, self.edge)?;
        Some(if self.is_flipped() {
            strip.reversed()
        } else {
            strip
        })
    }

    fn agrees(self, other: Side<'_>) -> bool {
        let (Some(one), Some(two)) = (self.strip(), other.strip()) else {
            return false;
        };
        self.is_flipped() != other.is_flipped()
            && one.stretches().count() == two.stretches().count()
            && one
                .stretches()
                .zip(two.stretches())
                .all(|(one, two)| self.has_same(one, other, two))
    }

    fn has_same(self, own: &Stretch, other: Side<'_>, others: &Stretch) -> bool {
        if (own.depth, own.at, own.crease) != (others.depth, others.at, others.crease) {
            return false;
        }
        let (Some(own_points), Some(other_points)) = (own.points, others.points) else {
            return own.points == others.points;
        };
        let points = own_points
            .iter()
            .flatten()
            .zip(other_points.iter().flatten());
        let mut pairs = points.chain([(&own.base, &others.base)]);
        pairs.all(|(&own, &others)| {
            self.origin(own) == other.origin(others) && self.terms(own).eq(other.terms(others))
        })
    }

    /// The vertex that a point is relative to.
    fn origin(self, point: u32) -> Option<u32> {
        let corner = self.plan.stencils[point as usize].corner?;
        let corner = (self.patch.turn(self.topology) + self.patch.corner(corner)) % 4;
        Some(self.topology.face(self.patch.part.face)[corner as usize])
    }

    /// What a point is a sum of, in the order in which it is added.
    fn terms(&self, point: u32) -> impl Iterator<Item = (u32, u32)> {
        let weights = &self.plan.stencils[point as usize].weights;
        let vertices = &self.patch.ring.vertices;
        self.patch.order.iter().filter_map(move |&place| {
            let weight = weights[place as usize] as f32;
            (weight != 0.0).then(|| (vertices[place as usize], weight.to_bits()))
        })
    }
}
