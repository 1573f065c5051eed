//! The mesh whose faces have one extraordinary vertex at most: the control mesh, or that refined once.

use crate::abi;
use crate::error::{Error, Place, Result};
use crate::mesh::Model;
use crate::mesh::sharpness::is_sharp;
use crate::mesh::topology::Topology;
use crate::method::children::{Child, children};
use crate::method::patches::{self, Part};
use crate::subdivision::{Mask, refine_all};

/// Eigenvectors of a face's matrix are 2 N + 8; the paper's are of valences up to this.
const MOST_FACES: usize = 50;

/// Refuses what has no eigenbasis, by its place: boundaries, creases, sharp vertices, valences of 2 and above the paper's, and extraordinary vertices that
/// one refinement does not tell apart.
///
/// # Errors
/// [`Error::Input`] with an edge, a vertex or a face.
pub fn check(model: &Model) -> Result<()> {
    let topology = model.topology();
    for face in (0..topology.face_count() as u32).filter(|&face| !topology.is_hole(face)) {
        for &vertex in topology.face(face) {
            check_vertex(topology, vertex)?;
        }
        check_face(topology, face)?;
    }
    Ok(())
}

fn check_vertex(topology: &Topology, vertex: u32) -> Result<()> {
    if let Some(edge) = topology.sharp_edges(vertex).next() {
        let [a, b] = topology.edge(edge).vertices;
        let problem = match topology.edge_faces(edge).len() {
            1 => "it is a boundary",
            2 => "it is a crease, or its faces run along it in the same direction",
            _ => "several surfaces meet there",
        };
        return Err(Error::input(
            Place::Edge(a as usize, b as usize),
            format!("{problem}, and eigenbases are of vertices around which all is smooth"),
            "choose a method that does edges (quadtree, qas)",
        ));
    }
    let refuse = |problem: String, remedy: &str| {
        let place = Place::Vertex(vertex as usize);
        Err(Error::input(place, problem, remedy))
    };
    if is_sharp(topology.vertex_sharpness(vertex)) {
        return refuse(
            "it is sharp, and eigenbases are of vertices around which all is smooth".into(),
            "choose a method that does corners (quadtree, qas), or remove the tag",
        );
    }
    match topology.vertex_faces(vertex).len() {
        faces @ ..3 => refuse(
            format!("{faces} faces close around it, and there is no eigenbasis of so few"),
            "remove the vertex, or choose another method",
        ),
        ..=MOST_FACES => Ok(()),
        faces => refuse(
            format!(
                "{faces} faces meet there, and eigenbases are of {MOST_FACES} at most, as in the paper"
            ),
            "divide the fan, or choose another method",
        ),
    }
}

fn check_face(topology: &Topology, face: u32) -> Result<()> {
    let vertices = topology.face(face);
    let refuse = |problem: String, remedy: &str| {
        let place = Place::Face(face as usize);
        Err(Error::input(place, problem, remedy))
    };
    if vertices.len() == 4 {
        return Ok(());
    }
    if vertices.len() > MOST_FACES {
        return refuse(
            format!(
                "its middle has the valence {}, and eigenbases are of {MOST_FACES} at most, as in the paper",
                vertices.len()
            ),
            "divide the face, or choose another method",
        );
    }
    match vertices
        .iter()
        .find(|&&vertex| is_extraordinary(topology, vertex))
    {
        None => Ok(()),
        Some(vertex) => refuse(
            format!(
                "it has {} corners, and at vertex {vertex} meet {} faces: refined once, its part there has two extraordinary vertices",
                vertices.len(),
                topology.vertex_faces(*vertex).len()
            ),
            "refine the mesh once, cut the face into quads, or choose another method",
        ),
    }
}

fn is_extraordinary(topology: &Topology, vertex: u32) -> bool {
    topology.vertex_faces(vertex).len() != 4
}

/// The corner of a quad whose vertex is extraordinary.
fn extraordinary(topology: &Topology, face: u32) -> Option<u32> {
    let vertices = (0..).zip(topology.face(face));
    let mut found = vertices.filter(|&(_, &vertex)| is_extraordinary(topology, vertex));
    found.next().map(|(corner, _)| corner)
}

/// A face of the mesh that is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    pub number: u32,
    /// The corner of its extraordinary vertex.
    pub extraordinary: Option<u32>,
    of: Of,
}

/// Which part of the control mesh a face is.
#[derive(Clone, Copy, Debug)]
enum Of {
    Part(Part),
    Child(Child),
}

impl Face {
    /// The common fields of its patch, whose corner 0 is the face's corner `turn`, and texture coordinates.
    pub fn patch(
        &self,
        model: &Model,
        topology: &Topology,
        turn: u32,
    ) -> (abi::Patch, [[f32; 2]; 4]) {
        match self.of {
            Of::Part(part) => (
                patches::patch(model, part, turn),
                patches::texture(model, part, turn),
            ),
            Of::Child(child) => {
                let patch = child.patch(topology, turn);
                (patch, child.texture(model, &patch))
            }
        }
    }
}

/// A mesh of quads with one extraordinary vertex at most.
pub struct Net {
    pub topology: Topology,
    /// Its vertices, by those of the control mesh.
    pub masks: Vec<Mask>,
    pub faces: Vec<Face>,
}

impl Net {
    /// Of a model that [`check`] lets through.
    pub fn new(model: &Model) -> Net {
        let topology = model.topology();
        let parts = patches::parts(model);
        if parts.iter().all(|part| is_isolated(topology, part.face)) {
            let itself = |vertex| Mask::from_slice(&[(vertex, 1.0)]);
            let face = |part: Part| Face {
                number: part.face,
                extraordinary: extraordinary(topology, part.face),
                of: Of::Part(part),
            };
            return Net {
                masks: (0..topology.vertex_count() as u32).map(itself).collect(),
                faces: parts.into_iter().map(face).collect(),
                topology: topology.clone(),
            };
        }
        let refined = refine_all(topology, model.mesh().options().scheme);
        let face = |child: Child| Face {
            number: child.face,
            extraordinary: extraordinary(&refined.topology, child.face),
            of: Of::Child(child),
        };
        Net {
            faces: children(model).into_iter().map(face).collect(),
            masks: refined.masks,
            topology: refined.topology,
        }
    }
}

/// Whether a face is a quad among quads and has one extraordinary vertex at most.
fn is_isolated(topology: &Topology, face: u32) -> bool {
    let vertices = topology.face(face);
    let is_quad = |face: u32| topology.face(face).len() == 4;
    let among_quads = |&vertex: &u32| {
        let mut faces = topology.vertex_faces(vertex).iter();
        faces.all(|at| is_quad(at.face))
    };
    let extraordinary = vertices.iter().filter(|&&v| is_extraordinary(topology, v));
    is_quad(face) && vertices.iter().all(among_quads) && extraordinary.count() <= 1
}
