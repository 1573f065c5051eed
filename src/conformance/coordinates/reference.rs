//! Tess coordinates as the specification constructs them (Vulkan, "Tessellator", sections "Tessellator Spacing" to "Isoline Tessellation").
//!
//! Equal spacing is fixed to the last vertex. Of fractional spacing only counts and symmetry are, so the places of an edge's vertices are
//! taken from the device's own edges, and everything else follows from them.

use glam::DVec3;

use crate::conformance::modes::{Domain, Spacing};

/// Tess levels of a patch. Twin of `TessLevels` in `glsl/conformance/coordinates.tesc`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TessLevels {
    pub outer: [f32; 4],
    pub inner: [f32; 2],
}

// As `tests/layout.rs` holds the shaders to: four levels, then two.
const _: () = assert!(size_of::<TessLevels>() == 4 * 6);

impl TessLevels {
    /// All the same.
    pub fn uniform(level: f32) -> TessLevels {
        TessLevels {
            outer: [level; 4],
            inner: [level; 2],
        }
    }

    /// The outer levels that a domain has.
    pub fn outer(&self, domain: Domain) -> &[f32] {
        match domain {
            Domain::Quads => &self.outer,
            Domain::Triangles => &self.outer[..3],
            Domain::Isolines => &self.outer[..2],
        }
    }

    /// The inner levels that a domain has.
    pub fn inner(&self, domain: Domain) -> &[f32] {
        match domain {
            Domain::Quads => &self.inner,
            Domain::Triangles => &self.inner[..1],
            Domain::Isolines => &[],
        }
    }
}

/// A level within what the spacing allows, on a device whose greatest is `most`.
pub fn clamped(spacing: Spacing, level: f32, most: f32) -> f32 {
    match spacing {
        Spacing::Equal => level.clamp(1.0, most),
        Spacing::FractionalEven => level.clamp(2.0, most),
        Spacing::FractionalOdd => level.clamp(1.0, most - 1.0),
    }
}

/// The segments that an edge of this level gets.
pub fn segments(spacing: Spacing, level: f32, most: f32) -> u32 {
    let level = clamped(spacing, level, most);
    match spacing {
        Spacing::Equal => level.ceil() as u32,
        Spacing::FractionalEven => 2 * (level / 2.0).ceil() as u32,
        Spacing::FractionalOdd => 2 * ((level - 1.0) / 2.0).ceil() as u32 + 1,
    }
}

/// Where the vertices of an edge lie, from 0 to 1.
pub type Cuts = Vec<f64>;

/// Equal steps.
pub fn equal_cuts(segments: u32) -> Cuts {
    (0..=segments)
        .map(|i| f64::from(i) / f64::from(segments))
        .collect()
}

/// The cuts of a level that is a hair above 1: what an inner level of 1 becomes beside an edge that is divided.
pub fn barely_divided(spacing: Spacing) -> Cuts {
    match spacing {
        Spacing::FractionalOdd => vec![0.0, 0.0, 1.0, 1.0],
        _ => vec![0.0, 0.5, 1.0],
    }
}

/// All vertices of a patch, in no order, from the cuts of its outer and inner levels.
pub fn vertices(domain: Domain, outer: &[Cuts], inner: &[Cuts]) -> Vec<DVec3> {
    match domain {
        Domain::Quads => quad(outer, inner),
        Domain::Triangles => triangle(outer, &inner[0]),
        Domain::Isolines => isolines(outer),
    }
}

/// How many vertices a patch has.
pub fn vertex_count(domain: Domain, spacing: Spacing, levels: &TessLevels, most: f32) -> usize {
    let count = |&level: &f32| segments(spacing, level, most);
    let (outer, inner) = (levels.outer(domain), levels.inner(domain));
    let divided = outer.iter().chain(inner).any(|level| count(level) > 1);
    let outer: Vec<Cuts> = outer.iter().map(|level| equal_cuts(count(level))).collect();
    let inner = inner.iter().map(|level| match count(level) {
        1 if divided => barely_divided(spacing),
        count => equal_cuts(count),
    });
    vertices(domain, &outer, &inner.collect::<Vec<_>>()).len()
}

/// "Quad Tessellation": the outer edges by their own levels, inside a grid by the inner ones.
fn quad(outer: &[Cuts], inner: &[Cuts]) -> Vec<DVec3> {
    // Edge 0 is u = 0, then v = 0, u = 1, v = 1.
    let place = |edge: usize, t: f64| match edge {
        0 => DVec3::new(0.0, t, 0.0),
        1 => DVec3::new(t, 0.0, 0.0),
        2 => DVec3::new(1.0, t, 0.0),
        _ => DVec3::new(t, 1.0, 0.0),
    };
    let mut vertices: Vec<DVec3> = (0..2)
        .flat_map(|i| (0..2).map(move |j| DVec3::new(f64::from(i), f64::from(j), 0.0)))
        .collect();
    for (edge, cuts) in outer.iter().enumerate() {
        vertices.extend(between(cuts).iter().map(|&t| place(edge, t)));
    }
    for &v in between(&inner[1]) {
        vertices.extend(between(&inner[0]).iter().map(|&u| DVec3::new(u, v, 0.0)));
    }
    vertices
}

/// "Triangle Tessellation": the outer edges by their own levels, inside concentric triangles by the inner one.
fn triangle(outer: &[Cuts], inner: &Cuts) -> Vec<DVec3> {
    let corners = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut vertices = corners.to_vec();
    for (edge, cuts) in outer.iter().enumerate() {
        // Edge 0 is u = 0, hence between the second corner and the third.
        let (from, to) = (corners[(edge + 1) % 3], corners[(edge + 2) % 3]);
        vertices.extend(between(cuts).iter().map(|&t| from.lerp(to, t)));
    }
    let (mut corners, mut cuts) = (corners, inner.clone());
    while cuts.len() > 2 {
        (corners, cuts) = next_triangle(corners, &cuts);
        match cuts.len() {
            1 => vertices.push(corners.iter().sum::<DVec3>() / 3.0),
            _ => vertices.extend(outline(corners, &cuts)),
        }
    }
    vertices
}

/// The next triangle inside: its corners stand where the lines perpendicular to two edges, from the vertices next to their common corner, meet; it
/// is subdivided by the perpendiculars from the others.
fn next_triangle(corners: [DVec3; 3], cuts: &Cuts) -> ([DVec3; 3], Cuts) {
    let (first, last) = (cuts[1], cuts[cuts.len() - 2]);
    // In an equilateral triangle they meet at (1 - 4/3 t, 2/3 t, 2/3 t).
    let inside = |i: usize| {
        let others = corners[(i + 1) % 3] + corners[(i + 2) % 3];
        corners[i] * (1.0 - 4.0 / 3.0 * first) + others * (2.0 / 3.0 * first)
    };
    let span = if last > first { last - first } else { 1.0 };
    let inner = between(cuts).iter().map(|t| (t - first) / span).collect();
    ([0, 1, 2].map(inside), inner)
}

fn outline(corners: [DVec3; 3], cuts: &Cuts) -> Vec<DVec3> {
    let sides = (0..3).map(|i| (corners[i], corners[(i + 1) % 3]));
    sides
        .flat_map(|(from, to)| {
            cuts[..cuts.len() - 1]
                .iter()
                .map(move |&t| from.lerp(to, t))
        })
        .collect()
}

/// "Isoline Tessellation": equally spaced lines, none at v = 1.
fn isolines(outer: &[Cuts]) -> Vec<DVec3> {
    let lines = &outer[0][..outer[0].len() - 1];
    lines
        .iter()
        .flat_map(|&v| outer[1].iter().map(move |&u| DVec3::new(u, v, 0.0)))
        .collect()
}

/// Without both ends.
fn between(cuts: &Cuts) -> &[f64] {
    &cuts[1..cuts.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn equal(domain: Domain, outer: &[u32], inner: &[u32]) -> Vec<DVec3> {
        let cuts = |n: &u32| equal_cuts(*n);
        let (outer, inner): (Vec<Cuts>, Vec<Cuts>) = (
            outer.iter().map(cuts).collect(),
            inner.iter().map(cuts).collect(),
        );
        vertices(domain, &outer, &inner)
    }

    #[test]
    fn levels_are_clamped_and_rounded_up() {
        let all = |level| Spacing::ALL.map(|spacing| segments(spacing, level, 64.0));
        assert_eq!(all(-1.0), [1, 2, 1]);
        assert_eq!(all(1.0), [1, 2, 1]);
        assert_eq!(all(1.1), [2, 2, 3]);
        assert_eq!(all(3.0), [3, 4, 3]);
        assert_eq!(all(4.5), [5, 6, 5]);
        assert_eq!(all(63.5), [64, 64, 63]);
        assert_eq!(all(1000.0), [64, 64, 63]);
    }

    #[test]
    fn counts_are_the_known_ones() {
        for n in 1..=9 {
            let quads = equal(Domain::Quads, &[n; 4], &[n; 2]).len() as u32;
            assert_eq!(quads, (n + 1) * (n + 1));
            let lines = equal(Domain::Isolines, &[3, n], &[]).len() as u32;
            assert_eq!(lines, 3 * (n + 1));
        }
        // Triangles of 1, 2, 3, 4 segments: 3, 6 + 1, 9 + 3, 12 + 6 + 1 vertices.
        let triangles = [1, 2, 3, 4].map(|n| equal(Domain::Triangles, &[n; 3], &[n]).len());
        assert_eq!(triangles, [3, 7, 12, 19]);
    }

    #[test]
    fn triangles_are_barycentric_and_symmetric() {
        let all = equal(Domain::Triangles, &[7; 3], &[7]);
        let has = |wanted: DVec3| all.iter().any(|p| p.distance(wanted) < 1e-12);
        for p in &all {
            assert!((p.element_sum() - 1.0).abs() < 1e-12 && p.min_element() > -1e-12);
            assert!(has(DVec3::new(p.y, p.z, p.x)) && has(DVec3::new(p.y, p.x, p.z)));
        }
    }
}
