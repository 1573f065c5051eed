//! Refinement patterns: which patch is drawn with which.

use rustc_hash::FxHashMap;

use crate::frame::Draw;
use crate::tessellation::{Domain, Levels, lattice_segments};

/// What a pattern depends on: the shape, and the levels of the edges.
pub(crate) type Key = (Domain, [u32; 4]);

/// The patterns of a draw list.
#[derive(Clone, Debug, Default)]
pub(super) struct Patterns {
    known: FxHashMap<Key, u32>,
    /// Levels that ask for each.
    pub all: Vec<Levels>,
}

impl Patterns {
    /// Sorts patches by the patterns that their levels ask for: an instance a patch, those with the same pattern in one draw. Returns the draws,
    /// and the patches in the order of instances; the first instance has the number of the first patch. Patches without levels come last, and are not drawn.
    pub fn arrange(
        &mut self,
        patches: std::ops::Range<u32>,
        levels: impl Fn(u32) -> Option<Levels>,
    ) -> (Vec<Draw>, Vec<u32>) {
        let mut first = patches.start;
        let mut vacant = Vec::new();
        let mut drawn: Vec<(Key, Levels, u32)> = Vec::with_capacity(patches.len());
        for patch in patches {
            match levels(patch) {
                Some(levels) => drawn.push((key(&levels), levels, patch)),
                None => vacant.push(patch),
            }
        }
        drawn.sort_by_key(|&((_, edges), _, patch)| (edges, patch));
        let mut draws = Vec::new();
        for run in drawn.chunk_by(|a, b| a.0 == b.0) {
            let instances = run.len() as u32;
            draws.push(Draw::Pattern {
                pattern: self.number(&run[0].1),
                first_instance: first,
                instances,
                segments: lattice_segments(&run[0].1),
            });
            first += instances;
        }
        let instances = drawn.into_iter().map(|(_, _, patch)| patch);
        (draws, instances.chain(vacant).collect())
    }

    fn number(&mut self, levels: &Levels) -> u32 {
        let all = &mut self.all;
        *self.known.entry(key(levels)).or_insert_with(|| {
            all.push(*levels);
            all.len() as u32 - 1
        })
    }
}

/// The pattern of a patch.
pub(crate) fn key(levels: &Levels) -> Key {
    (levels.domain, levels.edges.map(|level| level as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(edges: [f32; 3]) -> Levels {
        let [a, b, c] = edges;
        Levels {
            domain: Domain::Triangles,
            cells: [1; 2],
            edges: [a, b, c, c],
            inside: a.max(b).max(c),
        }
    }

    #[test]
    fn patches_with_the_same_tags_are_instances_of_one_pattern_which_is_made_once() {
        let edges = [
            [4.0, 4.0, 4.0],
            [4.0, 2.0, 4.0],
            [4.0, 4.0, 4.0],
            [4.0, 2.0, 4.0],
        ];
        let mut patterns = Patterns::default();
        let of = |patch: u32| (patch < 8).then(|| triangle(edges[patch as usize % 4]));
        let (draws, instances) = patterns.arrange(0..4, of);
        assert_eq!(instances, [1, 3, 0, 2]);
        let pattern = |pattern, first_instance| Draw::Pattern {
            pattern,
            first_instance,
            instances: 2,
            segments: 4,
        };
        assert_eq!(draws, [pattern(0, 0), pattern(1, 2)]);
        let (draws, instances) = patterns.arrange(4..9, of);
        assert_eq!(instances, [5, 7, 4, 6, 8], "nothing is drawn of the last");
        assert_eq!(draws, [pattern(0, 4), pattern(1, 6)]);
        assert_eq!(patterns.all.len(), 2);
    }
}
