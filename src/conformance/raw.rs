//! Draws with shaders of the suite's own, without any of the layers that our surfaces have.

mod recorder;

use std::borrow::Cow;

use ash::vk;
use gpu_allocator::MemoryLocation;

use crate::conformance::modes::module;
use crate::error::Result;
use crate::gpu::{Buffer, failed};
use crate::host::{Device, Encoding, OffscreenTarget, StatisticsQuery, StorageSet};

pub use recorder::{Event, Recorder, Scope};

/// Stages that see the buffers and the push constants.
const STAGES: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::ALL_GRAPHICS.as_raw() | vk::ShaderStageFlags::COMPUTE.as_raw(),
);

/// The greatest push constants that the suite's shaders have.
const CONSTANT_BYTES: u32 = 32;

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
        })
    }

    /// The stages that it has, with their modules' words.
    fn stages(&self) -> Vec<(vk::ShaderStageFlags, &[u32])> {
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

/// Storage buffers at bindings 0, 1, ... that the host sees, a picture, and pipelines over them.
pub struct Raw<'a> {
    device: &'a Device,
    layout: vk::PipelineLayout,
    /// Of the buffers.
    set: Option<StorageSet>,
    buffers: Vec<Buffer>,
    pipelines: Vec<vk::Pipeline>,
    target: OffscreenTarget,
}

impl<'a> Raw<'a> {
    /// Buffers of so many bytes, all zero, and a square picture of `side` pixels.
    pub fn new(device: &'a Device, sizes: &[u64], side: u32) -> Result<Raw<'a>> {
        // Null handles until made: if a step fails, what was made before it goes with `raw`.
        let mut raw = Raw {
            device,
            layout: vk::PipelineLayout::null(),
            set: None,
            buffers: Vec::new(),
            pipelines: Vec::new(),
            target: OffscreenTarget::with_encoding(device, side, side, 1, Encoding::Unorm)?,
        };
        for &size in sizes {
            raw.make_buffer(size)?;
        }
        let set = StorageSet::new(device, STAGES, raw.buffers.iter())?;
        raw.make_layout(&set)?;
        raw.set = Some(set);
        Ok(raw)
    }

    fn make_buffer(&mut self, size: u64) -> Result<()> {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::INDEX_BUFFER
            | vk::BufferUsageFlags::INDIRECT_BUFFER;
        let (device, location) = (self.device.raw(), MemoryLocation::GpuToCpu);
        let allocator = &mut self.device.allocator();
        // SAFETY: device and allocator belong together; the usage needs no feature.
        let buffer =
            unsafe { Buffer::new(device, allocator, "conformance", size, usage, location) };
        self.buffers.push(buffer?);
        let last = self.buffers.len() - 1;
        self.buffers[last].write(0, &vec![0; size as usize])
    }

    fn make_layout(&mut self, set: &StorageSet) -> Result<()> {
        let sets = [set.layout()];
        let constants = [vk::PushConstantRange::default()
            .stage_flags(STAGES)
            .size(CONSTANT_BYTES)];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&sets)
            .push_constant_ranges(&constants);
        // SAFETY: the device is live; the info's pointers live through the call.
        self.layout = unsafe { self.device.raw().create_pipeline_layout(&info, None) }
            .map_err(failed("vkCreatePipelineLayout"))?;
        Ok(())
    }

    /// Replaces the beginning of a buffer.
    pub fn write<T: bytemuck::NoUninit>(&mut self, binding: usize, data: &[T]) -> Result<()> {
        self.buffers[binding].write(0, bytemuck::cast_slice(data))
    }

    /// Fills a buffer with zeros.
    pub fn clear(&mut self, binding: usize) -> Result<()> {
        let zeros = vec![0; self.buffers[binding].size() as usize];
        self.buffers[binding].write(0, &zeros)
    }

    /// The words of a buffer.
    pub fn words(&self, binding: usize) -> &[u32] {
        bytemuck::cast_slice(self.buffers[binding].bytes())
    }

    /// A buffer's handle.
    pub fn buffer(&self, binding: usize) -> vk::Buffer {
        self.buffers[binding].raw()
    }

    /// The picture of the last draw: the number of each pixel's patch plus one, 0 where nothing was drawn.
    pub fn pixels(&self) -> Vec<u32> {
        let bytes = self.target.read_pixels();
        let pixels = bytes.chunks_exact(4);
        let word = |pixel: &[u8]| u32::from_le_bytes([pixel[0], pixel[1], pixel[2], 0]);
        pixels.map(word).collect()
    }

    /// Builds a pipeline, which lives as long as this.
    pub fn pipeline(&mut self, program: &Program) -> Result<vk::Pipeline> {
        let device = self.device.raw();
        let mut modules = Vec::new();
        let mut made = Ok(());
        for (stage, words) in program.stages() {
            let info = vk::ShaderModuleCreateInfo::default().code(words);
            // SAFETY: the words are a valid module: one that ships, with valid modes in the place of its own.
            match unsafe { device.create_shader_module(&info, None) } {
                Ok(module) => modules.push((stage, module)),
                Err(code) => made = Err(failed("vkCreateShaderModule")(code)),
            }
        }
        let pipeline = made.and_then(|()| self.assemble(program, &modules));
        for (_, module) in modules {
            // SAFETY: modules are not needed once the pipeline is there.
            unsafe { device.destroy_shader_module(module, None) };
        }
        self.pipelines.extend(pipeline.as_ref().ok());
        pipeline
    }

    fn assemble(
        &self,
        program: &Program,
        modules: &[(vk::ShaderStageFlags, vk::ShaderModule)],
    ) -> Result<vk::Pipeline> {
        let constants: &[u8] = bytemuck::cast_slice(&program.constants);
        let entry = |id: u32| {
            vk::SpecializationMapEntry::default()
                .constant_id(id)
                .offset(4 * id)
                .size(4)
        };
        let entries: Vec<_> = (0..program.constants.len() as u32).map(entry).collect();
        let special = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(constants);
        let stage = |&(stage, module): &(vk::ShaderStageFlags, vk::ShaderModule)| {
            vk::PipelineShaderStageCreateInfo::default()
                .stage(stage)
                .module(module)
                .name(c"main")
                .specialization_info(&special)
        };
        let stages: Vec<_> = modules.iter().map(stage).collect();
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
        let has_patches = program.tessellation.is_some();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(if has_patches {
                vk::PrimitiveTopology::PATCH_LIST
            } else {
                vk::PrimitiveTopology::TRIANGLE_LIST
            });
        let mut origin = vk::PipelineTessellationDomainOriginStateCreateInfo::default()
            .domain_origin(program.origin);
        let tessellation = vk::PipelineTessellationStateCreateInfo::default()
            .patch_control_points(program.control_points)
            .push_next(&mut origin);
        let viewport = vk::PipelineViewportStateCreateInfo::default()
            .viewport_count(1)
            .scissor_count(1);
        let rasterization = rasterization(program.raster);
        let multisample = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(self.target.samples());
        let depth = vk::PipelineDepthStencilStateCreateInfo::default();
        let colour = [vk::PipelineColorBlendAttachmentState::default()
            .color_write_mask(vk::ColorComponentFlags::RGBA)];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&colour);
        let dynamic = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&multisample)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(self.layout)
            .render_pass(self.target.render_pass());
        let info = if has_patches {
            info.tessellation_state(&tessellation)
        } else {
            info
        };
        let (device, cache) = (self.device.raw(), vk::PipelineCache::null());
        // SAFETY: everything that the info points to lives through the call and is of this device.
        let made = unsafe { device.create_graphics_pipelines(cache, &[info], None) };
        made.map(|pipelines| pipelines[0])
            .map_err(|(_, code)| failed("vkCreateGraphicsPipelines")(code))
    }

    /// Builds a compute pipeline, which lives as long as this.
    pub fn compute_pipeline(&mut self, words: &[u32]) -> Result<vk::Pipeline> {
        let device = self.device.raw();
        let info = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the words are a valid module, one that ships.
        let module = unsafe { device.create_shader_module(&info, None) }
            .map_err(failed("vkCreateShaderModule"))?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(c"main");
        let info = vk::ComputePipelineCreateInfo::default()
            .stage(stage)
            .layout(self.layout);
        let cache = vk::PipelineCache::null();
        // SAFETY: all that the info points to lives through the calls and is of this device; modules are not needed once the pipeline is there.
        let made = unsafe {
            let made = device.create_compute_pipelines(cache, &[info], None);
            device.destroy_shader_module(module, None);
            made
        };
        let pipeline = made
            .map(|pipelines| pipelines[0])
            .map_err(|(_, code)| failed("vkCreateComputePipelines")(code))?;
        self.pipelines.push(pipeline);
        Ok(pipeline)
    }

    fn recorder(&self, cmd: vk::CommandBuffer) -> Recorder<'_> {
        Recorder {
            device: self.device.raw(),
            raw: self,
            cmd,
        }
    }

    /// Records commands that need no render pass, submits, and waits.
    pub fn submit_outside(&self, commands: impl FnOnce(&Recorder<'_>)) -> Result<()> {
        self.device.submit(|cmd| {
            commands(&self.recorder(cmd));
            Ok(())
        })
    }

    /// Records `draws` inside of a render pass over a black picture, submits, and waits. `query` counts what they do.
    pub fn submit(
        &self,
        query: Option<&StatisticsQuery>,
        draws: impl FnOnce(&Recorder<'_>),
    ) -> Result<()> {
        self.submit_all(query, |_| (), draws)
    }

    /// The same behind commands outside of the pass.
    pub fn submit_behind(
        &self,
        before: impl FnOnce(&Recorder<'_>),
        draws: impl FnOnce(&Recorder<'_>),
    ) -> Result<()> {
        self.submit_all(None, before, draws)
    }

    fn submit_all(
        &self,
        query: Option<&StatisticsQuery>,
        before: impl FnOnce(&Recorder<'_>),
        draws: impl FnOnce(&Recorder<'_>),
    ) -> Result<()> {
        // SAFETY: recording on the device that made everything: the query's reset outside of the pass, the rest in it.
        self.device.submit(|cmd| unsafe {
            if let Some(query) = query {
                query.cmd_reset(cmd);
            }
            before(&self.recorder(cmd));
            self.target.begin(cmd, [0.0; 4]);
            if let Some(query) = query {
                query.cmd_begin(cmd);
            }
            draws(&self.recorder(cmd));
            if let Some(query) = query {
                query.cmd_end(cmd);
            }
            self.target.end(cmd);
            self.cmd_read_back(cmd);
            self.target.cmd_copy_to_host(cmd);
            Ok(())
        })
    }

    /// # Safety
    /// `cmd` is recording on this device, outside of a render pass.
    unsafe fn cmd_read_back(&self, cmd: vk::CommandBuffer) {
        let barrier = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::SHADER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ);
        let stages = vk::PipelineStageFlags::ALL_GRAPHICS;
        let host = vk::PipelineStageFlags::HOST;
        let none = vk::DependencyFlags::empty();
        // SAFETY: this function's contract.
        unsafe {
            self.device
                .raw()
                .cmd_pipeline_barrier(cmd, stages, host, none, &[barrier], &[], &[])
        };
    }
}

fn rasterization(raster: Raster) -> vk::PipelineRasterizationStateCreateInfo<'static> {
    let (cull, front) = match raster {
        Raster::Discard | Raster::Solid => {
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

impl Drop for Raw<'_> {
    fn drop(&mut self) {
        if self.device.is_hung() {
            return;
        }
        let device = self.device.raw();
        let allocator = &mut self.device.allocator();
        // SAFETY: all of it was made from this device; each submission was waited for. Null handles are allowed.
        unsafe {
            for pipeline in self.pipelines.drain(..) {
                device.destroy_pipeline(pipeline, None);
            }
            device.destroy_pipeline_layout(self.layout, None);
            for buffer in self.buffers.drain(..) {
                buffer.destroy(device, allocator);
            }
        }
    }
}
