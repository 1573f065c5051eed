//! The weights of new points: face points, edge points and vertex points (Catmull, Clark 1978; semi-sharp rules by DeRose, Kass,
//! Truong 1998, section 3 and appendix; as in OpenSubdiv's `Sdc::Scheme<SCHEME_CATMARK>`).

use glam::DVec3;
use smallvec::SmallVec;

use crate::mesh::TriangleSubdivision;
use crate::mesh::places::Places;
use crate::mesh::sharpness::{Rule, is_sharp, rule, sum};
use crate::mesh::topology::Topology;

/// A point as a weighted sum of vertices. A vertex may occur more than once: that of a regular vertex point has 21 terms.
pub type Mask = SmallVec<[(u32, f64); 21]>;

/// What masks can be applied to: positions, or rows of weights.
pub trait Blend: Sized {
    /// The sum of `values[vertex] * weight` over the mask. A vertex without a value adds nothing.
    fn blend(mask: &[(u32, f64)], values: &[Self]) -> Self;
}

impl Blend for DVec3 {
    fn blend(mask: &[(u32, f64)], values: &[DVec3]) -> DVec3 {
        let values = mask.iter().filter_map(|&(vertex, weight)| {
            let value = values.get(vertex as usize)?;
            Some(*value * weight)
        });
        values.sum()
    }
}

impl Blend for Vec<f64> {
    fn blend(mask: &[(u32, f64)], values: &[Vec<f64>]) -> Vec<f64> {
        let mut sum = vec![0.0; values.first().map_or(0, Vec::len)];
        for &(vertex, weight) in mask {
            for (sum, value) in sum
                .iter_mut()
                .zip(values.get(vertex as usize).into_iter().flatten())
            {
                *sum += weight * value;
            }
        }
        sum
    }
}

impl Blend for Mask {
    /// In the order in which vertices first appear.
    fn blend(mask: &[(u32, f64)], values: &[Mask]) -> Mask {
        let mut sum = Mask::new();
        let mut places = Places::default();
        for &(value, weight) in mask {
            for &(vertex, part) in values.get(value as usize).into_iter().flatten() {
                match places.of(vertex) {
                    place if place < sum.len() => sum[place].1 += weight * part,
                    _ => sum.push((vertex, weight * part)),
                }
            }
        }
        sum
    }
}

/// Adds `scale` times the mean of a face's vertices.
pub(super) fn add_face(topology: &Topology, face: u32, scale: f64, mask: &mut Mask) {
    if let Some(mean) = topology.mean_of(face) {
        return mask.push((mean, scale));
    }
    let vertices = topology.face(face);
    mask.extend(
        vertices
            .iter()
            .map(|&vertex| (vertex, scale / vertices.len() as f64)),
    );
}

/// The mask of a face point: the mean of the face's vertices.
pub fn face_point(topology: &Topology, face: u32) -> Mask {
    let mut mask = Mask::new();
    add_face(topology, face, 1.0, &mut mask);
    mask
}

/// The mask of an edge point.
pub fn edge_point(topology: &Topology, edge: u32) -> Mask {
    edge_point_with(topology, edge, add_smooth_edge)
}

/// A scheme's own rule: adds so many times its mask of an edge or a vertex.
pub(super) type Smooth = fn(&Topology, u32, f64, &mut Mask);

/// The mask of an edge point of any scheme whose sharp rule is the edge's middle.
pub(super) fn edge_point_with(topology: &Topology, edge: u32, smooth: Smooth) -> Mask {
    let mut mask = Mask::new();
    let crease = crease_share(topology, edge);
    if crease != 0.0 {
        mask.extend(
            topology
                .edge(edge)
                .vertices
                .map(|vertex| (vertex, 0.5 * crease)),
        );
    }
    if crease != 1.0 {
        smooth(topology, edge, 1.0 - crease, &mut mask);
    }
    mask
}

/// How much of an edge point follows the crease rule: all of it while both halves stay sharp, else the sharpness itself.
///
/// Under Chaikin's rule a sharpness above 1 may leave a half smooth, beside an edge that is nearly so. Then the share is more than 1, and the smooth
/// rule has a negative one: `Sdc::Scheme::ComputeEdgeVertexMask` does not clamp it, where the transition of a vertex is clamped.
fn crease_share(topology: &Topology, edge: u32) -> f64 {
    if topology.next_sharpness(edge).into_iter().all(is_sharp) {
        1.0
    } else {
        f64::from(topology.edge(edge).sharpness)
    }
}

/// `smoothtriangles` gives the face points beside an edge this weight when the face is a triangle, instead of 1/4
/// (OpenSubdiv's `CATMARK_SMOOTH_TRI_EDGE_WEIGHT`).
const SMOOTH_TRIANGLE_FACE_WEIGHT: f64 = 0.47;

pub(super) fn add_smooth_edge(topology: &Topology, edge: u32, scale: f64, mask: &mut Mask) {
    let &[first, second] = topology.edge_faces(edge) else {
        // Only rims of partial topologies get here, whose points nobody asks for.
        mask.extend(
            topology
                .edge(edge)
                .vertices
                .map(|vertex| (vertex, 0.5 * scale)),
        );
        return;
    };
    let smooth = topology.options().triangles == TriangleSubdivision::Smooth;
    let share = |face| {
        if smooth && topology.face(face).len() == 3 {
            SMOOTH_TRIANGLE_FACE_WEIGHT
        } else {
            0.25
        }
    };
    let faces = 0.5 * (share(first) + share(second));
    mask.extend(
        topology
            .edge(edge)
            .vertices
            .map(|vertex| (vertex, (0.5 - faces) * scale)),
    );
    add_face(topology, first, faces * scale, mask);
    add_face(topology, second, faces * scale, mask);
}

/// The mask of a vertex point.
pub fn vertex_point(topology: &Topology, vertex: u32) -> Mask {
    if let Some(hub) = topology.hub_at(vertex) {
        return Mask::from_slice(&[(hub.first, 1.0)]);
    }
    vertex_point_with(topology, vertex, add_smooth_vertex)
}

/// The mask of a vertex point of any scheme whose creases are cubic B-splines.
pub(super) fn vertex_point_with(topology: &Topology, vertex: u32, smooth: Smooth) -> Mask {
    if topology.vertex_edges(vertex).is_empty() {
        // No face uses it; means over no neighbours would be no numbers.
        return Mask::from_slice(&[(vertex, 1.0)]);
    }
    let now = topology.vertex_sharpness(vertex);
    let next = crate::mesh::sharpness::decayed(now);
    let sharp: SmallVec<[u32; 4]> = topology.sharp_edges(vertex).collect();
    let still: SmallVec<[u32; 4]> = sharp
        .iter()
        .copied()
        .filter(|&edge| is_sharp(topology.next_at(edge, vertex)))
        .collect();
    let (before, after) = (rule(now, sharp.len()), rule(next, still.len()));
    let mut mask = Mask::new();
    if before == after || matches!(before, Rule::Smooth | Rule::Dart) {
        add_vertex(topology, vertex, before, &sharp, 1.0, smooth, &mut mask);
    } else {
        let share = fading_share(topology, vertex, &sharp);
        add_vertex(topology, vertex, before, &sharp, share, smooth, &mut mask);
        add_vertex(
            topology,
            vertex,
            after,
            &still,
            1.0 - share,
            smooth,
            &mut mask,
        );
    }
    mask
}

/// How much of a vertex point in transition follows the present rule: the mean sharpness of what is sharp now and smooth next.
fn fading_share(topology: &Topology, vertex: u32, sharp: &[u32]) -> f64 {
    let own = topology.vertex_sharpness(vertex);
    let own = (is_sharp(own) && !is_sharp(crate::mesh::sharpness::decayed(own))).then_some(own);
    let fading = sharp
        .iter()
        .filter(|&&edge| !is_sharp(topology.next_at(edge, vertex)))
        .map(|&edge| topology.edge(edge).sharpness);
    let fading: SmallVec<[f32; 4]> = own.into_iter().chain(fading).collect();
    if fading.is_empty() {
        0.0
    } else {
        f64::from((sum(fading.iter().copied()) / fading.len() as f32).min(1.0))
    }
}

fn add_vertex(
    topology: &Topology,
    vertex: u32,
    rule: Rule,
    sharp: &[u32],
    scale: f64,
    smooth: Smooth,
    mask: &mut Mask,
) {
    match rule {
        Rule::Corner => mask.push((vertex, scale)),
        Rule::Crease => {
            mask.push((vertex, 0.75 * scale));
            mask.extend(
                sharp
                    .iter()
                    .map(|&edge| (topology.edge(edge).other(vertex), 0.125 * scale)),
            );
        }
        Rule::Smooth | Rule::Dart => smooth(topology, vertex, scale, mask),
    }
}

/// Catmull and Clark's (n - 2) / n of the vertex, and 1 / n^2 of each edge's far end and each new face point.
pub(super) fn add_smooth_vertex(topology: &Topology, vertex: u32, scale: f64, mask: &mut Mask) {
    let edges = topology.vertex_edges(vertex);
    let n = edges.len() as f64;
    mask.push((vertex, (n - 2.0) / n * scale));
    mask.extend(
        edges
            .iter()
            .map(|&edge| (topology.edge(edge).other(vertex), scale / (n * n))),
    );
    for corner in topology.vertex_faces(vertex) {
        add_face(topology, corner.face, scale / (n * n), mask);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{
        BoundaryInterpolation, ControlMesh, CreaseMethod, INFINITE_SHARPNESS, Scheme, SchemeOptions,
    };

    const WIDTH: u32 = 5;

    /// Quads between five columns and three rows of vertices; the height of each vertex is that of its row, but for the middle of the grid.
    fn grid(
        heights: [f64; 3],
        middle: f64,
        creases: &[([u32; 2], f32)],
        boundary: BoundaryInterpolation,
    ) -> (Topology, Vec<DVec3>) {
        let rows = (0..3 * WIDTH).map(|i| {
            let height = if i == 7 {
                middle
            } else {
                heights[i as usize / 5]
            };
            [f64::from(i % WIDTH), f64::from(i / WIDTH), height]
        });
        let positions: Vec<[f64; 3]> = rows.collect();
        let corners = (0..2 * WIDTH).filter(|i| i % WIDTH < WIDTH - 1);
        let faces: Vec<u32> = corners
            .flat_map(|i| [i, i + 1, i + WIDTH + 1, i + WIDTH])
            .collect();
        let mut builder =
            ControlMesh::builder(&positions, &[4; 8], &faces).options(SchemeOptions {
                creasing: CreaseMethod::Chaikin,
                boundary,
                ..SchemeOptions::default()
            });
        for &([a, b], sharpness) in creases {
            builder = builder.crease(a, b, sharpness);
        }
        let mesh = builder.build().expect("a sound grid");
        (Topology::new(&mesh), mesh.positions().to_vec())
    }

    fn edge_between(topology: &Topology, a: u32, b: u32) -> u32 {
        let edges = topology.vertex_edges(a).iter().copied();
        let mut found = edges.filter(|&edge| topology.edge(edge).other(a) == b);
        found.next().expect("an edge")
    }

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
    }

    /// Along a ridge of height 1 between valleys of 0 the smooth rule gives 3/4 and the crease rule 1; so 3/4 + share / 4.
    #[test]
    fn edge_points_of_chaikin_creases_are_opensubdivs() {
        const INF: f32 = INFINITE_SHARPNESS;
        // Sharpness of the ridge's four edges and of an edge across at the end of the second; the second edge's share.
        let cases: [([f32; 5], f64); 7] = [
            // Both halves decay to 3/4 1.3 + 1/4 0.01 - 1 < 0.
            ([0.01, 1.3, 0.01, 0.01, 0.0], 1.3),
            // One half does: at the other end nothing else is sharp, and 0.3 is left.
            ([0.0, 1.3, 0.01, 0.0, 0.0], 1.3),
            // Three creases: 3/4 1.2 + 1/4 (0.1 + 0.2) / 2 - 1 < 0.
            ([0.0, 1.2, 0.1, 0.0, 0.2], 1.2),
            // Both halves stay sharp though the edge is below 1: 3/4 0.9 + 1/4 3 - 1 = 0.425.
            ([3.0, 0.9, 3.0, 0.0, 0.0], 1.0),
            ([3.0, 0.9, 0.1, 0.0, 0.0], 0.9),
            // Infinite creases do not share.
            ([INF, 1.2, INF, 0.0, 0.0], 1.0),
            ([INF, 0.6, 3.0, 0.0, 0.0], 0.6),
        ];
        for (sharpness, share) in cases {
            let along = (0..4).map(|i| ([5 + i, 6 + i], sharpness[i as usize]));
            let creases: Vec<_> = along.chain([([7, 12], sharpness[4])]).collect();
            let heights = [0.0, 1.0, 0.0];
            let (topology, positions) =
                grid(heights, 1.0, &creases, BoundaryInterpolation::EdgeOnly);
            let edge = edge_between(&topology, 6, 7);
            let point = DVec3::blend(&edge_point(&topology, edge), &positions);
            near(point.z, 0.75 + 0.25 * share);
            near(point.x, 1.5);
            // Loop's own rules differ, what makes a crease does not.
            let smooth: Smooth = |_, _, scale, mask| mask.push((0, scale));
            let mask = edge_point_with(&topology, edge, smooth);
            near(
                mask.iter()
                    .filter(|term| term.0 == 0)
                    .map(|term| term.1)
                    .sum(),
                1.0 - share,
            );
        }
    }

    #[test]
    fn vertex_points_of_chaikin_creases_are_opensubdivs() {
        let ridge = |creases: &[([u32; 2], f32)]| {
            let (topology, positions) = grid(
                [0.0, 1.0, 0.0],
                3.0,
                creases,
                BoundaryInterpolation::EdgeOnly,
            );
            DVec3::blend(&vertex_point(&topology, 7), &positions).z
        };
        // 2/4 3 + (1 + 1) / 16 + 4 / 16, for the mean of each face is 1.
        const SMOOTH: f64 = 1.875;
        const CREASE: f64 = 0.75 * 3.0 + 0.25;
        near(ridge(&[]), SMOOTH);
        near(ridge(&[([6, 7], 2.0), ([7, 8], 2.0)]), CREASE);
        // Both fade: the mean of 0.01 and 1.3.
        let share = 0.655;
        let expected = share * CREASE + (1.0 - share) * SMOOTH;
        near(ridge(&[([6, 7], 0.01), ([7, 8], 1.3)]), expected);
        // One fades, and a dart is left, which is smooth: 3/4 2.4 + 1/4 0.01 - 1 = 0.8025.
        let expected = 0.01 * CREASE + 0.99 * SMOOTH;
        near(ridge(&[([6, 7], 0.01), ([7, 8], 2.4)]), expected);
        // A corner of three, of which one fades: 3/4 0.25 + 1/4 2 - 1 < 0, but 3/4 2 + 1/4 1.125 - 1 = 0.78125.
        let expected = 0.25 * 3.0 + 0.75 * CREASE;
        near(
            ridge(&[([6, 7], 2.0), ([7, 8], 2.0), ([7, 12], 0.25)]),
            expected,
        );
    }

    /// OpenSubdiv leaves the boundary as the tags have it where faces beside it are holes, and Chaikin's rule counts what is semi-sharp.
    #[test]
    fn boundaries_without_interpolation_take_part_in_chaikins_rule() {
        let creases = [([2, 7], 0.9), ([7, 8], 3.0), ([1, 2], 3.0)];
        for (boundary, share) in [
            (BoundaryInterpolation::None, 1.0),
            (BoundaryInterpolation::EdgeOnly, 0.9),
        ] {
            let (topology, positions) = grid([0.0, 1.0, 0.0], 1.0, &creases, boundary);
            let edge = edge_between(&topology, 2, 7);
            let point = DVec3::blend(&edge_point(&topology, edge), &positions);
            // Both rules give this height. The smooth one takes a sixteenth of what lies beside.
            near(point.z, 0.5);
            let mask = edge_point(&topology, edge);
            let beside = mask.iter().filter(|term| term.0 == 6).map(|term| term.1);
            near(beside.sum(), (1.0 - share) / 16.0);
        }
        let (topology, _) = grid([0.0; 3], 0.0, &[], BoundaryInterpolation::None);
        let edge = edge_between(&topology, 0, 1);
        let (own, next) = (topology.edge(edge).sharpness, topology.next_sharpness(edge));
        assert_eq!((own, next), (INFINITE_SHARPNESS, [INFINITE_SHARPNESS; 2]));
        assert_eq!(topology.options().scheme, Scheme::CatmullClark);
    }
}
