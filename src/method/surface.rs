//! A point of a surface, and what it is computed from.

use glam::Vec3;

use crate::abi;
use crate::method::unit::unit;

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
    /// The unit normal, as `glsl/lib/surface.glsl` computes it; zero where the tangents are parallel. No zero is negative.
    pub fn normal(&self) -> Vec3 {
        unit(unit(self.du).cross(unit(self.dv)))
    }

    /// The point with the normal that its tangents give.
    pub fn point(&self) -> SurfacePoint {
        SurfacePoint {
            position: self.position,
            normal: self.normal(),
        }
    }
}
