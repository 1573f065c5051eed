//! What is known of the control points that a pose has cached.

use std::collections::VecDeque;

use crate::gpu::Tables;
use crate::gpu::kept_cache::CacheState;
use crate::method::Jobs;

/// What is known of a pose's cache.
#[derive(Debug)]
pub(super) struct Cache {
    /// The plan level up to which it has the points of the present positions; None where it has none.
    pub level: Option<u32>,
    /// By pass, what is still to be computed of these.
    pub left: VecDeque<(usize, Jobs)>,
    /// Of tables that are edited, the state that these points are of.
    pub state: Option<CacheState>,
    bytes: u64,
}

impl Cache {
    /// None where control points are not cached.
    pub fn new(tables: &Tables) -> Option<Cache> {
        let (deepest, points) = tables.cached()?;
        Some(Cache {
            level: None,
            left: VecDeque::new(),
            state: None,
            bytes: POINT_BYTES * u64::from(points.count(*deepest)),
        })
    }

    /// It has nothing.
    pub fn forget(&mut self) {
        self.level = None;
        self.left.clear();
    }

    /// How many points are left to be computed of those that it is to have.
    pub fn count_left(&self) -> u32 {
        self.left.iter().map(|(_, jobs)| jobs.count).sum()
    }

    /// Takes so many points of those that are left.
    pub fn take(&mut self, most: u32) -> Vec<(usize, Jobs)> {
        let (mut room, mut taken) = (most, Vec::new());
        while let Some((pass, jobs)) = self.left.pop_front() {
            let count = room.min(jobs.count);
            let rest = Jobs {
                first: jobs.first + count,
                first_point: jobs.first_point + count,
                count: jobs.count - count,
            };
            if count > 0 {
                taken.push((pass, Jobs { count, ..jobs }));
            }
            if rest.count > 0 {
                self.left.push_front((pass, rest));
                break;
            }
            room -= count;
        }
        taken
    }

    /// Whether it has room for the points of tables.
    pub fn has_room(&self, tables: &Tables) -> bool {
        Cache::new(tables).is_some_and(|needed| needed.bytes <= self.bytes)
    }

    /// Its bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Three floats.
const POINT_BYTES: u64 = 12;
