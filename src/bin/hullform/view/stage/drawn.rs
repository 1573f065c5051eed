//! How a frame draws one surface: its points, and its draws, once or with lines over them.

use std::sync::Arc;

use hullform::Result;
use hullform::ash::vk;
use hullform::gpu::{DrawList, Pipelines, Residence, View, ring};
use hullform::host::Owned;

use super::{Cost, Stage, style};
use crate::view::context::{Context, Drawn};
use crate::view::viewer::Viewer;

impl Drawn {
    /// Records what comes before rendering: how many control points are computed.
    ///
    /// # Safety
    /// `cmd` is recording on the device that made it, outside of a render pass.
    pub(super) unsafe fn cmd_prepare(
        &mut self,
        cmd: vk::CommandBuffer,
        context: &Context,
        view: View,
    ) -> Result<u64> {
        let (device, layout) = (context.device().raw(), context.layout());
        let mut points = 0;
        // SAFETY: this function's contract.
        unsafe {
            self.surface.cmd_upload(device, cmd);
            if let (Some(cache), Some(list)) = (&self.cache, &self.list) {
                points = self.surface.cmd_cache(device, cmd, layout, cache, list)?;
            }
            self.surface.cmd_prepare(device, cmd, &[view])?;
        }
        Ok(u64::from(points))
    }

    /// Records its draws: solid, and lines over it. What has no pipelines yet is not drawn.
    ///
    /// # Safety
    /// As `TessellatedSurface::cmd_draw`.
    pub(super) unsafe fn cmd_draw(
        &self,
        cmd: vk::CommandBuffer,
        viewer: &Viewer,
        context: &Context,
        cost: &mut Cost,
    ) -> Result<()> {
        let Some(list) = &self.list else {
            return Ok(());
        };
        cost.vertices += self.vertices;
        for (round, fill) in (0..).zip(Stage::fills(viewer)) {
            let key = self.key(style(self, viewer, fill));
            let Some(pipelines) = context.ready_or_like(&key) else {
                continue;
            };
            // SAFETY: this function's contract.
            unsafe { self.cmd_round(cmd, context, list, round, &pipelines, cost) }?;
        }
        Ok(())
    }

    /// # Safety
    /// As there.
    unsafe fn cmd_round(
        &self,
        cmd: vk::CommandBuffer,
        context: &Context,
        list: &DrawList,
        round: u32,
        pipelines: &Arc<Owned<Pipelines>>,
        cost: &mut Cost,
    ) -> Result<()> {
        let (device, layout) = (context.device().raw(), context.layout());
        for batch in list.round(round)? {
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
