//! How a frame draws one surface: its points, and its draws, once or with lines over them.

use std::sync::Arc;

use hullform::Result;
use hullform::ash::vk;
use hullform::gpu::{
    Decided, Decides, Decision, DrawList, Filling, Pipelines, Residence, View, ring,
};
use hullform::host::Owned;
use hullform::method::{Editable, Update};

use super::Cost;
use super::scene::{Batches, work_of};
use crate::view::context::{Context, Drawn, Growth};

impl Drawn {
    /// What is drawn of it: all, or where a part of the picture is drawn what is seen there.
    pub(super) fn drawn_list(&self, is_part: bool) -> Option<&DrawList> {
        match is_part {
            true => self.few.as_ref().map(|few| &few.list),
            false => self.list.as_ref(),
        }
    }

    /// The work that each batch is of what is drawn of it in a round.
    pub(super) fn works(&self, is_part: bool) -> Option<Arc<[f64]>> {
        match is_part {
            true => self.few.as_ref().map(|few| few.works.clone()),
            false => self
                .list
                .as_ref()
                .map(|l| l.batches().map(work_of).collect()),
        }
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
        (self.list, self.few) = (None, None);
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

    /// How many control points are to be computed before it is drawn.
    pub(super) fn uncached(&self) -> u32 {
        let cached = self.list.as_ref().filter(|_| self.cache.is_some());
        cached.map_or(0, |list| self.surface.uncached(list))
    }

    /// Records the computation of so many of these: how many they are.
    ///
    /// # Safety
    /// As [`cmd_prepare`](Self::cmd_prepare).
    pub(super) unsafe fn cmd_fill(
        &mut self,
        cmd: vk::CommandBuffer,
        context: &Context,
        most: u32,
    ) -> Result<u32> {
        let (device, layout) = (context.device().raw(), context.layout());
        let (Some(cache), Some(list)) = (&self.cache, &self.list) else {
            return Ok(0);
        };
        let filling = Filling { list, most };
        // SAFETY: this function's contract.
        unsafe {
            self.surface.cmd_upload(device, cmd);
            self.surface
                .cmd_cache_some(device, cmd, layout, cache, filling)
        }
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
        let Some(list) = self.drawn_list(batches.is_part) else {
            return Ok(());
        };
        let (device, layout) = (context.device().raw(), context.layout());
        let Batches { range, works, .. } = batches;
        let batches = list.round(round)?.zip(works.iter()).skip(range.start);
        let batches = batches.take(range.len());
        for (batch, _) in batches.filter(|(_, work)| **work > 0.0) {
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
