//! Points as weighted sums over a ring: a matrix that grows row by row.

use crate::subdivision::Mask;

/// Rows of weights, one behind the other.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    width: usize,
    weights: Vec<f64>,
}

impl Rows {
    /// `count` rows of zeros, one weight a vertex of a ring of `width`.
    pub fn zero(width: usize, count: usize) -> Rows {
        Rows {
            width,
            weights: vec![0.0; width * count],
        }
    }

    /// The same in the memory of others.
    pub fn zero_in(mut weights: Vec<f64>, width: usize, count: usize) -> Rows {
        weights.clear();
        weights.resize(width * count, 0.0);
        Rows { width, weights }
    }

    /// Their memory, for others.
    pub fn into_memory(self) -> Vec<f64> {
        self.weights
    }

    /// The vertices of the ring themselves.
    pub fn identity(width: usize) -> Rows {
        let mut rows = Rows::zero(width, width);
        (0..width).for_each(|i| rows.row_mut(i)[i] = 1.0);
        rows
    }

    /// How many weights a row has.
    pub fn width(&self) -> usize {
        self.width
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.weights.len() / self.width
    }

    /// One row.
    pub fn row(&self, number: usize) -> &[f64] {
        &self.weights[self.width * number..][..self.width]
    }

    /// One row, for writing.
    pub fn row_mut(&mut self, number: usize) -> &mut [f64] {
        &mut self.weights[self.width * number..][..self.width]
    }

    /// Appends a row of zeros, for something to be added to it.
    pub fn push(&mut self, row: impl FnOnce(&mut [f64])) {
        let number = self.len();
        self.weights.resize(self.weights.len() + self.width, 0.0);
        row(self.row_mut(number));
    }

    /// Adds to a row what a mask makes of these points.
    pub fn add_to(&self, row: &mut [f64], mask: &[(u32, f64)]) {
        for &(vertex, weight) in mask {
            for (sum, value) in row.iter_mut().zip(self.row(vertex as usize)) {
                *sum += weight * value;
            }
        }
    }

    /// What masks make of these points.
    pub fn next(&self, masks: &[Mask]) -> Rows {
        let mut next = Rows::zero(self.width, 0);
        next.weights.reserve(self.width * masks.len());
        for mask in masks {
            next.push(|row| self.add_to(row, mask));
        }
        next
    }
}
