//! The plans of a pass as its tables have them, each once. They only ever grow, and their numbers stay: so what is edited appends what it lacks.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::plan::database::{Entry, Kind};
use crate::plan::{Configuration, Database, PackedPlans, Plan, PlanOptions, Strip};

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

    /// Every plan.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().map(|entry| &**entry)
    }

    /// The numbers of the plans of what is wanted; new ones are packed in the order in which they are first wanted.
    ///
    /// # Errors
    /// As [`Database::plans`] and [`PackedPlans::push`].
    pub fn plans<'a>(
        &mut self,
        wanted: impl Iterator<Item = (Kind, &'a Configuration)>,
        options: PlanOptions,
        database: &Database,
    ) -> Result<Vec<u32>> {
        let mut known: FxHashMap<(Kind, &Configuration), u32> = FxHashMap::default();
        let mut firsts: Vec<(Kind, &Configuration)> = Vec::new();
        let number = |wanted| {
            *known.entry(wanted).or_insert_with(|| {
                firsts.push(wanted);
                firsts.len() as u32 - 1
            })
        };
        let places: Vec<u32> = wanted.map(number).collect();
        let mut found: Vec<Option<Arc<Entry>>> = vec![None; firsts.len()];
        for kind in Kind::ALL {
            let own = (0..firsts.len()).filter(|&i| firsts[i].0 == kind);
            let own: Vec<usize> = own.collect();
            let configurations: Vec<&Configuration> = own.iter().map(|&i| firsts[i].1).collect();
            let plans = database.plans(kind, options, &configurations)?;
            for (&i, (_, entry)) in own.iter().zip(plans) {
                found[i] = Some(entry);
            }
        }
        let numbers = found.into_iter().flatten().map(|entry| self.add(entry));
        let numbers: Vec<u32> = numbers.collect::<Result<_>>()?;
        Ok(places.iter().map(|&i| numbers[i as usize]).collect())
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
