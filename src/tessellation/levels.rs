//! Tess levels of a patch, a function of its edges alone on each edge. Twin of `glsl/lib/levels.glsl`.

use crate::abi;

/// Vulkan's spacing modes that keep vertices away from corners. Fractional-odd does not (see Brainerd et al. 2016, section 9.7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Spacing {
    /// Whole levels, equal steps.
    #[default]
    Equal,
    /// Any level; two short steps grow as the level does.
    FractionalEven,
}

impl Spacing {
    /// The number of segments that the tessellator makes of an edge of this level (Vulkan spec, "Tessellator Spacing").
    pub fn segments(self, level: f32) -> u32 {
        match self {
            Spacing::Equal => level.clamp(self.least(), 64.0).ceil() as u32,
            Spacing::FractionalEven => 2 * (level.clamp(self.least(), 64.0) / 2.0).ceil() as u32,
        }
    }

    /// The level within what the tessellator and plans of `max_level` levels can do: from [`least`](Self::least) to 2^`max_level` and at
    /// most 64.
    pub fn clamp(self, level: f32, max_level: u32) -> f32 {
        let greatest = (1u32 << max_level).min(64) as f32;
        level.clamp(self.least(), greatest.max(self.least()))
    }

    /// The least level: the tessellator raises lower ones to it.
    pub fn least(self) -> f32 {
        match self {
            Spacing::Equal => 1.0,
            Spacing::FractionalEven => 2.0,
        }
    }

    /// The name of the shader module's variant.
    pub fn name(self) -> &'static str {
        match self {
            Spacing::Equal => "equal",
            Spacing::FractionalEven => "fractional-even",
        }
    }
}

/// Tess levels of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// Of the edges from corner i to corner i + 1.
    pub edges: [f32; 4],
    /// Of the inside, in both directions.
    pub inside: f32,
}

/// The levels of a patch when quads have `level`, from the spacing's least to 2^`max_level` and at most 64.
///
/// Where a quad meets an n-gon, its edge gets twice the segments of the n-gon's half edge: 2k and k with equal spacing, 4k and 2k with
/// fractional-even (Brainerd et al. 2016, section 7.2).
pub fn levels(patch: &abi::Patch, level: f32, spacing: Spacing, max_level: u32) -> Levels {
    let level = spacing.clamp(level, max_level);
    let half = match spacing {
        Spacing::Equal => (level * 0.5).ceil(),
        Spacing::FractionalEven => 2.0 * (level * 0.25).ceil(),
    };
    if patch.flags & abi::PATCH_HALF != 0 {
        return Levels {
            edges: [half; 4],
            inside: half,
        };
    }
    let even = |edge: u32| patch.flags & abi::PATCH_EVEN_EDGE << edge != 0;
    Levels {
        edges: [0, 1, 2, 3].map(|edge| if even(edge) { 2.0 * half } else { level }),
        inside: level,
    }
}

impl Levels {
    /// The greatest of all.
    pub fn greatest(&self) -> f32 {
        self.edges.iter().copied().fold(self.inside, f32::max)
    }

    /// The vertices that the tessellator makes of a patch (Vulkan spec, "Quad Tessellation").
    pub fn vertices(&self, spacing: Spacing) -> u32 {
        let outer = self.edges.map(|level| spacing.segments(level));
        let inside = self.inside_segments(spacing);
        if inside == 1 {
            4
        } else {
            outer.iter().sum::<u32>() + (inside - 1) * (inside - 1)
        }
    }

    /// The triangles that the tessellator makes of a patch.
    pub fn triangles(&self, spacing: Spacing) -> u32 {
        let outer: u32 = self
            .edges
            .iter()
            .map(|&level| spacing.segments(level))
            .sum();
        let inside = self.inside_segments(spacing);
        if inside == 1 {
            2
        } else {
            outer + 4 * (inside - 2) + 2 * (inside - 2) * (inside - 2)
        }
    }

    /// An inside level of 1 counts as just over 1 unless all levels are 1.
    fn inside_segments(&self, spacing: Spacing) -> u32 {
        let inside = spacing.segments(self.inside);
        if inside == 1 && self.edges.iter().any(|&level| spacing.segments(level) > 1) {
            2
        } else {
            inside
        }
    }
}

/// The plan level that tess levels need: ceil(log2 of the greatest), at most `max_level`.
pub fn required_level(levels: &Levels, max_level: u32) -> u32 {
    (0..max_level)
        .find(|&level| (1u32 << level) as f32 >= levels.greatest())
        .unwrap_or(max_level)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACINGS: [Spacing; 2] = [Spacing::Equal, Spacing::FractionalEven];

    fn patch(flags: u32) -> abi::Patch {
        abi::Patch {
            flags,
            ..Default::default()
        }
    }

    /// Whole levels 1..=64 and some between.
    fn all_levels() -> impl Iterator<Item = f32> {
        (4..=256).map(|quarters| quarters as f32 / 4.0)
    }

    #[test]
    fn edges_have_the_same_segments_on_both_sides() {
        for (level, spacing, max_level) in all_levels()
            .flat_map(|l| SPACINGS.map(|s| (l, s)))
            .flat_map(|(l, s)| [1, 2, 4, 6].map(|m| (l, s, m)))
        {
            let quad = levels(&patch(abi::PATCH_EVEN_EDGE << 2), level, spacing, max_level);
            let half = levels(&patch(abi::PATCH_HALF), level, spacing, max_level);
            let place = format!("{level}, {spacing:?}, {max_level}");
            // Quads agree by the same number, n-gons' inner edges too.
            assert_eq!(quad.edges[0], quad.inside, "{place}");
            assert_eq!(half.edges, [half.inside; 4], "{place}");
            // An edge before an n-gon has its segments from two parts.
            assert_eq!(
                spacing.segments(quad.edges[2]),
                2 * spacing.segments(half.edges[0]),
                "{place}"
            );
        }
    }

    /// Both ways to make the segments put their vertices at the same places: equal steps, since each level is a whole even number.
    #[test]
    fn edges_beside_n_gons_have_equal_steps() {
        for (level, spacing) in all_levels().flat_map(|l| SPACINGS.map(|s| (l, s))) {
            let quad = levels(&patch(abi::PATCH_EVEN_EDGE), level, spacing, 6);
            let half = levels(&patch(abi::PATCH_HALF), level, spacing, 6);
            for level in [quad.edges[0], half.edges[0]] {
                assert_eq!(
                    level,
                    spacing.segments(level) as f32,
                    "{level}, {spacing:?}"
                );
            }
        }
    }

    #[test]
    fn levels_stay_within_what_the_plan_is_made_for() {
        for (level, max_level) in all_levels().flat_map(|l| (1..=6).map(move |m| (l, m))) {
            let quad = levels(
                &patch(abi::PATCH_EVEN_EDGE),
                level,
                Spacing::Equal,
                max_level,
            );
            assert!(quad.greatest() <= (1u32 << max_level) as f32);
            let needed = required_level(&quad, max_level);
            assert!(quad.greatest() <= (1u32 << needed) as f32);
            assert!(needed == 0 || quad.greatest() > (1u32 << (needed - 1)) as f32);
        }
    }
}
