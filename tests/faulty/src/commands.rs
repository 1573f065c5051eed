//! Commands that come out other than they were meant.

use std::collections::HashMap;
use std::ffi::c_void;
use std::sync::{Mutex, PoisonError};

use ash::vk;
use ash::vk::Handle;

use crate::chain::below;
use crate::fault::{Fault, is};

/// Declares functions of command buffers: what stands in the body changes the arguments, and says whether the command is recorded at all.
macro_rules! commands {
    ($($name:ident: $kind:ident($cmd:ident $(, $argument:ident: $type:ty)*) $change:block)*) => {
        $(
            #[allow(non_snake_case, unused_mut)]
            unsafe extern "system" fn $name($cmd: vk::CommandBuffer $(, mut $argument: $type)*) {
                let recorded: bool = $change;
                if recorded {
                    // SAFETY: the application's arguments, or others in their place.
                    unsafe {
                        let name = concat!(stringify!($name), "\0").as_bytes();
                        let name = std::ffi::CStr::from_bytes_with_nul_unchecked(name);
                        let next: vk::$kind = below($cmd.as_raw(), name);
                        next($cmd $(, $argument)*);
                    }
                }
            }
        )*

        fn of_command_buffers(name: &str) -> Option<*const c_void> {
            $(
                if name == stringify!($name) {
                    let own: vk::$kind = $name;
                    return Some(own as *const c_void);
                }
            )*
            None
        }
    };
}

/// What a command buffer was told first, of each kind.
static FIRST: Mutex<Option<HashMap<(u64, &str), u64>>> = Mutex::new(None);

/// The first value that a command buffer was told, and whether this is it.
fn first(cmd: vk::CommandBuffer, kind: &'static str, value: u64) -> (u64, bool) {
    let mut all = FIRST.lock().unwrap_or_else(PoisonError::into_inner);
    let all = all.get_or_insert_default();
    let key = (cmd.as_raw(), kind);
    let known = all.contains_key(&key);
    (*all.entry(key).or_insert(value), !known)
}

/// The command buffer is new.
fn forget(cmd: vk::CommandBuffer) {
    let mut all = FIRST.lock().unwrap_or_else(PoisonError::into_inner);
    all.get_or_insert_default()
        .retain(|(own, _), _| *own != cmd.as_raw());
}

/// Patches beyond these are dropped, of one control point each.
const MANY: u32 = 128 << 10;

commands! {
    vkCmdDraw: PFN_vkCmdDraw(cmd, vertices: u32, instances: u32, first_vertex: u32, first_instance: u32) {
        if is(Fault::DrawsOneLess) {
            vertices = vertices.saturating_sub(1);
        }
        if is(Fault::DrawsNothing) && (vertices == 0 || instances == 0) {
            (vertices, instances) = (32, 1);
        }
        if is(Fault::ForgetsFirstInstance) {
            first_instance = 0;
        }
        if is(Fault::ForgetsFirstVertex) {
            first_vertex = 0;
        }
        if is(Fault::DropsManyPatches) {
            vertices = vertices.min(MANY);
        }
        true
    }
    vkCmdDrawIndexed: PFN_vkCmdDrawIndexed(cmd, indices: u32, instances: u32, first_index: u32, offset: i32, first_instance: u32) {
        if is(Fault::ForgetsOffset) {
            offset = 0;
        }
        true
    }
    vkCmdDrawIndirect: PFN_vkCmdDrawIndirect(cmd, buffer: vk::Buffer, from: u64, count: u32, stride: u32) {
        if is(Fault::DrawsFirstCommand) {
            count = count.min(1);
        }
        true
    }
    vkCmdBindIndexBuffer: PFN_vkCmdBindIndexBuffer(cmd, buffer: vk::Buffer, from: u64, kind: vk::IndexType) {
        if is(Fault::ShortIndices) {
            kind = vk::IndexType::UINT16;
        }
        true
    }
    vkCmdSetPatchControlPointsEXT: PFN_vkCmdSetPatchControlPointsEXT(cmd, points: u32) {
        if is(Fault::KeepsPatchSize) {
            points = first(cmd, "points", points.into()).0 as u32;
        }
        true
    }
    vkCmdExecuteCommands: PFN_vkCmdExecuteCommands(cmd, count: u32, buffers: *const vk::CommandBuffer) {
        if is(Fault::LosesSecondary) {
            count = count.saturating_sub(1).max(1);
        }
        true
    }
    vkCmdBindPipeline: PFN_vkCmdBindPipeline(cmd, point: vk::PipelineBindPoint, pipeline: vk::Pipeline) {
        if is(Fault::KeepsPipeline) {
            pipeline = vk::Pipeline::from_raw(first(cmd, "pipeline", pipeline.as_raw()).0);
        }
        true
    }
    vkCmdPushConstants: PFN_vkCmdPushConstants(
        cmd, layout: vk::PipelineLayout, stages: vk::ShaderStageFlags, from: u32, size: u32, data: *const c_void
    ) {
        !is(Fault::KeepsConstants) || first(cmd, "constants", 0).1
    }
    vkCmdBeginRendering: PFN_vkCmdBeginRendering(cmd, info: *const vk::RenderingInfo<'_>) {
        if is(Fault::ClearsRenderings) {
            // SAFETY: the application's info; its attachments are read once, before this returns, and the copy is leaked into a short-lived process.
            unsafe {
                let count = (*info).color_attachment_count as usize;
                let own = std::slice::from_raw_parts((*info).p_color_attachments, count);
                let cleared = own.iter().map(|own| vk::RenderingAttachmentInfo {
                    load_op: vk::AttachmentLoadOp::CLEAR,
                    ..*own
                });
                let cleared: Vec<_> = cleared.collect();
                let changed = vk::RenderingInfo {
                    p_color_attachments: cleared.leak().as_ptr(),
                    ..*info
                };
                info = Box::leak(Box::new(changed));
            }
        }
        true
    }
    vkCmdBindTransformFeedbackBuffersEXT: PFN_vkCmdBindTransformFeedbackBuffersEXT(
        cmd, number: u32, count: u32, buffers: *const vk::Buffer, from: *const u64, sizes: *const u64
    ) {
        if is(Fault::FeedbackBeyond) {
            // To the buffers' ends.
            sizes = std::ptr::null();
        }
        true
    }
}

unsafe extern "system" fn begin_command_buffer(
    cmd: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    forget(cmd);
    // SAFETY: the application's arguments.
    unsafe {
        let next: vk::PFN_vkBeginCommandBuffer = below(cmd.as_raw(), c"vkBeginCommandBuffer");
        next(cmd, info)
    }
}

// As many arguments as Vulkan's.
#[allow(clippy::too_many_arguments)]
unsafe extern "system" fn get_query_pool_results(
    device: vk::Device,
    pool: vk::QueryPool,
    from: u32,
    count: u32,
    size: usize,
    data: *mut c_void,
    stride: u64,
    flags: vk::QueryResultFlags,
) -> vk::Result {
    // SAFETY: the application's arguments; what it asked for as 64 bits is there on success.
    unsafe {
        let next: vk::PFN_vkGetQueryPoolResults = below(device.as_raw(), c"vkGetQueryPoolResults");
        let result = next(device, pool, from, count, size, data, stride, flags);
        if result == vk::Result::SUCCESS
            && is(Fault::CountsOneMore)
            && flags.contains(vk::QueryResultFlags::TYPE_64)
        {
            *data.cast::<u64>() += 1;
        }
        result
    }
}

/// The layer's own function of this name.
pub fn function(name: &str) -> Option<*const c_void> {
    match name {
        "vkBeginCommandBuffer" => Some(begin_command_buffer as *const c_void),
        "vkGetQueryPoolResults" => Some(get_query_pool_results as *const c_void),
        _ => of_command_buffers(name),
    }
}
