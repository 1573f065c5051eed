//! The weights of new points: face points, edge points and vertex points (Catmull, Clark 1978; semi-sharp rules by DeRose, Kass,
//! Truong 1998, section 3 and appendix; as in OpenSubdiv's `Sdc::Scheme<SCHEME_CATMARK>`).

use glam::DVec3;
use smallvec::SmallVec;

use crate::mesh::TriangleSubdivision;
use crate::mesh::sharpness::{Rule, is_sharp, rule, sum};
use crate::mesh::topology::Topology;

/// A point as a weighted sum of vertices. A vertex may occur more than once: that of a regular vertex point has 21 terms.
pub type Mask = SmallVec<[(u32, f64); 21]>;

/// What masks can be applied to: positions, or rows of weights.
pub trait Blend: Sized {
    /// The sum of `values[vertex] * weight` over the mask.
    fn blend(mask: &[(u32, f64)], values: &[Self]) -> Self;
}

impl Blend for DVec3 {
    fn blend(mask: &[(u32, f64)], values: &[DVec3]) -> DVec3 {
        mask.iter()
            .map(|&(vertex, weight)| values[vertex as usize] * weight)
            .sum()
    }
}

impl Blend for Vec<f64> {
    fn blend(mask: &[(u32, f64)], values: &[Vec<f64>]) -> Vec<f64> {
        let mut sum = vec![0.0; values[0].len()];
        for &(vertex, weight) in mask {
            for (sum, value) in sum.iter_mut().zip(&values[vertex as usize]) {
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
        for &(value, weight) in mask {
            for &(vertex, part) in &values[value as usize] {
                match sum.iter_mut().find(|(known, _)| *known == vertex) {
                    Some((_, total)) => *total += weight * part,
                    None => sum.push((vertex, weight * part)),
                }
            }
        }
        sum
    }
}

/// Adds `scale` times the mean of a face's vertices.
pub(super) fn add_face(topology: &Topology, face: u32, scale: f64, mask: &mut Mask) {
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
    if crease > 0.0 {
        mask.extend(
            topology
                .edge(edge)
                .vertices
                .map(|vertex| (vertex, 0.5 * crease)),
        );
    }
    if crease < 1.0 {
        smooth(topology, edge, 1.0 - crease, &mut mask);
    }
    mask
}

/// How much of an edge point follows the crease rule: all of it from sharpness 1 on, below that the sharpness itself.
/// Chaikin's rule can leave both halves of an edge below 1 sharp; then it is a crease still.
fn crease_share(topology: &Topology, edge: u32) -> f64 {
    let edge = topology.edge(edge);
    if edge.sharpness >= 1.0 || (is_sharp(edge.next[0]) && is_sharp(edge.next[1])) {
        1.0
    } else {
        f64::from(edge.sharpness.max(0.0))
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
    vertex_point_with(topology, vertex, add_smooth_vertex)
}

/// The mask of a vertex point of any scheme whose creases are cubic B-splines.
pub(super) fn vertex_point_with(topology: &Topology, vertex: u32, smooth: Smooth) -> Mask {
    let now = topology.vertex_sharpness(vertex);
    let next = crate::mesh::sharpness::decayed(now);
    let sharp: SmallVec<[u32; 4]> = topology.sharp_edges(vertex).collect();
    let still: SmallVec<[u32; 4]> = sharp
        .iter()
        .copied()
        .filter(|&edge| is_sharp(topology.edge(edge).next_at(vertex)))
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
    let edges = sharp.iter().map(|&edge| topology.edge(edge));
    let fading = edges
        .filter(|edge| !is_sharp(edge.next_at(vertex)))
        .map(|edge| edge.sharpness);
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
