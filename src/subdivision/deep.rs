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

/// The limit position and tangents at `corner` of `face`, over the vertices of `topology`. None where there is no such corner.
pub fn deep_limit(
    topology: &Topology,
    scheme: Scheme,
    face: u32,
    corner: u32,
) -> Option<LimitStencil> {
    let is_corner = (corner as usize) < topology.face(face).len();
    is_corner.then(|| {
        // Most often a mask is known where one stands, and nothing around needs to be copied.
        let known = vertex_limit(topology, scheme, face, corner);
        known.unwrap_or_else(|| Descent::new(topology, scheme, face).limit(corner))
    })
}

/// Two tangents next to `corner` of `face`, a triangle or quad: at (2^-halvings, 2^-halvings) from the corner. They span the tangent plane there and have
/// its orientation, no more: as rows of weights they are orthonormal.
pub(crate) fn tangents_nearby(
    topology: &Topology,
    scheme: Scheme,
    face: u32,
    corner: u32,
    halvings: u32,
) -> [Mask; 2] {
    let n = topology.face(face).len() as u32;
    let whole = Descent::new(topology, scheme, face);
    let triangle = n == 3;
    let levels = if triangle { halvings - 1 } else { halvings };
    let mut near = (0..levels).fold(whole, |level, _| level.child(corner));
    if triangle {
        // In the middle of the edge opposite to the corner, which is the middle child's corner of that number.
        near = near.child(3);
    }
    let opposite = if triangle { corner } else { (corner + 2) % n };
    let LimitStencil { du, dv, .. } = near.limit(opposite);
    orthonormal_masks(&du, &dv)
}

/// Less than this sine between two rows of weights is what refining twenty times leaves of rounding.
const PARALLEL: f64 = 1.0 / (1u64 << 20) as f64;

/// Two rows of weights that span the plane of two others and have its orientation, of length 1 and orthogonal (Gram, Schmidt): beside a cusp both
/// derivatives nearly have its direction, and their difference would drown in the rounding of an f32. Rows that are parallel but for rounding span
/// none: the second is zero.
///
/// All pairs for the same plane differ by a rotation: how much the tangents span beside the sum of their squares does not depend on the pair that
/// was known, nor on how often the mesh had been refined for it.
pub(crate) fn orthonormal(du: &[f64], dv: &[f64]) -> [Vec<f64>; 2] {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let unit = |row: &[f64], least: f64| -> Vec<f64> {
        let length = dot(row, row).sqrt();
        let factor = if length > least { 1.0 / length } else { 0.0 };
        row.iter().map(|weight| factor * weight).collect()
    };
    let [du, dv] = [du, dv].map(|row| unit(row, 0.0));
    let share = dot(&du, &dv);
    let rest: Vec<f64> = dv.iter().zip(&du).map(|(b, a)| b - share * a).collect();
    let dv = unit(&rest, PARALLEL);
    [du, dv]
}

/// The same for masks.
pub(crate) fn orthonormal_masks(du: &Mask, dv: &Mask) -> [Mask; 2] {
    let mut vertices: Vec<u32> = du.iter().chain(dv).map(|&(vertex, _)| vertex).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let row = |mask: &Mask| {
        let mut row = vec![0.0; vertices.len()];
        for &(vertex, weight) in mask {
            let place = vertices.binary_search(&vertex);
            row[place.expect("all are there")] += weight;
        }
        row
    };
    let of_row = |row: Vec<f64>| -> Mask {
        let all = vertices.iter().copied().zip(row);
        all.filter(|&(_, weight)| weight != 0.0).collect()
    };
    orthonormal(&row(du), &row(dv)).map(of_row)
}

/// A face in its surroundings at some level.
struct Descent {
    scheme: Scheme,
    topology: Topology,
    /// Of each vertex its weights over those of the beginning, as they are numbered outside. Few of all that surround a face: rows with a weight for each
    /// would take the square of their number.
    values: Vec<Mask>,
}

impl Descent {
    fn new(topology: &Topology, scheme: Scheme, face: u32) -> Descent {
        let mut faces = vec![face];
        for _ in 0..rings(scheme) {
            faces = with_neighbours(topology, &faces);
        }
        let (topology, vertices) = topology.excerpt(&faces);
        let itself = |vertex| Mask::from_slice(&[(vertex, 1.0)]);
        Descent {
            scheme,
            topology,
            values: vertices.into_iter().map(itself).collect(),
        }
    }

    fn child(self, child: u32) -> Descent {
        let refined = refine_child(&self.topology, self.scheme, child);
        let masks = refined.masks.iter();
        Descent {
            values: masks.map(|mask| Mask::blend(mask, &self.values)).collect(),
            topology: refined.topology,
            ..self
        }
    }

    /// Position and tangents at a corner, once a mask is known or the vertex stands for its limit.
    fn limit(mut self, mut corner: u32) -> LimitStencil {
        let over = |mask: &[(u32, f64)], values: &[Mask]| {
            let mut row = Mask::blend(mask, values);
            row.retain(|(_, weight)| *weight != 0.0);
            row
        };
        for _ in 0..DEEPEST {
            if let Some(limit) = vertex_limit(&self.topology, self.scheme, 0, corner) {
                return LimitStencil {
                    position: over(&limit.position, &self.values),
                    du: over(&limit.du, &self.values),
                    dv: over(&limit.dv, &self.values),
                };
            }
            let whole = self.scheme.is_whole(self.topology.face(0).len());
            self = self.child(corner);
            // The child of any other face begins at the corner.
            corner = if whole { corner } else { 0 };
        }
        let (here, next, previous) = around(self.topology.face(0), corner);
        let towards = |vertex: u32| over(&[(vertex, 1.0), (here, -1.0)], &self.values);
        LimitStencil {
            position: over(&[(here, 1.0)], &self.values),
            du: towards(next),
            dv: towards(previous),
        }
    }
}

/// A corner's vertex, the next and the previous one.
fn around(face: &[u32], corner: u32) -> (u32, u32, u32) {
    let (n, i) = (face.len(), corner as usize);
    (face[i], face[(i + 1) % n], face[(i + n - 1) % n])
}
