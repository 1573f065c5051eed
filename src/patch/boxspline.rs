//! The quartic box spline on a triangle, the limit of Loop's rules where six triangles meet at each corner (Stam 1998, "Evaluation of Loop
//! subdivision surfaces", appendix A).
//!
//! With barycentric coordinates w = 1 - u - v, u, v, the twelve weights are three polynomials, turned and mirrored: of a corner of the triangle, of the
//! point beyond an edge, and of a point beyond a corner.

use super::Real;

/// Where the control points lie on the lattice in which the triangle's corners are (0,0), (1,0) and (0,1).
///
/// First the corners; then the points beyond edges 0-1, 1-2 and 2-0; then for each corner the two that touch nothing else of the triangle, in the
/// counter-clockwise order around it.
pub const LATTICE: [[i8; 2]; 12] = [
    [0, 0],
    [1, 0],
    [0, 1],
    [1, -1],
    [1, 1],
    [-1, 1],
    [-1, 0],
    [0, -1],
    [2, -1],
    [2, 0],
    [0, 2],
    [-1, 2],
];

/// Weights of the twelve control points, and of their derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis<T> {
    /// Values; they sum to 1.
    pub value: [T; 12],
    /// Derivatives by u; they sum to 0.
    pub du: [T; 12],
    /// Derivatives by v; they sum to 0.
    pub dv: [T; 12],
}

/// A term of a polynomial in three barycentric coordinates: twelve times its factor, and the exponents.
type Term = (f32, [u8; 3]);

/// A corner's weight; the first coordinate is its own.
const CORNER: [Term; 15] = [
    (6.0, [4, 0, 0]),
    (24.0, [3, 1, 0]),
    (24.0, [3, 0, 1]),
    (24.0, [2, 2, 0]),
    (60.0, [2, 1, 1]),
    (24.0, [2, 0, 2]),
    (8.0, [1, 3, 0]),
    (36.0, [1, 2, 1]),
    (36.0, [1, 1, 2]),
    (8.0, [1, 0, 3]),
    (1.0, [0, 4, 0]),
    (6.0, [0, 3, 1]),
    (12.0, [0, 2, 2]),
    (6.0, [0, 1, 3]),
    (1.0, [0, 0, 4]),
];

/// The weight of the point beyond the edge between the first two coordinates' corners.
const BEYOND_EDGE: [Term; 9] = [
    (1.0, [4, 0, 0]),
    (6.0, [3, 1, 0]),
    (12.0, [2, 2, 0]),
    (6.0, [1, 3, 0]),
    (1.0, [0, 4, 0]),
    (2.0, [3, 0, 1]),
    (6.0, [2, 1, 1]),
    (6.0, [1, 2, 1]),
    (2.0, [0, 3, 1]),
];

/// The weight of a point beyond the first coordinate's corner, next to that beyond its edge to the second's.
const BEYOND_CORNER: [Term; 2] = [(1.0, [4, 0, 0]), (2.0, [3, 1, 0])];

/// Which polynomial belongs to each control point, and which corners take the part of its coordinates.
const POINTS: [(&[Term], [usize; 3]); 12] = [
    (&CORNER, [0, 1, 2]),
    (&CORNER, [1, 2, 0]),
    (&CORNER, [2, 0, 1]),
    (&BEYOND_EDGE, [0, 1, 2]),
    (&BEYOND_EDGE, [1, 2, 0]),
    (&BEYOND_EDGE, [2, 0, 1]),
    (&BEYOND_CORNER, [0, 2, 1]),
    (&BEYOND_CORNER, [0, 1, 2]),
    (&BEYOND_CORNER, [1, 0, 2]),
    (&BEYOND_CORNER, [1, 2, 0]),
    (&BEYOND_CORNER, [2, 1, 0]),
    (&BEYOND_CORNER, [2, 0, 1]),
];

/// The basis at (u, v), u and v from 0 and u + v to 1.
pub fn basis<T: Real>(u: T, v: T) -> Basis<T> {
    let zero = T::from(0.0);
    let coordinates = [T::from(1.0) - u - v, u, v];
    let powers = coordinates.map(|x| {
        let square = x * x;
        [T::from(1.0), x, square, square * x, square * square]
    });
    let mut basis = Basis {
        value: [zero; 12],
        du: [zero; 12],
        dv: [zero; 12],
    };
    for (point, (terms, corners)) in POINTS.into_iter().enumerate() {
        let powers = corners.map(|corner| powers[corner]);
        let mut slopes = [zero; 3];
        for &(factor, exponents) in terms {
            let factor = T::from(factor) / T::from(12.0);
            let power = |i: usize| powers[i][exponents[i] as usize];
            basis.value[point] = basis.value[point] + factor * power(0) * power(1) * power(2);
            for i in (0..3).filter(|&i| exponents[i] > 0) {
                let (exponent, [j, k]) = (exponents[i], [(i + 1) % 3, (i + 2) % 3]);
                let slope = T::from(f32::from(exponent)) * powers[i][exponent as usize - 1];
                let corner = corners[i];
                slopes[corner] = slopes[corner] + factor * slope * power(j) * power(k);
            }
        }
        basis.du[point] = slopes[1] - slopes[0];
        basis.dv[point] = slopes[2] - slopes[0];
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> impl Iterator<Item = [f64; 2]> {
        (0..=12).flat_map(|i| (0..=12 - i).map(move |j| [f64::from(i) / 12.0, f64::from(j) / 12.0]))
    }

    #[test]
    fn weights_sum_to_one_and_their_derivatives_to_zero() {
        for [u, v] in grid() {
            let Basis { value, du, dv } = basis(u, v);
            assert!((value.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!(du.iter().sum::<f64>().abs() < 1e-15);
            assert!(dv.iter().sum::<f64>().abs() < 1e-15);
            assert!(value.iter().all(|&weight| weight >= -1e-16));
        }
    }

    #[test]
    fn linear_functions_of_the_lattice_stay() {
        for [u, v] in grid() {
            let basis = basis(u, v);
            for axis in 0..2 {
                let at = |weights: [f64; 12]| -> f64 {
                    (0..12)
                        .map(|i| weights[i] * f64::from(LATTICE[i][axis]))
                        .sum()
                };
                assert!((at(basis.value) - [u, v][axis]).abs() < 1e-15);
                assert!((at(basis.du) - [1.0, 0.0][axis]).abs() < 1e-14);
                assert!((at(basis.dv) - [0.0, 1.0][axis]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_weights() {
        let step = 1e-6;
        for [u, v] in grid() {
            let Basis { du, dv, .. } = basis(u, v);
            let (right, left) = (basis(u + step, v).value, basis(u - step, v).value);
            let (up, down) = (basis(u, v + step).value, basis(u, v - step).value);
            for i in 0..12 {
                assert!(((right[i] - left[i]) / (2.0 * step) - du[i]).abs() < 1e-9);
                assert!(((up[i] - down[i]) / (2.0 * step) - dv[i]).abs() < 1e-9);
            }
        }
    }
}
