//! End caps, for what is irregular at the last level: patches with the limit at their corners.
//!
//! Where a corner is that of a B-spline, so is the cap: on edges that it shares with B-spline patches it is the same cubic. At an extraordinary vertex inside,
//! at a boundary and between infinite creases it has the limit's tangent plane, with tangents as Gregory patches have them (Loop, Schaefer, Ni, Castaño 2009), one
//! along each edge for both faces; inside it has the point of Loop, Schaefer 2008. At corners, darts and what is still semi-sharp edges leave as they do in the mesh.
//!
//! Gregory caps have two points inside of each corner, one for each edge there (Loop, Schaefer, Ni, Castaño 2009): (c1 p + (3 - 2 c0 - c1) e + 2 c0 e' + r) / 3. Beside a B-spline
//! both cosines are 0, and it is the B-spline's own point. On edges that are not smooth, or whose ends have no plane, both are the bicubic one.
//!
//! B-spline caps: of the sixteen points of the B-spline that a face with one extraordinary vertex inside would be, the mesh lacks the one opposite to the face, x.
//! Edges away from that vertex do not depend on it, so the cap joins B-spline patches there with their derivatives. Nor do the three other Bézier points of an edge that ends at
//! the vertex, and both its faces have the same; the point at the vertex itself is (x + 4 (a + b + c + d) + 16 p + e + f + g) / 36, so x is chosen for the limit.

use rustc_hash::FxHashMap;

use crate::mesh::Scheme;
use crate::mesh::sharpness::{is_semi_sharp, is_sharp};
use crate::mesh::topology::Topology;
use crate::method::EndCaps;
use crate::method::fas::level::Level;
use crate::method::points::Points;
use crate::method::spokes::edge::Edge;
use crate::method::spokes::ring::Ring;
use crate::method::spokes::{Family, sum};
use crate::subdivision::{
    ControlPoint, CornerPoints, Mask, TangentPlane, corner_points, deep_limit, tangent_plane,
};

/// The points that caps share.
pub struct Caps {
    kind: EndCaps,
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

/// A cap's control points, and whether they are those of a bicubic patch, else of the kind that is asked for.
pub struct Cap {
    pub controls: Vec<u32>,
    pub is_bicubic: bool,
}

impl Caps {
    /// None yet.
    pub fn new(kind: EndCaps) -> Caps {
        Caps {
            kind,
            corners: FxHashMap::default(),
            near: FxHashMap::default(),
            rings: FxHashMap::default(),
        }
    }

    /// The cap of a face. Points of patches stand by corners: these, next to each on its edge, next to the other end there, and inside of each: one, or one for its own
    /// edge and then all for the edges before.
    pub fn of(&mut self, level: &Level<'_>, face: u32, points: &mut Points) -> Cap {
        let own = [0, 1, 2, 3].map(|corner| self.corner(&level.topology, face, corner));
        let controls = match self.kind {
            EndCaps::Bicubic => None,
            EndCaps::Bspline => {
                spline(&level.topology, face, &own).map(|masks| numbers(level, points, &masks))
            }
            EndCaps::Gregory => {
                let mut all = self.outline(level, face, &own, points);
                let inside = self.inside(&level.topology, face, &own);
                all.extend(inside.iter().map(|mask| level.push(points, mask)));
                Some(all)
            }
            EndCaps::Legacy => Some(self.summed(level, face, &own)),
        };
        let is_bicubic = controls.is_none();
        let controls = controls.unwrap_or_else(|| {
            let mut all = self.outline(level, face, &own, points);
            all.extend(own.iter().map(|own| level.push(points, &own.inner)));
            all
        });
        Cap {
            controls,
            is_bicubic,
        }
    }

    /// The points of corners and edges, which neighbours share.
    fn outline(
        &mut self,
        level: &Level<'_>,
        face: u32,
        own: &[Corner; 4],
        points: &mut Points,
    ) -> Vec<u32> {
        let topology = &level.topology;
        let (vertices, edges) = (topology.face(face), topology.face_edges(face));
        let mut numbers = vec![0; 12];
        for (corner, own) in own.iter().enumerate() {
            let vertex = vertices[corner];
            let [edge, before] = [edges[corner], edges[(corner + 3) % 4]];
            let mut near = |edge: u32, mask: &Mask| {
                let known = self.near.entry((vertex, edge));
                *known.or_insert_with(|| level.push(points, mask))
            };
            numbers[4 + corner] = near(edge, &own.next);
            numbers[8 + (corner + 3) % 4] = near(before, &own.previous);
            let limit = self.corners.entry(vertex);
            numbers[corner] = *limit.or_insert_with(|| level.push(points, &own.limit));
        }
        numbers
    }

    /// The eight points inside of a Gregory patch: of each edge those at its beginning, then of each those at its end.
    fn inside(&mut self, topology: &Topology, face: u32, own: &[Corner; 4]) -> Vec<Mask> {
        let pairs = [0, 1, 2, 3].map(|side| {
            let next = (side + 1) % 4;
            self.beside_edge(topology, face, side as u32)
                .unwrap_or_else(|| [&own[side], &own[next]].map(|own| own.inner.clone()))
        });
        let (before, behind): (Vec<Mask>, Vec<Mask>) =
            pairs.into_iter().map(|[a, b]| (a, b)).unzip();
        [before, behind].concat()
    }

    /// The points inside of both ends of an edge; None where it is not smooth, or an end has no plane.
    fn beside_edge(&mut self, topology: &Topology, face: u32, side: u32) -> Option<[Mask; 2]> {
        let edge = topology.face_edges(face)[side as usize];
        let ends = [side, (side + 1) % 4];
        let is_smooth =
            topology.edge_faces(edge).len() == 2 && !is_sharp(topology.edge(edge).sharpness);
        if !is_smooth || ends.iter().any(|&end| !has_ring(topology, face, end)) {
            return None;
        }
        ends.iter().for_each(|&end| {
            self.ring(topology, face, end);
        });
        let rings = ends.map(|end| &self.rings[&key(topology, face, end)]);
        let masks = Edge::new(topology, Family::Gregory, edge, rings).masks();
        let [near, _, first, second, _, far] = &masks[..] else {
            return None;
        };
        let inner = |[own, other]: [&Ring; 2], [next, beyond]: [&Mask; 2], field: &Mask| {
            let along = (3.0 - 2.0 * own.cosine) - other.cosine;
            let terms = [
                (other.cosine, &own.limit),
                (along, next),
                (2.0 * own.cosine, beyond),
                (1.0, field),
            ];
            sum(&terms.map(|(weight, mask)| (weight / 3.0, mask)))
        };
        let [a, b] = rings;
        Some([
            inner([a, b], [near, far], first),
            inner([b, a], [far, near], second),
        ])
    }

    /// A Gregory cap as the control shader sums it: where the terms of each point begin and end, counted from here; then the terms, a vertex and its weight each.
    fn summed(&mut self, level: &Level<'_>, face: u32, own: &[Corner; 4]) -> Vec<u32> {
        let at = |corner: usize| &own[corner % 4];
        let corners = (0..4).map(|i| at(i).limit.clone());
        let near = (0..4).map(|i| at(i).next.clone());
        let far = (0..4).map(|i| at(i + 1).previous.clone());
        let mut masks: Vec<Mask> = corners.chain(near).chain(far).collect();
        masks.extend(self.inside(&level.topology, face, own));
        let mut words = vec![0; masks.len() + 1];
        for (i, mask) in masks.iter().enumerate() {
            words[i] = words.len() as u32;
            // Each vertex once.
            for (vertex, weight) in sum(&[(1.0, mask)]) {
                words.extend([level.first_point + vertex, (weight as f32).to_bits()]);
            }
        }
        words[masks.len()] = words.len() as u32;
        words
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

    fn ring(&mut self, topology: &Topology, face: u32, corner: u32) -> &Ring {
        let ring = self.rings.entry(key(topology, face, corner));
        ring.or_insert_with(|| Ring::new(topology, Scheme::CatmullClark, face, corner))
    }

    fn of_ring(&mut self, topology: &Topology, face: u32, corner: u32) -> Corner {
        let ring = self.ring(topology, face, corner);
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

/// By which a ring is known.
fn key(topology: &Topology, face: u32, corner: u32) -> (u32, u32) {
    let fan = topology.fan(face, corner);
    (fan.vertex, fan.faces[0])
}

/// Those of masks, of which single vertices have theirs already.
fn numbers(level: &Level<'_>, points: &mut Points, masks: &[Mask; 16]) -> Vec<u32> {
    let number = |mask: &Mask| match mask[..] {
        [(vertex, 1.0)] => level.first_point + vertex,
        _ => level.push(points, mask),
    };
    masks.iter().map(number).collect()
}

/// The points of a B-spline around a face with one extraordinary vertex, and nothing sharp, row by row; None of other faces.
fn spline(topology: &Topology, face: u32, own: &[Corner; 4]) -> Option<[Mask; 16]> {
    let around = [0, 1, 2, 3].map(|corner| corner_points(topology, face, corner));
    let mut strange = (0..4).filter(|&corner| around[corner].is_none());
    let (strange, None) = (strange.next()?, strange.next()) else {
        return None;
    };
    let is_inside = tangent_plane(topology, face, strange as u32) == TangentPlane::Vertex
        && has_ring(topology, face, strange as u32);
    if !is_inside
        || around
            .iter()
            .flatten()
            .any(|corner| corner.crease.is_some())
    {
        return None;
    }
    let mut masks: [Mask; 16] = std::array::from_fn(|_| Mask::new());
    // A corner's frame: the corner itself, one step to the next vertex, one to the previous.
    let place = |corner: usize, [next, previous]: [isize; 2]| {
        let turns = [[1, 0], [0, 1], [-1, 0], [0, -1]];
        let [x, y] = [[1, 1], [2, 1], [2, 2], [1, 2]][corner];
        let (along, back) = (turns[corner], turns[(corner + 1) % 4]);
        let at = |i: usize, from: isize| from + next * along[i] + previous * back[i];
        (at(0, x) + 4 * at(1, y)) as usize
    };
    for (corner, &vertex) in topology.face(face).iter().enumerate() {
        masks[place(corner, [0, 0])] = Mask::from_slice(&[(vertex, 1.0)]);
        let Some(around) = &around[corner] else {
            continue;
        };
        let outside = [
            (around.along, [-1, 0]),
            (around.beside, [0, -1]),
            (around.diagonal, [-1, -1]),
            (around.past_previous, [-1, 1]),
            (around.past_next, [1, -1]),
        ];
        for (point, at) in outside {
            // Mirrored points belong to corners that may have no plane.
            let ControlPoint::Vertex(vertex) = point else {
                return None;
            };
            masks[place(corner, at)] = Mask::from_slice(&[(vertex, 1.0)]);
        }
    }
    let far = place(strange, [-1, -1]);
    let mut terms = vec![(36.0, &own[strange].limit)];
    for next in -1isize..2 {
        for previous in -1isize..2 {
            let weight = [4.0, 1.0][next.unsigned_abs()] * [4.0, 1.0][previous.unsigned_abs()];
            let at = place(strange, [next, previous]);
            terms.extend((at != far).then(|| (-weight, &masks[at])));
        }
    }
    masks[far] = sum(&terms);
    Some(masks)
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
