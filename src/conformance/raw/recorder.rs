//! Commands over the buffers and pipelines of [`Raw`].

use ash::{ext, vk};

use super::{Raw, STAGES};
use crate::error::Result;
use crate::gpu::failed;
use crate::gpu::ring::cmd_ring_barrier;
use crate::host::{Device, StorageSet};

/// An event of a device.
pub struct Event<'a> {
    device: &'a Device,
    raw: vk::Event,
}

impl<'a> Event<'a> {
    /// One that is not set.
    pub fn new(device: &'a Device) -> Result<Event<'a>> {
        let info = vk::EventCreateInfo::default();
        // SAFETY: the device is live.
        let raw = unsafe { device.raw().create_event(&info, None) };
        let raw = raw.map_err(failed("vkCreateEvent"))?;
        Ok(Event { device, raw })
    }
}

impl Drop for Event<'_> {
    fn drop(&mut self) {
        if !self.device.is_hung() {
            // SAFETY: each submission was waited for.
            unsafe { self.device.raw().destroy_event(self.raw, None) };
        }
    }
}

/// Stages, and accesses of theirs, on one side of a memory dependency.
pub type Scope = (vk::PipelineStageFlags, vk::AccessFlags);

fn memory_barrier(from: Scope, to: Scope) -> vk::MemoryBarrier<'static> {
    vk::MemoryBarrier::default()
        .src_access_mask(from.1)
        .dst_access_mask(to.1)
}

/// The same as a dependency of Vulkan 1.3, whose first bits are the older ones'.
fn memory_barrier2(from: Scope, to: Scope) -> vk::MemoryBarrier2<'static> {
    let stages = |scope: Scope| vk::PipelineStageFlags2::from_raw(scope.0.as_raw().into());
    let accesses = |scope: Scope| vk::AccessFlags2::from_raw(scope.1.as_raw().into());
    vk::MemoryBarrier2::default()
        .src_stage_mask(stages(from))
        .src_access_mask(accesses(from))
        .dst_stage_mask(stages(to))
        .dst_access_mask(accesses(to))
}

/// Records draws inside of the render pass. Draws of one submission that write the same memory need a [`barrier`](Self::barrier) between
/// them.
pub struct Recorder<'a> {
    pub(super) device: &'a ash::Device,
    pub(super) raw: &'a Raw<'a>,
    pub(super) cmd: vk::CommandBuffer,
}

impl Recorder<'_> {
    /// Binds a pipeline with all buffers, and sets the push constants.
    pub fn bind<T: bytemuck::NoUninit>(&self, pipeline: vk::Pipeline, constants: &T) {
        self.bind_to(vk::PipelineBindPoint::GRAPHICS, pipeline, constants);
    }

    fn bind_to<T: bytemuck::NoUninit>(
        &self,
        point: vk::PipelineBindPoint,
        pipeline: vk::Pipeline,
        constants: &T,
    ) {
        // SAFETY: recording where the pipeline may be bound; all of one device.
        unsafe { self.device.cmd_bind_pipeline(self.cmd, point, pipeline) };
        self.bind_buffers(point, constants);
    }

    /// Sets the push constants, of all stages, and binds nothing.
    pub fn push<T: bytemuck::NoUninit>(&self, constants: &T) {
        let bytes = bytemuck::bytes_of(constants);
        // SAFETY: recording on the device of the layout, which has room for the constants of all of the suite's shaders.
        unsafe {
            self.device
                .cmd_push_constants(self.cmd, self.raw.layout, STAGES, 0, bytes)
        };
    }

    /// Binds all buffers, and sets the push constants.
    pub(super) fn bind_buffers<T: bytemuck::NoUninit>(
        &self,
        point: vk::PipelineBindPoint,
        constants: &T,
    ) {
        let layout = self.raw.layout;
        let sets = self.raw.set.as_slice();
        let sets: Vec<vk::DescriptorSet> = sets.iter().map(StorageSet::raw).collect();
        // SAFETY: recording on the device of all of them.
        unsafe {
            self.device
                .cmd_bind_descriptor_sets(self.cmd, point, layout, 0, &sets, &[])
        };
        self.push(constants);
    }

    /// Says of how many control points patches are, for pipelines that leave it to draws.
    pub fn patch_size(&self, points: u32) {
        let instance = self.raw.device.instance().raw();
        let functions = ext::extended_dynamic_state2::Device::new(instance, self.device);
        // SAFETY: the device has the feature if it has pipelines that need it; the caller's number is one that devices have.
        unsafe { functions.cmd_set_patch_control_points(self.cmd, points) };
    }

    /// A draw without indices.
    pub fn draw(&self, vertices: u32, instances: u32, first_vertex: u32, first_instance: u32) {
        // SAFETY: a pipeline is bound; nothing is fetched but by the vertex's number.
        unsafe {
            self.device
                .cmd_draw(self.cmd, vertices, instances, first_vertex, first_instance)
        };
    }

    /// A draw with the 32-bit indices in a buffer.
    pub fn draw_indexed(&self, binding: usize, indices: u32, instances: u32, offset: i32) {
        self.bind_indices(binding, vk::IndexType::UINT32);
        // SAFETY: a pipeline and indices are bound, and the caller's buffer holds so many.
        unsafe {
            self.device
                .cmd_draw_indexed(self.cmd, indices, instances, 0, offset, 0)
        };
    }

    /// A draw whose arguments are the first words of a buffer.
    pub fn draw_indirect(&self, arguments: usize) {
        let buffer = self.raw.buffer(arguments);
        let stride = size_of::<vk::DrawIndirectCommand>() as u32;
        // SAFETY: a pipeline is bound; the host wrote the arguments before the submission.
        unsafe {
            self.device
                .cmd_draw_indirect(self.cmd, buffer, 0, 1, stride)
        };
    }

    /// A draw with indices whose arguments are the first words of a buffer.
    pub fn draw_indexed_indirect(&self, binding: usize, arguments: usize) {
        self.bind_indices(binding, vk::IndexType::UINT32);
        let buffer = self.raw.buffer(arguments);
        let stride = size_of::<vk::DrawIndexedIndirectCommand>() as u32;
        // SAFETY: as above, and indices are bound.
        unsafe {
            self.device
                .cmd_draw_indexed_indirect(self.cmd, buffer, 0, 1, stride)
        };
    }

    /// Binds the indices in a buffer, for draws that do not do so themselves.
    pub fn bind_indices(&self, binding: usize, kind: vk::IndexType) {
        let buffer = self.raw.buffer(binding);
        // SAFETY: the buffer was made to hold indices.
        unsafe { self.device.cmd_bind_index_buffer(self.cmd, buffer, 0, kind) };
    }

    /// A draw with the indices that are bound.
    pub fn draw_bound(&self, arguments: vk::DrawIndexedIndirectCommand) {
        // SAFETY: a pipeline and indices are bound, and the caller's buffer holds so many.
        unsafe {
            self.device.cmd_draw_indexed(
                self.cmd,
                arguments.index_count,
                arguments.instance_count,
                arguments.first_index,
                arguments.vertex_offset,
                arguments.first_instance,
            );
        }
    }

    /// Draws whose arguments stand one behind the other in a buffer, from a byte on, with the indices that are bound or without. Several need
    /// `multiDrawIndirect`.
    pub fn draw_several(&self, indexed: bool, arguments: usize, from: u64, count: u32) {
        let (device, buffer) = (self.device, self.raw.buffer(arguments));
        // SAFETY: a pipeline is bound; the host wrote the arguments before the submission.
        unsafe {
            if indexed {
                let stride = size_of::<vk::DrawIndexedIndirectCommand>() as u32;
                device.cmd_draw_indexed_indirect(self.cmd, buffer, from, count, stride);
            } else {
                let stride = size_of::<vk::DrawIndirectCommand>() as u32;
                device.cmd_draw_indirect(self.cmd, buffer, from, count, stride);
            }
        }
    }

    /// The same with how many there are, `most` at most, in a word of another buffer. The device has `drawIndirectCount`.
    pub fn draw_counted(
        &self,
        indexed: bool,
        [arguments, counts]: [usize; 2],
        [from, count_from]: [u64; 2],
        most: u32,
    ) {
        let (device, cmd) = (self.device, self.cmd);
        let (buffer, counts) = (self.raw.buffer(arguments), self.raw.buffer(counts));
        // SAFETY: as above, of `most` commands.
        unsafe {
            if indexed {
                let stride = size_of::<vk::DrawIndexedIndirectCommand>() as u32;
                device.cmd_draw_indexed_indirect_count(
                    cmd, buffer, from, counts, count_from, most, stride,
                );
            } else {
                let stride = size_of::<vk::DrawIndirectCommand>() as u32;
                device.cmd_draw_indirect_count(cmd, buffer, from, counts, count_from, most, stride);
            }
        }
    }

    fn multi_draw(&self) -> ext::multi_draw::Device {
        ext::multi_draw::Device::new(self.raw.device.instance().raw(), self.device)
    }

    /// Draws several ranges in a call. The device has `multiDraw`.
    pub fn draw_multi(&self, ranges: &[vk::MultiDrawInfoEXT], instances: u32, first: u32) {
        let draw = self.multi_draw().fp().cmd_draw_multi_ext;
        let (count, stride) = (ranges.len() as u32, size_of_val(&ranges[..1]) as u32);
        // SAFETY: a pipeline is bound; nothing is fetched but by the vertex's number; the device has the function.
        unsafe { draw(self.cmd, count, ranges.as_ptr(), instances, first, stride) };
    }

    /// The same with the indices that are bound.
    pub fn draw_multi_bound(
        &self,
        ranges: &[vk::MultiDrawIndexedInfoEXT],
        instances: u32,
        first: u32,
    ) {
        let draw = self.multi_draw().fp().cmd_draw_multi_indexed_ext;
        let (count, stride) = (ranges.len() as u32, size_of_val(&ranges[..1]) as u32);
        let own_offsets = std::ptr::null();
        // SAFETY: as above, and the caller's buffer holds so many indices.
        unsafe {
            draw(
                self.cmd,
                count,
                ranges.as_ptr(),
                instances,
                first,
                stride,
                own_offsets,
            );
        }
    }

    /// Binds a compute pipeline with all buffers, and sets the push constants.
    pub fn bind_compute<T: bytemuck::NoUninit>(&self, pipeline: vk::Pipeline, constants: &T) {
        self.bind_to(vk::PipelineBindPoint::COMPUTE, pipeline, constants);
    }

    /// Runs so many groups of the compute shader, outside of a pass.
    pub fn dispatch(&self, groups: u32) {
        // SAFETY: a compute pipeline with its buffers is bound.
        unsafe { self.device.cmd_dispatch(self.cmd, groups, 1, 1) };
    }

    /// A memory barrier, outside of a pass.
    pub fn memory_barrier(&self, from: Scope, to: Scope) {
        let barrier = [memory_barrier(from, to)];
        let none = vk::DependencyFlags::empty();
        // SAFETY: recording outside of a pass; stages and accesses fit each other.
        unsafe {
            self.device
                .cmd_pipeline_barrier(self.cmd, from.0, to.0, none, &barrier, &[], &[]);
        }
    }

    /// A barrier for a buffer, outside of a pass.
    pub fn buffer_barrier(&self, binding: usize, from: Scope, to: Scope) {
        let barrier = [vk::BufferMemoryBarrier::default()
            .src_access_mask(from.1)
            .dst_access_mask(to.1)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .buffer(self.raw.buffer(binding))
            .size(vk::WHOLE_SIZE)];
        let none = vk::DependencyFlags::empty();
        // SAFETY: as above; the buffer is of this device.
        unsafe {
            self.device
                .cmd_pipeline_barrier(self.cmd, from.0, to.0, none, &[], &barrier, &[]);
        }
    }

    /// Sets an event behind a stage and waits for it, outside of a pass. Each event serves once.
    pub fn event(&self, event: &Event<'_>, from: Scope, to: Scope) {
        let barrier = [memory_barrier(from, to)];
        // SAFETY: as above; the caller's event lives until the commands are done, and was not set before.
        unsafe {
            self.device.cmd_set_event(self.cmd, event.raw, from.0);
            self.device
                .cmd_wait_events(self.cmd, &[event.raw], from.0, to.0, &barrier, &[], &[]);
        }
    }

    /// A memory barrier as Vulkan 1.3 has it, outside of a pass. The device has `synchronization2`.
    pub fn memory_barrier2(&self, from: Scope, to: Scope) {
        let barrier = [memory_barrier2(from, to)];
        let info = vk::DependencyInfo::default().memory_barriers(&barrier);
        // SAFETY: as above, and the caller's device has the feature.
        unsafe { self.device.cmd_pipeline_barrier2(self.cmd, &info) };
    }

    /// An event as Vulkan 1.3 has it, likewise: what it orders is said when it is set, and when it is waited for.
    pub fn event2(&self, event: &Event<'_>, from: Scope, to: Scope) {
        let barrier = [memory_barrier2(from, to)];
        let info = [vk::DependencyInfo::default().memory_barriers(&barrier)];
        // SAFETY: as above; the event serves once.
        unsafe {
            self.device.cmd_set_event2(self.cmd, event.raw, &info[0]);
            self.device.cmd_wait_events2(self.cmd, &[event.raw], &info);
        }
    }

    /// Lets the next draw use the memory of the one before.
    pub fn barrier(&self) {
        // SAFETY: inside of a pass that was made with the dependency for it.
        unsafe { cmd_ring_barrier(self.device, self.cmd) };
    }
}
