//! Numbers in the order in which they are first met, each once.
//!
//! Around a vertex are few: these are in a small table, without a map's cost. Around a pole, or in an n-gon, there may be thousands, and every face there meets
//! all of them: these are marked in memory that one walk leaves to the next.

use std::cell::RefCell;

use smallvec::SmallVec;

/// So many are in the small table,
const FEW: usize = 40;
/// which has so many slots.
const SLOTS: usize = 128;

/// Gives numbers places, in the order in which they are first met. Numbers are of faces, edges or vertices of one mesh: the memory is as long as the greatest
/// where there are many.
#[derive(Debug)]
pub(crate) struct Places {
    found: SmallVec<[u32; 32]>,
    /// Places plus 1, each in the first free slot from its number's own on.
    slots: [u8; SLOTS],
    /// All of them, once there are many.
    marks: Option<Marks>,
}

/// By number, its place, and which walk has marked it.
#[derive(Debug, Default)]
struct Marks {
    walk: u32,
    places: Vec<(u32, u32)>,
}

thread_local! {
    /// What no walk uses now.
    static FREE: RefCell<Vec<Marks>> = const { RefCell::new(Vec::new()) };
}

impl Marks {
    fn new(found: &[u32]) -> Marks {
        let mut marks = FREE.with_borrow_mut(Vec::pop).unwrap_or_default();
        marks.walk = marks.walk.wrapping_add(1);
        if marks.walk == 0 {
            marks.places.clear();
            marks.walk = 1;
        }
        for (place, &number) in (0..).zip(found) {
            marks.set(number, place);
        }
        marks
    }

    fn get(&self, number: u32) -> Option<usize> {
        let &(walk, place) = self.places.get(number as usize)?;
        (walk == self.walk).then_some(place as usize)
    }

    fn set(&mut self, number: u32, place: u32) {
        let number = number as usize;
        if number >= self.places.len() {
            self.places.resize((number + 1).next_power_of_two(), (0, 0));
        }
        self.places[number] = (self.walk, place);
    }
}

impl Drop for Places {
    fn drop(&mut self) {
        if let Some(marks) = self.marks.take() {
            // At the thread's end they go.
            let _ = FREE.try_with(|free| free.borrow_mut().push(marks));
        }
    }
}

impl Default for Places {
    fn default() -> Places {
        Places {
            found: SmallVec::new(),
            slots: [0; SLOTS],
            marks: None,
        }
    }
}

impl Places {
    /// The slot in which a number is, or would be: two thirds of them are free at least.
    fn slot(&self, number: u32) -> usize {
        let mut slot = (number.wrapping_mul(0x9e37_79b9) >> 25) as usize;
        while self.slots[slot] != 0 && self.found[usize::from(self.slots[slot]) - 1] != number {
            slot = (slot + 1) % SLOTS;
        }
        slot
    }

    /// The place of a number; the next one if it was not met before.
    pub fn of(&mut self, number: u32) -> usize {
        let next = self.found.len();
        if next < FEW {
            let slot = self.slot(number);
            if let Some(place) = usize::from(self.slots[slot]).checked_sub(1) {
                return place;
            }
            self.slots[slot] = next as u8 + 1;
        } else {
            let found = &self.found;
            let marks = self.marks.get_or_insert_with(|| Marks::new(found));
            if let Some(place) = marks.get(number) {
                return place;
            }
            marks.set(number, next as u32);
        }
        self.found.push(number);
        next
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
        for count in [FEW - 1, FEW, FEW + 1, 1000, FEW + 2] {
            let number = |i: usize| (i as u32 * 7919) % 10_007;
            let mut places = Places::default();
            for i in 0..count {
                assert!(places.add(number(i)), "{i} of {count}");
            }
            for i in 0..count {
                assert_eq!(places.of(number(i)), i, "{i} of {count}");
            }
            assert!(places.found().iter().copied().eq((0..count).map(number)));
        }
    }
}
