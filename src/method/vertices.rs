//! What methods have in common whose control points are computed points: patches, and vertices with the normals of the faces around them.

#[cfg(test)]
pub mod reference;

use glam::Vec3;

use crate::abi;
use crate::error::{Error, Place, Result};
use crate::mesh::Model;
use crate::mesh::places::Places;
use crate::mesh::topology::{Fan, Topology};
use crate::method::patches::{self, Part};
use crate::method::points::{Points, Row};
use crate::method::surface::Controls;
use crate::method::{Pass, Prepared};
use crate::subdivision::Mask;

/// Adds the patch of a face, whose control points are the `points`.
pub fn add(pass: &mut Pass, model: &Model, part: Part, points: &[u32], flags: u32) {
    let mut patch = patches::patch(model, part, 0);
    patch.controls = pass.controls.len() as u32;
    patch.flags |= flags;
    pass.controls.extend_from_slice(points);
    pass.texture.push(patches::texture(model, part, 0));
    pass.patches.push(patch);
}

/// What a method needs that knows nothing but vertices and their normals: a patch a whole face, from the points of its corners, in the pass of
/// its domain.
pub fn by_vertices<const N: usize>(model: &Model, mut passes: [Pass; N]) -> Prepared {
    let topology = model.topology();
    for part in patches::parts(model) {
        let mut fitting = passes.iter_mut().filter(|pass| pass.domain == part.domain);
        let pass = fitting.next().expect("every domain has its pass");
        add(pass, model, part, topology.face(part.face), 0);
    }
    Prepared {
        points: vertex_normals(topology),
        ..Prepared::of(passes)
    }
}

/// Refuses faces that the scheme takes in parts: their corners are no vertices.
///
/// # Errors
/// [`Error::Input`] with the face.
pub fn whole_faces(model: &Model) -> Result<()> {
    let (topology, scheme) = (model.topology(), model.mesh().options().scheme);
    let drawn = (0..topology.face_count() as u32).filter(|&face| !topology.is_hole(face));
    let corners = |face: u32| topology.face(face).len();
    match drawn
        .into_iter()
        .find(|&face| !scheme.is_whole(corners(face)))
    {
        None => Ok(()),
        Some(face) => {
            let remedy = if corners(face) == 3 {
                "cut it into quads, or use a scheme that takes triangles whole (loop-stam, loop)"
            } else if scheme.is_whole(3) {
                "cut it into triangles or quads"
            } else {
                "cut it into quads"
            };
            Err(Error::Input {
                place: Place::Face(face as usize),
                problem: format!(
                    "under {scheme} its {} corners make it several patches, and methods that know vertices alone take whole faces",
                    corners(face)
                ),
                remedy: remedy.into(),
            })
        }
    }
}

/// A point for each vertex: where it is, with the normal of the faces around it, each by its area.
fn vertex_normals(topology: &Topology) -> Points {
    let mut points = Points::default();
    points.begin(abi::POINTS_BLEND, 0);
    let vertices = 0..topology.vertex_count() as u32;
    for vertex in vertices.clone() {
        points.push(Row::Blend(&Mask::from_slice(&[(vertex, 1.0)])));
    }
    points.begin(abi::POINTS_RING, 0);
    for vertex in vertices {
        push_ring(&mut points, topology, vertex, 0);
    }
    points
}

/// Adds the ring of faces around a vertex, with all of their vertices: cut from the vertex into triangles, a face has its own area as a vector, whatever
/// its shape, while its two edges there would turn over at a reflex corner. Where several fans meet, all follow one another with the vertex itself
/// between them: faces that have it twice have no area. `first` is the point of vertex 0.
pub fn push_ring(points: &mut Points, topology: &Topology, vertex: u32, first: u32) {
    let fans = fans(topology, vertex);
    let middle = first + vertex;
    let rim = |fan: &Fan| -> Vec<u32> {
        let mut rim: Vec<u32> = Vec::new();
        for &face in &fan.faces {
            let vertices = topology.face(face);
            let at = vertices.iter().position(|&v| v == vertex);
            let at = at.expect("the fan's faces touch its vertex");
            // The last is the next face's first.
            let around = (1..vertices.len() - 1).map(|i| vertices[(at + i) % vertices.len()]);
            rim.extend(around.map(|vertex| first + vertex));
        }
        if !fan.closed {
            let last = *fan.edges.last().expect("a fan has edges");
            rim.push(first + topology.edge(last).other(vertex));
        }
        rim
    };
    if let [fan] = &fans[..] {
        return points.push(Row::Ring {
            middle,
            ends: &rim(fan),
            open: !fan.closed,
        });
    }
    let mut ends = Vec::new();
    for fan in &fans {
        let rim = rim(fan);
        ends.extend_from_slice(&rim);
        ends.extend(rim.first().filter(|_| fan.closed));
        ends.push(middle);
    }
    let open = !ends.is_empty();
    points.push(Row::Ring {
        middle,
        ends: &ends,
        open,
    });
}

/// The fans around a vertex, by the lowest face of each: so every order of asking gives the same.
fn fans(topology: &Topology, vertex: u32) -> Vec<Fan> {
    let mut corners = topology.vertex_faces(vertex).to_vec();
    corners.sort_unstable_by_key(|corner| corner.face);
    let mut fans: Vec<Fan> = Vec::new();
    let mut met = Places::default();
    for corner in corners {
        if met.add(corner.face) {
            let fan = topology.fan(corner.face, corner.corner);
            fan.faces.iter().for_each(|&face| {
                met.add(face);
            });
            fans.push(fan);
        }
    }
    fans
}

/// Positions and normals of a patch's control points.
pub fn control_points<const N: usize>(
    pass: &Pass,
    given: &Controls,
    patch: usize,
) -> ([Vec3; N], [Vec3; N]) {
    let controls = &pass.controls[pass.patches[patch].controls as usize..];
    let point = |i: usize| given.points[controls[i] as usize];
    (
        std::array::from_fn(|i| point(i).position.into()),
        std::array::from_fn(|i| point(i).normal.into()),
    )
}
