//! A point of the limit with its derivatives, and how far rounding may have moved these: what is left of a sum that cancels is no direction.

use std::ops::{Add, Mul};

use glam::{DVec2, DVec3};

use crate::subdivision::limit::LimitStencil;

/// A sum of weighted points, and a bound on its rounding error in each coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sum {
    pub value: DVec3,
    pub error: f64,
}

/// A point with its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Jet {
    pub position: DVec3,
    pub du: Sum,
    pub dv: Sum,
}

/// Roundings that went into a point and a weight before they met: each level of refinement adds a few, and masks have some of their own.
const EARLIER: usize = 64;

/// How many times its own error a sum has to be to count as a direction: its angle is right to a thousandth then at worst, and far better as
/// errors go, which do not all add up.
pub(super) const CLEAR: f64 = 1024.0;

impl Sum {
    /// The sum over a mask. A sum of n products errs by no more than n units of rounding of the sum of their absolute values (Higham 2002, section
    /// 3.1). That bound says something only where points are relative to one near by.
    pub fn of(mask: &[(u32, f64)], points: &[DVec3]) -> Sum {
        let (mut value, mut absolute) = (DVec3::ZERO, 0.0);
        for &(vertex, weight) in mask {
            let point = points[vertex as usize];
            value += point * weight;
            absolute += weight.abs() * point.abs().max_element();
        }
        let roundings = (mask.len() + EARLIER) as f64;
        Sum {
            value,
            error: roundings * 0.5 * f64::EPSILON * absolute,
        }
    }

    /// The difference of two points.
    pub fn between(from: DVec3, to: DVec3) -> Sum {
        Sum::of(&[(0, -1.0), (1, 1.0)], &[from, to])
    }

    /// Whether there is more to it than rounding; as a vector of length about 1, with the error to the same scale.
    fn direction(self) -> Option<Sum> {
        let greatest = self.value.abs().max_element();
        // Not if anything is NaN.
        (greatest > CLEAR * self.error).then(|| Sum {
            value: self.value / greatest,
            error: self.error / greatest,
        })
    }
}

impl Add for Sum {
    type Output = Sum;

    fn add(self, other: Sum) -> Sum {
        Sum {
            value: self.value + other.value,
            error: self.error + other.error,
        }
    }
}

impl Mul<f64> for Sum {
    type Output = Sum;

    fn mul(self, factor: f64) -> Sum {
        Sum {
            value: self.value * factor,
            error: self.error * factor.abs(),
        }
    }
}

impl Jet {
    /// What a stencil makes of points.
    pub fn of(stencil: &LimitStencil, points: &[DVec3]) -> Jet {
        Jet {
            position: Sum::of(&stencil.position, points).value,
            du: Sum::of(&stencil.du, points),
            dv: Sum::of(&stencil.dv, points),
        }
    }

    /// With derivatives by parameters that run so much slower.
    pub fn scaled(self, scale: f64) -> Jet {
        Jet {
            du: self.du * scale,
            dv: self.dv * scale,
            ..self
        }
    }

    /// Elsewhere, and with so much more error in the points that the derivatives are taken of.
    pub fn moved(self, by: DVec3) -> Jet {
        Jet {
            position: self.position + by,
            ..self
        }
    }

    /// With derivatives that err by so much more.
    pub fn blurred(mut self, error: f64) -> Jet {
        self.du.error += error;
        self.dv.error += error;
        self
    }

    /// The unit normal, on the side from which the parameters run counter-clockwise; none where that is left to rounding.
    pub fn normal(&self) -> Option<DVec3> {
        let (du, dv) = (self.du.direction()?, self.dv.direction()?);
        let normal = du.value.cross(dv.value);
        let (a, b) = (du.value.length(), dv.value.length());
        let error = du.error * b + dv.error * a + 2.0 * f64::EPSILON * a * b;
        (normal.length() > CLEAR * error).then(|| normal.normalize())
    }

    /// How much the derivatives span beside the mean of their squares: the sine between them where they have one length, less elsewhere.
    pub fn spread(&self) -> f64 {
        let (du, dv) = (self.du.value, self.dv.value);
        let longer = du.length().max(dv.length());
        if longer > 0.0 {
            let (a, b) = (du / longer, dv / longer);
            2.0 * a.cross(b).length() / (a.length_squared() + b.length_squared())
        } else {
            0.0
        }
    }
}

/// Makes points relative to one of them, and that to what it was relative to.
pub(super) fn recentred(points: &mut [DVec3], origin: &mut DVec3, vertex: u32) {
    let at = points[vertex as usize];
    points.iter_mut().for_each(|point| *point -= at);
    *origin += at;
}

/// The corner of a face that (u, v) is nearest to.
pub(super) fn nearest_corner(uv: DVec2) -> u32 {
    match (uv.x < 0.5, uv.y < 0.5) {
        (true, true) => 0,
        (false, true) => 1,
        (false, false) => 2,
        (true, false) => 3,
    }
}
