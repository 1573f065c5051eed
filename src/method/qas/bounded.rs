//! Which meshes have too much around single vertices.
//!
//! The limit at the middle of an edge depends on all that surrounds the edge's ends: where n triangles meet, each of n middles is a sum of n terms.

use crate::error::{Error, Place, Result};
use crate::mesh::Model;

/// Sums of so many terms are what models are made of.
const ORDINARY: usize = 1 << 8;

/// The terms that all longer sums may have: a pole of 4,000 triangles.
const MOST: usize = 1 << 24;

/// Refuses a mesh with more triangles at single vertices than will be summed.
///
/// # Errors
/// [`Error::Input`] with the vertex that has the most.
pub fn check(model: &Model) -> Result<()> {
    let topology = model.topology();
    let vertices = 0..topology.vertex_count() as u32;
    let faces = |vertex: u32| topology.vertex_faces(vertex).len();
    let long = vertices
        .clone()
        .map(faces)
        .filter(|&faces| faces > ORDINARY);
    let terms = long.fold(0, |sum: usize, faces| {
        sum.saturating_add(faces.saturating_mul(faces))
    });
    let most = vertices.max_by_key(|&vertex| faces(vertex));
    match most.filter(|_| terms > MOST) {
        None => Ok(()),
        Some(vertex) => Err(Error::input(
            Place::Vertex(vertex as usize),
            format!(
                "{} triangles meet there, the limit on each of which depends on all others: that is more than will be summed",
                faces(vertex)
            ),
            "remove triangles that are there twice, divide the fan, or choose another method",
        )),
    }
}
