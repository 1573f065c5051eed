//! End caps: a bicubic patch for what is irregular at the last level, with the limit at its corners.
//!
//! Where a corner is that of a B-spline, so is the cap: on edges that it shares with B-spline patches it is the same cubic. At an extraordinary vertex inside,
//! at a boundary and between infinite creases it has the limit's tangent plane, with tangents as Gregory patches have them (Loop, Schaefer, Ni, Castaño 2009), one
//! along each edge for both faces; inside it has the point of Loop, Schaefer 2008. At corners, darts and what is still semi-sharp edges leave as they do in the mesh.

use rustc_hash::FxHashMap;

use crate::mesh::Scheme;
use crate::mesh::sharpness::is_semi_sharp;
use crate::mesh::topology::Topology;
use crate::method::fas::level::Level;
use crate::method::points::Points;
use crate::method::spokes::ring::Ring;
use crate::method::spokes::sum;
use crate::subdivision::{
    CornerPoints, Mask, TangentPlane, corner_points, deep_limit, tangent_plane,
};

/// The points that caps share.
#[derive(Default)]
pub struct Caps {
    /// The limit of each vertex.
    corners: FxHashMap<u32, u32>,
    /// Next to a vertex on an edge.
    near: FxHashMap<(u32, u32), u32>,
    /// What is around a vertex, by its first face there.
    rings: FxHashMap<(u32, u32), Ring>,
}

/// What a cap has at a corner: the limit, next to it on the edges to the next vertex and to the previous one, and inside.
struct Corner {
    limit: Mask,
    next: Mask,
    previous: Mask,
    inner: Mask,
}

impl Caps {
    /// The points of a face's cap: corners, next to each on its edge, next to the other end there, and inside of each corner.
    pub fn points(&mut self, level: &Level<'_>, face: u32, points: &mut Points) -> [u32; 16] {
        let topology = &level.topology;
        let (vertices, edges) = (topology.face(face), topology.face_edges(face));
        let mut numbers = [0; 16];
        for corner in 0..4 {
            let vertex = vertices[corner];
            let [edge, before] = [edges[corner], edges[(corner + 3) % 4]];
            let own = self.corner(topology, face, corner as u32);
            let mut near = |edge: u32, mask: &Mask| {
                let known = self.near.entry((vertex, edge));
                *known.or_insert_with(|| level.push(points, mask))
            };
            numbers[4 + corner] = near(edge, &own.next);
            numbers[8 + (corner + 3) % 4] = near(before, &own.previous);
            let limit = self.corners.entry(vertex);
            numbers[corner] = *limit.or_insert_with(|| level.push(points, &own.limit));
            numbers[12 + corner] = level.push(points, &own.inner);
        }
        numbers
    }

    fn corner(&mut self, topology: &Topology, face: u32, corner: u32) -> Corner {
        match corner_points(topology, face, corner) {
            Some(around) if around.crease.is_none() => {
                of_spline(topology.face(face), corner, &around)
            }
            _ if has_ring(topology, face, corner) => self.of_ring(topology, face, corner),
            _ => of_edges(topology, face, corner),
        }
    }

    fn of_ring(&mut self, topology: &Topology, face: u32, corner: u32) -> Corner {
        let fan = topology.fan(face, corner);
        let ring = self.rings.entry((fan.vertex, fan.faces[0]));
        let ring = ring.or_insert_with(|| Ring::new(topology, Scheme::CatmullClark, face, corner));
        let edges = topology.face_edges(face);
        let own = ring.place_of_edge(edges[corner as usize]);
        let towards = |edge: u32| {
            let tangent = &ring.tangents[ring.place_of_edge(edge)];
            sum(&[(1.0, &ring.limit), (ring.speed / 3.0, tangent)])
        };
        Corner {
            next: towards(edges[corner as usize]),
            previous: towards(edges[(corner as usize + 3) % 4]),
            inner: ring.inner(own),
            limit: ring.limit.clone(),
        }
    }
}

/// Whether a cap has the limit's tangent plane at a corner.
pub fn has_plane(topology: &Topology, face: u32, corner: u32) -> bool {
    corner_points(topology, face, corner).is_some_and(|around| around.crease.is_none())
        || has_ring(topology, face, corner)
}

/// Whether all faces around a vertex, or in a sector between infinite creases, share a plane with tangents of known lengths.
fn has_ring(topology: &Topology, face: u32, corner: u32) -> bool {
    let vertex = topology.face(face)[corner as usize];
    let semi_sharp = |edge: u32| is_semi_sharp(topology.edge(edge).sharpness);
    if is_semi_sharp(topology.vertex_sharpness(vertex))
        || topology.sharp_edges(vertex).any(semi_sharp)
    {
        return false;
    }
    match tangent_plane(topology, face, corner) {
        TangentPlane::Face(_) => false,
        TangentPlane::Sector(_) => true,
        TangentPlane::Vertex => {
            let darts = topology.sharp_edges(vertex).count();
            darts == 0 && topology.vertex_faces(vertex).len() > 2
        }
    }
}

/// Weights of Bézier points over the three B-spline points from one behind the corner to one before it: at the corner, and next to it.
const AT: [f64; 3] = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
const NEXT_TO: [f64; 3] = [0.0, 4.0 / 6.0, 2.0 / 6.0];

/// The corner of a B-spline patch, of which these are the points around it.
fn of_spline(vertices: &[u32], corner: u32, around: &CornerPoints) -> Corner {
    let vertex = |step: usize| {
        let place = (corner as usize + step) % 4;
        Mask::from_slice(&[(vertices[place], 1.0)])
    };
    let rows = [
        [
            around.diagonal.mask(),
            around.beside.mask(),
            around.past_next.mask(),
        ],
        [around.along.mask(), vertex(0), vertex(1)],
        [around.past_previous.mask(), vertex(3), vertex(2)],
    ];
    let product = |along: [f64; 3], across: [f64; 3]| {
        let terms = rows.iter().zip(across).flat_map(|(row, weight)| {
            let weighted = row.iter().zip(along);
            weighted.map(move |(mask, along)| (along * weight, mask))
        });
        sum(&terms.collect::<Vec<_>>())
    };
    Corner {
        limit: product(AT, AT),
        next: product(NEXT_TO, AT),
        previous: product(AT, NEXT_TO),
        inner: product(NEXT_TO, NEXT_TO),
    }
}

/// The limit, from where edges leave as they do in the mesh.
fn of_edges(topology: &Topology, face: u32, corner: u32) -> Corner {
    let vertices = topology.face(face);
    let limit = deep_limit(topology, Scheme::CatmullClark, face, corner);
    let limit = limit.expect("the face has this corner").position;
    let at = |step: usize| Mask::from_slice(&[(vertices[(corner as usize + step) % 4], 1.0)]);
    let [own, next, previous] = [0, 1, 3].map(at);
    const THIRD: f64 = 1.0 / 3.0;
    Corner {
        next: sum(&[(1.0, &limit), (THIRD, &next), (-THIRD, &own)]),
        previous: sum(&[(1.0, &limit), (THIRD, &previous), (-THIRD, &own)]),
        inner: sum(&[
            (1.0, &limit),
            (THIRD, &next),
            (THIRD, &previous),
            (-2.0 * THIRD, &own),
        ]),
        limit,
    }
}
