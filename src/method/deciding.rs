//! What the device needs to decide about patches, see `glsl/decide.comp`.

use rustc_hash::FxHashMap;

use crate::abi;
use crate::method::{Outline, Pass, Table};

/// `PatchSides` of all patches of a pass, and the lists of vertices that these point into: the sides that patches have in common are there once.
pub(crate) fn deciding_tables(outline: &Outline, pass: &Pass) -> [Table; 2] {
    let mut lists: Vec<u32> = Vec::new();
    let mut known: FxHashMap<u32, u32> = FxHashMap::default();
    let mut list = |side: u32| {
        *known.entry(side).or_insert_with(|| {
            let first = lists.len() as u32;
            let vertices = outline.side(side);
            lists.push(vertices.len() as u32);
            lists.extend_from_slice(vertices);
            first
        })
    };
    let records = pass
        .sides
        .iter()
        .enumerate()
        .map(|(patch, sides)| abi::PatchSides {
            sides: sides.map(&mut list),
            hull: pass.hull(patch).len() as u32,
        });
    let records: Vec<abi::PatchSides> = records.collect();
    [Table::of(&records), Table::of(&lists)]
}
