//! The uniform cubic B-spline.

/// Weights of four control points, and of their derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// Values; they sum to 1.
    pub value: [f64; 4],
    /// Derivatives; they sum to 0.
    pub derivative: [f64; 4],
}

/// The cubic B-spline basis at `t` in 0..=1 of the middle interval.
pub fn basis(t: f64) -> Basis {
    let s = 1.0 - t;
    Basis {
        value: [
            s * s * s / 6.0,
            (4.0 + t * t * (3.0 * t - 6.0)) / 6.0,
            (4.0 + s * s * (3.0 * s - 6.0)) / 6.0,
            t * t * t / 6.0,
        ],
        derivative: [
            -0.5 * s * s,
            t * (1.5 * t - 2.0),
            -s * (1.5 * s - 2.0),
            0.5 * t * t,
        ],
    }
}
