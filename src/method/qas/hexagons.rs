//! The hexagons H_T: limits of one refinement at the corners and the middles of the edges of each triangle (section 2.2), as rows over the
//! control vertices, made once a topology.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::abi;
use crate::mesh::topology::Topology;
use crate::mesh::{Model, Scheme};
use crate::method::points::{Points, Row};
use crate::subdivision::{
    Blend, LimitStencil, Mask, Refinement, deep_limit, refine_all, shared_tangent_plane,
};

/// The points of all hexagons. One a vertex of the refined mesh, more where faces there have different tangent planes.
pub struct Hexagons {
    /// How they are computed.
    pub points: Points,
    refined: Topology,
    /// Points by vertex of the refined mesh and by the face that stands for those of its tangent plane.
    numbers: FxHashMap<(u32, u32), u32>,
    /// How many points a vertex of the refined mesh has.
    counts: Vec<u32>,
}

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
                let plane = shared_tangent_plane(&refined, face, corner);
                let next = numbers.len() as u32;
                numbers.entry((vertex, plane)).or_insert_with(|| {
                    places.push((vertex, plane));
                    counts[vertex as usize] += 1;
                    next
                });
            }
        }
        let stencils: Vec<LimitStencil> = places
            .par_iter()
            .map(|&(vertex, face)| stencil(&refined, scheme, face, vertex, &masks))
            .collect();
        Hexagons {
            points: rows(&places, &stencils),
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
            let plane = shared_tangent_plane(&self.refined, child, corner);
            self.numbers[&(vertex, plane)]
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

/// A row a point. All points of a vertex have the position of the first: the same bits whatever rounding did to the others.
fn rows(places: &[(u32, u32)], stencils: &[LimitStencil]) -> Points {
    let mut points = Points::default();
    let mut first: FxHashMap<u32, &Mask> = FxHashMap::default();
    points.begin(abi::POINTS_LIMIT, 0);
    for (&(vertex, _), stencil) in places.iter().zip(stencils) {
        let position = *first.entry(vertex).or_insert(&stencil.position);
        points.push(Row::Limit([position, &stencil.du, &stencil.dv]));
    }
    points
}
