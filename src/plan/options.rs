//! How plans are built.

use crate::error::{Error, Result};

/// How plans are built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlanOptions {
    /// The deepest level, 1..=10. Tess factors up to 2^max_level are evaluated exactly.
    pub max_level: u32,
    /// Whether single semi-sharp creases are evaluated directly (Brainerd et al. 2016, section 6.2) or refined away.
    pub direct_creases: bool,
}

impl Default for PlanOptions {
    /// Level 6 for tess levels up to 64, all that tessellators do at once, creases evaluated directly.
    fn default() -> PlanOptions {
        PlanOptions {
            max_level: 6,
            direct_creases: true,
        }
    }
}

impl PlanOptions {
    /// The highest `max_level`.
    pub const HIGHEST_LEVEL: u32 = 10;

    /// The `max_level` that a tess level needs: its binary logarithm, 1 at least.
    pub fn level_for(tess_level: f32) -> u32 {
        let greatest = (1u32 << PlanOptions::HIGHEST_LEVEL) as f32;
        let whole = tess_level.clamp(2.0, greatest).ceil() as u32;
        whole.next_power_of_two().ilog2()
    }

    /// Checks the range of `max_level`.
    ///
    /// # Errors
    /// [`Error::Option`] when it is not in 1..=10.
    pub fn check(self) -> Result<PlanOptions> {
        if (1..=Self::HIGHEST_LEVEL).contains(&self.max_level) {
            return Ok(self);
        }
        Err(Error::Option {
            option: "--max-level",
            problem: format!("{} is out of range", self.max_level),
            remedy: "give a level of 1 to 10; 6 serves every tess level up to 64".into(),
        })
    }
}
