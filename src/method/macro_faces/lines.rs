//! Levels of macro faces: which edges of the mesh have one.
//!
//! The tessellator makes a side of a macro face at once, in equal steps, so that a vertex is at each vertex of the mesh only if each of its edges has as many
//! segments. Therefore the edges of a side have one level; and whatever lies beyond must have the same, be it another macro face or some single ones. Where
//! sides lie offset to one another, as those of quartets may, the edges of both have one level, and so on: these edges are a *line*. Its level is the greatest
//! of those of its edges by themselves. So it depends on what its edges alone depend on, and all patches along it agree to the bit; no patch is coarser
//! than it would be by itself.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::abi;
use crate::mesh::faces::Faces;
use crate::method::{Pass, Prepared};
use crate::tessellation::cells;

/// Gives what was prepared its lines, and the sides of all patches that lie on one its number.
pub fn join_sides(prepared: &mut Prepared) {
    let edges = prepared.outline.edges();
    let mut groups = Groups((0..edges.len() as u32).collect());
    for pass in &prepared.passes {
        let found = (0..pass.patches.len()).filter(|&patch| is_macro(pass, patch));
        for side in found.flat_map(|patch| (0..4).map(move |side| edges_of(pass, patch, side))) {
            for pair in side.windows(2) {
                groups.join(pair[0], pair[1]);
            }
        }
    }
    let mut members: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for edge in 0..edges.len() as u32 {
        members.entry(groups.of(edge)).or_default().push(edge);
    }
    members.retain(|_, all| all.len() > 1);
    let first = prepared.outline.first_line();
    let mut lines: FxHashMap<u32, u32> = FxHashMap::default();
    for (number, all) in (first..).zip(members.values()) {
        lines.extend(all.iter().map(|&edge| (edge, number)));
    }
    let way = |all: &Vec<u32>| way(all.iter().map(|&edge| edges[edge as usize]));
    let ways: Vec<Vec<u32>> = members.values().map(way).collect();
    for pass in &mut prepared.passes {
        // Those of the cells tell the edges; they are left as they are.
        let macros: Vec<(usize, [u32; 4])> = (0..pass.patches.len())
            .filter(|&patch| is_macro(pass, patch))
            .map(|patch| {
                (
                    patch,
                    [0, 1, 2, 3].map(|side| edges_of(pass, patch, side)[0]),
                )
            })
            .collect();
        for (patch, sides) in macros {
            pass.sides[patch] = sides;
        }
        for side in pass.sides.iter_mut().flatten() {
            *side = lines.get(side).copied().unwrap_or(*side);
        }
    }
    let ways = ways.iter().map(Vec::as_slice);
    prepared.outline.add_lines(Faces::collect(ways));
}

fn is_macro(pass: &Pass, patch: usize) -> bool {
    pass.patches[patch].flags & abi::PATCH_MACRO != 0
}

/// The edges of the mesh along a side of a macro face, one a cell.
fn edges_of(pass: &Pass, patch: usize, side: usize) -> Vec<u32> {
    let count = cells(&pass.patches[patch])[side % 2];
    let edge = |cell: u32| {
        let middle = (cell as f32 + 0.5) / count as f32;
        let place = [[middle, 0.0], [1.0, middle], [middle, 1.0], [0.0, middle]][side];
        let (slot, [u, v]) = pass.face_at(patch, place);
        let own = match () {
            () if v == 0.0 => 0,
            () if u == 1.0 => 1,
            () if v == 1.0 => 2,
            () => 3,
        };
        pass.sides[slot][own]
    };
    (0..count).map(edge).collect()
}

/// Which edges are together: each with another of its group, or itself.
struct Groups(Vec<u32>);

impl Groups {
    /// An edge that stands for all of its group.
    fn of(&mut self, edge: u32) -> u32 {
        let mut at = edge;
        while self.0[at as usize] != at {
            let next = self.0[at as usize];
            // Every other one is passed over from now on.
            self.0[at as usize] = self.0[next as usize];
            at = next;
        }
        at
    }

    fn join(&mut self, a: u32, b: u32) {
        let [a, b] = [self.of(a), self.of(b)];
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// The vertices of a way along edges that hang together, along each of them there and back: its last edge ends where it begins.
fn way(edges: impl Iterator<Item = [u32; 2]>) -> Vec<u32> {
    let edges: Vec<[u32; 2]> = edges.collect();
    let mut around: FxHashMap<u32, SmallVec<[usize; 2]>> = FxHashMap::default();
    for (number, ends) in edges.iter().enumerate() {
        for &end in ends {
            around.entry(end).or_default().push(number);
        }
    }
    let mut is_met = vec![false; edges.len()];
    let mut way = Vec::with_capacity(2 * edges.len() + 1);
    let mut back = vec![edges[0][0]];
    while let Some(&at) = back.last() {
        way.push(at);
        let mut next = around[&at].iter();
        match next.find(|&&edge| !is_met[edge]) {
            Some(&edge) => {
                is_met[edge] = true;
                let [a, b] = edges[edge];
                back.push(if a == at { b } else { a });
            }
            None => {
                back.pop();
            }
        }
    }
    way.pop();
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a line with two ends, and of one without.
    #[test]
    fn a_way_goes_along_each_edge_there_and_back() {
        for edges in [vec![[3, 7], [1, 7], [3, 9]], vec![[1, 2], [3, 2], [1, 3]]] {
            let way = way(edges.iter().copied());
            let mut met: Vec<[u32; 2]> = (0..way.len())
                .map(|i| [way[i], way[(i + 1) % way.len()]])
                .collect();
            let mut expected: Vec<[u32; 2]> =
                edges.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
            met.sort_unstable();
            expected.sort_unstable();
            assert_eq!(met, expected);
        }
    }
}
