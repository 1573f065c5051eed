//! Points as weighted sums over a ring: a matrix that grows row by row.

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

    /// Makes room for so many rows more.
    pub fn reserve(&mut self, count: usize) {
        self.weights.reserve(self.width * count);
    }

    /// Appends a point that a mask makes of other rows' points.
    pub fn push(&mut self, mask: &[(u32, f64)], points: &Rows) {
        let number = self.len();
        self.weights.resize(self.weights.len() + self.width, 0.0);
        self.add(number, mask, points);
    }

    /// Adds to a row what a mask makes of other rows' points.
    pub fn add(&mut self, number: usize, mask: &[(u32, f64)], points: &Rows) {
        let sum = self.row_mut(number);
        for &(vertex, weight) in mask {
            for (sum, value) in sum.iter_mut().zip(points.row(vertex as usize)) {
                *sum += weight * value;
            }
        }
    }
}
