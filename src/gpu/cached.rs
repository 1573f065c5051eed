//! What is known of the control points that a pose has cached.

use crate::gpu::Tables;
use crate::gpu::kept_cache::CacheState;

/// What is known of a pose's cache.
#[derive(Debug)]
pub(super) struct Cache {
    /// The plan level up to which it has the points of the present positions; None where it has none.
    pub level: Option<u32>,
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
            state: None,
            bytes: POINT_BYTES * u64::from(points.count(*deepest)),
        })
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
