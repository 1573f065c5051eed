//! A face in its surroundings, refined towards a point of it, under any scheme.

use glam::{DVec2, DVec3};

use crate::mesh::Scheme;
use crate::mesh::topology::Topology;
use crate::patch::boxspline;
use crate::subdivision::jet::{Jet, Sum, nearest_corner, recentred};
use crate::subdivision::masks::Blend;
use crate::subdivision::regular::{bspline_jet, bspline_patch};
use crate::subdivision::schemes::vertex_limit;
use crate::subdivision::split::refine_child;
use crate::subdivision::{Refinement, box_spline_patch};

/// A face, number 0 of a topology with all that its limit depends on.
pub(super) struct SchemeCell {
    pub topology: Topology,
    /// Relative to the origin, which is one of the face's vertices.
    pub positions: Vec<DVec3>,
    pub origin: DVec3,
    pub scheme: Scheme,
}

/// After so many halvings a face is flat to the last digit of an f64, while differences of its corners still have half their digits.
const DEEPEST: u32 = 26;

impl SchemeCell {
    /// The limit at (u, v) of the face; of its ptex face at `corner` when it is neither triangle nor quad.
    pub fn evaluate(mut self, corner: u32, mut uv: DVec2) -> Jet {
        if !self.scheme.is_whole(self.topology.face(0).len()) {
            self = self.child(corner);
        }
        let triangle = self.topology.face(0).len() == 3;
        let mut scale = 1.0;
        for depth in 0..DEEPEST {
            if let Some(corner) = corner_at(triangle, uv) {
                return self.limit(corner, DEEPEST - depth).scaled(scale);
            }
            if let Some(jet) = self.regular(uv) {
                return jet.scaled(scale);
            }
            let (child, inside, turn) = descend(triangle, uv);
            self = self.child(child);
            uv = inside;
            scale *= turn;
        }
        self.flat(uv).scaled(scale)
    }

    fn child(&self, child: u32) -> SchemeCell {
        let Refinement {
            topology, masks, ..
        } = refine_child(&self.topology, self.scheme, child);
        let blend = |mask| DVec3::blend(mask, &self.positions);
        let mut positions: Vec<DVec3> = masks.iter().map(|mask| blend(mask)).collect();
        // The child at a corner keeps it, but that of an n-gon begins there; the one in the middle of a triangle has none.
        let n = topology.face(0).len();
        let at = if n == self.topology.face(0).len() {
            child as usize % n
        } else {
            0
        };
        let mut origin = self.origin;
        recentred(&mut positions, &mut origin, topology.face(0)[at]);
        SchemeCell {
            topology,
            positions,
            origin,
            scheme: self.scheme,
        }
    }

    /// The limit at a corner. Where no mask is known after so many more refinements, tangents are the edges there, in error by about 2^-26 or whatever
    /// else the scheme's modes contract to.
    fn limit(&self, corner: u32, levels: u32) -> Jet {
        if let Some(stencil) = vertex_limit(&self.topology, self.scheme, 0, corner) {
            return Jet::of(&stencil, &self.positions).moved(self.origin);
        }
        if levels == 0 {
            return Jet {
                position: self.settled(corner),
                ..self.corner(corner)
            };
        }
        self.child(corner).limit(corner, levels - 1).scaled(2.0)
    }

    /// Where a corner goes. Among faces of both kinds it may be off its limit by as much as a face is wide, so it takes as many halvings again.
    fn settled(&self, corner: u32) -> DVec3 {
        let at = |cell: &SchemeCell| {
            cell.origin + cell.positions[cell.topology.face(0)[corner as usize] as usize]
        };
        if self.scheme == Scheme::Butterfly {
            return at(self);
        }
        let first = self.child(corner);
        at(&(1..DEEPEST).fold(first, |cell, _| cell.child(corner)))
    }

    /// A corner of the face itself, and the face's edges there as derivatives.
    fn corner(&self, corner: u32) -> Jet {
        let face = self.topology.face(0);
        let points: Vec<DVec3> = face.iter().map(|&v| self.positions[v as usize]).collect();
        let along = |from: usize, to: usize| Sum::between(points[from], points[to]);
        let (du, dv) = match (face.len(), corner) {
            (3, _) => (along(0, 1), along(0, 2)),
            (_, 0) => (along(0, 1), along(0, 3)),
            (_, 1) => (along(0, 1), along(1, 2)),
            (_, 2) => (along(3, 2), along(1, 2)),
            _ => (along(3, 2), along(0, 3)),
        };
        let position = self.origin + points[corner as usize];
        Jet { position, du, dv }
    }

    /// Between the limits at the corners, linearly.
    fn flat(&self, uv: DVec2) -> Jet {
        let DVec2 { x: u, y: v } = uv;
        let weights = match self.topology.face(0).len() {
            3 => vec![1.0 - u - v, u, v],
            _ => vec![(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v],
        };
        let mut sum = Jet::default();
        for (corner, weight) in (0..).zip(weights) {
            let jet = self.limit(corner, 0);
            sum.position += weight * jet.position;
            sum.du = sum.du + jet.du * weight;
            sum.dv = sum.dv + jet.dv * weight;
        }
        sum
    }

    /// The face's polynomial at (u, v), where the scheme has one.
    fn regular(&self, uv: DVec2) -> Option<Jet> {
        match self.scheme {
            Scheme::Butterfly | Scheme::Bilinear => return None,
            Scheme::CatmullClark | Scheme::Loop | Scheme::LoopStam => {}
        }
        if self.topology.face(0).len() == 3 {
            let masks = box_spline_patch(&self.topology, 0)?;
            let points = masks.map(|mask| DVec3::blend(&mask, &self.positions));
            let basis = boxspline::basis(uv.x, uv.y);
            let sum = |weights: [f64; 12]| {
                let weights: [(u32, f64); 12] = std::array::from_fn(|i| (i as u32, weights[i]));
                Sum::of(&weights, &points)
            };
            let jet = Jet {
                position: sum(basis.value).value,
                du: sum(basis.du),
                dv: sum(basis.dv),
            };
            return Some(jet.moved(self.origin));
        }
        let patch = bspline_patch(&self.topology, 0).filter(|patch| patch.crease.is_none())?;
        Some(bspline_jet(&patch, &self.positions, uv).moved(self.origin))
    }
}

fn corner_at(triangle: bool, uv: DVec2) -> Option<u32> {
    match (triangle, uv.x, uv.y) {
        (_, 0.0, 0.0) => Some(0),
        (_, 1.0, 0.0) => Some(1),
        (true, 0.0, 1.0) => Some(2),
        (false, 1.0, 1.0) => Some(2),
        (false, 0.0, 1.0) => Some(3),
        _ => None,
    }
}

/// The child that holds (u, v), the point's own (u, v) there, and by what the child's derivatives are to be multiplied.
fn descend(triangle: bool, uv: DVec2) -> (u32, DVec2, f64) {
    if !triangle {
        let corner = nearest_corner(uv);
        let origin = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)][corner as usize];
        return (corner, 2.0 * uv - DVec2::from(origin), 2.0);
    }
    if uv.x >= 0.5 {
        (1, 2.0 * uv - DVec2::X, 2.0)
    } else if uv.y >= 0.5 {
        (2, 2.0 * uv - DVec2::Y, 2.0)
    } else if uv.x + uv.y <= 0.5 {
        (0, 2.0 * uv, 2.0)
    } else {
        (3, 1.0 - 2.0 * uv, -2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{ControlMesh, INFINITE_SHARPNESS};

    /// Triangles around vertex 0, and around all but the rim another ring, so that the fan's far edges are smooth.
    fn fan(n: usize, closed: bool, creases: &[usize], sharp: bool) -> Topology {
        let count = if closed { n } else { n + 1 } as u32;
        let (inner, outer) = (|i: u32| 1 + i % count, |i: u32| 1 + count + i % count);
        let mut faces = Vec::new();
        for i in 0..n as u32 {
            faces.extend([0, inner(i), inner(i + 1)]);
            faces.extend([inner(i), outer(i), outer(i + 1)]);
            faces.extend([inner(i), outer(i + 1), inner(i + 1)]);
        }
        let positions = vec![[0.0; 3]; 1 + 2 * count as usize];
        let mut builder = ControlMesh::builder(&positions, &vec![3; faces.len() / 3], &faces)
            .scheme(Scheme::Loop);
        for &edge in creases {
            builder = builder.crease(0, inner(edge as u32), INFINITE_SHARPNESS);
        }
        if sharp {
            builder = builder.corner(0, INFINITE_SHARPNESS);
        }
        Topology::new(&builder.build().expect("a sound fan"))
    }

    /// The number `i` of a sequence without pattern, in -1..1 (splitmix64).
    fn scatter(i: usize) -> f64 {
        let mut x = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ x >> 31) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// The face with vertices anywhere.
    fn cell(topology: &Topology, face: u32) -> SchemeCell {
        let faces = crate::subdivision::refine::with_neighbours(topology, &[face]);
        let (topology, vertices) = topology.excerpt(&faces);
        let position = |&v: &u32| {
            let i = v as usize;
            if v == 0 {
                return DVec3::ZERO;
            }
            DVec3::new(scatter(3 * i), scatter(3 * i + 1), scatter(3 * i + 2))
        };
        SchemeCell {
            topology,
            positions: vertices.iter().map(position).collect(),
            origin: DVec3::ZERO,
            scheme: Scheme::Loop,
        }
    }

    fn normal(jet: Jet) -> DVec3 {
        jet.normal().expect("nothing cancels here")
    }

    /// Distance of the positions and angle of the normals of a mask at corner 0 and of refinement. Elsewhere than at sharp vertices sixteen levels show the normal: of more, rounding
    /// would be all that is left of what contracts by 1/4.
    fn apart(mut cell: SchemeCell, levels: u32) -> (f64, f64) {
        let mask = cell.limit(0, 0);
        assert!(vertex_limit(&cell.topology, Scheme::Loop, 0, 0).is_some());
        let position = cell.settled(0);
        for _ in 0..levels {
            cell = cell.child(0);
        }
        (
            mask.position.distance(position),
            normal(mask).angle_between(normal(cell.corner(0))),
        )
    }

    #[test]
    fn masks_among_triangles_are_what_refinement_leads_to() {
        for n in 1..=9 {
            let mut kinds = vec![
                ("crease", fan(n, false, &[], false), 0.15),
                // Neighbouring modes contract by 3/8 and 1/2 where four triangles meet, and alike, which takes 1 / level, at corners of three and six.
                ("corner", fan(n, false, &[], true), 0.3),
            ];
            if n > 2 {
                kinds.extend([
                    ("smooth", fan(n, true, &[], false), 0.05),
                    ("dart", fan(n, true, &[0], false), 0.15),
                    ("sharp vertex", fan(n, true, &[], true), 0.4),
                    ("crease through", fan(n, true, &[0, n / 2], false), 0.15),
                ]);
            }
            // Beside a crease of seven triangles the second wave contracts less than the crease itself; as OpenSubdiv's, the tangents given
            // are the crease and the first wave all the same.
            kinds.retain(|kind| n < 7 || !kind.0.starts_with("crease"));
            for (kind, topology, bound) in kinds {
                // A corner stays at the origin, so nothing is lost however near its neighbours come.
                let levels = if kind == "corner" { 60 } else { 16 };
                for face in 0..n as u32 {
                    let (distance, angle) = apart(cell(&topology, 3 * face), levels);
                    let place = format!("{kind}, {n} triangles, number {face}");
                    assert!(distance < 1e-7, "{place}: {distance:e} off");
                    assert!(angle < bound, "{place}: {angle} radians");
                }
            }
        }
    }
}
