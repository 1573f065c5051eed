//! Where a mesh lies and how large it is.

use glam::{DMat4, DVec3};

/// How local positions, of about unit size around the origin, relate to those of a mesh. Everything is computed from local positions: so a mesh
/// scaled by a power of two gives the same bits, one of any finite size neither overflows nor underflows, and one far from the origin loses nothing.
///
/// Engines put it into the object matrix, see [`Placement::matrix`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The middle of the bounding box of all vertices that faces use, in units of the mesh.
    pub centre: DVec3,
    /// A unit of local positions in units of the mesh: the greatest power of two within half of the bounding box' longest side, so that local
    /// coordinates lie in -2..=2. 1 where the mesh has no extent.
    pub scale: f64,
}

impl Placement {
    /// The placement of finite points.
    pub(crate) fn of(points: impl IntoIterator<Item = DVec3>) -> Placement {
        let (low, high) = bounds(points);
        let middle = |axis: usize| f64::midpoint(low[axis], high[axis]);
        let centre = DVec3::from([0, 1, 2].map(middle));
        let half = (high - centre).max(centre - low).max_element();
        Placement {
            centre,
            scale: if half > 0.0 {
                power_of_two_in(half)
            } else {
                1.0
            },
        }
    }

    /// From units of the mesh to local ones.
    pub fn local(&self, position: DVec3) -> DVec3 {
        (position - self.centre) / self.scale
    }

    /// From local units to those of the mesh.
    pub fn position(&self, local: DVec3) -> DVec3 {
        self.centre + self.scale * local
    }

    /// The object matrix, from local positions to those of the mesh. Multiply it with the view in f64 and round once: f32 holds neither a scale
    /// beyond 2^127 nor a place far from the eye.
    pub fn matrix(&self) -> DMat4 {
        DMat4::from_translation(self.centre) * DMat4::from_scale(DVec3::splat(self.scale))
    }
}

/// The least and greatest corner of the points' bounding box; zero without any.
pub(super) fn bounds(points: impl IntoIterator<Item = DVec3>) -> (DVec3, DVec3) {
    let mut points = points.into_iter();
    let first = points.next().unwrap_or(DVec3::ZERO);
    points.fold((first, first), |(low, high), p| (low.min(p), high.max(p)))
}

/// The greatest power of two that is not greater than a finite `x` above 0; exact for subnormal numbers too.
fn power_of_two_in(x: f64) -> f64 {
    let exponent = x.to_bits() & f64::INFINITY.to_bits();
    if exponent != 0 {
        return f64::from_bits(exponent);
    }
    f64::from_bits(1 << x.to_bits().ilog2())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_of_two_is_exact_everywhere() {
        for (x, power) in [
            (1.0, 1.0),
            (1.9, 1.0),
            (f64::MAX, 2f64.powi(1023)),
            (f64::MIN_POSITIVE, f64::MIN_POSITIVE),
            (5e-324, 5e-324),
            (2e-323, 2e-323),
            (3e-320, f64::from_bits(1 << 12)),
        ] {
            assert_eq!(power_of_two_in(x), power, "{x}");
        }
    }

    #[test]
    fn local_positions_are_of_unit_size_whatever_the_mesh() {
        let [least, greatest] = [5e-324, f64::MAX];
        for [low, high] in [
            [-greatest, greatest],
            [-least, least],
            [0.99 * greatest, greatest],
            [-1.0, 1.5],
            [1e6, 1e6 + 1e-6],
        ] {
            let corners = [DVec3::splat(low), DVec3::splat(high)];
            let placement = Placement::of(corners);
            for corner in corners {
                let local = placement.local(corner);
                let size = local.abs().max_element();
                assert!((0.5..=2.0).contains(&size), "{low}..{high}: {local}");
                assert_eq!(placement.position(local), corner, "{low}..{high}");
                let by_matrix = placement.matrix().transform_point3(local);
                assert!(
                    by_matrix.distance(corner) <= 1e-15 * (high - low),
                    "{low}..{high}"
                );
            }
        }
        let point = Placement::of([DVec3::ONE]);
        assert_eq!((point.centre, point.scale), (DVec3::ONE, 1.0));
        assert_eq!(point.local(DVec3::ONE), DVec3::ZERO);
    }
}
