//! Non-manifold creases: faces that begin and end at the same edge of the crease, or are a cone around a vertex on it.

use std::f64::consts::PI;

use super::{LimitStencil, Ring};
use crate::subdivision::masks::Mask;

impl Ring<'_> {
    /// Whether the fan does not lead from one edge of the crease to the other, as only non-manifold vertices allow.
    pub(super) fn is_page(&self) -> bool {
        self.fan.closed || self.fan.edges[0] == self.fan.edges[self.faces()]
    }

    /// A cusp as at a corner, but its tip moves along the crease.
    pub(super) fn page(&self) -> LimitStencil {
        let (k, at) = (self.faces(), self.fan.at);
        let [a, b] = self.crease_ends();
        let position =
            Mask::from_slice(&[(self.middle(), 4.0 / 6.0), (a, 1.0 / 6.0), (b, 1.0 / 6.0)]);
        let (du, dv) = if self.fan.closed {
            let (cusp, across) = self.cusp();
            (self.moving(cusp, self.eigenvalue(0.0) - 0.5, true), across)
        } else {
            let back = self.end(0) == b;
            let (near, beyond) = if back { (b, a) } else { (a, b) };
            let along = Mask::from_slice(&[(near, 0.5), (beyond, -0.5)]);
            let excess = self.eigenvalue(PI / k as f64) - 0.5;
            let slowest = if excess > 1e-9 {
                self.moving(self.sector_mode(1), excess, false)
            } else {
                // Two faces: across the crease as anywhere.
                let mut mask = self.sector_mode(1);
                mask.extend([(self.middle(), 2.0), (a, -1.0), (b, -1.0)]);
                mask
            };
            match at {
                0 => (along, slowest),
                _ if at == k - 1 => (slowest, along),
                _ => (slowest, self.beside_cusp(along)),
            }
        };
        LimitStencil { position, du, dv }
    }

    /// The far ends of the crease through the middle.
    fn crease_ends(&self) -> [u32; 2] {
        let mut edges = self.topology.sharp_edges(self.middle());
        [0, 1].map(|_| {
            let edge = edges.next().expect("a crease has two edges");
            self.topology.edge(edge).other(self.middle())
        })
    }

    /// A mode seen from a middle that stays, turned into that seen from one on a crease: its weight and what the two ends take over from
    /// it follow from their columns of the matrix. With `raw`, the mode has yet to be scaled by the excess of its eigenvalue over 1/2.
    fn moving(&self, mode: Mask, excess: f64, raw: bool) -> Mask {
        let scale = if raw { excess } else { 1.0 };
        let own = |&(vertex, weight): &(u32, f64)| (vertex == self.middle()).then_some(weight);
        let middle = scale * mode.iter().filter_map(own).sum::<f64>() / (excess + 0.25);
        let mut mask: Mask = mode
            .iter()
            .filter(|&&(vertex, _)| vertex != self.middle())
            .map(|&(vertex, weight)| (vertex, scale * weight))
            .collect();
        mask.push((self.middle(), excess * middle));
        mask.extend(self.crease_ends().map(|end| (end, middle / 8.0)));
        mask
    }
}
