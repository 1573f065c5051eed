//! Faces of a refined mesh as pieces of ptex faces.

use crate::abi;
use crate::mesh::Model;
use crate::mesh::topology::Topology;
use crate::method::Pass;
use crate::method::patches::{self, Part};
use crate::method::ptex::Piece;

/// A face of a level: its part of the control mesh, and which piece of that it is.
#[derive(Clone, Copy)]
pub struct Cell {
    pub part: Part,
    pub piece: Piece,
    /// Its number among the faces of the level.
    pub face: u32,
}

impl Cell {
    /// A part as a whole; of an n-gon it has no number yet.
    pub fn of(part: Part) -> Cell {
        Cell {
            part,
            piece: Piece::default(),
            face: part.face,
        }
    }

    /// Its quarter at a corner, without its number.
    pub fn child(&self, corner: u32) -> Cell {
        let piece = self.piece.child(corner);
        Cell { piece, ..*self }
    }

    /// Its patch, but for control points and what is a method's own.
    pub fn record(&self, model: &Model, topology: &Topology) -> abi::Patch {
        let valence = |&vertex: &u32| topology.vertex_edges(vertex).len().min(255) as u8;
        let mut valences = [0; 4];
        for (valence_of, vertex) in valences.iter_mut().zip(topology.face(self.face)) {
            *valence_of = valence(vertex);
        }
        let mut flags = 0;
        if model.topology().face(self.part.face).len() != 4 {
            flags |= abi::PATCH_HALF;
        }
        if self.piece.depth > 0 {
            flags |= abi::CHILD_PIECE << abi::PATCH_CHILD_SHIFT;
        }
        abi::Patch {
            ptex: self.part.ptex,
            flags,
            controls: 0,
            plan: self.piece.plan(),
            valences: u32::from_le_bytes(valences),
        }
    }

    /// Adds its patch.
    pub fn add(&self, pass: &mut Pass, model: &Model, controls: &[u32], record: abi::Patch) {
        pass.patches.push(abi::Patch {
            controls: pass.controls.len() as u32,
            ..record
        });
        pass.controls.extend_from_slice(controls);
        pass.texture.push(self.texture(model));
    }

    /// Texture coordinates at its corners: linear between those of its part.
    fn texture(&self, model: &Model) -> [[f32; 2]; 4] {
        let corners = patches::texture(model, self.part, 0).map(glam::Vec2::from);
        self.piece.corners().map(|[u, v]| {
            let [a, b, c, d] = corners;
            a.lerp(b, u).lerp(d.lerp(c, u), v).to_array()
        })
    }
}
