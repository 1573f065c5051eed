//! Recording the draws of a batch.

use std::ops::Range;

use ash::vk;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Batch, Decides, Draw, DrawList};
use crate::gpu::ring::cmd_ring_barrier;
use crate::gpu::sets::STAGES;
use crate::gpu::{FrameSlot, Layout, OwnLayout, Pipelines, Pose, Tables};
use crate::tessellation::Spacing;

/// What is drawn, in which pose, and with which slot: all that a batch's draws are bound to.
///
/// Any number of poses shares tables, and any number of frames in flight has a slot each.
#[derive(Clone, Copy, Debug)]
pub struct Drawing<'a> {
    /// What a method made of the topology.
    pub tables: &'a Tables,
    /// Where its vertices are.
    pub pose: &'a Pose,
    /// What the frame writes.
    pub slot: &'a FrameSlot,
    /// The engine's own sets, bound behind ours, from 3 on if these begin with 0; for pipelines with a layout of the engine's own.
    pub sets: &'a [vk::DescriptorSet],
}

impl Drawing<'_> {
    /// Records the draw of a batch, seen with each of a range of the views that [`cmd_prepare`](FrameSlot::cmd_prepare) was given, from 0: rigid instances
    /// of a pose are views of it, and all of them are one draw (one a refinement pattern, where patterns are drawn). No views, no draw. A batch that
    /// uses the ring takes one view at a time, each in a [round](super::DrawList::round) of its own, and waits for the evaluation shaders of the batch
    /// before it.
    ///
    /// Fragment shaders are told patch and view in one number (`drawn_patch` and `drawn_view` in `glsl/lib/interface.glsl`).
    ///
    /// Binds a pipeline and sets 0 to 2 (or where the pipelines' [`OwnLayout`] has them), [`sets`](Self::sets) behind these, and pushes constants from offset 0: an engine binds its own again
    /// afterwards.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`], [`Misuse::NotWritten`], [`Misuse::NotDecided`],
    /// [`Misuse::View`], [`Misuse::ViewsInRing`],
    /// [`Misuse::ManyViews`], [`Misuse::Eyes`], [`Misuse::NotCached`], [`Misuse::OtherPipelines`], [`Misuse::SubPatchPipelines`], [`Misuse::BarrierInRendering`] and
    /// [`Misuse::OwnSets`]; nothing has been recorded then.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made all of this, a primary or a secondary command buffer, after `cmd_upload` of tables and pose and
    /// [`cmd_prepare`](FrameSlot::cmd_prepare) (of this frame), inside rendering that suits `pipelines`: dynamic, or the subpass of a render
    /// pass that is compatible with theirs. Where batches wait for one another, and record the barriers for it
    /// ([`barriers`](super::SurfaceOptions::barriers)), that subpass declares [`ring_dependency`](super::ring::ring_dependency). Viewport and scissor are set. `layout` is the
    /// one that made `pipelines` and all of this. Each batch of each [round](super::DrawList::round) is recorded at most once after
    /// `cmd_prepare`, in their order. Everything lives until the commands have been executed.
    pub unsafe fn cmd_draw(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &Pipelines,
        views: Range<u32>,
        batch: Batch<'_>,
    ) -> Result<()> {
        let pipeline = self.check(pipelines, &views, batch)?;
        if views.is_empty() {
            return Ok(());
        }
        let instances = views.len() as u32 / pipelines.eyes();
        let constants = Constants {
            layout: pipelines.layout_or(layout),
            eyes: pipelines.eyes(),
        };
        // SAFETY: this function's contract.
        unsafe { self.cmd_bind(device, cmd, constants.layout, pipeline, batch) };
        for draw in batch.draws() {
            let frame = self.frame(constants.eyes, views.start, batch, draw);
            // SAFETY: as above; the list's patterns are those that were written last.
            unsafe {
                match *draw {
                    Draw::Decided { batch: number } => {
                        let commands = self.decided_commands(layout, batch, number, &views);
                        commands.cmd_draw(device, cmd, constants, frame);
                    }
                    _ => {
                        constants.cmd_push(device, cmd, &frame);
                        self.cmd_draw_one(device, cmd, instances, batch, draw);
                    }
                }
            }
        }
        Ok(())
    }

    /// The pipeline of a batch, if it may be drawn with these views now.
    ///
    /// # Errors
    /// As [`cmd_draw`](Self::cmd_draw).
    pub(super) fn check(
        &self,
        pipelines: &Pipelines,
        views: &Range<u32>,
        batch: Batch<'_>,
    ) -> Result<vk::Pipeline> {
        let Drawing {
            tables, pose, slot, ..
        } = *self;
        pose.check(tables)?;
        slot.check_list(tables, batch.list())?;
        slot.check_views(views, batch)?;
        slot.check_decided(views, batch.list())?;
        pose.check_cached(tables, batch.list())?;
        let (count, eyes) = (views.len() as u32, pipelines.eyes());
        if count % eyes != 0 {
            let views = count;
            return Err(Error::Misuse(Misuse::Eyes { views, eyes }));
        }
        if pipelines.are_dynamic() && batch.waits() && slot.options().barriers {
            return Err(Error::Misuse(Misuse::BarrierInRendering));
        }
        if !self.sets.is_empty() && pipelines.layout().is_none() {
            return Err(Error::Misuse(Misuse::OwnSets));
        }
        pipelines.for_pass(tables.prepared(), batch.list(), batch.pass())
    }

    /// # Safety
    /// As [`cmd_draw`](Self::cmd_draw); the layout is the pipeline's.
    pub(super) unsafe fn cmd_bind(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: OwnLayout,
        pipeline: vk::Pipeline,
        batch: Batch<'_>,
    ) {
        let (slot, pass) = (self.slot, batch.pass());
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        let ours = [self.tables.set(pass), self.pose.set(), slot.set(pass)];
        let sets = [&ours, self.sets].concat();
        // SAFETY: this function's contract.
        unsafe {
            if batch.waits() && slot.options().barriers {
                cmd_ring_barrier(device, cmd);
            }
            device.cmd_bind_pipeline(cmd, graphics, pipeline);
            let first = layout.first_set;
            device.cmd_bind_descriptor_sets(cmd, graphics, layout.raw, first, &sets, &[]);
            if let Some(indices) = slot.patterns().buffer() {
                device.cmd_bind_index_buffer(cmd, indices, 0, vk::IndexType::UINT16);
            }
        }
    }

    /// Whether the pose has all control points that a list is drawn with, so that [`cmd_cache`](Pose::cmd_cache) would record nothing; true where the
    /// ring has them.
    pub fn is_cached(&self, list: &DrawList) -> bool {
        self.pose.check_cached(self.tables, list).is_ok()
    }

    /// # Safety
    /// As [`cmd_draw`](Self::cmd_draw), with pipeline, sets and indices bound, and the draw's constants pushed.
    unsafe fn cmd_draw_one(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        repeated: u32,
        batch: Batch<'_>,
        draw: &Draw,
    ) {
        match *draw {
            Draw::Patches {
                per_instance,
                instances,
                ..
            } => {
                let pass = &self.tables.prepared().passes[batch.pass()];
                let vertices = self.slot.vertices_of(pass, per_instance);
                // SAFETY: this function's contract.
                unsafe { device.cmd_draw(cmd, vertices, instances * repeated, 0, 0) };
            }
            Draw::Pattern {
                pattern, instances, ..
            } => {
                let indices = self.slot.patterns().place(pattern);
                let (count, first) = (indices.len() as u32, indices.start);
                // SAFETY: this function's contract.
                unsafe { device.cmd_draw_indexed(cmd, count, instances * repeated, first, 0, 0) };
            }
            // Its commands are on the device.
            Draw::Decided { .. } => {}
        }
    }

    /// The constants of a draw of a batch.
    pub(super) fn frame(&self, eyes: u32, view: u32, batch: Batch<'_>, draw: &Draw) -> abi::Frame {
        let flag = |on: bool, flag: u32| if on { flag } else { 0 };
        let (prepared, cut) = (self.tables.prepared(), batch.list().cut());
        let max_level = prepared.passes[batch.pass()].max_level;
        let fractional_even = cut.spacing == Spacing::FractionalEven;
        let (first, per_instance, instances, segments) = match *draw {
            Draw::Patches {
                first,
                per_instance,
                instances,
            } => (first, per_instance, instances, 0),
            Draw::Pattern {
                first_instance,
                instances,
                segments,
                ..
            } => (first_instance, 1, instances, segments),
            Draw::Decided { batch: number } => {
                let lists = &self.slot.lists()[batch.pass()];
                // No view has more instances than patches.
                (
                    lists.batch(0, number),
                    lists.view_words(),
                    lists.patches(),
                    0,
                )
            }
        };
        let counter = match *draw {
            Draw::Decided { .. } => self.slot.lists()[batch.pass()].list(0),
            _ => abi::COUNTER_BATCHES + batch.ring_batch(),
        };
        abi::Frame {
            // As the CPU has it, whatever the pass: control shaders compute the points that this level needs.
            level: cut.spacing.clamp(cut.level, max_level),
            flags: self.slot.flags()
                | flag(fractional_even, abi::FRAME_FRACTIONAL_EVEN)
                | flag(batch.list().is_tagged(), abi::FRAME_ADAPTIVE)
                | flag(batch.list().has_sub_patches(), abi::FRAME_SUB_PATCHES)
                | flag(
                    self.slot.options().decides == Decides::Device,
                    abi::FRAME_DECIDED,
                )
                | segments << abi::FRAME_SEGMENTS_SHIFT
                | eyes << abi::FRAME_EYES_SHIFT,
            first_patch: first,
            end_patch: batch.drawn().end,
            patches_per_instance: per_instance,
            counter,
            instances,
            view,
        }
    }
}

/// How the constants of draws are pushed.
#[derive(Clone, Copy)]
pub(super) struct Constants {
    /// The pipelines' layout.
    pub layout: OwnLayout,
    /// Views an instance.
    pub eyes: u32,
}

impl Constants {
    /// # Safety
    /// `cmd` is recording on `device`, which made the layout.
    pub unsafe fn cmd_push(self, device: &ash::Device, cmd: vk::CommandBuffer, frame: &abi::Frame) {
        let constants = bytemuck::bytes_of(frame);
        // SAFETY: this function's contract.
        unsafe { device.cmd_push_constants(cmd, self.layout.raw, STAGES, 0, constants) };
    }
}
