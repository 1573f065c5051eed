//! Tangents at vertices that stay where they are.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use super::{Family, LimitStencil, Ring, negated};
use crate::subdivision::masks::Mask;

impl Ring<'_> {
    /// The vertex stays, and what is beside it contracts towards it mode by mode.
    ///
    /// A face that has both sharp edges to itself lies in their plane. Among several faces the slowest mode of the sector drags all
    /// inner edges into one direction: the surface has a cusp. Its tangent plane, as the limit of the plane through the face's two edges,
    /// is spanned by that direction and by what tells the two edges apart: a sharp edge itself or the next slower mode.
    pub(super) fn corner(&self) -> LimitStencil {
        let position = Mask::from_slice(&[(self.middle(), 1.0)]);
        let (k, at) = (self.faces(), self.fan.at);
        let (du, dv) = if self.fan.closed {
            self.cusp()
        } else if k == 1 {
            (self.along(0), self.along(1))
        } else if at == 0 {
            (self.along(0), self.sector_mode(1))
        } else if at == k - 1 {
            (self.sector_mode(1), self.along(k))
        } else {
            (self.sector_mode(1), self.beside_cusp(self.along(0)))
        };
        LimitStencil { position, du, dv }
    }

    /// What tells the edges of a face inside a sector apart once its cusp is taken out; `along` is the direction of the sector's first edge.
    ///
    /// If that edge is also its last, and of four faces, mode 2 contracts like it without being fed by it. Then both count: the faces' edges
    /// e1, e2, e3 hold 0, -1, 0 of the sharp edge (the right eigenvector of 1/2 that is 1 there), 1, 0, -1 of mode 2 over its square of
    /// 12, and the sines of mode 1.
    pub(super) fn beside_cusp(&self, along: Mask) -> Mask {
        let (k, at) = (self.faces(), self.fan.at);
        if self.family == Family::Triangles && (k == 4 || k == 5) {
            return self.between_sharp_edges();
        }
        let mut mask = self.sector_mode(2);
        if k == 4 && self.fan.edges[0] == self.fan.edges[k] {
            let share = 12.0 * FRAC_1_SQRT_2 * if at == 1 { 1.0 } else { -1.0 };
            mask.extend(
                along
                    .iter()
                    .map(|&(vertex, weight)| (vertex, share * weight)),
            );
        }
        negated(mask)
    }

    /// Of four or five triangles mode 2 is faster than the sharp edges, so these tell a face's edges apart. Edge i holds r(i) of the first sharp
    /// edge and r(k - i) of the last, by the right eigenvectors of 1/2: r(i) = r(i - 1) + r(i + 1), r(0) = 1, r(k) = 0.
    fn between_sharp_edges(&self) -> Mask {
        let (k, at) = (self.faces(), self.fan.at);
        let third = PI / 3.0;
        let held = |i: usize| ((k - i) as f64 * third).sin() / (k as f64 * third).sin();
        let slow = |i: usize| (i as f64 * PI / k as f64).sin();
        let share = |end: fn(usize, usize) -> usize| {
            slow(at) * held(end(k, at + 1)) - slow(at + 1) * held(end(k, at))
        };
        let mut mask = Mask::new();
        for (edge, share) in [(0, share(|_, i| i)), (k, share(|k, i| k - i))] {
            mask.extend([(self.end(edge), share), (self.middle(), -share)]);
        }
        mask
    }

    fn along(&self, i: usize) -> Mask {
        Mask::from_slice(&[(self.middle(), -1.0), (self.end(i), 1.0)])
    }

    /// A sharp vertex without sharp edges: the mode of frequency 0 is the slowest, those of frequency 1 tell the face's edges apart.
    pub(super) fn cusp(&self) -> (Mask, Mask) {
        let (n, at) = (self.faces(), self.fan.at);
        if n == 2 {
            let chord = Mask::from_slice(&[(self.end(at + 1), 1.0), (self.end(at), -1.0)]);
            return (self.mode(0.0, |_| 1.0), chord);
        }
        let angle = 2.0 * PI / n as f64;
        (
            self.mode(0.0, |_| 1.0),
            self.mode(angle, |i| (angle * (i - at as f64 - 0.5)).sin()),
        )
    }

    /// Mode j of a sector of k faces between sharp edges: sin(i j pi / k) inside, and whatever the sharp edges feed into it.
    ///
    /// Sharp edges contract by 1/2. A slower mode takes them in with weight 1 / (eigenvalue - 1/2); at 1/2 there is resonance and
    /// they take over; faster modes vanish beside them.
    pub(super) fn sector_mode(&self, j: usize) -> Mask {
        let k = self.faces();
        let angle = PI * j as f64 / k as f64;
        let excess = self.eigenvalue(angle) - 0.5;
        let apart = self.fan.edges[0] != self.fan.edges[k];
        let slower = excess > 1e-9;
        let mut mask = Mask::new();
        if slower || !apart && (j == 2 || k == 2) {
            let scale = if slower { excess } else { 1.0 };
            mask.extend(
                self.mode(angle, |i| (angle * i).sin())
                    .iter()
                    .map(|&(v, w)| (v, w * scale)),
            );
        }
        if slower || apart {
            let fed = self.fed(angle);
            let far_sign = if j % 2 == 1 { 1.0 } else { -1.0 };
            for (i, sign) in [(0, 1.0), (k, far_sign)] {
                mask.push((self.end(i), fed * sign));
                mask.push((self.middle(), -fed * sign));
            }
        }
        mask
    }

    /// The mask of a mode of frequency `angle` whose edge i has amplitude f(i), seen from a middle that stays.
    fn mode(&self, angle: f64, f: impl Fn(f64) -> f64) -> Mask {
        let mut mask = Mask::new();
        for i in 0..self.faces() {
            let edge = self.edge_weight(angle) * f(i as f64);
            mask.extend([(self.end(i), edge), (self.middle(), -edge)]);
            if self.family == Family::Quads {
                let face = f(i as f64) + f(i as f64 + 1.0);
                mask.extend([(self.far(i), face), (self.middle(), -face)]);
            }
        }
        mask
    }
}
