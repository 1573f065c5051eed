//! Triangles with a colour a vertex: for pictures of numbers over a surface that has been captured.

use ash::vk;
use bytemuck::{Pod, Zeroable};
use gpu_allocator::MemoryLocation;

use crate::error::{Error, Misuse, Result};
use crate::gpu::{Buffer, failed, shaders};
use crate::host::{Device, OffscreenTarget, StorageSet};

/// A projected vertex and its colour, as `glsl/coloured.vert` takes them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct ColouredVertex {
    /// In clip space.
    pub clip: [f32; 4],
    /// In linear light, already weighted with its alpha.
    pub colour: [f32; 4],
}

/// Triangles on the device with the pipeline that draws them; colours are linear between the vertices. Vertices leave a mark, so that one can
/// tell whether they came.
///
/// Projected by the host, so that there are no push constants: what is drawn once gains nothing from them.
pub struct ColouredTriangles {
    device: Device,
    /// Vertices, indices, marks.
    buffers: Vec<Buffer>,
    /// Of the marks.
    set: Option<StorageSet>,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
    indices: u32,
    /// Vertices that triangles have.
    used: usize,
}

/// Where the marks stand in [`ColouredTriangles::buffers`].
const MARKS: usize = 2;

impl ColouredTriangles {
    /// Brings triangles to the device, to be drawn into `target` or one like it.
    ///
    /// # Errors
    /// [`Error::Refused`] if there are more vertices than the device's indices reach; [`Misuse::Index`] for a triangle of others.
    pub fn new(
        device: &Device,
        target: &OffscreenTarget,
        vertices: &[ColouredVertex],
        triangles: &[[u32; 3]],
    ) -> Result<ColouredTriangles> {
        check(device, vertices, triangles)?;
        // Null and empty until made: if a step fails, what was made before it goes with `drawn`.
        let mut drawn = ColouredTriangles {
            device: device.clone(),
            buffers: Vec::new(),
            set: None,
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
            indices: 0,
            used: 0,
        };
        let set = drawn.fill(vertices, triangles, 1)?;
        drawn.make_pipeline(target, &set)?;
        drawn.set = Some(set);
        Ok(drawn)
    }

    /// Other triangles in the place of these. Buffers grow by doubling: what changes each frame costs a copy of it.
    ///
    /// # Errors
    /// As [`ColouredTriangles::new`].
    ///
    /// # Safety
    /// No submitted command still draws them.
    pub unsafe fn replace(
        &mut self,
        vertices: &[ColouredVertex],
        triangles: &[[u32; 3]],
    ) -> Result<()> {
        check(&self.device, vertices, triangles)?;
        let (of_vertices, of_triangles) = (size_of_val(vertices), size_of_val(triangles));
        let fits = self.buffers.len() > MARKS
            && of_vertices as u64 <= self.buffers[0].size()
            && of_triangles as u64 <= self.buffers[1].size();
        if fits {
            self.buffers[0].write(0, bytemuck::cast_slice(vertices))?;
            self.buffers[1].write(0, bytemuck::cast_slice(triangles))?;
            self.indices = 3 * triangles.len() as u32;
            self.used = used(vertices.len(), triangles);
            return Ok(());
        }
        self.indices = 0;
        {
            let mut allocator = self.device.allocator();
            for buffer in self.buffers.drain(..) {
                // SAFETY: this function's contract.
                unsafe { buffer.destroy(self.device.raw(), &mut allocator) };
            }
        }
        self.set = Some(self.fill(vertices, triangles, 2)?);
        Ok(())
    }

    /// Makes the buffers, with room for so many times what is in them, and the set that shows the marks.
    fn fill(
        &mut self,
        vertices: &[ColouredVertex],
        triangles: &[[u32; 3]],
        room: usize,
    ) -> Result<StorageSet> {
        use MemoryLocation::{CpuToGpu, GpuToCpu};
        use vk::BufferUsageFlags as Usage;
        let (of_vertices, of_triangles) = (
            bytemuck::cast_slice(vertices),
            bytemuck::cast_slice(triangles),
        );
        self.add_buffer(
            "vertices",
            Usage::VERTEX_BUFFER,
            CpuToGpu,
            of_vertices,
            room,
        )?;
        self.add_buffer("indices", Usage::INDEX_BUFFER, CpuToGpu, of_triangles, room)?;
        let marks = vec![0; 4 * vertices.len().max(1) * room];
        self.add_buffer("marks", Usage::STORAGE_BUFFER, GpuToCpu, &marks, 1)?;
        self.indices = 3 * triangles.len() as u32;
        self.used = used(vertices.len(), triangles);
        let marks = self.buffers[MARKS..].iter();
        StorageSet::new(&self.device, vk::ShaderStageFlags::VERTEX, marks)
    }

    /// Draws them.
    ///
    /// # Safety
    /// `cmd` is recording on this device, inside a render pass that is compatible with the target's, with viewport and scissor set. They
    /// stay alive until the commands have finished. Only after the first draw marks tell anything: they are not taken back.
    pub unsafe fn cmd_draw(&self, cmd: vk::CommandBuffer) {
        let device = self.device.raw();
        let sets = self.set.as_slice();
        let sets: Vec<vk::DescriptorSet> = sets.iter().map(StorageSet::raw).collect();
        // SAFETY: this function's contract; every index is below the number of vertices, as the caller gave them.
        unsafe {
            let graphics = vk::PipelineBindPoint::GRAPHICS;
            device.cmd_bind_pipeline(cmd, graphics, self.pipeline);
            device.cmd_bind_descriptor_sets(cmd, graphics, self.layout, 0, &sets, &[]);
            device.cmd_bind_vertex_buffers(cmd, 0, &[self.buffers[0].raw()], &[0]);
            device.cmd_bind_index_buffer(cmd, self.buffers[1].raw(), 0, vk::IndexType::UINT32);
            device.cmd_draw_indexed(cmd, self.indices, 1, 0, 0, 0);
        }
    }

    /// Makes the marks visible to the host, for [`check`](Self::check).
    ///
    /// # Safety
    /// `cmd` is recording on this device, after the draw and outside of a render pass.
    pub unsafe fn cmd_read_back(&self, cmd: vk::CommandBuffer) {
        let written = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::SHADER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ);
        let (from, to) = (
            vk::PipelineStageFlags::VERTEX_SHADER,
            vk::PipelineStageFlags::HOST,
        );
        let none = vk::DependencyFlags::empty();
        let device = self.device.raw();
        // SAFETY: this function's contract.
        unsafe { device.cmd_pipeline_barrier(cmd, from, to, none, &[written], &[], &[]) };
    }

    /// Refuses what was drawn if not every vertex came. Meaningful when [`cmd_read_back`](Self::cmd_read_back) has been executed.
    ///
    /// # Errors
    /// [`Error::Lost`].
    pub fn check(&self) -> Result<()> {
        let marks: &[u32] = bytemuck::cast_slice(self.buffers[MARKS].bytes());
        let came = marks.iter().filter(|&&mark| mark != 0).count();
        if came >= self.used {
            return Ok(());
        }
        Err(Error::Lost {
            what: format!("{} of {} coloured vertices", self.used - came, self.used),
        })
    }

    fn add_buffer(
        &mut self,
        name: &str,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
        bytes: &[u8],
        room: usize,
    ) -> Result<()> {
        let size = (bytes.len() * room) as u64;
        let device = self.device.raw();
        let allocator = &mut self.device.allocator();
        // SAFETY: device and allocator belong together; the usage needs no feature.
        let buffer = unsafe { Buffer::new(device, allocator, name, size, usage, location) }?;
        self.buffers.push(buffer);
        let last = self.buffers.len() - 1;
        self.buffers[last].write(0, bytes)
    }

    fn make_pipeline(&mut self, target: &OffscreenTarget, set: &StorageSet) -> Result<()> {
        let device = self.device.raw();
        let sets = [set.layout()];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
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

/// Refuses what one draw cannot take, and triangles of vertices that there are not.
fn check(device: &Device, vertices: &[ColouredVertex], triangles: &[[u32; 3]]) -> Result<()> {
    let greatest = device.limits().max_draw_indexed_index_value;
    // Without fullDrawIndexUint32 indices go to 2^24 - 1 (Vulkan, "maxDrawIndexedIndexValue").
    let reach = greatest.min((1 << 24) - 1) as usize;
    if vertices.len() > reach {
        return Err(Error::Refused(format!(
            "{} vertices are more than one draw takes here ({reach}); use a lower --level",
            vertices.len()
        )));
    }
    let mut corners = triangles.iter().flatten().copied();
    if let Some(vertex) = corners.find(|&vertex| vertex as usize >= vertices.len()) {
        let count = vertices.len();
        return Err(Error::Misuse(Misuse::Index { vertex, count }));
    }
    Ok(())
}

/// How many of the vertices some triangle has.
fn used(vertices: usize, triangles: &[[u32; 3]]) -> usize {
    let mut is_used = vec![false; vertices];
    for &vertex in triangles.iter().flatten() {
        is_used[vertex as usize] = true;
    }
    is_used.into_iter().filter(|&used| used).count()
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
