//! What edits change of the points that poses have cached.
//!
//! Tables know where points are and how they are computed; the points themselves are each pose's own. So an edit takes down which of them are to be computed again, and a
//! pose that has missed none of the last edits computes only these.

use std::collections::VecDeque;
use std::ops::Range;

use crate::method::{CacheEdits, CachedPoints, Jobs, Prepared, Update};

/// So many edits are remembered: a pose that comes later computes all points.
const REMEMBERED: usize = 64;

/// See the top of this file.
#[derive(Debug)]
pub(super) struct KeptCache {
    edits: Box<dyn CacheEdits>,
    /// The version of what was prepared in which everything was placed.
    made: u64,
    /// The version that it is of now.
    version: u64,
    /// The last edits' points, with the version that each led to.
    last: VecDeque<(u64, LevelJobs)>,
}

/// Jobs of passes and levels.
pub(super) type LevelJobs = Vec<(usize, u32, Jobs)>;

/// By pass, its tables and words that have changed, of those that a cache has.
pub(super) type CacheWords = Vec<Vec<(usize, Range<usize>)>>;

/// Which state of a cache a pose has the points of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CacheState {
    made: u64,
    version: u64,
}

impl KeptCache {
    /// Of a cache up to a plan level; None where points are not edited, but everything is made anew.
    pub fn new(prepared: &Prepared, deepest: u32) -> Option<(CachedPoints, KeptCache)> {
        let (points, edits) = prepared.edited_points(deepest)?;
        let kept = KeptCache {
            edits,
            made: prepared.version(),
            version: prepared.version(),
            last: VecDeque::new(),
        };
        Some((points, kept))
    }

    /// Brings the points up to an edit; tells which words are other ones, and nothing where there is no room.
    pub fn edit(
        &mut self,
        points: &mut CachedPoints,
        prepared: &Prepared,
        update: &Update,
    ) -> Option<CacheWords> {
        let change = self.edits.edit(points, prepared, update)?;
        self.version = prepared.version();
        self.last.push_back((self.version, change.jobs));
        if self.last.len() > REMEMBERED {
            self.last.pop_front();
        }
        Some(change.words)
    }

    /// What a pose is to have.
    pub fn state(&self) -> CacheState {
        CacheState {
            made: self.made,
            version: self.version,
        }
    }

    /// What a pose computes again that has the points of a state; None where that is all.
    pub fn since(&self, state: CacheState) -> Option<LevelJobs> {
        let next = state.version + 1;
        let knows = state.version == self.version
            || self.last.front().is_some_and(|&(first, _)| first <= next);
        if state.made != self.made || !knows {
            return None;
        }
        let later = self.last.iter().filter(|&&(version, _)| version >= next);
        Some(later.flat_map(|(_, jobs)| jobs.iter().copied()).collect())
    }
}
