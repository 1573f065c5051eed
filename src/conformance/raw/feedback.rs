//! Transform feedback, and queries about what passes by.

use std::ptr::null;

use ash::{ext, vk};

use super::{Raw, Recorder};
use crate::error::Result;
use crate::gpu::failed;
use crate::host::Device;

/// The functions of `VK_EXT_transform_feedback`, and a query.
pub struct Feedback<'a> {
    device: &'a Device,
    functions: Option<ext::transform_feedback::Device>,
    pool: vk::QueryPool,
    flags: vk::QueryControlFlags,
    /// Numbers in a result.
    counts: usize,
}

impl<'a> Feedback<'a> {
    /// Captures vertices, and counts the primitives that were written and those there would have been room needed for. The device has
    /// `transformFeedback`.
    pub fn capture(device: &'a Device) -> Result<Feedback<'a>> {
        let functions = ext::transform_feedback::Device::new(device.instance().raw(), device.raw());
        let kind = vk::QueryType::TRANSFORM_FEEDBACK_STREAM_EXT;
        let mut feedback = Feedback::query(device, kind, vk::QueryControlFlags::empty())?;
        feedback.functions = Some(functions);
        Ok(feedback)
    }

    /// Counts the samples that are drawn, exactly. The device has `occlusionQueryPrecise`.
    pub fn samples(device: &'a Device) -> Result<Feedback<'a>> {
        let kind = vk::QueryType::OCCLUSION;
        Feedback::query(device, kind, vk::QueryControlFlags::PRECISE)
    }

    /// Counts the invocations of the geometry shader, and the primitives that it makes. The device has `pipelineStatisticsQuery` and `geometryShader`.
    pub fn geometry(device: &'a Device) -> Result<Feedback<'a>> {
        let kind = vk::QueryType::PIPELINE_STATISTICS;
        Feedback::query(device, kind, vk::QueryControlFlags::empty())
    }

    fn query(
        device: &'a Device,
        kind: vk::QueryType,
        flags: vk::QueryControlFlags,
    ) -> Result<Feedback<'a>> {
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(kind)
            .query_count(1)
            .pipeline_statistics(if kind == vk::QueryType::PIPELINE_STATISTICS {
                vk::QueryPipelineStatisticFlags::GEOMETRY_SHADER_INVOCATIONS
                    | vk::QueryPipelineStatisticFlags::GEOMETRY_SHADER_PRIMITIVES
            } else {
                Default::default()
            });
        // SAFETY: the device is live and was opened with the feature, as the caller promises.
        let pool = unsafe { device.raw().create_query_pool(&info, None) }
            .map_err(failed("vkCreateQueryPool"))?;
        Ok(Feedback {
            device,
            functions: None,
            pool,
            flags,
            counts: if kind == vk::QueryType::OCCLUSION {
                1
            } else {
                2
            },
        })
    }

    /// Resets the query, outside of a pass.
    pub fn reset(&self, cmd: &Recorder<'_>) {
        // SAFETY: recording outside of a pass; the pool is of this device.
        unsafe {
            self.device
                .raw()
                .cmd_reset_query_pool(cmd.cmd, self.pool, 0, 1)
        };
    }

    /// Records draws that are captured into so many bytes of a buffer, and counted.
    pub fn around(
        &self,
        cmd: &Recorder<'_>,
        into: Option<(&Raw<'_>, usize, u64)>,
        draws: impl FnOnce(),
    ) {
        let device = self.device.raw();
        // SAFETY: recording inside of a pass, after the reset; a pipeline with the execution mode Xfb is bound where something is captured.
        unsafe {
            device.cmd_begin_query(cmd.cmd, self.pool, 0, self.flags);
            if let (Some(functions), Some((raw, binding, bytes))) = (&self.functions, into) {
                let buffers = [raw.buffer(binding)];
                let (offsets, sizes) = ([0], [bytes]);
                let (buffers, offsets, sizes) =
                    (buffers.as_ptr(), offsets.as_ptr(), sizes.as_ptr());
                let functions = functions.fp();
                (functions.cmd_bind_transform_feedback_buffers_ext)(
                    cmd.cmd, 0, 1, buffers, offsets, sizes,
                );
                (functions.cmd_begin_transform_feedback_ext)(cmd.cmd, 0, 0, null(), null());
            }
            draws();
            if let (Some(functions), Some(_)) = (&self.functions, into) {
                let functions = functions.fp();
                (functions.cmd_end_transform_feedback_ext)(cmd.cmd, 0, 0, null(), null());
            }
            device.cmd_end_query(cmd.cmd, self.pool, 0);
        }
    }

    /// What was counted: one number, twice; or two, of a capture primitives that were written, and that would have been with more room.
    pub fn counts(&self) -> Result<[u64; 2]> {
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        let device = self.device.raw();
        let error = failed("vkGetQueryPoolResults");
        if self.counts == 1 {
            let mut counts = [0u64];
            // SAFETY: one query of one 64-bit count.
            unsafe { device.get_query_pool_results(self.pool, 0, &mut counts, flags) }
                .map_err(error)?;
            return Ok([counts[0]; 2]);
        }
        let mut counts = [[0u64; 2]];
        // SAFETY: one query of two 64-bit counts.
        unsafe { device.get_query_pool_results(self.pool, 0, &mut counts, flags) }
            .map_err(error)?;
        Ok(counts[0])
    }
}

impl Drop for Feedback<'_> {
    fn drop(&mut self) {
        if !self.device.is_hung() {
            // SAFETY: each submission was waited for.
            unsafe { self.device.raw().destroy_query_pool(self.pool, None) };
        }
    }
}
