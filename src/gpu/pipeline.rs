//! Pipelines: one a pass, from the method's modules.

use ash::vk;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Backend, DrawList, Residence, SurfaceOptions};
use crate::gpu::{Enabled, Layout, failed, shaders};
use crate::method::{Pass, Prepared};
use crate::tessellation::Spacing;

/// What pipelines draw into.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// The render pass; its subpass 0 has one colour attachment and depth, and depends on itself as
    /// [`ring_dependency`](super::ring::ring_dependency) says.
    pub render_pass: vk::RenderPass,
    /// Its samples a pixel.
    pub samples: vk::SampleCountFlags,
    /// Which triangles are left out. The front of a surface is where its faces are counter-clockwise, whoever cuts them.
    pub cull: vk::CullModeFlags,
    /// How depths are compared; what passes is written. `LESS_OR_EQUAL` for pictures as they come. After a pre-pass `EQUAL`, which is exact: our
    /// shaders' positions are `invariant`, so all pipelines of one backend and spacing have the same depths. For reversed depths
    /// `GREATER_OR_EQUAL`.
    pub compare: vk::CompareOp,
}

/// What the colours of our own fragment shader mean. A constant of the pipeline: fragments do not pay for what others are shaded by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// A lit surface.
    #[default]
    Lit,
    /// The normal's direction.
    Normal,
    /// A colour for each patch.
    Patch,
    /// The kind of node that a point was evaluated in.
    Node,
    /// The valences of the face's vertices.
    Valence,
}

impl Shading {
    fn code(self) -> u32 {
        match self {
            Shading::Lit => abi::SHADING_LIT,
            Shading::Normal => abi::SHADING_NORMAL,
            Shading::Patch => abi::SHADING_PATCH,
            Shading::Node => abi::SHADING_NODE,
            Shading::Valence => abi::SHADING_VALENCE,
        }
    }
}

/// What becomes of the triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// They are filled.
    Solid(Shading),
    /// Their edges are drawn in one dark colour, a little in front of the filled ones. Needs the feature `fillModeNonSolid`.
    Lines,
    /// Their depths alone count: there is no fragment shader and no colour. For pre-passes and shadow maps.
    Depth,
    /// Nothing: only what is captured counts.
    Discard,
}

/// The pipelines of a prepared model, one a pass, for one backend and spacing.
#[derive(Debug)]
pub struct Pipelines {
    pipelines: Vec<vk::Pipeline>,
    /// What they draw, where it is known.
    made_for: Option<MadeFor>,
}

/// What pipelines draw.
#[derive(Debug)]
struct MadeFor {
    shaders: Vec<&'static str>,
    backend: Backend,
    residence: Residence,
    spacing: Spacing,
}

impl Pipelines {
    /// Builds the pipelines of every pass. Viewport and scissor are dynamic states. Cache and render pass may go afterwards: any compatible
    /// render pass will do for drawing.
    ///
    /// # Errors
    /// [`Misuse::Features`] when the device was created without `fillModeNonSolid` or `geometryShader` and these are needed; Vulkan's own.
    ///
    /// # Safety
    /// `device` is live; `layout`, `cache` (or null) and `target` are of this device.
    #[allow(clippy::too_many_arguments)]
    pub unsafe fn new(
        device: &ash::Device,
        layout: &Layout,
        cache: vk::PipelineCache,
        prepared: &Prepared,
        target: Target,
        backend: Backend,
        residence: Residence,
        spacing: Spacing,
        fill: Fill,
    ) -> Result<Pipelines> {
        let enabled = layout.enabled();
        let (lines, geometry) = (fill == Fill::Lines, backend == Backend::Geometry);
        Enabled::require(lines, enabled.fill_mode_non_solid, "fillModeNonSolid")?;
        Enabled::require(geometry, enabled.geometry_shader, "geometryShader")?;
        let mut pipelines = Pipelines {
            pipelines: Vec::new(),
            made_for: Some(MadeFor {
                shaders: prepared.passes.iter().map(|pass| pass.shader).collect(),
                backend,
                residence,
                spacing,
            }),
        };
        for pass in &prepared.passes {
            let shader = shader(pass, residence);
            let modules = modules(shader, backend, spacing, fill)?;
            let plan = PipelinePlan {
                backend,
                control_points: control_points(pass, residence),
                target,
                fill,
            };
            // SAFETY: this function's contract.
            match unsafe { plan.build(device, layout, cache, &modules) } {
                Ok(pipeline) => pipelines.pipelines.push(pipeline),
                Err(error) => {
                    // SAFETY: nothing has used them.
                    unsafe { pipelines.destroy(device) };
                    return Err(error);
                }
            }
        }
        Ok(pipelines)
    }

    /// Pipelines of the engine's own, one a pass of [`Prepared`] in order: other shaders, other targets, other states.
    ///
    /// They are drawn like any others. [`destroy`](Self::destroy) destroys them; an engine that keeps its handles drops this instead.
    ///
    /// # Safety
    /// Each pipeline takes patches of its pass's [`control_points`](crate::method::Pass::control_points) without vertex input, or what else the
    /// surface's backend draws. Its layout is
    /// compatible with [`Layout::pipeline`] for sets 0 to 2 and has [`Layout::push_constant_range`] alone; further sets are the engine's. Its stages read
    /// `abi::Frame` and these sets as `glsl/lib` declares them, and spacing and winding are those of `glsl/surface.tese`.
    pub unsafe fn from_raw(pipelines: Vec<vk::Pipeline>) -> Pipelines {
        Pipelines {
            pipelines,
            made_for: None,
        }
    }

    /// The pipeline for a pass of a draw list.
    ///
    /// # Errors
    /// [`Misuse::OtherPipelines`] when they were made for something else.
    pub(super) fn for_pass(
        &self,
        prepared: &Prepared,
        list: &DrawList,
        pass: usize,
    ) -> Result<vk::Pipeline> {
        let fits = self.made_for.as_ref().is_none_or(|own| {
            let SurfaceOptions {
                backend, residence, ..
            } = *list.options();
            let spacing = list.cut().spacing;
            let shaders = prepared.passes.iter().map(|pass| pass.shader);
            own.backend == backend
                && own.residence == residence
                && (own.spacing == spacing || backend != Backend::Tessellator)
                && shaders.eq(own.shaders.iter().copied())
        });
        let pipeline = self.pipelines.get(pass).filter(|_| fits);
        pipeline
            .copied()
            .ok_or(Error::Misuse(Misuse::OtherPipelines))
    }

    /// The pipeline of a pass; None where there is no such pass.
    pub fn get(&self, pass: usize) -> Option<vk::Pipeline> {
        self.pipelines.get(pass).copied()
    }

    /// Destroys them.
    ///
    /// # Safety
    /// `device` made them, and no submitted command still uses them.
    pub unsafe fn destroy(self, device: &ash::Device) {
        for pipeline in self.pipelines {
            // SAFETY: this function's contract.
            unsafe { device.destroy_pipeline(pipeline, None) };
        }
    }
}

/// A stage and the words of its module.
type Module = (vk::ShaderStageFlags, &'static [u32]);

/// The file that evaluates a pass's patches.
fn shader(pass: &Pass, residence: Residence) -> &'static str {
    match residence {
        Residence::Ring => pass.shader,
        Residence::Cache => pass.cached.unwrap_or(pass.shader),
    }
}

/// The control points of a patch that go through the vertex shader.
pub(super) fn control_points(pass: &Pass, residence: Residence) -> u32 {
    match (residence, pass.cached) {
        (Residence::Cache, Some(_)) => 1,
        _ => pass.control_points,
    }
}

/// The modules of a method's pipeline.
fn modules(method: &str, backend: Backend, spacing: Spacing, fill: Fill) -> Result<Vec<Module>> {
    use vk::ShaderStageFlags as Stage;
    let evaluation = format!("{}.tese", spacing.name());
    let mut stages = match backend {
        Backend::Tessellator => vec![
            (Stage::VERTEX, format!("{method}.vert")),
            (Stage::TESSELLATION_CONTROL, format!("{method}.tesc")),
            (
                Stage::TESSELLATION_EVALUATION,
                format!("{method}.{evaluation}"),
            ),
        ],
        Backend::Pattern => vec![(Stage::VERTEX, format!("{method}.pattern.vert"))],
        Backend::Geometry => vec![
            (Stage::VERTEX, "patches.vert".into()),
            (Stage::GEOMETRY, format!("{method}.geom")),
        ],
    };
    // Rasterisation that is discarded has no fragment shader (VUID-VkGraphicsPipelineCreateInfo-pStages-06894 and neighbours); depths need none.
    if matches!(fill, Fill::Solid(_) | Fill::Lines) {
        stages.push((Stage::FRAGMENT, format!("{method}.frag")));
    }
    let found = stages.into_iter().map(|(stage, name)| {
        let words = shaders::spirv(&name);
        let words =
            words.ok_or_else(|| Error::Refused(format!("there is no shader module {name}")))?;
        Ok((stage, words))
    });
    found.collect()
}

/// What a pipeline is made of, its shaders aside.
struct PipelinePlan {
    backend: Backend,
    control_points: u32,
    target: Target,
    fill: Fill,
}

impl PipelinePlan {
    /// # Safety
    /// As [`Pipelines::new`].
    unsafe fn build(
        &self,
        device: &ash::Device,
        layout: &Layout,
        cache: vk::PipelineCache,
        modules: &[Module],
    ) -> Result<vk::Pipeline> {
        let mut made = Vec::new();
        let mut problem = None;
        for &(stage, words) in modules {
            let info = vk::ShaderModuleCreateInfo::default().code(words);
            // SAFETY: the words are a valid module; the tests validate every one.
            match unsafe { device.create_shader_module(&info, None) } {
                Ok(module) => made.push((stage, module)),
                Err(code) => problem = Some(failed("vkCreateShaderModule")(code)),
            }
        }
        let pipeline = match problem {
            Some(problem) => Err(problem),
            // SAFETY: this function's contract.
            None => unsafe { self.assemble(device, layout, cache, &made) },
        };
        for (_, module) in made {
            // SAFETY: modules are not needed once the pipeline is there.
            unsafe { device.destroy_shader_module(module, None) };
        }
        pipeline
    }

    /// # Safety
    /// As [`Pipelines::new`]; the modules are of this device.
    unsafe fn assemble(
        &self,
        device: &ash::Device,
        layout: &Layout,
        cache: vk::PipelineCache,
        modules: &[(vk::ShaderStageFlags, vk::ShaderModule)],
    ) -> Result<vk::Pipeline> {
        let shading = self.shading().to_ne_bytes();
        let constants = [vk::SpecializationMapEntry::default().size(shading.len())];
        let constants = vk::SpecializationInfo::default()
            .map_entries(&constants)
            .data(&shading);
        let stages: Vec<vk::PipelineShaderStageCreateInfo> = modules
            .iter()
            .map(|&(stage, module)| {
                let info = vk::PipelineShaderStageCreateInfo::default()
                    .stage(stage)
                    .module(module)
                    .name(c"main");
                match stage {
                    vk::ShaderStageFlags::FRAGMENT => info.specialization_info(&constants),
                    _ => info,
                }
            })
            .collect();
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(match self.backend {
                Backend::Tessellator => vk::PrimitiveTopology::PATCH_LIST,
                Backend::Pattern => vk::PrimitiveTopology::TRIANGLE_LIST,
                Backend::Geometry => vk::PrimitiveTopology::POINT_LIST,
            });
        let tessellation = vk::PipelineTessellationStateCreateInfo::default()
            .patch_control_points(self.control_points);
        let viewport = vk::PipelineViewportStateCreateInfo::default()
            .viewport_count(1)
            .scissor_count(1);
        let rasterization = self.rasterization();
        let multisample = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(self.target.samples);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(true)
            .depth_write_enable(true)
            .depth_compare_op(self.target.compare);
        // Without a fragment shader colours are undefined (Vulkan spec, "Fragment Output Interface").
        let written = match self.fill {
            Fill::Depth => vk::ColorComponentFlags::empty(),
            _ => vk::ColorComponentFlags::RGBA,
        };
        let colour = [vk::PipelineColorBlendAttachmentState::default().color_write_mask(written)];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&colour);
        let dynamic = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic);
        let mut info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&multisample)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(layout.pipeline())
            .render_pass(self.target.render_pass);
        if self.backend == Backend::Tessellator {
            info = info.tessellation_state(&tessellation);
        }
        // SAFETY: everything that the info points to lives through the call and is of this device.
        let made = unsafe { device.create_graphics_pipelines(cache, &[info], None) };
        made.map(|pipelines| pipelines[0])
            .map_err(|(_, code)| failed("vkCreateGraphicsPipelines")(code))
    }

    /// The constant of the fragment shader.
    fn shading(&self) -> u32 {
        match self.fill {
            Fill::Solid(shading) => shading.code(),
            Fill::Lines | Fill::Depth | Fill::Discard => abi::SHADING_LINES,
        }
    }

    fn rasterization(&self) -> vk::PipelineRasterizationStateCreateInfo<'static> {
        let lines = self.fill == Fill::Lines;
        vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(if lines {
                vk::PolygonMode::LINE
            } else {
                vk::PolygonMode::FILL
            })
            .rasterizer_discard_enable(self.fill == Fill::Discard)
            .cull_mode(self.target.cull)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .depth_bias_enable(lines)
            .depth_bias_constant_factor(if lines { -1.0 } else { 0.0 })
            .depth_bias_slope_factor(if lines { -1.0 } else { 0.0 })
            .line_width(1.0)
    }
}
