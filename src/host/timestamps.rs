//! The time that the device itself takes.

use ash::vk;

use crate::error::Result;
use crate::gpu::failed;
use crate::host::Device;

/// A pair of timestamps: what lies between them took how long.
pub struct TimestampQuery {
    device: Device,
    pool: vk::QueryPool,
    /// The bits of a timestamp that count (`timestampValidBits`).
    mask: u64,
    /// Seconds a tick.
    period: f64,
}

impl TimestampQuery {
    /// Makes a query; None on a device whose queue writes no timestamps.
    ///
    /// # Errors
    /// Vulkan's own.
    pub fn new(device: &Device) -> Result<Option<TimestampQuery>> {
        let physical = device.info().physical;
        // SAFETY: the physical device is that of the live instance.
        let families = unsafe {
            let instance = device.instance().raw();
            instance.get_physical_device_queue_family_properties(physical)
        };
        let bits = families[device.queue_family() as usize].timestamp_valid_bits;
        if bits == 0 {
            return Ok(None);
        }
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TIMESTAMP)
            .query_count(2);
        // SAFETY: the device is live.
        let pool = unsafe { device.raw().create_query_pool(&info, None) }
            .map_err(failed("vkCreateQueryPool"))?;
        Ok(Some(TimestampQuery {
            device: device.clone(),
            pool,
            mask: u64::MAX >> (64 - bits.min(64)),
            period: f64::from(device.limits().timestamp_period) * 1e-9,
        }))
    }

    /// Records the reset that must come first, and the beginning: when all that was recorded before has been done.
    ///
    /// # Safety
    /// `cmd` is recording on this query's device outside of a render pass.
    pub unsafe fn cmd_begin(&self, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe {
            self.device.raw().cmd_reset_query_pool(cmd, self.pool, 0, 2);
            self.cmd_write(cmd, 0);
        }
    }

    /// Records the end: when all that was recorded before has been done.
    ///
    /// # Safety
    /// After [`TimestampQuery::cmd_begin`], in the same command buffer or one that is submitted later to the same queue.
    pub unsafe fn cmd_end(&self, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe { self.cmd_write(cmd, 1) };
    }

    /// # Safety
    /// As [`TimestampQuery::cmd_end`].
    unsafe fn cmd_write(&self, cmd: vk::CommandBuffer, number: u32) {
        let bottom = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
        // SAFETY: this function's contract.
        unsafe {
            self.device
                .raw()
                .cmd_write_timestamp(cmd, bottom, self.pool, number)
        };
    }

    /// Seconds from begin to end. Waits for both.
    ///
    /// # Errors
    /// Vulkan's own.
    pub fn read(&self) -> Result<f64> {
        let mut ticks = [0u64; 2];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: two queries of a 64-bit count each.
        unsafe {
            self.device
                .raw()
                .get_query_pool_results(self.pool, 0, &mut ticks, flags)
        }
        .map_err(failed("vkGetQueryPoolResults"))?;
        // Counters run over.
        let passed = ticks[1].wrapping_sub(ticks[0]) & self.mask;
        Ok(passed as f64 * self.period)
    }
}

impl Drop for TimestampQuery {
    fn drop(&mut self) {
        if !self.device.is_hung() {
            // SAFETY: every submission has been waited for.
            unsafe { self.device.raw().destroy_query_pool(self.pool, None) };
        }
    }
}
