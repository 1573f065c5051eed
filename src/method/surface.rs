//! A point of a surface, and what it is computed from.

use glam::Vec3;

use crate::abi;

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
        normalized(normalized(self.du).cross(normalized(self.dv))) + Vec3::ZERO
    }

    /// The point with the normal that its tangents give.
    pub fn point(&self) -> SurfacePoint {
        SurfacePoint {
            position: self.position,
            normal: self.normal(),
        }
    }
}

/// Unit length, or zero where there is no direction. Scaled first, so that no square leaves the range of floats.
pub(super) fn normalized(v: Vec3) -> Vec3 {
    let greatest = v.abs().max_element();
    if greatest == 0.0 {
        Vec3::ZERO
    } else {
        (v / greatest).normalize()
    }
}
