//! The uniform cubic B-spline. Twin of `glsl/lib/bspline.glsl`.

use super::Real;

/// Weights of four control points, and of their derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis<T> {
    /// Values; they sum to 1.
    pub value: [T; 4],
    /// Derivatives; they sum to 0.
    pub derivative: [T; 4],
}

/// The cubic B-spline basis at `t` in 0..=1 of the middle interval.
pub fn basis<T: Real>(t: T) -> Basis<T> {
    basis_of(t, T::from(1.0) - t)
}

/// The basis at `t`, where `s` is 1 - t. With both exchanged it is the same basis from the other end, bit by bit.
pub fn basis_of<T: Real>(t: T, s: T) -> Basis<T> {
    let c = |x: f32| T::from(x);
    let sixth = c(1.0) / c(6.0);
    Basis {
        value: [
            s * s * s * sixth,
            (c(4.0) + t * t * (c(3.0) * t - c(6.0))) * sixth,
            (c(4.0) + s * s * (c(3.0) * s - c(6.0))) * sixth,
            t * t * t * sixth,
        ],
        derivative: [
            c(-0.5) * s * s,
            t * (c(1.5) * t - c(2.0)),
            s * (c(2.0) - c(1.5) * s),
            c(0.5) * t * t,
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// De Boor's blossom: the cubic through repeated interpolation of the control values at knots -2..=3.
    fn blossom(points: [f64; 4], t: f64) -> f64 {
        let mut points = points;
        for width in (1..=3).rev() {
            for i in 0..width {
                let low = i as f64 - width as f64 + 1.0;
                let share = (t - low) / width as f64;
                points[i] += share * (points[i + 1] - points[i]);
            }
        }
        points[0]
    }

    #[test]
    fn weights_sum_to_one_and_their_derivatives_to_zero() {
        for i in 0..=100 {
            let Basis { value, derivative } = basis(f64::from(i) / 100.0);
            assert!((value.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!(derivative.iter().sum::<f64>().abs() < 1e-15);
            assert!(value.iter().all(|&weight| weight >= 0.0));
        }
    }

    #[test]
    fn weights_are_those_of_repeated_interpolation() {
        for i in 0..=20 {
            let t = f64::from(i) / 20.0;
            for (number, weight) in basis(t).value.into_iter().enumerate() {
                let mut unit = [0.0; 4];
                unit[number] = 1.0;
                assert!((blossom(unit, t) - weight).abs() < 1e-15, "{number} at {t}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_weights() {
        let step = 1e-6;
        for i in 1..20 {
            let t = f64::from(i) / 20.0;
            let (before, after) = (basis(t - step).value, basis(t + step).value);
            for number in 0..4 {
                let slope = (after[number] - before[number]) / (2.0 * step);
                assert!((slope - basis(t).derivative[number]).abs() < 1e-9);
            }
        }
    }
}
