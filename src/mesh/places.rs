//! Numbers in the order in which they are first met, each once.
//!
//! Around a vertex are few: they are searched one by one, which is faster than hashing. Around a pole, or in an n-gon, there may be thousands, and
//! what searches them again and again would take the square of that.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// So many are searched one by one.
const FEW: usize = 24;

/// Gives numbers places, in the order in which they are first met.
#[derive(Clone, Debug, Default)]
pub(crate) struct Places {
    found: SmallVec<[u32; FEW]>,
    /// The place of each, once there are many.
    known: FxHashMap<u32, usize>,
}

impl Places {
    /// The place of a number, if it was met.
    pub fn find(&self, number: u32) -> Option<usize> {
        if self.known.is_empty() {
            return self.found.iter().position(|&found| found == number);
        }
        self.known.get(&number).copied()
    }

    /// The place of a number; the next one if it was not met before.
    pub fn of(&mut self, number: u32) -> usize {
        let next = self.found.len();
        let place = if next < FEW {
            let place = self.found.iter().position(|&found| found == number);
            place.unwrap_or(next)
        } else {
            if self.known.is_empty() {
                self.known = self.found.iter().copied().zip(0..).collect();
            }
            *self.known.entry(number).or_insert(next)
        };
        if place == next {
            self.found.push(number);
        }
        place
    }

    /// Adds a number. Whether it is new.
    pub fn add(&mut self, number: u32) -> bool {
        let next = self.found.len();
        self.of(number) == next
    }

    /// The numbers.
    pub fn found(&self) -> &[u32] {
        &self.found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_or_many_numbers_are_kept_once_and_in_order() {
        for count in [FEW - 1, FEW, FEW + 1, 1000] {
            let number = |i: usize| (i as u32).wrapping_mul(0x9e37_79b9);
            let mut places = Places::default();
            for i in 0..count {
                assert_eq!(places.find(number(i)), None, "{i} of {count}");
                assert!(places.add(number(i)), "{i} of {count}");
            }
            for i in 0..count {
                assert_eq!(places.find(number(i)), Some(i), "{i} of {count}");
                assert_eq!(places.of(number(i)), i, "{i} of {count}");
            }
            assert!(places.found().iter().copied().eq((0..count).map(number)));
        }
    }
}
