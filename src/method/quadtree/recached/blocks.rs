//! Places of a cache that is edited, and what an edit writes.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::method::cached::{CacheChange, CachedPoints, Jobs};

/// The places of a pass and level.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    pub first_job: u32,
    pub first_point: u32,
    pub room: u32,
    /// Those up to here have jobs.
    pub used: u32,
}

/// What has been written.
pub(super) struct Change {
    /// By pass and table, where words were written; nothing where nobody will ask.
    words: Vec<[BTreeSet<(usize, usize)>; 3]>,
    /// Places that are to be computed: pass, level, and where in the block.
    jobs: BTreeSet<(usize, usize, u32)>,
}

impl Change {
    /// Of so many passes; of none where nobody will ask.
    pub fn new(passes: usize) -> Change {
        Change {
            words: vec![Default::default(); passes],
            jobs: BTreeSet::new(),
        }
    }

    /// Writes words at a place of a table of a pass.
    pub fn write(&mut self, made: &mut CachedPoints, at: (usize, usize, usize), words: &[u32]) {
        let (pass, table, place) = at;
        made.passes[pass].tables[table].write(place, words);
        if let Some(tables) = self.words.get_mut(pass) {
            tables[table].insert((place, place + words.len()));
        }
    }

    /// Says that some places of a block are to be computed.
    pub fn compute(&mut self, pass: usize, level: usize, places: Range<u32>) {
        if pass < self.words.len() {
            self.jobs.extend(places.map(|at| (pass, level, at)));
        }
    }

    pub fn finish(self, blocks: &[Vec<Block>]) -> CacheChange {
        let of_pass = |tables: [BTreeSet<(usize, usize)>; 3]| {
            let tables = tables.into_iter().enumerate();
            let ranges = tables.flat_map(|(table, all)| {
                all.into_iter().map(move |(start, end)| (table, start..end))
            });
            ranges.collect()
        };
        let mut jobs: Vec<(usize, u32, Jobs)> = Vec::new();
        for (pass, level, at) in self.jobs {
            let block = blocks[pass][level];
            let own = Jobs {
                first: block.first_job + at,
                count: 1,
                first_point: block.first_point + at,
            };
            match jobs.last_mut() {
                Some((of, at_level, last))
                    if (*of, *at_level) == (pass, level as u32)
                        && last.first + last.count == own.first =>
                {
                    last.count += 1;
                }
                _ => jobs.push((pass, level as u32, own)),
            }
        }
        CacheChange {
            words: self.words.into_iter().map(of_pass).collect(),
            jobs,
        }
    }
}
