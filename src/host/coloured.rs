//! Triangles with a colour a vertex: for pictures of numbers over a surface that has been captured.

use ash::vk;
use bytemuck::{Pod, Zeroable};
use gpu_allocator::MemoryLocation;

use crate::error::{Error, Result};
use crate::gpu::{Buffer, failed, shaders};
use crate::host::{Device, OffscreenTarget};

/// A projected vertex and its colour, as `glsl/coloured.vert` takes them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct ColouredVertex {
    /// In clip space.
    pub clip: [f32; 4],
    /// In linear light, already weighted with its alpha.
    pub colour: [f32; 4],
}

/// Triangles on the device with the pipeline that draws them; colours are linear between the vertices.
///
/// Projected by the host, so that there are neither descriptors nor push constants: what is drawn once gains nothing from them.
pub struct ColouredTriangles {
    device: Device,
    buffers: Vec<Buffer>,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
    indices: u32,
}

impl ColouredTriangles {
    /// Brings triangles to the device, to be drawn into `target` or one like it.
    ///
    /// # Errors
    /// [`Error::Refused`] if there are more vertices than the device's indices reach.
    pub fn new(
        device: &Device,
        target: &OffscreenTarget,
        vertices: &[ColouredVertex],
        triangles: &[[u32; 3]],
    ) -> Result<ColouredTriangles> {
        let greatest = device.limits().max_draw_indexed_index_value;
        // Without fullDrawIndexUint32 indices go to 2^24 - 1 (Vulkan, "maxDrawIndexedIndexValue").
        let reach = greatest.min((1 << 24) - 1) as usize;
        if vertices.len() > reach {
            return Err(Error::Refused(format!(
                "{} vertices are more than one draw takes here ({reach}); use a lower --level",
                vertices.len()
            )));
        }
        // Null and empty until made: if a step fails, what was made before it goes with `drawn`.
        let mut drawn = ColouredTriangles {
            device: device.clone(),
            buffers: Vec::new(),
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
            indices: 3 * triangles.len() as u32,
        };
        use vk::BufferUsageFlags as Usage;
        drawn.add_buffer(
            "vertices",
            Usage::VERTEX_BUFFER,
            bytemuck::cast_slice(vertices),
        )?;
        drawn.add_buffer(
            "indices",
            Usage::INDEX_BUFFER,
            bytemuck::cast_slice(triangles),
        )?;
        drawn.make_pipeline(target)?;
        Ok(drawn)
    }

    /// Draws them.
    ///
    /// # Safety
    /// `cmd` is recording on this device, inside a render pass that is compatible with the target's, with viewport and scissor set. They
    /// stay alive until the commands have finished.
    pub unsafe fn cmd_draw(&self, cmd: vk::CommandBuffer) {
        let device = self.device.raw();
        // SAFETY: this function's contract; every index is below the number of vertices, as the caller gave them.
        unsafe {
            device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::GRAPHICS, self.pipeline);
            device.cmd_bind_vertex_buffers(cmd, 0, &[self.buffers[0].raw()], &[0]);
            device.cmd_bind_index_buffer(cmd, self.buffers[1].raw(), 0, vk::IndexType::UINT32);
            device.cmd_draw_indexed(cmd, self.indices, 1, 0, 0, 0);
        }
    }

    fn add_buffer(&mut self, name: &str, usage: vk::BufferUsageFlags, bytes: &[u8]) -> Result<()> {
        let (size, location) = (bytes.len() as u64, MemoryLocation::CpuToGpu);
        let device = self.device.raw();
        let allocator = &mut self.device.allocator();
        // SAFETY: device and allocator belong together; the usage needs no feature.
        let mut buffer = unsafe { Buffer::new(device, allocator, name, size, usage, location) }?;
        buffer.write(0, bytes);
        self.buffers.push(buffer);
        Ok(())
    }

    fn make_pipeline(&mut self, target: &OffscreenTarget) -> Result<()> {
        let device = self.device.raw();
        let info = vk::PipelineLayoutCreateInfo::default();
        // SAFETY: the device is live.
        self.layout = unsafe { device.create_pipeline_layout(&info, None) }
            .map_err(failed("vkCreatePipelineLayout"))?;
        let vertex = Module::new(&self.device, "coloured.vert")?;
        let fragment = Module::new(&self.device, "coloured.frag")?;
        let stages = [
            vertex.stage(vk::ShaderStageFlags::VERTEX),
            fragment.stage(vk::ShaderStageFlags::FRAGMENT),
        ];
        // SAFETY: layout, modules and target are of this device.
        self.pipeline = unsafe { pipeline(device, self.layout, &stages, target) }?;
        Ok(())
    }
}

impl Drop for ColouredTriangles {
    fn drop(&mut self) {
        if self.device.is_hung() {
            return;
        }
        let device = self.device.raw();
        let mut allocator = self.device.allocator();
        // SAFETY: all of it was made from this device; the device waits for each submission, so nothing is in use.
        unsafe {
            device.destroy_pipeline(self.pipeline, None);
            device.destroy_pipeline_layout(self.layout, None);
            for buffer in self.buffers.drain(..) {
                buffer.destroy(device, &mut allocator);
            }
        }
    }
}

/// A shader module that goes when the pipeline is made.
struct Module<'a> {
    device: &'a Device,
    raw: vk::ShaderModule,
}

impl<'a> Module<'a> {
    fn new(device: &'a Device, name: &str) -> Result<Module<'a>> {
        let words = shaders::spirv(name)
            .ok_or_else(|| Error::Refused(format!("there is no shader module {name}")))?;
        let info = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the device is live; the words are a valid module.
        let raw = unsafe { device.raw().create_shader_module(&info, None) }
            .map_err(failed("vkCreateShaderModule"))?;
        Ok(Module { device, raw })
    }

    fn stage(&self, stage: vk::ShaderStageFlags) -> vk::PipelineShaderStageCreateInfo<'static> {
        vk::PipelineShaderStageCreateInfo::default()
            .stage(stage)
            .module(self.raw)
            .name(c"main")
    }
}

impl Drop for Module<'_> {
    fn drop(&mut self) {
        // SAFETY: a module is not needed once the pipeline is there.
        unsafe { self.device.raw().destroy_shader_module(self.raw, None) };
    }
}

/// # Safety
/// Everything is of the live `device`.
unsafe fn pipeline(
    device: &ash::Device,
    layout: vk::PipelineLayout,
    stages: &[vk::PipelineShaderStageCreateInfo<'_>],
    target: &OffscreenTarget,
) -> Result<vk::Pipeline> {
    let attribute = |location, offset| vk::VertexInputAttributeDescription {
        location,
        binding: 0,
        format: vk::Format::R32G32B32A32_SFLOAT,
        offset,
    };
    let bindings = [vk::VertexInputBindingDescription::default()
        .stride(size_of::<ColouredVertex>() as u32)
        .input_rate(vk::VertexInputRate::VERTEX)];
    let attributes = [attribute(0, 0), attribute(1, 16)];
    let vertex_input = vk::PipelineVertexInputStateCreateInfo::default()
        .vertex_binding_descriptions(&bindings)
        .vertex_attribute_descriptions(&attributes);
    let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
        .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let viewport = vk::PipelineViewportStateCreateInfo::default()
        .viewport_count(1)
        .scissor_count(1);
    let rasterization = vk::PipelineRasterizationStateCreateInfo::default()
        .cull_mode(vk::CullModeFlags::NONE)
        .line_width(1.0);
    let multisample =
        vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(target.samples());
    let depth = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(true)
        .depth_write_enable(true)
        .depth_compare_op(vk::CompareOp::LESS_OR_EQUAL);
    let colour = [vk::PipelineColorBlendAttachmentState::default()
        .color_write_mask(vk::ColorComponentFlags::RGBA)];
    let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&colour);
    let dynamic = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic);
    let info = vk::GraphicsPipelineCreateInfo::default()
        .stages(stages)
        .vertex_input_state(&vertex_input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&rasterization)
        .multisample_state(&multisample)
        .depth_stencil_state(&depth)
        .color_blend_state(&blend)
        .dynamic_state(&dynamic)
        .layout(layout)
        .render_pass(target.render_pass());
    // SAFETY: this function's contract; everything that the info points to lives through the call.
    let made =
        unsafe { device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) };
    made.map(|pipelines| pipelines[0])
        .map_err(|(_, code)| failed("vkCreateGraphicsPipelines")(code))
}
