//! The hexagons H_T: limits of one refinement at the corners and the middles of the edges of each triangle (section 2.2), as rows over the
//! control vertices, made once a topology.

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::abi;
use crate::mesh::topology::Topology;
use crate::mesh::{Model, Scheme};
use crate::method::points::{Points, Row};
use crate::subdivision::{
    Blend, LimitStencil, Mask, Refinement, closing_tangents, deep_limit, is_cusp, is_unpromised,
    orthonormal_masks, refine_all, tangents_nearby,
};

/// The points of all hexagons. One a vertex of the refined mesh, more where infinite creases part its faces into sectors. At a cusp, where each
/// face has a normal of its own, a sector has the mean of these: so normals agree along its smooth edges.
pub struct Hexagons {
    /// How they are computed.
    pub points: Points,
    refined: Topology,
    /// The first child of each triangle.
    firsts: Vec<u32>,
    /// The point at each corner of each of its faces.
    numbers: Vec<[u32; 3]>,
    /// How many points a vertex of the refined mesh has.
    counts: Vec<u32>,
    /// The vertices whose points stand for several normals.
    cusps: FxHashSet<u32>,
}

/// What a point stands for.
struct Place {
    vertex: u32,
    /// The lowest face of its sector.
    face: u32,
    kind: Kind,
}

/// How a point comes to its normal, in the order in which points stand.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// By the limit's tangents.
    Limit,
    /// Likewise, or by others where these cancel.
    Closing,
    /// Between two sharp edges of a single face, and where no tangent plane is promised: likewise, or by tangents nearby on these faces.
    Checked(Vec<u32>),
    /// At a cusp: by tangents nearby on all these faces of the sector.
    Cusp(Vec<u32>),
}

/// A place that is not numbered yet.
const UNNUMBERED: u32 = u32::MAX;

impl Hexagons {
    /// Refines once and collects the limits.
    pub fn new(model: &Model) -> Hexagons {
        let topology = model.topology();
        let scheme = model.mesh().options().scheme;
        let Refinement {
            topology: refined,
            masks,
            ..
        } = refine_all(topology, scheme);
        let mut counts = vec![0; refined.vertex_count()];
        let mut places: Vec<Place> = Vec::new();
        // At first of the place of each corner, then of its point.
        let mut numbers = vec![[UNNUMBERED; 3]; refined.face_count()];
        for face in (0..refined.face_count() as u32).filter(|&face| !refined.is_hole(face)) {
            for (corner, &vertex) in (0..).zip(refined.face(face)) {
                if numbers[face as usize][corner as usize] != UNNUMBERED {
                    continue;
                }
                let sector = sector(&refined, face, corner);
                for &face in &sector {
                    let corner = refined.corner_of(face, vertex);
                    numbers[face as usize][corner as usize] = places.len() as u32;
                }
                let of_control = (vertex as usize) < topology.vertex_count();
                places.push(Place {
                    vertex,
                    face: sector[0],
                    kind: kind(&refined, scheme, sector, vertex, of_control),
                });
                counts[vertex as usize] += 1;
            }
        }
        let numbers = sort(&mut places, numbers);
        // Faces that were removed have no children.
        let children = |face| 4 * topology.face(face).len().min(1) as u32;
        let firsts = (0..topology.face_count() as u32).scan(0, |next, face| {
            let first = *next;
            *next += children(face);
            Some(first)
        });
        let firsts: Vec<u32> = firsts.collect();
        let rows = Rows {
            topology,
            refined: &refined,
            scheme,
            masks: &masks,
            firsts: &firsts,
        };
        let cusps = places
            .iter()
            .filter(|place| matches!(place.kind, Kind::Cusp(_)));
        Hexagons {
            points: rows.points(&places),
            cusps: cusps.map(|place| place.vertex).collect(),
            refined,
            numbers,
            counts,
            firsts,
        }
    }

    /// The points of a triangle, corners first, then the middles of the edges from corner i to corner i + 1; and the flags of those places
    /// where the surface has several normals.
    pub fn of(&self, face: u32) -> ([u32; 6], u32) {
        let child = |number: u32| self.firsts[face as usize] + number;
        let mut flags = 0;
        let points = std::array::from_fn(|i| {
            // A corner belongs to the child there, the middle of an edge to the middle child, opposite to its corner.
            let (child, corner) = match i {
                0..3 => (child(i as u32), i as u32),
                _ => (child(3), (i as u32 + 2) % 3),
            };
            let vertex = self.refined.face(child)[corner as usize];
            if self.counts[vertex as usize] > 1 || self.cusps.contains(&vertex) {
                flags |= super::creased(i);
            }
            self.numbers[child as usize][corner as usize]
        });
        (points, flags)
    }
}

/// How the point of a sector around `vertex` comes to its normal.
fn kind(
    refined: &Topology,
    scheme: Scheme,
    sector: Vec<u32>,
    vertex: u32,
    of_control: bool,
) -> Kind {
    let face = sector[0];
    let corner = refined.corner_of(face, vertex);
    match sector.len() {
        1 => Kind::Checked(sector),
        _ if of_control && is_unpromised(refined, scheme, face, corner) => Kind::Checked(sector),
        _ if is_cusp(refined, face, corner) => Kind::Cusp(sector),
        _ if closing_tangents(refined, face, corner).is_some() => Kind::Closing,
        _ => Kind::Limit,
    }
}

/// Puts places that come to their normals alike in a row, and their numbers right.
fn sort(places: &mut Vec<Place>, mut numbers: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    let mut sorted: Vec<(u32, Place)> = (0..).zip(std::mem::take(places)).collect();
    sorted.sort_by(|(_, a), (_, b)| a.kind.cmp(&b.kind));
    let mut points = vec![0; sorted.len()];
    for (point, &(place, _)) in (0..).zip(&sorted) {
        points[place as usize] = point;
    }
    for number in numbers.as_flattened_mut() {
        // Corners of holes have none.
        *number = points.get(*number as usize).copied().unwrap_or(UNNUMBERED);
    }
    places.extend(sorted.into_iter().map(|(_, place)| place));
    numbers
}

/// The faces around a corner up to the next infinite creases, the lowest first.
fn sector(topology: &Topology, face: u32, corner: u32) -> Vec<u32> {
    let mut faces = topology.fan(face, corner).faces.to_vec();
    faces.sort_unstable();
    faces
}

/// What the rows are made of.
struct Rows<'a> {
    topology: &'a Topology,
    refined: &'a Topology,
    scheme: Scheme,
    /// Of each vertex of the refined mesh, over the control vertices.
    masks: &'a [Mask],
    /// The first child of each triangle.
    firsts: &'a [u32],
}

/// So many halvings lead from a vertex of the refined mesh to the surroundings that the truth asks, 1/64 away in the control mesh.
const HALVINGS: u32 = 5;

impl Rows<'_> {
    /// Limits of all places, and what else their normals come from. All points of a vertex have the position of the first: the same bits whatever
    /// rounding did to the others.
    fn points(&self, places: &[Place]) -> Points {
        let mut points = Points::default();
        let of_kind = |kind: fn(&Kind) -> bool| {
            let first = places.iter().position(|place| kind(&place.kind));
            let found = places.iter().filter(move |place| kind(&place.kind));
            (first.unwrap_or(0) as u32, found.collect::<Vec<_>>())
        };
        let limits: Vec<LimitStencil> = places
            .par_iter()
            .map(|place| match place.kind {
                Kind::Checked(_) => self.checked_limit(place),
                _ => self.limit(place.face, place.vertex),
            })
            .collect();
        let mut positions: FxHashMap<u32, Mask> = FxHashMap::default();
        points.begin(abi::POINTS_LIMIT, 0);
        for (place, LimitStencil { position, du, dv }) in places.iter().zip(&limits) {
            let position = &*positions
                .entry(place.vertex)
                .or_insert_with(|| position.clone());
            points.push(match place.kind {
                Kind::Checked(_) => Row::Firm([position, du, dv]),
                _ => Row::Limit([position, du, dv]),
            });
        }
        let (first, closing) = of_kind(|kind| *kind == Kind::Closing);
        points.begin(abi::POINTS_SPARE, first);
        for place in closing {
            let corner = self.corner(place.face, place.vertex);
            let closing = closing_tangents(self.refined, place.face, corner);
            let closing = closing.expect("places of this kind have them");
            self.push(&mut points, place.vertex, closing);
        }
        let (first_checked, checked) = of_kind(|kind| matches!(kind, Kind::Checked(_)));
        let (first_cusp, cusps) = of_kind(|kind| matches!(kind, Kind::Cusp(_)));
        let faces = |place: &Place| match &place.kind {
            Kind::Checked(faces) | Kind::Cusp(faces) => faces.clone(),
            Kind::Limit | Kind::Closing => Vec::new(),
        };
        let mut next = places.len() as u32;
        points.begin(abi::POINTS_LIMIT, next);
        for place in checked.iter().chain(&cusps) {
            for face in faces(place) {
                self.push(&mut points, place.vertex, self.nearby(face, place.vertex));
            }
        }
        for (kind, first, places) in [
            (abi::POINTS_NEARBY, first_checked, checked),
            (abi::POINTS_CUSP, first_cusp, cusps),
        ] {
            points.begin(kind, first);
            for place in places {
                let numbers = next..next + faces(place).len() as u32;
                next = numbers.end;
                points.push(Row::Normals(&numbers.map(|face| (face, 1.0)).collect()));
            }
        }
        points
    }

    /// Adds a row of tangents over the vertices of the refined mesh, about a vertex.
    fn push(&self, points: &mut Points, vertex: u32, tangents: [Mask; 2]) {
        let [du, dv] = tangents.map(|mask| Mask::blend(&mask, self.masks));
        points.push(Row::Limit([&self.masks[vertex as usize], &du, &dv]));
    }

    fn corner(&self, face: u32, vertex: u32) -> u32 {
        let corner = self.refined.face(face).iter().position(|&v| v == vertex);
        corner.expect("the face has this vertex") as u32
    }

    /// The limit at a vertex of the refined mesh, seen from a face, over the control vertices. Of the tangents only the plane counts.
    fn limit(&self, face: u32, vertex: u32) -> LimitStencil {
        let limit = deep_limit(self.refined, self.scheme, face, self.corner(face, vertex));
        let limit = limit.expect("the face has this vertex");
        let over_controls = |mask: &Mask| Mask::blend(mask, self.masks);
        let [du, dv] = orthonormal_masks(&over_controls(&limit.du), &over_controls(&limit.dv));
        LimitStencil {
            position: over_controls(&limit.position),
            du,
            dv,
        }
    }

    /// Likewise, with the tangents of the control mesh itself: where none are promised each refinement may bring them nearer to parallel, and truth and
    /// method shall agree on whether they are firm. Only faces around control vertices are alone, or without a promised plane; each is the child at that
    /// corner of its own.
    fn checked_limit(&self, place: &Place) -> LimitStencil {
        // Of those that begin alike, all but the last were removed.
        let parent = self.firsts.partition_point(|&first| first <= place.face) - 1;
        let (face, corner) = (parent as u32, place.face - self.firsts[parent]);
        let limit = deep_limit(self.topology, self.scheme, face, corner);
        let LimitStencil { du, dv, .. } = limit.expect("the face has this corner");
        let [du, dv] = orthonormal_masks(&du, &dv);
        LimitStencil {
            du,
            dv,
            ..self.limit(place.face, place.vertex)
        }
    }

    fn nearby(&self, face: u32, vertex: u32) -> [Mask; 2] {
        let corner = self.corner(face, vertex);
        tangents_nearby(self.refined, self.scheme, face, corner, HALVINGS)
    }
}
