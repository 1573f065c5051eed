//! Copies of a mesh beside each other, as measurements of growth need them.

use glam::{DVec2, DVec3};

use crate::error::{Error, Result};
use crate::mesh::{ControlMesh, FaceVarying};

/// So many copies of a mesh on a square grid in x and z, each a bounding box and a half from the next. Vertices, faces, tags and texture coordinates of a
/// copy follow those of the one before.
///
/// # Errors
/// [`Error::Option`] for no copies, or for so many that their vertices, corners or tags have no numbers of 32 bits.
pub fn replicated(mesh: &ControlMesh, copies: u32) -> Result<ControlMesh> {
    let corners: usize = mesh.faces().map(<[u32]>::len).sum();
    let texture = mesh.texture().map_or(0, |texture| texture.values.len());
    let most = mesh.vertex_count().max(corners).max(texture) as u64;
    if copies == 0 || most * u64::from(copies) > u64::from(u32::MAX) {
        return Err(Error::Option {
            option: "--replicate",
            problem: format!("{copies} copies of {most} corners are none, or too many to number"),
            remedy: format!("give 1 to {}", u64::from(u32::MAX) / most.max(1)),
        });
    }
    let (low, high) = mesh.bounds();
    let step = 1.5 * (high - low).max(DVec3::splat(f64::MIN_POSITIVE));
    let side = f64::from(copies).sqrt().ceil() as u32;
    let numbers = 0..copies;
    let place = |copy: u32| {
        let at = DVec2::new(f64::from(copy % side), f64::from(copy / side));
        DVec3::new(at.x * step.x, 0.0, at.y * step.z)
    };
    let positions: Vec<[f64; 3]> = numbers
        .clone()
        .flat_map(|copy| {
            let moved = place(copy);
            mesh.positions()
                .iter()
                .map(move |&p| (p + moved).to_array())
        })
        .collect();
    let vertices = mesh.vertex_count() as u32;
    let faces: Vec<u32> = numbers
        .clone()
        .flat_map(|copy| mesh.faces().flatten().map(move |&v| v + copy * vertices))
        .collect();
    let sizes: Vec<u32> = numbers
        .clone()
        .flat_map(|_| mesh.faces().map(|face| face.len() as u32))
        .collect();
    let mut builder = ControlMesh::builder(&positions, &sizes, &faces).options(mesh.options());
    for copy in numbers.clone() {
        let first = copy * vertices;
        for crease in mesh.creases() {
            let [a, b] = crease.vertices.map(|vertex| vertex + first);
            builder = builder.crease(a, b, crease.sharpness);
        }
        for corner in mesh.corners() {
            builder = builder.corner(corner.vertex + first, corner.sharpness);
        }
        for &hole in mesh.holes() {
            builder = builder.hole(hole + copy * mesh.face_count() as u32);
        }
    }
    if let Some(own) = mesh.texture() {
        let values = own.values.len() as u32;
        let indices = |copy: u32| own.indices.iter().map(move |&index| index + copy * values);
        builder = builder.texture(FaceVarying {
            values: own.values.repeat(copies as usize),
            indices: numbers.flat_map(indices).collect(),
        });
    }
    builder.build()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::builtin;

    #[test]
    fn copies_have_tags_of_their_own_and_stand_apart() {
        let one = builtin("hull").expect("it is built in");
        let three = replicated(&one, 3).expect("three are not many");
        let counts = |mesh: &ControlMesh| {
            [
                mesh.vertex_count(),
                mesh.face_count(),
                mesh.creases().len(),
                mesh.corners().len(),
                mesh.holes().len(),
            ]
        };
        assert_eq!(counts(&three), counts(&one).map(|count| 3 * count));
        let (faces, vertices) = (one.face_count(), one.vertex_count());
        for copy in 0..3 {
            let own = one.face(5).iter().map(|&v| v + (copy * vertices) as u32);
            assert!(three.face(5 + copy * faces).iter().copied().eq(own));
        }
        let (low, high) = one.bounds();
        let moved = three.positions()[vertices] - one.positions()[0];
        assert!(moved.x > (high - low).x, "{moved}");
        assert!(replicated(&one, 0).is_err() && replicated(&one, u32::MAX).is_err());
    }
}
