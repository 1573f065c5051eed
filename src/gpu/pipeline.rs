//! Pipelines: one a pass, from the method's modules.

mod modules;

use ash::vk;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Backend, DrawList, Residence, SurfaceOptions};
use crate::gpu::shaders::{Embedded, Modules, moved};
use crate::gpu::target::{Attachments, Fill, OwnLayout, PipelineOptions};
use crate::gpu::{Layout, failed};
use crate::method::{Pass, Prepared};
use crate::tessellation::Spacing;
use modules::{Module, modules, names};

/// The pipelines of a prepared model, one a pass, for one backend and spacing.
#[derive(Debug)]
pub struct Pipelines {
    pipelines: Vec<vk::Pipeline>,
    /// Their layout, where it is the engine's.
    layout: Option<OwnLayout>,
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
    /// Views an instance has.
    eyes: u32,
    /// Whether they are for dynamic rendering.
    dynamic: bool,
    /// Whether they draw pieces.
    sub_patches: bool,
    /// The greatest level that they draw.
    greatest_level: f32,
}

impl Pipelines {
    /// Builds the pipelines of every pass. Viewport and scissor are dynamic states. Cache, render pass and the engine's module may go afterwards.
    ///
    /// # Errors
    /// [`Misuse::Features`] when the device was created without what is asked for: `fillModeNonSolid`, `geometryShader`, `dynamicRendering`,
    /// `multiviewTessellationShader`. [`Misuse::MultiviewBackend`]. Vulkan's own.
    ///
    /// # Safety
    /// `device` is live; `layout`, `cache` (or null) and all handles in `options` are of this device and as they say.
    pub unsafe fn new(
        device: &ash::Device,
        layout: &Layout,
        cache: vk::PipelineCache,
        prepared: &Prepared,
        options: &PipelineOptions<'_>,
    ) -> Result<Pipelines> {
        // SAFETY: this function's contract; the tests validate every module of ours.
        unsafe { Pipelines::with_modules(device, layout, cache, prepared, options, &Embedded) }
    }

    /// The same from other modules than those that the crate brings, of the same names ([`modules`](Self::modules)).
    ///
    /// # Errors
    /// As [`new`](Self::new), and those of the modules.
    ///
    /// # Safety
    /// As [`new`](Self::new); the modules are valid SPIR-V for the device, with the interfaces that ours have.
    pub unsafe fn with_modules(
        device: &ash::Device,
        layout: &Layout,
        cache: vk::PipelineCache,
        prepared: &Prepared,
        options: &PipelineOptions<'_>,
        from: &dyn Modules,
    ) -> Result<Pipelines> {
        options.check(&layout.enabled())?;
        check_tangents(prepared, options)?;
        let attachments = options.target.attachments;
        let mut pipelines = Pipelines {
            pipelines: Vec::new(),
            layout: options.layout,
            made_for: Some(MadeFor {
                shaders: prepared.passes.iter().map(|pass| pass.shader).collect(),
                backend: options.backend,
                residence: options.residence,
                spacing: options.spacing,
                eyes: options.target.eyes(),
                dynamic: matches!(attachments, Attachments::Dynamic { .. }),
                sub_patches: options.sub_patches,
                greatest_level: match options.tangents() {
                    true => options.backend.on_device().tangent_level,
                    false => f32::INFINITY,
                },
            }),
        };
        for pass in &prepared.passes {
            let plan = PipelinePlan {
                options,
                control_points: control_points(pass, options.residence),
                invocations: layout.enabled().control_invocations(),
                layout: pipelines.layout_or(layout),
            };
            let modules = modules(pass, options, plan.invocations, from);
            // SAFETY: this function's contract.
            let made = modules.and_then(|modules| unsafe { plan.build(device, cache, &modules) });
            match made {
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
    /// They are drawn like any others; our sets are bound with `layout`, which is theirs, or with [`Layout::pipeline`] for None. [`destroy`](Self::destroy) destroys them; an engine that keeps its handles drops this instead.
    ///
    /// # Safety
    /// Each pipeline takes patches of its pass's [`control_points`](crate::method::Pass::control_points) without vertex input, or what else the
    /// surface's backend draws. Its layout is `layout`, or one that is
    /// compatible with [`Layout::pipeline`] for sets 0 to 2, and has [`Layout::push_constant_range`] alone; further sets are the engine's. Its stages read
    /// `abi::Frame` and these sets as `glsl/lib` declares them, for levels above 64 with specialization constant 2 set, and spacing and winding are those of `glsl/surface.tese`.
    pub unsafe fn from_raw(pipelines: Vec<vk::Pipeline>, layout: Option<OwnLayout>) -> Pipelines {
        Pipelines {
            pipelines,
            layout,
            made_for: None,
        }
    }

    /// The names of the modules that pipelines are made of.
    pub fn modules(prepared: &Prepared, options: &PipelineOptions<'_>) -> Vec<String> {
        let passes = prepared.passes.iter();
        let names = passes.flat_map(|pass| names(pass, options));
        names.map(|(_, name)| name).collect()
    }

    /// The pipeline for a pass of a draw list.
    ///
    /// # Errors
    /// [`Misuse::OtherPipelines`] when they were made for something else; [`Misuse::SubPatchPipelines`]; [`Misuse::BackendLevel`] for a level that geometry shaders have no room for beside
    /// tangents.
    pub(super) fn for_pass(
        &self,
        prepared: &Prepared,
        list: &DrawList,
        pass: usize,
    ) -> Result<vk::Pipeline> {
        let greatest = self.made_for.as_ref().map(|own| own.greatest_level);
        if let Some(greatest) = greatest.filter(|&greatest| list.cut().level > greatest) {
            let backend = list.options().backend.name();
            return Err(Error::Misuse(Misuse::BackendLevel { backend, greatest }));
        }
        let knows_pieces = self.made_for.as_ref().is_none_or(|own| own.sub_patches);
        if list.has_sub_patches() && !knows_pieces {
            return Err(Error::Misuse(Misuse::SubPatchPipelines));
        }
        let fits = self.made_for.as_ref().is_none_or(|own| {
            let SurfaceOptions {
                backend, residence, ..
            } = *list.options();
            let spacing = list.cut().spacing;
            let shaders = prepared.passes.iter().map(|pass| pass.shader);
            own.backend == backend
                && own.residence == residence
                && (own.spacing == spacing || !backend.takes_any_level())
                && shaders.eq(own.shaders.iter().copied())
        });
        let pipeline = self.pipelines.get(pass).filter(|_| fits);
        pipeline
            .copied()
            .ok_or(Error::Misuse(Misuse::OtherPipelines))
    }

    /// Their layout, where it is the engine's.
    pub(super) fn layout(&self) -> Option<OwnLayout> {
        self.layout
    }

    /// Their layout.
    pub(super) fn layout_or(&self, ours: &Layout) -> OwnLayout {
        self.layout.unwrap_or(OwnLayout {
            raw: ours.pipeline(),
            first_set: 0,
        })
    }

    /// How many views an instance has: one, but with multiview.
    pub(super) fn eyes(&self) -> u32 {
        self.made_for.as_ref().map_or(1, |own| own.eyes)
    }

    /// Whether they are known to be for dynamic rendering.
    pub(super) fn are_dynamic(&self) -> bool {
        self.made_for.as_ref().is_some_and(|own| own.dynamic)
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

/// # Errors
/// [`Misuse::NoTangents`] where tangents are asked for that a method has not.
fn check_tangents(prepared: &Prepared, options: &PipelineOptions<'_>) -> Result<()> {
    let mut passes = prepared.passes.iter();
    match passes.find(|pass| options.tangents() && !pass.has_tangents()) {
        Some(pass) => Err(Error::Misuse(Misuse::NoTangents {
            shader: pass.shader,
        })),
        None => Ok(()),
    }
}

/// The control points of a patch that go through the vertex shader.
pub(super) fn control_points(pass: &Pass, residence: Residence) -> u32 {
    match (residence, pass.cached) {
        (Residence::Cache, Some(_)) => 1,
        _ => pass.control_points,
    }
}

/// What a pipeline is made of, its shaders aside.
struct PipelinePlan<'a> {
    options: &'a PipelineOptions<'a>,
    control_points: u32,
    /// Of control shaders that share their work among them.
    invocations: u32,
    layout: OwnLayout,
}

impl PipelinePlan<'_> {
    /// # Safety
    /// As [`Pipelines::new`].
    unsafe fn build(
        &self,
        device: &ash::Device,
        cache: vk::PipelineCache,
        modules: &[Module<'_>],
    ) -> Result<vk::Pipeline> {
        let mut made = Vec::new();
        let mut problem = None;
        for (stage, words) in modules {
            let words = moved(words, self.layout.first_set);
            let info = vk::ShaderModuleCreateInfo::default().code(&words);
            // SAFETY: the words are a valid module, as the caller promises.
            match unsafe { device.create_shader_module(&info, None) } {
                Ok(module) => made.push((*stage, module)),
                Err(code) => problem = Some(failed("vkCreateShaderModule")(code)),
            }
        }
        let pipeline = match problem {
            Some(problem) => Err(problem),
            // SAFETY: this function's contract.
            None => unsafe { self.assemble(device, cache, &made) },
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
        cache: vk::PipelineCache,
        modules: &[(vk::ShaderStageFlags, vk::ShaderModule)],
    ) -> Result<vk::Pipeline> {
        // What the colours mean, in fragment shaders; whether tangents are asked for, where patches are evaluated; whether patches may be pieces; how many invocations
        // control shaders have that share their work.
        let constants = [
            self.options.fill.shading(),
            u32::from(self.options.tangents()),
            u32::from(self.options.sub_patches),
            self.invocations,
        ];
        let numbers = [
            abi::CONSTANT_ID_SHADING,
            abi::CONSTANT_ID_TANGENTS,
            abi::CONSTANT_ID_SUB_PATCHES,
            abi::CONSTANT_ID_INVOCATIONS,
        ];
        let entries = numbers.map(|number| {
            vk::SpecializationMapEntry::default()
                .constant_id(number)
                .offset(4 * number)
                .size(4)
        });
        let constants = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(bytemuck::bytes_of(&constants));
        let stages = self.stages(modules, &constants);
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
        let backend = self.options.backend.on_device();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(backend.topology);
        let tessellation = vk::PipelineTessellationStateCreateInfo::default()
            .patch_control_points(self.control_points);
        let viewport = vk::PipelineViewportStateCreateInfo::default()
            .viewport_count(1)
            .scissor_count(1);
        let rasterization = self.rasterization();
        let target = &self.options.target;
        let multisample =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(target.samples);
        let depth = self.depth();
        let colours = vec![self.colour(); target.attachments.colours()];
        let blend = vk::PipelineColorBlendStateCreateInfo::default()
            .attachments(&colours)
            .blend_constants([self.options.target.line_share(); 4]);
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
            .layout(self.layout.raw);
        if backend.tessellates {
            info = info.tessellation_state(&tessellation);
        }
        let mut rendering = vk::PipelineRenderingCreateInfo::default();
        let info = match target.attachments {
            Attachments::RenderPass {
                render_pass,
                subpass,
                ..
            } => info.render_pass(render_pass).subpass(subpass),
            Attachments::Dynamic {
                colours,
                depth,
                stencil,
            } => {
                rendering = rendering
                    .view_mask(target.view_mask)
                    .color_attachment_formats(colours)
                    .depth_attachment_format(depth)
                    .stencil_attachment_format(stencil);
                info.push_next(&mut rendering)
            }
        };
        // SAFETY: everything that the info points to lives through the call and is of this device.
        let made = unsafe { device.create_graphics_pipelines(cache, &[info], None) };
        made.map(|pipelines| pipelines[0])
            .map_err(|(_, code)| failed("vkCreateGraphicsPipelines")(code))
    }

    /// Our stages, and the engine's own fragment shader.
    fn stages<'s>(
        &'s self,
        modules: &[(vk::ShaderStageFlags, vk::ShaderModule)],
        constants: &'s vk::SpecializationInfo<'s>,
    ) -> Vec<vk::PipelineShaderStageCreateInfo<'s>> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let of = |stage, module| {
            vk::PipelineShaderStageCreateInfo::default()
                .stage(stage)
                .module(module)
                .name(c"main")
        };
        // A stage without such a constant takes no notice (Vulkan spec, VkSpecializationMapEntry).
        let ours = modules.iter();
        let ours = ours.map(|&(stage, module)| of(stage, module).specialization_info(constants));
        let own = self.options.fragment.as_ref();
        let own = own.filter(|_| self.options.fill != Fill::Discard);
        let own = own.map(|own| {
            let info = of(fragment, own.module);
            match own.constants {
                Some(constants) => info.specialization_info(constants),
                None => info,
            }
        });
        ours.chain(own).collect()
    }

    fn depth(&self) -> vk::PipelineDepthStencilStateCreateInfo<'static> {
        let target = &self.options.target;
        let none = matches!(target.attachments, Attachments::Dynamic { depth, .. }
            if depth == vk::Format::UNDEFINED);
        // What is equal would be written as it is: so the attachment may be one that is only read.
        let writes = target.compare != vk::CompareOp::EQUAL;
        vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(!none)
            .depth_write_enable(!none && writes)
            .depth_compare_op(target.compare)
    }

    /// Without a fragment shader colours are undefined (Vulkan spec, "Fragment Output Interface").
    fn colour(&self) -> vk::PipelineColorBlendAttachmentState {
        let written = match self.options.fill {
            Fill::Depth => vk::ColorComponentFlags::empty(),
            _ => vk::ColorComponentFlags::RGBA,
        };
        let state = vk::PipelineColorBlendAttachmentState::default().color_write_mask(written);
        if self.options.fill != Fill::Lines || self.options.target.line_width >= 1.0 {
            return state;
        }
        let (own, other) = (
            vk::BlendFactor::CONSTANT_ALPHA,
            vk::BlendFactor::ONE_MINUS_CONSTANT_ALPHA,
        );
        state
            .blend_enable(true)
            .src_color_blend_factor(own)
            .dst_color_blend_factor(other)
            .src_alpha_blend_factor(own)
            .dst_alpha_blend_factor(other)
    }

    fn rasterization(&self) -> vk::PipelineRasterizationStateCreateInfo<'static> {
        let PipelineOptions { target, fill, .. } = self.options;
        let lines = *fill == Fill::Lines;
        // Towards the eye.
        let front = match (lines, target.is_reversed()) {
            (false, _) => 0.0,
            (true, false) => -1.0,
            (true, true) => 1.0,
        };
        let bias = [target.bias.constant + front, target.bias.slope + front];
        vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(if lines {
                vk::PolygonMode::LINE
            } else {
                vk::PolygonMode::FILL
            })
            .rasterizer_discard_enable(*fill == Fill::Discard)
            .cull_mode(target.cull)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .depth_bias_enable(bias != [0.0; 2])
            .depth_bias_constant_factor(bias[0])
            .depth_bias_slope_factor(bias[1])
            .line_width(if lines {
                target.line_width.max(1.0)
            } else {
                1.0
            })
    }
}
