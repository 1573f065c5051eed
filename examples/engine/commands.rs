//! Commands, and waiting for them.

use std::error::Error;

use ash::vk;

use crate::gpu::{Gpu, Held, failed};

/// Waits at the end of its scope, so that what is declared before it can be destroyed.
pub struct Idle<'g>(pub &'g Gpu);

impl Drop for Idle<'_> {
    fn drop(&mut self) {
        // SAFETY: nobody else uses the device. A lost device counts as idle (Vulkan spec, "Lost Device").
        let waited = unsafe { self.0.device.device_wait_idle() };
        if let Err(code) = waited
            && code != vk::Result::ERROR_DEVICE_LOST
        {
            // What the device does is not known: so the program leaves without destroying anything.
            eprintln!("{}", failed("vkDeviceWaitIdle")(code));
            std::process::exit(1);
        }
    }
}

/// The commands of a frame in flight.
pub struct Commands<'g> {
    gpu: &'g Gpu,
    queue: vk::Queue,
    pool: Held<'g, vk::CommandPool>,
    fence: Held<'g, vk::Fence>,
    pub cmd: vk::CommandBuffer,
}

impl<'g> Commands<'g> {
    pub fn new(gpu: &'g Gpu) -> Result<Commands<'g>, Box<dyn Error>> {
        let device = &gpu.device;
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.family);
        // SAFETY: the device is live, here and below, and has one queue of this family.
        let pool = unsafe { device.create_command_pool(&info, None) };
        let pool = gpu.hold(pool.map_err(failed("vkCreateCommandPool"))?, |gpu, pool| {
            // SAFETY: see `Gpu::buffer`.
            unsafe { gpu.device.destroy_command_pool(pool, None) };
        });
        let info = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
        // SAFETY: as above.
        let fence = unsafe { device.create_fence(&info, None) };
        let fence = gpu.hold(fence.map_err(failed("vkCreateFence"))?, |gpu, fence| {
            // SAFETY: see `Gpu::buffer`.
            unsafe { gpu.device.destroy_fence(fence, None) };
        });
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(*pool)
            .command_buffer_count(1);
        // SAFETY: as above.
        let cmd = unsafe { device.allocate_command_buffers(&info) };
        Ok(Commands {
            gpu,
            // SAFETY: as above.
            queue: unsafe { device.get_device_queue(gpu.family, 0) },
            cmd: cmd.map_err(failed("vkAllocateCommandBuffers"))?[0],
            pool,
            fence,
        })
    }

    /// Waits until they have been executed.
    pub fn wait(&self) -> Result<(), String> {
        // SAFETY: the fence is ours.
        unsafe {
            let device = &self.gpu.device;
            let waited = device.wait_for_fences(&[*self.fence], true, u64::MAX);
            waited.map_err(failed("vkWaitForFences"))
        }
    }

    /// Waits for the frame that had these commands, and begins anew.
    pub fn begin(&self) -> Result<(), String> {
        self.wait()?;
        let device = &self.gpu.device;
        let once = vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT;
        let begin = vk::CommandBufferBeginInfo::default().flags(once);
        let none = vk::CommandPoolResetFlags::empty();
        // SAFETY: they are ours, and not in use when the fence is signalled.
        unsafe {
            device
                .reset_command_pool(*self.pool, none)
                .map_err(failed("vkResetCommandPool"))?;
            device
                .begin_command_buffer(self.cmd, &begin)
                .map_err(failed("vkBeginCommandBuffer"))
        }
    }

    /// Ends and submits.
    pub fn submit(&self) -> Result<(), String> {
        let device = &self.gpu.device;
        let commands = [self.cmd];
        let submit = [vk::SubmitInfo::default().command_buffers(&commands)];
        // SAFETY: recording, outside of rendering; nobody else uses the queue. The fence is reset only when something will signal it.
        unsafe {
            device
                .end_command_buffer(self.cmd)
                .map_err(failed("vkEndCommandBuffer"))?;
            device
                .reset_fences(&[*self.fence])
                .map_err(failed("vkResetFences"))?;
            device
                .queue_submit(self.queue, &submit, *self.fence)
                .map_err(failed("vkQueueSubmit"))
        }
    }
}
