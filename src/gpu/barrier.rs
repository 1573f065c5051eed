//! Barriers between stages that write buffers and stages that read them.

use ash::vk;

/// Bytes that `vkCmdUpdateBuffer` takes (VUID-vkCmdUpdateBuffer-dataSize-00037).
pub(super) const MOST_UPDATED: usize = 65_536;

/// A barrier from all writes of the stages `from` to `access` in the stages `to`.
///
/// # Safety
/// `cmd` is recording on `device`, outside of a render pass.
pub(super) unsafe fn cmd_make_visible(
    device: &ash::Device,
    cmd: vk::CommandBuffer,
    from: vk::PipelineStageFlags,
    to: vk::PipelineStageFlags,
    access: vk::AccessFlags,
) {
    let mut written = vk::AccessFlags::empty();
    if from.contains(vk::PipelineStageFlags::TRANSFER) {
        written |= vk::AccessFlags::TRANSFER_WRITE;
    }
    // Whatever evaluates patches may capture them.
    if from != vk::PipelineStageFlags::TRANSFER {
        written |= vk::AccessFlags::SHADER_WRITE;
    }
    let barrier = vk::MemoryBarrier::default()
        .src_access_mask(written)
        .dst_access_mask(access);
    // SAFETY: this function's contract.
    unsafe {
        device.cmd_pipeline_barrier(
            cmd,
            from,
            to,
            vk::DependencyFlags::empty(),
            &[barrier],
            &[],
            &[],
        )
    };
}
