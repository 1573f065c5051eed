//! The cache of a pose: control points that a compute pass computes once, for all draws (Brainerd et al. 2016, section 8.2).

use ash::vk;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Cut, DrawList, Residence, SurfaceOptions};
use crate::gpu::barrier::{MOST_UPDATED, cmd_make_visible};
use crate::gpu::points::compute_pipeline;
use crate::gpu::sets::STAGES;
use crate::gpu::{Layout, Pose, Tables};
use crate::method::Prepared;

/// Workgroups of a dispatch that every device takes (Vulkan spec, "Required Limits", `maxComputeWorkGroupCount`).
const MOST_GROUPS: u32 = 65_535;

/// What is known of a pose's cache.
#[derive(Debug)]
pub(super) struct Cache {
    /// The deepest plan level that it has room for.
    deepest: u32,
    bytes: u64,
    /// The plan level whose points it has; None where it has none of the present positions.
    level: Option<u32>,
    /// The plan level by which slots are placed, and the points in them.
    placed: Option<(u32, u32)>,
}

impl Cache {
    /// None where control points are not cached.
    pub fn new(prepared: &Prepared, options: &SurfaceOptions) -> Option<Cache> {
        let cached = options.residence == Residence::Cache;
        cached.then(|| {
            let cuts = options.greatest_cuts().into_iter();
            let levels = cuts.map(|cut| options.backend.cut(cut).cached_level(prepared));
            let deepest = levels.max().unwrap_or(0);
            let slots = Slots::new(prepared, deepest);
            Cache {
                deepest,
                bytes: 16 * u64::from(slots.end),
                level: None,
                placed: None,
            }
        })
    }

    /// Its bytes: where slots begin, then points.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Where in a cache the slots of all patches that have one begin, in points from its beginning.
struct Slots {
    starts: Vec<u32>,
    end: u32,
    /// Points in them.
    points: u32,
}

impl Slots {
    fn new(prepared: &Prepared, level: u32) -> Slots {
        let cut = Cut::of_plan_level(level);
        let passes = prepared.passes.iter().filter(|pass| pass.cached.is_some());
        let patches: u32 = passes.clone().map(|pass| pass.cached_patches()).sum();
        // Four words are a point's room.
        let first = patches.div_ceil(4);
        let mut end = first;
        let mut starts = Vec::with_capacity(patches as usize);
        for pass in passes {
            for patch in 0..pass.patches.len() {
                starts.push(end);
                end += cut.points(pass, patch);
            }
        }
        Slots {
            starts,
            end,
            points: end - first,
        }
    }
}

/// The pipelines that fill caches, one a pass that has any.
#[derive(Debug)]
pub struct CachePipelines {
    shaders: Vec<&'static str>,
    /// Null for passes that need none.
    pipelines: Vec<vk::Pipeline>,
}

impl CachePipelines {
    /// Builds them for all passes of what was prepared. The pipeline cache may go afterwards.
    ///
    /// # Errors
    /// Vulkan's own.
    ///
    /// # Safety
    /// `device` is live; `layout` and `cache` (or null) are of this device.
    pub unsafe fn new(
        device: &ash::Device,
        layout: &Layout,
        cache: vk::PipelineCache,
        prepared: &Prepared,
    ) -> Result<CachePipelines> {
        let mut made = CachePipelines {
            shaders: prepared.passes.iter().map(|pass| pass.shader).collect(),
            pipelines: Vec::new(),
        };
        for pass in &prepared.passes {
            if pass.cached.is_none() {
                made.pipelines.push(vk::Pipeline::null());
                continue;
            }
            let name = format!("{}.comp", pass.shader);
            // SAFETY: this function's contract.
            match unsafe { compute_pipeline(device, layout, cache, &name) } {
                Ok(pipeline) => made.pipelines.push(pipeline),
                Err(error) => {
                    // SAFETY: nothing has used them.
                    unsafe { made.destroy(device) };
                    return Err(error);
                }
            }
        }
        Ok(made)
    }

    /// Destroys them.
    ///
    /// # Safety
    /// `device` made them, and no submitted command still uses them.
    pub unsafe fn destroy(self, device: &ash::Device) {
        for pipeline in self.pipelines {
            // SAFETY: this function's contract; null handles are fine.
            unsafe { device.destroy_pipeline(pipeline, None) };
        }
    }
}

impl Pose {
    /// Says that control vertices were written on the device: what was cached of them is of no use any more.
    pub fn positions_changed(&mut self) {
        if let Some(cache) = &mut self.cache {
            cache.level = None;
        }
    }

    /// Says that commands of [`cmd_cache`](Self::cmd_cache) were never executed: there is nothing in the cache.
    pub fn forget_cache(&mut self) {
        if let Some(cache) = &mut self.cache {
            (cache.level, cache.placed) = (None, None);
        }
    }

    /// Records the computation of all control points that a list is drawn with, if they are not in the cache already: for a list of the same level
    /// or a lower one, and positions that have not changed, nothing. Returns how many are computed.
    ///
    /// They count as cached from here on: if the commands are never executed, say so by [`forget_cache`](Self::forget_cache).
    ///
    /// It waits for the draws of earlier frames, and later draws wait for it. Binds compute pipelines and sets 0 and 1, and pushes constants.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`], [`Misuse::OtherPipelines`], [`Misuse::NotCached`] for a pose without a cache, or one without room for the
    /// level; nothing has been recorded then.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made all of this, after [`cmd_upload`](Self::cmd_upload), outside of a render pass, on a queue that also
    /// computes, and is submitted before whatever draws; control vertices are visible to `SHADER_READ` in the compute stage. All of it lives until
    /// the commands have been executed.
    pub unsafe fn cmd_cache(
        &mut self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &CachePipelines,
        tables: &Tables,
        list: &DrawList,
    ) -> Result<u32> {
        self.check(tables)?;
        let prepared = tables.prepared();
        let cache = self.cache.as_ref().zip(list.cached_level());
        let Some((cache, needed)) = cache.filter(|(cache, needed)| *needed <= cache.deepest) else {
            return Err(Error::Misuse(Misuse::NotCached));
        };
        let shaders = prepared.passes.iter().map(|pass| pass.shader);
        if !shaders.eq(pipelines.shaders.iter().copied()) {
            return Err(Error::Misuse(Misuse::OtherPipelines));
        }
        if cache.level.is_some_and(|level| needed <= level) {
            return Ok(0);
        }
        // Where slots begin depends on the level alone: what moves from frame to frame finds them in place.
        let placed = cache.placed.filter(|&(level, _)| level == needed);
        let slots = placed.is_none().then(|| Slots::new(prepared, needed));
        let points = placed.map(|(_, points)| points);
        let points = points.or(slots.as_ref().map(|slots| slots.points));
        let starts = slots.as_ref().map_or(&[][..], |slots| &slots.starts);
        // SAFETY: this function's contract.
        unsafe { self.cmd_fill(device, cmd, layout, pipelines, tables, (needed, starts)) };
        let points = points.unwrap_or(0);
        if let Some(cache) = &mut self.cache {
            (cache.level, cache.placed) = (Some(needed), Some((needed, points)));
        }
        Ok(points)
    }

    /// # Safety
    /// As [`cmd_cache`](Self::cmd_cache).
    unsafe fn cmd_fill(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &CachePipelines,
        tables: &Tables,
        (level, starts): (u32, &[u32]),
    ) {
        let (compute, transfer) = (
            vk::PipelineStageFlags::COMPUTE_SHADER,
            vk::PipelineStageFlags::TRANSFER,
        );
        let buffer = self.computed();
        let readers = self.readers();
        // Synchronization is a matter of whole buffers: dispatches write points behind the slots, each those of its own patches.
        let read = vk::AccessFlags::SHADER_READ;
        let both = read | vk::AccessFlags::SHADER_WRITE;
        let words: &[u8] = bytemuck::cast_slice(starts);
        // SAFETY: this function's contract.
        unsafe {
            let write = vk::AccessFlags::TRANSFER_WRITE | vk::AccessFlags::SHADER_WRITE;
            cmd_make_visible(device, cmd, readers | compute, transfer | compute, write);
            for (place, part) in (0u64..).zip(words.chunks(MOST_UPDATED)) {
                device.cmd_update_buffer(cmd, buffer, place * MOST_UPDATED as u64, part);
            }
            cmd_make_visible(device, cmd, transfer, readers | compute, both);
        }
        let bind = vk::PipelineBindPoint::COMPUTE;
        let mut again = false;
        let passes = tables.prepared().passes.iter().zip(&pipelines.pipelines);
        for (number, (pass, &pipeline)) in passes.enumerate() {
            let patches = pass.cached_patches();
            if patches == 0 {
                continue;
            }
            let sets = [tables.set(number), self.set()];
            // SAFETY: as above.
            unsafe {
                device.cmd_bind_pipeline(cmd, bind, pipeline);
                device.cmd_bind_descriptor_sets(cmd, bind, layout.pipeline(), 0, &sets, &[]);
            }
            for first in (0..patches).step_by(MOST_GROUPS as usize) {
                let end = patches.min(first + MOST_GROUPS);
                let frame = abi::Frame {
                    level: Cut::of_plan_level(level).level,
                    first_patch: first,
                    end_patch: end,
                    ..abi::Frame::default()
                };
                let constants = bytemuck::bytes_of(&frame);
                // SAFETY: as above.
                unsafe {
                    if std::mem::replace(&mut again, true) {
                        cmd_make_visible(device, cmd, compute, compute, both);
                    }
                    device.cmd_push_constants(cmd, layout.pipeline(), STAGES, 0, constants);
                    device.cmd_dispatch(cmd, end - first, 1, 1);
                }
            }
        }
        // SAFETY: as above.
        unsafe { cmd_make_visible(device, cmd, compute, readers, read) };
    }

    /// # Errors
    /// [`Misuse::NotCached`] where the cache has not all points that a list is drawn with.
    pub(super) fn check_cached(&self, list: &DrawList) -> Result<()> {
        let Some(needed) = list.cached_level() else {
            return Ok(());
        };
        let level = self.cache.as_ref().and_then(|cache| cache.level);
        if level.is_some_and(|level| needed <= level) {
            return Ok(());
        }
        Err(Error::Misuse(Misuse::NotCached))
    }
}
