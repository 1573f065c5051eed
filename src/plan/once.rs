//! Numbers as they are met, each once: found without hashing while they are few.

use rustc_hash::FxHashMap;

/// Lists up to this length are searched from their beginning; longer ones have a table.
const SHORT: usize = 32;

/// Numbers, each once, in the order in which they come.
#[derive(Default)]
pub(super) struct Once {
    /// All, in this order.
    pub all: Vec<u32>,
    /// Their places, once there are many.
    places: FxHashMap<u32, u32>,
}

impl Once {
    /// Nothing yet, with room for so many.
    pub fn with_capacity(count: usize) -> Once {
        Once {
            all: Vec::with_capacity(count),
            ..Once::default()
        }
    }

    /// The place of a number, if it is there.
    pub fn find(&self, number: u32) -> Option<u32> {
        if self.all.len() <= SHORT {
            let place = self.all.iter().position(|&known| known == number);
            return place.map(|place| place as u32);
        }
        self.places.get(&number).copied()
    }

    /// Its place, the next one if it is new; and whether it is.
    pub fn place(&mut self, number: u32) -> (u32, bool) {
        if let Some(place) = self.find(number) {
            return (place, false);
        }
        let place = self.all.len() as u32;
        self.all.push(number);
        if self.all.len() == SHORT + 1 {
            self.places = self.all.iter().copied().zip(0..).collect();
        } else if self.all.len() > SHORT {
            self.places.insert(number, place);
        }
        (place, true)
    }
}
