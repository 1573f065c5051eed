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
    let c = |x: f32| T::from(x);
    let s = c(1.0) - t;
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
