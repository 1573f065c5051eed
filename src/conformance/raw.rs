//! Draws with shaders of the suite's own, without any of the layers that our surfaces have.

use std::borrow::Cow;

use ash::vk;
use gpu_allocator::MemoryLocation;

use crate::conformance::modes::module;
use crate::error::Result;
use crate::gpu::ring::{RING_STAGES, cmd_ring_barrier};
use crate::gpu::{Buffer, failed};
use crate::host::{Device, Encoding, OffscreenTarget, StatisticsQuery, StorageSet};

/// Stages that see the buffers and the push constants.
const STAGES: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::TESSELLATION_CONTROL.as_raw()
        | vk::ShaderStageFlags::TESSELLATION_EVALUATION.as_raw(),
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
}

/// What a pipeline is made of, beside the vertex shader that all share.
pub struct Program {
    /// Words of the control shader.
    pub control: Cow<'static, [u32]>,
    /// Words of the evaluation shader.
    pub evaluation: Cow<'static, [u32]>,
    /// Control points a patch.
    pub control_points: u32,
    /// Constant 0 of the control shader.
    pub constant: u32,
    /// What becomes of the triangles.
    pub raster: Raster,
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
        let vertex = module("patch.vert")?;
        let fragment = module("solid.frag")?;
        let mut stages: Vec<(vk::ShaderStageFlags, &[u32])> = vec![
            (vk::ShaderStageFlags::VERTEX, vertex),
            (vk::ShaderStageFlags::TESSELLATION_CONTROL, &program.control),
            (
                vk::ShaderStageFlags::TESSELLATION_EVALUATION,
                &program.evaluation,
            ),
        ];
        if program.raster != Raster::Discard {
            stages.push((vk::ShaderStageFlags::FRAGMENT, fragment));
        }
        let device = self.device.raw();
        let mut modules = Vec::new();
        let mut made = Ok(());
        for (stage, words) in stages {
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
        let constant = program.constant.to_le_bytes();
        let entries = [vk::SpecializationMapEntry::default().size(4)];
        let special = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(&constant);
        let stage = |&(stage, module): &(vk::ShaderStageFlags, vk::ShaderModule)| {
            let info = vk::PipelineShaderStageCreateInfo::default()
                .stage(stage)
                .module(module)
                .name(c"main");
            if stage == vk::ShaderStageFlags::TESSELLATION_CONTROL {
                info.specialization_info(&special)
            } else {
                info
            }
        };
        let stages: Vec<_> = modules.iter().map(stage).collect();
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::PATCH_LIST);
        let tessellation = vk::PipelineTessellationStateCreateInfo::default()
            .patch_control_points(program.control_points);
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
            .tessellation_state(&tessellation)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&multisample)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(self.layout)
            .render_pass(self.target.render_pass());
        let (device, cache) = (self.device.raw(), vk::PipelineCache::null());
        // SAFETY: everything that the info points to lives through the call and is of this device.
        let made = unsafe { device.create_graphics_pipelines(cache, &[info], None) };
        made.map(|pipelines| pipelines[0])
            .map_err(|(_, code)| failed("vkCreateGraphicsPipelines")(code))
    }

    /// Records `draws` inside of a render pass over a black picture, submits, and waits. `query` counts what they do.
    pub fn submit(
        &self,
        query: Option<&StatisticsQuery>,
        draws: impl FnOnce(&Recorder<'_>),
    ) -> Result<()> {
        let recorder = |cmd| Recorder {
            device: self.device.raw(),
            raw: self,
            cmd,
        };
        // SAFETY: recording on the device that made everything: the query's reset outside of the pass, the rest in it.
        self.device.submit(|cmd| unsafe {
            if let Some(query) = query {
                query.cmd_reset(cmd);
            }
            self.target.begin(cmd, [0.0; 4]);
            if let Some(query) = query {
                query.cmd_begin(cmd);
            }
            draws(&recorder(cmd));
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
        let (stages, host) = (RING_STAGES, vk::PipelineStageFlags::HOST);
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
    vk::PipelineRasterizationStateCreateInfo::default()
        .rasterizer_discard_enable(raster == Raster::Discard)
        .polygon_mode(vk::PolygonMode::FILL)
        .cull_mode(if raster == Raster::Front {
            vk::CullModeFlags::BACK
        } else {
            vk::CullModeFlags::NONE
        })
        .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
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

/// Records draws inside of the render pass. Draws of one submission that write the same memory need a [`barrier`](Self::barrier) between
/// them.
pub struct Recorder<'a> {
    device: &'a ash::Device,
    raw: &'a Raw<'a>,
    cmd: vk::CommandBuffer,
}

impl Recorder<'_> {
    /// Binds a pipeline with all buffers, and sets the push constants.
    pub fn bind<T: bytemuck::NoUninit>(&self, pipeline: vk::Pipeline, constants: &T) {
        let bytes = bytemuck::bytes_of(constants);
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        let layout = self.raw.layout;
        let sets = self.raw.set.as_slice();
        let sets: Vec<vk::DescriptorSet> = sets.iter().map(StorageSet::raw).collect();
        // SAFETY: recording inside of the pass that the pipeline was made for; all of one device.
        unsafe {
            let device = self.device;
            device.cmd_bind_pipeline(self.cmd, graphics, pipeline);
            device.cmd_bind_descriptor_sets(self.cmd, graphics, layout, 0, &sets, &[]);
            device.cmd_push_constants(self.cmd, layout, STAGES, 0, bytes);
        }
    }

    /// A draw without indices.
    pub fn draw(&self, vertices: u32, instances: u32, first_vertex: u32, first_instance: u32) {
        // SAFETY: a pipeline is bound; nothing is fetched but by the vertex's number.
        unsafe {
            self.device
                .cmd_draw(self.cmd, vertices, instances, first_vertex, first_instance)
        };
    }

    /// A draw with the 32-bit indices in a buffer.
    pub fn draw_indexed(&self, binding: usize, indices: u32, instances: u32, offset: i32) {
        self.bind_indices(binding);
        // SAFETY: a pipeline and indices are bound, and the caller's buffer holds so many.
        unsafe {
            self.device
                .cmd_draw_indexed(self.cmd, indices, instances, 0, offset, 0)
        };
    }

    /// A draw whose arguments are the first words of a buffer.
    pub fn draw_indirect(&self, arguments: usize) {
        let buffer = self.raw.buffer(arguments);
        let stride = size_of::<vk::DrawIndirectCommand>() as u32;
        // SAFETY: a pipeline is bound; the host wrote the arguments before the submission.
        unsafe {
            self.device
                .cmd_draw_indirect(self.cmd, buffer, 0, 1, stride)
        };
    }

    /// A draw with indices whose arguments are the first words of a buffer.
    pub fn draw_indexed_indirect(&self, binding: usize, arguments: usize) {
        self.bind_indices(binding);
        let buffer = self.raw.buffer(arguments);
        let stride = size_of::<vk::DrawIndexedIndirectCommand>() as u32;
        // SAFETY: as above, and indices are bound.
        unsafe {
            self.device
                .cmd_draw_indexed_indirect(self.cmd, buffer, 0, 1, stride)
        };
    }

    /// Lets the next draw use the memory of the one before.
    pub fn barrier(&self) {
        // SAFETY: inside of a pass that was made with the dependency for it.
        unsafe { cmd_ring_barrier(self.device, self.cmd) };
    }

    fn bind_indices(&self, binding: usize) {
        let (buffer, kind) = (self.raw.buffer(binding), vk::IndexType::UINT32);
        // SAFETY: the buffer was made to hold indices.
        unsafe { self.device.cmd_bind_index_buffer(self.cmd, buffer, 0, kind) };
    }
}
