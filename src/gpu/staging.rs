//! Memory that the host writes and the device copies to where it is read.

use ash::vk;
use gpu_allocator::MemoryLocation;

use crate::error::Result;
use crate::gpu::barrier::cmd_make_visible;
use crate::gpu::bound::Bound;
use crate::gpu::{Buffer, Memory};

/// The queue families between which what has been copied changes hands. The buffers are `EXCLUSIVE`: what one family has written another one sees
/// only after a release by the one and an acquisition by the other, with a semaphore between (Vulkan spec, "Queue Family Ownership Transfer").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handover {
    /// The family of the queue that copies.
    pub from: u32,
    /// The family of the queues that draw.
    pub to: u32,
}

/// What is to be copied into numbered buffers, together.
#[derive(Debug, Default)]
pub(super) struct Staging {
    bytes: Vec<u8>,
    copies: Vec<(usize, vk::BufferCopy)>,
    buffer: Option<Buffer>,
    /// Whether there is something that no recorded copy has.
    changed: bool,
}

impl Staging {
    /// Adds what will be copied to a buffer; before [`Staging::fill`].
    pub fn add(&mut self, number: usize, bytes: &[u8]) {
        let copy = vk::BufferCopy::default()
            .src_offset(self.bytes.len() as u64)
            .size(bytes.len() as u64);
        self.copies.push((number, copy));
        self.bytes.extend_from_slice(bytes);
    }

    /// Makes the memory, and brings there what was added.
    ///
    /// # Safety
    /// `device` is live and `allocator` its own.
    pub unsafe fn fill(&mut self, device: &ash::Device, allocator: &mut dyn Memory) -> Result<()> {
        let bytes = std::mem::take(&mut self.bytes);
        let (size, usage) = (bytes.len() as u64, vk::BufferUsageFlags::TRANSFER_SRC);
        let location = MemoryLocation::CpuToGpu;
        // SAFETY: this function's contract.
        let buffer = unsafe { Buffer::new(device, allocator, "staging", size, usage, location)? };
        self.changed = true;
        self.buffer.insert(buffer).write(0, &bytes)
    }

    /// Replaces what will be copied to a buffer, or the beginning of it.
    pub fn replace(&mut self, number: usize, bytes: &[u8]) -> Result<()> {
        let copy = self.copies.iter().find(|(to, _)| *to == number);
        let copy = copy.expect("only what was added is replaced").1;
        debug_assert!(bytes.len() as u64 <= copy.size);
        let buffer = self.buffer.as_mut();
        let buffer = buffer.expect("it is filled as long as the surface lives");
        self.changed = true;
        buffer.write(copy.src_offset, bytes)
    }

    /// The copies that bring the device what has changed since this was asked last.
    pub fn take_copies(&mut self) -> Option<(vk::Buffer, &[(usize, vk::BufferCopy)])> {
        let buffer = self.buffer.as_ref()?.raw();
        std::mem::take(&mut self.changed).then_some((buffer, &self.copies[..]))
    }

    /// The memory, if it was made.
    pub fn into_buffer(self) -> Option<Buffer> {
        self.buffer
    }
}

/// Records the copies that are due, after what earlier commands of the queue still read, and before whatever reads next in the stages `readers`.
///
/// # Safety
/// `cmd` is recording on the device of both, outside of a render pass; the copies were added for buffers of `bound`.
pub(super) unsafe fn cmd_copy(
    device: &ash::Device,
    cmd: vk::CommandBuffer,
    staging: &mut Staging,
    bound: &Bound,
    readers: vk::PipelineStageFlags,
) {
    let Some((from, copies)) = staging.take_copies() else {
        return;
    };
    let transfer = vk::PipelineStageFlags::TRANSFER;
    let (write, read) = (
        vk::AccessFlags::TRANSFER_WRITE,
        vk::AccessFlags::SHADER_READ | vk::AccessFlags::UNIFORM_READ,
    );
    // SAFETY: this function's contract; the copies were made with the buffers' sizes.
    unsafe {
        cmd_make_visible(device, cmd, readers | transfer, transfer, write);
        for (number, copy) in copies.iter().filter(|(_, copy)| copy.size > 0) {
            device.cmd_copy_buffer(cmd, from, bound.buffer(*number).raw(), &[*copy]);
        }
        cmd_make_visible(device, cmd, transfer, readers, read);
    }
}

/// Records the copies that are due on a queue that does not draw, and their buffers' release. Returns whether there were any.
///
/// # Safety
/// As [`cmd_copy`]; nothing that was submitted still uses the buffers.
pub(super) unsafe fn cmd_copy_and_release(
    device: &ash::Device,
    cmd: vk::CommandBuffer,
    staging: &mut Staging,
    bound: &Bound,
    handover: Handover,
) -> bool {
    let Some((from, copies)) = staging.take_copies() else {
        return false;
    };
    let (transfer, end) = (
        vk::PipelineStageFlags::TRANSFER,
        vk::PipelineStageFlags::BOTTOM_OF_PIPE,
    );
    // Whatever the buffers held is overwritten as a whole, so nobody need hand them over before (same chapter).
    // SAFETY: this function's contract; the copies were made with the buffers' sizes.
    unsafe {
        for (number, copy) in copies.iter().filter(|(_, copy)| copy.size > 0) {
            device.cmd_copy_buffer(cmd, from, bound.buffer(*number).raw(), &[*copy]);
        }
        let written = (vk::AccessFlags::TRANSFER_WRITE, vk::AccessFlags::empty());
        cmd_hand_over(device, cmd, bound, handover, [transfer, end], written);
    }
    true
}

/// Records the acquisition of what [`cmd_copy_and_release`] has released, before whatever reads next in the stages `readers`.
///
/// # Safety
/// `cmd` is recording on the device of `bound`, outside of a render pass, for a queue of the family `handover.to`, and waits for the release.
pub(super) unsafe fn cmd_acquire(
    device: &ash::Device,
    cmd: vk::CommandBuffer,
    bound: &Bound,
    handover: Handover,
    readers: vk::PipelineStageFlags,
) {
    let read = vk::AccessFlags::SHADER_READ | vk::AccessFlags::UNIFORM_READ;
    // The semaphore that is waited for in any of these stages comes before the barrier.
    let stages = [readers, readers];
    // SAFETY: this function's contract.
    unsafe {
        let accesses = (vk::AccessFlags::empty(), read);
        cmd_hand_over(device, cmd, bound, handover, stages, accesses);
    }
}

/// One half of the transfer of all buffers.
///
/// # Safety
/// `cmd` is recording on the device of `bound`, outside of a render pass.
unsafe fn cmd_hand_over(
    device: &ash::Device,
    cmd: vk::CommandBuffer,
    bound: &Bound,
    Handover { from, to }: Handover,
    [before, after]: [vk::PipelineStageFlags; 2],
    (written, read): (vk::AccessFlags, vk::AccessFlags),
) {
    let barrier = |buffer: &Buffer| {
        vk::BufferMemoryBarrier::default()
            .src_access_mask(written)
            .dst_access_mask(read)
            .src_queue_family_index(from)
            .dst_queue_family_index(to)
            .buffer(buffer.raw())
            .size(vk::WHOLE_SIZE)
    };
    let barriers: Vec<_> = bound.buffers().iter().map(barrier).collect();
    // SAFETY: this function's contract.
    unsafe {
        device.cmd_pipeline_barrier(
            cmd,
            before,
            after,
            vk::DependencyFlags::empty(),
            &[],
            &barriers,
            &[],
        );
    }
}
