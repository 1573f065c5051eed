//! The hexagons H_T: limits of one refinement at the corners and the middles of the edges of each triangle (section 2.2), as rows over the
//! control vertices, made once a topology.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::abi;
use crate::mesh::topology::Topology;
use crate::mesh::{Model, Scheme};
use crate::method::points::{Points, Row};
use crate::subdivision::{Blend, LimitStencil, Mask, Refinement, deep_limit, is_cusp, refine_all};

/// The points of all hexagons. One a vertex of the refined mesh, more where infinite creases part its faces into sectors. At a cusp, where each
/// face has a tangent plane of its own, a sector has the mean of their normals: so normals agree along its smooth edges.
pub struct Hexagons {
    /// How they are computed.
    pub points: Points,
    refined: Topology,
    /// Points by vertex of the refined mesh and lowest face of the sector.
    numbers: FxHashMap<(u32, u32), u32>,
    /// How many points a vertex of the refined mesh has.
    counts: Vec<u32>,
}

/// What a point stands for.
struct Place {
    vertex: u32,
    /// The lowest face of its sector.
    face: u32,
    /// At a cusp all faces of the sector, else none.
    cusp: Vec<u32>,
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
        let mut numbers = FxHashMap::default();
        let mut counts = vec![0; refined.vertex_count()];
        let mut places = Vec::new();
        for face in (0..refined.face_count() as u32).filter(|&face| !refined.is_hole(face)) {
            for (corner, &vertex) in (0..).zip(refined.face(face)) {
                let sector = sector(&refined, face, corner);
                numbers.entry((vertex, sector[0])).or_insert_with(|| {
                    let cusp = is_cusp(&refined, face, corner) && sector.len() > 1;
                    counts[vertex as usize] += 1;
                    places.push(Place {
                        vertex,
                        face: sector[0],
                        cusp: if cusp { sector } else { Vec::new() },
                    });
                    UNNUMBERED
                });
            }
        }
        // Points whose normals are means come last, in a row.
        places.sort_by_key(|place| !place.cusp.is_empty());
        for (number, place) in (0..).zip(&places) {
            numbers.insert((place.vertex, place.face), number);
        }
        let stencil =
            |&(vertex, face): &(u32, u32)| stencil(&refined, scheme, face, vertex, &masks);
        Hexagons {
            points: rows(&places, stencil),
            refined,
            numbers,
            counts,
        }
    }

    /// The points of a triangle, corners first, then the middles of the edges from corner i to corner i + 1; and the flags of those places
    /// where the surface has several normals.
    pub fn of(&self, face: u32) -> ([u32; 6], u32) {
        let child = |number: u32| 4 * face + number;
        let mut flags = 0;
        let points = std::array::from_fn(|i| {
            // A corner belongs to the child there, the middle of an edge to the middle child, opposite to its corner.
            let (child, corner) = match i {
                0..3 => (child(i as u32), i as u32),
                _ => (child(3), (i as u32 + 2) % 3),
            };
            let vertex = self.refined.face(child)[corner as usize];
            if self.counts[vertex as usize] > 1 {
                flags |= super::creased(i);
            }
            self.numbers[&(vertex, sector(&self.refined, child, corner)[0])]
        });
        (points, flags)
    }
}

/// The limit at a vertex of the refined mesh, seen from a face, over the control vertices.
fn stencil(
    refined: &Topology,
    scheme: Scheme,
    face: u32,
    vertex: u32,
    masks: &[Mask],
) -> LimitStencil {
    let corner = refined.face(face).iter().position(|&v| v == vertex);
    let corner = corner.expect("the face has this vertex") as u32;
    let limit = deep_limit(refined, scheme, face, corner);
    let over_controls = |mask: &Mask| Mask::blend(mask, masks);
    LimitStencil {
        position: over_controls(&limit.position),
        du: over_controls(&limit.du),
        dv: over_controls(&limit.dv),
    }
}

/// The faces around a corner up to the next infinite creases, the lowest first.
fn sector(topology: &Topology, face: u32, corner: u32) -> Vec<u32> {
    let mut faces = topology.fan(face, corner).faces.to_vec();
    faces.sort_unstable();
    faces
}

/// The rows: limits of all places, limits as each face at a cusp sees them, and the means of those. All points of a vertex have the position of
/// the first: the same bits whatever rounding did to the others.
fn rows(places: &[Place], stencil: impl Fn(&(u32, u32)) -> LimitStencil + Sync) -> Points {
    let mut points = Points::default();
    let mut positions: FxHashMap<u32, Mask> = FxHashMap::default();
    let mut limits = |points: &mut Points, seen: &[(u32, u32)]| {
        let stencils: Vec<LimitStencil> = seen.par_iter().map(&stencil).collect();
        for (&(vertex, _), stencil) in seen.iter().zip(&stencils) {
            let position = positions
                .entry(vertex)
                .or_insert_with(|| stencil.position.clone());
            points.push(Row::Limit([position, &stencil.du, &stencil.dv]));
        }
    };
    points.begin(abi::POINTS_LIMIT, 0);
    let seen: Vec<(u32, u32)> = places
        .iter()
        .map(|place| (place.vertex, place.face))
        .collect();
    limits(&mut points, &seen);
    let cusps = places.iter().filter(|place| !place.cusp.is_empty());
    let first = places.len() - cusps.clone().count();
    let seen: Vec<(u32, u32)> = cusps
        .clone()
        .flat_map(|place| place.cusp.iter().map(|&face| (place.vertex, face)))
        .collect();
    let mut next = places.len() as u32;
    points.begin(abi::POINTS_LIMIT, next);
    limits(&mut points, &seen);
    points.begin(abi::POINTS_NORMALS, first as u32);
    for place in cusps {
        let faces = next..next + place.cusp.len() as u32;
        next = faces.end;
        points.push(Row::Normals(&faces.map(|face| (face, 1.0)).collect()));
    }
    points
}
