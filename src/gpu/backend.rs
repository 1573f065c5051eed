//! What a back-end is on the device: a row each. `frame/backend.rs` has what is decided without one.

use ash::vk::{PipelineStageFlags, PrimitiveTopology, ShaderStageFlags};

use crate::abi;
use crate::frame::Backend;

/// What a back-end is on the device.
pub(super) struct Row {
    /// The stages up to the fragment shader, and their modules: `{method}` is the file that evaluates, `{views}` and `{tangents}` come before those that know of
    /// several eyes and of tangents, `{spacing}` is the cut's.
    pub stages: &'static [(ShaderStageFlags, &'static str)],
    /// What its vertices make.
    pub topology: PrimitiveTopology,
    /// Whether vertices are control points of patches that the device's tessellator cuts.
    pub tessellates: bool,
    /// Whether a patch is one vertex, whatever its control points are.
    pub one_vertex: bool,
    /// Whether it needs the feature `geometryShader`.
    pub geometry_shader: bool,
    /// The stages that evaluate, and those that hand over to them.
    pub readers: PipelineStageFlags,
    /// The greatest level at which there is room for tangents.
    pub tangent_level: f32,
}

/// By the numbers of [`Backend`].
static ROWS: [Row; 3] = [
    Row {
        stages: &[
            (ShaderStageFlags::VERTEX, "{method}.vert"),
            (ShaderStageFlags::TESSELLATION_CONTROL, "{method}.tesc"),
            (
                ShaderStageFlags::TESSELLATION_EVALUATION,
                "{method}.{views}{spacing}.tese",
            ),
        ],
        topology: PrimitiveTopology::PATCH_LIST,
        tessellates: true,
        one_vertex: false,
        geometry_shader: false,
        readers: super::ring::RING_STAGES,
        tangent_level: 64.0,
    },
    Row {
        stages: &[(ShaderStageFlags::VERTEX, "{method}.pattern.vert")],
        topology: PrimitiveTopology::TRIANGLE_LIST,
        tessellates: false,
        one_vertex: false,
        geometry_shader: false,
        readers: PipelineStageFlags::VERTEX_SHADER,
        tangent_level: 64.0,
    },
    Row {
        stages: &[
            (ShaderStageFlags::VERTEX, "patches.vert"),
            (ShaderStageFlags::GEOMETRY, "{method}.{tangents}geom"),
        ],
        topology: PrimitiveTopology::POINT_LIST,
        tessellates: false,
        one_vertex: true,
        geometry_shader: true,
        readers: PipelineStageFlags::GEOMETRY_SHADER,
        tangent_level: abi::TANGENT_ROWS as f32,
    },
];

impl Backend {
    pub(super) fn on_device(self) -> &'static Row {
        &ROWS[self as usize]
    }
}
