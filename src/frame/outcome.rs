//! What decisions about patches come to, counted.

use std::ops::AddAssign;

use rustc_hash::FxHashMap;

use crate::abi;
use crate::frame::patterns::{Key, key};
use crate::frame::{Culled, Cut, DrawList};
use crate::method::{Pass, Prepared};
use crate::tessellation::{Levels, required_level};

/// What was decided about patches, counted: of each as often as there are views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Patches that are drawn.
    pub drawn: u64,
    /// Patches outside of the picture.
    pub frustum: u64,
    /// Patches that show their backs.
    pub back: u64,
    /// Patches between samples.
    pub small: u64,
    /// Vertices of what is drawn, at least.
    pub vertices: u64,
    /// Its triangles, at least.
    pub triangles: u64,
    /// Points that control shaders compute for it, where there is a ring.
    pub points: u64,
    /// The products of a weight and a vertex that these take.
    pub products: u64,
    /// The greatest number of segments of an edge.
    pub segments: u32,
}

/// A level as tessellators may count it: in steps of 2^-16 (Direct3D 11.3 functional specification, section 14.3), so that what is above a whole number by
/// less may make no segment more.
fn counted(level: f32) -> f32 {
    level - 1.0 / 65536.0
}

impl Outcome {
    /// Of the decisions about a pass in one view, in the order of patches, for a list of this cut.
    pub fn of(pass: &Pass, records: &[abi::PatchDraw], cut: Cut) -> Outcome {
        let mut outcome = Outcome::default();
        let slots = records.iter().enumerate();
        // Those that are not drawn at the depth of the cut have no level, and nothing culls them.
        let is_decided = |record: &abi::PatchDraw| record.inside > 0.0 || record.slot != 0;
        for (patch, record) in
            slots.filter(|&(patch, record)| !pass.is_vacant(patch) && is_decided(record))
        {
            let levels = Levels {
                domain: pass.domain,
                cells: [1; 2],
                edges: record.edges,
                inside: record.inside,
            };
            let least = Levels {
                domain: pass.domain,
                cells: [1; 2],
                edges: levels.edges.map(counted),
                inside: counted(levels.inside),
            };
            match Culled::of(record.slot).filter(|_| record.inside == 0.0) {
                Some(Culled::Frustum) => outcome.frustum += 1,
                Some(Culled::Back) => outcome.back += 1,
                Some(Culled::Small) => outcome.small += 1,
                None => {
                    let vertices = least.vertices(cut.spacing);
                    let triangles = least.triangles(cut.spacing);
                    outcome.add(pass, patch, &levels, [vertices, triangles]);
                    let segments = cut.spacing.segments(least.greatest());
                    outcome.segments = outcome.segments.max(segments);
                }
            }
        }
        outcome
    }

    /// The same so many times.
    pub fn times(self, times: u64) -> Outcome {
        Outcome {
            drawn: times * self.drawn,
            frustum: times * self.frustum,
            back: times * self.back,
            small: times * self.small,
            vertices: times * self.vertices,
            triangles: times * self.triangles,
            points: times * self.points,
            products: times * self.products,
            segments: self.segments,
        }
    }

    /// Adds a patch that is drawn.
    fn add(&mut self, pass: &Pass, patch: usize, levels: &Levels, [vertices, triangles]: [u32; 2]) {
        let level = required_level(levels, abi::HIGHEST_LEVEL);
        self.drawn += 1;
        self.vertices += u64::from(vertices);
        self.triangles += u64::from(triangles);
        self.points += u64::from(pass.points(patch, level));
        self.products += pass.products(patch, level);
    }
}

impl DrawList {
    /// What the host decided: everything is drawn, and vertices are those that evaluating shaders run for. Of `prepared`, which the list was made for.
    pub fn outcome(&self, prepared: &Prepared) -> Outcome {
        let (backend, spacing) = (self.options().backend, self.cut().spacing);
        let mut outcome = Outcome::default();
        // Patterns are long to count.
        let mut patterns: FxHashMap<Key, u32> = FxHashMap::default();
        for (number, pass) in prepared.passes.iter().enumerate() {
            for patch in 0..pass.patches.len() {
                let Some(levels) = self.levels(prepared, number, patch as u32) else {
                    continue;
                };
                let count = || backend.triangles(&levels, spacing);
                let triangles = match backend.takes_any_level() {
                    true => count(),
                    false => *patterns.entry(key(&levels)).or_insert_with(count),
                };
                let vertices = backend.evaluations(&levels, spacing);
                outcome.add(pass, patch, &levels, [vertices, triangles]);
                outcome.segments = outcome.segments.max(levels.greatest_segments(spacing));
            }
        }
        outcome
    }
}

impl AddAssign for Outcome {
    fn add_assign(&mut self, other: Outcome) {
        self.drawn += other.drawn;
        self.frustum += other.frustum;
        self.back += other.back;
        self.small += other.small;
        self.vertices += other.vertices;
        self.triangles += other.triangles;
        self.points += other.points;
        self.products += other.products;
        self.segments = self.segments.max(other.segments);
    }
}
