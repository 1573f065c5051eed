//! Depth by patch: of methods that refine around each irregularity as far as a frame needs there. What is refined to all depths is prepared, and a frame draws
//! of it what its depths say.

use crate::abi;
use crate::method::stage::{ALWAYS, NOWHERE};
use crate::method::{IsolationOptions, Pass, Prepared};

/// The least depth of an irregularity: its faces are refined once, so that it is by itself.
const LEAST: u32 = abi::LEAST_DEPTH;

impl Pass {
    /// Whether a frame decides which of its patches are drawn.
    pub(crate) fn is_dynamic(&self) -> bool {
        !self.stages.is_empty()
    }

    /// Forgets when patches are drawn but for some, which are all that is left of them.
    #[cfg(feature = "host")]
    pub(crate) fn keep_stages(&mut self, kept: &[usize]) {
        if self.is_dynamic() {
            self.stages = kept.iter().map(|&patch| self.stages[patch]).collect();
        }
    }

    /// When the device draws a patch, which decides at one depth for all: `HULL_...` flags.
    #[cfg(feature = "vulkan")]
    pub(super) fn stage_flags(&self, patch: usize) -> u32 {
        match self.stages.get(patch).map(|stage| stage.depths) {
            None => 0,
            Some([_, u32::MAX]) => abi::HULL_DYNAMIC,
            Some(_) => abi::HULL_DYNAMIC | abi::HULL_SHALLOW,
        }
    }

    /// The record of a patch at depths of irregularities; None where it is not drawn at these, or there is no such patch.
    pub(crate) fn at_depths(&self, patch: usize, depth: impl Fn(u32) -> u32) -> Option<abi::Patch> {
        let record = *self.patches.get(patch)?;
        let Some(stage) = self.stages.get(patch) else {
            return Some(record);
        };
        let [from, to] = stage.depths;
        let of = |irregularity: u32| match irregularity {
            NOWHERE => LEAST,
            irregularity => depth(irregularity),
        };
        if !(from..=to).contains(&of(stage.irregularity)) {
            return None;
        }
        let is_halved = |edge: usize| match stage.beside[edge] {
            NOWHERE => false,
            ALWAYS => true,
            irregularity => depth(irregularity) > from,
        };
        let even = (0..4).filter(|&edge| is_halved(edge));
        let even = even.fold(0, |flags, edge| flags | abi::PATCH_EVEN_EDGE << edge);
        Some(abi::Patch {
            flags: record.flags & !(15 * abi::PATCH_EVEN_EDGE) | even,
            ..record
        })
    }
}

impl Prepared {
    /// Whether a frame decides how deep it is refined around each irregularity.
    pub fn is_dynamic(&self) -> bool {
        self.irregularities > 0
    }

    /// How often the mesh is refined around each irregularity where the sides of the [outline](Prepared::outline) have tess levels: as often as the greatest
    /// of its faces' needs, and once at least.
    pub(crate) fn depths_at(&self, level: impl Fn(u32) -> f32) -> Vec<u32> {
        let mut depths = vec![LEAST; self.irregularities as usize];
        for pass in &self.passes {
            for (stage, sides) in pass.stages.iter().zip(&pass.sides) {
                if stage.irregularity == NOWHERE || stage.depths[0] != LEAST {
                    continue;
                }
                let own = &mut depths[stage.irregularity as usize];
                for &side in sides {
                    *own = IsolationOptions::level_for(level(side)).max(*own);
                }
            }
        }
        depths
    }
}

/// The depth of all irregularities at a tess level.
pub(crate) fn depth_at(level: f32) -> u32 {
    IsolationOptions::level_for(level).max(LEAST)
}
