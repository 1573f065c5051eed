//! Tags and positions of a mesh that is edited. Whoever sets them has checked them.

use glam::DVec3;

use crate::mesh::{ControlMesh, Corner, Crease};

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
}
