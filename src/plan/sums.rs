//! The vertices of a refinement level as sums over a ring.
//!
//! Around a pole, or in an n-gon, the vertex in the middle is a sum over the whole ring, and every vertex beside it contains the middle. As rows of weights
//! that is the square of the ring's size a level. So where rings are large, sums that are long stand once, as *hubs*, and others have a single term for
//! each: what is beside the middle is then short, however many there are.

use std::borrow::Cow;
use std::sync::Arc;

use crate::plan::rows::Rows;
use crate::subdivision::Mask;

/// In rings of up to so many vertices a row has a weight for each.
const SMALL: usize = 64;

/// Sums of more terms become hubs.
const LONG: usize = 48;

/// Sums over a ring.
#[derive(Clone)]
pub(super) enum Sums {
    /// Over a small one.
    Rows(Rows),
    /// Over a large one.
    Terms(Terms),
}

/// Sums by their terms.
#[derive(Clone)]
pub(super) struct Terms {
    /// The ring's vertices.
    width: usize,
    /// Where the terms of each sum end.
    ends: Vec<usize>,
    /// Weights of the ring's vertices, and behind these of the hubs.
    terms: Vec<(u32, f64)>,
    /// A weight for each of the ring's vertices.
    hubs: Vec<Arc<[f64]>>,
}

impl Sums {
    /// The vertices of the ring themselves.
    pub fn identity(width: usize) -> Sums {
        if width <= SMALL {
            return Sums::Rows(Rows::identity(width));
        }
        Sums::Terms(Terms {
            width,
            ends: (1..=width).collect(),
            terms: (0..width as u32).map(|vertex| (vertex, 1.0)).collect(),
            hubs: Vec::new(),
        })
    }

    /// How many vertices the ring has.
    pub fn width(&self) -> usize {
        match self {
            Sums::Rows(rows) => rows.width(),
            Sums::Terms(terms) => terms.width,
        }
    }

    /// The weights of a sum.
    pub fn row(&self, number: usize) -> Cow<'_, [f64]> {
        match self {
            Sums::Rows(rows) => Cow::Borrowed(rows.row(number)),
            Sums::Terms(terms) => {
                let mut row = vec![0.0; terms.width];
                terms.add_to(&mut row, &[(number as u32, 1.0)]);
                Cow::Owned(row)
            }
        }
    }

    /// Adds to a row what a mask makes of the sums.
    pub fn add_to(&self, row: &mut [f64], mask: &[(u32, f64)]) {
        match self {
            Sums::Rows(rows) => rows.add_to(row, mask),
            Sums::Terms(terms) => terms.add_to(row, mask),
        }
    }

    /// What masks make of the sums.
    pub fn next(&self, masks: &[Mask]) -> Sums {
        match self {
            Sums::Rows(rows) => Sums::Rows(rows.next(masks)),
            Sums::Terms(terms) => Sums::Terms(terms.next(masks)),
        }
    }
}

impl Terms {
    fn sum(&self, number: u32) -> &[(u32, f64)] {
        let number = number as usize;
        let start = number.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.terms[start..self.ends[number]]
    }

    fn add_to(&self, row: &mut [f64], mask: &[(u32, f64)]) {
        let mut shares = vec![0.0; self.hubs.len()];
        for &(number, weight) in mask {
            for &(place, own) in self.sum(number) {
                match row.get_mut(place as usize) {
                    Some(sum) => *sum += weight * own,
                    None => shares[place as usize - self.width] += weight * own,
                }
            }
        }
        for (hub, share) in self.hubs.iter().zip(shares).filter(|pair| pair.1 != 0.0) {
            for (sum, weight) in row.iter_mut().zip(hub.iter()) {
                *sum += share * weight;
            }
        }
    }

    fn next(&self, masks: &[Mask]) -> Terms {
        let mut next = Terms {
            width: self.width,
            ends: Vec::with_capacity(masks.len()),
            terms: Vec::with_capacity(16 * masks.len()),
            hubs: self.hubs.clone(),
        };
        let mut gathered = Gathered::new(self.width + self.hubs.len());
        for mask in masks {
            for &(number, weight) in mask {
                for &(place, own) in self.sum(number) {
                    gathered.add(place, weight * own);
                }
            }
            let start = next.terms.len();
            gathered.take(&mut next.terms);
            if next.terms.len() - start > LONG {
                next.terms.truncate(start);
                let mut hub = vec![0.0; self.width];
                self.add_to(&mut hub, mask);
                let place = (self.width + next.hubs.len()) as u32;
                next.hubs.push(hub.into());
                next.terms.push((place, 1.0));
            }
            next.ends.push(next.terms.len());
        }
        next
    }
}

/// Terms of a sum as they come, each place once.
struct Gathered {
    sums: Vec<f64>,
    is_met: Vec<bool>,
    met: Vec<u32>,
}

impl Gathered {
    fn new(places: usize) -> Gathered {
        Gathered {
            sums: vec![0.0; places],
            is_met: vec![false; places],
            met: Vec::new(),
        }
    }

    fn add(&mut self, place: u32, weight: f64) {
        let at = place as usize;
        if !std::mem::replace(&mut self.is_met[at], true) {
            self.met.push(place);
        }
        self.sums[at] += weight;
    }

    /// Hands the terms out, and begins anew.
    fn take(&mut self, terms: &mut Vec<(u32, f64)>) {
        for place in self.met.drain(..) {
            let at = place as usize;
            self.is_met[at] = false;
            let weight = std::mem::take(&mut self.sums[at]);
            if weight != 0.0 {
                terms.push((place, weight));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fan whose middle takes in everything, level by level: the same weights, however they are kept; and beside the middle no sum is long.
    #[test]
    fn sums_by_terms_are_those_by_rows_and_short_but_for_hubs() {
        let n = 200u32;
        let beside = |i: u32| 1 + i % n;
        let mut masks = vec![Mask::new()];
        masks[0].push((0, 0.5));
        masks[0].extend((0..n).map(|i| (beside(i), 0.5 / f64::from(n))));
        masks.extend((0..n).map(|i| -> Mask {
            [(0, 0.25), (beside(i), 0.5), (beside(i + 1), 0.25)]
                .into_iter()
                .collect()
        }));
        let width = n as usize + 1;
        let mut rows = Sums::Rows(Rows::identity(width));
        let mut terms = Sums::identity(width);
        for _ in 0..6 {
            (rows, terms) = (rows.next(&masks), terms.next(&masks));
        }
        for number in 0..width {
            let (a, b) = (rows.row(number), terms.row(number));
            assert!(
                a.iter().zip(b.iter()).all(|(a, b)| (a - b).abs() < 1e-13),
                "{number}"
            );
        }
        let Sums::Terms(terms) = terms else {
            panic!("the ring is large");
        };
        assert_eq!(terms.hubs.len(), 6);
        assert!(terms.terms.len() < 20 * width, "{}", terms.terms.len());
    }
}
