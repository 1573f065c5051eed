//! The barrier between batches that share scratch memory, and what a render pass must declare for it.
//!
//! Control shaders hand control points to evaluation shaders through a buffer that the next batch uses again. Inside dynamic
//! rendering no barrier is allowed (VUID-vkCmdPipelineBarrier-None-06191); inside a classic render pass it is, if the subpass
//! declares a dependency on itself that covers it.

use ash::vk;

/// The stages that use the scratch memory.
///
/// Both stages on both sides: evaluation to control alone would miss that two batches' control shaders write the same place.
pub const RING_STAGES: vk::PipelineStageFlags = vk::PipelineStageFlags::from_raw(
    vk::PipelineStageFlags::TESSELLATION_CONTROL_SHADER.as_raw()
        | vk::PipelineStageFlags::TESSELLATION_EVALUATION_SHADER.as_raw(),
);

/// What these stages do with it.
pub const RING_ACCESS: vk::AccessFlags = vk::AccessFlags::from_raw(
    vk::AccessFlags::SHADER_READ.as_raw() | vk::AccessFlags::SHADER_WRITE.as_raw(),
);

/// The dependency of `subpass` on itself that [`cmd_ring_barrier`] needs.
///
/// No `BY_REGION`: neither stage is a framebuffer-space stage (VUID-VkSubpassDependency-srcSubpass-02243).
pub fn ring_dependency(subpass: u32) -> vk::SubpassDependency {
    vk::SubpassDependency::default()
        .src_subpass(subpass)
        .dst_subpass(subpass)
        .src_stage_mask(RING_STAGES)
        .dst_stage_mask(RING_STAGES)
        .src_access_mask(RING_ACCESS)
        .dst_access_mask(RING_ACCESS)
}

/// Lets the next batch use the scratch memory again.
///
/// # Safety
/// `cmd` is recording on the live `device`, either outside of a render pass or inside a subpass that was created with
/// [`ring_dependency`] (VUID-vkCmdPipelineBarrier-pDependencies-02285).
pub unsafe fn cmd_ring_barrier(device: &ash::Device, cmd: vk::CommandBuffer) {
    // A global memory barrier: a buffer barrier is refused inside a render pass
    // (VUID-vkCmdPipelineBarrier-bufferMemoryBarrierCount-01178).
    let barrier = vk::MemoryBarrier::default()
        .src_access_mask(RING_ACCESS)
        .dst_access_mask(RING_ACCESS);
    let no_flags = vk::DependencyFlags::empty();
    // SAFETY: this function's contract; the flags are those of the self-dependency, as the subpass demands.
    unsafe {
        device.cmd_pipeline_barrier(
            cmd,
            RING_STAGES,
            RING_STAGES,
            no_flags,
            &[barrier],
            &[],
            &[],
        );
    }
}
