//! Which faces are bicubic B-splines, and of which sixteen control points.
//!
//! Smooth regular faces; faces beside boundaries and infinite creases, by extrapolated control points (Kobbelt 1996; Brainerd et al. 2016,
//! section 4.1); and faces with one semi-sharp crease (Nießner et al. 2012). An infinite crease separates its two sides, so only the
//! sector on the face's own side has to be regular.

use glam::{DVec2, DVec3};
use smallvec::SmallVec;

use crate::mesh::sharpness::{Rule, decayed, is_semi_sharp, rule};
use crate::mesh::topology::Topology;
use crate::patch::bspline;
use crate::subdivision::jet::{Jet, Sum};
use crate::subdivision::masks::{Blend, Mask};

/// A control point of a B-spline patch: a vertex, or one mirrored beyond a sharp edge or corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ControlPoint {
    /// The vertex itself.
    Vertex(u32),
    /// 2a - b: beyond the sharp edge through a, seen from b.
    Mirrored([u32; 2]),
    /// 4a - 2b - 2c + d: beyond the sharp corner a, whose face is a b d c.
    Corner([u32; 4]),
}

impl ControlPoint {
    /// The point as weights of vertices.
    pub fn mask(self) -> Mask {
        match self {
            ControlPoint::Vertex(a) => Mask::from_slice(&[(a, 1.0)]),
            ControlPoint::Mirrored([a, b]) => Mask::from_slice(&[(a, 2.0), (b, -1.0)]),
            ControlPoint::Corner([a, b, c, d]) => {
                Mask::from_slice(&[(a, 4.0), (b, -2.0), (c, -2.0), (d, 1.0)])
            }
        }
    }
}

/// A face as a bicubic B-spline.
#[derive(Clone, Debug, PartialEq)]
pub struct BsplinePatch {
    /// Control points, row by row: number x + 4 y belongs to u = x - 1, v = y - 1.
    pub points: [ControlPoint; 16],
    /// A semi-sharp crease: the face's edge that carries it, and its sharpness.
    pub crease: Option<(u32, f32)>,
    /// Whether any point is mirrored.
    pub mirrored: bool,
}

/// The points around a corner that lie outside of the face, in the corner's own frame: `along` lies opposite to the next vertex, `beside`
/// opposite to the previous one, `diagonal` opposite to the face; `past_previous` and `past_next` beside the face, beyond its edge to
/// the previous and to the next vertex.
pub struct CornerPoints {
    pub along: ControlPoint,
    pub beside: ControlPoint,
    pub diagonal: ControlPoint,
    pub past_previous: ControlPoint,
    pub past_next: ControlPoint,
    /// The semi-sharp crease through the corner, and whether it follows the edge to the next vertex (else the one to the previous).
    pub crease: Option<(bool, f32)>,
}

/// Where the corner's vertex, `along`, `beside` and `diagonal` stand in the 4x4 array, for each corner.
const PLACES: [[usize; 4]; 4] = [[5, 4, 1, 0], [6, 2, 7, 3], [10, 11, 14, 15], [9, 13, 8, 12]];

/// The face as a B-spline patch, or None when it has to be refined first.
pub fn bspline_patch(topology: &Topology, face: u32) -> Option<BsplinePatch> {
    let vertices = topology.face(face);
    if vertices.len() != 4 {
        return None;
    }
    let mut points = [ControlPoint::Vertex(0); 16];
    let mut through = [None; 4];
    for corner in 0..4 {
        let around = corner_points(topology, face, corner)?;
        let [own, along, beside, diagonal] = PLACES[corner as usize];
        points[own] = ControlPoint::Vertex(vertices[corner as usize]);
        points[along] = around.along;
        points[beside] = around.beside;
        points[diagonal] = around.diagonal;
        // A crease towards the next vertex lies on edge `corner`, one towards the previous on the edge before.
        through[corner as usize] = around
            .crease
            .map(|(next, sharpness)| (if next { corner } else { (corner + 3) % 4 }, sharpness));
    }
    let mirrored = points
        .iter()
        .any(|point| !matches!(point, ControlPoint::Vertex(_)));
    Some(BsplinePatch {
        points,
        crease: single_crease(topology, face, &through)?,
        mirrored,
    })
}

/// The one crease that both its corners agree on, or none at all; anything else has to be refined.
fn single_crease(
    topology: &Topology,
    face: u32,
    through: &[Option<(u32, f32)>; 4],
) -> Option<Option<(u32, f32)>> {
    let mut found = through.iter().flatten();
    let Some(&(edge, sharpness)) = found.next() else {
        let edges = topology.face_edges(face).iter();
        return edges
            .into_iter()
            .all(|&e| !is_semi_sharp(topology.edge(e).sharpness))
            .then_some(None);
    };
    let ends = [edge as usize, (edge as usize + 1) % 4];
    let agree =
        (0..4).all(|corner| through[corner] == ends.contains(&corner).then_some((edge, sharpness)));
    agree.then_some(Some((edge, sharpness)))
}

/// The points around a corner of a quad, or None when its vertex is not regular.
pub fn corner_points(topology: &Topology, face: u32, corner: u32) -> Option<CornerPoints> {
    let vertices = topology.face(face);
    let [own, next, opposite, previous] = [0, 1, 2, 3].map(|i| vertices[(corner as usize + i) % 4]);
    let fan = topology.fan_within(face, corner, 4)?;
    let end = |i: usize| topology.edge(fan.edges[i % fan.edges.len()]).other(own);
    let far = |i: usize| opposite_in(topology, fan.faces[i % fan.faces.len()], own);
    if fan.faces.iter().any(|&face| topology.face(face).len() != 4)
        || is_semi_sharp(topology.vertex_sharpness(own))
    {
        return None;
    }
    let sharp: SmallVec<[u32; 8]> = topology.sharp_edges(own).collect();
    let semi_sharp = sharp
        .iter()
        .any(|&edge| is_semi_sharp(topology.edge(edge).sharpness));
    match (
        rule(topology.vertex_sharpness(own), sharp.len()),
        fan.faces.len(),
    ) {
        (Rule::Smooth, 4) if fan.closed => Some(interior(&end, &far, fan.at, None)),
        (Rule::Crease, 4) if fan.closed => {
            let crease = straight_crease(topology, own, &fan.edges, &sharp)?;
            let follows_next = (fan.at + 4 - crease.0).is_multiple_of(2);
            Some(interior(&end, &far, fan.at, Some((follows_next, crease.1))))
        }
        (Rule::Crease, 2) if !semi_sharp && fan.at == 0 => Some(CornerPoints {
            along: ControlPoint::Vertex(end(2)),
            beside: ControlPoint::Mirrored([own, previous]),
            diagonal: ControlPoint::Mirrored([end(2), far(1)]),
            past_previous: ControlPoint::Vertex(far(1)),
            past_next: ControlPoint::Mirrored([next, opposite]),
            crease: None,
        }),
        (Rule::Crease, 2) if !semi_sharp => Some(CornerPoints {
            along: ControlPoint::Mirrored([own, next]),
            beside: ControlPoint::Vertex(end(0)),
            diagonal: ControlPoint::Mirrored([end(0), far(0)]),
            past_previous: ControlPoint::Mirrored([previous, opposite]),
            past_next: ControlPoint::Vertex(far(0)),
            crease: None,
        }),
        (Rule::Corner, 1) if !semi_sharp => Some(CornerPoints {
            along: ControlPoint::Mirrored([own, next]),
            beside: ControlPoint::Mirrored([own, previous]),
            diagonal: ControlPoint::Corner([own, next, previous, opposite]),
            past_previous: ControlPoint::Mirrored([previous, opposite]),
            past_next: ControlPoint::Mirrored([next, opposite]),
            crease: None,
        }),
        _ => None,
    }
}

/// Four quads all round: beyond the edges opposite to the face's own two, and in the face opposite to it.
fn interior(
    end: &impl Fn(usize) -> u32,
    far: &impl Fn(usize) -> u32,
    at: usize,
    crease: Option<(bool, f32)>,
) -> CornerPoints {
    CornerPoints {
        along: ControlPoint::Vertex(end(at + 2)),
        beside: ControlPoint::Vertex(end(at + 3)),
        diagonal: ControlPoint::Vertex(far(at + 2)),
        past_previous: ControlPoint::Vertex(far(at + 1)),
        past_next: ControlPoint::Vertex(far(at + 3)),
        crease,
    }
}

/// Two sharp edges opposite to each other, equally sharp now and as far as they reach: the number in the fan of the first, and the sharpness.
///
/// Both halves must decay alike, which Chaikin's rule grants only where the sharpness beyond is the same.
fn straight_crease(
    topology: &Topology,
    vertex: u32,
    edges: &[u32],
    sharp: &[u32],
) -> Option<(usize, f32)> {
    let first = edges.iter().position(|edge| sharp.contains(edge))?;
    let pair = [edges[first], edges[(first + 2) % 4]];
    let sharpness = topology.edge(pair[0]).sharpness;
    let alike = pair.into_iter().all(|number| {
        let edge = topology.edge(number);
        edge.other(vertex) != vertex
            && edge.sharpness == sharpness
            && topology.next_sharpness(number) == [decayed(sharpness); 2]
    });
    alike.then_some((first, sharpness))
}

fn opposite_in(topology: &Topology, face: u32, vertex: u32) -> u32 {
    let vertices = topology.face(face);
    let corner = vertices
        .iter()
        .position(|&v| v == vertex)
        .expect("a fan's faces touch its vertex");
    vertices[(corner + 2) % 4]
}

/// A B-spline patch at (u, v).
pub(super) fn bspline_jet(patch: &BsplinePatch, positions: &[DVec3], uv: DVec2) -> Jet {
    let (u, v) = (bspline::basis(uv.x), bspline::basis(uv.y));
    let points = patch
        .points
        .map(|point| DVec3::blend(&point.mask(), positions));
    let sum = |u: [f64; 4], v: [f64; 4]| {
        let weights: [(u32, f64); 16] = std::array::from_fn(|i| (i as u32, u[i % 4] * v[i / 4]));
        Sum::of(&weights, &points)
    };
    Jet {
        position: sum(u.value, v.value).value,
        du: sum(u.derivative, v.value),
        dv: sum(u.value, v.derivative),
    }
}
