//! Regular quartets: four regular faces around a vertex, evaluated with five by five control vertices (Brainerd et al. 2016, section 7.3, figure 9). With one
//! level for all faces they may lie offset to one another.
//!
//! Greedily, the lowest vertex first, and after each quartet those two edges away from its middle: so regular regions are filled without gaps, however
//! their vertices are numbered.

use super::MacroFace;
use super::region::Region;
use crate::mesh::topology::FaceCorner;

/// The quartets.
pub fn find(region: &Region<'_>) -> Vec<MacroFace> {
    let topology = region.topology();
    let mut taken = vec![false; topology.face_count()];
    let mut found = Vec::new();
    for vertex in 0..topology.vertex_count() as u32 {
        let mut next = vec![vertex];
        while let Some(vertex) = next.pop() {
            let Some(around) = around(region, vertex, &taken) else {
                continue;
            };
            for side in around {
                taken[(side / 4) as usize] = true;
            }
            // Reversed, since the last is taken first.
            next.extend(
                around
                    .into_iter()
                    .rev()
                    .filter_map(|side| two_away(region, side)),
            );
            found.push(quartet(around));
        }
    }
    found.sort_by_key(|one| one.cells[0].face);
    found
}

/// The sides that begin at a vertex, counter-clockwise, if it is the middle of a quartet.
fn around(region: &Region<'_>, vertex: u32, taken: &[bool]) -> Option<[u32; 4]> {
    if !region.goes_on(vertex) {
        return None;
    }
    let first = region.topology().vertex_faces(vertex)[0];
    let mut sides = [4 * first.face + first.corner; 4];
    for i in 1..4 {
        sides[i] = region.smooth.around(sides[i - 1]);
    }
    let is_free = |side: &u32| {
        let face = side / 4;
        let is_regular = region.smooth.is_regular(face) && region.has(face);
        is_regular && !taken[face as usize] && !region.is_barred(*side)
    };
    let faces = sides.map(|side| side / 4);
    let is_met_twice = (1..4).any(|i| faces[..i].contains(&faces[i]));
    (sides.iter().all(is_free) && !is_met_twice).then_some(sides)
}

/// The vertex two edges straight on from the beginning of a side.
fn two_away(region: &Region<'_>, side: u32) -> Option<u32> {
    let end = region.start(Region::after(side, 1));
    let next = region.straight(side).filter(|_| region.goes_on(end))?;
    Some(region.start(Region::after(next, 1)))
}

/// The quartet around a vertex: its faces have it as corner 2, 3, 1, 0 of their cells.
fn quartet([right, above, left, below]: [u32; 4]) -> MacroFace {
    let cells = [(left, 2), (below, 1), (above, 3), (right, 0)];
    let cell = |(side, back): (u32, u32)| {
        let lower = Region::after(side, back);
        FaceCorner {
            face: lower / 4,
            corner: lower % 4,
        }
    };
    MacroFace {
        columns: 2,
        rows: 2,
        cells: cells.map(cell).into(),
    }
}
