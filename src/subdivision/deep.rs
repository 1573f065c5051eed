//! The limit at any vertex as masks over the vertices of the topology itself: where no mask is known yet, by refining until one is.

use crate::mesh::Scheme;
use crate::mesh::topology::Topology;
use crate::subdivision::limit::LimitStencil;
use crate::subdivision::masks::{Blend, Mask};
use crate::subdivision::refine::with_neighbours;
use crate::subdivision::schemes::{rings, vertex_limit};
use crate::subdivision::split::refine_child;

/// After so many refinements a vertex stands for its limit, and its edges for tangents; only schemes whose limit has no mask come here. A
/// semi-sharp feature is gone after ten.
const DEEPEST: u32 = 20;

/// The limit position and tangents at `corner` of `face`, a triangle or quad, over the vertices of `topology`.
pub fn deep_limit(topology: &Topology, scheme: Scheme, face: u32, corner: u32) -> LimitStencil {
    let mut faces = vec![face];
    for _ in 0..rings(scheme) {
        faces = with_neighbours(topology, &faces);
    }
    let (mut topology, vertices) = topology.excerpt(&faces);
    // Of each vertex of the excerpt its weights over those that it began with.
    let unit = |one: usize| {
        (0..vertices.len())
            .map(|i| f64::from(u8::from(i == one)))
            .collect()
    };
    let mut values: Vec<Vec<f64>> = (0..vertices.len()).map(unit).collect();
    for _ in 0..DEEPEST {
        if let Some(stencil) = vertex_limit(&topology, scheme, 0, corner) {
            let mask = |mask: &Mask| outside(&Vec::blend(mask, &values), &vertices);
            return LimitStencil {
                position: mask(&stencil.position),
                du: mask(&stencil.du),
                dv: mask(&stencil.dv),
            };
        }
        let refined = refine_child(&topology, scheme, corner);
        values = refined
            .masks
            .iter()
            .map(|mask| Vec::blend(mask, &values))
            .collect();
        topology = refined.topology;
    }
    let point = |vertex: u32| outside(&values[vertex as usize], &vertices);
    let (here, next, previous) = around(topology.face(0), corner);
    let towards = |vertex: u32| {
        let edge = Mask::from_slice(&[(vertex, 1.0), (here, -1.0)]);
        outside(&Vec::blend(&edge, &values), &vertices)
    };
    LimitStencil {
        position: point(here),
        du: towards(next),
        dv: towards(previous),
    }
}

/// A corner's vertex, the next and the previous one.
fn around(face: &[u32], corner: u32) -> (u32, u32, u32) {
    let (n, i) = (face.len(), corner as usize);
    (face[i], face[(i + 1) % n], face[(i + n - 1) % n])
}

/// The weights that count, with the numbers that the vertices have outside of the excerpt.
fn outside(weights: &[f64], vertices: &[u32]) -> Mask {
    let all = vertices.iter().copied().zip(weights.iter().copied());
    all.filter(|&(_, weight)| weight != 0.0).collect()
}
