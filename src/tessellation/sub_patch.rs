//! Patches with more segments than a tessellator makes: they are cut into pieces, all alike, each of which is drawn by itself. Twin of `glsl/lib/sub_patch.glsl`.
//!
//! All that is drawn of a patch lies on one lattice, with as many segments as each row of pieces has together. Where the patch has other segments on an edge,
//! fewer or as many, the lattice's vertices there go to the nearest that the edge has: several to one, at least one to each. So no piece breaks a segment,
//! the neighbour has the same vertices whatever its own pieces are, and what lies between the edge and the lattice's next row is covered once: one of
//! each triangle's corners stands in that row, and those on the edge keep their order.
//!
//! All vertices are counted and none is taken as the tessellator places it: so patches that need no pieces have the same bits on their edges. That asks for
//! equal spacing: where vertices slide apart the specification does not fix where they are.

use crate::abi;
use crate::tessellation::{Domain, Levels, Piece, TESSELLATED};

impl Levels {
    /// How often the patch is halved before it is drawn, each way; 0 where a tessellator makes its segments at once.
    pub fn piece_depth(&self) -> u32 {
        if self.domain == Domain::Triangles {
            return 0;
        }
        let enough = |&depth: &u32| self.inside <= TESSELLATED * (1u32 << depth) as f32;
        let deepest = abi::HIGHEST_LEVEL - abi::TESSELLATED_LEVEL;
        (0..deepest).find(enough).unwrap_or(deepest)
    }

    /// The levels that a tessellator gets: those of each piece, or its own.
    pub fn of_pieces(&self) -> Levels {
        match self.piece_depth() {
            0 => *self,
            depth => {
                let level = self.inside / (1u32 << depth) as f32;
                Levels {
                    edges: [level; 4],
                    inside: level,
                    ..*self
                }
            }
        }
    }

    /// With as many segments inside as whole pieces have.
    pub(super) fn in_whole_pieces(self) -> Levels {
        let pieces = (1u32 << self.piece_depth()) as f32;
        match pieces {
            1.0 => self,
            _ => Levels {
                inside: pieces * (self.inside / pieces).ceil(),
                ..self
            },
        }
    }
}

/// Where (u, v) of a piece lies in its patch, as a tessellator has it that was given [`of_pieces`](Levels::of_pieces).
pub(crate) fn piece_coordinates(
    patch: &abi::Patch,
    levels: &Levels,
    piece: Piece,
    uv: [f32; 2],
) -> [f32; 2] {
    let segments = (levels.inside / (1u32 << piece.depth) as f32) as u32;
    let lattice = segments << piece.depth;
    let is_cut = piece.depth > 0;
    let first = [piece.column, piece.row].map(|place| place * segments);
    let vertex = |i: usize| first[i] + (uv[i] * segments as f32 + 0.5) as u32;
    let [low, high] = match is_cut {
        true => [0, 1].map(|end| [0, 1].map(|i| vertex(i) == end * lattice)),
        false => [[0, 1].map(|i| uv[i] <= 0.0), [0, 1].map(|i| uv[i] >= 1.0)],
    };
    let edge = match () {
        () if low[1] => 0,
        () if high[1] => 2,
        () if low[0] => 3,
        () if high[0] => 1,
        () if is_cut => return [0, 1].map(|i| step_of(vertex(i), lattice)),
        () => return uv,
    };
    let along = edge & 1;
    let on_edge = levels.edges[edge] as u32;
    let nearest = match is_cut {
        true => (2 * vertex(along) * on_edge + lattice) / (2 * lattice),
        false => (uv[along] * on_edge as f32 + 0.5) as u32,
    };
    let halved = patch.flags & abi::PATCH_EVEN_EDGE << edge != 0;
    let mut place = [
        if high[0] { 1.0 } else { 0.0 },
        if high[1] { 1.0 } else { 0.0 },
    ];
    place[along] = vertex_place(nearest, on_edge, halved);
    place
}

/// Where vertex `i` of an edge's is; where two patches lie beyond, each of them counts by itself.
fn vertex_place(i: u32, segments: u32, halved: bool) -> f32 {
    if !halved {
        return step_of(i, segments);
    }
    let half = segments / 2;
    match i > half {
        true => 0.5 + 0.5 * step_of(i - half, half),
        false => 0.5 * step_of(i, half),
    }
}

/// Vertex i of n on an edge, in steps of 2^-16; the steps from the other end are the same.
fn step_of(i: u32, n: u32) -> f32 {
    ((i * 65536 + n / 2) / n) as f32 * (1.0 / 65536.0)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::tessellation::{Spacing, coordinates, levels_of_edges, triangulate};

    fn levels(edges: [f32; 4], flags: u32) -> (abi::Patch, Levels) {
        let patch = abi::Patch {
            flags,
            ..Default::default()
        };
        let levels = levels_of_edges(Domain::Quads, &patch, edges, Spacing::Equal, 10);
        (patch, levels)
    }

    /// All that is drawn of a patch, in its own (u, v).
    fn triangles(patch: &abi::Patch, levels: &Levels) -> Vec<[[f32; 2]; 3]> {
        let uv = coordinates(&levels.of_pieces(), Spacing::Equal);
        let joined = triangulate(Domain::Quads, &uv);
        let pieces = Piece::all(levels.piece_depth());
        let of_piece = |piece: Piece| {
            let places = uv
                .iter()
                .map(|&at| piece_coordinates(patch, levels, piece, at));
            let places: Vec<[f32; 2]> = places.collect();
            let corners = |triangle: &[u32; 3]| triangle.map(|i| places[i as usize]);
            joined.iter().map(corners).collect::<Vec<_>>()
        };
        pieces.flat_map(of_piece).collect()
    }

    /// Twice the area, in steps of 2^-17: exact.
    fn area(corners: &[[f32; 2]; 3]) -> i64 {
        let [a, b, c] = corners.map(|at| at.map(|x| (x * 131_072.0) as i64));
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    #[test]
    fn pieces_cover_their_patch_once_and_have_the_vertices_of_its_edges_alone() {
        for edges in [
            [65.0; 4],
            [1.0, 100.0, 1.0, 3.0],
            [128.0, 1.0, 64.0, 37.0],
            [200.0, 7.0, 193.0, 1.0],
            [1.0, 1.0, 1.0, 300.0],
        ] {
            for flags in [0, abi::PATCH_EVEN_EDGE << 1 | abi::PATCH_EVEN_EDGE << 3] {
                let (patch, levels) = levels(edges, flags);
                let triangles = triangles(&patch, &levels);
                assert!(levels.piece_depth() > 0);
                assert_eq!(triangles.len() as u32, levels.triangles(Spacing::Equal));
                assert!(
                    triangles.iter().all(|corners| area(corners) >= 0),
                    "{levels:?}"
                );
                let whole: i64 = triangles.iter().map(area).sum();
                assert_eq!(whole, 2 * 131_072 * 131_072, "{levels:?}");
                let used: BTreeSet<[u32; 2]> = triangles
                    .iter()
                    .flatten()
                    .map(|at| at.map(f32::to_bits))
                    .collect();
                assert_eq!(used.len() as u32, levels.different_vertices(Spacing::Equal));
                for (edge, side) in [(0, 0.0f32), (1, 1.0), (2, 1.0), (3, 0.0)] {
                    let across = 1 - (edge & 1);
                    let on = used
                        .iter()
                        .filter(|at| at[across] == side.to_bits())
                        .count();
                    assert_eq!(on as f32, levels.edges[edge] + 1.0, "{levels:?} {edge}");
                }
            }
        }
    }

    /// A quad, cut or not, and the two parts of an n-gon beyond an edge of it; the quad on its other side.
    #[test]
    fn neighbours_have_the_same_bits_on_edges_whatever_their_pieces_are() {
        let on = |(patch, levels): (abi::Patch, Levels), edge: usize| {
            let corners = triangles(&patch, &levels).into_iter().flatten();
            let [along, across] = [edge & 1, 1 - (edge & 1)];
            let side = if edge == 1 || edge == 2 { 1.0 } else { 0.0 };
            let places = corners.filter(move |at| at[across] == side);
            places
                .map(|at| at[along].to_bits())
                .collect::<BTreeSet<u32>>()
        };
        for level in [1.0, 5.0, 37.0, 64.0, 65.0, 100.0, 129.0, 200.0] {
            for beside in [1.0, 90.0, 130.0] {
                let first = on(levels([level, beside, beside, beside], 0), 0);
                let second = on(levels([1.0, 1.0, level, 1.0], 0), 2);
                assert_eq!(first, second, "{level}");
                let quad = on(
                    levels([beside, level, 1.0, 1.0], abi::PATCH_EVEN_EDGE << 1),
                    1,
                );
                let part = on(levels([level, beside, 1.0, beside], abi::PATCH_HALF), 0);
                let halves = part.iter().flat_map(|&t| {
                    let t = 0.5 * f32::from_bits(t);
                    [t, 0.5 + t].map(f32::to_bits)
                });
                assert_eq!(quad, halves.collect(), "{level}");
            }
        }
    }
}
