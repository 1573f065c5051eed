//! Recording: upload, preparation of a frame, draws, and reading back what was counted.

use ash::vk;
use gpu_allocator::vulkan::Allocator;

use crate::abi;
use crate::gpu::backend::Backend;
use crate::gpu::batches::{Batch, Cut};
use crate::gpu::layout::STAGES;
use crate::gpu::options::Slots;
use crate::gpu::ring::{RING_ACCESS, cmd_ring_barrier};
use crate::gpu::surface::TessellatedSurface;
use crate::gpu::workaround::patches_per_instance;
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
    /// From model space, relative to the model's centre, to Vulkan's clip space; column by column.
    pub clip_from_model: [[f32; 4]; 4],
    /// The eye in model space.
    pub eye: [f32; 3],
    /// One of `abi::SHADING_...`.
    pub shading: u32,
    /// A displacement along the normal. Where the limit has several normals, on infinite creases and at cusps, points stay.
    pub displacement: Displacement,
}

/// Some patches, the same number in each instance.
#[derive(Clone, Copy, Debug, Default)]
struct Draw {
    first: u32,
    patches_per_instance: u32,
    instances: u32,
    /// Where patterns are drawn, the segments of an edge of their lattice.
    segments: u32,
}

impl TessellatedSurface {
    /// Records the copy of everything to the device, after what earlier commands of the queue still draw, and before whatever draws next.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this surface, outside of a render pass. The surface lives until the commands have been
    /// executed, and neither [`finish_upload`](Self::finish_upload) nor [`write_positions`](Self::write_positions) is called before.
    pub unsafe fn cmd_upload(&self, device: &ash::Device, cmd: vk::CommandBuffer) {
        let Some((staging, copies)) = self.buffers.uploads() else {
            return;
        };
        let stages = vk::PipelineStageFlags::VERTEX_SHADER
            | self.options.backend.stages()
            | vk::PipelineStageFlags::FRAGMENT_SHADER
            | vk::PipelineStageFlags::COMPUTE_SHADER;
        let transfer = vk::PipelineStageFlags::TRANSFER;
        // SAFETY: this function's contract.
        unsafe {
            cmd_make_visible(
                device,
                cmd,
                stages | transfer,
                transfer,
                vk::AccessFlags::TRANSFER_WRITE,
            )
        };
        for (buffer, copy) in copies {
            // SAFETY: the copies were made with the buffers' sizes.
            unsafe { device.cmd_copy_buffer(cmd, staging, buffer, &[copy]) };
        }
        // SAFETY: this function's contract.
        unsafe { cmd_make_visible(device, cmd, transfer, stages, vk::AccessFlags::SHADER_READ) };
    }

    /// Gives the staging memory back. Positions cannot be replaced after this.
    ///
    /// # Safety
    /// `device` and `allocator` made this surface, and the upload has been executed.
    pub unsafe fn finish_upload(&mut self, device: &ash::Device, allocator: &mut Allocator) {
        if let Some(staging) = self.buffers.take_staging() {
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
        let stages = self.options.backend.stages();
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
    /// # Safety
    /// `cmd` is recording on `device`, which made this surface, after [`cmd_upload`](Self::cmd_upload) and
    /// [`cmd_prepare`](Self::cmd_prepare) (of this frame), inside subpass 0 of a render pass that is compatible with that of `pipelines`
    /// and whose subpass declares [`ring_dependency`](super::ring::ring_dependency), or, without
    /// [`barriers`](super::SurfaceOptions::barriers), inside any rendering that suits `pipelines`. Viewport and scissor are set.
    /// `pipelines` were built for this surface's [`Prepared`](crate::method::Prepared) and the spacing of `cut`, `layout` is the one that
    /// made them and the surface. `batch` is one of [`batches`](Self::batches) for `cut`, with a level of at most
    /// [`greatest_level`](super::SurfaceOptions::greatest_level), or its [`again`](Self::again); each is recorded at most once after
    /// `cmd_prepare`, in their order. [`write_draws`](Self::write_draws) was called for them where it is needed. Surface, pipelines
    /// and layout live until the commands have been executed.
    #[allow(clippy::too_many_arguments)]
    pub unsafe fn cmd_draw(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &Pipelines,
        view: &View,
        cut: Cut,
        batch: &Batch,
    ) {
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        let sets = [self.sets[batch.pass]];
        // SAFETY: this function's contract.
        unsafe {
            device.cmd_bind_pipeline(cmd, graphics, pipelines.get(batch.pass));
            device.cmd_bind_descriptor_sets(cmd, graphics, layout.pipeline(), 0, &sets, &[]);
        }
        match self.options.backend {
            // SAFETY: this function's contract.
            Backend::Tessellator => unsafe {
                self.cmd_draw_patches(device, cmd, layout, view, cut, batch)
            },
            // SAFETY: as above.
            Backend::Pattern => unsafe {
                self.cmd_draw_patterns(device, cmd, layout, view, cut, batch)
            },
            Backend::Geometry => {
                let count = batch.end - batch.first;
                let draw = Draw {
                    first: batch.first,
                    patches_per_instance: count,
                    instances: 1,
                    ..Draw::default()
                };
                let frame = self.frame(view, cut, batch, draw);
                // SAFETY: as above.
                unsafe {
                    cmd_push(device, cmd, layout, &frame);
                    device.cmd_draw(cmd, count, 1, 0, 0);
                }
            }
        }
    }

    /// # Safety
    /// As [`cmd_draw`](Self::cmd_draw), with pipeline and set bound.
    unsafe fn cmd_draw_patches(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        view: &View,
        cut: Cut,
        batch: &Batch,
    ) {
        // The first draw of all finds the ring free; every other one waits for the one before. Two draws of a batch have slots apart, but
        // synchronization is a matter of whole buffers.
        let mut waits = batch.ring_batch > 0;
        for draw in self.draws(cut, batch) {
            if waits && batch.points > 0 && self.options.barriers {
                // SAFETY: this function's contract.
                unsafe { cmd_ring_barrier(device, cmd) };
            }
            waits = true;
            let frame = self.frame(view, cut, batch, draw);
            let control_points = self.prepared.passes[batch.pass].control_points;
            let vertices = draw.patches_per_instance * control_points;
            // SAFETY: this function's contract.
            unsafe {
                cmd_push(device, cmd, layout, &frame);
                device.cmd_draw(cmd, vertices, draw.instances, 0, 0);
            }
        }
    }

    /// An instance a patch, those with the same pattern in one draw.
    ///
    /// # Safety
    /// As [`cmd_draw`](Self::cmd_draw), with pipeline and set bound.
    unsafe fn cmd_draw_patterns(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        view: &View,
        cut: Cut,
        batch: &Batch,
    ) {
        let Some((indices, draws)) = self.patterns.draws(batch) else {
            return;
        };
        // SAFETY: this function's contract.
        unsafe { device.cmd_bind_index_buffer(cmd, indices, 0, vk::IndexType::UINT16) };
        for draw in draws {
            let segments = draw.segments;
            let of_pattern = Draw {
                segments,
                ..Draw::default()
            };
            let frame = self.frame(view, cut, batch, of_pattern);
            let (count, instances) = (draw.indices.len() as u32, draw.instances.len() as u32);
            let (first, first_instance) = (draw.indices.start, draw.instances.start);
            // SAFETY: this function's contract.
            unsafe {
                cmd_push(device, cmd, layout, &frame);
                device.cmd_draw_indexed(cmd, count, instances, first, 0, first_instance);
            }
        }
    }

    /// The draws of a batch: full instances, and one of what is left, so that no patch is drawn that is none.
    fn draws(&self, cut: Cut, batch: &Batch) -> impl Iterator<Item = Draw> + use<> {
        let count = batch.end - batch.first;
        let per_instance = self
            .patches_per_instance(cut, batch)
            .unwrap_or(count)
            .min(count);
        let (instances, rest) = (count / per_instance, count % per_instance);
        let full = Draw {
            first: batch.first,
            patches_per_instance: per_instance,
            instances,
            ..Draw::default()
        };
        let last = Draw {
            first: batch.end - rest,
            patches_per_instance: rest,
            instances: 1,
            ..Draw::default()
        };
        [full, last]
            .into_iter()
            .filter(|draw| draw.patches_per_instance > 0)
    }

    /// How many patches an instance may hold on this driver; None where nothing bounds it.
    fn patches_per_instance(&self, cut: Cut, batch: &Batch) -> Option<u32> {
        let pass = &self.prepared.passes[batch.pass];
        let greatest =
            (batch.first..batch.end).map(|patch| cut.levels(pass, patch as usize).greatest());
        let segments = cut.spacing.segments(greatest.fold(1.0, f32::max));
        patches_per_instance(&self.workarounds, segments)
    }

    fn frame(&self, view: &View, cut: Cut, batch: &Batch, draw: Draw) -> abi::Frame {
        let flag = |on: bool, flag: u32| if on { flag } else { 0 };
        let cut = self.options.backend.cut(cut);
        abi::Frame {
            view_projection: view.clip_from_model,
            eye: view.eye,
            shading: view.shading,
            // As the CPU has it, whatever the pass: control shaders compute the points that this level needs.
            level: cut
                .spacing
                .clamp(cut.level, self.prepared.passes[batch.pass].max_level),
            flags: flag(
                cut.spacing == Spacing::FractionalEven,
                abi::FRAME_FRACTIONAL_EVEN,
            ) | flag(self.options.slots == Slots::Host, abi::FRAME_HOST_SLOTS)
                | flag(self.options.capture_vertices > 0, abi::FRAME_CAPTURE)
                | flag(self.options.amplify_cracks, abi::FRAME_PARITY)
                | flag(!self.tagged.is_empty(), abi::FRAME_ADAPTIVE)
                | flag(self.options.count_vertices, abi::FRAME_COUNT),
            first_patch: draw.first,
            end_patch: batch.end,
            patches_per_instance: draw.patches_per_instance,
            ring_points: (self.options.ring_bytes / 16).min(u64::from(u32::MAX / 2)) as u32,
            counter: abi::COUNTER_BATCHES + batch.ring_batch,
            capture_vertices: self.options.capture_vertices,
            segments: draw.segments,
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
        let stages = self.options.backend.stages();
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
    pub fn counters(&self) -> Counters {
        let counted: &[u32] = bytemuck::cast_slice(self.buffers.counted().bytes());
        Counters {
            overflows: counted[abi::COUNTER_OVERFLOWS as usize],
            points: counted[abi::COUNTER_POINTS as usize],
        }
    }

    /// What was captured since [`cmd_prepare`](Self::cmd_prepare), in no order, and possibly some vertices more than once. Meaningful
    /// when [`cmd_read_back`](Self::cmd_read_back) has been executed.
    pub fn captured(&self) -> &[abi::Captured] {
        let (count, captured) = self.buffers.capture().bytes().split_at(4);
        let count = bytemuck::pod_read_unaligned::<u32>(count).min(self.options.capture_vertices);
        &bytemuck::cast_slice(captured)[..count as usize]
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
