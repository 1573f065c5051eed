//! The plans of a pass as its tables have them, each once. They only ever grow, and their numbers stay: so what is edited appends what it lacks.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::method::quadtree::configurations::Configurations;
use crate::plan::database::Entry;
use crate::plan::{Database, PackedPlans, Plan, PlanOptions, Strip};

/// Packed plans, by their numbers.
#[derive(Debug, Default)]
pub struct Store {
    /// The plans as shaders read them.
    pub packed: PackedPlans,
    /// What was packed; it keeps the addresses below its own.
    entries: Vec<Arc<Entry>>,
    /// The numbers by the addresses of entries: a database hands out the same entry for the same surroundings.
    numbers: FxHashMap<usize, u32>,
}

impl Store {
    /// The plan of a number.
    pub fn plan(&self, number: u32) -> &Plan {
        self.entry(number).plan()
    }

    /// The entry of a number.
    pub fn entry(&self, number: u32) -> &Entry {
        &self.entries[number as usize]
    }

    /// The plans as shaders read them, without what they were packed from.
    pub fn into_packed(self) -> PackedPlans {
        self.packed
    }

    /// Every plan.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().map(|entry| &**entry)
    }

    /// The numbers of the plans of configurations, by theirs; new ones are packed in the order in which they are first wanted.
    ///
    /// # Errors
    /// As [`Database::plans`] and [`PackedPlans::push`].
    pub fn plans(
        &mut self,
        wanted: Configurations,
        options: PlanOptions,
        database: &Database,
    ) -> Result<Vec<u32>> {
        let found = wanted.plans(options, database)?.into_iter();
        found.map(|entry| self.add(entry)).collect()
    }

    /// Packs the tree of an edge that a face evaluates with points of a plan's own, unless it is there; returns its root.
    pub fn push_strip(&mut self, plan: u32, strip: &Strip) -> u32 {
        self.packed
            .push_strip(self.entries[plan as usize].plan(), strip)
    }

    /// The number of an entry, which is packed if it is not known.
    fn add(&mut self, entry: Arc<Entry>) -> Result<u32> {
        let address = Arc::as_ptr(&entry) as usize;
        if let Some(&known) = self.numbers.get(&address) {
            return Ok(known);
        }
        self.packed.push(entry.plan())?;
        let number = self.entries.len() as u32;
        self.numbers.insert(address, number);
        self.entries.push(entry);
        Ok(number)
    }
}
