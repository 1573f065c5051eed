//! Where the vertices lie that a tessellator makes of a patch, on the CPU (Vulkan spec, "Tessellator Spacing", "Quad Tessellation", "Triangle
//! Tessellation").
//!
//! With equal spacing they are where the specification puts them, to the last bit of an f32; devices may round otherwise where an edge's segments
//! are no power of two. Of fractional spacing it fixes counts and symmetry alone: here the two short segments grow from the middle of each half, as in
//! Direct3D's reference, by linear interpolation between the last even level and the next.

use glam::DVec3;

use crate::tessellation::{Domain, Levels, Spacing};

/// The vertices of a patch, by v and then u.
pub fn coordinates(levels: &Levels, spacing: Spacing) -> Vec<[f32; 2]> {
    let corners = levels.domain.corners();
    // Whole levels go by their segments: just over 1 is two of them, and each cell has as many.
    let of = |level: f32, segments: u32| match spacing {
        Spacing::Equal => cuts(spacing, segments as f32),
        Spacing::FractionalEven => cuts(spacing, level),
    };
    let inside = levels.inside_segments(spacing);
    let inside = inside.map(|segments| of(levels.inside, segments));
    let outer =
        (0..corners).map(|edge| of(levels.edges[edge], levels.edge_segments(edge, spacing)));
    let outer: Vec<Vec<f64>> = outer.collect();
    let mut found = match levels.domain {
        Domain::Quads => quad(&outer, &inside),
        Domain::Triangles => triangle(&outer, &inside[0]),
    };
    found.sort_by_key(|uv| [uv[1], uv[0]].map(f32::to_bits));
    found
}

/// Where an edge of this level is cut, from 0 to 1; the second half mirrors the first.
fn cuts(spacing: Spacing, level: f32) -> Vec<f64> {
    let segments = match spacing {
        // Of all cells of a side there may be more than 64.
        Spacing::Equal => level.ceil() as u32,
        _ => spacing.segments(level),
    };
    let near = |i: u32| match spacing {
        Spacing::Equal => f64::from(i) / f64::from(segments),
        Spacing::FractionalEven => fractional(i, segments / 2, f64::from(level) / 2.0),
    };
    let place = |i: u32| match 2 * i {
        twice if twice > segments => 1.0 - near(segments - i),
        _ => near(i),
    };
    (0..=segments).map(place).collect()
}

/// Vertex `i` of the first of two halves with `segments` each, of which so many and a fraction are whole.
fn fractional(i: u32, segments: u32, wanted: f64) -> f64 {
    let fewer = segments.saturating_sub(1);
    let share = wanted - f64::from(fewer);
    if fewer == 0 || share >= 1.0 {
        return 0.5 * f64::from(i) / f64::from(segments);
    }
    // The new vertex comes out of the one before it: the number without its highest bit, doubled, and one.
    let split = 2 * (fewer - (1 << fewer.ilog2())) + 1;
    let before = if i > split { i - 1 } else { i };
    let [from, to] = [(before, fewer), (i, segments)].map(|(i, n)| f64::from(i) / f64::from(n));
    0.5 * (from + share * (to - from))
}

/// Without both ends.
fn between(cuts: &[f64]) -> &[f64] {
    cuts.get(1..cuts.len() - 1).unwrap_or_default()
}

fn quad(outer: &[Vec<f64>], [along, across]: &[Vec<f64>; 2]) -> Vec<[f32; 2]> {
    let place = |edge: usize, t: f64| match edge {
        0 => [t, 0.0],
        1 => [1.0, t],
        2 => [1.0 - t, 1.0],
        _ => [0.0, 1.0 - t],
    };
    let edges = outer.iter().enumerate();
    let edges = edges.flat_map(|(edge, cuts)| {
        let without_end = &cuts[..cuts.len() - 1];
        without_end.iter().map(move |&t| place(edge, t))
    });
    let rows = between(across).iter();
    let grid = rows.flat_map(|&v| between(along).iter().map(move |&u| [u, v]));
    let all = edges.chain(grid);
    all.map(|uv| uv.map(|x| x as f32)).collect()
}

/// The outer edges by their own levels, inside triangles within one another: the corners of each stand where the lines perpendicular to two edges, from
/// the vertices next to their common corner, meet; it is cut by the perpendiculars from the others.
fn triangle(outer: &[Vec<f64>], inside: &[f64]) -> Vec<[f32; 2]> {
    // Barycentric: (0, 0), (1, 0), (0, 1) are the corners.
    let mut corners = [DVec3::X, DVec3::Y, DVec3::Z];
    let outline = |corners: [DVec3; 3], edge: usize, cuts: &[f64]| {
        let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
        let without_end = cuts[..cuts.len() - 1].iter();
        without_end.map(|&t| from.lerp(to, t)).collect::<Vec<_>>()
    };
    let mut found: Vec<DVec3> = Vec::new();
    for (edge, cuts) in outer.iter().enumerate() {
        found.extend(outline(corners, edge, cuts));
    }
    let mut cuts = inside.to_vec();
    while cuts.len() > 2 {
        let (first, last) = (cuts[1], cuts[cuts.len() - 2]);
        let span = if last > first { last - first } else { 1.0 };
        // In an equilateral triangle they meet at (1 - 4/3 t, 2/3 t, 2/3 t).
        corners = [0, 1, 2].map(|i| {
            let others = corners[(i + 1) % 3] + corners[(i + 2) % 3];
            corners[i] * (1.0 - 4.0 / 3.0 * first) + others * (2.0 / 3.0 * first)
        });
        cuts = between(&cuts).iter().map(|t| (t - first) / span).collect();
        match cuts.len() {
            1 => found.push(corners.iter().sum::<DVec3>() / 3.0),
            _ => (0..3).for_each(|edge| found.extend(outline(corners, edge, &cuts))),
        }
    }
    let uv = found.into_iter().map(|at| [at.y as f32, at.z as f32]);
    // No zero is negative.
    uv.map(|uv| uv.map(|x| x.max(0.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tessellation::triangulate;

    /// Whatever the levels: as many vertices as there are, each once, and triangles that cover the patch.
    #[test]
    fn coordinates_are_those_of_a_patch() {
        let steps = [1.0, 2.0, 2.5, 3.0, 4.0, 5.3, 7.0, 16.0, 63.0, 64.0];
        for domain in [Domain::Quads, Domain::Triangles] {
            for spacing in [Spacing::Equal, Spacing::FractionalEven] {
                for (i, &level) in steps.iter().enumerate() {
                    let edge = |j: usize| spacing.clamp(steps[(i * j) % steps.len()], 10);
                    let edges = match domain {
                        Domain::Quads => [0, 1, 2, 3].map(edge),
                        Domain::Triangles => [0, 1, 2, 2].map(edge),
                    };
                    let levels = Levels {
                        domain,
                        cells: [1; 2],
                        edges,
                        inside: spacing.clamp(level, 10),
                    };
                    let uv = coordinates(&levels, spacing);
                    assert_eq!(uv.len() as u32, levels.vertices(spacing), "{levels:?}");
                    assert!(uv.iter().all(|&at| domain.contains(at)), "{levels:?}");
                    let order = |pair: &[[f32; 2]]| {
                        let [[a, b], [c, d]] = [pair[0], pair[1]];
                        (b, a) < (d, c)
                    };
                    assert!(uv.windows(2).all(order), "{levels:?} {spacing:?}");
                    let triangles = triangulate(domain, &uv).len();
                    assert_eq!(triangles as u32, levels.triangles(spacing), "{levels:?}");
                }
            }
        }
    }

    #[test]
    fn edges_are_symmetric_and_equal_steps_are_equal() {
        for spacing in [Spacing::Equal, Spacing::FractionalEven] {
            for level in [2.0f32, 3.0, 4.7, 6.0, 9.9, 31.3, 64.0] {
                let cuts = cuts(spacing, level);
                let mirrored = cuts.iter().rev().map(|t| 1.0 - t);
                assert!(
                    cuts.iter()
                        .zip(mirrored)
                        .all(|(a, b)| (a - b).abs() < 1e-15)
                );
                assert!(cuts.windows(2).all(|pair| pair[0] < pair[1]), "{cuts:?}");
            }
        }
        assert_eq!(cuts(Spacing::Equal, 4.0), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(
            cuts(Spacing::FractionalEven, 4.0),
            [0.0, 0.25, 0.5, 0.75, 1.0]
        );
        // From 2 to 4 segments the new vertices come out of the ends.
        assert_eq!(
            cuts(Spacing::FractionalEven, 3.0),
            [0.0, 0.375, 0.5, 0.625, 1.0]
        );
    }
}
