//! What the device needs to decide about patches, see `glsl/decide.comp`.

use rustc_hash::FxHashMap;

use crate::abi;
use crate::method::{Outline, Pass, Table};

/// `PatchSides` of all patches of a pass, the lists of vertices that these point into, where the sides that patches have in common are there once, and the
/// stars of all vertices.
pub(crate) fn deciding_tables(outline: &Outline, pass: &Pass) -> [Table; 3] {
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
    let spline = if pass.is_spline { abi::HULL_SPLINE } else { 0 };
    let records = pass
        .sides
        .iter()
        .enumerate()
        .map(|(patch, sides)| abi::PatchSides {
            sides: sides.map(&mut list),
            hull: pass.hull(patch).len() as u32 | spline | pass.stage_flags(patch),
        });
    let records: Vec<abi::PatchSides> = records.collect();
    [
        Table::of(&records),
        Table::of(&lists),
        Table::of(&stars(outline, pass)),
    ]
}

/// For each vertex where its star begins, 0 for those that no side has; then the stars: how many faces there are around, and of each the vertex behind it
/// and the one before.
fn stars(outline: &Outline, pass: &Pass) -> Vec<u32> {
    let vertices = pass.sides.iter().flatten();
    let mut vertices: Vec<u32> = vertices
        .flat_map(|&side| outline.side(side).iter().copied())
        .collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut words = vec![0; vertices.last().map_or(0, |&last| last as usize + 1)];
    for vertex in vertices {
        let star = outline.star(vertex);
        words[vertex as usize] = words.len() as u32;
        words.push(star.len() as u32);
        words.extend(star.iter().flatten());
    }
    words
}
