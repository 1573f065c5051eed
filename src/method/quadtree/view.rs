//! The border of a patch, as the shaders read it.

use std::collections::BTreeSet;

use crate::abi;
use crate::method::Pass;

/// The method's own tables, in this order.
pub(super) const NODES: usize = 0;
pub(super) const POINTS: usize = 1;
pub(super) const ROWS: usize = 2;
pub(super) const SETS: usize = 3;
pub(super) const PATTERNS: usize = 4;
pub(super) const USES: usize = 5;
pub(super) const ENDS: usize = 6;
pub(super) const BORDERS: usize = 7;

/// A patch's border.
#[derive(Clone, Copy)]
pub(super) struct Border<'a> {
    pub record: &'a abi::Border,
    mirrored: bool,
    uses: &'a [abi::Use],
    ends: &'a abi::Ends,
}

impl<'a> Border<'a> {
    /// That of a patch of a pass.
    pub fn of(pass: &'a Pass, patch: usize) -> Border<'a> {
        let records: &[abi::Border] = bytemuck::cast_slice(&pass.tables[BORDERS]);
        let ends: &[abi::Ends] = bytemuck::cast_slice(&pass.tables[ENDS]);
        let abi::Patch { plan, flags, .. } = pass.patches[patch];
        let record = &records[plan as usize];
        Border {
            record,
            mirrored: flags & abi::PATCH_MIRRORED != 0,
            uses: bytemuck::cast_slice(&pass.tables[USES]),
            ends: &ends[record.ends as usize],
        }
    }

    /// What it is evaluated by: 0 inside, 1..=4 on an edge, 5..=8 at a corner.
    pub fn used(self, number: usize) -> &'a abi::Use {
        &self.uses[self.record.uses[number] as usize]
    }

    /// Whether the patch is the mirror image of what its inside's plan is for.
    pub fn is_mirrored(self) -> bool {
        self.mirrored
    }

    /// The use of the corner that a plan of the inside means by a `STENCIL_CORNER`.
    pub fn use_of_corner(self, corner: u32) -> u32 {
        if self.is_mirrored() {
            abi::STENCIL_CORNER + (4 - (corner - abi::STENCIL_CORNER)) % 4
        } else {
            corner
        }
    }

    /// Where the points of a use end in a slot of some plan level.
    pub fn end(self, level: u32, number: usize) -> u32 {
        ends_of(self.ends, level as usize)[number]
    }
}

/// Where the rows of all plans of insides begin.
pub(super) fn rows_of_insides(pass: &Pass) -> BTreeSet<u32> {
    let records: &[abi::Border] = bytemuck::cast_slice(&pass.tables[BORDERS]);
    let uses: &[abi::Use] = bytemuck::cast_slice(&pass.tables[USES]);
    let rows = records
        .iter()
        .map(|record| uses[record.uses[0] as usize].rows);
    rows.collect()
}

/// Where the points of each use end at a level.
pub(super) fn ends_of(ends: &abi::Ends, level: usize) -> [u32; abi::USES as usize] {
    let words = &ends.levels[level];
    std::array::from_fn(|number| words[number / 2] >> (16 * (number % 2)) & 0xffff)
}

/// A number for each level.
pub(super) type Levels<T> = [T; abi::HIGHEST_LEVEL as usize + 1];

/// The points of a patch's slot at each level, and the products of a weight and a vertex that these take. Of a corner's two points one is a normal, by two
/// tangents.
pub(super) fn sums(
    border: &abi::Border,
    uses: &[abi::Use],
    ends: &[abi::Ends],
) -> (Levels<u32>, Levels<u64>) {
    let mut sums: (Levels<u32>, Levels<u64>) = Default::default();
    for level in 0..sums.0.len() {
        let mut start = abi::USES + border.plain_count;
        let ends = ends_of(&ends[border.ends as usize], level);
        for (number, end) in ends.into_iter().enumerate() {
            let stencils = end - std::mem::replace(&mut start, end);
            let tangents = u32::from(number >= 5 && stencils > 0);
            let size = uses[border.uses[number] as usize].size;
            sums.1[level] += u64::from(size) * u64::from(stencils + tangents);
        }
        sums.0[level] = start;
    }
    sums
}
