//! What an edit changes of what was prepared.

use std::ops::Range;

use crate::abi;
use crate::mesh::{ChangeSet, Model};
use crate::method::{Outline, Prepared};

/// Which words of a pass' tables are other ones: its patches, the numbers of control vertices, texture coordinates, and the method's own tables, in this order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PassChange {
    tables: Vec<Vec<Range<usize>>>,
    /// Slots of patches, ascending.
    slots: Vec<u32>,
}

/// What an edit did to what was prepared.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Update {
    /// Whether everything was prepared anew, or a pass has more patches than it had room for: what was made for it on a device is of no use any more.
    pub is_whole: bool,
    /// By pass, which words of its tables are other ones; nothing where all are.
    pub passes: Vec<PassChange>,
    /// Whether faces and vertices are other ones.
    is_reconnected: bool,
    /// The version that was edited.
    before: u64,
}

impl Update {
    /// An update of a version.
    pub(super) fn new(
        is_whole: bool,
        passes: Vec<PassChange>,
        before: u64,
        is_reconnected: bool,
    ) -> Update {
        Update {
            is_whole,
            passes,
            is_reconnected,
            before,
        }
    }

    /// The words of tables that are other ones.
    pub fn words(&self) -> usize {
        self.passes.iter().map(PassChange::words).sum()
    }

    /// The version that was edited.
    #[cfg(feature = "vulkan")]
    pub(crate) fn before(&self) -> u64 {
        self.before
    }
}

/// Words of a patch, and of its texture coordinates.
const PATCH_WORDS: usize = size_of::<abi::Patch>() / 4;
const TEXTURE_WORDS: usize = size_of::<[[f32; 2]; 4]>() / 4;

impl PassChange {
    /// The tables that have changed, by their numbers, and in which words.
    pub fn ranges(&self) -> impl Iterator<Item = (usize, Range<usize>)> + '_ {
        let tables = self.tables.iter().enumerate();
        tables.flat_map(|(table, ranges)| ranges.iter().map(move |range| (table, range.clone())))
    }

    /// The slots whose patches have changed, ascending.
    pub fn slots(&self) -> &[u32] {
        &self.slots
    }

    /// How many words there are.
    pub fn words(&self) -> usize {
        self.ranges().map(|(_, range)| range.len()).sum()
    }

    pub(super) fn patches(&mut self, mut slots: Vec<u32>) {
        slots.sort_unstable();
        slots.dedup();
        for &slot in &slots {
            let slot = slot as usize;
            self.add(0, PATCH_WORDS * slot..PATCH_WORDS * (slot + 1));
            self.add(2, TEXTURE_WORDS * slot..TEXTURE_WORDS * (slot + 1));
        }
        self.slots = slots;
    }

    pub(super) fn controls(&mut self, written: &[Range<u32>], appended: Range<usize>) {
        for range in written {
            self.add(1, range.start as usize..range.end as usize);
        }
        self.add(1, appended);
    }

    pub(super) fn own(&mut self, table: usize, appended: Range<usize>) {
        self.add(3 + table, appended);
    }

    fn add(&mut self, table: usize, range: Range<usize>) {
        if range.is_empty() {
            return;
        }
        if self.tables.len() <= table {
            self.tables.resize(table + 1, Vec::new());
        }
        let ranges = &mut self.tables[table];
        match ranges.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => ranges.push(range),
        }
    }
}

/// The sides of each pass's patches.
pub(super) type Sides = Vec<Vec<[u32; 4]>>;

impl Prepared {
    /// Gives the sides of all patches the numbers that edges have after an edit; tells those that they had.
    pub(super) fn renumber(&mut self, changes: &ChangeSet, model: &Model) -> Sides {
        if !changes.is_reconnected() {
            return Sides::new();
        }
        let before: Sides = self.passes.iter().map(|pass| pass.sides.clone()).collect();
        let (were, are) = (
            self.outline.edges().len() as u32,
            model.topology().edge_count() as u32,
        );
        let sides = self.passes.iter_mut().flat_map(|pass| &mut pass.sides);
        for side in sides.flatten() {
            *side = match side.checked_sub(were) {
                Some(face) => are + face,
                // Patches of an edge that is gone are planned again, or gone themselves.
                None => changes.edge(*side).unwrap_or(0),
            };
        }
        before
    }

    /// Takes sides back.
    pub(super) fn restore(&mut self, sides: Sides) {
        for (pass, sides) in self.passes.iter_mut().zip(sides) {
            pass.sides = sides;
        }
    }

    /// Takes over the faces and vertices of a model.
    pub(super) fn surround(&mut self, model: &Model) {
        let limits = self.outline.take_limits();
        self.outline = Outline::new(model.topology(), limits);
        for pass in &mut self.passes {
            pass.needs[0] = model.mesh().vertex_count();
        }
    }
}

#[cfg(feature = "vulkan")]
impl Prepared {
    /// Takes over what an update has changed in another one, which was as this one is.
    pub(crate) fn adopt(&mut self, edited: &Prepared, update: &Update) {
        let passes = self.passes.iter_mut().zip(&edited.passes);
        for ((own, edited), change) in passes.zip(&update.passes) {
            for &slot in change.slots() {
                let slot = slot as usize;
                own.patches[slot] = edited.patches[slot];
                own.texture[slot] = edited.texture[slot];
                own.sides[slot] = edited.sides[slot];
            }
            own.controls.resize(edited.controls.len(), 0);
            for (table, range) in change.ranges() {
                match table {
                    0 | 2 => {}
                    1 => own.controls[range.clone()].copy_from_slice(&edited.controls[range]),
                    table => own.tables[table - 3].adopt(&edited.tables[table - 3], range),
                }
            }
            let known = own.scratch_points.len();
            own.scratch_points
                .extend_from_slice(&edited.scratch_points[known..]);
            own.scratch_products
                .extend_from_slice(&edited.scratch_products[known..]);
        }
        if update.is_reconnected {
            self.outline = edited.outline.clone();
            for (own, edited) in self.passes.iter_mut().zip(&edited.passes) {
                own.sides.clone_from(&edited.sides);
                own.needs = edited.needs;
            }
        }
        self.outline.adopt_limits(&edited.outline);
        self.origin = edited.origin;
        self.plans = None;
    }
}
