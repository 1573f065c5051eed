//! What tables do not cover is refused by name, rather than drawn as another surface.
//!
//! The paper knows interior vertices and boundaries ("interior and boundary cases"). A crease would need tables of its own, and normals on both
//! sides of it, which subdivision shading does not have.

use crate::error::{Error, Place, Result};
use crate::mesh::Model;
use crate::mesh::sharpness::{is_infinite, is_sharp};
use crate::method::instead_of;

/// Refuses creases, sharp vertices that are no corners of the boundary, edges of more than two faces, and vertices where several fans meet.
///
/// # Errors
/// [`Error::Input`] with the edge or vertex.
pub fn check(model: &Model) -> Result<()> {
    let topology = model.topology();
    for edge in 0..topology.edge_count() as u32 {
        check_edge(model, edge)?;
    }
    (0..topology.vertex_count() as u32).try_for_each(|vertex| check_vertex(model, vertex))
}

fn check_edge(model: &Model, number: u32) -> Result<()> {
    let topology = model.topology();
    let edge = topology.edge(number);
    let [a, b] = edge.vertices.map(|vertex| vertex as usize);
    let place = Place::Edge(a, b);
    match topology.edge_faces(number).len() {
        0 | 1 => Ok(()),
        2 if !is_sharp(edge.sharpness) => Ok(()),
        2 if model.mesh().creases().iter().any(|crease| {
            let [c, d] = crease.vertices.map(|vertex| vertex as usize);
            (a, b) == (c, d) || (a, b) == (d, c)
        }) =>
        {
            Err(refused(model, place, "is a crease", "remove the crease"))
        }
        2 => Err(refused(
            model,
            place,
            "has two faces that run along it in the same direction",
            "turn one of them over",
        )),
        n => Err(refused(
            model,
            place,
            &format!("has {n} faces"),
            "split the mesh there",
        )),
    }
}

fn check_vertex(model: &Model, vertex: u32) -> Result<()> {
    let topology = model.topology();
    let Some(corner) = topology.vertex_faces(vertex).first() else {
        return Ok(());
    };
    let place = Place::Vertex(vertex as usize);
    let fan = topology.fan(corner.face, corner.corner);
    if fan.faces.len() != topology.vertex_faces(vertex).len() {
        return Err(refused(
            model,
            place,
            "joins faces that share no edge there",
            "split the vertex",
        ));
    }
    let sharpness = topology.vertex_sharpness(vertex);
    if is_sharp(sharpness) && (fan.closed || !is_infinite(sharpness)) {
        return Err(refused(
            model,
            place,
            "is sharp, and no sharp corner of the boundary",
            "remove the sharpness",
        ));
    }
    Ok(())
}

/// The error, with what draws the model instead as the way out.
fn refused(model: &Model, place: Place, problem: &str, remedy: &str) -> Error {
    let other = instead_of("bft", model).name;
    Error::Input {
        place,
        problem: format!("it {problem}, and the method bft has no table for that"),
        remedy: format!("{remedy}, or use --method {other}"),
    }
}
