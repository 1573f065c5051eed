//! Lists of words, one behind the other, and how they are told apart: without a box for each, which took most of the time of packing.

use std::hash::BuildHasher;

use hashbrown::HashTable;
use rustc_hash::FxBuildHasher;

/// Lists of words, by number.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lists {
    /// The words of all.
    pub words: Vec<u32>,
    /// Where each list ends.
    ends: Vec<u32>,
}

impl Lists {
    /// Those that end at these places; None where the words cannot be cut so.
    pub fn cut(words: &[u32], ends: &[u32]) -> Option<Lists> {
        let end = ends.last().copied().unwrap_or(0) as usize;
        (end == words.len() && ends.is_sorted()).then(|| Lists {
            words: words.to_vec(),
            ends: ends.to_vec(),
        })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Where list `number` begins among the words.
    pub fn start(&self, number: u32) -> u32 {
        match number {
            0 => 0,
            _ => self.ends[number as usize - 1],
        }
    }

    /// List `number`.
    pub fn get(&self, number: u32) -> &[u32] {
        &self.words[self.start(number) as usize..self.ends[number as usize] as usize]
    }

    /// All, in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.ends.len() as u32).map(|number| self.get(number))
    }

    /// Where each ends.
    pub fn ends(&self) -> &[u32] {
        &self.ends
    }

    /// Appends one; returns its number.
    pub fn push(&mut self, list: &[u32]) -> u32 {
        self.words.extend_from_slice(list);
        self.ends.push(self.words.len() as u32);
        self.ends.len() as u32 - 1
    }
}

/// Which lists are there, by their hashes; the lists themselves are elsewhere.
#[derive(Clone, Debug, Default)]
pub(super) struct KnownLists {
    /// Hash and number.
    table: HashTable<(u32, u32)>,
}

impl KnownLists {
    /// The number of a list, which is appended where it is not there yet.
    pub fn number(&mut self, lists: &mut Lists, list: &[u32]) -> u32 {
        let hash = FxBuildHasher.hash_one(list);
        let short = (hash >> 32) as u32;
        let is_it = |&(own, number): &(u32, u32)| own == short && lists.get(number) == list;
        match self.table.find(spread(short), is_it) {
            Some(&(_, number)) => number,
            None => {
                let number = lists.push(list);
                let entry = (short, number);
                self.table
                    .insert_unique(spread(short), entry, |&(own, _)| spread(own));
                number
            }
        }
    }

    /// Forgets all and keeps the memory.
    pub fn clear(&mut self) {
        self.table.clear();
    }
}

/// A hash whose upper and lower bits both count: the table looks at these.
fn spread(short: u32) -> u64 {
    u64::from(short) << 32 | u64::from(short)
}
