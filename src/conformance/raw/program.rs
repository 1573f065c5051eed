//! Pipelines with shaders of the suite's own.

use std::borrow::Cow;

use ash::vk;

use crate::conformance::modes::module;
use crate::error::Result;
use crate::gpu::failed;

/// What becomes of the triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Raster {
    /// Nothing.
    Discard,
    /// The patch's number as a colour.
    Solid,
    /// The same, only for those that face the viewer: counter-clockwise ones.
    Front,
    /// The same, without those that are culled.
    Culled(vk::CullModeFlags, vk::FrontFace),
    /// The patch's number as a colour, added to what the pixel has.
    Added,
}

/// How a pipeline comes to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Assembly {
    /// At once.
    Whole,
    /// At once; of how many control points patches are, is said by the draws (`VK_EXT_extended_dynamic_state2`).
    DynamicPatchSize,
    /// Linked from four parts, fast, without optimisation (`VK_EXT_graphics_pipeline_library`).
    Linked,
    /// The same, optimised when it is linked.
    Optimised,
}

/// What a pipeline is made of. Words are those of modules.
pub struct Program {
    /// The vertex shader.
    pub vertex: &'static [u32],
    /// The control and the evaluation shader; without them there are no patches, but triangles.
    pub tessellation: Option<[Cow<'static, [u32]>; 2]>,
    /// The geometry shader, if there is one.
    pub geometry: Option<Cow<'static, [u32]>>,
    /// The fragment shader, where anything is drawn.
    pub fragment: &'static [u32],
    /// Control points a patch.
    pub control_points: u32,
    /// Constants 0, 1, ... of all shaders.
    pub constants: Vec<u32>,
    /// What becomes of the triangles.
    pub raster: Raster,
    /// Where the domain has its origin.
    pub origin: vk::TessellationDomainOrigin,
    /// How the pipeline comes to be.
    pub assembly: Assembly,
}

impl Program {
    /// Patches of one control point each, whose numbers are drawn.
    pub fn new(
        control: impl Into<Cow<'static, [u32]>>,
        evaluation: impl Into<Cow<'static, [u32]>>,
    ) -> Result<Program> {
        Ok(Program {
            vertex: module("patch.vert")?,
            tessellation: Some([control.into(), evaluation.into()]),
            geometry: None,
            fragment: module("solid.frag")?,
            control_points: 1,
            constants: Vec::new(),
            raster: Raster::Solid,
            origin: vk::TessellationDomainOrigin::UPPER_LEFT,
            assembly: Assembly::Whole,
        })
    }

    /// Where the constants stand, a word each.
    pub(super) fn entries(&self) -> Vec<vk::SpecializationMapEntry> {
        let entry = |id: u32| {
            vk::SpecializationMapEntry::default()
                .constant_id(id)
                .offset(4 * id)
                .size(4)
        };
        (0..self.constants.len() as u32).map(entry).collect()
    }

    /// The stages that it has, with their modules' words.
    pub(super) fn stages(&self) -> Vec<(vk::ShaderStageFlags, &[u32])> {
        let mut stages: Vec<(vk::ShaderStageFlags, &[u32])> =
            vec![(vk::ShaderStageFlags::VERTEX, self.vertex)];
        if let Some([control, evaluation]) = &self.tessellation {
            stages.push((vk::ShaderStageFlags::TESSELLATION_CONTROL, control));
            stages.push((vk::ShaderStageFlags::TESSELLATION_EVALUATION, evaluation));
        }
        let geometry = self.geometry.iter();
        stages.extend(geometry.map(|words| (vk::ShaderStageFlags::GEOMETRY, &**words)));
        if self.raster != Raster::Discard {
            stages.push((vk::ShaderStageFlags::FRAGMENT, self.fragment));
        }
        stages
    }
}

/// What a pipeline is made for.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    pub device: &'a ash::Device,
    pub layout: vk::PipelineLayout,
    pub destination: Destination,
    pub samples: vk::SampleCountFlags,
}

/// What pipelines draw in.
#[derive(Clone, Copy)]
pub(super) enum Destination {
    /// The first subpass of a render pass.
    Pass(vk::RenderPass),
    /// Dynamic rendering to a colour of this format and in these views.
    Rendering(vk::Format, u32),
}

impl Place<'_> {
    fn create<'a>(
        self,
        info: vk::GraphicsPipelineCreateInfo<'a>,
        made: &mut Vec<vk::Pipeline>,
    ) -> Result<vk::Pipeline> {
        let mut formats = [vk::Format::UNDEFINED];
        let mut rendering = vk::PipelineRenderingCreateInfo::default();
        let mut info = info.layout(self.layout);
        match self.destination {
            Destination::Pass(pass) => info = info.render_pass(pass),
            Destination::Rendering(format, view_mask) => {
                formats[0] = format;
                rendering = rendering
                    .color_attachment_formats(&formats)
                    .view_mask(view_mask);
                info = info.push_next(&mut rendering);
            }
        }
        let cache = vk::PipelineCache::null();
        // SAFETY: everything that the info points to lives through the call and is of this device.
        let new = unsafe { self.device.create_graphics_pipelines(cache, &[info], None) };
        let new = new.map_err(|(_, code)| failed("vkCreateGraphicsPipelines")(code))?;
        made.extend(&new);
        Ok(new[0])
    }

    /// Links parts to a pipeline.
    fn link(
        self,
        parts: &[vk::Pipeline],
        optimised: bool,
        made: &mut Vec<vk::Pipeline>,
    ) -> Result<vk::Pipeline> {
        let mut libraries = vk::PipelineLibraryCreateInfoKHR::default().libraries(parts);
        let flags = if optimised {
            vk::PipelineCreateFlags::LINK_TIME_OPTIMIZATION_EXT
        } else {
            vk::PipelineCreateFlags::empty()
        };
        // The same as the parts have: the validation layer misses it otherwise (1.3.239).
        let multisample =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(self.samples);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .flags(flags)
            .multisample_state(&multisample)
            .push_next(&mut libraries);
        self.create(info, made)
    }
}

/// The parts of a pipeline that libraries may have, one each.
const PARTS: [vk::GraphicsPipelineLibraryFlagsEXT; 4] = [
    vk::GraphicsPipelineLibraryFlagsEXT::VERTEX_INPUT_INTERFACE,
    vk::GraphicsPipelineLibraryFlagsEXT::PRE_RASTERIZATION_SHADERS,
    vk::GraphicsPipelineLibraryFlagsEXT::FRAGMENT_SHADER,
    vk::GraphicsPipelineLibraryFlagsEXT::FRAGMENT_OUTPUT_INTERFACE,
];

impl Program {
    /// The pipeline, and whatever it is linked from: all of it goes to `made`.
    pub(super) fn assemble(
        &self,
        place: Place<'_>,
        modules: &[(vk::ShaderStageFlags, vk::ShaderModule)],
        made: &mut Vec<vk::Pipeline>,
    ) -> Result<vk::Pipeline> {
        let every = PARTS.into_iter().fold(PARTS[0], |all, part| all | part);
        let optimised = match self.assembly {
            Assembly::Whole | Assembly::DynamicPatchSize => {
                return self.part(every, false, place, modules, made);
            }
            Assembly::Linked => false,
            Assembly::Optimised => true,
        };
        // Without a rasteriser there are no others.
        let count = if self.raster == Raster::Discard { 2 } else { 4 };
        let parts = PARTS[..count]
            .iter()
            .map(|&part| self.part(part, optimised, place, modules, made));
        let parts = parts.collect::<Result<Vec<_>>>()?;
        place.link(&parts, optimised, made)
    }

    /// A pipeline, or some parts of one as a library. What belongs to other parts is left out.
    fn part(
        &self,
        parts: vk::GraphicsPipelineLibraryFlagsEXT,
        optimised: bool,
        place: Place<'_>,
        modules: &[(vk::ShaderStageFlags, vk::ShaderModule)],
        made: &mut Vec<vk::Pipeline>,
    ) -> Result<vk::Pipeline> {
        use vk::GraphicsPipelineLibraryFlagsEXT as Part;
        let has = |part| parts.contains(part);
        let is_library = parts.as_raw().count_ones() == 1;
        let constants: &[u8] = bytemuck::cast_slice(&self.constants);
        let entries = self.entries();
        let special = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(constants);
        let own = |(stage, _): &&(vk::ShaderStageFlags, vk::ShaderModule)| {
            let part = match *stage {
                vk::ShaderStageFlags::FRAGMENT => Part::FRAGMENT_SHADER,
                _ => Part::PRE_RASTERIZATION_SHADERS,
            };
            parts.contains(part)
        };
        let stage = |&(stage, module): &(vk::ShaderStageFlags, vk::ShaderModule)| {
            vk::PipelineShaderStageCreateInfo::default()
                .stage(stage)
                .module(module)
                .name(c"main")
                .specialization_info(&special)
        };
        let stages: Vec<_> = modules.iter().filter(own).map(stage).collect();
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
        let has_patches = self.tessellation.is_some();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(if has_patches {
                vk::PrimitiveTopology::PATCH_LIST
            } else {
                vk::PrimitiveTopology::TRIANGLE_LIST
            });
        let mut origin = vk::PipelineTessellationDomainOriginStateCreateInfo::default()
            .domain_origin(self.origin);
        let tessellation = vk::PipelineTessellationStateCreateInfo::default()
            .patch_control_points(self.control_points)
            .push_next(&mut origin);
        let viewport = vk::PipelineViewportStateCreateInfo::default()
            .viewport_count(1)
            .scissor_count(1);
        let rasterization = rasterization(self.raster);
        let multisample =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(place.samples);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default();
        let colour = [attachment(self.raster)];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&colour);
        let dynamic: &[vk::DynamicState] = match self.assembly {
            Assembly::DynamicPatchSize if has_patches => &[
                vk::DynamicState::VIEWPORT,
                vk::DynamicState::SCISSOR,
                vk::DynamicState::PATCH_CONTROL_POINTS_EXT,
            ],
            _ => &[vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR],
        };
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(dynamic);
        let mut library = vk::GraphicsPipelineLibraryCreateInfoEXT::default().flags(parts);
        let mut info = vk::GraphicsPipelineCreateInfo::default();
        if has(Part::VERTEX_INPUT_INTERFACE) {
            info = info
                .vertex_input_state(&vertex_input)
                .input_assembly_state(&assembly);
        }
        if has(Part::PRE_RASTERIZATION_SHADERS) {
            info = info
                .viewport_state(&viewport)
                .rasterization_state(&rasterization)
                .dynamic_state(&dynamic);
            if has_patches {
                info = info.tessellation_state(&tessellation);
            }
        }
        if has(Part::FRAGMENT_SHADER) {
            info = info.depth_stencil_state(&depth);
        }
        if has(Part::FRAGMENT_OUTPUT_INTERFACE) {
            info = info.color_blend_state(&blend);
        }
        if has(Part::FRAGMENT_SHADER) || has(Part::FRAGMENT_OUTPUT_INTERFACE) {
            info = info.multisample_state(&multisample);
        }
        info = info.stages(&stages);
        if is_library {
            let keep = if optimised {
                vk::PipelineCreateFlags::RETAIN_LINK_TIME_OPTIMIZATION_INFO_EXT
            } else {
                vk::PipelineCreateFlags::empty()
            };
            info = info
                .flags(vk::PipelineCreateFlags::LIBRARY_KHR | keep)
                .push_next(&mut library);
        }
        place.create(info, made)
    }
}

pub(super) fn attachment(raster: Raster) -> vk::PipelineColorBlendAttachmentState {
    vk::PipelineColorBlendAttachmentState::default()
        .color_write_mask(vk::ColorComponentFlags::RGBA)
        .blend_enable(raster == Raster::Added)
        .src_color_blend_factor(vk::BlendFactor::ONE)
        .dst_color_blend_factor(vk::BlendFactor::ONE)
        .color_blend_op(vk::BlendOp::ADD)
        .src_alpha_blend_factor(vk::BlendFactor::ONE)
        .dst_alpha_blend_factor(vk::BlendFactor::ONE)
        .alpha_blend_op(vk::BlendOp::ADD)
}

pub(super) fn rasterization(raster: Raster) -> vk::PipelineRasterizationStateCreateInfo<'static> {
    let (cull, front) = match raster {
        Raster::Discard | Raster::Solid | Raster::Added => {
            (vk::CullModeFlags::NONE, vk::FrontFace::COUNTER_CLOCKWISE)
        }
        Raster::Front => (vk::CullModeFlags::BACK, vk::FrontFace::COUNTER_CLOCKWISE),
        Raster::Culled(cull, front) => (cull, front),
    };
    vk::PipelineRasterizationStateCreateInfo::default()
        .rasterizer_discard_enable(raster == Raster::Discard)
        .polygon_mode(vk::PolygonMode::FILL)
        .cull_mode(cull)
        .front_face(front)
        .line_width(1.0)
}
