//! Where the tables of a pass stand in one buffer.

use crate::abi;
use crate::method::pass::Pass;
use crate::method::table::Table;

/// Where a table begins in the buffer of its pass, in elements of its own, and its words.
struct Placed<'a> {
    base: usize,
    stride: usize,
    words: &'a [u32],
    /// The words that it may get besides.
    spare: usize,
}

/// The tables of a pass one behind the other, as they are on a device.
#[cfg(feature = "vulkan")]
pub(crate) struct Packed {
    /// The words of the buffer.
    pub words: Vec<u32>,
    /// Where its tables begin.
    pub bases: abi::Bases,
    /// The words that each table may take: patches, numbers of control vertices, texture coordinates, the method's own tables, and others.
    pub rooms: Vec<std::ops::Range<usize>>,
}

impl Placed<'_> {
    /// Where it begins and where it ends, in words.
    fn range(&self) -> std::ops::Range<usize> {
        let start = self.base * self.stride;
        start..start + self.words.len()
    }
}

impl Pass {
    /// Patches, numbers of control vertices, texture coordinates, the method's own tables, and others: each begins at a multiple of its elements' size.
    fn placed<'a>(&'a self, others: &'a [Table], spare: fn(usize) -> usize) -> Vec<Placed<'a>> {
        let shared = [
            (size_of::<abi::Patch>(), bytemuck::cast_slice(&self.patches)),
            (size_of::<u32>(), &self.controls[..]),
            (size_of::<[f32; 2]>(), bytemuck::cast_slice(&self.texture)),
        ];
        let shared = shared.map(|(bytes, words)| (bytes / 4, words));
        // Others begin behind all tables that a method may have.
        let missing = abi::TABLES as usize - self.tables.len().min(abi::TABLES as usize);
        let missing = if others.is_empty() { 0 } else { missing };
        let none = std::iter::repeat_n((1, &[][..]), missing);
        let table = |table: &'a Table| (table.stride.max(1), &table[..]);
        let own = self.tables.iter().map(table).chain(none);
        let own = own.chain(others.iter().map(table));
        let mut end = 0usize;
        let all = shared.into_iter().chain(own).map(|(stride, words)| {
            let base = end.div_ceil(stride);
            let placed = Placed {
                base,
                stride,
                words,
                spare: spare(words.len()),
            };
            end = placed.range().end + placed.spare;
            placed
        });
        all.collect()
    }

    /// The bytes that its tables take on a device, all in one buffer.
    pub fn table_bytes(&self) -> u64 {
        Self::bytes(&self.placed(&[], |_| 0))
    }

    fn bytes(placed: &[Placed<'_>]) -> u64 {
        let end = |last: &Placed<'_>| last.range().end + last.spare;
        placed.last().map_or(0, |last| 4 * end(last) as u64)
    }

    /// The words of that buffer, with other tables behind the method's own, and where its tables begin there.
    pub fn packed(&self, others: &[Table]) -> (Vec<u32>, abi::Bases) {
        self.pack(&self.placed(others, |_| 0))
    }

    /// The same with room in each table for what edits append.
    #[cfg(feature = "vulkan")]
    pub(crate) fn packed_with_room(&self, others: &[Table]) -> Packed {
        // What is there for good takes a quarter more, and an edit of a small mesh some kilobytes.
        let placed = self.placed(others, |words| words / 4 + 4096);
        let (words, bases) = self.pack(&placed);
        let room = |table: &Placed<'_>| table.range().start..table.range().end + table.spare;
        Packed {
            words,
            bases,
            rooms: placed.iter().map(room).collect(),
        }
    }

    fn pack(&self, placed: &[Placed<'_>]) -> (Vec<u32>, abi::Bases) {
        let mut words = vec![0; Self::bytes(placed) as usize / 4];
        for table in placed {
            words[table.range()].copy_from_slice(table.words);
        }
        let base = |number: usize| placed.get(number).map_or(0, |table| table.base as u32);
        let bases = abi::Bases {
            controls: base(1),
            texture: base(2),
            own: std::array::from_fn(|own| base(3 + own)),
            patches: self.patches.len() as u32,
        };
        (words, bases)
    }
}
