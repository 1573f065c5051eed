//! The control points that a surface has cached.

use ash::vk;

use super::TessellatedSurface;
use crate::error::Result;
use crate::frame::DrawList;
use crate::gpu::{CachePipelines, Filling, Layout};
#[cfg(doc)]
use crate::gpu::{Drawing, Pose, Tables};
use crate::method::CachedPoints;

impl TessellatedSurface {
    /// As [`Pose::cmd_cache`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Safety
    /// As there.
    pub unsafe fn cmd_cache(
        &mut self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &CachePipelines,
        list: &DrawList,
    ) -> Result<u32> {
        let tables = &self.tables;
        // SAFETY: this function's contract.
        unsafe {
            self.pose
                .cmd_cache(device, cmd, layout, pipelines, tables, list)
        }
    }

    /// As [`Pose::cmd_cache_some`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Safety
    /// As there.
    pub unsafe fn cmd_cache_some(
        &mut self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &CachePipelines,
        fill: Filling<'_>,
    ) -> Result<u32> {
        let tables = &self.tables;
        // SAFETY: this function's contract.
        unsafe {
            self.pose
                .cmd_cache_some(device, cmd, layout, pipelines, tables, fill)
        }
    }

    /// As [`Pose::uncached`].
    pub fn uncached(&self, list: &DrawList) -> u32 {
        self.pose.uncached(&self.tables, list)
    }

    /// As [`Tables::cached_points`].
    pub fn cached_points(&self) -> Option<&CachedPoints> {
        self.tables.cached_points()
    }

    /// As [`Drawing::is_cached`].
    pub fn is_cached(&self, list: &DrawList) -> bool {
        self.drawing().is_cached(list)
    }

    /// As [`Pose::positions_changed`].
    pub fn positions_changed(&mut self) {
        self.pose.positions_changed();
    }
}
