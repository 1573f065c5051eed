//! A table of basis functions: for every point of a face's lattice the weights of the configuration's vertices in its limit, or in two tangents
//! there (section II-C).
//!
//! "All vertices are placed within the plane except one which is moved to 1" (section II-A): the configuration is refined with unit vectors for
//! values, one component a vertex. All in f64; weights are rounded once, to f32.

use rustc_hash::FxHashMap;

use crate::mesh::Scheme;
use crate::mesh::topology::Topology;
use crate::method::bft::configuration::{Cell, Configuration, children};
use crate::method::bft::lattice::Lattice;
use crate::subdivision::{
    Blend, LimitStencil, Mask, Refinement, deep_limit, refine_all, scheme_rings, vertex_limit,
};

/// The configuration's mesh at some level.
struct Level {
    topology: Topology,
    /// Of each vertex the weights of the configuration's vertices.
    values: Vec<Vec<f64>>,
    /// Descendants of the face in the topology, on the lattice of this level.
    cells: Vec<Cell>,
}

/// The masks of something at a corner of a face.
type Masks = fn(&Topology, Scheme, u32, u32) -> Vec<Mask>;

/// The weights at each row of the lattice, one a vertex of the configuration.
pub fn weights(
    topology: &Topology,
    scheme: Scheme,
    configuration: &Configuration,
    lattice: Lattice,
) -> Vec<f32> {
    rows(topology, scheme, configuration, lattice, limit_position)
}

/// The weights of two tangents at each row of the lattice, those of the first before those of the second. Of the tangents only the normal counts: from
/// point to point they may turn and change their length.
pub fn tangents(
    topology: &Topology,
    scheme: Scheme,
    configuration: &Configuration,
    lattice: Lattice,
) -> Vec<f32> {
    rows(topology, scheme, configuration, lattice, limit_tangents)
}

fn rows(
    topology: &Topology,
    scheme: Scheme,
    configuration: &Configuration,
    lattice: Lattice,
    masks: Masks,
) -> Vec<f32> {
    let mut level = Level::new(topology, configuration);
    for _ in configuration.level..lattice.segments.ilog2() {
        level = level.refined(scheme);
    }
    let mut limits: FxHashMap<u32, Vec<f64>> = FxHashMap::default();
    for (face, corners) in &level.cells {
        for (corner, &[i, j]) in (0..).zip(corners) {
            limits
                .entry(lattice.row(i, j))
                .or_insert_with(|| level.weights(masks(&level.topology, scheme, *face, corner)));
        }
    }
    let rows = (0..lattice.rows()).flat_map(|row| &limits[&row]);
    rows.map(|&weight| weight as f32).collect()
}

impl Level {
    /// The configuration itself.
    fn new(topology: &Topology, configuration: &Configuration) -> Level {
        let (topology, vertices) = topology.excerpt(&configuration.faces);
        let order: FxHashMap<u32, usize> =
            configuration.vertices.iter().copied().zip(0..).collect();
        let unit = |vertex: &u32| {
            let mut value = vec![0.0; vertices.len()];
            value[order[vertex]] = 1.0;
            value
        };
        let cells = configuration.cells.iter().map(|(_, corners)| corners);
        Level {
            values: vertices.iter().map(unit).collect(),
            topology,
            cells: (0..).zip(cells.cloned()).collect(),
        }
    }

    /// Refined once; only what the face's descendants depend on is kept.
    fn refined(&self, scheme: Scheme) -> Level {
        let refinement = refine_all(&self.topology, scheme);
        let cells: Vec<Cell> = self
            .cells
            .iter()
            .flat_map(|(face, corners)| children(*face, corners))
            .collect();
        let faces = surrounded(&refinement.topology, &cells, scheme_rings(scheme));
        let Refinement {
            topology, masks, ..
        } = refinement;
        let (topology, vertices) = topology.excerpt(&faces);
        let value = |&vertex: &u32| Vec::blend(&masks[vertex as usize], &self.values);
        Level {
            topology,
            values: vertices.iter().map(value).collect(),
            cells: (0..).zip(cells).map(|(n, (_, c))| (n, c)).collect(),
        }
    }

    /// The weights of masks, one mask after the other.
    fn weights(&self, masks: Vec<Mask>) -> Vec<f64> {
        let all = masks.iter();
        all.flat_map(|mask| Vec::blend(mask, &self.values))
            .collect()
    }
}

/// The mask of the limit position at a corner. An interpolating scheme's vertices are there already.
fn limit_position(topology: &Topology, scheme: Scheme, face: u32, corner: u32) -> Vec<Mask> {
    if scheme == Scheme::Butterfly {
        let vertex = topology.face(face)[corner as usize];
        return vec![Mask::from_slice(&[(vertex, 1.0)])];
    }
    vec![limit(topology, scheme, face, corner).position]
}

/// The masks of two tangents at a corner.
fn limit_tangents(topology: &Topology, scheme: Scheme, face: u32, corner: u32) -> Vec<Mask> {
    let LimitStencil { du, dv, .. } = limit(topology, scheme, face, corner);
    vec![du, dv]
}

fn limit(topology: &Topology, scheme: Scheme, face: u32, corner: u32) -> LimitStencil {
    let known = vertex_limit(topology, scheme, face, corner);
    let limit = known.or_else(|| deep_limit(topology, scheme, face, corner));
    limit.expect("faces have their corners")
}

/// The faces of the cells, which come first, and rings of faces around them.
fn surrounded(topology: &Topology, cells: &[Cell], rings: usize) -> Vec<u32> {
    let mut faces: Vec<u32> = cells.iter().map(|(face, _)| *face).collect();
    let mut kept = vec![false; topology.face_count()];
    faces.iter().for_each(|&face| kept[face as usize] = true);
    let mut first = 0;
    for _ in 0..rings {
        let end = faces.len();
        for i in first..end {
            for &vertex in topology.face(faces[i]) {
                for corner in topology.vertex_faces(vertex) {
                    if !std::mem::replace(&mut kept[corner.face as usize], true) {
                        faces.push(corner.face);
                    }
                }
            }
        }
        first = end;
    }
    faces
}
