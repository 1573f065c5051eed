//! What points deep in a tree are relative to.
//!
//! A sum over a ring errs by some units of rounding of the ring's own size, while neighbouring points at depth d are 2^d times nearer to each other: by
//! their differences, which derivatives are, up to six binary digits would be lost. So from depth 2 on points are relative to a vertex near the corner
//! (of an edge: the end) that their quarter (their half) of the tree has: the one there at the deepest level. The weights of such a point sum to zero,
//! and are as small as its distance from that vertex. Evaluation adds the vertex again, to the position alone.

use crate::plan::rows::Rows;

/// From this depth on points are relative.
pub(super) const DEPTH: u32 = 2;

/// The level of a stencil that nothing uses.
pub(super) const UNUSED: u32 = u32::MAX;

/// The vertices that points are relative to, which are a plan's first rows, one for each of a tree's first children.
pub(super) struct Bases {
    /// Their weights, as far as they are known.
    vertices: Vec<Vec<f64>>,
    /// Of the rows behind them, which each is relative to.
    of: Vec<Option<usize>>,
}

impl Bases {
    /// For a tree whose nodes have `children` each.
    pub fn new(children: usize) -> Bases {
        Bases {
            vertices: vec![Vec::new(); children],
            of: Vec::new(),
        }
    }

    /// The rows of a plan before anything else is pushed: room for the bases.
    pub fn rows(&self, width: usize) -> Rows {
        Rows::zero(width, self.vertices.len())
    }

    /// Tells the vertex at the corner of a child, at the deepest level so far.
    pub fn found(&mut self, child: usize, weights: &[f64]) {
        self.vertices[child] = weights.to_vec();
    }

    /// Tells that a row was pushed at some depth below a child of the root.
    pub fn pushed(&mut self, depth: u32, child: usize) {
        self.of.push((depth >= DEPTH).then_some(child));
    }

    /// Makes rows relative, and gives the bases themselves the level of the row that comes first: so they come before it. Without such rows nothing
    /// uses them.
    pub fn apply(self, rows: &mut Rows, levels: &mut [u32]) {
        let count = self.vertices.len();
        let any = self.of.iter().any(Option::is_some);
        let first = levels[count..].iter().copied().min().filter(|_| any);
        levels[..count].fill(first.unwrap_or(UNUSED));
        for (number, child) in (count..).zip(&self.of) {
            let Some(child) = *child else { continue };
            let base = self.vertices[child].iter();
            let row = rows.row_mut(number).iter_mut();
            row.zip(base).for_each(|(weight, base)| *weight -= base);
        }
        for (number, weights) in self.vertices.iter().enumerate() {
            if any && !weights.is_empty() {
                rows.row_mut(number).copy_from_slice(weights);
            }
        }
    }
}
