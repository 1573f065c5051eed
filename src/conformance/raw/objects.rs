//! Shaders that are bound one by one, without a pipeline (`VK_EXT_shader_object`).

use ash::{ext, vk};

use super::program::{Program, attachment, rasterization};
use super::{CONSTANT_BYTES, Raw, Recorder, STAGES};
use crate::error::Result;
use crate::gpu::failed;
use crate::host::Device;

/// The shaders of a program, and what a pipeline would say beside them.
pub struct Objects {
    device: Device,
    functions: ext::shader_object::Device,
    /// Each with its stage.
    shaders: Vec<(vk::ShaderStageFlags, vk::ShaderEXT)>,
    patches: Option<(u32, vk::TessellationDomainOrigin)>,
    raster: super::Raster,
}

impl Raw<'_> {
    /// Makes the shaders of a program, all at once, linked or each by itself. The device has `shaderObject`.
    pub fn objects(&self, program: &Program, linked: bool) -> Result<Objects> {
        let instance = self.device.instance().raw();
        let functions = ext::shader_object::Device::new(instance, self.device.raw());
        let stages = program.stages();
        let constants: &[u8] = bytemuck::cast_slice(&program.constants);
        let entries = program.entries();
        let special = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(constants);
        let set = self.set.as_ref().map(|set| set.layout());
        let ranges = [vk::PushConstantRange::default()
            .stage_flags(STAGES)
            .size(CONSTANT_BYTES)];
        let flags = if linked {
            vk::ShaderCreateFlagsEXT::LINK_STAGE
        } else {
            vk::ShaderCreateFlagsEXT::empty()
        };
        let infos = (0..stages.len()).map(|i| {
            let (stage, words) = stages[i];
            let next = stages
                .get(i + 1)
                .map_or_else(Default::default, |next| next.0);
            vk::ShaderCreateInfoEXT::default()
                .flags(flags)
                .stage(stage)
                .next_stage(next)
                .code_type(vk::ShaderCodeTypeEXT::SPIRV)
                .code(bytemuck::cast_slice(words))
                .name(c"main")
                .set_layouts(set.as_slice())
                .push_constant_ranges(&ranges)
                .specialization_info(&special)
        });
        let infos: Vec<_> = infos.collect();
        // SAFETY: the words are valid modules, of stages that follow each other, and all that infos point to lives through the call.
        let made = unsafe { functions.create_shaders(&infos, None) };
        let (made, result) = match made {
            Ok(made) => (made, Ok(())),
            Err((made, code)) => (made, Err(failed("vkCreateShadersEXT")(code))),
        };
        let stages = stages.iter().map(|&(stage, _)| stage);
        let objects = Objects {
            device: self.device.clone(),
            functions,
            shaders: stages.zip(made).collect(),
            patches: program
                .tessellation
                .as_ref()
                .map(|_| (program.control_points, program.origin)),
            raster: program.raster,
        };
        // What was made of them goes with `objects`.
        result.map(|()| objects)
    }
}

impl Drop for Objects {
    fn drop(&mut self) {
        if self.device.is_hung() {
            return;
        }
        for &(_, shader) in &self.shaders {
            // SAFETY: made from this device, or null; each submission was waited for.
            unsafe { self.functions.destroy_shader(shader, None) };
        }
    }
}

/// Stages that a draw needs told, even where it has no shader for them (VUID-vkCmdDraw-None-08684 and those behind it).
const ALL: [vk::ShaderStageFlags; 5] = [
    vk::ShaderStageFlags::VERTEX,
    vk::ShaderStageFlags::TESSELLATION_CONTROL,
    vk::ShaderStageFlags::TESSELLATION_EVALUATION,
    vk::ShaderStageFlags::GEOMETRY,
    vk::ShaderStageFlags::FRAGMENT,
];

impl Recorder<'_> {
    /// Binds shaders with all buffers, says all that a pipeline would, and sets the push constants. Inside of dynamic rendering.
    pub fn bind_objects<T: bytemuck::NoUninit>(&self, objects: &Objects, constants: &T) {
        let has_geometry = objects.device.info().support.optional.geometry_shader;
        let stages = ALL
            .into_iter()
            .filter(|&stage| stage != vk::ShaderStageFlags::GEOMETRY || has_geometry);
        let (stages, shaders): (Vec<_>, Vec<_>) = stages
            .map(|stage| {
                let own = objects.shaders.iter().find(|(own, _)| *own == stage);
                (stage, own.map_or_else(Default::default, |own| own.1))
            })
            .unzip();
        let functions = &objects.functions;
        // SAFETY: recording on the shaders' device, which has the feature.
        unsafe { functions.cmd_bind_shaders(self.cmd, &stages, &shaders) };
        self.say_state(objects);
        self.bind_buffers(vk::PipelineBindPoint::GRAPHICS, constants);
    }

    /// What draws without pipelines need to be told (Vulkan, "Shader Objects, Setting State").
    fn say_state(&self, objects: &Objects) {
        let Some(layers) = &self.raw.layers else {
            return;
        };
        let (cmd, functions) = (self.cmd, &objects.functions);
        let raster = rasterization(objects.raster);
        let blend = attachment(objects.raster);
        let equation = vk::ColorBlendEquationEXT::default()
            .src_color_blend_factor(blend.src_color_blend_factor)
            .dst_color_blend_factor(blend.dst_color_blend_factor)
            .color_blend_op(blend.color_blend_op)
            .src_alpha_blend_factor(blend.src_alpha_blend_factor)
            .dst_alpha_blend_factor(blend.dst_alpha_blend_factor)
            .alpha_blend_op(blend.alpha_blend_op);
        let (viewport, scissor) = layers.look();
        let one = vk::SampleCountFlags::TYPE_1;
        // SAFETY: recording on the device of the shaders, which has the feature; all values are ones that every device takes.
        unsafe {
            functions.cmd_set_viewport_with_count(cmd, &[viewport]);
            functions.cmd_set_scissor_with_count(cmd, &[scissor]);
            functions.cmd_set_vertex_input(cmd, &[], &[]);
            functions.cmd_set_primitive_topology(
                cmd,
                match objects.patches {
                    Some(_) => vk::PrimitiveTopology::PATCH_LIST,
                    None => vk::PrimitiveTopology::TRIANGLE_LIST,
                },
            );
            functions.cmd_set_primitive_restart_enable(cmd, false);
            if let Some((points, origin)) = objects.patches {
                functions.cmd_set_patch_control_points(cmd, points);
                functions.cmd_set_tessellation_domain_origin(cmd, origin);
            }
            functions.cmd_set_rasterizer_discard_enable(cmd, raster.rasterizer_discard_enable != 0);
            functions.cmd_set_polygon_mode(cmd, raster.polygon_mode);
            functions.cmd_set_cull_mode(cmd, raster.cull_mode);
            functions.cmd_set_front_face(cmd, raster.front_face);
            functions.cmd_set_depth_bias_enable(cmd, false);
            self.device.cmd_set_line_width(cmd, raster.line_width);
            functions.cmd_set_rasterization_samples(cmd, one);
            functions.cmd_set_sample_mask(cmd, one, &[1]);
            functions.cmd_set_alpha_to_coverage_enable(cmd, false);
            functions.cmd_set_depth_test_enable(cmd, false);
            functions.cmd_set_depth_write_enable(cmd, false);
            functions.cmd_set_stencil_test_enable(cmd, false);
            functions.cmd_set_color_blend_enable(cmd, 0, &[blend.blend_enable]);
            functions.cmd_set_color_blend_equation(cmd, 0, &[equation]);
            functions.cmd_set_color_write_mask(cmd, 0, &[blend.color_write_mask]);
        }
    }
}
