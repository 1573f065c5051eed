//! Configurations that plans are wanted for.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::plan::database::{Entry, Kind};
use crate::plan::{Configuration, Database, PlanOptions};

/// Configurations, each once, by numbers of their own.
#[derive(Default)]
pub struct Configurations(FxHashMap<(Kind, Configuration), u32>);

impl Configurations {
    /// The number of a configuration.
    pub fn number(&mut self, kind: Kind, configuration: Configuration) -> u32 {
        let next = self.0.len() as u32;
        *self.0.entry((kind, configuration)).or_insert(next)
    }

    /// Their plans, by these numbers.
    ///
    /// # Errors
    /// As [`Database::plans`].
    pub fn plans(self, options: PlanOptions, database: &Database) -> Result<Vec<Arc<Entry>>> {
        let mut wanted: Vec<(Kind, u32, Configuration)> = self
            .0
            .into_iter()
            .map(|((kind, configuration), number)| (kind, number, configuration))
            .collect();
        wanted.sort_unstable_by_key(|&(kind, number, _)| (kind, number));
        let mut plans: Vec<Option<Arc<Entry>>> = vec![None; wanted.len()];
        for own in wanted.chunk_by(|one, other| one.0 == other.0) {
            let configurations = own.iter().map(|(.., configuration)| configuration);
            let configurations: Vec<&Configuration> = configurations.collect();
            let found = database.plans(own[0].0, options, &configurations)?;
            for (&(_, number, _), (_, entry)) in own.iter().zip(found) {
                plans[number as usize] = Some(entry);
            }
        }
        Ok(plans.into_iter().flatten().collect())
    }
}
