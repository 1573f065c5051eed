//! What a cache of control points holds: each point once, for all faces that share it.

#[cfg(feature = "vulkan")]
use std::ops::Range;

use crate::abi;
#[cfg(feature = "vulkan")]
use crate::method::Update;
use crate::method::{Prepared, Table};

/// Levels of a cut, 0..=10.
const LEVELS: usize = abi::HIGHEST_LEVEL as usize + 1;

/// The points of a cache, those of lower plan levels first, and what it takes to compute and find them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CachedPoints {
    /// How many points the levels up to each have, behind what is computed beforehand ([`Prepared::points`]): two places a point.
    pub ends: [u32; LEVELS],
    /// The products of a weight and a vertex that these take.
    pub sums: [u64; LEVELS],
    /// The passes of what was prepared; empty for those whose points are not cached.
    pub passes: Vec<CachedPass>,
}

/// What a cache takes of one pass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CachedPass {
    /// Tables behind the method's own: where each patch's places begin, its places, and jobs.
    pub tables: Vec<Table>,
    /// Of each level the jobs, and the point that the first one computes; the others follow.
    pub jobs: [Jobs; LEVELS],
}

/// Jobs that compute points that follow one another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Jobs {
    /// The first job of the pass's.
    pub first: u32,
    /// How many.
    pub count: u32,
    /// The first point.
    pub first_point: u32,
}

impl CachedPoints {
    /// How many points there are up to a level.
    pub fn count(&self, level: u32) -> u32 {
        self.ends[(level as usize).min(LEVELS - 1)]
    }

    /// The products of a weight and a vertex that these take.
    pub fn products(&self, level: u32) -> u64 {
        self.sums[(level as usize).min(LEVELS - 1)]
    }
}

/// Keeps what a cache holds up with what was prepared.
#[cfg(feature = "vulkan")]
pub(crate) trait CacheEdits: std::fmt::Debug + Send + Sync {
    /// Brings the points up to an edit: those of patches that are other ones. The rest stays where it is. None where there is no room for them; the points are of no use
    /// then, nor is this.
    fn edit(
        &mut self,
        points: &mut CachedPoints,
        prepared: &Prepared,
        update: &Update,
    ) -> Option<CacheChange>;
}

/// What an edit changes of a cache.
#[cfg(feature = "vulkan")]
#[derive(Clone, Debug, Default)]
pub(crate) struct CacheChange {
    /// By pass, the tables that have changed, by their numbers among [`CachedPass::tables`], and in which words.
    pub words: Vec<Vec<(usize, Range<usize>)>>,
    /// The points that are to be computed: their pass, level and jobs.
    pub jobs: Vec<(usize, u32, Jobs)>,
}

/// What a cache holds, and what keeps it up with edits.
#[cfg(feature = "vulkan")]
pub(crate) type EditedPoints = (CachedPoints, Box<dyn CacheEdits>);

impl Prepared {
    /// The same as [`cached_points`](Self::cached_points), with room for points to come; None where that cannot be edited.
    #[cfg(feature = "vulkan")]
    pub(crate) fn edited_points(&self, level: u32) -> Option<EditedPoints> {
        let level = level.min(abi::HIGHEST_LEVEL).min(LEVELS as u32 - 1);
        self.recached.map(|of| of(self, level))
    }

    /// What a cache holds of control points up to a plan level; nothing where no pass has any.
    pub fn cached_points(&self, level: u32) -> CachedPoints {
        let level = level.min(abi::HIGHEST_LEVEL).min(LEVELS as u32 - 1);
        self.cached
            .map_or_else(CachedPoints::default, |of| of(self, level))
    }
}
