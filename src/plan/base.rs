//! What points deep in a tree are relative to.
//!
//! A sum over a ring errs by some units of rounding of the ring's own size, while neighbouring points at depth d are 2^d times nearer to each other: by
//! their differences, which derivatives are, up to six binary digits would be lost. So below the root points are relative to a point at the corner
//! (of an edge: the end) near which they are. The weights of such a point sum to zero, and are as small as its distance from there. Evaluation adds
//! the base again, to the position alone.
//!
//! The bases of a face are limits of its corners, which are the same for all faces around: so are the weights of points that they share.

use crate::plan::rows::Rows;

/// The level of a stencil that nothing uses.
pub(super) const UNUSED: u32 = u32::MAX;

/// The points that others are relative to, which are a plan's first rows, one for each corner of a face or end of an edge.
pub(super) struct Bases {
    /// Their weights, as far as they are known.
    weights: Vec<Vec<f64>>,
    /// Of the rows behind them, which each is relative to.
    of: Vec<Option<u32>>,
}

impl Bases {
    /// For so many corners or ends.
    pub fn new(count: usize) -> Bases {
        Bases {
            weights: vec![Vec::new(); count],
            of: Vec::new(),
        }
    }

    /// The rows of a plan before anything else is pushed, in the memory of others: room for the bases.
    pub fn rows(&self, memory: Vec<f64>, width: usize) -> Rows {
        Rows::zero_in(memory, width, self.weights.len())
    }

    /// Tells what a base is.
    pub fn found(&mut self, base: u32, weights: &[f64]) {
        self.weights[base as usize] = weights.to_vec();
    }

    /// Tells that a row was pushed, and what it is relative to.
    pub fn pushed(&mut self, base: Option<u32>) {
        self.of.push(base);
    }

    /// The bases that rows are relative to.
    pub fn used(&self) -> Vec<u32> {
        let all = 0..self.weights.len() as u32;
        all.filter(|&base| self.of.contains(&Some(base))).collect()
    }

    /// Which base, if any, each row is relative to, or is itself.
    pub fn of_rows(&self) -> Vec<Option<u32>> {
        let own = (0..self.weights.len() as u32).map(Some);
        own.chain(self.of.iter().copied()).collect()
    }

    /// Makes rows relative, and gives the bases that are used the level of the row that comes first: so they come before all others.
    pub fn apply(&self, rows: &mut Rows, levels: &mut [u32]) {
        let count = self.weights.len();
        let first = levels[count..].iter().copied().min();
        levels[..count].fill(UNUSED);
        for (number, &base) in (count..).zip(&self.of) {
            let Some(base) = base else { continue };
            let weights = self.weights[base as usize].iter();
            let row = rows.row_mut(number).iter_mut();
            row.zip(weights).for_each(|(weight, base)| *weight -= base);
        }
        for base in self.used() {
            let number = base as usize;
            rows.row_mut(number).copy_from_slice(&self.weights[number]);
            levels[number] = first.unwrap_or(UNUSED);
        }
    }
}
