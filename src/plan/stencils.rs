//! The stencils of a plan.

use std::borrow::Cow;

use crate::plan::row_pool::PooledRows;
use crate::plan::stencil_rows::{KnownRows, StencilRows};

/// Control points, or limit positions and tangents, as weighted sums over the 1-ring, sorted by the level that first needs them. Below the root of a tree
/// control points are relative to one of the first, which the nodes name.
#[derive(Clone, Debug)]
pub struct Stencils {
    ring_size: usize,
    weights: Weights,
}

/// One weight a vertex of the ring.
#[derive(Clone, Debug)]
enum Weights {
    /// As they were found.
    Exact {
        /// Level and corner of each stencil.
        of: Vec<(u32, Option<u32>)>,
        weights: Vec<f64>,
    },
    /// As shaders have them.
    Packed(StencilRows),
    /// The same in a database.
    Pooled(PooledRows),
}

impl PartialEq for Stencils {
    fn eq(&self, other: &Stencils) -> bool {
        let own = |stencils: &Stencils, number| {
            let (level, corner) = (stencils.level(number), stencils.corner(number));
            (level, corner, stencils.weights(number))
        };
        (self.ring_size, self.len()) == (other.ring_size, other.len())
            && (0..self.len()).all(|number| own(self, number) == own(other, number))
    }
}

impl Stencils {
    /// None, over a ring of so many vertices; with exact weights, or packed ones.
    pub(super) fn new(ring_size: usize, exact: bool) -> Stencils {
        let weights = if exact {
            Weights::Exact {
                of: Vec::new(),
                weights: Vec::new(),
            }
        } else {
            Weights::Packed(StencilRows::new(ring_size))
        };
        Stencils { ring_size, weights }
    }

    /// Those of rows that are packed already.
    pub(super) fn of(ring_size: usize, rows: StencilRows) -> Stencils {
        Stencils {
            ring_size,
            weights: Weights::Packed(rows),
        }
    }

    /// Those of rows that are in a pool.
    pub(super) fn pooled(ring_size: usize, rows: PooledRows) -> Stencils {
        Stencils {
            ring_size,
            weights: Weights::Pooled(rows),
        }
    }

    /// The rows, where they are in a pool.
    pub(super) fn in_pool(&self) -> Option<&PooledRows> {
        match &self.weights {
            Weights::Pooled(rows) => Some(rows),
            Weights::Exact { .. } | Weights::Packed(_) => None,
        }
    }

    /// Appends one, not into a pool. Those of vertices are dense: they are summed for every patch whatever its level, without a pattern to be fetched first.
    pub(super) fn push(
        &mut self,
        level: u32,
        corner: Option<u32>,
        own: impl Iterator<Item = f64>,
        dense: bool,
        known: &mut KnownRows,
    ) {
        match &mut self.weights {
            Weights::Exact { of, weights } => {
                of.push((level, corner));
                weights.extend(own);
            }
            Weights::Packed(rows) => rows.push(level, corner, own, dense, known),
            Weights::Pooled(_) => unreachable!("what is in a pool is finished"),
        }
    }

    /// Packed, as shaders have them.
    pub(super) fn packed(&self, dense: bool) -> Cow<'_, StencilRows> {
        match &self.weights {
            Weights::Packed(rows) => Cow::Borrowed(rows),
            Weights::Exact { .. } | Weights::Pooled(_) => {
                let mut rows = StencilRows::new(self.ring_size);
                let mut known = KnownRows::default();
                for number in 0..self.len() {
                    let (level, corner) = (self.level(number), self.corner(number));
                    let own = self.weights(number).into_iter();
                    rows.push(level, corner, own, dense, &mut known);
                }
                Cow::Owned(rows)
            }
        }
    }

    /// The packed rows, which tell levels and corners; none where weights are exact.
    fn rows(&self) -> &[[u32; 2]] {
        match &self.weights {
            Weights::Exact { .. } => &[],
            Weights::Packed(rows) => &rows.rows,
            Weights::Pooled(rows) => &rows.rows,
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match &self.weights {
            Weights::Exact { of, .. } => of.len(),
            _ => self.rows().len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many the levels up to one need; they are the first ones.
    pub fn count(&self, level: u32) -> usize {
        match &self.weights {
            Weights::Exact { of, .. } => of.partition_point(|own| own.0 <= level),
            _ => self
                .rows()
                .partition_point(|row| StencilRows::level(row) <= level),
        }
    }

    /// The lowest level that needs stencil `number`, which must be one.
    pub fn level(&self, number: usize) -> u32 {
        match &self.weights {
            Weights::Exact { of, .. } => of[number].0,
            _ => StencilRows::level(&self.rows()[number]),
        }
    }

    /// The corner of the face near which stencil `number` is relative to the limit, or whose limit it is. The sum is then taken relative to that corner's
    /// vertex, which has the same bits in all faces there; otherwise to the ring's first.
    pub fn corner(&self, number: usize) -> Option<u32> {
        match &self.weights {
            Weights::Exact { of, .. } => of[number].1,
            _ => StencilRows::corner(&self.rows()[number]),
        }
    }

    /// The weights of stencil `number`, one a vertex of the ring.
    pub fn weights(&self, number: usize) -> Vec<f64> {
        match &self.weights {
            Weights::Exact { weights, .. } => {
                weights[self.ring_size * number..][..self.ring_size].to_vec()
            }
            Weights::Packed(rows) => rows.weights(number),
            Weights::Pooled(rows) => rows.weights(number, self.ring_size),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_stencils_have_the_weights_that_shaders_have() {
        for ring_size in [1, 30, 64, 65, 200, 700] {
            let weight = |number: usize, place: usize| match (place * 7 + number) % 3 {
                0 => 0.0,
                1 => ((place % 5) as f64 - 3.1) / (number as f64 + 1.7),
                _ => (place as f64 - 3.1) / (number as f64 + 1.7),
            };
            let mut known = KnownRows::default();
            let mut exact = Stencils::new(ring_size, true);
            let mut direct = Stencils::new(ring_size, false);
            for number in 0..5 {
                let corner = (number % 2 == 1).then_some(number as u32 % 4);
                for stencils in [&mut exact, &mut direct] {
                    let weights = (0..ring_size).map(|place| weight(number, place));
                    stencils.push(number as u32 / 2, corner, weights, false, &mut known);
                }
            }
            let packed = Stencils::of(ring_size, exact.packed(false).into_owned());
            assert_eq!(packed, direct);
            assert_eq!((packed.len(), packed.count(1)), (5, 4));
            let sums: Vec<[f64; 2]> = exact.packed(false).sums().collect();
            for (number, sums) in sums.into_iter().enumerate() {
                assert_eq!(packed.corner(number), exact.corner(number));
                assert_eq!(packed.level(number), exact.level(number));
                let rounded = exact.weights(number);
                let rounded = rounded.iter().map(|&weight| f64::from(weight as f32));
                let weights = packed.weights(number);
                assert!(weights.iter().copied().eq(rounded), "{ring_size}");
                let sum: f64 = weights.iter().sum();
                let size: f64 = weights.iter().map(|weight| weight.abs()).sum();
                assert!((sum - sums[0]).abs() <= 1e-12 * size.max(1.0));
                assert!((size - sums[1]).abs() <= 1e-12 * size.max(1.0));
            }
        }
    }
}
