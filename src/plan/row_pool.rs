//! The rows of all plans of a database: sets and patterns that several plans have are there once, with numbers that never change.

use std::fmt;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

use crate::plan::lists::{KnownLists, Lists};
use crate::plan::stencil_rows::StencilRows;

/// Sets and patterns, which only ever grow more.
#[derive(Default)]
pub(super) struct RowPool {
    /// As in [`StencilRows`].
    pub sets: Lists,
    /// As in [`StencilRows`].
    pub patterns: Lists,
    known_sets: KnownLists,
    known_patterns: KnownLists,
}

impl RowPool {
    /// A plan's rows by the numbers of sets and patterns here.
    fn keep(&mut self, own: &StencilRows) -> Box<[[u32; 2]]> {
        let sets = own.sets.iter();
        let sets = sets.map(|set| self.known_sets.number(&mut self.sets, set));
        let sets: Vec<u32> = sets.collect();
        let patterns = own.patterns.iter();
        let patterns = patterns.map(|list| self.known_patterns.number(&mut self.patterns, list));
        let patterns: Vec<u32> = patterns.collect();
        let rows = own.rows.iter();
        rows.map(|row| StencilRows::renumbered(row, &sets, &patterns))
            .collect()
    }
}

/// A pool that plans share.
#[derive(Clone, Default)]
pub(super) struct SharedPool(Arc<RwLock<RowPool>>);

impl SharedPool {
    /// What it has now.
    pub fn read(&self) -> RwLockReadGuard<'_, RowPool> {
        self.0.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps the rows of plans.
    pub fn keep<'a>(&self, plans: impl Iterator<Item = &'a StencilRows>) -> Vec<PooledRows> {
        let mut pool = self.0.write().unwrap_or_else(PoisonError::into_inner);
        plans
            .map(|own| PooledRows {
                rows: pool.keep(own),
                pool: self.clone(),
            })
            .collect()
    }

    /// Whether two are one.
    pub fn is(&self, other: &SharedPool) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl fmt::Debug for SharedPool {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("SharedPool")
    }
}

/// A plan's rows, whose sets and patterns are in a pool.
#[derive(Clone, Debug)]
pub(super) struct PooledRows {
    /// As in [`StencilRows`], with the pool's numbers.
    pub rows: Box<[[u32; 2]]>,
    /// The pool.
    pub pool: SharedPool,
}

impl PooledRows {
    /// The weights of row `number` over a ring of so many vertices.
    pub fn weights(&self, number: usize, ring_size: usize) -> Vec<f64> {
        let pool = self.pool.read();
        let row = &self.rows[number];
        StencilRows::weights_of(row, &pool.sets, &pool.patterns, ring_size)
    }
}
