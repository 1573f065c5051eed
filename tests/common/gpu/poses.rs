//! What follows from positions: points, and control points in a cache.

use ash::vk;
use hullform::Result;
use hullform::gpu::{CachePipelines, DrawList, PointPipeline};

use super::Loaded;

impl Loaded<'_> {
    /// Moves the control vertices on the device, as an engine that skins its mesh there would, and computes what depends on them.
    pub fn move_on_device(&self, positions: &[[f32; 3]]) {
        let device = self.gpu.device.raw();
        let layout = self.gpu.layout();
        // SAFETY: device and layout are live.
        let pipeline = unsafe { PointPipeline::new(device, layout, vk::PipelineCache::null()) };
        let pipeline = pipeline.expect("the shipped module makes a pipeline");
        let barrier = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::SHADER_READ);
        let transfer = vk::PipelineStageFlags::TRANSFER;
        let readers =
            vk::PipelineStageFlags::COMPUTE_SHADER | vk::PipelineStageFlags::VERTEX_SHADER;
        let none = vk::DependencyFlags::empty();
        let moved = self.gpu.device.submit(|cmd| {
            // SAFETY: recording on the device that made everything, outside of a render pass; the meshes of the tests are small enough for
            // an update from the command buffer, and nothing is drawn meanwhile.
            unsafe {
                let buffer = self.surface().position_buffer();
                device.cmd_update_buffer(cmd, buffer, 0, bytemuck::cast_slice(positions));
                device.cmd_pipeline_barrier(cmd, transfer, readers, none, &[barrier], &[], &[]);
                self.surface().cmd_points(device, cmd, layout, &pipeline);
            }
            Ok(())
        });
        moved.expect("it is executed");
        // SAFETY: the submission has been waited for.
        unsafe { pipeline.destroy(device) };
    }

    /// Replaces the positions on the host and brings them to the device.
    pub fn replace_positions(&mut self, positions: &[[f32; 3]]) {
        let device = &self.gpu.device;
        let surface = self.surface.as_mut().expect("there from load to drop");
        let written = surface.write_positions(positions);
        written.expect("there is one a control vertex");
        let uploaded = device.submit(|cmd| {
            // SAFETY: recording on the device that made the surface, outside of a render pass.
            unsafe { surface.cmd_upload(device.raw(), cmd) };
            Ok(())
        });
        uploaded.expect("it is executed");
    }

    /// Fills the cache with what a list needs; how many control points are computed.
    pub fn cache(&mut self, list: &DrawList) -> Result<u32> {
        let (device, layout) = (&self.gpu.device, self.gpu.layout());
        let cache = vk::PipelineCache::null();
        let surface = self.surface.as_mut().expect("there from load to drop");
        // SAFETY: all of one live device; the submission is waited for before the pipelines go.
        unsafe {
            let prepared = surface.prepared();
            let pipelines = CachePipelines::new(device.raw(), layout, cache, prepared)?;
            let cached =
                device.submit(|cmd| surface.cmd_cache(device.raw(), cmd, layout, &pipelines, list));
            pipelines.destroy(device.raw());
            cached
        }
    }
}
