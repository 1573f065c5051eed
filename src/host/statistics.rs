//! The driver's own counters of what a draw did.

use ash::vk;

use crate::error::Result;
use crate::gpu::failed;
use crate::host::Device;

/// A query of pipeline statistics: control shader patches, evaluation shader invocations, clipping primitives.
///
/// Needs `pipelineStatisticsQuery`; see [`OptionalFeatures`](crate::gpu::OptionalFeatures).
pub struct StatisticsQuery {
    device: Device,
    pool: vk::QueryPool,
}

impl StatisticsQuery {
    /// Makes a query.
    pub fn new(device: &Device) -> Result<StatisticsQuery> {
        let counted = vk::QueryPipelineStatisticFlags::TESSELLATION_CONTROL_SHADER_PATCHES
            | vk::QueryPipelineStatisticFlags::TESSELLATION_EVALUATION_SHADER_INVOCATIONS
            | vk::QueryPipelineStatisticFlags::CLIPPING_PRIMITIVES;
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::PIPELINE_STATISTICS)
            .query_count(1)
            .pipeline_statistics(counted);
        // SAFETY: the device is live and was opened with the feature, where it has it.
        let pool = unsafe { device.raw().create_query_pool(&info, None) }
            .map_err(failed("vkCreateQueryPool"))?;
        Ok(StatisticsQuery {
            device: device.clone(),
            pool,
        })
    }

    /// Records the reset that must come first.
    ///
    /// # Safety
    /// `cmd` is recording on this query's device outside of a render pass.
    pub unsafe fn cmd_reset(&self, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe { self.device.raw().cmd_reset_query_pool(cmd, self.pool, 0, 1) };
    }

    /// Records where counting begins.
    ///
    /// # Safety
    /// `cmd` is recording on this query's device, after the reset, in the subpass in which counting ends.
    pub unsafe fn cmd_begin(&self, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe {
            self.device
                .raw()
                .cmd_begin_query(cmd, self.pool, 0, vk::QueryControlFlags::empty())
        };
    }

    /// Records where it ends.
    ///
    /// # Safety
    /// After [`StatisticsQuery::cmd_begin`], in the same subpass.
    pub unsafe fn cmd_end(&self, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe { self.device.raw().cmd_end_query(cmd, self.pool, 0) };
    }

    /// The counts, in the order of the flags' bits: clipping primitives come before control shader patches there, here they come last.
    pub fn read(&self) -> Result<[u64; 3]> {
        let mut counts = [[0u64; 3]];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: one query of three 64-bit counts.
        unsafe {
            self.device
                .raw()
                .get_query_pool_results(self.pool, 0, &mut counts, flags)
        }
        .map_err(failed("vkGetQueryPoolResults"))?;
        let [clipping, patches, evaluations] = counts[0];
        Ok([patches, evaluations, clipping])
    }
}

impl Drop for StatisticsQuery {
    fn drop(&mut self) {
        if !self.device.is_hung() {
            // SAFETY: every submission has been waited for.
            unsafe { self.device.raw().destroy_query_pool(self.pool, None) };
        }
    }
}
