//! A point of a surface, and what it is computed from.

use glam::Vec3;

use crate::abi;
use crate::method::unit::{scaled, unit};

/// A point of a patch as the evaluation shader computes it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePoint {
    /// Position in the local units of the model's [`Placement`](crate::mesh::Placement).
    pub position: Vec3,
    /// Unit normal; zero where there is none.
    pub normal: Vec3,
}

/// What patches are evaluated from. [`Prepared::controls`](super::Prepared::controls) makes it.
#[derive(Clone, Debug, Default)]
pub struct Controls {
    /// The control vertices in local units.
    pub vertices: Vec<Vec3>,
    /// What is computed from them beforehand.
    pub points: Vec<abi::Point>,
}

/// A point with its tangents. Twin of `Surface` in `glsl/lib/surface.glsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Surface {
    /// Position in the local units of the model's [`Placement`](crate::mesh::Placement).
    pub position: Vec3,
    /// Derivative by u.
    pub du: Vec3,
    /// Derivative by v.
    pub dv: Vec3,
}

impl Surface {
    /// The unit normal, as `glsl/lib/surface.glsl` computes it; zero where the tangents are parallel but for rounding. No zero is negative.
    pub fn normal(&self) -> Vec3 {
        let normal = unit(self.du).cross(unit(self.dv));
        if reach(normal) > PARALLEL {
            unit(normal)
        } else {
            Vec3::ZERO
        }
    }

    /// The point with the normal that its tangents give.
    pub fn point(&self) -> SurfacePoint {
        SurfacePoint {
            position: self.position,
            normal: self.normal(),
        }
    }
}

/// Two tangents, each with a bound on its rounding error. Twin of `glsl/lib/tangents.glsl`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tangents {
    /// The tangents.
    pub sums: [Vec3; 2],
    /// By how much a coordinate of each may be off.
    pub errors: [f32; 2],
}

/// A unit of rounding.
pub(super) const UNIT: f32 = 0.5 * f32::EPSILON;

/// How many times its own error a sum has to be to count as a direction. The bounds are never reached, as not all errors add up.
pub(super) const CLEAR: f32 = 4.0;

/// Where the limit's tangents count only if the surroundings have a normal like theirs: how much they span at least beside the sum of their squares, and
/// how far their normal may be from that nearby; squared. As in `subdivision/normals.rs`, of half the sum.
const FIRM: f32 = 1.0 / 1024.0;
const NEAR: f32 = 0.0076;

/// The greatest element.
pub(super) fn reach(v: Vec3) -> f32 {
    v.abs().max_element()
}

/// The power of two that brings a vector's greatest element to 2..4, as [`scaled`] does; 0 where that gives zero.
fn factor(v: Vec3) -> f32 {
    let exponent = reach(v).to_bits() & 0x7f80_0000;
    if exponent == 0 || exponent == 0x7f80_0000 {
        0.0
    } else {
        f32::from_bits((255 << 23) - exponent)
    }
}

impl Tangents {
    /// Whether they span a plane beyond what rounding may have made of them: by additions and multiplications alone, so that all devices agree.
    pub fn span_plane(&self) -> bool {
        let [a, b] = self.sums.map(scaled);
        let errors = [0, 1].map(|i| CLEAR * (factor(self.sums[i]) * self.errors[i]));
        // An element of the product errs by no more than twice each error times the other's greatest element, which is below 4.
        let bound = 8.0 * (errors[0] + errors[1]);
        errors[0] < 2.0 && errors[1] < 2.0 && reach(a.cross(b)) > bound
    }

    /// Whether they span enough beside their squares: not if they are nearly parallel, nor if one is far longer than the other.
    pub fn are_firm(&self) -> bool {
        let [du, dv] = self.sums;
        let grown = factor(if reach(du) > reach(dv) { du } else { dv });
        let (a, b) = (grown * du, grown * dv);
        let squares = a.dot(a) + b.dot(b);
        let area = a.cross(b);
        squares > 0.0 && area.dot(area) >= FIRM * (squares * squares)
    }

    /// Whether a normal and that nearby are so much alike that the former counts.
    pub fn are_near(own: Vec3, nearby: Vec3) -> bool {
        let apart = own - nearby;
        own != Vec3::ZERO && apart.dot(apart) < NEAR
    }

    /// The unit normal; zero where it is left to rounding.
    pub fn normal(&self) -> Vec3 {
        if self.span_plane() {
            unit(unit(self.sums[0]).cross(unit(self.sums[1])))
        } else {
            Vec3::ZERO
        }
    }
}

/// Less than this is rounding, in the product of unit vectors each of which is a sum of a patch's points: 2^-20, sixteen units of rounding.
const PARALLEL: f32 = 8.0 * f32::EPSILON;
