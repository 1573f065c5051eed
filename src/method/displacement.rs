//! A procedural displacement along the normal, to show that it opens no cracks. Twin of `glsl/lib/displacement.glsl`.

use glam::Vec3;

use crate::method::unit::unit;

/// Bumps on a lattice, as high as they say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    /// The height of the bumps in local units; 0 for no displacement.
    pub height: f32,
    /// Bumps a local unit of length.
    pub frequency: f32,
}

impl Displacement {
    /// Moves a point along its normal; the normal follows to first order. Nothing but position and normal has a say: where faces have the same
    /// bits of both, they still have them afterwards.
    pub fn displace(&self, position: Vec3, normal: Vec3) -> (Vec3, Vec3) {
        let at = position * self.frequency;
        let f = at - at.floor();
        let rest = Vec3::ONE - f;
        let wave = (f * rest) * (f * rest) * 16.0;
        let height = ((wave.x + wave.y) + wave.z) / 3.0;
        let slope = (f * rest) * (rest - f) * (32.0 / 3.0);
        let gradient = slope * (self.height * self.frequency);
        let along = (gradient.x * normal.x + gradient.y * normal.y) + gradient.z * normal.z;
        (
            position + (self.height * height) * normal,
            unit(normal - (gradient - along * normal)),
        )
    }
}
