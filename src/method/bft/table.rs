//! A table of basis functions: for every point of a face's lattice the weights of the configuration's vertices in its limit.
//!
//! "All vertices are placed within the plane except one which is moved to 1" (section II-A): the configuration is refined with unit vectors for
//! values, one component a vertex. All in f64; weights are rounded once, to f32.

use rustc_hash::FxHashMap;

use crate::mesh::Scheme;
use crate::mesh::topology::Topology;
use crate::method::bft::configuration::Configuration;
use crate::method::bft::lattice::Lattice;
use crate::subdivision::{
    Blend, Mask, Refinement, deep_limit, refine_all, scheme_rings, vertex_limit,
};

/// A descendant of the face: its number in the topology, and where its corners lie on the lattice of this level.
type Cell = (u32, Vec<[u32; 2]>);

/// The configuration's mesh at some level.
struct Level {
    topology: Topology,
    /// Of each vertex the weights of the configuration's vertices.
    values: Vec<Vec<f64>>,
    cells: Vec<Cell>,
}

/// The weights at each row of the lattice, one a vertex of the configuration.
pub fn weights(
    topology: &Topology,
    scheme: Scheme,
    configuration: &Configuration,
    lattice: Lattice,
) -> Vec<f32> {
    let mut level = Level::new(topology, configuration, lattice.corners);
    for _ in 0..lattice.segments.ilog2() {
        level = level.refined(scheme);
    }
    let mut limits: FxHashMap<u32, Vec<f64>> = FxHashMap::default();
    for (face, corners) in &level.cells {
        for (corner, &[i, j]) in (0..).zip(corners) {
            limits
                .entry(lattice.row(i, j))
                .or_insert_with(|| level.limit(scheme, *face, corner));
        }
    }
    let rows = (0..lattice.rows()).flat_map(|row| &limits[&row]);
    rows.map(|&weight| weight as f32).collect()
}

impl Level {
    /// The configuration itself.
    fn new(topology: &Topology, configuration: &Configuration, corners: u32) -> Level {
        let (topology, vertices) = topology.excerpt(&configuration.faces);
        let order: FxHashMap<u32, usize> =
            configuration.vertices.iter().copied().zip(0..).collect();
        let unit = |vertex: &u32| {
            let mut value = vec![0.0; vertices.len()];
            value[order[vertex]] = 1.0;
            value
        };
        let mut corners: Vec<[u32; 2]> = match corners {
            3 => vec![[0, 0], [1, 0], [0, 1]],
            _ => vec![[0, 0], [1, 0], [1, 1], [0, 1]],
        };
        corners.rotate_right(configuration.turn as usize);
        Level {
            values: vertices.iter().map(unit).collect(),
            topology,
            cells: vec![(0, corners)],
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

    /// The weights of the limit at a corner of a face.
    fn limit(&self, scheme: Scheme, face: u32, corner: u32) -> Vec<f64> {
        Vec::blend(
            &limit_position(&self.topology, scheme, face, corner),
            &self.values,
        )
    }
}

/// The mask of the limit position at a corner. An interpolating scheme's vertices are there already.
fn limit_position(topology: &Topology, scheme: Scheme, face: u32, corner: u32) -> Mask {
    if scheme == Scheme::Butterfly {
        let vertex = topology.face(face)[corner as usize];
        return Mask::from_slice(&[(vertex, 1.0)]);
    }
    let known = vertex_limit(topology, scheme, face, corner);
    known
        .unwrap_or_else(|| deep_limit(topology, scheme, face, corner))
        .position
}

/// The four children of a triangle or quad in the order of [`refine_all`], with their corners on a lattice of twice the segments: each lies between
/// two corners of the parent, and the middle of a quad between two opposite ones.
fn children(face: u32, corners: &[[u32; 2]]) -> Vec<Cell> {
    let n = corners.len();
    let between = |a: usize, b: usize| {
        let [a, b] = [corners[a % n], corners[b % n]];
        [a[0] + b[0], a[1] + b[1]]
    };
    let mut children: Vec<Cell> = (0..n)
        .map(|corner| {
            let child = (0..n).map(|other| between(corner, other));
            (4 * face + corner as u32, child.collect())
        })
        .collect();
    if n == 3 {
        let middle = (0..3).map(|corner| between(corner + 1, corner + 2));
        children.push((4 * face + 3, middle.collect()));
    }
    children
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
