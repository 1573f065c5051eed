//! Patches of the mesh refined once: which part of the control mesh each face there belongs to, and what its patch has in common with all others.

use crate::abi;
use crate::mesh::Model;
use crate::mesh::topology::Topology;
use crate::method::pass::linear;
use crate::method::patches::{self, Part};
use crate::method::to_ptex;
use crate::tessellation::Domain;

/// A face of the refined mesh: the part of the control mesh that it belongs to, and which child of it it is.
#[derive(Clone, Copy, Debug)]
pub struct Child {
    pub part: Part,
    pub face: u32,
    child: u32,
}

/// The faces that are drawn, in the order of ptex faces. The children of a whole face are its quarters, that at the corner of an n-gon is a part itself.
pub fn children(model: &Model) -> Vec<Child> {
    let topology = model.topology();
    let scheme = model.mesh().options().scheme;
    let mut first = 0;
    let firsts: Vec<u32> = (0..topology.face_count() as u32)
        .map(|face| {
            let arity = topology.face(face).len();
            let count = match scheme.is_whole(arity) {
                true => 4 * arity.min(1),
                false => arity,
            };
            let own = first;
            first += count as u32;
            own
        })
        .collect();
    let parts = patches::parts(model).into_iter().flat_map(|part| {
        let whole = scheme.is_whole(topology.face(part.face).len());
        let first_child = match part.domain {
            Domain::Quads => abi::CHILD_OF_QUAD,
            Domain::Triangles => abi::CHILD_OF_TRIANGLE,
        };
        let first = firsts[part.face as usize];
        (0..if whole { 4 } else { 1 }).map(move |number| Child {
            part,
            face: first + if whole { number } else { part.corner },
            child: if whole { first_child + number } else { 0 },
        })
    });
    parts.collect()
}

impl Child {
    /// The common fields of its patch, whose corner 0 is the corner `turn` of its face in the refined mesh.
    pub fn patch(&self, refined: &Topology, turn: u32) -> abi::Patch {
        let vertices = refined.face(self.face);
        let valence = |i: usize| {
            let corner = (i + turn as usize) % vertices.len();
            let edges = refined.vertex_edges(vertices[corner]).len();
            edges.min(255) as u8 * u8::from(i < vertices.len())
        };
        abi::Patch {
            ptex: self.part.ptex,
            flags: abi::PATCH_HALF
                | abi::PATCH_REFINED
                | turn << abi::PATCH_TURN_SHIFT
                | self.child << abi::PATCH_CHILD_SHIFT,
            valences: u32::from_le_bytes([0, 1, 2, 3].map(valence)),
            ..abi::Patch::default()
        }
    }

    /// The texture coordinates at the corners of its patch, linear in the part that it belongs to; a triangle's last one twice.
    pub fn texture(&self, model: &Model, patch: &abi::Patch) -> [[f32; 2]; 4] {
        let whole = patches::texture(model, self.part, 0);
        let corners = match self.part.domain {
            Domain::Quads => [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            Domain::Triangles => [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0]],
        };
        corners.map(|corner| linear(self.part.domain, whole, to_ptex(patch, corner)))
    }
}
