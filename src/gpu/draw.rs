//! Recording: upload, preparation of a frame, draws, and reading back what was counted.

use ash::vk;
use gpu_allocator::vulkan::Allocator;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Backend, Batch, Draw, Slots};
use crate::gpu::buffers::NOT_READ_BACK;
use crate::gpu::layout::STAGES;
use crate::gpu::ring::{RING_ACCESS, cmd_ring_barrier, stages};
use crate::gpu::surface::TessellatedSurface;
use crate::gpu::{Layout, Pipelines};
use crate::method::Displacement;
use crate::tessellation::Spacing;

/// What the control shaders counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Patches that found no room in the ring and were left out: the picture is not whole, draw again with [`Slots::Host`].
    pub overflows: u32,
    /// Points computed.
    pub points: u32,
}

/// What a frame is drawn with, the same for all of its batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From the local units of the model's [`Placement`](crate::mesh::Placement) to Vulkan's clip space; column by column.
    pub clip_from_model: [[f32; 4]; 4],
    /// The eye in local units.
    pub eye: [f32; 3],
    /// A displacement along the normal. Where the limit has several normals, on infinite creases and at cusps, points stay.
    pub displacement: Displacement,
}

impl TessellatedSurface {
    /// Records the copy of what has changed to the device, after what earlier commands of the queue still draw, and before whatever draws next:
    /// the first time everything, after [`write_positions`](Self::write_positions) the control vertices and their points, else nothing.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this surface, outside of a render pass, and will be executed. The surface lives until then,
    /// and neither [`finish_upload`](Self::finish_upload) nor [`write_positions`](Self::write_positions) is called before.
    pub unsafe fn cmd_upload(&mut self, device: &ash::Device, cmd: vk::CommandBuffer) {
        let uploads = self.buffers.take_uploads();
        if uploads.is_empty() {
            return;
        }
        let readers = vk::PipelineStageFlags::VERTEX_SHADER
            | stages(self.options.backend)
            | vk::PipelineStageFlags::FRAGMENT_SHADER
            | vk::PipelineStageFlags::COMPUTE_SHADER;
        let transfer = vk::PipelineStageFlags::TRANSFER;
        // SAFETY: this function's contract.
        unsafe {
            cmd_make_visible(
                device,
                cmd,
                readers | transfer,
                transfer,
                vk::AccessFlags::TRANSFER_WRITE,
            )
        };
        for (from, to, copy) in uploads {
            // SAFETY: the copies were made with the buffers' sizes.
            unsafe { device.cmd_copy_buffer(cmd, from, to, &[copy]) };
        }
        // SAFETY: this function's contract.
        unsafe { cmd_make_visible(device, cmd, transfer, readers, vk::AccessFlags::SHADER_READ) };
    }

    /// Gives the memory back that the tables were staged in. Positions can still be replaced.
    ///
    /// # Safety
    /// `device` and `allocator` made this surface, and the upload has been executed.
    pub unsafe fn finish_upload(&mut self, device: &ash::Device, allocator: &mut Allocator) {
        if let Some(staging) = self.buffers.take_staged_tables() {
            // SAFETY: this function's contract.
            unsafe { staging.destroy(device, allocator) };
        }
    }

    /// Records what a frame needs before its render pass: counters at zero, and the ring free of earlier frames' use.
    ///
    /// It waits for the control and evaluation shaders (or whatever evaluates patches) of all earlier commands on the queue. Frames that shall overlap need a surface each.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this surface, outside of a render pass, and is submitted to the queue of the
    /// surface's earlier frames. The surface lives until the commands have been executed.
    pub unsafe fn cmd_prepare(&self, device: &ash::Device, cmd: vk::CommandBuffer) {
        let transfer = vk::PipelineStageFlags::TRANSFER;
        let stages = stages(self.options.backend);
        // SAFETY: this function's contract; vkCmdFillBuffer is not allowed inside a render pass, hence this function.
        unsafe {
            cmd_make_visible(
                device,
                cmd,
                stages | transfer,
                transfer,
                vk::AccessFlags::TRANSFER_WRITE,
            );
            device.cmd_fill_buffer(cmd, self.buffers.counters().raw(), 0, vk::WHOLE_SIZE, 0);
            device.cmd_fill_buffer(cmd, self.buffers.capture().raw(), 0, 4, 0);
            for counts in self.buffers.counts() {
                device.cmd_fill_buffer(cmd, counts.raw(), 0, vk::WHOLE_SIZE, 0);
            }
            cmd_make_visible(device, cmd, transfer | stages, stages, RING_ACCESS);
        }
    }

    /// Records the draw of a batch. A batch that uses the ring after another waits for that one's evaluation shaders.
    ///
    /// Binds a pipeline and set 0, and pushes constants from offset 0: an engine binds its own again afterwards.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`], [`Misuse::NotWritten`] and [`Misuse::OtherPipelines`]; nothing has been recorded then.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this surface, after [`cmd_upload`](Self::cmd_upload) and
    /// [`cmd_prepare`](Self::cmd_prepare) (of this frame), inside subpass 0 of a render pass that is compatible with that of `pipelines`
    /// and whose subpass declares [`ring_dependency`](super::ring::ring_dependency), or, without
    /// [`barriers`](super::SurfaceOptions::barriers), inside any rendering that suits `pipelines`. Viewport and scissor are set. `layout` is the
    /// one that made `pipelines` and the surface. Each batch of each [round](super::DrawList::round) is recorded at most once after
    /// `cmd_prepare`, in their order. Surface, pipelines and layout live until the commands have been executed.
    pub unsafe fn cmd_draw(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &Pipelines,
        view: &View,
        batch: Batch<'_>,
    ) -> Result<()> {
        self.check(batch.list())?;
        let pipeline = pipelines.for_pass(&self.prepared, batch.list(), batch.pass())?;
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        let sets = [self.sets[batch.pass()]];
        // SAFETY: this function's contract.
        unsafe {
            if batch.waits() && self.options.barriers {
                cmd_ring_barrier(device, cmd);
            }
            device.cmd_bind_pipeline(cmd, graphics, pipeline);
            device.cmd_bind_descriptor_sets(cmd, graphics, layout.pipeline(), 0, &sets, &[]);
            if let Some(indices) = self.patterns.buffer() {
                device.cmd_bind_index_buffer(cmd, indices, 0, vk::IndexType::UINT16);
            }
        }
        let mut frame = self.frame(view, batch);
        for draw in batch.draws() {
            // SAFETY: as above; the list's patterns are those that were written last.
            unsafe { self.cmd_draw_one(device, cmd, layout, &mut frame, batch, draw) };
        }
        Ok(())
    }

    /// # Safety
    /// As [`cmd_draw`](Self::cmd_draw), with pipeline, set and indices bound.
    unsafe fn cmd_draw_one(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        frame: &mut abi::Frame,
        batch: Batch<'_>,
        draw: &Draw,
    ) {
        match *draw {
            Draw::Patches {
                first,
                per_instance,
                instances,
            } => {
                (frame.first_patch, frame.patches_per_instance) = (first, per_instance);
                let vertices = match self.options.backend {
                    Backend::Geometry => per_instance,
                    _ => per_instance * self.prepared.passes[batch.pass()].control_points,
                };
                // SAFETY: this function's contract.
                unsafe {
                    cmd_push(device, cmd, layout, frame);
                    device.cmd_draw(cmd, vertices, instances, 0, 0);
                }
            }
            Draw::Pattern {
                pattern,
                first_instance,
                instances,
                segments,
            } => {
                frame.segments = segments;
                let indices = self.patterns.place(pattern);
                let count = indices.len() as u32;
                // SAFETY: this function's contract.
                unsafe {
                    cmd_push(device, cmd, layout, frame);
                    let first = indices.start;
                    device.cmd_draw_indexed(cmd, count, instances, first, 0, first_instance);
                }
            }
        }
    }

    /// The constants of a batch, its draws aside.
    fn frame(&self, view: &View, batch: Batch<'_>) -> abi::Frame {
        let flag = |on: bool, flag: u32| if on { flag } else { 0 };
        let (options, cut) = (&self.options, batch.list().cut());
        let max_level = self.prepared.passes[batch.pass()].max_level;
        abi::Frame {
            view_projection: view.clip_from_model,
            eye: view.eye,
            // As the CPU has it, whatever the pass: control shaders compute the points that this level needs.
            level: cut.spacing.clamp(cut.level, max_level),
            flags: flag(
                cut.spacing == Spacing::FractionalEven,
                abi::FRAME_FRACTIONAL_EVEN,
            ) | flag(options.slots == Slots::Host, abi::FRAME_HOST_SLOTS)
                | flag(options.capture_vertices > 0, abi::FRAME_CAPTURE)
                | flag(options.amplify_cracks, abi::FRAME_PARITY)
                | flag(batch.list().is_tagged(), abi::FRAME_ADAPTIVE)
                | flag(options.count_vertices, abi::FRAME_COUNT),
            first_patch: batch.patches().start,
            end_patch: batch.patches().end,
            patches_per_instance: 0,
            ring_points: options.ring_points(),
            counter: abi::COUNTER_BATCHES + batch.ring_batch(),
            capture_vertices: options.capture_vertices,
            segments: 0,
            displacement: [view.displacement.height, view.displacement.frequency],
        }
    }

    /// Records the copy of what was counted and captured to where the host can read it.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this surface, outside of a render pass, after the draws. The surface lives until the
    /// commands have been executed.
    pub unsafe fn cmd_read_back(&self, device: &ash::Device, cmd: vk::CommandBuffer) {
        let copy = vk::BufferCopy::default().size(8);
        let (transfer, host) = (
            vk::PipelineStageFlags::TRANSFER,
            vk::PipelineStageFlags::HOST,
        );
        let stages = stages(self.options.backend);
        // SAFETY: this function's contract.
        unsafe {
            cmd_make_visible(
                device,
                cmd,
                stages,
                transfer,
                vk::AccessFlags::TRANSFER_READ,
            );
            device.cmd_copy_buffer(
                cmd,
                self.buffers.counters().raw(),
                self.buffers.counted().raw(),
                &[copy],
            );
            cmd_make_visible(
                device,
                cmd,
                transfer | stages,
                host,
                vk::AccessFlags::HOST_READ,
            );
        }
    }

    /// What was counted. Meaningful when [`cmd_read_back`](Self::cmd_read_back) has been executed.
    ///
    /// # Errors
    /// [`Misuse::NotReadBack`] as long as none has been.
    pub fn counters(&self) -> Result<Counters> {
        let counted: [u32; 2] = bytemuck::pod_read_unaligned(self.buffers.counted().bytes());
        if counted == NOT_READ_BACK {
            return Err(Error::Misuse(Misuse::NotReadBack));
        }
        Ok(Counters {
            overflows: counted[abi::COUNTER_OVERFLOWS as usize],
            points: counted[abi::COUNTER_POINTS as usize],
        })
    }

    /// What was captured since [`cmd_prepare`](Self::cmd_prepare), in no order, and possibly some vertices more than once. Meaningful
    /// when [`cmd_read_back`](Self::cmd_read_back) has been executed.
    ///
    /// # Errors
    /// [`Misuse::NotReadBack`] as long as none has been.
    pub fn captured(&self) -> Result<&[abi::Captured]> {
        self.counters()?;
        let (count, captured) = self.buffers.capture().bytes().split_at(4);
        let count = bytemuck::pod_read_unaligned::<u32>(count).min(self.options.capture_vertices);
        Ok(&bytemuck::cast_slice(captured)[..count as usize])
    }
}

/// # Safety
/// `cmd` is recording on `device`, which made `layout`.
unsafe fn cmd_push(
    device: &ash::Device,
    cmd: vk::CommandBuffer,
    layout: &Layout,
    frame: &abi::Frame,
) {
    let constants = bytemuck::bytes_of(frame);
    // SAFETY: this function's contract.
    unsafe { device.cmd_push_constants(cmd, layout.pipeline(), STAGES, 0, constants) };
}

/// A barrier from all writes of the stages `from` to `access` in the stages `to`.
///
/// # Safety
/// `cmd` is recording on `device`, outside of a render pass.
unsafe fn cmd_make_visible(
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
