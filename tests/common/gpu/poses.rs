//! Positions that an engine moves itself.

use ash::vk;
use hullform::gpu::Cut;

use super::Loaded;

impl Loaded<'_> {
    /// Moves the control vertices on the device, as an engine that skins its mesh there would, and computes what a cut needs of what depends on them.
    pub fn move_on_device(&self, positions: &[[f32; 3]], cut: Cut) {
        let (device, layout) = (self.gpu.device.raw(), self.gpu.layout());
        let pipeline = self.point_pipeline();
        let pipeline = pipeline.expect("the shipped module makes a pipeline");
        let list = self.surface().draw_list(cut, None);
        let list = list.expect("it is drawn so");
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
                self.surface()
                    .cmd_points_of(device, cmd, layout, &pipeline, &list);
            }
            Ok(())
        });
        moved.expect("it is executed");
    }
}
