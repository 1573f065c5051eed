//! Polygons cut into triangles, for schemes that take nothing else.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use crate::error::Result;
use crate::mesh::{ControlMesh, FaceVarying};

/// How a polygon is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Triangulation {
    /// All triangles of a face share its first vertex.
    Fan,
    /// A quad along its shorter diagonal. A larger polygon loses one corner after another, each time the one whose neighbours are nearest
    /// to each other.
    #[default]
    ShortestDiagonal,
}

/// The mesh with every face of more than three vertices cut into triangles.
///
/// Vertices keep their numbers. The triangles of a face take its place in the order of faces and turn the way it does. Creases, corners, texture
/// coordinates and options stay; the diagonals are smooth, and all triangles of a hole are holes.
///
/// # Errors
/// Whatever [`ControlMeshBuilder::build`](crate::mesh::ControlMeshBuilder::build) finds; a mesh that was built before has nothing to find.
pub fn triangulated(mesh: &ControlMesh, how: Triangulation) -> Result<ControlMesh> {
    let mut triangles: Vec<u32> = Vec::new();
    let mut texture: Vec<u32> = Vec::new();
    let mut holes: Vec<u32> = Vec::new();
    // Of unit size: squares of lengths leave the range of f64 elsewhere.
    let placement = mesh.placement();
    let local = |vertex: &u32| placement.local(mesh.positions()[*vertex as usize]);
    let mut is_hole = vec![false; mesh.face_count()];
    mesh.holes()
        .iter()
        .for_each(|&face| is_hole[face as usize] = true);
    for (number, face) in mesh.faces().enumerate() {
        let corners = mesh.corner_range(number);
        let hole = is_hole[number];
        let points: Vec<DVec3> = face.iter().map(local).collect();
        for triangle in cut(&points, how) {
            if hole {
                holes.push((triangles.len() / 3) as u32);
            }
            triangles.extend(triangle.map(|corner| face[corner]));
            if let Some(varying) = mesh.texture() {
                texture.extend(triangle.map(|corner| varying.indices[corners.start + corner]));
            }
        }
    }
    let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
    let sizes = vec![3; triangles.len() / 3];
    let mut builder = ControlMesh::builder(&positions, &sizes, &triangles).options(mesh.options());
    for crease in mesh.creases() {
        builder = builder.crease(crease.vertices[0], crease.vertices[1], crease.sharpness);
    }
    for corner in mesh.corners() {
        builder = builder.corner(corner.vertex, corner.sharpness);
    }
    for hole in holes {
        builder = builder.hole(hole);
    }
    if let Some(varying) = mesh.texture() {
        builder = builder.texture(FaceVarying {
            values: varying.values.clone(),
            indices: texture,
        });
    }
    builder.build()
}

/// The triangles of a face with these corners, as their numbers.
fn cut(points: &[DVec3], how: Triangulation) -> Vec<[usize; 3]> {
    match how {
        Triangulation::Fan => (2..points.len()).map(|i| [0, i - 1, i]).collect(),
        Triangulation::ShortestDiagonal => cut_ears(points),
    }
}

/// A diagonal that cuts off a corner, by its length and then by the corner: equal diagonals are cut alike on every machine. The least is the first in
/// a heap whose head is the greatest.
#[derive(PartialEq)]
struct Diagonal {
    length: f64,
    ear: usize,
    /// The corners that it joins, as far as is known: an ear whose neighbours are others by now is stale.
    ends: [usize; 2],
}

impl Eq for Diagonal {}

impl PartialOrd for Diagonal {
    fn partial_cmp(&self, other: &Diagonal) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Diagonal {
    fn cmp(&self, other: &Diagonal) -> Ordering {
        let by_length = other.length.total_cmp(&self.length);
        by_length.then(other.ear.cmp(&self.ear))
    }
}

/// Cuts off one corner after another, each time that with the shortest diagonal, until three are left.
fn cut_ears(points: &[DVec3]) -> Vec<[usize; 3]> {
    let n = points.len();
    let mut before: Vec<usize> = (0..n).map(|i| (i + n - 1) % n).collect();
    let mut after: Vec<usize> = (0..n).map(|i| (i + 1) % n).collect();
    let diagonal = |ear: usize, ends: [usize; 2]| Diagonal {
        length: points[ends[0]].distance_squared(points[ends[1]]),
        ear,
        ends,
    };
    let all = (0..n).map(|ear| diagonal(ear, [before[ear], after[ear]]));
    let mut diagonals: BinaryHeap<Diagonal> = all.collect();
    let mut gone = vec![false; n];
    let mut triangles = Vec::with_capacity(n - 2);
    while triangles.len() + 3 < n {
        let Some(Diagonal { ear, ends, .. }) = diagonals.pop() else {
            break;
        };
        if gone[ear] || ends != [before[ear], after[ear]] {
            continue;
        }
        let [a, b] = ends;
        triangles.push([a, ear, b]);
        gone[ear] = true;
        (after[a], before[b]) = (b, a);
        diagonals.extend([a, b].map(|ear| diagonal(ear, [before[ear], after[ear]])));
    }
    let rest: Vec<usize> = (0..n).filter(|&corner| !gone[corner]).collect();
    triangles.extend(rest.as_chunks::<3>().0);
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn pentagon_beside_a_quad() -> ControlMesh {
        let positions = [
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [3.0, 1.0, 0.0],
            [0.5, 1.0, 0.0],
            [2.0, 2.0, 0.0],
            [1.0, 3.0, 0.0],
            [0.0, 2.0, 0.0],
        ];
        let texture = FaceVarying {
            values: (0..9).map(|i| DVec2::new(f64::from(i), 0.0)).collect(),
            indices: (0..9).collect(),
        };
        ControlMesh::builder(&positions, &[4, 5], &[0, 1, 2, 3, 3, 2, 4, 5, 6])
            .crease(2, 3, 2.0)
            .corner(5, 1.0)
            .hole(1)
            .texture(texture)
            .build()
            .expect("a sound mesh")
    }

    #[test]
    fn a_fan_turns_about_the_first_vertex_and_a_quad_has_a_shorter_diagonal() {
        let mesh = pentagon_beside_a_quad();
        let fan = triangulated(&mesh, Triangulation::Fan).expect("it is sound");
        let faces: Vec<&[u32]> = fan.faces().collect();
        assert_eq!(faces[..2], [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(faces[2..], [[3, 2, 4], [3, 4, 5], [3, 5, 6]]);
        let short = triangulated(&mesh, Triangulation::ShortestDiagonal).expect("it is sound");
        let faces: Vec<&[u32]> = short.faces().collect();
        assert_eq!(faces[..2], [[3, 0, 1], [1, 2, 3]]);
    }

    #[test]
    fn tags_and_texture_coordinates_stay() {
        let mesh = pentagon_beside_a_quad();
        for how in [Triangulation::Fan, Triangulation::ShortestDiagonal] {
            let cut = triangulated(&mesh, how).expect("it is sound");
            assert_eq!(cut.holes(), [2, 3, 4]);
            assert_eq!(cut.creases(), mesh.creases());
            assert_eq!(cut.corners(), mesh.corners());
            let texture = cut.texture().expect("it had texture coordinates");
            for face in 0..cut.face_count() {
                for (&vertex, corner) in cut.face(face).iter().zip(cut.corner_range(face)) {
                    let index = texture.indices[corner] as usize;
                    let before = if face < 2 { 0..4 } else { 4..9 };
                    assert!(before.contains(&index));
                    let whole: Vec<u32> = mesh.faces().flatten().copied().collect();
                    assert_eq!(whole[index], vertex);
                }
            }
        }
    }
}
