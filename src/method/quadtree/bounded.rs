//! Which meshes have too much around single vertices or within single faces.
//!
//! A patch lists its ring, and its plan depends on all of it (Brainerd et al. 2016, section 4.3): where n faces meet in a vertex, each of them names the n
//! others, and so do the n parts of an n-gon. That is the square of what the file has. Up to a bound it is no matter; beyond, a file of a few hundred
//! kilobytes would take minutes and gigabytes.

use crate::error::{Error, Place, Result};
use crate::mesh::Model;
use crate::mesh::sharpness::is_semi_sharp;
use crate::mesh::topology::Topology;
use crate::method::patches::Part;

/// Rings of so many corners of faces are what models are made of, however many there are.
const ORDINARY: u64 = 1 << 10;

/// The corners that all larger rings may have. A pole of 1,600 triangles, or two thousand quads, or an n-gon of 5,000 corners.
const MOST: u64 = 3 << 23;

/// Where a vertex has edges of more different sharpness than these, faces around it hardly share plans, and a plan has hundreds of sums over the ring.
const ALIKE: usize = 4;
const SUMS: u64 = 128;

/// Refuses a mesh whose rings have more corners than will be planned for.
///
/// # Errors
/// [`Error::Input`] with the vertex or face that has the most around it.
pub fn check(model: &Model) -> Result<()> {
    let topology = model.topology();
    let faces = 0..topology.face_count() as u32;
    let corners = faces.map(|face| topology.face(face).len() as u64).max();
    let vertices = 0..topology.vertex_count() as u32;
    let meeting = vertices.map(|vertex| topology.vertex_faces(vertex).len() as u64);
    // Most meshes have nothing large anywhere.
    let (corners, meeting) = (corners.unwrap_or(0), meeting.max().unwrap_or(0));
    if corners.saturating_mul(corners).saturating_mul(meeting) <= ORDINARY {
        return Ok(());
    }
    let around = |vertex: u32| -> u64 {
        let faces = topology.vertex_faces(vertex).iter();
        faces.map(|at| topology.face(at.face).len() as u64).sum()
    };
    let around: Vec<u64> = (0..topology.vertex_count() as u32).map(around).collect();
    let mut total = 0;
    let mut met = Met::new(topology);
    for face in (0..topology.face_count() as u32).filter(|&face| !topology.is_hole(face)) {
        let vertices = topology.face(face);
        let at_most: u64 = vertices.iter().map(|&v| around[v as usize]).sum();
        if at_most <= ORDINARY {
            continue;
        }
        let ring = met.ring(face, 2 * MOST);
        if ring > ORDINARY {
            let parts = if vertices.len() == 4 {
                1
            } else {
                vertices.len() as u64
            };
            let differ = vertices
                .iter()
                .any(|&vertex| around[vertex as usize] > ORDINARY && is_varied(topology, vertex));
            total += parts * ring * if differ { SUMS } else { 1 };
        }
        if total > MOST {
            return Err(refusal(topology, &around, face));
        }
    }
    Ok(())
}

/// Whether the semi-sharp edges at a vertex are of many kinds.
fn is_varied(topology: &Topology, vertex: u32) -> bool {
    let mut kinds: Vec<u32> = Vec::new();
    for edge in topology.sharp_edges(vertex) {
        let sharpness = topology.edge(edge).sharpness;
        if is_semi_sharp(sharpness) && !kinds.contains(&sharpness.to_bits()) {
            kinds.push(sharpness.to_bits());
        }
        if kinds.len() > ALIKE {
            return true;
        }
    }
    false
}

/// Whether anywhere so much meets that rings of some thousand parts take more memory than is worth it.
pub fn is_crowded(topology: &Topology) -> bool {
    let vertices = 0..topology.vertex_count() as u32;
    let mut around = vertices.map(|vertex| topology.vertex_faces(vertex).len());
    let mut faces = 0..topology.face_count() as u32;
    topology.quads().is_none() && faces.any(|face| topology.face(face).len() > CROWD)
        || around.any(|around| around > CROWD)
}

/// So many faces or corners are a crowd.
const CROWD: usize = 64;

/// How many of the parts, `most` at most, are looked at in parallel before what they show is kept once: fewer where much is around them.
pub fn some(topology: &Topology, parts: &[Part], most: usize) -> usize {
    let around = |part: &Part| match topology.face(part.face) {
        quad @ [_, _, _, _] => {
            let faces = quad
                .iter()
                .map(|&vertex| topology.vertex_faces(vertex).len());
            faces.sum()
        }
        face => face.len(),
    };
    let mut total = 0;
    let fit = parts.iter().take(most).take_while(|part| {
        let before = total;
        total += around(part);
        before < 16 * most
    });
    fit.count()
}

/// Counts what surrounds faces, each face once.
struct Met<'a> {
    topology: &'a Topology,
    /// The last face around which each was met.
    by: Vec<u32>,
}

impl Met<'_> {
    fn new(topology: &Topology) -> Met<'_> {
        Met {
            topology,
            by: Vec::new(),
        }
    }

    /// The corners of a face and of all that touch it, or a number above `enough`.
    fn ring(&mut self, face: u32, enough: u64) -> u64 {
        self.by.resize(self.topology.face_count(), u32::MAX);
        let mut corners = 0;
        for &vertex in self.topology.face(face) {
            for at in self.topology.vertex_faces(vertex) {
                if std::mem::replace(&mut self.by[at.face as usize], face) != face {
                    corners += self.topology.face(at.face).len() as u64;
                }
            }
            if corners > enough {
                break;
            }
        }
        corners
    }
}

/// By the face itself, if it is what is large, or else by the vertex where the most meets.
fn refusal(topology: &Topology, around: &[u64], face: u32) -> Error {
    let vertices = topology.face(face);
    let beside = |&&vertex: &&u32| around[vertex as usize] - vertices.len() as u64;
    let most = vertices.iter().max_by_key(beside);
    let &vertex = most.expect("a face has vertices");
    let (faces, corners) = (topology.vertex_faces(vertex).len(), vertices.len());
    if corners >= faces {
        return Error::input(
            Place::Face(face as usize),
            format!(
                "it has {corners} corners, each a patch that depends on all others: that is more than will be planned for"
            ),
            "divide the face, or choose another method",
        );
    }
    Error::input(
        Place::Vertex(vertex as usize),
        format!(
            "{faces} faces meet there, each a patch that depends on all others: that is more than will be planned for"
        ),
        "remove faces that are there twice, divide the fan of faces, or choose another method",
    )
}
