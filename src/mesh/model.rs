//! A control mesh made ready for methods and GPU.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec3, Vec3};

use crate::mesh::topology::Topology;
use crate::mesh::{ControlMesh, Placement};

/// A control mesh, its topology, and its positions as the GPU gets them.
///
/// Positions are f32 relative to the mesh's [`Placement`]: whatever its size, and however far it lies from the origin, nothing is lost.
#[derive(Clone, Debug)]
pub struct Model {
    pub(super) mesh: ControlMesh,
    /// Shared with what was prepared of it, until it is edited.
    pub(super) topology: Arc<Topology>,
    pub(super) placement: Placement,
    /// A number that no other state of a model has.
    pub(super) revision: u64,
}

/// A number that no other state of a model has.
pub(super) fn next_revision() -> u64 {
    static REVISION: AtomicU64 = AtomicU64::new(1);
    REVISION.fetch_add(1, Ordering::Relaxed)
}

/// What is smaller in local positions is zero: it is nothing beside the mesh, and products of it would leave the range of normal floats, which
/// devices may flush to zero and CPUs do not (Vulkan spec, "Rounding and Denormalization").
const LEAST: f64 = 1.0 / (1u128 << 100) as f64;

impl Model {
    /// Takes a mesh in.
    pub fn new(mesh: ControlMesh) -> Model {
        Model {
            topology: Arc::new(Topology::new(&mesh)),
            placement: mesh.placement(),
            revision: next_revision(),
            mesh,
        }
    }

    /// A number that no other state of a model has; clones share it.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// The control mesh.
    pub fn mesh(&self) -> &ControlMesh {
        &self.mesh
    }

    /// Its topology.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The same, for who keeps it.
    pub(crate) fn shared_topology(&self) -> &Arc<Topology> {
        &self.topology
    }

    /// Whether anything is drawn of it: any face that is no hole.
    pub fn has_surface(&self) -> bool {
        self.topology.has_surface()
    }

    /// How positions that go to the GPU or come from there relate to those of the mesh.
    pub fn placement(&self) -> Placement {
        self.placement
    }

    /// The diagonal of the bounding box in local units: 2 to 7, or 0 for a mesh without extent.
    pub fn diagonal(&self) -> f64 {
        let (low, high) = self.mesh.bounds();
        self.placement
            .local(low)
            .distance(self.placement.local(high))
    }

    /// The control vertices in local units, those that no face uses at the origin. No zero is negative: whatever faces make of one has the same
    /// bits.
    pub fn positions(&self) -> Vec<Vec3> {
        let all = 0..self.mesh.vertex_count() as u32;
        all.map(|vertex| self.position(vertex)).collect()
    }

    /// One of these; at the origin where there is no such vertex.
    pub fn position(&self, vertex: u32) -> Vec3 {
        let position = self.mesh.positions().get(vertex as usize);
        let is_used = !self.topology.vertex_faces(vertex).is_empty();
        let Some(&position) = position.filter(|_| is_used) else {
            return Vec3::ZERO;
        };
        let local = self.placement.local(position);
        DVec3::select(local.abs().cmplt(DVec3::splat(LEAST)), DVec3::ZERO, local).as_vec3()
    }
}
