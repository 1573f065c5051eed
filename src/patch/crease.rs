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

#[cfg(test)]
mod tests {
    use super::*;

    /// One refinement of control values p0..p3 whose crease through p1 has the given sharpness: those of the half 0..0.5 or 0.5..1 of
    /// the segment from p1 to p2. Vertex points of a crease stay while it is 1 or more sharp, those of a smooth curve move.
    fn refined([p0, p1, p2, p3]: [f64; 4], sharpness: f64, upper: bool) -> [f64; 4] {
        let middle = |a: f64, b: f64| 0.5 * (a + b);
        let vertex = |a: f64, b: f64, c: f64| 0.125 * (a + 6.0 * b + c);
        let share = sharpness.min(1.0);
        let (q1, q2) = (middle(p0, p1), middle(p1, p2));
        let (q3, q4) = (vertex(p1, p2, p3), middle(p2, p3));
        let creased = share * p1 + (1.0 - share) * vertex(p0, p1, p2);
        if upper {
            [creased, q2, q3, q4]
        } else {
            [q1, creased, q2, q3]
        }
    }

    /// Value and derivative at t by refinement until nothing is sharp.
    fn reference(points: [f64; 4], sharpness: f64, t: f64, scale: f64) -> [f64; 2] {
        if sharpness <= 0.0 {
            let Basis { value, derivative } = basis(t);
            let sum =
                |weights: [f64; 4]| weights.iter().zip(points).map(|(w, p)| w * p).sum::<f64>();
            return [sum(value), scale * sum(derivative)];
        }
        let upper = t >= 0.5;
        let half = refined(points, sharpness, upper);
        // The upper half has left the crease behind.
        let rest = if upper { 0.0 } else { sharpness - 1.0 };
        reference(
            half,
            rest,
            2.0 * t - f64::from(u8::from(upper)),
            2.0 * scale,
        )
    }

    #[test]
    fn weights_are_those_of_refinement_at_every_sharpness() {
        for sharpness in (1..=99).map(|i| i as f32 / 10.0) {
            for i in 0..=64 {
                let t = f64::from(i) / 64.0;
                let Basis { value, derivative } = crease_basis(t, sharpness);
                for number in 0..4 {
                    let mut unit = [0.0; 4];
                    unit[number] = 1.0;
                    let [expected, slope] = reference(unit, f64::from(sharpness), t, 1.0);
                    let place = format!("weight {number} at {t}, sharpness {sharpness}");
                    assert!((value[number] - expected).abs() < 1e-13, "{place}");
                    assert!((derivative[number] - slope).abs() < 1e-12, "{place}");
                }
            }
        }
    }

    #[test]
    fn weights_sum_to_one_and_their_derivatives_to_zero() {
        for (sharpness, i) in (1..=40).flat_map(|s| (0..=50).map(move |i| (s, i))) {
            let Basis { value, derivative } =
                crease_basis(f64::from(i) / 50.0, sharpness as f32 / 4.0);
            assert!((value.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(derivative.iter().sum::<f64>().abs() < 1e-12);
        }
    }

    #[test]
    fn a_crease_that_fades_is_the_smooth_curve() {
        let (faded, smooth) = (crease_basis(0.3f64, 1e-7), basis(0.3f64));
        for i in 0..4 {
            assert!((faded.value[i] - smooth.value[i]).abs() < 1e-6);
        }
    }
}
