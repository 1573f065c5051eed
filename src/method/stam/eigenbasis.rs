//! The eigenvectors of Catmull and Clark's subdivision matrix around one extraordinary vertex (Stam 1998, section 3 and appendix A).
//!
//! Around a vertex of valence N a face's limit depends on K = 2 N + 8 vertices: on those of the 1-ring, whose matrix is made of circulants, and on seven beyond, which
//! are a regular mesh's. So the matrix is block triangular, and all is in closed form: a wave around the vertex of each frequency, and products of the vectors of a
//! cubic B-spline's boundary. The paper leaves open whether a matrix of some valence is defective; none is up to 50, as the test shows.
//!
//! The vertices are numbered from the extraordinary one on, then edge by edge the far end and the vertex opposite in the face that follows; then those beyond,
//! see [`OUTER`]. The face itself is the first.

use std::f64::consts::TAU;

use glam::{DMat2, DMat3, DVec2, DVec3};

/// Vertices beyond the 1-ring, where the extraordinary vertex is (0, 0) and the face's other corners are (1, 0), (1, 1) and (0, 1).
pub const OUTER: [[i32; 2]; 7] = [[2, -1], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [-1, 2]];

/// How many vertices the face's limit depends on.
pub fn vertices(valence: usize) -> usize {
    2 * valence + 8
}

/// The vertex at a place of the face's grid, -1..=2 in both directions. At (-1, -1) there is none unless the valence is 4.
pub fn on_grid(valence: usize, [x, y]: [i32; 2]) -> Option<usize> {
    let end = |i: usize| 1 + 2 * (i % valence);
    let opposite = |i: usize| 2 + 2 * (i % valence);
    match [x, y] {
        [0, 0] => Some(0),
        [1, 0] => Some(end(0)),
        [1, 1] => Some(opposite(0)),
        [0, 1] => Some(end(1)),
        [-1, 1] => Some(opposite(1)),
        [-1, 0] => Some(end(2)),
        [0, -1] => Some(end(valence - 1)),
        [1, -1] => Some(opposite(valence - 1)),
        [-1, -1] => (valence == 4).then(|| opposite(2)),
        place => {
            let outer = OUTER.iter().position(|&outer| outer == place);
            outer.map(|outer| 2 * valence + 1 + outer)
        }
    }
}

/// An eigenvalue, and its vector.
#[derive(Clone, Debug)]
struct Mode {
    value: f64,
    vector: Vec<f64>,
}

/// The eigenvectors of a valence, of which the first is one everywhere and has the eigenvalue 1.
#[derive(Clone, Debug)]
pub struct Eigenbasis {
    valence: usize,
    modes: Vec<Mode>,
}

/// The three pieces that a face falls into beside its extraordinary corner, as places of their lower left corners.
pub const PIECES: [[i32; 2]; 3] = [[1, 0], [0, 1], [1, 1]];

impl Eigenbasis {
    /// Of a valence of 3 or more.
    pub fn new(valence: usize) -> Eigenbasis {
        let mut modes = ring_modes(valence);
        for mode in &mut modes {
            let beyond = beyond(valence, mode);
            mode.vector.extend(beyond);
        }
        modes.extend(OUTER_VALUES.iter().enumerate().map(|(number, &value)| {
            let mut vector = vec![0.0; 2 * valence + 1];
            let mut coordinates = [0.0; 7];
            coordinates[number] = 1.0;
            vector.extend(outer_vector(coordinates));
            Mode { value, vector }
        }));
        Eigenbasis { valence, modes }
    }

    /// The eigenvalues.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.modes.iter().map(|mode| mode.value)
    }

    /// By what each vertex adds to the vectors: row i is that of vector i. The inverse of the matrix of eigenvectors.
    pub fn inverse(&self) -> Vec<Vec<f64>> {
        let size = vertices(self.valence);
        let columns = (0..size).map(|vertex| {
            let mut values = vec![0.0; size];
            values[vertex] = 1.0;
            self.coordinates(&values)
        });
        let columns: Vec<Vec<f64>> = columns.collect();
        let row = |i: usize| columns.iter().map(|column| column[i]).collect();
        (0..size).map(row).collect()
    }

    /// The sum of vectors that values at the vertices are.
    fn coordinates(&self, values: &[f64]) -> Vec<f64> {
        let n = self.valence;
        let ring = 2 * n + 1;
        let mut found = ring_coordinates(n, &values[..ring]);
        let mut rest: [f64; 7] = std::array::from_fn(|i| values[ring + i]);
        for (mode, share) in self.modes.iter().zip(&found) {
            for (rest, own) in rest.iter_mut().zip(&mode.vector[ring..]) {
                *rest -= share * own;
            }
        }
        found.extend(outer_coordinates(rest));
        found
    }

    /// The control points, number x + 4 y, of the B-spline that a vector is on a piece.
    pub fn coefficients(&self, vector: usize, [x, y]: [i32; 2]) -> [f64; 16] {
        let mode = &self.modes[vector];
        std::array::from_fn(|i| {
            let [i, j] = [i % 4, i / 4].map(|i| i as i32 - 1);
            self.refined(mode, [x + i, y + j])
        })
    }

    /// What a vector becomes at a place of the refined grid, -1..=3.
    fn refined(&self, mode: &Mode, place: [i32; 2]) -> f64 {
        if let Some(vertex) = on_grid(self.valence, place) {
            return mode.value * mode.vector[vertex];
        }
        let [by_x, by_y] = place.map(halved);
        let products = by_x.iter().flat_map(|&(x, a)| {
            by_y.iter().map(move |&(y, b)| {
                let vertex = on_grid(self.valence, [x, y]);
                let vertex = vertex.expect("what is refined is away from the extraordinary vertex");
                a * b * mode.vector[vertex]
            })
        });
        products.sum()
    }
}

/// The rule of cubic B-splines: a place of the refined grid along one direction, by places of the grid.
fn halved(place: i32) -> Vec<(i32, f64)> {
    let low = place.div_euclid(2);
    match place.rem_euclid(2) {
        0 => vec![(low - 1, 0.125), (low, 0.75), (low + 1, 0.125)],
        _ => vec![(low, 0.5), (low + 1, 0.5)],
    }
}

/// What is the same all around: the vertex, its edges' ends, the vertices opposite; by the same of the level before.
fn around(valence: usize) -> DMat3 {
    let n = valence as f64;
    let rows = [
        DVec3::new(1.0 - 7.0 / (4.0 * n), 1.5 / n, 0.25 / n),
        DVec3::new(0.375, 0.5, 0.125),
        DVec3::new(0.25, 0.5, 0.25),
    ];
    DMat3::from_cols(rows[0], rows[1], rows[2]).transpose()
}

/// Its eigenvalues beside 1, and all its vectors. The sum and the product of the values are the trace and the determinant.
fn constant_modes(valence: usize) -> ([f64; 3], DMat3) {
    let matrix = around(valence);
    let half = 0.5 * (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z - 1.0);
    let root = (half * half - matrix.determinant()).sqrt();
    let values = [1.0, half + root, half - root];
    let vector = |value: f64| {
        let rows = matrix.transpose();
        let null = (rows.y_axis - value * DVec3::Y).cross(rows.z_axis - value * DVec3::Z);
        null / null.abs().max_element()
    };
    let vectors = DMat3::from_cols(DVec3::ONE, vector(values[1]), vector(values[2]));
    (values, vectors)
}

/// The waves of a frequency, seen from the face's diagonal: their values, and their heights at edges' ends and opposite to the vertex.
fn waves(valence: usize, frequency: usize) -> ([f64; 2], DMat2) {
    let angle = TAU * frequency as f64 / valence as f64;
    let cosine = angle.cos();
    let root = ((9.0 + cosine) * (1.0 + cosine)).sqrt();
    let values = [root, -root].map(|root| (5.0 + cosine + root) / 16.0);
    let vector = |value: f64| {
        let heights = DVec2::new(value - 0.25, 0.5 * (0.5 * angle).cos());
        heights / heights.abs().max_element()
    };
    (
        values,
        DMat2::from_cols(vector(values[0]), vector(values[1])),
    )
}

/// Frequencies at which waves come in pairs, a cosine and a sine.
fn frequencies(valence: usize) -> std::ops::Range<usize> {
    1..valence.div_ceil(2)
}

/// A wave of a frequency and phase, at the end of edge j and opposite to the vertex in the face that follows it.
fn wave(valence: usize, frequency: usize, phase: fn(f64) -> f64, j: usize) -> DVec2 {
    let angle = TAU * frequency as f64 / valence as f64;
    let turn = angle * j as f64;
    DVec2::new(phase(turn - 0.5 * angle), phase(turn))
}

const PHASES: [fn(f64) -> f64; 2] = [f64::cos, f64::sin];

/// The sign of what alternates from edge to edge.
fn sign(j: usize) -> f64 {
    if j.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// The eigenvectors of the 1-ring, on the 1-ring.
fn ring_modes(valence: usize) -> Vec<Mode> {
    let mut modes = Vec::with_capacity(vertices(valence));
    let mut push = |value: f64, vertex: f64, pair: &dyn Fn(usize) -> DVec2| {
        let pairs = (0..valence).flat_map(|j| pair(j).to_array());
        modes.push(Mode {
            value,
            vector: std::iter::once(vertex).chain(pairs).collect(),
        });
    };
    let (values, vectors) = constant_modes(valence);
    for (i, value) in values.into_iter().enumerate() {
        let heights = vectors.col(i);
        push(value, heights.x, &|_| DVec2::new(heights.y, heights.z));
    }
    for frequency in frequencies(valence) {
        let (values, heights) = waves(valence, frequency);
        for phase in PHASES {
            for (i, value) in values.into_iter().enumerate() {
                let height = heights.col(i);
                push(value, 0.0, &|j| height * wave(valence, frequency, phase, j));
            }
        }
    }
    // At half the valence the two do not mix: both have the value 1/4.
    if valence.is_multiple_of(2) {
        push(0.25, 0.0, &|j| DVec2::new(sign(j), 0.0));
        push(0.25, 0.0, &|j| DVec2::new(0.0, sign(j)));
    }
    modes
}

/// The sum of the vectors of [`ring_modes`] that values at the 1-ring are. Waves of different frequency or phase are orthogonal.
fn ring_coordinates(valence: usize, values: &[f64]) -> Vec<f64> {
    let n = valence as f64;
    let pair = |j: usize| DVec2::new(values[1 + 2 * j], values[2 + 2 * j]);
    let mean: DVec2 = (0..valence).map(pair).sum::<DVec2>() / n;
    let (_, vectors) = constant_modes(valence);
    let constant = vectors.inverse() * DVec3::new(values[0], mean.x, mean.y);
    let mut found = constant.to_array().to_vec();
    for frequency in frequencies(valence) {
        let (_, heights) = waves(valence, frequency);
        for phase in PHASES {
            let products = (0..valence).map(|j| pair(j) * wave(valence, frequency, phase, j));
            let heard = products.sum::<DVec2>() * (2.0 / n);
            found.extend((heights.inverse() * heard).to_array());
        }
    }
    if valence.is_multiple_of(2) {
        let alternating = (0..valence).map(|j| sign(j) * pair(j)).sum::<DVec2>() / n;
        found.extend(alternating.to_array());
    }
    found
}

/// The eigenvalues of what lies beyond the 1-ring: those along one side, along the other, and of the corner.
const OUTER_VALUES: [f64; 7] = [
    1.0 / 8.0,
    1.0 / 16.0,
    1.0 / 32.0,
    1.0 / 8.0,
    1.0 / 16.0,
    1.0 / 32.0,
    1.0 / 64.0,
];

/// The vectors along a side, towards the corner: of the matrix of three neighbours on a cubic B-spline.
const SIDE: DMat3 = DMat3::from_cols_array(&[1.0, 1.0, 1.0, -1.0, 0.0, 1.0, 1.0, -0.5, 1.0]);

/// What a vector along a side has at the corner, where it is refined with weights of 6/64 and 1/64.
fn at_corner(number: usize) -> f64 {
    let side = SIDE.col(number);
    (6.0 * side.z + side.y) / (64.0 * OUTER_VALUES[number] - 1.0)
}

/// A sum of the eigenvectors beyond the 1-ring.
fn outer_vector(coordinates: [f64; 7]) -> [f64; 7] {
    let [a, b, c, d, e, f, corner] = coordinates;
    let sides = [DVec3::new(a, b, c), DVec3::new(d, e, f)];
    let [one, other] = sides.map(|side| SIDE * side);
    let corners = sides.iter().map(|side| {
        let products = (0..3).map(|i| at_corner(i) * side[i]);
        products.sum::<f64>()
    });
    let corner = corner + corners.sum::<f64>();
    [one.x, one.y, one.z, corner, other.z, other.y, other.x]
}

/// The sum of these eigenvectors that values are.
fn outer_coordinates([a, b, c, corner, d, e, f]: [f64; 7]) -> [f64; 7] {
    let inverse = SIDE.inverse();
    let sides = [DVec3::new(a, b, c), DVec3::new(f, e, d)].map(|side| inverse * side);
    let corners = sides.iter().map(|side| {
        let products = (0..3).map(|i| at_corner(i) * side[i]);
        products.sum::<f64>()
    });
    let corner = corner - corners.sum::<f64>();
    let [one, other] = sides;
    [one.x, one.y, one.z, other.x, other.y, other.z, corner]
}

/// What an eigenvector of the 1-ring has beyond it (Stam 1998, equation 20): what the 1-ring brings there, in the eigenvectors beyond, each over the difference of the values.
/// Where both are one value, as they are at a quarter of the valence, nothing is brought.
fn beyond(valence: usize, mode: &Mode) -> [f64; 7] {
    let brought = OUTER.map(|place| {
        let [by_x, by_y] = place.map(halved);
        let products = by_x.iter().flat_map(|&(x, a)| {
            by_y.iter().map(move |&(y, b)| {
                let vertex = on_grid(valence, [x, y]).filter(|&vertex| vertex <= 2 * valence);
                vertex.map_or(0.0, |vertex| a * b * mode.vector[vertex])
            })
        });
        products.sum()
    });
    let mut coordinates = outer_coordinates(brought);
    for (coordinate, outer) in coordinates.iter_mut().zip(OUTER_VALUES) {
        let apart = mode.value - outer;
        *coordinate = if apart.abs() < 1e-12 {
            assert!(coordinate.abs() < 1e-12, "no matrix is defective");
            0.0
        } else {
            *coordinate / apart
        };
    }
    outer_vector(coordinates)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What becomes of values at the vertices of a face's limit, by Catmull and Clark's rules.
    fn refined(valence: usize, values: &[f64]) -> Vec<f64> {
        let n = valence as f64;
        let [end, opposite] = [1, 2].map(|first| move |j: usize| values[first + 2 * (j % valence)]);
        let mut next = vec![0.0; values.len()];
        let all = |of: &dyn Fn(usize) -> f64| (0..valence).map(of).sum::<f64>();
        next[0] = (1.0 - 7.0 / (4.0 * n)) * values[0]
            + 1.5 / (n * n) * all(&end)
            + 0.25 / (n * n) * all(&opposite);
        for j in 0..valence {
            let before = j + valence - 1;
            next[1 + 2 * j] = 0.375 * (values[0] + end(j))
                + (end(before) + end(j + 1) + opposite(before) + opposite(j)) / 16.0;
            next[2 + 2 * j] = 0.25 * (values[0] + end(j) + end(j + 1) + opposite(j));
        }
        for (i, place) in OUTER.into_iter().enumerate() {
            let [by_x, by_y] = place.map(halved);
            for (x, a) in by_x {
                for &(y, b) in &by_y {
                    let vertex = on_grid(valence, [x, y]).expect("it is on the grid");
                    next[2 * valence + 1 + i] += a * b * values[vertex];
                }
            }
        }
        next
    }

    #[test]
    fn vectors_are_eigenvectors_of_the_rules_at_every_valence() {
        for valence in 3..=50 {
            let basis = Eigenbasis::new(valence);
            assert_eq!(basis.modes.len(), vertices(valence));
            assert!(
                basis.modes[0]
                    .vector
                    .iter()
                    .all(|x| (x - 1.0).abs() < 1e-14)
            );
            for mode in &basis.modes {
                let next = refined(valence, &mode.vector);
                for (next, own) in next.iter().zip(&mode.vector) {
                    assert!((next - mode.value * own).abs() < 1e-13, "{valence}");
                }
            }
        }
    }

    #[test]
    fn vectors_are_a_basis_at_every_valence() {
        for valence in 3..=50 {
            let basis = Eigenbasis::new(valence);
            for (i, row) in basis.inverse().iter().enumerate() {
                for (j, mode) in basis.modes.iter().enumerate() {
                    let product: f64 = row.iter().zip(&mode.vector).map(|(a, b)| a * b).sum();
                    let right = f64::from(u8::from(i == j));
                    assert!((product - right).abs() < 1e-11, "{valence}: {i} {j}");
                }
            }
        }
    }
}
