//! Triangles of a triangular patch: its vertices lie on rings within one another (Vulkan spec, "Triangle Tessellation").

use std::cmp::Ordering;

use crate::tessellation::levels::{inner_rings, ring_vertices};

/// The distances from the edges 0 (from corner 0 to corner 1), 1 and 2.
fn distances([u, v]: [f32; 2]) -> [f32; 3] {
    [v, 1.0 - u - v, u]
}

/// How far along side `side` a point lies, from its first corner to its second.
fn along(side: usize, uv: [f32; 2]) -> f32 {
    let to_edges = distances(uv);
    to_edges[(side + 2) % 3] - to_edges[(side + 1) % 3]
}

/// The sides of a ring, each with both of its corners, sorted from the first to the second.
type Ring = [Vec<u32>; 3];

/// The triangles of a patch with the vertices `uv`.
pub fn triangle(uv: &[[f32; 2]]) -> Vec<[u32; 3]> {
    let (rim, mut inside): (Vec<u32>, Vec<u32>) =
        (0..uv.len() as u32).partition(|&i| distances(uv[i as usize]).iter().any(|d| *d <= 1e-7));
    let rings = segments_for(inside.len());
    let wanted: u32 = inner_rings(rings).map(ring_vertices).sum();
    if wanted as usize != inside.len() {
        return Vec::new();
    }
    let mut triangles = Vec::new();
    let mut outer = rim_of(uv, &rim);
    inside.sort_by(|&a, &b| order(depth(uv, a), depth(uv, b)));
    let mut rest = &inside[..];
    for segments in inner_rings(rings) {
        let (own, deeper) = rest.split_at(ring_vertices(segments) as usize);
        rest = deeper;
        let inner = ring_of(uv, own);
        for side in 0..3 {
            let place = |vertex: u32| along(side, uv[vertex as usize]);
            stitch(place, &outer[side], &inner[side], &mut triangles);
        }
        outer = inner;
    }
    if outer.iter().all(|side| side.len() == 2) {
        triangles.push([outer[0][0], outer[1][0], outer[2][0]]);
    }
    triangles
}

/// How deep a vertex lies.
fn depth(uv: &[[f32; 2]], vertex: u32) -> f32 {
    distances(uv[vertex as usize])
        .into_iter()
        .fold(f32::MAX, f32::min)
}

/// The inside level that makes so many vertices inside.
fn segments_for(inside: usize) -> u32 {
    let vertices = |segments: u32| inner_rings(segments).map(ring_vertices).sum::<u32>() as usize;
    (1..=64)
        .find(|&segments| vertices(segments) >= inside)
        .unwrap_or(64)
}

/// The sides of the patch itself.
fn rim_of(uv: &[[f32; 2]], rim: &[u32]) -> Ring {
    [0, 1, 2].map(|side| {
        let own = rim.iter().copied();
        let own = own.filter(|&i| distances(uv[i as usize])[side] <= 1e-7);
        sorted(uv, side, own.collect())
    })
}

/// The sides of an inner ring: its vertices as seen from the middle, a third of the turn a side.
fn ring_of(uv: &[[f32; 2]], vertices: &[u32]) -> Ring {
    let count = vertices.len() / 3;
    [0, 1, 2].map(|side| {
        if count == 0 {
            return vertices.to_vec();
        }
        // Those nearest to the edge: the ring's side is parallel to it.
        let mut own = vertices.to_vec();
        let to_edge = |i: u32| distances(uv[i as usize])[side];
        own.sort_by(|&a, &b| order(to_edge(a), to_edge(b)));
        own.truncate(count + 1);
        sorted(uv, side, own)
    })
}

fn sorted(uv: &[[f32; 2]], side: usize, mut vertices: Vec<u32>) -> Vec<u32> {
    let place = |vertex: u32| along(side, uv[vertex as usize]);
    vertices.sort_by(|&a, &b| order(place(a), place(b)));
    vertices
}

pub(super) fn order(a: f32, b: f32) -> Ordering {
    a.partial_cmp(&b).expect("tess coordinates are numbers")
}

/// Fills the gap between a side and the inside, always advancing where the next vertex is nearer.
pub(super) fn stitch(
    along: impl Fn(u32) -> f32,
    outer: &[u32],
    inner: &[u32],
    triangles: &mut Vec<[u32; 3]>,
) {
    if inner.is_empty() {
        return;
    }
    let (mut i, mut j) = (0, 0);
    while i + 1 < outer.len() || j + 1 < inner.len() {
        let next_outer = outer
            .get(i + 1)
            .map_or(f32::INFINITY, |&vertex| along(vertex));
        let next_inner = inner
            .get(j + 1)
            .map_or(f32::INFINITY, |&vertex| along(vertex));
        if next_outer <= next_inner {
            triangles.push([outer[i], outer[i + 1], inner[j]]);
            i += 1;
        } else {
            triangles.push([outer[i], inner[j + 1], inner[j]]);
            j += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tessellation::{Domain, Levels, Spacing};

    /// The vertices of a patch with the given segments on its edges and inside, all steps equal.
    fn vertices(edges: [u32; 3], inside: u32) -> Vec<[f32; 2]> {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(glam::Vec2::from);
        let outline = |corners: [glam::Vec2; 3], edges: [u32; 3]| {
            let side = move |i: usize| {
                let (from, to) = (corners[i], corners[(i + 1) % 3]);
                (0..edges[i]).map(move |k| from.lerp(to, k as f32 / edges[i] as f32).to_array())
            };
            (0..3).flat_map(side).collect::<Vec<_>>()
        };
        let mut uv = outline(corners, edges);
        let middle = corners.into_iter().sum::<glam::Vec2>() / 3.0;
        for segments in inner_rings(inside) {
            let size = segments as f32 / inside as f32;
            match segments {
                0 => uv.push(middle.to_array()),
                _ => uv.extend(outline(
                    corners.map(|c| middle.lerp(c, size)),
                    [segments; 3],
                )),
            }
        }
        uv
    }

    #[test]
    fn triangles_cover_the_triangle_once() {
        for (edges, inside) in [
            ([1; 3], 1),
            ([2; 3], 2),
            ([4, 2, 3], 2),
            ([6, 5, 5], 5),
            ([64, 1, 2], 33),
            ([64; 3], 64),
        ] {
            let uv = vertices(edges, inside);
            let area = |[a, b, c]: [u32; 3]| {
                let [a, b, c] = [a, b, c].map(|i| glam::Vec2::from(uv[i as usize]).as_dvec2());
                (b - a).perp_dot(c - a)
            };
            let triangles = triangle(&uv);
            let areas: Vec<f64> = triangles.iter().copied().map(area).collect();
            assert!(areas.iter().all(|&area| area > 0.0), "{edges:?} {inside}");
            let whole = areas.iter().sum::<f64>();
            assert!((whole - 1.0).abs() < 1e-6, "{edges:?} {inside}");
            let [a, b, c] = edges.map(|edge| edge as f32);
            let levels = Levels {
                domain: Domain::Triangles,
                cells: [1; 2],
                edges: [a, b, c, c],
                inside: inside as f32,
            };
            assert_eq!(levels.vertices(Spacing::Equal) as usize, uv.len());
            assert_eq!(levels.triangles(Spacing::Equal) as usize, triangles.len());
        }
    }
}
