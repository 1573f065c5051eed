//! The borders of patches: by which plans of edges and vertices each is evaluated on its edges and at its corners.
//!
//! An edge's plan, the order of its vertices and its direction come from the edge alone, and a vertex's from the vertex alone, so all faces
//! there compute the same bits. Where edge and vertex are plain (smooth, four quads around each vertex) no plan is needed: B-splines
//! whose sums are symmetric give the same bits to all sides by themselves, to patches without plans as well. And where the plans of both faces on an
//! edge have the same points along it, each evaluates it with its own (see `agreement.rs`).

use std::rc::Rc;

use bytemuck::{AnyBitPattern, NoUninit};
use rustc_hash::FxHashMap;
use smallvec::smallvec;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::mesh::topology::{Hub, Topology};
use crate::method::quadtree::hubs::{self, hub_of};
use crate::method::quadtree::in_ring::{InRing, List, Plain};
use crate::method::quadtree::irregular::{Irregular, Irregulars};
use crate::method::quadtree::places;
use crate::method::quadtree::plain::{edge_rows, is_plain, vertex_rows};
use crate::method::quadtree::sides::{lines, points};
use crate::method::quadtree::store::Store;
use crate::method::quadtree::subjects::{
    Known, LONG, Line, LongRings, Point, Shared, Subject, Subjects,
};
use crate::method::regular::is_turned_corner;
use crate::plan::{Database, PlanOptions, Ring, Side, SmoothQuads};

/// The levels that a patch can be drawn at.
const LEVELS: usize = abi::HIGHEST_LEVEL as usize + 1;
/// What a patch is evaluated by.
const USES: usize = abi::USES as usize;
/// An edge of which the patch has half.
const HALVES: u32 = abi::USE_FIRST_HALF | abi::USE_SECOND_HALF;

/// What borders are found for.
#[derive(Clone, Copy)]
pub struct Given<'a> {
    /// The mesh.
    pub topology: &'a Topology,
    /// What is smooth in it.
    pub smooth: &'a SmoothQuads<'a>,
    /// The irregular patches of a pass.
    pub patches: &'a Irregulars<'a>,
    /// Of each edge of the mesh, whether both faces there evaluate it with points of their own, see `agreement.rs`.
    pub agreed: &'a [bool],
}

/// Borders, each once. They only ever grow, and their numbers stay.
#[derive(Default)]
pub struct Borders {
    /// The borders.
    pub records: Vec<abi::Border>,
    /// What they are made of.
    pub uses: Vec<abi::Use>,
    /// Where the points of slots end.
    pub ends: Vec<abi::Ends>,
    /// Roots of the trees of agreed edges, by plan, edge, whether the patch is mirrored, and whether the edge is flipped.
    strips: FxHashMap<(u32, u32, bool, bool), u32>,
    /// Where lists of places begin among the numbers of control vertices.
    lists: FxHashMap<List, u32>,
    /// Nodes of plain edges and vertices by their points.
    nodes: FxHashMap<[u32; 16], u32>,
    known_uses: FxHashMap<[u32; 5], u32>,
    known_ends: FxHashMap<[u32; 55], u32>,
    known: FxHashMap<[u32; 12], u32>,
}

/// What was found of some patches.
pub struct Found {
    /// Of each the number of its border.
    pub numbers: Vec<u32>,
    /// Which vertices of a patch's ring take part in an edge, vertex or plain points: lists one behind the other, to be appended to the numbers of control
    /// vertices.
    pub places: Vec<u32>,
}

impl Borders {
    /// Finds the borders of some irregular patches of a pass, whose plans are in its store, and packs the plans of edges and vertices that they lack.
    pub fn find(
        &mut self,
        given: Given<'_>,
        slots: &[u32],
        store: &mut Store,
        options: PlanOptions,
        database: &Database,
    ) -> Result<Found> {
        let Given {
            topology,
            smooth,
            patches,
            agreed,
        } = given;
        let is_settled = |edge: u32| {
            let ends = topology.edge(edge).vertices;
            agreed[edge as usize] || ends.iter().all(|&vertex| is_plain(smooth, vertex))
        };
        let needs_none = |point: Point| {
            matches!(point, Point::Vertex(vertex) if is_plain(smooth, vertex))
                || hub_of(topology, point).is_some()
        };
        let (mut all_lines, mut all_points) = (Subjects::new(), Subjects::new());
        for record in slots.iter().map(|&slot| &patches.records[slot as usize]) {
            let turn = record.turn(topology);
            let edges = topology.face_edges(record.part.face);
            // Of most faces around which all is smooth no edge needs a plan.
            if !record.is_smooth || !edges.iter().all(|&edge| is_settled(edge)) {
                for (line, ..) in lines(topology, record.part, turn) {
                    if !matches!(line, Line::Edge(edge) if is_settled(edge)) {
                        all_lines.add(topology, line);
                    }
                }
            }
            for point in points(topology, record.part, turn).into_iter().flatten() {
                if !needs_none(point) {
                    all_points.add(topology, point);
                }
            }
        }
        let lines = Shared::new(smooth, all_lines, store, options, database)?;
        let vertices = Shared::new(smooth, all_points, store, options, database)?;
        let mut builder = Builder {
            topology,
            smooth,
            agreed,
            in_ring: InRing::new(topology),
            stars: FxHashMap::default(),
            long_rings: LongRings::default(),
            lines: &lines,
            vertices: &vertices,
            store,
            borders: self,
            first_place: patches.pass.controls.len() as u32,
            places: Vec::new(),
        };
        let mut smooth_borders = FxHashMap::default();
        let mut numbers = Vec::with_capacity(slots.len());
        for &slot in slots {
            let patch = patches.get(slot);
            let looks = patch.record.is_smooth.then(|| builder.looks(patch));
            let known = looks.and_then(|looks| smooth_borders.get(&looks));
            if let Some(&known) = known {
                numbers.push(known);
                continue;
            }
            let border = builder.border(patch)?;
            let Borders { known, records, .. } = &mut *builder.borders;
            let number = numbered(known, records, border);
            if let Some(looks) = looks {
                smooth_borders.insert(looks, number);
            }
            numbers.push(number);
        }
        let places = builder.places;
        Ok(Found { numbers, places })
    }
}

/// Puts borders together.
struct Builder<'a> {
    topology: &'a Topology,
    smooth: &'a SmoothQuads<'a>,
    agreed: &'a [bool],
    lines: &'a Shared,
    vertices: &'a Shared,
    /// By vertex, where it stands in the ring of the patch at hand, if it does.
    in_ring: InRing,
    /// The rings of points that have none of their own.
    stars: FxHashMap<usize, Rc<Ring>>,
    long_rings: LongRings,
    store: &'a mut Store,
    borders: &'a mut Borders,
    /// Where the lists of places will begin.
    first_place: u32,
    places: Vec<u32>,
}

/// The number of a record, which is appended if it is not known.
fn numbered<T: NoUninit + AnyBitPattern, const N: usize>(
    known: &mut FxHashMap<[u32; N], u32>,
    records: &mut Vec<T>,
    record: T,
) -> u32 {
    *known.entry(bytemuck::cast(record)).or_insert_with(|| {
        records.push(record);
        records.len() as u32 - 1
    })
}

/// The flags of a corner.
fn side_flags(side: Side, creased: bool) -> u32 {
    let flag = |set: bool, flag: u32| if set { flag } else { 0 };
    abi::USE_LIMIT
        | flag(creased, abi::USE_CREASED)
        | flag(side.spare, abi::USE_SPARE)
        | side
            .pair
            .map_or(abi::USE_CUSP, |pair| pair << abi::USE_SIDE_SHIFT)
}

/// Where in a slot the points of each use end, at each level: there is a head for each use, then the plain points, then those of the plans.
///
/// # Errors
/// [`Misuse::PlanTooLarge`] when 16 bits do not hold them.
fn ends(plain: u32, counts: &[[u32; LEVELS]; USES]) -> Result<abi::Ends> {
    let mut ends = abi::Ends::default();
    for (level, words) in ends.levels.iter_mut().enumerate() {
        let mut end = abi::USES + plain;
        for (number, counts) in counts.iter().enumerate() {
            end += counts[level];
            words[number / 2] |= end << (16 * (number % 2));
        }
        let (points, greatest) = (end as usize, usize::from(u16::MAX));
        if points > greatest {
            return Err(Error::Misuse(Misuse::PlanTooLarge { points, greatest }));
        }
    }
    Ok(ends)
}

impl Builder<'_> {
    /// What decides which border a patch has around which all is smooth: its plan, what its edges are, and at its corners where it stands among the faces
    /// around.
    fn looks(&self, patch: Irregular<'_>) -> [u32; 9] {
        let (topology, turn) = (self.topology, patch.turn(self.topology));
        let record = patch.record;
        let face = record.part.face;
        let (vertices, edges) = (topology.face(face), topology.face_edges(face));
        let mut looks = [0; 9];
        looks[0] = record.plan << 1 | u32::from(record.mirrored);
        for i in 0..4 {
            let corner = (turn + i) % 4;
            let (from, edge) = (vertices[corner as usize], edges[corner as usize]);
            let flipped = from != topology.edge(edge).vertices[0];
            looks[1 + i as usize] = match self.lines.get(topology, Line::Edge(edge)) {
                _ if self.agreed[edge as usize] => 2 | u32::from(flipped),
                None => 0,
                Some(Known { plan, ring }) => {
                    let ring = ring.as_deref().expect("smooth faces have short rings");
                    let against = u32::from(from != ring.vertices[0]);
                    let beyond = u32::from(face != ring.faces[0]);
                    4 + (plan << 2 | against << 1 | beyond)
                }
            };
            let point = self.vertices.get(topology, Point::Vertex(from));
            looks[5 + i as usize] = match point {
                None => is_turned_corner(self.smooth, 4 * face + corner).into(),
                Some(known) => 2 + (known.plan << 5 | self.smooth.place_around(face, corner)),
            };
        }
        looks
    }

    fn border(&mut self, patch: Irregular<'_>) -> Result<abi::Border> {
        let (topology, smooth, turn) = (self.topology, self.smooth, patch.turn(self.topology));
        let part = patch.record.part;
        let mut uses = [abi::Use::default(); USES];
        let mut counts = [[0; LEVELS]; USES];
        let [inside @ .., _] = self.plan(&mut uses[0], patch.record.plan);
        counts[0] = inside;
        let nearby = self.store.packed.nearby[patch.record.plan as usize];
        let mut places = List::new();
        let mut in_ring = std::mem::take(&mut self.in_ring);
        for (place, &vertex) in (0..).zip(patch.vertices) {
            in_ring.set(vertex, place);
        }
        let mut plain = Plain {
            in_ring: &in_ring,
            places: &mut places,
            numbers: smallvec![u32::MAX; patch.vertices.len()],
        };
        for (edge, (line, flags, corner)) in (0..).zip(lines(topology, part, turn)) {
            let number = 1 + edge as usize;
            if matches!(line, Line::Edge(edge) if self.agreed[edge as usize]) {
                let flipped = patch.is_flipped(topology, edge);
                let turn = (edge + 2 * u32::from(flipped)) % 4;
                let direction = if flipped { abi::USE_FLIPPED } else { 0 };
                uses[number].flags = abi::USE_INSIDE | direction | turn << abi::USE_TURN_SHIFT;
                uses[number].root = self.strip(patch, edge, flipped);
                continue;
            }
            match self.lines.get(topology, line) {
                Some(known) => {
                    let long = known.ring.is_none();
                    let long = long.then(|| self.long_rings.get(topology, line));
                    let ring = known.ring.as_deref().or(long.as_deref());
                    let ring = ring.expect("it is kept, or was just found");
                    let flags = flags ^ self.line_flags(part.face, corner, line, ring, known.plan);
                    let reflected = flags & abi::USE_REFLECTED != 0;
                    let flipped = 2 * u32::from(flags & abi::USE_FLIPPED != 0 && !reflected);
                    uses[number].flags = flags | ((edge + flipped) % 4) << abi::USE_TURN_SHIFT;
                    uses[number].ring = self.places(ring, &plain);
                    let found = self.plan(&mut uses[number], known.plan);
                    // Half of an edge needs what is one level deeper in the whole.
                    let deeper = usize::from(flags & HALVES != 0);
                    counts[number] = std::array::from_fn(|level| found[level + deeper]);
                }
                None => {
                    uses[number].flags = edge << abi::USE_TURN_SHIFT;
                    let vertices = edge_rows(smooth, part.face, corner);
                    uses[number].root = self.plain_node(vertices.map(|vertex| plain.point(vertex)));
                }
            }
        }
        for (corner, point) in (0..).zip(points(topology, part, turn)) {
            let number = 5 + corner as usize;
            // Points near a corner are relative to its vertex; near the middle of an edge, to that of the n-gon's corner.
            let own = if point.is_some() {
                patch.corner(corner)
            } else {
                0
            };
            uses[number].ring = self.list(patch.vertices.len(), &[own]);
            let Some(point) = point else { continue };
            if let Some(hub) = hub_of(topology, point) {
                uses[number] = self.hub(hub, point, own, &plain);
                // Position and normal.
                counts[number] = [2; LEVELS];
                continue;
            }
            match self.vertices.get(topology, point) {
                Some(known) => {
                    let star = known.ring.is_none().then(|| self.star(point));
                    let ring = known.ring.as_deref().or(star.as_deref());
                    let ring = ring.expect("it is kept, or was just found");
                    let local = ring.faces.iter().position(|&face| face == part.face);
                    let (sides, planes) = self.store.entry(known.plan).vertex_sides();
                    let side = match point {
                        Point::Vertex(_) => sides[local.expect("the face has the vertex")],
                        Point::Centre(_) | Point::Corner { .. } => sides[0],
                    };
                    let creased = planes > 1 || matches!(point, Point::Corner { .. });
                    uses[number].flags = side_flags(side, creased);
                    uses[number].ring = self.places(ring, &plain);
                    self.plan(&mut uses[number], known.plan);
                    uses[number].root = nearby[patch.corner(corner) as usize];
                    // Position and normal.
                    counts[number] = [2; LEVELS];
                }
                None => {
                    let face_corner = (turn + corner) % 4;
                    let turned = is_turned_corner(smooth, 4 * part.face + face_corner);
                    let quarters = (corner + u32::from(turned)) % 4;
                    uses[number].flags = quarters << abi::USE_TURN_SHIFT;
                    let vertices = vertex_rows(smooth, part.face, face_corner, turned);
                    uses[number].root = self.plain_node(vertices.map(|vertex| plain.point(vertex)));
                }
            }
        }
        for &vertex in patch.vertices {
            in_ring.set(vertex, u16::MAX);
        }
        self.in_ring = in_ring;
        let plain_count = places.len() as u32;
        let ends = ends(plain_count, &counts)?;
        let plain = self.list(patch.vertices.len(), &places);
        let borders = &mut *self.borders;
        Ok(abi::Border {
            uses: uses.map(|used| numbered(&mut borders.known_uses, &mut borders.uses, used)),
            plain,
            plain_count,
            ends: numbered(&mut borders.known_ends, &mut borders.ends, ends),
        })
    }

    /// A corner at a hub, which stands at place `own` if it is a vertex: it is relative to that, or to the limit.
    fn hub(&mut self, hub: Hub, point: Point, own: u32, plain: &Plain<'_>) -> abi::Use {
        let origin = match point {
            Point::Vertex(_) | Point::Corner { .. } => own,
            Point::Centre(_) => plain.place(hub.limit()),
        };
        abi::Use {
            size: 1,
            rows: hubs::number_of(hub.limit()),
            root: hubs::normal_of(self.topology.hubs(), hub),
            ring: self.list(plain.numbers.len(), &[origin]),
            flags: abi::USE_LIMIT | abi::USE_HUB,
        }
    }

    /// The ring of a point that has none of its own.
    fn star(&mut self, point: Point) -> Rc<Ring> {
        let number = point.number(self.topology);
        if let Some(known) = self.stars.get(&number) {
            return known.clone();
        }
        let ring = self.long_rings.get(self.topology, point);
        if ring.vertices.len() <= LONG {
            self.stars.insert(number, ring.clone());
        }
        ring
    }

    /// The root of the tree of an edge that is evaluated with the points of an inside's plan.
    fn strip(&mut self, patch: Irregular<'_>, edge: u32, flipped: bool) -> u32 {
        let (number, mirrored) = (patch.record.plan, patch.record.mirrored);
        let store = &mut *self.store;
        let push = || {
            let strip = patch.strip(store.plan(number), edge);
            let strip = strip.expect("faces agree on edges along which they have cells");
            let turned = strip.turned(mirrored, flipped);
            store.push_strip(number, &turned)
        };
        *self
            .borders
            .strips
            .entry((number, edge, mirrored, flipped))
            .or_insert_with(push)
    }

    /// Which side of the line the face is on, and whether it runs the other way.
    fn line_flags(&self, face: u32, corner: u32, line: Line, ring: &Ring, plan: u32) -> u32 {
        match line {
            Line::Edge(_) => {}
            Line::Side { .. } if ring.mirrored => {
                return abi::USE_CREASED | abi::USE_FLIPPED | abi::USE_REFLECTED;
            }
            Line::Side { .. } => return abi::USE_CREASED,
            Line::Spoke { .. } => return 0,
        }
        let sides = self.store.entry(plan).edge_sides();
        let local = |&side: &u32| ring.faces[side as usize] == face;
        let side = sides.iter().position(local).unwrap_or(0) as u32;
        let creased = if sides.len() > 1 { abi::USE_CREASED } else { 0 };
        let flipped = self.topology.face(face)[corner as usize] != ring.vertices[0];
        side << abi::USE_SIDE_SHIFT | creased | if flipped { abi::USE_FLIPPED } else { 0 }
    }

    /// Gives a use its plan; tells how many stencils each level needs.
    fn plan(&self, used: &mut abi::Use, plan: u32) -> [u32; LEVELS + 1] {
        let header = &self.store.packed.headers[plan as usize];
        (used.size, used.rows, used.root) = (header.ring_size, header.rows, header.root);
        header.counts
    }

    /// Where it stands which vertices of the patch's ring a plan's ring has.
    fn places(&mut self, ring: &Ring, plain: &Plain<'_>) -> u32 {
        let places = ring.vertices.iter().map(|&vertex| plain.place(vertex));
        let places: List = places.collect();
        self.list(plain.numbers.len(), &places)
    }

    /// Where a list of places in a patch's ring of this size begins.
    fn list(&mut self, ring: usize, places: &[u32]) -> u32 {
        let (all, first) = (&mut self.places, self.first_place);
        let mut words = List::new();
        places::push(&mut words, ring, places);
        *self
            .borders
            .lists
            .entry(words)
            .or_insert_with_key(|words: &List| {
                let start = first + all.len() as u32;
                all.extend_from_slice(words);
                start
            })
    }

    /// The node of a B-spline of plain points.
    fn plain_node(&mut self, points: [u32; 16]) -> u32 {
        let packed = &mut self.store.packed;
        *self
            .borders
            .nodes
            .entry(points)
            .or_insert_with(|| packed.push_bspline(&points))
    }
}
