//! The stencils of a plan.

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
    pub fn weights(&self, number: usize) -> Vec<f64> {
        let mut weights = Vec::new();
        self.write_weights(number, &mut weights);
        weights
    }

    /// Writes the weights into a list, in the place of what is there.
    pub(super) fn write_weights(&self, number: usize, into: &mut Vec<f64>) {
        into.clear();
        match &self.weights {
            Weights::Exact(weights) => {
                into.extend_from_slice(&weights[self.ring_size * number..][..self.ring_size]);
            }
            Weights::Rounded { .. } => {
                into.resize(self.ring_size, 0.0);
                self.each_term(number, |place, weight| into[place] = weight.into());
            }
        }
    }

    /// How many vertices of the ring have a weight in stencil `number`, and which, as shaders have it.
    pub(crate) fn each_term(&self, number: usize, mut visit: impl FnMut(usize, f32)) -> usize {
        let mut count = 0;
        match &self.weights {
            Weights::Exact(weights) => {
                let row = weights[self.ring_size * number..][..self.ring_size].iter();
                for (place, weight) in row.map(|&weight| weight as f32).enumerate() {
                    if weight != 0.0 {
                        visit(place, weight);
                        count += 1;
                    }
                }
            }
            Weights::Rounded { weights, .. } => {
                let (bits, start) = self.rounded_row(number);
                let own = &weights[start..];
                for (word, &bits) in bits.iter().enumerate() {
                    let mut rest = bits;
                    while rest != 0 {
                        visit(64 * word + rest.trailing_zeros() as usize, own[count]);
                        count += 1;
                        rest &= rest - 1;
                    }
                }
            }
        }
        count
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
                let terms: Vec<(usize, f32)> = terms.collect();
                for stencils in [&rounded, &exact] {
                    let mut found = Vec::new();
                    let count =
                        stencils.each_term(number, |place, weight| found.push((place, weight)));
                    assert_eq!((count, &found), (terms.len(), &terms));
                }
            }
        }
    }
}
