//! What a surface is seen with.

use crate::abi;
use crate::method::Displacement;

/// What a surface is seen with. A frame has as many as it is drawn from, or its instances have places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From the local units of the model's [`Placement`](crate::mesh::Placement) to Vulkan's clip space; column by column.
    pub clip_from_model: [[f32; 4]; 4],
    /// The eye in local units.
    pub eye: [f32; 3],
    /// A displacement along the normal. Where the limit has several normals, on infinite creases and at cusps, points stay.
    pub displacement: Displacement,
}

impl View {
    /// As shaders see it.
    pub(super) fn record(&self) -> abi::View {
        abi::View {
            clip_from_model: self.clip_from_model,
            eye: self.eye,
            displacement: [self.displacement.height, self.displacement.frequency],
        }
    }
}
