//! What a control mesh must be: checked once, so that nobody after it need ask.

use smallvec::SmallVec;

use crate::error::{Error, Place, Result};
use crate::mesh::control_mesh::{
    ControlMesh, GREATEST_COORDINATE, GREATEST_TEXTURE_COORDINATE, creased_edges,
};
use glam::DVec3;

pub(super) fn offsets(face_sizes: &[u32], vertices: usize) -> Result<Vec<u32>> {
    let total: u64 = face_sizes.iter().map(|&size| u64::from(size)).sum();
    if face_sizes.is_empty() {
        return Err(Error::input(
            Place::Mesh,
            "there is no face",
            "give at least one face of three or more vertices",
        ));
    }
    if total != vertices as u64 || total > u64::from(u32::MAX) {
        return Err(Error::input(
            Place::Mesh,
            format!("the face sizes add up to {total}, but {vertices} face vertices are given"),
            "give one vertex index for every corner of every face",
        ));
    }
    let mut next = 0;
    Ok(std::iter::once(0)
        .chain(face_sizes.iter().map(|&size| {
            next += size;
            next
        }))
        .collect())
}

pub(super) fn check_positions(mesh: &ControlMesh) -> Result<()> {
    // Not a number is not within bounds either.
    let is_fine = |p: &DVec3| p.abs().cmple(DVec3::splat(GREATEST_COORDINATE)).all();
    if mesh.positions.iter().all(is_fine) {
        return Ok(());
    }
    let check = |vertex: usize, used| check_position(vertex, mesh.positions[vertex], used);
    (0..mesh.vertex_count()).try_for_each(|vertex| check(vertex, false))?;
    let mut used = mesh.faces.vertices().iter();
    used.try_for_each(|&vertex| check(vertex as usize, true))
}

/// Refuses positions that nothing can be calculated with; one that no face uses need only be finite.
pub(in crate::mesh) fn check_position(vertex: usize, position: DVec3, is_used: bool) -> Result<()> {
    let refused = |problem: &str, remedy: &str| {
        let problem = format!("its position {position} {problem}");
        Err(Error::input(Place::Vertex(vertex), problem, remedy))
    };
    if !position.is_finite() {
        let remedy = "replace NaN and infinite coordinates by numbers";
        return refused("is not finite", remedy);
    }
    if is_used && position.abs().max_element() > GREATEST_COORDINATE {
        return refused(
            "is beyond what double precision can calculate with",
            "coordinates go up to 1e300: scale the mesh down",
        );
    }
    Ok(())
}

pub(super) fn check_faces(mesh: &ControlMesh) -> Result<()> {
    let count = mesh.vertex_count();
    let mut faces = mesh.faces().enumerate();
    faces.try_for_each(|(number, face)| check_face(number, face, count))
}

/// Refuses a face of too few vertices, and one that names a vertex twice or one that is not among so many.
pub(in crate::mesh) fn check_face(number: usize, face: &[u32], count: usize) -> Result<()> {
    let place = Place::Face(number);
    if face.len() < 3 {
        return Err(Error::input(
            place,
            format!("it has {} vertices", face.len()),
            "faces need three or more vertices",
        ));
    }
    if let Some(vertex) = face.iter().find(|&&vertex| vertex as usize >= count) {
        return Err(Error::input(
            place,
            format!("it names vertex {vertex}, but the mesh has {count} vertices"),
            "vertex indices must be below the number of vertices",
        ));
    }
    if let Some(vertex) = named_twice(face) {
        return Err(Error::input(
            place,
            format!("it names vertex {vertex} twice"),
            "remove the repeated vertex, or split the face",
        ));
    }
    Ok(())
}

/// The least vertex that a face names more than once.
fn named_twice(face: &[u32]) -> Option<u32> {
    if let &[a, b, c, d] = face
        && a != b
        && a != c
        && a != d
        && b != c
        && b != d
        && c != d
    {
        return None;
    }
    let mut sorted: SmallVec<[u32; 16]> = face.into();
    sorted.sort_unstable();
    let twice = sorted.windows(2).find(|pair| pair[0] == pair[1])?;
    Some(twice[0])
}

pub(super) fn check_tags(mesh: &ControlMesh) -> Result<()> {
    let edges = creased_edges(mesh);
    let mut met = vec![false; edges.count()];
    if !met.is_empty() {
        for face in mesh.faces() {
            for (i, &vertex) in face.iter().enumerate() {
                let next = face[if i + 1 < face.len() { i + 1 } else { 0 }];
                if let Some(edge) = edges.number([vertex, next]) {
                    met[edge] = true;
                }
            }
        }
    }
    for crease in &mesh.creases {
        let [a, b] = crease.vertices;
        let place = Place::Edge(a as usize, b as usize);
        if !edges.number(crease.vertices).is_some_and(|edge| met[edge]) {
            return Err(Error::input(
                place,
                "a crease names it, but no face has this edge",
                "creases need two neighbouring vertices of a face",
            ));
        }
        check_sharpness(place, crease.sharpness)?;
    }
    for corner in &mesh.corners {
        let place = Place::Vertex(corner.vertex as usize);
        if corner.vertex as usize >= mesh.vertex_count() {
            return Err(Error::input(
                place,
                "a corner names it, but there is no such vertex",
                "vertex indices must be below the number of vertices",
            ));
        }
        check_sharpness(place, corner.sharpness)?;
    }
    if let Some(&hole) = mesh
        .holes
        .iter()
        .find(|&&hole| hole as usize >= mesh.face_count())
    {
        return Err(Error::input(
            Place::Face(hole as usize),
            "a hole names it, but there is no such face",
            "face indices must be below the number of faces",
        ));
    }
    check_texture(mesh)
}

pub(in crate::mesh) fn check_sharpness(place: Place, sharpness: f32) -> Result<()> {
    if sharpness >= 0.0 {
        return Ok(());
    }
    Err(Error::input(
        place,
        format!("its sharpness {sharpness} is not a number of 0 or more"),
        "sharpness goes from 0 (smooth) to 10 (infinite)",
    ))
}

fn check_texture(mesh: &ControlMesh) -> Result<()> {
    let Some(texture) = &mesh.texture else {
        return Ok(());
    };
    let (corners, values) = (mesh.faces.vertices().len(), texture.values.len());
    let problem = if texture.indices.len() != corners {
        format!(
            "{} texture indices are given for {corners} face corners",
            texture.indices.len()
        )
    } else if let Some(index) = texture
        .indices
        .iter()
        .find(|&&index| index as usize >= values)
    {
        format!("texture index {index} is out of range, there are {values} texture coordinates")
    } else if let Some(value) = texture.values.iter().find(|value| !value.is_finite()) {
        format!("the texture coordinate {value} is not finite")
    } else if let Some(value) = texture
        .indices
        .iter()
        .map(|&index| texture.values[index as usize])
        .find(|value| value.abs().max_element() > GREATEST_TEXTURE_COORDINATE)
    {
        format!("the texture coordinate {value} is beyond what single precision can interpolate")
    } else {
        return Ok(());
    };
    Err(Error::input(
        Place::Mesh,
        problem,
        "give one texture coordinate of at most 1e30 for every face corner",
    ))
}
