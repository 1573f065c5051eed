//! Where a vertex ends up under endless refinement, and the tangents there: left eigenvectors of the subdivision matrix.
//!
//! Smooth vertices: Halstead, Kass, DeRose 1993, appendix A. Creases: Biermann, Levin, Zorin 2000, appendix A. An infinitely sharp
//! crease that ends inside (a dart) changes the matrix of its end, and no closed form is known to us: the eigenvectors are iterated.

use std::f64::consts::PI;

use crate::mesh::sharpness::{Rule, is_semi_sharp, rule};
use crate::mesh::topology::{Fan, Topology};
use crate::subdivision::masks::Mask;

/// Limit position and two tangents of a vertex, as masks over the vertices of a topology.
///
/// The tangents span the limit's tangent plane as seen from the asking face, and their cross product points to the side from which the
/// face's vertices run counter-clockwise. At regular vertices they are dP/du and dP/dv of the face; elsewhere only their plane counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LimitStencil {
    /// Limit position; weights sum to 1.
    pub position: Mask,
    /// First tangent; weights sum to 0.
    pub du: Mask,
    /// Second tangent; weights sum to 0.
    pub dv: Mask,
}

/// The limit at `corner` of `face`, or None while a semi-sharp feature at the vertex or a face that is no quad asks for refinement.
pub fn limit_stencil(topology: &Topology, face: u32, corner: u32) -> Option<LimitStencil> {
    let vertex = topology.face(face)[corner as usize];
    let mut sharp = 0;
    for edge in topology.sharp_edges(vertex) {
        if is_semi_sharp(topology.edge(edge).sharpness) {
            return None;
        }
        sharp += 1;
    }
    let sharpness = topology.vertex_sharpness(vertex);
    let fan = topology.fan(face, corner);
    if is_semi_sharp(sharpness) || fan.faces.iter().any(|&face| topology.face(face).len() != 4) {
        return None;
    }
    let ring = Ring { topology, fan };
    let own = match rule(sharpness, sharp) {
        Rule::Smooth if ring.fan.edges.len() == 2 => ring.valence_two(),
        Rule::Smooth => ring.smooth(),
        Rule::Crease if ring.is_page() => ring.page(),
        Rule::Crease => ring.crease(),
        Rule::Corner => ring.corner(),
        Rule::Dart => ring.dart(),
    };
    Some(own.turned(corner))
}

impl LimitStencil {
    /// From the frame of a corner, whose u runs to the next vertex and v to the previous one, to that of the face.
    fn turned(self, corner: u32) -> LimitStencil {
        let LimitStencil { position, du, dv } = self;
        let (du, dv) = match corner {
            0 => (du, dv),
            1 => (negated(dv), du),
            2 => (negated(du), negated(dv)),
            _ => (dv, negated(du)),
        };
        LimitStencil { position, du, dv }
    }
}

fn negated(mask: Mask) -> Mask {
    mask.into_iter()
        .map(|(vertex, weight)| (vertex, -weight))
        .collect()
}

/// How much more than its faces an edge weighs in a mode of frequency `angle` around a vertex.
fn edge_weight(angle: f64) -> f64 {
    1.0 + angle.cos() + (angle / 2.0).cos() * (2.0 * (9.0 + angle.cos())).sqrt()
}

/// By what a mode of frequency `angle` contracts in one refinement (Halstead, Kass, DeRose 1993, appendix A).
fn eigenvalue(angle: f64) -> f64 {
    (5.0 + angle.cos() + (angle / 2.0).cos() * (2.0 * (9.0 + angle.cos())).sqrt()) / 16.0
}

/// A fan of quads: its middle, the far ends of its edges and the far corners of its faces.
struct Ring<'a> {
    topology: &'a Topology,
    fan: Fan,
}

impl Ring<'_> {
    fn middle(&self) -> u32 {
        self.fan.vertex
    }

    fn faces(&self) -> usize {
        self.fan.faces.len()
    }

    /// The far end of edge i; a closed fan's edges come round again.
    fn end(&self, i: usize) -> u32 {
        self.topology
            .edge(self.fan.edges[i % self.fan.edges.len()])
            .other(self.middle())
    }

    /// The vertex of face i opposite to the middle.
    fn far(&self, i: usize) -> u32 {
        let face = self.topology.face(self.fan.faces[i]);
        let corner = face
            .iter()
            .position(|&vertex| vertex == self.middle())
            .expect("the fan's faces touch its vertex");
        face[(corner + 2) % 4]
    }

    /// Interior, no sharp edge: (n^2, 4, 1) / (n (n + 5)); the tangents belong to the double eigenvalue of frequency 1.
    fn smooth(&self) -> LimitStencil {
        let n = self.faces();
        let count = n as f64;
        let whole = count * (count + 5.0);
        let mut position = Mask::from_slice(&[(self.middle(), count * count / whole)]);
        for i in 0..n {
            position.push((self.end(i), 4.0 / whole));
            position.push((self.far(i), 1.0 / whole));
        }
        let tangent =
            |towards: usize| self.harmonic(|i| (2.0 * PI * (i - towards as f64) / count).cos());
        LimitStencil {
            position,
            du: tangent(self.fan.at),
            dv: tangent(self.fan.at + 1),
        }
    }

    /// The tangent mask with weight A f(i) at edge i and f(i) + f(i + 1) at face i, scaled so that n = 4 gives the derivative.
    fn harmonic(&self, f: impl Fn(f64) -> f64) -> Mask {
        let n = self.faces();
        let angle = 2.0 * PI / n as f64;
        let edge = edge_weight(angle);
        let scale = 1.0 / (3.0 * n as f64);
        let mut mask = Mask::new();
        for i in 0..n {
            let (here, next) = (f(i as f64), f(i as f64 + 1.0));
            mask.push((self.end(i), edge * here * scale));
            mask.push((self.far(i), (here + next) * scale));
        }
        mask
    }

    /// Valence 2. The position is that of the general formula. The general tangents vanish: edges and faces decouple, and both
    /// antisymmetric modes e0 - e1 and f0 - f1 have eigenvalue 1/4. A symmetric mode has -1/4, so the tangent plane swings from
    /// level to level about the plane of those two, which is the one given.
    fn valence_two(&self) -> LimitStencil {
        let (first, second) = (self.fan.at, self.fan.at + 1);
        let across = |sign: f64| {
            Mask::from_slice(&[
                (self.end(first), 0.25),
                (self.end(second), -0.25),
                (self.far(first), 0.25 * sign),
                (self.far(second % 2), -0.25 * sign),
            ])
        };
        LimitStencil {
            du: across(1.0),
            dv: negated(across(-1.0)),
            ..self.smooth()
        }
    }

    /// Two infinitely sharp edges: the cubic B-spline of the crease, and the sine mode of the k faces on this side across it.
    fn crease(&self) -> LimitStencil {
        let k = self.faces();
        let (first, last) = (self.end(0), self.end(k));
        let position = Mask::from_slice(&[
            (self.middle(), 4.0 / 6.0),
            (first, 1.0 / 6.0),
            (last, 1.0 / 6.0),
        ]);
        if k == 1 {
            // A single face: the tangent plane is that of its two edges (the sum of the edges, a mode of 1/4, dominates across).
            return LimitStencil {
                position,
                ..self.corner()
            };
        }
        let across = self.across_crease(k);
        let tangent = |angle: f64| {
            let mut mask =
                Mask::from_slice(&[(first, 0.5 * angle.cos()), (last, -0.5 * angle.cos())]);
            mask.extend(
                across
                    .iter()
                    .map(|&(vertex, weight)| (vertex, weight * angle.sin())),
            );
            mask
        };
        let step = PI / k as f64;
        LimitStencil {
            position,
            du: tangent(self.fan.at as f64 * step),
            dv: tangent((self.fan.at + 1) as f64 * step),
        }
    }

    /// The sine mode of k faces beside a crease. Inside it is that of any vertex; the weight b of the crease's two ends follows from their
    /// column of the matrix, (eigenvalue - 1/2) b = middle / 8 + sin (A / 16 + 1/4), and that of the middle from the sum of zero.
    /// For k = 2 these are the weights (-4, -1, -1, 4, 1, 1) / 6 of the B-spline's derivative.
    fn across_crease(&self, k: usize) -> Mask {
        let angle = PI / k as f64;
        let edge = edge_weight(angle);
        let inside = (edge + 2.0) / (angle / 2.0).tan();
        let end = (angle.sin() * (edge + 4.0) / 16.0 - inside / 8.0) / (eigenvalue(angle) - 0.25);
        let scale = 1.0 / (3.0 * k as f64);
        let mut mask = Mask::from_slice(&[
            (self.middle(), -(2.0 * end + inside) * scale),
            (self.end(0), end * scale),
            (self.end(k), end * scale),
        ]);
        for i in 0..k {
            let (here, next) = ((i as f64 * angle).sin(), ((i + 1) as f64 * angle).sin());
            mask.push((self.end(i), edge * here * scale));
            mask.push((self.far(i), (here + next) * scale));
        }
        mask
    }

    /// Whether the fan does not lead from one edge of the crease to the other, as only non-manifold vertices allow.
    fn is_page(&self) -> bool {
        self.fan.closed || self.fan.edges[0] == self.fan.edges[self.faces()]
    }

    /// Faces that begin and end at the same edge of a crease, or are a cone around its vertex: a cusp as at a corner, whose tip
    /// moves along the crease.
    fn page(&self) -> LimitStencil {
        let (k, at) = (self.faces(), self.fan.at);
        let [a, b] = self.crease_ends();
        let position =
            Mask::from_slice(&[(self.middle(), 4.0 / 6.0), (a, 1.0 / 6.0), (b, 1.0 / 6.0)]);
        let (du, dv) = if self.fan.closed {
            let (cusp, across) = self.cusp();
            (self.moving(cusp, eigenvalue(0.0) - 0.5, true), across)
        } else {
            let back = self.end(0) == b;
            let (near, beyond) = if back { (b, a) } else { (a, b) };
            let along = Mask::from_slice(&[(near, 0.5), (beyond, -0.5)]);
            let excess = eigenvalue(PI / k as f64) - 0.5;
            let slowest = if excess > 1e-9 {
                self.moving(self.sector_mode(1), excess, false)
            } else {
                // Two faces: across the crease as anywhere.
                let mut mask = self.sector_mode(1);
                mask.extend([(self.middle(), 2.0), (a, -1.0), (b, -1.0)]);
                mask
            };
            match at {
                0 => (along, slowest),
                _ if at == k - 1 => (slowest, along),
                _ => (slowest, negated(self.sector_mode(2))),
            }
        };
        LimitStencil { position, du, dv }
    }

    /// The far ends of the crease through the middle.
    fn crease_ends(&self) -> [u32; 2] {
        let mut edges = self.topology.sharp_edges(self.middle());
        [0, 1].map(|_| {
            let edge = edges.next().expect("a crease has two edges");
            self.topology.edge(edge).other(self.middle())
        })
    }

    /// A mode seen from a middle that stays, turned into that seen from one on a crease: its weight and what the two ends take over from
    /// it follow from their columns of the matrix. With `raw`, the mode has yet to be scaled by the excess of its eigenvalue over 1/2.
    fn moving(&self, mode: Mask, excess: f64, raw: bool) -> Mask {
        let scale = if raw { excess } else { 1.0 };
        let own = |&(vertex, weight): &(u32, f64)| (vertex == self.middle()).then_some(weight);
        let middle = scale * mode.iter().filter_map(own).sum::<f64>() / (excess + 0.25);
        let mut mask: Mask = mode
            .iter()
            .filter(|&&(vertex, _)| vertex != self.middle())
            .map(|&(vertex, weight)| (vertex, scale * weight))
            .collect();
        mask.push((self.middle(), excess * middle));
        mask.extend(self.crease_ends().map(|end| (end, middle / 8.0)));
        mask
    }

    /// The vertex stays, and what is beside it contracts towards it mode by mode.
    ///
    /// A face that has both sharp edges to itself lies in their plane. Among several faces the slowest mode of the sector drags all
    /// inner edges into one direction: the surface has a cusp. Its tangent plane, as the limit of the plane through the face's two edges,
    /// is spanned by that direction and by what tells the two edges apart: a sharp edge itself or the next slower mode.
    fn corner(&self) -> LimitStencil {
        let position = Mask::from_slice(&[(self.middle(), 1.0)]);
        let (k, at) = (self.faces(), self.fan.at);
        let (du, dv) = if self.fan.closed {
            self.cusp()
        } else if k == 1 {
            (self.along(0), self.along(1))
        } else if at == 0 {
            (self.along(0), self.sector_mode(1))
        } else if at == k - 1 {
            (self.sector_mode(1), self.along(k))
        } else {
            (self.sector_mode(1), negated(self.sector_mode(2)))
        };
        LimitStencil { position, du, dv }
    }

    fn along(&self, i: usize) -> Mask {
        Mask::from_slice(&[(self.middle(), -1.0), (self.end(i), 1.0)])
    }

    /// A sharp vertex without sharp edges: the mode of frequency 0 is the slowest, those of frequency 1 tell the face's edges apart.
    fn cusp(&self) -> (Mask, Mask) {
        let (n, at) = (self.faces(), self.fan.at);
        if n == 2 {
            let chord = Mask::from_slice(&[(self.end(at + 1), 1.0), (self.end(at), -1.0)]);
            return (self.mode(0.0, |_| 1.0), chord);
        }
        let angle = 2.0 * PI / n as f64;
        (
            self.mode(0.0, |_| 1.0),
            self.mode(angle, |i| (angle * (i - at as f64 - 0.5)).sin()),
        )
    }

    /// Mode j of a sector of k faces between sharp edges: sin(i j pi / k) inside, and whatever the sharp edges feed into it.
    ///
    /// Sharp edges contract by 1/2. A slower mode takes them in with weight 1 / (eigenvalue - 1/2); at 1/2 there is resonance and
    /// they take over; faster modes vanish beside them.
    fn sector_mode(&self, j: usize) -> Mask {
        let k = self.faces();
        let angle = PI * j as f64 / k as f64;
        let excess = eigenvalue(angle) - 0.5;
        let apart = self.fan.edges[0] != self.fan.edges[k];
        let slower = excess > 1e-9;
        let mut mask = Mask::new();
        if slower || !apart && (j == 2 || k == 2) {
            let scale = if slower { excess } else { 1.0 };
            mask.extend(
                self.mode(angle, |i| (angle * i).sin())
                    .iter()
                    .map(|&(v, w)| (v, w * scale)),
            );
        }
        if slower || apart {
            // What edge 1 and face 0 take from edge 0 in one step: 1/16 and 1/4.
            let fed = (edge_weight(angle) / 16.0 + 0.25) * angle.sin();
            let far_sign = if j % 2 == 1 { 1.0 } else { -1.0 };
            for (i, sign) in [(0, 1.0), (k, far_sign)] {
                mask.push((self.end(i), fed * sign));
                mask.push((self.middle(), -fed * sign));
            }
        }
        mask
    }

    /// The mask of a mode of frequency `angle` whose edge i has amplitude f(i), seen from a middle that stays.
    fn mode(&self, angle: f64, f: impl Fn(f64) -> f64) -> Mask {
        let mut mask = Mask::new();
        for i in 0..self.faces() {
            let (edge, face) = (
                edge_weight(angle) * f(i as f64),
                f(i as f64) + f(i as f64 + 1.0),
            );
            mask.extend([
                (self.end(i), edge),
                (self.far(i), face),
                (self.middle(), -edge - face),
            ]);
        }
        mask
    }

    /// One infinitely sharp edge ends here. The matrix is mirror-symmetric about that edge. The antisymmetric tangent is the sine of the
    /// smooth vertex, on which the edge has no part; position and symmetric tangent are iterated.
    fn dart(&self) -> LimitStencil {
        let n = self.faces();
        let matrix = DartMatrix { n };
        let angle = |i: f64| 2.0 * PI * i / n as f64;
        let position = matrix.iterate(|i| f64::from(u8::from(i == 0)), false);
        let along = matrix.iterate(
            |i| match i {
                0 => 0.0,
                i if i <= n => angle((i - 1) as f64).cos(),
                i => angle((i - 1 - n) as f64 + 0.5).cos(),
            },
            true,
        );
        let sine = self.harmonic(|i| angle(i).sin());
        let tangent = |at: f64| -> Mask {
            let cosine = self
                .mask(&along)
                .into_iter()
                .map(|(vertex, weight)| (vertex, weight * at.cos()));
            cosine
                .chain(
                    sine.iter()
                        .map(|&(vertex, weight)| (vertex, weight * at.sin())),
                )
                .collect()
        };
        LimitStencil {
            position: self.mask(&position),
            du: tangent(angle(self.fan.at as f64)),
            dv: tangent(angle(self.fan.at as f64 + 1.0)),
        }
    }

    /// Weights in the order middle, edges, faces.
    fn mask(&self, weights: &[f64]) -> Mask {
        let n = self.faces();
        let vertex = |i: usize| match i {
            0 => self.middle(),
            i if i <= n => self.end(i - 1),
            i => self.far(i - 1 - n),
        };
        weights
            .iter()
            .enumerate()
            .map(|(i, &weight)| (vertex(i), weight))
            .collect()
    }
}

/// The subdivision matrix around a dart of valence n whose edge 0 is the sharp one; vertices in the order middle, edges, faces.
struct DartMatrix {
    n: usize,
}

impl DartMatrix {
    /// Iterates `row * matrix` from `start` until it stands still. With `tangent`, the row is normalised on the way; a row that
    /// sums to zero stays so, since the matrix reproduces constants, and ends in the largest eigenvalue below 1.
    fn iterate(&self, start: impl Fn(usize) -> f64, tangent: bool) -> Vec<f64> {
        let mut row: Vec<f64> = (0..=2 * self.n).map(start).collect();
        // Neighbouring modes differ by about 1 / n^2, so that many steps settle the last digit; the bound is for poles of hundreds.
        for _ in 0..(200 + 40 * self.n * self.n).min(50_000) {
            let mut next = self.times(&row);
            if tangent {
                let sum: f64 = next.iter().sum::<f64>() / next.len() as f64;
                let length = next.iter().map(|w| w * w).sum::<f64>().sqrt();
                next.iter_mut().for_each(|w| *w = (*w - sum) / length);
            }
            let change = row
                .iter()
                .zip(&next)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            row = next;
            if change < 1e-17 {
                break;
            }
        }
        row
    }

    fn times(&self, row: &[f64]) -> Vec<f64> {
        let n = self.n;
        let (edge, face) = (|i: usize| 1 + i % n, |i: usize| 1 + n + i % n);
        let mut product = vec![0.0; 2 * n + 1];
        let add_face = |i: usize, weight: f64, product: &mut Vec<f64>| {
            for vertex in [0, edge(i), edge(i + 1), face(i)] {
                product[vertex] += 0.25 * weight;
            }
        };
        let square = (n * n) as f64;
        product[0] += row[0] * (n as f64 - 2.0) / n as f64;
        for i in 0..n {
            product[edge(i)] += row[0] / square;
            add_face(i, row[0] / square, &mut product);
            let weight = row[edge(i)];
            if i == 0 {
                product[0] += 0.5 * weight;
                product[edge(0)] += 0.5 * weight;
            } else {
                product[0] += 0.25 * weight;
                product[edge(i)] += 0.25 * weight;
                add_face(i - 1, 0.25 * weight, &mut product);
                add_face(i, 0.25 * weight, &mut product);
            }
            add_face(i, row[face(i)], &mut product);
        }
        product
    }
}
