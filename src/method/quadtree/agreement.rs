//! Edges that the faces on both sides evaluate with points of their own plans, and get the same bits.
//!
//! A point has the same bits in both faces if it is a sum of the same weights over the same vertices in the same order, relative to the same vertex.
//! Order and origin are the mesh's own (see `Irregular::order`, `Stencil::corner`); that the weights agree in every bit is looked up, edge by edge.
//! Where they do not, or where one side has other cells than the other, the edge gets a plan of its own.

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;

use crate::abi;
use crate::mesh::sharpness::is_infinite;
use crate::mesh::topology::Topology;
use crate::method::quadtree::irregular::Irregular;
use crate::plan::{Plan, Stretch, Strip};
use crate::subdivision::is_plain_edge;

/// A patch's edge.
#[derive(Clone, Copy)]
struct Side<'a> {
    topology: &'a Topology,
    patch: &'a Irregular,
    plan: &'a Plan,
    /// The edge of the patch, 0..=3.
    edge: u32,
}

/// The edges of the mesh that need no plan.
pub fn agreed_edges(topology: &Topology, patches: &[Irregular], plans: &[Plan]) -> FxHashSet<u32> {
    let mut sides: FxHashMap<u32, SmallVec<[Side<'_>; 2]>> = FxHashMap::default();
    // Sums over longer rings are compensated, and so depend on the weights that are zero.
    let short = |patch: &&Irregular| {
        patch.ring.vertices.len() <= abi::CONTROL_INVOCATIONS as usize
            && topology.face(patch.part.face).len() == 4
    };
    for patch in patches.iter().filter(short) {
        let edges = topology.face_edges(patch.part.face);
        for edge in 0..4 {
            let number = edges[((patch.turn(topology) + edge) % 4) as usize];
            let plan = &plans[patch.plan as usize];
            sides.entry(number).or_default().push(Side {
                topology,
                patch,
                plan,
                edge,
            });
        }
    }
    let sides: Vec<(u32, SmallVec<[Side<'_>; 2]>)> = sides.into_iter().collect();
    let agreed = sides.into_par_iter().filter(|(edge, sides)| {
        let edge = *edge;
        let faces = topology.edge_faces(edge).len();
        let [one, other] = sides[..] else {
            return false;
        };
        faces == 2
            && !is_infinite(topology.edge(edge).sharpness)
            && !is_plain_edge(topology, edge)
            && one.agrees(other)
    });
    agreed.map(|(edge, _)| edge).collect()
}

impl Side<'_> {
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
