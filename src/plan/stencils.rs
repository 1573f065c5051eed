//! The stencils of a plan.

use smallvec::SmallVec;

/// Control points, or limit positions and tangents, as weighted sums over the 1-ring, sorted by the level that first needs them. Below the root of a tree
/// control points are relative to one of the first, which the nodes name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stencils {
    ring_size: usize,
    levels: Vec<u8>,
    /// Corners plus 1; 0 for none.
    corners: Vec<u8>,
    weights: Weights,
}

/// One weight a vertex of the ring.
#[derive(Clone, Debug, PartialEq)]
enum Weights {
    /// As they were found.
    Exact(Vec<f64>),
    /// As shaders have them, without those that are zero: half of them are, and databases have many.
    Rounded {
        /// Bits of the vertices that have a weight.
        places: Vec<u64>,
        /// Where each stencil's weights begin.
        starts: Vec<u32>,
        weights: Vec<f32>,
    },
}

impl Default for Weights {
    fn default() -> Weights {
        Weights::Exact(Vec::new())
    }
}

/// The weights of a stencil.
pub type Dense = SmallVec<[f64; 64]>;

impl Stencils {
    /// None, over a ring of so many vertices; with exact weights, or rounded.
    pub(super) fn new(ring_size: usize, exact: bool) -> Stencils {
        let rounded = || Weights::Rounded {
            places: Vec::new(),
            starts: Vec::new(),
            weights: Vec::new(),
        };
        Stencils {
            ring_size,
            weights: if exact { Weights::default() } else { rounded() },
            ..Stencils::default()
        }
    }

    /// Appends one.
    pub(super) fn push(
        &mut self,
        level: u32,
        corner: Option<u32>,
        own: impl ExactSizeIterator<Item = f64>,
    ) {
        self.levels.push(level as u8);
        self.corners
            .push(corner.map_or(0, |corner| corner as u8 + 1));
        match &mut self.weights {
            Weights::Exact(weights) => weights.extend(own),
            Weights::Rounded {
                places,
                starts,
                weights,
            } => {
                starts.push(weights.len() as u32);
                let first = places.len();
                places.resize(first + self.ring_size.div_ceil(64), 0);
                for (place, weight) in own.enumerate() {
                    let weight = weight as f32;
                    if weight != 0.0 {
                        places[first + place / 64] |= 1 << (place % 64);
                        weights.push(weight);
                    }
                }
            }
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.levels.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.levels.is_empty()
    }

    /// How many the levels up to one need; they are the first ones.
    pub fn count(&self, level: u32) -> usize {
        self.levels.partition_point(|&own| u32::from(own) <= level)
    }

    /// The lowest level that needs stencil `number`, which must be one.
    pub fn level(&self, number: usize) -> u32 {
        self.levels[number].into()
    }

    /// The corner of the face near which stencil `number` is relative to the limit, or whose limit it is. The sum is then taken relative to that corner's
    /// vertex, which has the same bits in all faces there; otherwise to the ring's first.
    pub fn corner(&self, number: usize) -> Option<u32> {
        self.corners[number].checked_sub(1).map(u32::from)
    }

    /// The weights of stencil `number`, one a vertex of the ring.
    pub fn weights(&self, number: usize) -> Dense {
        match &self.weights {
            Weights::Exact(weights) => weights[self.ring_size * number..][..self.ring_size].into(),
            Weights::Rounded { weights, .. } => {
                let (bits, start) = self.rounded_row(number);
                let mut own = weights[start..].iter();
                let mut dense = Dense::from_elem(0.0, self.ring_size);
                for (place, weight) in dense.iter_mut().enumerate() {
                    if bits[place / 64] >> (place % 64) & 1 != 0 {
                        *weight = (*own.next().expect("as many as bits")).into();
                    }
                }
                dense
            }
        }
    }

    /// The vertices of the ring that have a weight in stencil `number`, as shaders have it.
    pub(crate) fn terms(&self, number: usize) -> SmallVec<[(u16, f32); 32]> {
        let is_term = |&(_, weight): &(u16, f32)| weight != 0.0;
        match &self.weights {
            Weights::Exact(_) => {
                let weights = self.weights(number).into_iter();
                let weights = weights.map(|weight| weight as f32);
                (0..).zip(weights).filter(is_term).collect()
            }
            Weights::Rounded { weights, .. } => {
                let (bits, start) = self.rounded_row(number);
                let places = bits.iter().enumerate().flat_map(|(word, &bits)| {
                    let next = |&bits: &u64| Some(bits & bits.wrapping_sub(1));
                    let all = std::iter::successors(Some(bits), next);
                    let all = all.take_while(|&bits| bits != 0);
                    all.map(move |bits| (64 * word as u32 + bits.trailing_zeros()) as u16)
                });
                places.zip(weights[start..].iter().copied()).collect()
            }
        }
    }

    /// Bits and beginning of a stencil with rounded weights.
    fn rounded_row(&self, number: usize) -> (&[u64], usize) {
        let Weights::Rounded { places, starts, .. } = &self.weights else {
            return (&[], 0);
        };
        let words = self.ring_size.div_ceil(64);
        (&places[words * number..][..words], starts[number] as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_stencils_have_the_weights_that_shaders_have() {
        for ring_size in [1, 30, 64, 65, 200] {
            let weight = |number: usize, place: usize| match (place * 7 + number) % 3 {
                0 => 0.0,
                _ => (place as f64 - 3.1) / (number as f64 + 1.7),
            };
            let mut exact = Stencils::new(ring_size, true);
            for number in 0..5 {
                let corner = (number % 2 == 1).then_some(number as u32);
                let weights = (0..ring_size).map(|place| weight(number, place));
                exact.push(number as u32 / 2, corner, weights);
            }
            let mut rounded = Stencils::new(ring_size, false);
            for number in 0..5 {
                let (level, corner) = (exact.level(number), exact.corner(number));
                rounded.push(level, corner, exact.weights(number).into_iter());
            }
            assert_eq!((rounded.len(), rounded.count(1)), (5, 4));
            for number in 0..5 {
                assert_eq!(rounded.corner(number), exact.corner(number));
                let expected: Vec<f32> = (0..ring_size)
                    .map(|place| weight(number, place) as f32)
                    .collect();
                let dense = rounded.weights(number);
                assert!(
                    dense
                        .iter()
                        .map(|&weight| weight as f32)
                        .eq(expected.clone())
                );
                let terms = (0..).zip(expected).filter(|term| term.1 != 0.0);
                let terms: Vec<(u16, f32)> = terms.collect();
                assert_eq!(rounded.terms(number)[..], terms);
                assert_eq!(exact.terms(number)[..], terms);
            }
        }
    }
}
