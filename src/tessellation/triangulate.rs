//! Triangles from the vertices that the tessellator made of a patch.
//!
//! Vulkan fixes where the vertices lie but not how they are joined between the outer edges and the inside. This joins them by walking both
//! sides of that gap together. Inside, quads are a full grid, triangles are rings within one another.

use crate::tessellation::rings::{order, stitch};
use crate::tessellation::{Domain, Levels, Spacing, rings};

/// The triangles of a patch, counter-clockwise in (u, v), as numbers of its vertices `uv`, which may come in any order.
///
/// The outer edges may have different numbers of vertices; those inside must be as the tessellator makes them. There are no triangles where the
/// vertices are none of a patch: where a corner lacks, a coordinate is outside of 0..=1 or no number, or those inside have the wrong number.
pub fn triangulate(domain: Domain, uv: &[[f32; 2]]) -> Vec<[u32; 3]> {
    triangles(domain, None, uv)
}

/// The same of a patch whose levels are known: inside of a macro face there are not as many columns as rows.
pub(crate) fn triangulate_levels(
    levels: &Levels,
    spacing: Spacing,
    uv: &[[f32; 2]],
) -> Vec<[u32; 3]> {
    let [columns, _] = levels.inside_segments(spacing);
    let columns = (levels.cells != [1; 2]).then_some(columns as usize - 1);
    triangles(levels.domain, columns, uv)
}

fn triangles(domain: Domain, columns: Option<usize>, uv: &[[f32; 2]]) -> Vec<[u32; 3]> {
    // The corners of triangles come out of sums that round.
    let rounded = match domain {
        Domain::Quads => 0.0,
        Domain::Triangles => 1e-6,
    };
    let corners = &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]][..domain.corners()];
    let near = |[u, v]: [f32; 2], [x, y]: [f32; 2]| (u - x).abs().max((v - y).abs()) <= rounded;
    let has_corners = corners
        .iter()
        .all(|&corner| uv.iter().any(|&at| near(at, corner)));
    let in_range = |x: &f32| (-rounded..=1.0 + rounded).contains(x);
    if !has_corners || !uv.iter().flatten().all(in_range) {
        return Vec::new();
    }
    match domain {
        Domain::Quads => quad(uv, columns),
        Domain::Triangles => rings::triangle(uv),
    }
}

/// A row inside has so many vertices, or as many as there are rows.
fn quad(uv: &[[f32; 2]], columns: Option<usize>) -> Vec<[u32; 3]> {
    let is_edge = |x: f32| x == 0.0 || x == 1.0;
    let inside: Vec<u32> = numbers(uv, |[u, v]| !is_edge(u) && !is_edge(v));
    let is_full = match columns {
        Some(columns) => inside.len().is_multiple_of(columns),
        None => inside.len().isqrt().pow(2) == inside.len(),
    };
    if !is_full {
        return Vec::new();
    }
    let columns = columns.unwrap_or_else(|| inside.len().isqrt()).max(1);
    let rows = rows(uv, inside, columns);
    let mut triangles = grid(&rows);
    for side in 0..4 {
        let outer = numbers(uv, |at| turned(at, side)[1] == 0.0);
        let inner = inner_side(&rows, side);
        let along = |vertex: u32| turned(uv[vertex as usize], side)[0];
        stitch(
            along,
            &sorted(uv, outer, side),
            &sorted(uv, inner, side),
            &mut triangles,
        );
    }
    if rows.is_empty() {
        // All levels 1: the four corners.
        let corner = |u, v| numbers(uv, |at| at == [u, v])[0];
        let [a, b, c, d] = [
            corner(0.0, 0.0),
            corner(1.0, 0.0),
            corner(1.0, 1.0),
            corner(0.0, 1.0),
        ];
        triangles = vec![[a, b, c], [a, c, d]];
    }
    triangles
}

fn numbers(uv: &[[f32; 2]], choose: impl Fn([f32; 2]) -> bool) -> Vec<u32> {
    (0..uv.len() as u32)
        .filter(|&i| choose(uv[i as usize]))
        .collect()
}

/// (u, v) as seen with the given side of the square turned down: side 0 is v = 0, 1 is u = 1, 2 is v = 1, 3 is u = 0.
fn turned([u, v]: [f32; 2], side: usize) -> [f32; 2] {
    match side {
        0 => [u, v],
        1 => [v, 1.0 - u],
        2 => [1.0 - u, 1.0 - v],
        _ => [1.0 - v, u],
    }
}

fn sorted(uv: &[[f32; 2]], mut vertices: Vec<u32>, side: usize) -> Vec<u32> {
    vertices.sort_by(|&a, &b| {
        order(
            turned(uv[a as usize], side)[0],
            turned(uv[b as usize], side)[0],
        )
    });
    vertices
}

/// The inside vertices row by row, each sorted by u.
fn rows(uv: &[[f32; 2]], mut inside: Vec<u32>, columns: usize) -> Vec<Vec<u32>> {
    inside.sort_by(|&a, &b| order(uv[a as usize][1], uv[b as usize][1]));
    let rows = inside
        .chunks(columns)
        .map(|row| sorted(uv, row.to_vec(), 0));
    rows.collect()
}

fn grid(rows: &[Vec<u32>]) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for pair in rows.windows(2) {
        for (low, high) in pair[0].windows(2).zip(pair[1].windows(2)) {
            triangles.push([low[0], low[1], high[1]]);
            triangles.push([low[0], high[1], high[0]]);
        }
    }
    triangles
}

/// The inside vertices next to a side.
fn inner_side(rows: &[Vec<u32>], side: usize) -> Vec<u32> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return Vec::new();
    };
    match side {
        0 => first.clone(),
        1 => rows.iter().map(|row| row[row.len() - 1]).collect(),
        2 => last.clone(),
        _ => rows.iter().map(|row| row[0]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_patch_has_no_triangles() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        for domain in [Domain::Quads, Domain::Triangles] {
            let own = &corners[..domain.corners()];
            assert!(!triangulate(domain, own).is_empty());
            let with = |more: &[[f32; 2]]| triangulate(domain, &[own, more].concat());
            assert!(triangulate(domain, &[]).is_empty());
            assert!(triangulate(domain, &own[1..]).is_empty());
            assert!(with(&[[f32::NAN, 0.5]]).is_empty());
            assert!(with(&[[0.5, f32::INFINITY]]).is_empty());
            assert!(with(&[[0.5, 3e38]]).is_empty());
            // Two vertices inside are those of no level.
            assert!(with(&[[0.25, 0.25], [0.3, 0.25]]).is_empty());
            // Whatever comes, nothing but triangles of its vertices comes out.
            for seed in 0..2000u32 {
                let number =
                    |i: u32| (seed.wrapping_mul(2_654_435_761).rotate_left(i * 7) % 9) as f32 / 8.0;
                let odd: Vec<[f32; 2]> =
                    (0..seed % 12).map(|i| [number(i), number(i + 3)]).collect();
                let count = (own.len() + odd.len()) as u32;
                assert!(with(&odd).iter().flatten().all(|&vertex| vertex < count));
            }
        }
    }

    /// The vertices of a patch with the given segments on its edges and inside.
    fn vertices(edges: [u32; 4], inside: u32) -> Vec<[f32; 2]> {
        let at = |i: u32, n: u32| i as f32 / n as f32;
        let mut uv: Vec<[f32; 2]> = (1..inside)
            .flat_map(|y| (1..inside).map(move |x| [at(x, inside), at(y, inside)]))
            .collect();
        uv.extend((0..edges[0]).map(|i| [at(i, edges[0]), 0.0]));
        uv.extend((0..edges[1]).map(|i| [1.0, at(i, edges[1])]));
        uv.extend((0..edges[2]).map(|i| [1.0 - at(i, edges[2]), 1.0]));
        uv.extend((0..edges[3]).map(|i| [0.0, 1.0 - at(i, edges[3])]));
        uv
    }

    #[test]
    fn triangles_cover_the_square_once() {
        for (edges, inside) in [
            ([1; 4], 1),
            ([2; 4], 2),
            ([4, 2, 3, 1], 2),
            ([6, 5, 5, 6], 5),
            ([64, 1, 2, 64], 33),
        ] {
            let uv = vertices(edges, inside);
            let area = |[a, b, c]: [u32; 3]| {
                let [a, b, c] = [a, b, c].map(|i| glam::Vec2::from(uv[i as usize]).as_dvec2());
                0.5 * (b - a).perp_dot(c - a)
            };
            let areas: Vec<f64> = triangulate(Domain::Quads, &uv)
                .into_iter()
                .map(area)
                .collect();
            assert!(areas.iter().all(|&area| area > 0.0), "{edges:?} {inside}");
            assert!(
                (areas.iter().sum::<f64>() - 1.0).abs() < 1e-6,
                "{edges:?} {inside}"
            );
        }
    }
}
