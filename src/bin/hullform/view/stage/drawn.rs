//! How a frame draws one surface: its points, and its draws, once or with lines over them.

use std::ops::Range;
use std::sync::Arc;

use hullform::Result;
use hullform::ash::vk;
use hullform::gpu::{Decided, Decides, Decision, Pipelines, Residence, View, ring};
use hullform::host::Owned;
use hullform::method::{Editable, Update};

use super::Cost;
use super::scene::is_chosen;
use crate::view::context::{Context, Drawn, Growth};

/// Some of a list's batches.
pub(super) struct Batches<'a> {
    /// From which to which.
    pub range: Range<usize>,
    /// Which of these, where not all are.
    pub chosen: Option<&'a Arc<[bool]>>,
}

impl Drawn {
    /// The vertices of batches that are chosen.
    pub(super) fn vertices_of(&self, chosen: &[bool]) -> u64 {
        let batches = self.list.iter().flat_map(|list| list.batches());
        let chosen = batches.zip(chosen).filter(|(_, chosen)| **chosen);
        chosen.map(|(batch, _)| u64::from(batch.vertices())).sum()
    }

    /// Whether the device decides about its patches.
    pub fn is_decided_there(&self) -> bool {
        self.surface.options().decides == Decides::Device
    }

    /// Brings it up to an edit; the next frame records that. Nothing is drawn at this time.
    pub(super) fn edit(
        &mut self,
        editable: &Editable,
        update: &Update,
        context: &Context,
    ) -> Result<()> {
        let (device, layout) = (context.device(), context.layout());
        let memory = &mut device.memory();
        // SAFETY: all of it was made for this device; nothing that was submitted is still drawn, and what replaces tables is recorded before they are.
        unsafe {
            let raw = device.raw();
            let retired = self.surface.edit(raw, memory, layout, editable, update)?;
            if !retired.is_empty() {
                self.growth = Growth::Made;
                retired.destroy(raw, memory);
            }
        }
        self.list = None;
        Ok(())
    }

    /// Gives back what larger buffers were filled from, once they are. Nothing is drawn at this time.
    pub(super) fn finish(&mut self, context: &Context) {
        if self.growth != Growth::Recorded {
            return;
        }
        let device = context.device();
        // SAFETY: device and memory made the surface, and what was recorded is done.
        unsafe {
            let memory = &mut device.memory();
            self.surface.finish_upload(device.raw(), memory);
        }
        self.growth = Growth::Done;
    }

    /// Records what comes before rendering: how many control points are computed.
    ///
    /// # Safety
    /// `cmd` is recording on the device that made it, outside of a render pass.
    pub(super) unsafe fn cmd_prepare(
        &mut self,
        cmd: vk::CommandBuffer,
        context: &Context,
        views: &[View],
        decision: Option<&Decision>,
    ) -> Result<u64> {
        let (device, layout) = (context.device().raw(), context.layout());
        let mut points = 0;
        // SAFETY: this function's contract.
        unsafe {
            self.surface.cmd_upload(device, cmd);
            if self.growth == Growth::Made {
                self.growth = Growth::Recorded;
            }
            if let (Some(cache), Some(list)) = (&self.cache, &self.list) {
                points = self.surface.cmd_cache(device, cmd, layout, cache, list)?;
            }
            self.surface.cmd_prepare(device, cmd, views)?;
            let deciding = context.deciding().zip(decision).zip(self.list.as_ref());
            if let Some(((pipeline, decision), list)) = deciding.filter(|_| self.is_decided_there())
            {
                let decided = Decided {
                    views: 0..1,
                    eyes: 1,
                };
                let surface = &self.surface;
                surface.cmd_decide(device, cmd, layout, pipeline, list, decision, &decided)?;
            }
        }
        Ok(u64::from(points))
    }

    /// Records some of its draws in a round: solid, or lines over that.
    ///
    /// # Safety
    /// As `TessellatedSurface::cmd_draw`.
    pub(super) unsafe fn cmd_batches(
        &self,
        cmd: vk::CommandBuffer,
        context: &Context,
        round: u32,
        batches: Batches<'_>,
        pipelines: &Arc<Owned<Pipelines>>,
        cost: &mut Cost,
    ) -> Result<()> {
        let Some(list) = &self.list else {
            return Ok(());
        };
        let (device, layout) = (context.device().raw(), context.layout());
        let Batches { range, chosen } = batches;
        let batches = list.round(round)?.enumerate().skip(range.start);
        let batches = batches.take(range.len());
        for (_, batch) in batches.filter(|(number, _)| is_chosen(chosen, *number)) {
            let first = batch.points() > 0 && batch.ring_batch() == 0;
            // SAFETY: this function's contract; the target's pass allows the barrier.
            unsafe {
                if round > 0 && first && list.options().residence == Residence::Ring {
                    ring::cmd_ring_barrier(device, cmd);
                }
                self.surface
                    .cmd_draw(device, cmd, layout, pipelines, 0..1, batch)?;
            }
            cost.batches += 1;
            cost.draws += batch.draws().len();
        }
        Ok(())
    }
}
