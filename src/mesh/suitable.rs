//! Which meshes a scheme can refine.

use crate::error::{Error, Place, Result};
use crate::mesh::sharpness::is_semi_sharp;
use crate::mesh::{ControlMesh, Scheme};

impl Scheme {
    /// Whether the scheme can refine a mesh.
    ///
    /// # Errors
    /// [`Error::Input`] names a face that is no triangle when all must be, and a semi-sharp crease or corner of [`Scheme::Butterfly`],
    /// whose rules know sharp and smooth and nothing between.
    pub fn check(self, mesh: &ControlMesh) -> Result<()> {
        // Those that were removed have no corners.
        let mut faces = mesh.faces().enumerate().filter(|of| !of.1.is_empty());
        faces.try_for_each(|(face, vertices)| self.check_face(face, vertices.len()))?;
        if self != Scheme::Butterfly {
            return Ok(());
        }
        let creases = mesh.creases().iter().map(|crease| {
            let [a, b] = crease.vertices.map(|vertex| vertex as usize);
            (Place::Edge(a, b), crease.sharpness)
        });
        let corners = mesh.corners().iter();
        let corners =
            corners.map(|corner| (Place::Vertex(corner.vertex as usize), corner.sharpness));
        creases
            .chain(corners)
            .try_for_each(|(place, sharpness)| self.check_sharpness(place, sharpness))
    }

    /// Whether the scheme takes a face of so many corners.
    ///
    /// # Errors
    /// As [`Scheme::check`].
    pub(super) fn check_face(self, face: usize, corners: usize) -> Result<()> {
        if corners == 3 || !self.is_triangular() {
            return Ok(());
        }
        Err(Error::input(
            Place::Face(face),
            format!("it has {corners} vertices, but the scheme {self} takes triangles only"),
            "triangulate the mesh, or choose the scheme catmull-clark",
        ))
    }

    /// Whether the scheme has rules for a sharpness.
    ///
    /// # Errors
    /// As [`Scheme::check`].
    pub(super) fn check_sharpness(self, place: Place, sharpness: f32) -> Result<()> {
        if self != Scheme::Butterfly || !is_semi_sharp(sharpness) {
            return Ok(());
        }
        Err(Error::input(
            place,
            format!("its sharpness is {sharpness}, but the scheme {self} has no semi-sharp rules"),
            "make it 0 or 10, or choose the scheme loop",
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangular_schemes_refuse_quads_and_butterfly_semi_sharp_creases() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let quad = ControlMesh::builder(&positions, &[4], &[0, 1, 2, 3]);
        assert!(quad.clone().scheme(Scheme::LoopStam).build().is_ok());
        assert!(quad.scheme(Scheme::Loop).build().is_err());
        let pair = ControlMesh::builder(&positions, &[3, 3], &[0, 1, 2, 2, 3, 0]);
        let pair = pair.scheme(Scheme::Butterfly);
        assert!(pair.clone().crease(0, 2, 10.0).build().is_ok());
        assert!(pair.crease(0, 2, 2.0).build().is_err());
    }
}
