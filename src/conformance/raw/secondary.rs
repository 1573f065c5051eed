//! Secondary command buffers for draws in a render pass.

use ash::vk;

use crate::error::Result;
use crate::gpu::failed;
use crate::host::Device;

/// Some of them, with their pool.
pub(super) struct Secondary<'a> {
    device: &'a Device,
    pool: vk::CommandPool,
    pub(super) buffers: Vec<vk::CommandBuffer>,
}

impl<'a> Secondary<'a> {
    pub(super) fn new(device: &'a Device, count: usize) -> Result<Secondary<'a>> {
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(device.queue_family());
        // SAFETY: the device is live.
        let pool = unsafe { device.raw().create_command_pool(&info, None) };
        let mut secondary = Secondary {
            device,
            pool: pool.map_err(failed("vkCreateCommandPool"))?,
            buffers: Vec::new(),
        };
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(secondary.pool)
            .level(vk::CommandBufferLevel::SECONDARY)
            .command_buffer_count(count as u32);
        // SAFETY: the pool is new and ours.
        let buffers = unsafe { device.raw().allocate_command_buffers(&info) };
        secondary.buffers = buffers.map_err(failed("vkAllocateCommandBuffers"))?;
        Ok(secondary)
    }

    /// Begins one of them, for the first subpass of a pass.
    pub(super) fn begin(&self, cmd: vk::CommandBuffer, pass: vk::RenderPass) -> Result<()> {
        let inherited = vk::CommandBufferInheritanceInfo::default().render_pass(pass);
        let info = vk::CommandBufferBeginInfo::default()
            .flags(
                vk::CommandBufferUsageFlags::RENDER_PASS_CONTINUE
                    | vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT,
            )
            .inheritance_info(&inherited);
        // SAFETY: it is new and ours; the pass is of the same device.
        unsafe { self.device.raw().begin_command_buffer(cmd, &info) }
            .map_err(failed("vkBeginCommandBuffer"))
    }
}

impl Drop for Secondary<'_> {
    fn drop(&mut self) {
        if !self.device.is_hung() {
            // SAFETY: each submission was waited for.
            unsafe { self.device.raw().destroy_command_pool(self.pool, None) };
        }
    }
}
