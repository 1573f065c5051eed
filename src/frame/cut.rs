//! How finely a surface is cut.

use crate::abi;
use crate::method::Pass;
use crate::tessellation::{Levels, Spacing, levels, required_level};

/// How finely a surface is cut, the same for all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// The tess level of quads, 1..=64.
    pub level: f32,
    /// Spacing.
    pub spacing: Spacing,
}

impl Cut {
    /// The tess levels of a patch.
    pub fn levels(&self, pass: &Pass, patch: usize) -> Levels {
        levels(
            pass.domain,
            &pass.patches[patch],
            self.level,
            self.spacing,
            pass.max_level,
        )
    }

    /// The points that a patch needs in the ring.
    pub fn points(&self, pass: &Pass, patch: usize) -> u32 {
        pass.points(patch, self.plan_level(pass, patch))
    }

    /// The products of a weight and a vertex that these points take.
    pub fn products(&self, pass: &Pass, patch: usize) -> u64 {
        pass.products(patch, self.plan_level(pass, patch))
    }

    /// As the control shader has it: beside an n-gon the level may be more than what a plan of one level serves.
    fn plan_level(&self, pass: &Pass, patch: usize) -> u32 {
        required_level(&self.levels(pass, patch), abi::HIGHEST_LEVEL)
    }

    /// The vertices that the tessellator makes of a patch.
    pub fn vertices(&self, pass: &Pass, patch: usize) -> u32 {
        self.levels(pass, patch).vertices(self.spacing)
    }
}
