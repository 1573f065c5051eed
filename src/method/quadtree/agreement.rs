//! Edges that the faces on both sides evaluate with points of their own plans, and get the same bits.
//!
//! A point has the same bits in both faces if it is a sum of the same weights over the same vertices in the same order, relative to the same vertex.
//! Order and origin are the mesh's own (see `irregular.rs`, `Stencils::corner`); that the weights agree in every bit is looked up, edge by edge.
//! Where they do not, or where one side has other cells than the other, the edge gets a plan of its own.

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;

use crate::abi;
use crate::mesh::sharpness::is_infinite;
use crate::mesh::topology::Topology;
use crate::method::quadtree::irregular::{Irregular, Irregulars};
use crate::method::quadtree::plain::is_plain;
use crate::method::quadtree::store::Store;
use crate::plan::{Plan, Row, RowsView, SmoothQuads, Stretch, Strip};

/// A patch's edge.
#[derive(Clone, Copy)]
struct Side<'a> {
    topology: &'a Topology,
    patch: Irregular<'a>,
    plan: &'a Plan,
    /// The edge of the patch, 0..=3.
    edge: u32,
    /// Whether it runs against the direction of the mesh's edge.
    flipped: bool,
    /// The rows of all plans, and the number of the first of this one.
    rows: RowsView<'a>,
    first_row: u32,
}

/// Of the edges of some patches those that need no plan.
///
/// What two faces have alike depends on their plans, and on which vertices of one ring are which of the other: pairs that are alike in this are looked
/// at once.
pub fn agreed_edges(
    topology: &Topology,
    smooth: &SmoothQuads<'_>,
    patches: &Irregulars<'_>,
    slots: &[u32],
    store: &Store,
) -> Vec<u32> {
    let pairs = pairs(topology, smooth, patches, slots);
    let packed = &store.packed;
    let side = |number: Number| {
        let patch = patches.get(number.slot());
        let plan = patch.record.plan as usize;
        Side {
            topology,
            patch,
            plan: store.plan(patch.record.plan),
            edge: number.edge(),
            flipped: number.is_flipped(),
            rows: packed.rows.view(),
            first_row: packed.headers[plan].rows,
        }
    };
    let mut known: FxHashMap<Key, u32> = FxHashMap::default();
    let mut firsts = Vec::new();
    let mut numbers: Vec<u32> = Vec::with_capacity(pairs.len());
    let mut keys = Vec::new();
    for pairs in pairs.chunks(AT_A_TIME) {
        let found = pairs.par_iter();
        let found = found.map(|&[one, other]| side(one).key(side(other)));
        found.collect_into_vec(&mut keys);
        for (pair, key) in pairs.iter().zip(keys.drain(..)) {
            numbers.push(*known.entry(key).or_insert_with(|| {
                firsts.push(pair);
                firsts.len() as u32 - 1
            }));
        }
    }
    let agree: Vec<bool> = firsts
        .par_iter()
        .map(|&&[one, other]| side(one).agrees(side(other)))
        .collect();
    let agreeing = pairs.iter().zip(numbers);
    let agreeing = agreeing.filter(|&(_, number)| agree[number as usize]);
    agreeing.map(|(&[one, _], _)| side(one).number()).collect()
}

/// Takes down which edges of some faces are agreed upon, and adds the patches beyond those of which that has changed.
pub fn agree(
    topology: &Topology,
    faces: Option<&[u32]>,
    now: &[u32],
    agreed: &mut [bool],
    patches: &Irregulars<'_>,
    slots: &mut Vec<u32>,
) {
    let Some(faces) = faces else {
        // All patches are here, so none is to be added.
        agreed.fill(false);
        now.iter().for_each(|&edge| agreed[edge as usize] = true);
        return;
    };
    let edges = || faces.iter().flat_map(|&face| topology.face_edges(face));
    let before: Vec<bool> = edges().map(|&edge| agreed[edge as usize]).collect();
    edges().for_each(|&edge| agreed[edge as usize] = false);
    now.iter().for_each(|&edge| agreed[edge as usize] = true);
    let changed = edges()
        .zip(before)
        .filter(|&(&edge, before)| agreed[edge as usize] != before);
    let beyond = changed.flat_map(|(&edge, _)| topology.edge_faces(edge));
    let mut others: Vec<u32> = beyond.filter_map(|&face| patches.of_face(face)).collect();
    if others.is_empty() {
        return;
    }
    others.sort_unstable();
    others.dedup();
    let known: FxHashSet<u32> = slots.iter().copied().collect();
    slots.extend(others.into_iter().filter(|slot| !known.contains(slot)));
}

/// The vertices of a short ring.
const SHORT: usize = abi::CONTROL_INVOCATIONS as usize;
/// Of each vertex of a short ring, where it stands in another; [`SHORT`] where it does not.
type Places = SmallVec<[u8; SHORT]>;

/// What decides whether two sides agree.
#[derive(PartialEq, Eq, Hash)]
enum Key {
    /// Their plans and edges alone: all is smooth, and no vertex met twice around either face.
    Smooth([u32; 2]),
    /// Plans, edges, and which vertices of one ring are which of the other.
    Any(Box<[u8]>),
}

/// A side by its patch and edge, and whether it runs against the direction of the mesh's edge.
#[derive(Clone, Copy)]
struct Number(u32);

impl Number {
    fn new(slot: u32, edge: u32, flipped: bool) -> Number {
        Number(slot << 3 | edge << 1 | u32::from(flipped))
    }

    fn slot(self) -> u32 {
        self.0 >> 3
    }

    fn edge(self) -> u32 {
        self.0 >> 1 & 3
    }

    fn is_flipped(self) -> bool {
        self.0 & 1 != 0
    }
}

/// The two sides of each edge of some patches that quads with plans have on both, and that is neither plain nor infinitely sharp. That of the lower face comes
/// first, whoever asks.
fn pairs(
    topology: &Topology,
    smooth: &SmoothQuads<'_>,
    patches: &Irregulars<'_>,
    slots: &[u32],
) -> Vec<[Number; 2]> {
    let mut met = vec![false; topology.edge_count()];
    let mut pairs = Vec::new();
    for &slot in slots {
        let face = patches.records[slot as usize].part.face;
        // Sums over longer rings are compensated, and so depend on the weights that are zero.
        if patches.of_face(face) != Some(slot) {
            continue;
        }
        let turn = patches.turn(slot);
        for edge in 0..4 {
            let corner = ((turn + edge) % 4) as usize;
            let at = topology.face_edges(face)[corner];
            let &[one, two] = topology.edge_faces(at) else {
                continue;
            };
            let beyond = if one == face { two } else { one };
            let own = topology.edge(at);
            let is_plain = || own.vertices.iter().all(|&vertex| is_plain(smooth, vertex));
            if met[at as usize] || beyond == face || is_infinite(own.sharpness) || is_plain() {
                continue;
            }
            let Some(other) = patches.of_face(beyond) else {
                continue;
            };
            met[at as usize] = true;
            let is_flipped = |face, corner| topology.face(face)[corner] != own.vertices[0];
            let number = Number::new(slot, edge, is_flipped(face, corner));
            let edges = topology.face_edges(beyond).iter();
            let corner = edges.into_iter().position(|&edge| edge == at);
            let corner = corner.expect("a face on the edge has it");
            let edge = (corner as u32 + 4 - patches.turn(other)) % 4;
            let other = Number::new(other, edge, is_flipped(beyond, corner));
            pairs.push(if beyond < face {
                [other, number]
            } else {
                [number, other]
            });
        }
    }
    pairs
}

/// So many pairs are looked at between two looks at what is known.
const AT_A_TIME: usize = 1 << 13;

/// Pairs of points that were found to be the same: stretches side by side share most of theirs. Of each point of the first side, by the last digits of its
/// number, the last pair.
#[derive(Default)]
struct Same {
    pairs: [Option<[u32; 2]>; 32],
}

impl Same {
    /// Whether a pair is one of them. If it is not, it is to be looked at, and counts as one from now on: the first that differs ends it all.
    fn is_met(&mut self, pair: [u32; 2]) -> bool {
        let known = &mut self.pairs[pair[0] as usize % 32];
        known.replace(pair) == Some(pair)
    }
}

impl Side<'_> {
    /// The edge of the mesh.
    fn number(self) -> u32 {
        let corner = (self.patch.turn(self.topology) + self.edge) % 4;
        self.topology.face_edges(self.patch.record.part.face)[corner as usize]
    }

    fn key(self, other: Side<'_>) -> Key {
        let words = [self, other].map(|side| {
            let flags = u32::from(side.patch.record.mirrored) | u32::from(side.flipped) << 1;
            side.edge | flags << 2 | side.patch.record.plan << 4
        });
        if self.is_smooth_with(other) {
            return Key::Smooth(words);
        }
        // Short rings alone: a byte holds a place.
        let place = |&vertex: &u32| other.patch.place(vertex).map_or(u8::MAX, |at| at as u8);
        let mut key: SmallVec<[u8; 64]> = SmallVec::new();
        words.iter().for_each(|word| key.extend(word.to_le_bytes()));
        key.extend(self.patch.vertices.iter().map(place));
        Key::Any(key.as_slice().into())
    }

    /// Whether both faces and all around them are smooth, see [`Key::Smooth`].
    fn is_smooth_with(self, other: Side<'_>) -> bool {
        self.patch.record.is_smooth && other.patch.record.is_smooth
    }

    /// The stretches in the direction of the mesh's edge.
    fn stretches(self, strip: &Strip) -> impl Iterator<Item = Stretch> + '_ {
        strip.seen(self.patch.record.mirrored, self.flipped)
    }

    fn agrees(self, other: Side<'_>) -> bool {
        let strips = [self, other].map(|side| side.patch.strip(side.plan, side.edge));
        let [Some(one), Some(two)] = strips else {
            return false;
        };
        if self.flipped == other.flipped || one.count() != two.count() {
            return false;
        }
        let places = self.places_in(other);
        let mut same = Same::default();
        let stretches = self.stretches(one).zip(other.stretches(two));
        let mut stretches = stretches.into_iter();
        stretches.all(|(one, two)| self.has_same(&one, other, &two, &places, &mut same))
    }

    /// Where the vertices of this side's ring stand in the other's. Of smooth faces only those around the edge count: others may be the same in some pairs
    /// of faces, and not in others that have the same key.
    fn places_in(self, other: Side<'_>) -> Places {
        let is_smooth = self.is_smooth_with(other);
        let ends = self.topology.edge(self.number()).vertices;
        let faces = ends.iter().flat_map(|&end| self.topology.vertex_faces(end));
        let around = faces.flat_map(|at| self.topology.face(at.face));
        let around: SmallVec<[u32; 64]> = around.copied().collect();
        let place = |&vertex: &u32| {
            let counts = !is_smooth || around.contains(&vertex);
            let place = other.patch.place(vertex).filter(|_| counts);
            place.map_or(SHORT as u8, |place| place as u8)
        };
        self.patch.vertices.iter().map(place).collect()
    }

    fn has_same(
        self,
        own: &Stretch,
        other: Side<'_>,
        others: &Stretch,
        places: &[u8],
        same: &mut Same,
    ) -> bool {
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
            same.is_met([own, others])
                || self.origin(own) == other.origin(others)
                    && self.has_terms(own, other, others, places)
        })
    }

    /// Whether two points are sums of the same: the order is that of the vertices' numbers in the mesh.
    fn has_terms(self, own: u32, other: Side<'_>, others: u32, places: &[u8]) -> bool {
        let (Some(own), Some(others)) = (self.row(own), other.row(others)) else {
            return false;
        };
        let mut counts = [0; 2];
        // What stands nowhere has the weight of nothing.
        let mut weights = [f32::NAN; SHORT + 1];
        let ring = other.patch.vertices.len();
        others.each_weight(ring, |at, weight| {
            weights[at] = weight;
            counts[0] += u32::from(weight != 0.0);
        });
        let mut same = true;
        own.each_weight(places.len(), |at, weight| {
            same &= weight == 0.0 || weights[usize::from(places[at])] == weight;
            counts[1] += u32::from(weight != 0.0);
        });
        same && counts[0] == counts[1]
    }

    fn row(&self, point: u32) -> Option<Row<'_>> {
        self.rows.row(self.first_row + point)
    }

    /// The vertex that a point is relative to.
    fn origin(self, point: u32) -> Option<u32> {
        let corner = self.plan.stencils.corner(point as usize)?;
        let corner = (self.patch.turn(self.topology) + self.patch.corner(corner)) % 4;
        Some(self.topology.face(self.patch.record.part.face)[corner as usize])
    }
}
