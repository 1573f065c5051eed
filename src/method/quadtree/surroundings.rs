//! What is around the parts of faces: what their patches are, apart from plans.

use crate::abi;
use crate::mesh::Model;
use crate::mesh::topology::Topology;
use crate::method::patches::{self, Part};
use crate::method::regular::turned_corners;
use crate::plan::{Ring, SmoothQuads, SmoothRing, SmoothStart};

/// A part on its way to a patch.
pub struct Found {
    pub patch: abi::Patch,
    pub texture: [[f32; 2]; 4],
    pub surroundings: Surroundings,
}

/// What a part's limit depends on.
pub enum Surroundings {
    Regular([u32; 16]),
    Smooth(SmoothStart, SmoothRing),
    Irregular(Box<Ring>),
}

/// What there is at a part. The topology is the model's, perhaps with hubs.
pub fn found(model: &Model, topology: &Topology, smooth: &SmoothQuads<'_>, part: Part) -> Found {
    let surroundings = surroundings(topology, smooth, part);
    let quad = topology.face(part.face).len() == 4;
    let turn = match &surroundings {
        Surroundings::Smooth(start, _) => start.corner,
        Surroundings::Irregular(ring) if quad => ring.start,
        _ => 0,
    };
    let mut patch = patches::patch(model, part, turn);
    patch.flags |= match &surroundings {
        Surroundings::Regular(_) => turned_corners(smooth, part.face, 0),
        Surroundings::Smooth(start, ring) => ring_flags(ring.vertices(), start.mirrored),
        Surroundings::Irregular(ring) => ring_flags(&ring.vertices, ring.mirrored),
    };
    Found {
        patch,
        texture: patches::texture(model, part, turn),
        surroundings,
    }
}

fn ring_flags(vertices: &[u32], mirrored: bool) -> u32 {
    let size = (vertices.len() as u32).min(abi::CONTROL_INVOCATIONS);
    let mirrored = if mirrored { abi::PATCH_MIRRORED } else { 0 };
    size << abi::PATCH_RING_SHIFT | mirrored
}

fn surroundings(topology: &Topology, smooth: &SmoothQuads<'_>, part: Part) -> Surroundings {
    let face = part.face;
    if let Some(vertices) = smooth.regular(face) {
        return Surroundings::Regular(vertices);
    }
    let found = smooth.start(face);
    if let Some((start, ring)) = found.and_then(|start| Some((start, smooth.ring(face, start)?))) {
        return Surroundings::Smooth(start, ring);
    }
    let ring = match topology.face(face).len() {
        4 => Ring::of_quad(topology, face),
        _ => Ring::of_part(topology, face, part.corner),
    };
    Surroundings::Irregular(ring.expect("parts are the topology's own").into())
}
