//! The edges and faces of the control mesh, to which the edges of patches belong: levels that go by them agree on both sides of each.

use glam::{DVec3, Vec3};
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::mesh::Model;
use crate::mesh::topology::Topology;
use crate::method::patches::{self, Part};
use crate::method::ptex::{Child, child};

/// The edges and faces of a control mesh. Both count as sides, edges first: a patch's edge is a part of one of its mesh's edges, or lies within
/// one of its faces.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// The control vertices of each edge.
    edges: Vec<[u32; 2]>,
    /// The vertices of each face in turn, and of all faces one after the other.
    face_vertices: Vec<u32>,
    face_ends: Vec<usize>,
    vertices: usize,
}

impl Outline {
    /// The outline of a control mesh.
    pub(super) fn new(topology: &Topology) -> Outline {
        let ends = |edge| topology.edge(edge).vertices;
        let mut outline = Outline {
            edges: (0..topology.edge_count() as u32).map(ends).collect(),
            vertices: topology.vertex_count(),
            ..Outline::default()
        };
        for face in 0..topology.face_count() as u32 {
            outline.face_vertices.extend_from_slice(topology.face(face));
            outline.face_ends.push(outline.face_vertices.len());
        }
        outline
    }

    /// The depth of each side, by one a control vertex: of an edge the greater of its ends', of a face the greatest of its edges'.
    ///
    /// # Errors
    /// [`Misuse::Count`] for other than one depth a control vertex.
    pub fn depths(&self, tags: &[f32]) -> Result<Vec<f32>> {
        self.check_count("depth tags", tags.len())?;
        let greatest = |vertices: &[u32]| {
            let tags = vertices.iter().map(|&vertex| tags[vertex as usize]);
            tags.fold(0.0, f32::max)
        };
        let edges = self.edges.iter().map(|ends| greatest(ends));
        Ok(edges.chain(self.faces().map(greatest)).collect())
    }

    /// Refuses lists that have not one entry a control vertex.
    pub(super) fn check_count(&self, what: &'static str, given: usize) -> Result<()> {
        let expected = self.vertices;
        if given == expected {
            return Ok(());
        }
        Err(Error::Misuse(Misuse::Count {
            what,
            given,
            expected,
        }))
    }

    /// The control vertices of each edge.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The control vertices of a side: of an edge its ends, of a face all in turn. None where there is no such side.
    pub fn side(&self, side: u32) -> Option<&[u32]> {
        let side = side as usize;
        if let Some(ends) = self.edges.get(side) {
            return Some(ends);
        }
        let face = side - self.edges.len();
        let end = *self.face_ends.get(face)?;
        let start = face.checked_sub(1).map_or(0, |before| self.face_ends[before]);
        Some(&self.face_vertices[start..end])
    }

    /// The vertices of each face.
    fn faces(&self) -> impl Iterator<Item = &[u32]> {
        let mut start = 0;
        self.face_ends.iter().map(move |&end| {
            let face = &self.face_vertices[start..end];
            start = end;
            face
        })
    }

    /// Unit normals of the vertices: of the faces around each, by their areas.
    pub(super) fn normals(&self, vertices: &[Vec3]) -> Vec<Vec3> {
        // In f64 products of floats stay within its range.
        let mut normals = vec![DVec3::ZERO; vertices.len()];
        for face in self.faces() {
            let at = |i: usize| vertices[face[i % face.len()] as usize].as_dvec3();
            // Twice the area as a vector, whatever the polygon (Newell).
            let area = (0..face.len()).fold(DVec3::ZERO, |sum, i| {
                sum + (at(i) - at(0)).cross(at(i + 1) - at(0))
            });
            for &vertex in face {
                normals[vertex as usize] += area;
            }
        }
        let unit = |normal: DVec3| normal.normalize_or_zero().as_vec3();
        normals.into_iter().map(unit).collect()
    }
}

/// The sides to which a patch's edges belong, from corner i to corner i + 1; a triangle's last one twice.
fn sides(topology: &Topology, part: Part, patch: &abi::Patch) -> [u32; 4] {
    let edges = topology.face_edges(part.face);
    let within = topology.edge_count() as u32 + part.face;
    let n = part.domain.corners();
    let turn = (patch.flags >> abi::PATCH_TURN_SHIFT & 3) as usize;
    let is_part = edges.len() != n;
    std::array::from_fn(|i| {
        let side = (i.min(n - 1) + turn) % n;
        match child(patch) {
            // The part of an n-gon at a corner has half of the edges there.
            Child::Whole if is_part => {
                let corner = part.corner as usize;
                match side {
                    0 => edges[corner],
                    3 => edges[(corner + edges.len() - 1) % edges.len()],
                    _ => within,
                }
            }
            Child::Whole => edges[side],
            Child::Corner(corner) => {
                let touches = side == corner || side == (corner + n - 1) % n;
                if touches { edges[side] } else { within }
            }
            Child::Middle => within,
        }
    })
}

/// The sides of all patches of a pass.
pub(super) fn sides_of(model: &Model, patches: &[abi::Patch]) -> Vec<[u32; 4]> {
    let parts: FxHashMap<u32, Part> = patches::parts(model)
        .into_iter()
        .map(|part| (part.ptex, part))
        .collect();
    let side = |patch: &abi::Patch| sides(model.topology(), parts[&patch.ptex], patch);
    patches.iter().map(side).collect()
}
