//! Quads side by side, and where a macro face may not go on from one to the next.
//!
//! A side is a number, as in [`SmoothQuads`]: 4 times the face and the corner at which it begins.

use crate::mesh::Model;
use crate::mesh::sharpness::is_infinite;
use crate::mesh::topology::Topology;
use crate::plan::SmoothQuads;

/// The quads of a model, and how they hang together.
pub struct Region<'a> {
    pub model: &'a Model,
    pub smooth: &'a SmoothQuads<'a>,
    /// Whether four quads are all around a vertex, and the surface has a plane there: separatrices go on.
    goes_on: Vec<bool>,
}

impl<'a> Region<'a> {
    pub fn new(model: &'a Model, smooth: &'a SmoothQuads<'a>) -> Region<'a> {
        let topology = model.topology();
        let mut goes_on = vec![false; topology.vertex_count()];
        for (vertex, goes_on) in (0u32..).zip(&mut goes_on) {
            *goes_on = is_among_four(topology, smooth, vertex);
        }
        Region {
            model,
            smooth,
            goes_on,
        }
    }

    pub fn topology(&self) -> &'a Topology {
        self.model.topology()
    }

    /// Whether a face can be in a macro face.
    pub fn has(&self, face: u32) -> bool {
        self.topology().face(face).len() == 4 && !self.topology().is_hole(face)
    }

    /// Whether a vertex has four quads all around it, and is no infinitely sharp corner.
    pub fn goes_on(&self, vertex: u32) -> bool {
        self.goes_on[vertex as usize]
    }

    pub fn after(side: u32, steps: u32) -> u32 {
        SmoothQuads::after(side, steps)
    }

    pub fn beyond(&self, side: u32) -> Option<u32> {
        self.smooth.beyond(side)
    }

    /// The vertex at which a side of a quad begins.
    pub fn start(&self, side: u32) -> u32 {
        self.smooth.vertex_after(side, 0)
    }

    /// Of a side that ends in a vertex with four quads, the one that goes straight on from there.
    pub fn straight(&self, side: u32) -> Option<u32> {
        let beyond = self.beyond(Self::after(side, 1))?;
        Some(Self::after(beyond, 1))
    }

    /// Whether no macro face goes across a side, whatever separatrices there are: at boundaries, n-gons and holes; at infinite creases, where a vertex has two
    /// normals; and at seams of texture coordinates, where it has two of these.
    pub fn is_barred(&self, side: u32) -> bool {
        let Some(beyond) = self.beyond(side) else {
            return true;
        };
        let topology = self.topology();
        let [face, other] = [side, beyond].map(|side| side / 4);
        let edge = topology.face_edges(face)[(side % 4) as usize];
        is_infinite(topology.edge(edge).sharpness)
            || topology.is_hole(face)
            || topology.is_hole(other)
            || self.has_seam(side, beyond)
    }

    fn has_seam(&self, side: u32, beyond: u32) -> bool {
        let Some(texture) = self.model.mesh().texture() else {
            return false;
        };
        let at = |side: u32| {
            let corners = self.model.mesh().corner_range((side / 4) as usize);
            texture.values[texture.indices[corners][(side % 4) as usize] as usize]
        };
        at(side) != at(Self::after(beyond, 1)) || at(Self::after(side, 1)) != at(beyond)
    }
}

fn is_among_four(topology: &Topology, smooth: &SmoothQuads<'_>, vertex: u32) -> bool {
    let faces = topology.vertex_faces(vertex);
    let are_quads = || faces.iter().all(|at| topology.face(at.face).len() == 4);
    if faces.len() != 4 || !are_quads() || is_infinite(topology.vertex_sharpness(vertex)) {
        return false;
    }
    let first = 4 * faces[0].face + faces[0].corner;
    let mut at = first;
    for step in 0..4 {
        // From a side to the one that ends where it begins, and what is beyond that.
        let Some(next) = smooth.beyond(SmoothQuads::after(at, 3)) else {
            return false;
        };
        if next == first {
            return step == 3;
        }
        at = next;
    }
    false
}
