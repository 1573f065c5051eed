//! `bft`: tables of face functions (Holländer, Boubekeur 2011, "Synthesizing Subdivision Meshes using Real Time Tessellation").
//!
//! The mesh is refined once, on the device, which leaves each face one extraordinary vertex at most (section II-B): vertices and normals of that
//! mesh are [`Points`]. Its faces are the patches. For each configuration of a face with its neighbours there is one table, at the maximum level, of
//! the weights that give the limit at every point of the face's lattice; whatever the tess level, a vertex takes a row of it and sums the
//! ring, positions and normals alike (section II-C; the normals are Alexa and Boubekeur's subdivision shading, from level 1 on). Between the points of the lattice
//! vertices lie on a virtual mesh of the maximum level.
//!
//! So that both sides of an edge have the same bits, an edge is evaluated on the first face that has it, whoever asks, and so is a vertex.
//! The paper computes each edge twice and counts on equal weights.

mod configuration;
mod covered;
mod lattice;
mod pack;
mod table;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::abi::{self, TableFace, TablePlace};
use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::mesh::{Model, Scheme};
use crate::method::points::{Points, Row};
use crate::method::surface::{Controls, SurfacePoint, normalized};
use crate::method::triangles::corner_weights;
use crate::method::vertices;
use crate::method::{Contract, Method, Pass, Prepared, Reproduces};
use crate::plan::PlanOptions;
use crate::subdivision::{Blend, Mask, Refinement, refine_all, scheme_rings};
use crate::tessellation::Domain;

use configuration::{Configuration, configuration};
use lattice::{Lattice, Shares};

/// The row of the table.
pub const METHOD: Method = Method {
    name: "bft",
    summary: "the limit by tables of face functions, with subdivision shading",
    paper: "Holländer, Boubekeur 2011",
    schemes: &[
        Scheme::Loop,
        Scheme::CatmullClark,
        Scheme::Butterfly,
        Scheme::LoopStam,
    ],
    domains: &[Domain::Quads, Domain::Triangles],
    contract: Contract {
        reproduces: Reproduces::LimitOnLattice(1e-6),
        normals: None,
        interpolates: false,
        watertight: true,
    },
    covers: covered::check,
    prepare,
};

/// The greatest level of the tables: a patch has 2^level segments an edge, half of what its face has.
const GREATEST_TABLE_LEVEL: u32 = 6;

fn prepare(model: &Model, options: PlanOptions) -> Result<Prepared> {
    let level = table_level(options);
    let scheme = model.mesh().options().scheme;
    let Refinement {
        topology, masks, ..
    } = refine_all(model.topology(), scheme);
    let points = points(&topology, &masks);
    let tables = Tables::new(topology, scheme, level);
    let [quads, triangles] = pack::passes(model, &tables, options.max_level.min(level + 1));
    Ok(Prepared {
        points,
        ..Prepared::of([quads, triangles])
    })
}

/// The level of the tables is one less than that of plans, since a patch is half as long as its face: 5 by default, as in section II-A.
fn table_level(options: PlanOptions) -> u32 {
    let level = options.max_level.saturating_sub(1);
    level.clamp(1, GREATEST_TABLE_LEVEL)
}

/// The "computational entries" of section II-B: the refined vertices over the control vertices, and the rings around them that give normals.
fn points(refined: &Topology, masks: &[Mask]) -> Points {
    let mut points = Points::default();
    points.begin(abi::POINTS_BLEND, 0);
    for mask in masks {
        points.push(Row::Blend(&ascending(mask)));
    }
    points.begin(abi::POINTS_RING, 0);
    for vertex in 0..refined.vertex_count() as u32 {
        vertices::push_ring(&mut points, refined, vertex);
    }
    points
}

/// The mask with each vertex once, and the greatest weight last: sums of hundreds of terms, at vertices of high valence, keep their last places
/// so.
fn ascending(mask: &Mask) -> Mask {
    let mut merged = Mask::blend(&[(0, 1.0)], std::slice::from_ref(mask));
    merged.sort_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    merged
}

/// The refined mesh, the configuration of each face that is drawn, and a table for each that differs.
struct Tables {
    topology: Topology,
    level: u32,
    /// By face; none of holes.
    configurations: Vec<Option<Configuration>>,
    /// By face, the number of its table.
    kinds: Vec<u32>,
    weights: Vec<Vec<f32>>,
}

impl Tables {
    fn new(topology: Topology, scheme: Scheme, level: u32) -> Tables {
        let configurations: Vec<Option<Configuration>> = (0..topology.face_count() as u32)
            .into_par_iter()
            .map(|face| {
                let drawn = !topology.is_hole(face);
                drawn.then(|| configuration(&topology, face, scheme_rings(scheme)))
            })
            .collect();
        let (kinds, first) = kinds(&configurations);
        let lattice = |face: u32| Lattice::new(domain(&topology, face), level);
        let weights = first
            .par_iter()
            .filter_map(|&face| Some((face, configurations[face as usize].as_ref()?)))
            .map(|(face, found)| table::weights(&topology, scheme, found, lattice(face)))
            .collect();
        Tables {
            configurations,
            kinds,
            weights,
            level,
            topology,
        }
    }
}

/// The number of each face's table, and the first face of each. Holes have whichever.
fn kinds(configurations: &[Option<Configuration>]) -> (Vec<u32>, Vec<u32>) {
    let mut known = rustc_hash::FxHashMap::default();
    let mut first = Vec::new();
    let kinds = (0..).zip(configurations).map(|(face, found)| {
        let Some(found) = found else { return 0 };
        *known.entry(&found.key).or_insert_with(|| {
            first.push(face);
            first.len() as u32 - 1
        })
    });
    (kinds.collect(), first)
}

/// Faces of a refined mesh are triangles or quads.
fn domain(topology: &Topology, face: u32) -> Domain {
    match topology.face(face).len() {
        3 => Domain::Triangles,
        _ => Domain::Quads,
    }
}

/// Where a point of a patch lies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spot {
    Corner(u32),
    /// The edge from this corner to the next, and how far along it.
    Edge(u32, f32),
    Inside,
}

/// Twin of `spot` in `glsl/method/bft.glsl`.
fn spot(domain: Domain, uv: Vec2) -> Spot {
    let [u, v] = uv.to_array();
    let (on, along): (Vec<bool>, Vec<f32>) = match domain {
        Domain::Triangles => {
            let [w, _, _] = corner_weights(uv);
            (vec![v <= 0.0, w <= 0.0, u <= 0.0], vec![u, v, 1.0 - v])
        }
        Domain::Quads => (
            vec![v <= 0.0, u >= 1.0, v >= 1.0, u <= 0.0],
            vec![u, v, 1.0 - u, 1.0 - v],
        ),
    };
    let n = on.len();
    for edge in 0..n {
        if on[edge] && on[(edge + n - 1) % n] {
            return Spot::Corner(edge as u32);
        }
    }
    match on.iter().position(|&on| on) {
        Some(edge) => Spot::Edge(edge as u32, along[edge]),
        None => Spot::Inside,
    }
}

fn twin(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let [weights, faces, places] = &pass.tables[..] else {
        return SurfacePoint::default();
    };
    let weights: &[f32] = bytemuck::cast_slice(weights);
    let faces: &[TableFace] = bytemuck::cast_slice(faces);
    let places: &[TablePlace] = bytemuck::cast_slice(places);
    let corners = pass.domain.corners();
    let record = &pass.patches[patch];
    let place = |number: u32| places[record.plan as usize * 2 * corners + number as usize];
    let lattice = |face: u32| Lattice {
        corners: faces[face as usize].corners,
        segments: faces[face as usize].segments,
    };
    let (face, shares) = match spot(pass.domain, uv) {
        Spot::Inside => (record.plan, lattice(record.plan).inside(uv.to_array())),
        Spot::Edge(edge, along) => {
            let TablePlace { face, side } = place(edge);
            let flipped = side & abi::PLACE_FLIPPED != 0;
            let along = if flipped { 1.0 - along } else { along };
            let lattice = lattice(face);
            let at = along * lattice.segments as f32;
            (face, lattice.along(side & !abi::PLACE_FLIPPED, at))
        }
        Spot::Corner(corner) => {
            let TablePlace { face, side } = place(corners as u32 + corner);
            (face, [(side, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)])
        }
    };
    sum(pass, given, weights, faces[face as usize], shares)
}

/// The sum over the face's points (equation 1), from the last to the first: the face's own vertices weigh most.
fn sum(
    pass: &Pass,
    given: &Controls,
    weights: &[f32],
    face: TableFace,
    shares: Shares,
) -> SurfacePoint {
    let (mut position, mut normal) = (Vec3::ZERO, Vec3::ZERO);
    for i in (0..face.count).rev() {
        let weight = shares.iter().fold(0.0, |sum, &(row, share)| {
            if share == 0.0 {
                return sum;
            }
            sum + share * weights[(face.weights + row * face.count + i) as usize]
        });
        let point = given.points[pass.controls[(face.controls + i) as usize] as usize];
        position += weight * Vec3::from(point.position);
        normal += weight * Vec3::from(point.normal);
    }
    SurfacePoint {
        position,
        normal: normalized(normal) + Vec3::ZERO,
    }
}

#[cfg(test)]
mod tests;
