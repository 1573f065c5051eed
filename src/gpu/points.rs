//! Computing points from the control vertices on the device: for meshes that move there.

use ash::vk;

use crate::abi;
use crate::error::Result;
use crate::frame::DrawList;
use crate::gpu::sets::STAGES;
use crate::gpu::shaders::{Embedded, Modules};
use crate::gpu::{Layout, Pose, Tables, failed};

/// The pipeline that computes points, the same for all methods.
#[derive(Debug)]
pub struct PointPipeline {
    pipeline: vk::Pipeline,
}

impl PointPipeline {
    /// Builds it. The cache may go afterwards.
    ///
    /// # Errors
    /// Vulkan's own.
    ///
    /// # Safety
    /// `device` is live; `layout` and `cache` (or null) are of this device.
    pub unsafe fn new(
        device: &ash::Device,
        layout: &Layout,
        cache: vk::PipelineCache,
    ) -> Result<PointPipeline> {
        // SAFETY: this function's contract.
        let pipeline =
            unsafe { compute_pipeline(device, layout, cache, "points.comp", &Embedded)? };
        Ok(PointPipeline { pipeline })
    }

    /// Destroys it.
    ///
    /// # Safety
    /// `device` made it, and no submitted command still uses it.
    pub unsafe fn destroy(self, device: &ash::Device) {
        // SAFETY: this function's contract.
        unsafe { device.destroy_pipeline(self.pipeline, None) };
    }
}

impl Pose {
    /// Records the computation of the points from the control vertices in [`position_buffer`](Self::position_buffer), with the same bits as
    /// [`write_positions`](Self::write_positions) has. Methods without such points record nothing.
    ///
    /// It waits for the draws of earlier frames, and later draws wait for it. Binds a compute pipeline and sets 0 and 1, and pushes constants.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this pose, for these tables, outside of a render pass, on a queue that also computes; control vertices are
    /// visible to `SHADER_READ` in the compute stage. `layout` made all of this. All of them live until the commands have
    /// been executed.
    pub unsafe fn cmd_points(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipeline: &PointPipeline,
        tables: &Tables,
    ) {
        // SAFETY: this function's contract.
        unsafe { self.cmd_some_points(device, cmd, layout, pipeline, (tables, None)) };
    }

    /// The same of the points alone that a draw list needs: of methods that refine as deep as a frame needs, those of its depths; of others all. Before another list is drawn,
    /// its points are computed.
    ///
    /// # Safety
    /// As [`cmd_points`](Self::cmd_points); `list` is of what these tables were made of.
    pub unsafe fn cmd_points_of(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipeline: &PointPipeline,
        (tables, list): (&Tables, &DrawList),
    ) {
        let depths = list.depths();
        // SAFETY: this function's contract.
        unsafe { self.cmd_some_points(device, cmd, layout, pipeline, (tables, depths)) };
    }

    /// # Safety
    /// As [`cmd_points`](Self::cmd_points).
    unsafe fn cmd_some_points(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipeline: &PointPipeline,
        (tables, depths): (&Tables, Option<&[u32]>),
    ) {
        let compute = vk::PipelineStageFlags::COMPUTE_SHADER;
        let prepared = tables.prepared();
        if prepared.passes.is_empty() {
            return;
        }
        let sets = [tables.set(0), self.set()];
        let readers = self.readers();
        let mut before = readers | compute;
        for parts in prepared.points.steps_at(depths) {
            let bind = vk::PipelineBindPoint::COMPUTE;
            // SAFETY: this function's contract.
            unsafe {
                cmd_points_barrier(device, cmd, before, compute);
                device.cmd_bind_pipeline(cmd, bind, pipeline.pipeline);
                device.cmd_bind_descriptor_sets(cmd, bind, layout.pipeline(), 0, &sets, &[]);
            }
            for part in &parts {
                let constants = bytemuck::bytes_of(part);
                let groups = part.count.div_ceil(abi::POINT_INVOCATIONS);
                // SAFETY: as above.
                unsafe {
                    device.cmd_push_constants(cmd, layout.pipeline(), STAGES, 0, constants);
                    device.cmd_dispatch(cmd, groups, 1, 1);
                }
            }
            before = compute;
        }
        // SAFETY: as above.
        unsafe { cmd_points_barrier(device, cmd, compute, readers) };
    }
}

/// The pipeline of a compute shader.
///
/// # Errors
/// Vulkan's own.
///
/// # Safety
/// `device` is live; `layout` and `cache` (or null) are of this device; the module is valid SPIR-V for it.
pub(super) unsafe fn compute_pipeline(
    device: &ash::Device,
    layout: &Layout,
    cache: vk::PipelineCache,
    name: &str,
    from: &dyn Modules,
) -> Result<vk::Pipeline> {
    let words = from.module(name)?;
    let info = vk::ShaderModuleCreateInfo::default().code(&words);
    // SAFETY: the words are a valid module, as the caller promises.
    let module = unsafe { device.create_shader_module(&info, None) }
        .map_err(failed("vkCreateShaderModule"))?;
    let stage = vk::PipelineShaderStageCreateInfo::default()
        .stage(vk::ShaderStageFlags::COMPUTE)
        .module(module)
        .name(c"main");
    let info = vk::ComputePipelineCreateInfo::default()
        .stage(stage)
        .layout(layout.pipeline());
    // SAFETY: everything that the info points to lives through the call; the module is not needed once the pipeline is there.
    let made = unsafe {
        let made = device.create_compute_pipelines(cache, &[info], None);
        device.destroy_shader_module(module, None);
        made
    };
    made.map(|pipelines| pipelines[0])
        .map_err(|(_, code)| failed("vkCreateComputePipelines")(code))
}

/// # Safety
/// `cmd` is recording on `device`, outside of a render pass.
pub(super) unsafe fn cmd_points_barrier(
    device: &ash::Device,
    cmd: vk::CommandBuffer,
    from: vk::PipelineStageFlags,
    to: vk::PipelineStageFlags,
) {
    let barrier = vk::MemoryBarrier::default()
        .src_access_mask(vk::AccessFlags::SHADER_WRITE)
        .dst_access_mask(vk::AccessFlags::SHADER_READ | vk::AccessFlags::SHADER_WRITE);
    let none = vk::DependencyFlags::empty();
    // SAFETY: this function's contract.
    unsafe { device.cmd_pipeline_barrier(cmd, from, to, none, &[barrier], &[], &[]) };
}
