//! The end of an infinitely sharp crease inside the mesh.

use std::f64::consts::PI;

use super::{Family, LimitStencil, Ring};
use crate::subdivision::masks::Mask;
use crate::subdivision::schemes::neighbour_weight;

impl Ring<'_> {
    /// One infinitely sharp edge ends here. The matrix is mirror-symmetric about that edge. The antisymmetric tangent is the sine of the
    /// smooth vertex, on which the edge has no part; position and symmetric tangent are iterated.
    pub(super) fn dart(&self) -> LimitStencil {
        let n = self.faces();
        let matrix = DartMatrix {
            n,
            family: self.family,
        };
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
        let (first, second) = (self.fan.at, (self.fan.at + 1) % n);
        let sine = match n {
            // Of valence 2 the plane swings as without a crease; across the edge the face points tell the sides apart.
            2 => Mask::from_slice(&[(self.far(first), 0.25), (self.far(second), -0.25)]),
            _ => self.harmonic(|i| angle(i).sin()),
        };
        let tangent = |at: f64| -> Mask {
            let across = if n == 2 { 1.0 } else { at.sin() };
            let cosine = self
                .mask(&along)
                .into_iter()
                .map(|(vertex, weight)| (vertex, weight * at.cos()));
            cosine
                .chain(
                    sine.iter()
                        .map(|&(vertex, weight)| (vertex, weight * across)),
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

/// The subdivision matrix around a dart of valence n whose edge 0 is the sharp one; vertices in the order middle, edges, faces. Of
/// triangles there are no faces.
struct DartMatrix {
    n: usize,
    family: Family,
}

impl DartMatrix {
    /// Iterates `row * matrix` from a mirror-symmetric `start` until it stands still. With `tangent`, the row is normalised on the way; a
    /// row that sums to zero stays so, since the matrix reproduces constants, and ends in the largest symmetric eigenvalue below 1.
    /// Rounding must not bring in the sine, whose eigenvalue is larger from valence 5 on.
    fn iterate(&self, start: impl Fn(usize) -> f64, tangent: bool) -> Vec<f64> {
        let faces = if self.family == Family::Quads {
            self.n
        } else {
            0
        };
        let mut row: Vec<f64> = (0..=self.n + faces).map(start).collect();
        // Neighbouring modes differ by about 1 / n^2, so that many steps settle the last digit; the bound is for poles of hundreds.
        for _ in 0..(200 + 40 * self.n * self.n).min(50_000) {
            let mut next = self.mirrored(&self.times(&row));
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
            if change < 2e-16 {
                break;
            }
        }
        row
    }

    /// The mean of a row and its mirror image about edge 0.
    fn mirrored(&self, row: &[f64]) -> Vec<f64> {
        let image = |i: usize| match i {
            0 | 1 => i,
            i if i <= self.n => self.n + 2 - i,
            i => 3 * self.n + 1 - i,
        };
        (0..row.len())
            .map(|i| 0.5 * (row[i] + row[image(i)]))
            .collect()
    }

    fn times(&self, row: &[f64]) -> Vec<f64> {
        match self.family {
            Family::Quads => self.times_quads(row),
            Family::Triangles => self.times_triangles(row),
        }
    }

    fn times_triangles(&self, row: &[f64]) -> Vec<f64> {
        let n = self.n;
        let neighbour = neighbour_weight(n);
        let mut product = vec![0.0; n + 1];
        product[0] += row[0] * (1.0 - n as f64 * neighbour);
        for i in 0..n {
            let weight = row[1 + i];
            product[1 + i] += row[0] * neighbour;
            let own = if i == 0 { 0.5 } else { 0.375 };
            product[0] += own * weight;
            product[1 + i] += own * weight;
            if i > 0 {
                product[i] += 0.125 * weight;
                product[1 + (i + 1) % n] += 0.125 * weight;
            }
        }
        product
    }

    fn times_quads(&self, row: &[f64]) -> Vec<f64> {
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
