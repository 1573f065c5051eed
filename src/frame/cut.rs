//! How finely a surface is cut.

use crate::abi;
use crate::method::{Pass, Prepared, depth_at};
use crate::tessellation::{Levels, Spacing, levels, required_level};

/// How finely a surface is cut, the same for all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// The tess level of quads, 1..=64; up to 1024 with equal spacing, for surfaces that are [made for it](super::SurfaceOptions::greatest_level).
    pub level: f32,
    /// Spacing.
    pub spacing: Spacing,
}

impl Cut {
    /// The tess levels of a patch; None where there is no such patch, or its slot is vacant.
    pub fn levels(&self, pass: &Pass, patch: usize) -> Option<Levels> {
        if pass.is_vacant(patch) {
            return None;
        }
        // Where depths go by what a frame needs, all irregularities need the same.
        let patch = pass.at_depths(patch, |_| depth_at(self.level))?;
        let max_level = pass.max_level;
        Some(levels(
            pass.domain,
            &patch,
            self.level,
            self.spacing,
            max_level,
        ))
    }

    /// The points that a patch needs in the ring, or each piece of it; none where there is no such patch.
    pub fn points(&self, pass: &Pass, patch: usize) -> u32 {
        let levels = self.levels(pass, patch);
        levels.map_or(0, |levels| Cut::points_of(pass, patch, &levels))
    }

    /// The same at these levels.
    pub(super) fn points_of(pass: &Pass, patch: usize, levels: &Levels) -> u32 {
        pass.points(patch, required_level(levels, abi::HIGHEST_LEVEL))
    }

    /// The products of a weight and a vertex that these points take; none where there is no such patch.
    pub fn products(&self, pass: &Pass, patch: usize) -> u64 {
        let level = self.plan_level(pass, patch);
        level.map_or(0, |level| pass.products(patch, level))
    }

    /// The bytes of the least ring in which each pass of what was prepared is one batch, where nothing else bounds it: more gains nothing, and with
    /// less, down to what a single patch needs, there are more batches, each of which waits for the one before.
    pub fn ring_bytes(&self, prepared: &Prepared) -> u64 {
        let of_pass = |pass: &Pass| {
            let patches = 0..pass.patches.len();
            let points = patches.map(|patch| {
                let levels = self.levels(pass, patch);
                let depth = levels.map_or(0, |levels| levels.piece_depth());
                u64::from(self.points(pass, patch)) << (2 * depth)
            });
            points.sum::<u64>()
        };
        let passes = prepared.passes.iter();
        let ringed = passes.filter(|pass| !pass.scratch_points.is_empty());
        16 * ringed.map(of_pass).max().unwrap_or(0)
    }

    /// As the control shader has it: beside an n-gon the level may be more than what a plan of one level serves.
    fn plan_level(&self, pass: &Pass, patch: usize) -> Option<u32> {
        let level = |levels| required_level(&levels, abi::HIGHEST_LEVEL);
        self.levels(pass, patch).map(level)
    }

    /// The cut at which a cache has the control points of a plan level.
    fn of_plan_level(level: u32) -> Cut {
        Cut {
            level: (1u32 << level.min(abi::HIGHEST_LEVEL)) as f32,
            spacing: Spacing::Equal,
        }
    }

    /// The least plan level at which a cache has all control points that are drawn at this cut, or, where depth tags lower levels, at less.
    pub fn cached_level(&self, prepared: &Prepared) -> u32 {
        let passes = prepared.passes.iter();
        let cached = passes.filter(|pass| pass.cached.is_some());
        let levels = cached.map(|pass| self.cached_level_of(pass));
        levels.max().unwrap_or(0)
    }

    fn cached_level_of(&self, pass: &Pass) -> u32 {
        let enough = |&level: &u32| {
            let cached = Cut::of_plan_level(level);
            (0..pass.patches.len())
                .all(|patch| cached.plan_level(pass, patch) >= self.plan_level(pass, patch))
        };
        (0..abi::HIGHEST_LEVEL)
            .find(enough)
            .unwrap_or(abi::HIGHEST_LEVEL)
    }

    /// The vertices that the tessellator makes of a patch, or of its pieces; none where there is no such patch.
    pub fn vertices(&self, pass: &Pass, patch: usize) -> u32 {
        let levels = self.levels(pass, patch);
        levels.map_or(0, |levels| levels.vertices(self.spacing))
    }
}
