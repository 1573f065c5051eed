//! Which meshes have too much around single vertices or within single faces.
//!
//! A patch lists its ring, and its plan depends on all of it (Brainerd et al. 2016, section 4.3): where n faces meet in a vertex, each of them names the n
//! others, and so do the n parts of an n-gon. That is the square of what the file has, except at hubs (`hubs.rs`). Up to a bound it is no matter; beyond, a file
//! of a few hundred kilobytes would take minutes and gigabytes.

use crate::error::{Error, Place, Result};
use crate::mesh::Model;
use crate::mesh::sharpness::is_semi_sharp;
use crate::mesh::topology::{Hubs, Topology};
use crate::method::patches::Part;
use crate::method::quadtree::hubs::hubs;
use crate::plan::PlanOptions;

/// Rings of so many corners of faces are what models are made of, however many there are.
const ORDINARY: u64 = 1 << 10;

/// The corners that all larger rings may have. A pole of 1,600 triangles, or two thousand quads, or an n-gon of 5,000 corners.
const MOST: u64 = 3 << 23;

/// Where a vertex has edges of more different sharpness than these, faces around it hardly share plans, and a plan has hundreds of sums over the ring.
const ALIKE: usize = 4;
const SUMS: u64 = 128;

/// Of a hub a ring has no more faces or corners than about so many.
const NEAR: usize = 35;
/// Of a hub beside it about so many corners.
const BESIDE: u64 = 5;

/// Refuses a mesh whose rings have more corners than will be planned for.
///
/// # Errors
/// [`Error::Input`] with the vertex or face that has the most around it.
pub fn check(model: &Model) -> Result<()> {
    check_around(
        model.topology(),
        &hubs(model.topology(), PlanOptions::default()),
    )
}

/// The same where nothing is a hub.
///
/// # Errors
/// As [`check`].
pub fn check_without_hubs(model: &Model) -> Result<()> {
    check_around(model.topology(), &Hubs::default())
}

fn check_around(topology: &Topology, hubs: &Hubs) -> Result<()> {
    let faces = 0..topology.face_count() as u32;
    let corners = faces.map(|face| topology.face(face).len() as u64).max();
    let vertices = 0..topology.vertex_count() as u32;
    let meeting = vertices.map(|vertex| topology.vertex_faces(vertex).len() as u64);
    // Most meshes have nothing large anywhere.
    let (corners, meeting) = (corners.unwrap_or(0), meeting.max().unwrap_or(0));
    if corners.saturating_mul(corners).saturating_mul(meeting) <= ORDINARY {
        return Ok(());
    }
    let mut met = Met::new(topology, hubs);
    let around = 0..topology.vertex_count() as u32;
    let around: Vec<u64> = around.map(|vertex| met.around(vertex)).collect();
    let mut total = 0;
    for face in (0..topology.face_count() as u32).filter(|&face| !topology.is_hole(face)) {
        let vertices = topology.face(face);
        let near = if met.is_hub[face as usize] {
            NEAR
        } else {
            vertices.len()
        };
        let near = &vertices[..near.min(vertices.len())];
        let at_most: u64 = near.iter().map(|&v| around[v as usize]).sum();
        if at_most <= ORDINARY {
            continue;
        }
        let ring = met.ring(face, near, 2 * MOST);
        if ring > ORDINARY {
            let parts = if vertices.len() == 4 {
                1
            } else {
                vertices.len() as u64
            };
            let differ = near
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

/// Whether anywhere but at hubs so much meets that rings of some thousand parts take more memory than is worth it.
pub fn is_crowded(topology: &Topology) -> bool {
    let mut vertices = 0..topology.vertex_count() as u32;
    let mut faces = 0..topology.face_count() as u32;
    topology.quads().is_none()
        && faces.any(|face| topology.face(face).len() > CROWD && topology.hub_of(face).is_none())
        || vertices.any(|vertex| {
            topology.vertex_faces(vertex).len() > CROWD && !topology.is_crowded(vertex)
        })
}

/// So many faces or corners are a crowd.
const CROWD: usize = 64;

/// How many of some parts are looked at in parallel before what they show is kept once: fewer where much is around them.
pub fn some(topology: &Topology, parts: &[Part]) -> usize {
    let most = parts.len();
    let near = |count: usize, is_hub: bool| if is_hub { count.min(NEAR) } else { count };
    let faces = |vertex: u32| {
        near(
            topology.vertex_faces(vertex).len(),
            topology.is_crowded(vertex),
        )
    };
    let around = |part: &Part| match topology.face(part.face) {
        quad @ [_, _, _, _] => quad.iter().map(|&vertex| faces(vertex)).sum(),
        face => near(face.len(), topology.hub_of(part.face).is_some()),
    };
    let mut total = 0;
    let fit = parts.iter().take_while(|part| {
        let before = total;
        total += around(part);
        before < 16 * most
    });
    fit.count()
}

/// Counts what surrounds faces, each face once.
struct Met<'a> {
    topology: &'a Topology,
    hubs: &'a Hubs,
    /// By face.
    is_hub: Vec<bool>,
    /// The last face around which each was met.
    by: Vec<u32>,
}

impl Met<'_> {
    fn new<'a>(topology: &'a Topology, hubs: &'a Hubs) -> Met<'a> {
        let mut is_hub = vec![false; topology.face_count()];
        for hub in hubs.faces() {
            is_hub[hub.at as usize] = true;
        }
        Met {
            topology,
            hubs,
            is_hub,
            by: vec![u32::MAX; topology.face_count()],
        }
    }

    /// The faces that a ring has of those around a vertex.
    fn faces(&self, vertex: u32) -> impl Iterator<Item = u32> + use<'_> {
        let all = self.topology.vertex_faces(vertex);
        let most = match self.hubs.is_crowded(vertex) {
            true => NEAR,
            false => all.len(),
        };
        all.iter().take(most).map(|at| at.face)
    }

    /// The corners that a ring has of a face beside it.
    fn corners(&self, face: u32) -> u64 {
        match self.is_hub[face as usize] {
            true => BESIDE,
            false => self.topology.face(face).len() as u64,
        }
    }

    fn around(&self, vertex: u32) -> u64 {
        self.faces(vertex).map(|face| self.corners(face)).sum()
    }

    /// The corners of a face and of all that touch it at its vertices, or a number above `enough`.
    fn ring(&mut self, face: u32, vertices: &[u32], enough: u64) -> u64 {
        let mut by = std::mem::take(&mut self.by);
        let mut corners = 0;
        for &vertex in vertices {
            for at in self.faces(vertex) {
                if std::mem::replace(&mut by[at as usize], face) != face {
                    corners += self.corners(at);
                }
            }
            if corners > enough {
                break;
            }
        }
        self.by = by;
        corners
    }
}

/// By the face itself, if it is what is large, or else by the vertex where the most meets.
fn refusal(topology: &Topology, around: &[u64], face: u32) -> Error {
    let vertices = topology.face(face);
    let beside = |&&vertex: &&u32| around[vertex as usize].saturating_sub(vertices.len() as u64);
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
