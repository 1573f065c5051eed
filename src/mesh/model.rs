//! A control mesh made ready for methods and GPU.

use glam::{DVec3, Vec3};

use crate::mesh::ControlMesh;
use crate::mesh::topology::Topology;

/// A control mesh, its topology, and its positions as the GPU gets them.
///
/// Positions are f32 relative to the middle of the bounding box, so that a small mesh far from the origin loses nothing.
#[derive(Clone, Debug)]
pub struct Model {
    mesh: ControlMesh,
    topology: Topology,
    centre: DVec3,
}

impl Model {
    /// Takes a mesh in.
    pub fn new(mesh: ControlMesh) -> Model {
        let (low, high) = mesh.bounds();
        Model {
            topology: Topology::new(&mesh),
            centre: 0.5 * (low + high),
            mesh,
        }
    }

    /// The control mesh.
    pub fn mesh(&self) -> &ControlMesh {
        &self.mesh
    }

    /// Its topology.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Whether anything is drawn of it: any face that is no hole.
    pub fn has_surface(&self) -> bool {
        self.topology.has_surface()
    }

    /// What must be added to positions that come from the GPU.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The control vertices relative to the centre. No zero is negative: whatever faces make of one has the same bits.
    pub fn positions(&self) -> Vec<Vec3> {
        self.mesh
            .positions()
            .iter()
            .map(|&position| (position - self.centre).as_vec3() + Vec3::ZERO)
            .collect()
    }
}
