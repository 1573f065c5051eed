//! The cubic B-spline across one semi-sharp crease (Nießner, Loop, Greiner 2012, "Efficient evaluation of semi-smooth creases").
//! Twin of `glsl/lib/crease.glsl`.
//!
//! The crease passes through the second of four control points p0..p3, at t = 0. While its sharpness is 1 or more, each refinement leaves
//! that point where it is; the last, of sharpness r < 1, takes r of the sharp rule and 1 - r of the smooth one. Brainerd et al. 2016,
//! section 6.2, apply the resulting matrix to the basis instead of the control points. In closed form, with a = 2^-n and e = 8^-n,
//! the control points after n sharp refinements are
//!
//! ```text
//! q0 = p1 + a (p0 - p1)    q1 = p1    q2 = p1 + a (p2 - p1)    q3 = p1 + 2a (p2 - p1) + e (p3 - 2 p2 + p1)
//! ```

use super::Real;
use super::bspline::{Basis, basis};

/// The basis at `t` in 0..=1 across a crease of `sharpness` > 0 at t = 0; as weights of p0..p3.
pub fn crease_basis<T: Real>(t: T, sharpness: f32) -> Basis<T> {
    let level = sharpness.floor();
    let fraction = T::from(sharpness - level);
    let lower = after_sharp_levels(t, level);
    let upper = after_sharp_levels(t, level + 1.0);
    let mix = |a: [T; 4], b: [T; 4]| std::array::from_fn(|i| a[i] + fraction * (b[i] - a[i]));
    Basis {
        value: mix(lower.value, upper.value),
        derivative: mix(lower.derivative, upper.derivative),
    }
}

/// The basis when the first `level` refinements are sharp and all others smooth.
fn after_sharp_levels<T: Real>(t: T, level: f32) -> Basis<T> {
    let scale = T::from(level.exp2());
    let one = T::from(1.0);
    if t * scale >= one {
        let Basis { value, derivative } = basis(t);
        return Basis {
            value: sharp(value),
            derivative: sharp(derivative),
        };
    }
    let Basis { value, derivative } = basis(t * scale);
    let refined = |b| refined(b, one / scale);
    Basis {
        value: refined(value),
        derivative: refined(derivative).map(|weight| weight * scale),
    }
}

/// Beyond the last sharp level's first interval the curve is that of an infinite crease: p0 gives way to 2 p1 - p2.
fn sharp<T: Real>([b0, b1, b2, b3]: [T; 4]) -> [T; 4] {
    [T::from(0.0), b1 + T::from(2.0) * b0, b2 - b0, b3]
}

/// Weights of q0..q3 turned into weights of p0..p3; `a` = 2^-n.
fn refined<T: Real>([b0, b1, b2, b3]: [T; 4], a: T) -> [T; 4] {
    let (one, two) = (T::from(1.0), T::from(2.0));
    let e = a * a * a;
    [
        b0 * a,
        b0 * (one - a) + b1 + b2 * (one - a) + b3 * (one - two * a + e),
        b2 * a + b3 * two * (a - e),
        b3 * e,
    ]
}
