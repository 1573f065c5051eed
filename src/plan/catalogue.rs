//! The configuration database: which configurations there are, and the plan of each (Brainerd et al. 2016, section 4.3).

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::plan::builder::{Plan, PlanOptions};
use crate::plan::configuration::Configuration;

/// Configurations by number, each once.
#[derive(Clone, Debug, Default)]
pub struct Catalogue {
    numbers: FxHashMap<Configuration, u32>,
}

impl Catalogue {
    /// The number of a configuration, a new one if it was not known.
    pub fn number(&mut self, configuration: Configuration) -> u32 {
        let next = self.numbers.len() as u32;
        *self.numbers.entry(configuration).or_insert(next)
    }

    /// How many configurations there are.
    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Builds the plan of every configuration, in parallel, in the order of their numbers.
    ///
    /// # Errors
    /// As [`Plan::build`].
    pub fn build(&self, options: PlanOptions) -> Result<Vec<Plan>> {
        let mut configurations: Vec<(&Configuration, u32)> =
            self.numbers.iter().map(|(c, &n)| (c, n)).collect();
        configurations.sort_unstable_by_key(|&(_, number)| number);
        configurations
            .into_par_iter()
            .map(|(configuration, _)| Plan::build(configuration, options))
            .collect()
    }
}
