//! The edges around a vertex: its limit and a tangent along each, as masks.

use std::f64::consts::{PI, TAU};

use super::sum;
use crate::mesh::Scheme;
use crate::mesh::topology::Topology;
use crate::subdivision::{LimitStencil, Mask, deep_limit};

/// A vertex, counter-clockwise: face i lies between edges i and i + 1.
#[derive(Clone, Debug)]
pub struct Ring {
    pub middle: u32,
    edges: Vec<u32>,
    /// The far ends of the edges.
    ends: Vec<u32>,
    /// The far corner of each face that is a quad.
    fars: Vec<Option<u32>>,
    closed: bool,
    /// The limit position.
    pub limit: Mask,
    /// Tangents along the edges, as bicubic patches have them; among regular faces the derivatives.
    pub tangents: Vec<Mask>,
    /// By what Gregory patches have longer ones: twice the subdominant eigenvalue.
    pub speed: f64,
    /// That of the angle between edges; 0 at a single face, whose edges have nothing between them.
    pub cosine: f64,
}

impl Ring {
    pub fn new(topology: &Topology, scheme: Scheme, face: u32, corner: u32) -> Ring {
        let fan = topology.fan(face, corner);
        let far = |&face: &u32| {
            let vertices = topology.face(face);
            let at = topology.corner_of(face, fan.vertex) as usize;
            (vertices.len() == 4).then(|| vertices[(at + 2) % 4])
        };
        let first = fan.faces[0];
        let at = topology.corner_of(first, fan.vertex);
        let limit = deep_limit(topology, scheme, first, at).expect("the face has this corner");
        let mut ring = Ring {
            middle: fan.vertex,
            edges: fan.edges.to_vec(),
            ends: fan
                .edges
                .iter()
                .map(|&edge| topology.edge(edge).other(fan.vertex))
                .collect(),
            fars: fan.faces.iter().map(far).collect(),
            closed: fan.closed,
            limit: limit.position.clone(),
            tangents: Vec::new(),
            speed: 1.0,
            cosine: 0.0,
        };
        ring.cosine = match ring.faces() {
            1 => 0.0,
            _ => ring.angle().cos(),
        };
        ring.set_tangents(topology.face(first).len(), at, limit);
        ring
    }

    pub fn faces(&self) -> usize {
        self.fars.len()
    }

    /// Between edges.
    fn angle(&self) -> f64 {
        let faces = self.faces() as f64;
        if self.closed { TAU / faces } else { PI / faces }
    }

    /// Where an edge stands.
    pub fn place_of_edge(&self, edge: u32) -> usize {
        let place = self.edges.iter().position(|&other| other == edge);
        place.expect("the edge ends here")
    }

    /// Edge i + step, if there is one.
    fn stepped(&self, i: usize, step: isize) -> Option<usize> {
        let count = self.edges.len() as isize;
        let place = i as isize + step;
        match self.closed {
            true => Some(place.rem_euclid(count) as usize),
            false => (0..count).contains(&place).then_some(place as usize),
        }
    }

    /// The face to the left of edge i (step 0) or to its right (-1).
    pub fn face_beside(&self, i: usize, step: isize) -> Option<usize> {
        let place = i as isize + step;
        let faces = self.faces() as isize;
        match self.closed {
            true => Some(place.rem_euclid(faces) as usize),
            false => (0..faces).contains(&place).then_some(place as usize),
        }
    }

    /// The tangent of edge i + step.
    pub fn tangent_beside(&self, i: usize, step: isize) -> Option<&Mask> {
        self.stepped(i, step).map(|place| &self.tangents[place])
    }

    fn set_tangents(&mut self, corners: usize, corner: u32, limit: LimitStencil) {
        let triangles = self.fars.iter().filter(|far| far.is_none()).count();
        let mixed = triangles > 0 && triangles < self.faces();
        let (n, closed) = (self.faces() as f64, self.closed);
        let (angle, half) = (self.angle(), self.angle() / 2.0);
        if self.faces() == 1 {
            // What the limit of a sharp corner has; elsewhere the boundary is one curve.
            let along = sum(&[(0.5, &one(self.ends[0])), (-0.5, &one(self.ends[1]))]);
            self.tangents = match self.is_bend() {
                false => self.spokes().to_vec(),
                true => vec![along.clone(), sum(&[(-1.0, &along)])],
            };
            return;
        }
        let [first, second] = if mixed {
            self.mixed_tangents()
        } else {
            let [next, previous] = unturned(corners, corner, &limit);
            // The limit's plane with the lengths that both papers give it (Loop, Schaefer 2008; Loop, Schaefer, Ni, Castano 2009).
            let sigma = 1.0 / (4.0 + half.cos().powi(2)).sqrt();
            let length = match closed && triangles == 0 {
                true => 1.5 * sigma / half.cos(),
                false => 1.0,
            };
            [sum(&[(length, &next)]), sum(&[(length, &previous)])]
        };
        self.tangents = (0..self.edges.len())
            .map(|i| {
                let at = |towards: f64| (towards * angle).sin() / angle.sin();
                match self.faces() {
                    // Half a turn from the first: exactly its opposite.
                    faces if !closed && i == faces => sum(&[(-1.0, &first)]),
                    _ => sum(&[(at(1.0 - i as f64), &first), (at(i as f64), &second)]),
                }
            })
            .collect();
        if closed {
            // Halstead, Kass, DeRose 1993, appendix A; Loop 1987.
            let root = (18.0 + 2.0 * angle.cos()).sqrt();
            self.speed = 2.0
                * match triangles as f64 == n {
                    true => 0.375 + 0.25 * angle.cos(),
                    false => (5.0 + angle.cos() + half.cos() * root) / 16.0,
                };
        }
    }

    /// Of a vertex among triangles and quads the tangents along edges 0 and 1: inside those of the paper of 2009, over middles of edges and centres of faces;
    /// at a boundary half of what lies between its ends, and the sine of all edges across.
    fn mixed_tangents(&self) -> [Mask; 2] {
        let n = self.faces() as f64;
        let angle = self.angle();
        if !self.closed {
            let last = self.faces();
            let along = sum(&[(0.5, &one(self.ends[0])), (-0.5, &one(self.ends[last]))]);
            let spoke = |(i, &end): (usize, &u32)| {
                let weight = 2.0 / n * (i as f64 * angle).sin();
                [(end, weight), (self.middle, -weight)]
            };
            let across: Mask = self.ends.iter().enumerate().flat_map(spoke).collect();
            let second = sum(&[(angle.cos(), &along), (angle.sin(), &across)]);
            return [along, second];
        }
        let (half, sigma) = (
            (angle / 2.0).cos(),
            1.0 / (4.0 + (angle / 2.0).cos().powi(2)).sqrt(),
        );
        [0.0, 1.0].map(|towards| {
            let mut mask = Mask::new();
            for (i, far) in self.fars.iter().enumerate() {
                let turn = angle * (i as f64 - towards);
                let edge = 2.0 / n * (1.0 - sigma * half) * turn.cos();
                mask.extend([(self.middle, edge / 2.0), (self.ends[i], edge / 2.0)]);
                let face = 2.0 / n * 2.0 * sigma * (turn + angle / 2.0).cos();
                let next = self.ends[(i + 1) % self.ends.len()];
                let corners = [Some(self.middle), Some(self.ends[i]), *far, Some(next)];
                let corners: Vec<u32> = corners.into_iter().flatten().collect();
                let share = face / corners.len() as f64;
                mask.extend(corners.into_iter().map(|corner| (corner, share)));
            }
            sum(&[(1.0, &mask)])
        })
    }

    /// Whether the boundary is one curve around the corner of a single face, so that both tangents lie along it.
    fn is_bend(&self) -> bool {
        let mut others = self.limit.iter().filter(|term| term.0 != self.middle);
        self.faces() == 1 && others.any(|&(_, weight)| weight != 0.0)
    }

    /// The edges themselves, of a single face.
    fn spokes(&self) -> [Mask; 2] {
        [0, 1].map(|i| sum(&[(1.0, &one(self.ends[i])), (-1.0, &one(self.middle))]))
    }

    /// Two vectors in the plane that the patches have.
    ///
    /// In a bend of the boundary the first derivatives T and -T span none, and the normal is the limit of that inside, along the diagonal: T x (Suu + 2 Suv + Svv).
    /// Of a quad with the vertices v, a, c, b around v the points next to v are, in both papers, those of the boundary's B-spline, (2 v + a) / 3 and
    /// (v + 2 a) / 3, likewise with b, and (4 v + 2 a + 2 b + c) / 9 inside. So Suu = Svv = a + b - 2 v and Suv = c + (a + b) / 2 - 2 v. Of a triangle the sum is
    /// 3 (a + b - 2 v) but for multiples of T: its edges span the plane.
    pub fn plane(&self) -> [Mask; 2] {
        if self.faces() > 1 {
            return [self.tangents[0].clone(), self.tangents[1].clone()];
        }
        let Some(far) = self.fars[0].filter(|_| self.is_bend()) else {
            return self.spokes();
        };
        let [next, previous] = self.spokes();
        let across = sum(&[
            (3.0, &next),
            (3.0, &previous),
            (2.0, &one(far)),
            (-2.0, &one(self.middle)),
        ]);
        [self.tangents[0].clone(), across]
    }

    /// The valence that counts: a boundary is half of a vertex, and the corner of a single face is as regular as can be.
    fn valence(&self) -> f64 {
        match (self.closed, self.faces()) {
            (true, n) => n as f64,
            (false, 1) => 4.0,
            (false, k) => 2.0 * k as f64,
        }
    }

    /// The bicubic point inside of face i, a quad: (n, 2, 2, 1) / (n + 5).
    pub fn inner(&self, face: usize) -> Mask {
        let n = self.valence();
        let far = self.fars[face].expect("it is a quad");
        let ends = [face, (face + 1) % self.ends.len()].map(|i| self.ends[i]);
        let whole = n + 5.0;
        let terms = [
            (self.middle, n / whole),
            (ends[0], 2.0 / whole),
            (ends[1], 2.0 / whole),
            (far, 1.0 / whole),
        ];
        sum(&[(1.0, &Mask::from_slice(&terms))])
    }

    /// The bicubic point on edge i: the mean of those inside of both faces, and the third of a boundary.
    pub fn on_edge(&self, i: usize) -> Mask {
        match (self.face_beside(i, 0), self.face_beside(i, -1)) {
            (Some(left), Some(right)) => {
                sum(&[(0.5, &self.inner(left)), (0.5, &self.inner(right))])
            }
            _ => sum(&[
                (2.0 / 3.0, &one(self.middle)),
                (1.0 / 3.0, &one(self.ends[i])),
            ]),
        }
    }

    /// What the face on one side of edge i, left (1) or right (-1), has in the field of the edge next to the middle: half of a vertex. Of regular faces both sides
    /// together are exact: of quads the third of the next edge and the sixth of the far corner (2009), of triangles 5/12 of the opposite vertex and
    /// 1/12 of the one behind it, which is the derivative of the box spline across its edge. Where one is no longer there, it is the mirror image.
    pub fn half(&self, i: usize, side: isize) -> Mask {
        let face = self.face_beside(i, if side > 0 { 0 } else { -1 });
        let Some(face) = face else {
            return self.mirrored_half(i, side);
        };
        let next = self.stepped(i, side).expect("a face has two edges here");
        match self.fars[face] {
            Some(far) => Mask::from_slice(&[(self.ends[next], 1.0 / 3.0), (far, 1.0 / 6.0)]),
            None => {
                let behind = match self.stepped(i, 2 * side) {
                    Some(behind) => one(self.ends[behind]),
                    None => sum(&[
                        (1.0, &one(self.middle)),
                        (1.0, &one(self.ends[next])),
                        (-1.0, &one(self.ends[i])),
                    ]),
                };
                sum(&[(5.0 / 12.0, &one(self.ends[next])), (1.0 / 12.0, &behind)])
            }
        }
    }

    /// The half of the face that is not there, on the other side of a boundary.
    fn mirrored_half(&self, i: usize, side: isize) -> Mask {
        let next = self.stepped(i, -side).expect("there is a face");
        let opposite = sum(&[
            (1.0, &one(self.middle)),
            (1.0, &one(self.ends[i])),
            (-1.0, &one(self.ends[next])),
        ]);
        let last = self.stepped(i, -side * self.faces() as isize);
        let (behind, last) = (self.stepped(i, -2 * side), last.expect("its other end"));
        match behind.filter(|_| self.faces() > 2) {
            None => {
                // As far as the half on this side lies behind the edge, so far before it.
                let own = self.half(i, -side);
                let along = [(1.0, &one(self.middle)), (1.0, &one(self.ends[i]))];
                let mut parts = along.map(|(weight, mask)| (0.5 * weight, mask)).to_vec();
                parts.push((-1.0, &own));
                sum(&parts)
            }
            Some(behind) => sum(&[
                (5.0 / 12.0, &opposite),
                (1.0 / 12.0, &one(self.middle)),
                (1.0 / 12.0, &one(self.ends[last])),
                (-1.0 / 12.0, &one(self.ends[behind])),
            ]),
        }
    }
}

fn one(vertex: u32) -> Mask {
    Mask::from_slice(&[(vertex, 1.0)])
}

/// The tangents towards the next and the previous vertex of a face's corner, from the derivatives in the face's own frame.
fn unturned(corners: usize, corner: u32, limit: &LimitStencil) -> [Mask; 2] {
    let (du, dv) = (&limit.du, &limit.dv);
    let [next, previous]: [&[(f64, &Mask)]; 2] = match (corners, corner) {
        (_, 0) => [&[(1.0, du)], &[(1.0, dv)]],
        (3, 1) => [&[(1.0, dv), (-1.0, du)], &[(-1.0, du)]],
        (3, _) => [&[(-1.0, dv)], &[(1.0, du), (-1.0, dv)]],
        (_, 1) => [&[(1.0, dv)], &[(-1.0, du)]],
        (_, 2) => [&[(-1.0, du)], &[(-1.0, dv)]],
        (_, _) => [&[(-1.0, dv)], &[(1.0, du)]],
    };
    [sum(next), sum(previous)]
}
