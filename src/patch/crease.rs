//! The cubic B-spline across one semi-sharp crease (Nießner, Loop, Greiner 2012, "Efficient evaluation of semi-smooth creases").
//!
//! The crease passes through the second of four control points p0..p3, at t = 0. While its sharpness is 1 or more, each refinement leaves
//! that point where it is; the last, of sharpness r < 1, takes r of the sharp rule and 1 - r of the smooth one. Brainerd et al. 2016,
//! section 6.2, apply the resulting matrix to the basis instead of the control points. In closed form, with a = 2^-n and e = 8^-n,
//! the control points after n sharp refinements are
//!
//! ```text
//! q0 = p1 + a (p0 - p1)    q1 = p1    q2 = p1 + a (p2 - p1)    q3 = p1 + 2a (p2 - p1) + e (p3 - 2 p2 + p1)
//! ```

use crate::patch::bspline::{Basis, basis};

/// The basis at `t` in 0..=1 across a crease of `sharpness` > 0 at t = 0; as weights of p0..p3.
pub fn crease_basis(t: f64, sharpness: f64) -> Basis {
    let level = sharpness.floor();
    let fraction = sharpness - level;
    let lower = after_sharp_levels(t, level as i32);
    if fraction == 0.0 {
        return lower;
    }
    let upper = after_sharp_levels(t, level as i32 + 1);
    let mix = |a: [f64; 4], b: [f64; 4]| std::array::from_fn(|i| a[i] + fraction * (b[i] - a[i]));
    Basis {
        value: mix(lower.value, upper.value),
        derivative: mix(lower.derivative, upper.derivative),
    }
}

/// The basis when the first `level` refinements are sharp and all others smooth.
fn after_sharp_levels(t: f64, level: i32) -> Basis {
    let scale = 2f64.powi(level);
    if t * scale >= 1.0 {
        let Basis { value, derivative } = basis(t);
        return Basis {
            value: sharp(value),
            derivative: sharp(derivative),
        };
    }
    let Basis { value, derivative } = basis(t * scale);
    let refined = |b| refined(b, 1.0 / scale);
    Basis {
        value: refined(value),
        derivative: refined(derivative).map(|weight| weight * scale),
    }
}

/// Beyond the last sharp level's first interval the curve is that of an infinite crease: p0 gives way to 2 p1 - p2.
fn sharp([b0, b1, b2, b3]: [f64; 4]) -> [f64; 4] {
    [0.0, b1 + 2.0 * b0, b2 - b0, b3]
}

/// Weights of q0..q3 turned into weights of p0..p3; `a` = 2^-n.
fn refined([b0, b1, b2, b3]: [f64; 4], a: f64) -> [f64; 4] {
    let e = a * a * a;
    [
        b0 * a,
        b0 * (1.0 - a) + b1 + b2 * (1.0 - a) + b3 * (1.0 - 2.0 * a + e),
        b2 * a + b3 * (2.0 * a - 2.0 * e),
        b3 * e,
    ]
}
