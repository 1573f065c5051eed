//! Adaptive refinement patterns: triangles that the host cuts instead of the tessellator (Boubekeur, Schlick 2007, section 3.2, after their
//! "Generic adaptive mesh refinement", GPU Gems 3, 2007).
//!
//! Levels are powers of two, so a triangle of depth d has the 4^d triangles of d splits in four. A patch lies on the lattice of its finest
//! edge. On coarser edges the lattice's points move to the nearest one that the edge has, and triangles without area go.

use crate::tessellation::{Domain, Levels};

/// The segments of an edge of the lattice that a patch's pattern lies on. Levels are powers of two; here and below what lies outside of 1..=64
/// counts as the end of that.
pub fn lattice_segments(levels: &Levels) -> u32 {
    segments(levels.greatest())
}

fn segments(level: f32) -> u32 {
    (level as u32).clamp(1, 64)
}

/// The vertices of a patch's pattern.
pub fn lattice_vertices(levels: &Levels) -> u32 {
    let n = lattice_segments(levels);
    let outer = levels.edges[..levels.domain.corners()].iter();
    let outer: u32 = outer.map(|&level| segments(level)).sum();
    let inner = match levels.domain {
        Domain::Quads => (n - 1) * (n - 1),
        Domain::Triangles => (n - 1) * n.saturating_sub(2) / 2,
    };
    outer + inner
}

/// The vertices of the rows of triangles that a patch's lattice consists of: each row a strip, with those that both of two rows have counted twice.
pub fn lattice_rows(levels: &Levels) -> u32 {
    let n = lattice_segments(levels);
    match levels.domain {
        Domain::Quads => n * 2 * (n + 1),
        Domain::Triangles => n * (n + 2),
    }
}

/// The triangles of a patch's pattern, counter-clockwise in (u, v), as places (i, j) on its lattice: (u, v) is (i, j) over
/// [`lattice_segments`].
pub fn pattern(levels: &Levels) -> Vec<[[u32; 2]; 3]> {
    let n = lattice_segments(levels);
    let mut triangles = Vec::new();
    let mut add = |places: [[u32; 2]; 3]| {
        let [a, b, c] = places.map(|place| snapped(levels, n, place));
        if a != b && b != c && c != a {
            triangles.push([a, b, c]);
        }
    };
    for j in 0..n {
        for i in 0..n {
            let [here, right, above, beyond] = [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]];
            match levels.domain {
                Domain::Quads => {
                    add([here, right, beyond]);
                    add([here, beyond, above]);
                }
                Domain::Triangles if i + j < n => {
                    add([here, right, above]);
                    if i + j + 1 < n {
                        add([right, beyond, above]);
                    }
                }
                Domain::Triangles => {}
            }
        }
    }
    triangles
}

/// Where a point of the lattice goes: on an edge to the nearest point that the edge has, from halfway to the one that comes next around the
/// patch, counter-clockwise. Were it another on two edges of a corner, a triangle could get all of its corners on the third edge. Twin of `snapped` in `glsl/surface.geom`.
fn snapped(levels: &Levels, n: u32, [i, j]: [u32; 2]) -> [u32; 2] {
    let step = |edge: usize| n / segments(levels.edges[edge]);
    let along = |at: u32, edge: usize| (at + step(edge) / 2) / step(edge) * step(edge);
    // Of edges that are counted from their end.
    let against = |at: u32, edge: usize| (at + (step(edge) - 1) / 2) / step(edge) * step(edge);
    match levels.domain {
        _ if j == 0 => [along(i, 0), 0],
        Domain::Quads if i == n => [n, along(j, 1)],
        Domain::Quads if j == n => [against(i, 2), n],
        Domain::Quads if i == 0 => [0, against(j, 3)],
        Domain::Triangles if i + j == n => {
            let j = along(j, 1);
            [n - j, j]
        }
        Domain::Triangles if i == 0 => [0, against(j, 2)],
        _ => [i, j],
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// All levels up to 16 for the edges of a domain.
    fn all(domain: Domain) -> impl Iterator<Item = Levels> {
        let depths = 5usize;
        (0..depths.pow(4)).filter_map(move |number| {
            let edges = [0, 1, 2, 3].map(|i| (1 << (number / depths.pow(i) % depths)) as f32);
            let levels = Levels {
                domain,
                cells: [1; 2],
                edges,
                inside: edges[..domain.corners()]
                    .iter()
                    .copied()
                    .fold(0.0, f32::max),
            };
            (domain == Domain::Quads || edges[3] == edges[2]).then_some(levels)
        })
    }

    #[test]
    fn every_pattern_covers_its_patch_once() {
        for domain in [Domain::Quads, Domain::Triangles] {
            for levels in all(domain) {
                let n = i64::from(lattice_segments(&levels));
                let areas: Vec<i64> = pattern(&levels)
                    .into_iter()
                    .map(|places| {
                        let [a, b, c] = places.map(|place| place.map(i64::from));
                        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
                    })
                    .collect();
                let whole = if domain == Domain::Quads { 2 } else { 1 };
                assert!(areas.iter().all(|&area| area > 0), "{levels:?}");
                assert_eq!(areas.iter().sum::<i64>(), whole * n * n, "{levels:?}");
            }
        }
    }

    #[test]
    fn patterns_have_the_vertices_of_their_edges_alone() {
        for domain in [Domain::Quads, Domain::Triangles] {
            for levels in all(domain) {
                let used: BTreeSet<[u32; 2]> = pattern(&levels).into_iter().flatten().collect();
                let on_first = used.iter().filter(|place| place[1] == 0).count();
                assert_eq!(on_first, levels.edges[0] as usize + 1, "{levels:?}");
                assert_eq!(used.len() as u32, lattice_vertices(&levels), "{levels:?}");
            }
        }
    }

    #[test]
    fn a_triangle_of_depth_d_has_4_to_the_d_triangles() {
        for depth in 0..=6 {
            let levels = |domain| Levels {
                domain,
                cells: [1; 2],
                edges: [(1 << depth) as f32; 4],
                inside: (1 << depth) as f32,
            };
            assert_eq!(pattern(&levels(Domain::Triangles)).len(), 4usize.pow(depth));
            assert_eq!(pattern(&levels(Domain::Quads)).len(), 2 * 4usize.pow(depth));
        }
    }
}
