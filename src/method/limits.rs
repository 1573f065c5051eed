//! Where the control vertices are on the surface that is drawn: levels of edges go by these places, which may lie far from the vertices themselves.
//!
//! A limit is a sum over the vertices around (Halstead, Kass, DeRose 1993, appendix A; on creases Biermann, Levin, Zorin 2000, appendix A). It belongs to its vertex
//! alone, so all edges there have the same numbers, and with them both faces of each.

use std::sync::{Arc, OnceLock};

use glam::Vec3;
use rayon::prelude::*;
use smallvec::SmallVec;

use crate::abi;
use crate::mesh::sharpness::{Rule, is_semi_sharp, rule};
use crate::mesh::topology::Topology;
use crate::mesh::{ChangeSet, Model, Scheme, TriangleSubdivision};
use crate::method::points::ascending;
use crate::subdivision::{Mask, deep_limit, vertex_limit};

/// The terms of a limit: numbers of vertices, or behind [`abi::LIMIT_FACE`] that of a face, of whose vertices' sum the weight is. None where the vertex
/// itself is on the surface.
pub(super) type Row = SmallVec<[(u32, f32); 9]>;

/// Faces of more corners are one term: they would be as many at each of their corners.
const MOST_CORNERS: usize = 16;

/// Where the faces around a vertex have more corners together, and no mask is known before its surroundings are refined, it stands for its limit.
const MOST_AROUND: usize = 256;

/// The limits of all vertices, found when somebody asks. By default, and where surfaces go through their control vertices, these themselves.
#[derive(Clone, Debug, Default)]
pub(super) struct Limits {
    topology: Option<Arc<Topology>>,
    /// Clones find them once.
    rows: Arc<OnceLock<Vec<Row>>>,
}

impl Limits {
    /// Of a model whose surface is drawn; `interpolates` where that goes through its vertices whatever the scheme.
    pub fn new(model: &Model, interpolates: bool) -> Limits {
        let scheme = model.mesh().options().scheme;
        let is_on_surface = interpolates || matches!(scheme, Scheme::Butterfly | Scheme::Bilinear);
        Limits {
            topology: (!is_on_surface).then(|| model.shared_topology().clone()),
            rows: Arc::default(),
        }
    }

    /// Finds those anew that an edit may have changed, where they are known.
    pub fn renew(&mut self, model: &Model, changes: &ChangeSet) {
        if self.topology.is_none() {
            return;
        }
        let topology = model.shared_topology();
        self.topology = Some(topology.clone());
        let before = std::mem::take(&mut self.rows);
        let known = match Arc::try_unwrap(before) {
            Ok(rows) => rows.into_inner(),
            Err(shared) => shared.get().cloned(),
        };
        let Some(mut rows) = known else { return };
        let around = changes.faces().iter().flat_map(|&face| topology.face(face));
        // And those that faces have begun or ceased to use.
        let mut vertices: Vec<u32> = around.chain(changes.moved()).copied().collect();
        vertices.extend(rows.len() as u32..topology.vertex_count() as u32);
        vertices.sort_unstable();
        vertices.dedup();
        rows.resize(topology.vertex_count(), Row::new());
        for vertex in vertices {
            rows[vertex as usize] = limit(topology, vertex);
        }
        self.rows = Arc::new(OnceLock::from(rows));
    }

    /// Whether all vertices are on the surface.
    #[cfg(feature = "vulkan")]
    pub fn is_empty(&self) -> bool {
        self.topology.is_none()
    }

    /// The terms of a vertex; none where it is on the surface itself, and where there is no such vertex.
    pub fn row(&self, vertex: u32) -> &[(u32, f32)] {
        let Some(topology) = &self.topology else {
            return &[];
        };
        let rows = self.rows.get().unwrap_or_else(|| {
            let vertices = (0..topology.vertex_count() as u32).into_par_iter();
            let limit = |vertex| limit(topology, vertex);
            let found: Vec<Row> = vertices.with_min_len(64).map(limit).collect();
            // Not within it: a thread that waits there for others may be given work that asks for the same.
            self.rows.get_or_init(|| found)
        });
        rows.get(vertex as usize).map_or(&[], |row| &row[..])
    }
}

/// A sum of weighted vertices, of which `face` tells those of a face, in the order of its terms. Twin of `limit_of` in `glsl/limits.comp`, to the bit.
pub(super) fn sum<'a>(
    row: &[(u32, f32)],
    vertices: &[Vec3],
    face: impl Fn(u32) -> &'a [u32],
) -> Vec3 {
    let mut limit = Vec3::ZERO;
    for &(source, weight) in row {
        let value = match source & abi::LIMIT_FACE {
            0 => vertices[source as usize],
            _ => {
                let corners = face(source & !abi::LIMIT_FACE).iter();
                corners.fold(Vec3::ZERO, |sum, &vertex| sum + vertices[vertex as usize])
            }
        };
        limit += weight * value;
    }
    limit
}

/// The terms of a vertex' limit.
fn limit(topology: &Topology, vertex: u32) -> Row {
    let mask = catmull_clark(topology, vertex).unwrap_or_else(|| by_rules(topology, vertex));
    match &mask[..] {
        [] => Row::new(),
        [(only, _)] if *only == vertex => Row::new(),
        _ => ascending(&mask)
            .iter()
            .map(|&(source, weight)| (source, weight as f32))
            .collect(),
    }
}

/// By the scheme's rules, after as many refinements as these ask for; from the face with the fewest corners. Nothing where that would take the square of
/// very many corners around the vertex.
fn by_rules(topology: &Topology, vertex: u32) -> Mask {
    let around = topology.vertex_faces(vertex).iter();
    let corners: usize = around.clone().map(|at| topology.face(at.face).len()).sum();
    let least = around.min_by_key(|at| (topology.face(at.face).len(), at.face));
    let scheme = topology.options().scheme;
    let limit = least.and_then(|at| match corners > MOST_AROUND {
        true => vertex_limit(topology, scheme, at.face, at.corner),
        false => deep_limit(topology, scheme, at.face, at.corner),
    });
    limit.map_or(Mask::new(), |limit| limit.position)
}

/// Of Catmull-Clark, where nothing is semi-sharp and no crease ends; None elsewhere.
///
/// The limit of a smooth vertex v of n faces with the centres f and edges to p is (n (n - 1) v + 2 sum p + 4 sum f) / (n (n + 5)), whatever polygons they are: that
/// is the mask (n^2, 4, 1) / (n (n + 5)) of the mesh refined once, all of whose faces are quads, over the points that it is made of.
fn catmull_clark(topology: &Topology, vertex: u32) -> Option<Mask> {
    let (faces, edges) = (topology.vertex_faces(vertex), topology.vertex_edges(vertex));
    let sharpness = topology.vertex_sharpness(vertex);
    let sharp: SmallVec<[u32; 8]> = topology.sharp_edges(vertex).collect();
    let is_semi = |edge: &u32| is_semi_sharp(topology.edge(*edge).sharpness);
    let smooths_triangles = topology.options().triangles == TriangleSubdivision::Smooth
        && faces.iter().any(|at| topology.face(at.face).len() == 3);
    let is_other = topology.options().scheme != Scheme::CatmullClark;
    if is_other || is_semi_sharp(sharpness) || sharp.iter().any(is_semi) {
        return None;
    }
    let end = |&edge: &u32| topology.edge(edge).other(vertex);
    match rule(sharpness, sharp.len()) {
        Rule::Corner => Some(Mask::from_slice(&[(vertex, 1.0)])),
        Rule::Crease => {
            let ends = sharp.iter().map(|edge| (end(edge), 1.0 / 6.0));
            Some([(vertex, 4.0 / 6.0)].into_iter().chain(ends).collect())
        }
        Rule::Smooth if faces.len() == edges.len() && !smooths_triangles => {
            let n = faces.len() as f64;
            let whole = n * (n + 5.0);
            let mut mask = Mask::from_slice(&[(vertex, n * (n - 1.0) / whole)]);
            mask.extend(edges.iter().map(|edge| (end(edge), 2.0 / whole)));
            for at in faces {
                let corners = topology.face(at.face);
                let weight = 4.0 / whole / corners.len() as f64;
                match corners.len() > MOST_CORNERS {
                    true => mask.push((abi::LIMIT_FACE | at.face, weight)),
                    false => mask.extend(corners.iter().map(|&corner| (corner, weight))),
                }
            }
            Some(mask)
        }
        Rule::Smooth | Rule::Dart => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{ControlMesh, builtin};
    use crate::subdivision::{Blend, LimitSurface};
    use glam::DVec3;

    /// The terms against those that refining finds, and against the truth: a corner of a ptex face.
    #[test]
    fn rows_are_the_limits_that_the_truth_has() {
        let mut compared = 0;
        for name in ["hull", "ngons", "creased-torus", "pole-66", "cube"] {
            let mesh = builtin(name).expect(name);
            let (truth, offsets) = (LimitSurface::new(&mesh), mesh.ptex_offsets());
            let model = Model::new(mesh);
            let (topology, vertices) = (model.topology(), model.positions());
            let limits = Limits::new(&model, false);
            for vertex in 0..topology.vertex_count() as u32 {
                let Some(at) = topology.vertex_faces(vertex).first() else {
                    continue;
                };
                let row = limits.row(vertex);
                let found = match row {
                    [] => vertices[vertex as usize],
                    row => sum(row, &vertices, |face| topology.face(face)),
                };
                let n = topology.face(at.face).len() as u32;
                let ptex = offsets[at.face as usize] + if n == 4 { 0 } else { at.corner };
                let (u, v) = match (n, at.corner) {
                    (4, 1) => (1.0, 0.0),
                    (4, 2) => (1.0, 1.0),
                    (4, 3) => (0.0, 1.0),
                    _ => (0.0, 0.0),
                };
                let Some(limit) = truth.evaluate(ptex as usize, u, v) else {
                    continue;
                };
                let right = model.placement().local(limit.position).as_vec3();
                assert!(
                    found.distance(right) < 2e-6,
                    "{name} {vertex}: {found} {right}"
                );
                let places: Vec<DVec3> = vertices.iter().map(|v| v.as_dvec3()).collect();
                let refined = DVec3::blend(&by_rules(topology, vertex), &places).as_vec3();
                assert!(found.distance(refined) < 2e-6, "{name} {vertex}");
                compared += 1;
            }
        }
        assert!(compared > 300, "{compared}");
    }

    /// What is made of n-gons is no longer for it: all corners together would have the square of their number.
    #[test]
    fn large_faces_are_one_term_of_each_corner() {
        let n = 2000u32;
        let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
        let positions: Vec<[f64; 3]> = (0..n)
            .map(|i| [angle(i).cos(), angle(i).sin(), 0.1 * f64::from(i % 3)])
            .collect();
        let faces: Vec<u32> = (0..n).chain((0..n).rev()).collect();
        let mesh = ControlMesh::builder(&positions, &[n, n], &faces).build();
        let mesh = mesh.expect("a pillow is sound");
        let (truth, model) = (LimitSurface::new(&mesh), Model::new(mesh));
        let (topology, vertices) = (model.topology(), model.positions());
        let limits = Limits::new(&model, false);
        for vertex in [0, 1, 999] {
            let row = limits.row(vertex);
            assert_eq!(row.len(), 5);
            let found = sum(row, &vertices, |face| topology.face(face));
            let limit = truth.evaluate(vertex as usize, 0.0, 0.0);
            let limit = limit.expect("it has a limit").position;
            let right = model.placement().local(limit).as_vec3();
            assert!(found.distance(right) < 1e-5, "{vertex}: {found} {right}");
        }
    }
}
