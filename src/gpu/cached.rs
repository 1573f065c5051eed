//! What is known of the control points that a pose has cached.

use crate::gpu::Tables;

/// What is known of a pose's cache.
#[derive(Debug)]
pub(super) struct Cache {
    /// The plan level up to which it has the points of the present positions; None where it has none.
    pub level: Option<u32>,
    bytes: u64,
}

impl Cache {
    /// None where control points are not cached.
    pub fn new(tables: &Tables) -> Option<Cache> {
        let (deepest, points) = tables.cached()?;
        Some(Cache {
            level: None,
            bytes: POINT_BYTES * u64::from(points.count(*deepest)),
        })
    }

    /// Its bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Three floats.
const POINT_BYTES: u64 = 12;
