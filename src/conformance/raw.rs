//! Draws with shaders of the suite's own, without any of the layers that our surfaces have.

mod feedback;
mod layers;
mod objects;
mod program;
mod recorder;
mod secondary;

use ash::vk;
use gpu_allocator::MemoryLocation;

use crate::conformance::pictures;
use crate::error::Result;
use crate::gpu::{Buffer, failed};
use crate::host::{Device, Encoding, OffscreenTarget, StatisticsQuery, StorageSet};

pub use feedback::Feedback;
pub use layers::Drawing;
pub use objects::Objects;
pub use program::{Assembly, Program, Raster};
pub use recorder::{Event, Recorder, Scope};

use layers::Layers;
use program::{Destination, Place};
use secondary::Secondary;

/// Stages that see the buffers and the push constants.
const STAGES: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::ALL_GRAPHICS.as_raw() | vk::ShaderStageFlags::COMPUTE.as_raw(),
);

/// The greatest push constants that the suite's shaders have.
const CONSTANT_BYTES: u32 = 32;

/// Storage buffers at bindings 0, 1, ... that the host sees, a picture, and pipelines over them.
pub struct Raw<'a> {
    device: &'a Device,
    layout: vk::PipelineLayout,
    /// Of the buffers.
    set: Option<StorageSet>,
    buffers: Vec<Buffer>,
    pipelines: Vec<vk::Pipeline>,
    target: OffscreenTarget,
    /// The picture in the target's place, where it has views or is drawn without a pass.
    layers: Option<Layers>,
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
            layers: None,
        };
        for &size in sizes {
            raw.make_buffer(size)?;
        }
        let set = StorageSet::new(device, STAGES, raw.buffers.iter())?;
        raw.make_layout(&set)?;
        raw.set = Some(set);
        Ok(raw)
    }

    /// The same with a picture of another kind.
    pub fn drawing(
        device: &'a Device,
        sizes: &[u64],
        side: u32,
        drawing: Drawing,
    ) -> Result<Raw<'a>> {
        let mut raw = Raw::new(device, sizes, side)?;
        raw.layers = Some(Layers::new(device, side, drawing)?);
        Ok(raw)
    }

    fn make_buffer(&mut self, size: u64) -> Result<()> {
        let mut usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::INDEX_BUFFER
            | vk::BufferUsageFlags::INDIRECT_BUFFER;
        if self.device.extra().transform_feedback {
            usage |= vk::BufferUsageFlags::TRANSFORM_FEEDBACK_BUFFER_EXT;
        }
        let (device, location) = (self.device.raw(), MemoryLocation::GpuToCpu);
        let allocator = &mut self.device.allocator();
        // SAFETY: device and allocator belong together; the usage needs no feature but what the device was opened with.
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
        match &self.layers {
            Some(layers) => self.numbers(layers.read(0)),
            None => self.numbers(self.target.read_pixels()),
        }
    }

    /// The same of a view.
    pub fn pixels_of(&self, view: u32) -> Vec<u32> {
        match &self.layers {
            Some(layers) => self.numbers(layers.read(view)),
            None => self.pixels(),
        }
    }

    fn numbers(&self, bytes: &[u8]) -> Vec<u32> {
        let pixels = bytes.chunks_exact(4);
        let word = |pixel: &[u8]| u32::from_le_bytes([pixel[0], pixel[1], pixel[2], 0]);
        let numbers: Vec<u32> = pixels.map(word).collect();
        pictures::drew(|| pictures::of_numbers(self.target.area().width, &numbers));
        numbers
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
        let place = Place {
            device,
            layout: self.layout,
            destination: match &self.layers {
                Some(layers) => layers.destination(),
                None => Destination::Pass(self.target.render_pass()),
            },
            samples: self.target.samples(),
        };
        // Parts that pipelines are linked from live as long as these.
        let pipelines = &mut self.pipelines;
        let made = made.and_then(|()| program.assemble(place, &modules, pipelines));
        for (_, module) in modules {
            // SAFETY: modules are not needed once the pipeline is there.
            unsafe { device.destroy_shader_module(module, None) };
        }
        made
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

    /// The same, of which `query` counts what the draws do: it begins before them.
    pub fn submit_all(
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
            self.begin(cmd, true);
            if let Some(query) = query {
                query.cmd_begin(cmd);
            }
            draws(&self.recorder(cmd));
            if let Some(query) = query {
                query.cmd_end(cmd);
            }
            self.end(cmd);
            Ok(())
        })
    }

    /// The same with so many draws, each in a rendering of its own, over what the one before left: there are no barriers in dynamic rendering.
    pub fn submit_renderings(
        &self,
        count: usize,
        draw: impl Fn(&Recorder<'_>, usize),
    ) -> Result<()> {
        // SAFETY: as above; each rendering ends before the barrier and the next one.
        self.device.submit(|cmd| unsafe {
            for i in 0..count {
                if let (1.., Some(layers)) = (i, &self.layers) {
                    layers.cmd_pause(cmd);
                    self.recorder(cmd).barrier();
                }
                self.begin(cmd, i == 0);
                draw(&self.recorder(cmd), i);
            }
            self.end(cmd);
            Ok(())
        })
    }

    /// Begins drawing over a black picture, or over what is there already, which only pictures without a pass can.
    ///
    /// # Safety
    /// `cmd` is recording on this device, outside of a render pass.
    unsafe fn begin(&self, cmd: vk::CommandBuffer, anew: bool) {
        // SAFETY: this function's contract.
        unsafe {
            match &self.layers {
                Some(layers) => layers.cmd_begin(cmd, anew),
                None => self.target.begin(cmd, [0.0; 4]),
            }
        }
    }

    /// Ends it, and brings all of it to the host.
    ///
    /// # Safety
    /// `cmd` is recording on this device, behind [`begin`](Self::begin).
    unsafe fn end(&self, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe {
            match &self.layers {
                Some(layers) => {
                    layers.cmd_end(cmd);
                    self.cmd_read_back(cmd);
                }
                None => {
                    self.target.end(cmd);
                    self.cmd_read_back(cmd);
                    self.target.cmd_copy_to_host(cmd);
                }
            }
        }
    }

    /// The same with so many draws, each recorded into a secondary command buffer of its own.
    pub fn submit_secondary(
        &self,
        count: usize,
        draw: impl Fn(&Recorder<'_>, usize),
    ) -> Result<()> {
        let secondary = Secondary::new(self.device, count)?;
        for (i, &cmd) in secondary.buffers.iter().enumerate() {
            secondary.begin(cmd, self.target.render_pass())?;
            // SAFETY: it is recording.
            unsafe { self.target.cmd_set_view(cmd) };
            draw(&self.recorder(cmd), i);
            // SAFETY: as above.
            unsafe { self.device.raw().end_command_buffer(cmd) }
                .map_err(failed("vkEndCommandBuffer"))?;
        }
        // SAFETY: recording on the device that made everything; the secondary command buffers are complete, made for this pass, and live until
        // the submission has been waited for.
        self.device.submit(|cmd| unsafe {
            self.target.begin_for_secondary(cmd, [0.0; 4]);
            let device = self.device.raw();
            device.cmd_execute_commands(cmd, &secondary.buffers);
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
            .src_access_mask(if self.device.extra().transform_feedback {
                vk::AccessFlags::SHADER_WRITE | vk::AccessFlags::TRANSFORM_FEEDBACK_WRITE_EXT
            } else {
                vk::AccessFlags::SHADER_WRITE
            })
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
