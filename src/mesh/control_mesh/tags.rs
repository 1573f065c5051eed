//! Tags, positions and faces of a mesh that is edited. Whoever sets them has checked them.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use crate::mesh::faces::Slot;
use crate::mesh::{ControlMesh, Corner, Crease, FaceVarying};

impl ControlMesh {
    /// One crease an edge says how sharp it is, or none.
    pub(in crate::mesh) fn set_crease(&mut self, crease: Crease) {
        let [a, b] = crease.vertices;
        self.creases
            .retain(|known| ![[a, b], [b, a]].contains(&known.vertices));
        if crease.sharpness > 0.0 {
            self.creases.push(crease);
        }
    }

    pub(in crate::mesh) fn set_corner(&mut self, corner: Corner) {
        self.corners.retain(|known| known.vertex != corner.vertex);
        if corner.sharpness > 0.0 {
            self.corners.push(corner);
        }
    }

    pub(in crate::mesh) fn set_hole(&mut self, face: u32, hole: bool) {
        self.holes.retain(|&known| known != face);
        if hole {
            self.holes.push(face);
        }
    }

    pub(in crate::mesh) fn set_position(&mut self, vertex: u32, position: DVec3) {
        self.positions[vertex as usize] = position;
    }

    pub(in crate::mesh) fn add_vertices(&mut self, positions: &[DVec3]) {
        self.positions.extend_from_slice(positions);
    }

    /// Other faces in some places. Those that are removed are no holes any more, and those that come take the texture coordinates that `index` knows of their
    /// vertices, or else (0, 0).
    pub(in crate::mesh) fn set_faces(
        &mut self,
        slots: &BTreeMap<u32, Slot>,
        index: impl Fn(u32) -> Option<u32>,
    ) {
        let before = std::mem::take(&mut self.faces);
        self.faces = before.edited(slots).into();
        let is_removed = |face: u32| {
            slots
                .get(&face)
                .is_some_and(|slot| slot.vertices.is_empty())
        };
        self.holes.retain(|&hole| !is_removed(hole));
        let Some(texture) = &mut self.texture else {
            return;
        };
        let FaceVarying { values, indices } = texture;
        let mut edited = Vec::with_capacity(self.faces.vertices().len());
        let mut from = 0;
        for (&face, slot) in slots {
            let own = before.range(face as usize);
            let own = if own.is_empty() {
                before.start(face as usize)
            } else {
                own
            };
            edited.extend_from_slice(&indices[from..own.start]);
            for (corner, vertex) in slot.vertices.iter().enumerate() {
                let kept = before.get(face as usize).get(corner) == Some(vertex);
                let known = match kept {
                    true => Some(indices[own.start + corner]),
                    false => index(*vertex),
                };
                edited.push(known.unwrap_or_else(|| origin(values)));
            }
            from = own.end;
        }
        edited.extend_from_slice(&indices[from..]);
        *indices = edited;
    }

    /// Takes away creases that are on no edge any more.
    pub(in crate::mesh) fn retain_creases(&mut self, is_edge: impl Fn([u32; 2]) -> bool) {
        self.creases.retain(|crease| is_edge(crease.vertices));
    }

    /// The same mesh without the numbers of faces that were removed: those behind them move up, and so do ptex faces.
    pub fn compacted(mut self) -> ControlMesh {
        if self.faces.removed().is_empty() {
            return self;
        }
        let mut numbers = Vec::with_capacity(self.face_count());
        let mut next = 0;
        for face in self.faces.iter() {
            numbers.push(next);
            next += u32::from(!face.is_empty());
        }
        let holes = self.holes.iter().map(|&hole| numbers[hole as usize]);
        self.holes = holes.collect();
        self.faces = self.faces.compacted().into();
        self
    }
}

/// The number of the texture coordinates (0, 0).
fn origin(values: &mut Vec<DVec2>) -> u32 {
    let known = values.iter().position(|&value| value == DVec2::ZERO);
    known.unwrap_or_else(|| {
        values.push(DVec2::ZERO);
        values.len() - 1
    }) as u32
}
