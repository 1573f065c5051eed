//! What something was prepared of.

use std::hash::{Hash, Hasher};
use std::sync::atomic::{AtomicU64, Ordering};

use rustc_hash::FxHasher;

use crate::mesh::Model;

/// What something was prepared of. By default nothing that a model can be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Origin {
    /// The mesh without its positions, as a hash.
    mesh: u64,
    /// Control vertices.
    pub vertices: usize,
    /// A number of its own.
    pub number: u64,
    /// How often it was edited.
    pub version: u64,
}

impl Origin {
    pub fn new(model: &Model) -> Origin {
        // 0 is what was never prepared.
        static NUMBER: AtomicU64 = AtomicU64::new(1);
        Origin {
            mesh: fingerprint(model),
            vertices: model.mesh().vertex_count(),
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            version: 0,
        }
    }

    pub fn is_of(&self, model: &Model) -> bool {
        self.vertices == model.mesh().vertex_count() && self.mesh == fingerprint(model)
    }
}

/// All that plans depend on, so not positions; texture coordinates are in what was prepared. It guards against mistakes, so 64 bits without
/// a comparison will do.
fn fingerprint(model: &Model) -> u64 {
    let mesh = model.mesh();
    let mut hasher = FxHasher::default();
    mesh.options().hash(&mut hasher);
    mesh.faces().for_each(|face| face.hash(&mut hasher));
    mesh.shared_faces().removed().hash(&mut hasher);
    for crease in mesh.creases() {
        (crease.vertices, crease.sharpness.to_bits()).hash(&mut hasher);
    }
    for corner in mesh.corners() {
        (corner.vertex, corner.sharpness.to_bits()).hash(&mut hasher);
    }
    mesh.holes().hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::ControlMesh;

    /// Two quads beside each other, or one above the other's diagonal: the same counts.
    fn model(faces: &[u32], crease: f32, moved: f64) -> Model {
        let at = |i: u32| [f64::from(i % 3) + moved, f64::from(i / 3), moved];
        let positions: Vec<[f64; 3]> = (0..6).map(at).collect();
        let mesh = ControlMesh::builder(&positions, &[4, 4], faces).crease(1, 4, crease);
        Model::new(mesh.build().expect("two quads are sound"))
    }

    #[test]
    fn a_mesh_is_known_by_its_faces_and_tags_and_not_by_its_positions() {
        let faces = [0, 1, 4, 3, 1, 2, 5, 4];
        let origin = Origin::new(&model(&faces, 1.0, 0.0));
        assert!(origin.is_of(&model(&faces, 1.0, 0.0)));
        assert!(origin.is_of(&model(&faces, 1.0, 3.0)), "moved");
        assert!(!origin.is_of(&model(&faces, 1.5, 0.0)), "another crease");
        let turned = [1, 4, 3, 0, 1, 2, 5, 4];
        assert!(!origin.is_of(&model(&turned, 1.0, 0.0)), "other faces");
        assert!(!Origin::default().is_of(&model(&faces, 1.0, 0.0)));
        let again = Origin::new(&model(&faces, 1.0, 0.0));
        assert_ne!(again.number, origin.number);
    }
}
