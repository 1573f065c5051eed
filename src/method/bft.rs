//! `bft`: tables of face functions (Holländer, Boubekeur 2011, "Synthesizing Subdivision Meshes using Real Time Tessellation").
//!
//! The mesh is refined once, on the device, which leaves each face one extraordinary vertex at most (section II-B): vertices and normals of that
//! mesh are [`Points`]. Its faces are the patches. For each configuration of a face with its neighbours there is one table, at the maximum level, of
//! the weights that give the limit at every point of the face's lattice; whatever the tess level, a vertex takes a row of it and sums the
//! ring, positions and normals alike (section II-C; the normals are Alexa and Boubekeur's subdivision shading, from level 1 on). Between the points of the lattice
//! vertices lie on a virtual mesh of the maximum level.
//!
//! Shading that begins earlier carries the control mesh's normals to the refined mesh. Begun later, it has tables of its own, over the vertices of
//! the mesh refined once more; the limit's normals have tables of tangents (sections II-B and II-C name all three).
//!
//! So that both sides of an edge have the same bits, an edge is evaluated on the first face that has it, whoever asks, and so is a vertex.
//! The paper computes each edge twice and counts on equal weights.

mod configuration;
mod covered;
mod entries;
mod lattice;
mod pack;
mod table;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::abi::{self, TableFace, TablePlace};
use crate::error::{Error, Result};
use crate::mesh::topology::Topology;
use crate::mesh::{Model, Scheme};
use crate::method::surface::{Controls, SurfacePoint, Tangents, UNIT, reach};
use crate::method::triangles::corner_weights;
use crate::method::unit::unit;
use crate::method::{
    Contract, Method, MethodOptions, Pass, Prepared, Reproduces, TableNormals, TableOptions,
};
use crate::plan::Database;
use crate::subdivision::{refine_all, scheme_rings};
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
    uses_tables: true,
    isolates: false,
    aggregates: false,
    dynamic: false,
    covers: covered::check,
    prepare,
    edits: None,
};

fn prepare(model: &Model, options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let options = options.tables.check()?;
    let scheme = model.mesh().options().scheme;
    let once = refine_all(model.topology(), scheme);
    let from = options.normals;
    let twice = (from == TableNormals::Shading(2)).then(|| refine_all(&once.topology, scheme));
    let points = entries::points(model.topology(), &once, twice.as_ref(), from);
    let tables = Tables::new(
        once.topology,
        twice.map(|twice| twice.topology),
        scheme,
        options,
    );
    let [quads, triangles] = pack::passes(model, &tables);
    check_size(&quads)?;
    check_size(&triangles)?;
    Ok(Prepared {
        points,
        ..Prepared::of([quads, triangles])
    })
}

/// The bytes of a buffer that every device can bind (Vulkan spec, "Required Limits", `maxStorageBufferRange`).
const MOST_BYTES: u64 = 1 << 27;

/// Refuses tables of weights that a device may not be able to bind: many vertices of high valence, at a high level, make them so large.
fn check_size(pass: &Pass) -> Result<()> {
    let bytes = pass.table_bytes();
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    Err(Error::Option {
        option: "--table-level",
        problem: format!(
            "the tables take {bytes} bytes, and devices may bind {MOST_BYTES} at most"
        ),
        remedy: "give a lower level, shading instead of geometric normals, or another method"
            .into(),
    })
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
    normals: Normals,
}

/// What normals are sums of.
enum Normals {
    /// What positions are.
    Same,
    /// Tables of tangents, by kind.
    Tangents(Vec<Vec<f32>>),
    /// Vertices of the mesh refined once more, by face, and tables of weights, by kind.
    Refined(Vec<Option<Configuration>>, Vec<Vec<f32>>),
}

impl Tables {
    /// With the mesh refined once `more` if that is what normals come from.
    fn new(
        topology: Topology,
        more: Option<Topology>,
        scheme: Scheme,
        options: TableOptions,
    ) -> Tables {
        let TableOptions { level, normals } = options;
        let rings = scheme_rings(scheme);
        let configurations: Vec<Option<Configuration>> = (0..topology.face_count() as u32)
            .into_par_iter()
            .map(|face| {
                let drawn = !topology.is_hole(face);
                drawn.then(|| configuration(&topology, face, rings))
            })
            .collect();
        let (kinds, first) = kinds(&configurations);
        let each = |mesh: &Topology, found: &[Option<Configuration>], table: Table| {
            first
                .par_iter()
                .filter_map(|&face| {
                    let lattice = Lattice::new(domain(&topology, face), level);
                    let found = found[face as usize].as_ref()?;
                    Some(table(mesh, scheme, found, lattice))
                })
                .collect::<Vec<_>>()
        };
        let normals = match (normals, more) {
            (TableNormals::Geometric, _) => {
                Normals::Tangents(each(&topology, &configurations, table::tangents))
            }
            (_, None) => Normals::Same,
            (_, Some(more)) => {
                let found: Vec<Option<Configuration>> = configurations
                    .par_iter()
                    .map(|found| Some(found.as_ref()?.refined(&more, rings)))
                    .collect();
                let weights = each(&more, &found, table::weights);
                Normals::Refined(found, weights)
            }
        };
        Tables {
            weights: each(&topology, &configurations, table::weights),
            normals,
            configurations,
            kinds,
            level,
            topology,
        }
    }
}

/// Makes a table.
type Table = fn(&Topology, Scheme, &Configuration, Lattice) -> Vec<f32>;

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
    let sums = Sums {
        pass,
        points: &given.points,
        weights,
    };
    let own = faces[face as usize];
    let (position, shaded) = sums.weighted(own, shares);
    let other = faces[(own.normals & !abi::TABLE_TANGENTS) as usize];
    let normal = if own.normals == face {
        shaded
    } else if own.normals & abi::TABLE_TANGENTS != 0 {
        sums.limit_normal(other, shares)
    } else {
        sums.weighted(other, shares).1
    };
    SurfacePoint {
        position,
        normal: unit(normal),
    }
}

/// The derivatives of what is drawn, linear between points of the face's own lattice.
fn tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let [weights, faces, _] = &pass.tables[..] else {
        return [Vec3::ZERO; 2];
    };
    let faces: &[TableFace] = bytemuck::cast_slice(faces);
    let face = faces[pass.patches[patch].plan as usize];
    let sums = Sums {
        pass,
        points: &given.points,
        weights: bytemuck::cast_slice(weights),
    };
    let lattice = Lattice {
        corners: face.corners,
        segments: face.segments,
    };
    let shares = lattice.inside(uv.to_array());
    let origin = Vec3::from(sums.point(face, 0).position);
    lattice.changes(uv.to_array()).map(|changes| {
        (0..face.count).rev().fold(Vec3::ZERO, |sum, i| {
            let weight = |(&(row, _), change): (&(u32, f32), f32)| {
                change * sums.weights[(face.weights + row * face.count + i) as usize]
            };
            let weight: f32 = shares.iter().zip(changes).map(weight).sum();
            sum + weight * (Vec3::from(sums.point(face, i).position) - origin)
        })
    })
}

/// What is summed.
struct Sums<'a> {
    pass: &'a Pass,
    points: &'a [abi::Point],
    weights: &'a [f32],
}

impl Sums<'_> {
    fn point(&self, face: TableFace, i: u32) -> abi::Point {
        self.points[self.pass.controls[(face.controls + i) as usize] as usize]
    }

    /// Position and normal as sums over the face's points (equation 1), from the last to the first: the face's own vertices weigh most. The same
    /// weights for normals are subdivision shading (section II-C).
    fn weighted(&self, face: TableFace, shares: Shares) -> (Vec3, Vec3) {
        let (mut position, mut normal) = (Vec3::ZERO, Vec3::ZERO);
        for i in (0..face.count).rev() {
            let weight = shares.iter().fold(0.0, |sum, &(row, share)| {
                if share == 0.0 {
                    return sum;
                }
                sum + share * self.weights[(face.weights + row * face.count + i) as usize]
            });
            let point = self.point(face, i);
            position += weight * Vec3::from(point.position);
            normal += weight * Vec3::from(point.normal);
        }
        (position, normal)
    }

    /// The normal from tangents (section II-C: "tangent BFTs") at each point of the lattice, linear between. Their weights sum to zero, so they
    /// are sums of differences, which lose less; zero where rounding may have made them.
    ///
    /// Points are sums themselves, and so each spoke errs by the rounding of both its ends, as those of a ring do.
    fn limit_normal(&self, face: TableFace, shares: Shares) -> Vec3 {
        let origin = Vec3::from(self.point(face, 0).position);
        let roundings = face.count as f32 + 4.0;
        let of_row = |row: u32| {
            let first = face.weights + 2 * row * face.count;
            let mut tangents = Tangents::default();
            let (mut spread, mut total) = ([0.0; 2], [0.0; 2]);
            for i in (0..face.count).rev() {
                let spoke = Vec3::from(self.point(face, i).position) - origin;
                for tangent in 0..2 {
                    let row = first + tangent as u32 * face.count;
                    let weight = self.weights[(row + i) as usize];
                    tangents.sums[tangent] += weight * spoke;
                    spread[tangent] += weight.abs() * reach(spoke);
                    total[tangent] += weight.abs();
                }
            }
            let error = |i: usize| roundings * spread[i] + 4.0 * reach(origin) * total[i];
            tangents.errors = [0, 1].map(|i| UNIT * error(i));
            tangents.normal()
        };
        let used = shares.iter().filter(|(_, share)| *share != 0.0);
        used.fold(Vec3::ZERO, |sum, &(row, share)| sum + share * of_row(row))
    }
}

#[cfg(test)]
mod tests;
