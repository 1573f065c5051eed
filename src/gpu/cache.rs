//! The cache of a pose: control points that a compute pass computes once, for all draws (Brainerd et al. 2016, section 8.2).

use ash::vk;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::DrawList;
use crate::gpu::barrier::cmd_make_visible;
use crate::gpu::cached::Cache;
use crate::gpu::kept_cache::KeptCache;
use crate::gpu::points::compute_pipeline;
use crate::gpu::sets::STAGES;
use crate::gpu::shaders::{Embedded, Modules};
use crate::gpu::{Layout, Pose, Tables};
use crate::method::{Jobs, Pass, Prepared};

/// Workgroups of a dispatch that every device takes (Vulkan spec, "Required Limits", `maxComputeWorkGroupCount`).
const MOST_GROUPS: u32 = 65_535;

/// The pipelines that fill caches, one a pass that has any.
#[derive(Debug)]
pub struct CachePipelines {
    shaders: Vec<&'static str>,
    /// Null for passes that need none.
    pipelines: Vec<vk::Pipeline>,
}

/// What a cache is filled for, and how far at once.
#[derive(Clone, Copy, Debug)]
pub struct Filling<'a> {
    /// What is to be drawn.
    pub list: &'a DrawList,
    /// The most points that are computed.
    pub most: u32,
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
        // SAFETY: this function's contract; the tests validate every module of ours.
        unsafe { CachePipelines::with_modules(device, layout, cache, prepared, &Embedded) }
    }

    /// The names of the modules that they are made of.
    pub fn modules(prepared: &Prepared) -> impl Iterator<Item = String> + '_ {
        let passes = prepared.passes.iter();
        passes.filter(|pass| pass.cached.is_some()).map(module)
    }

    /// The same from other modules than those that the crate brings, of the same names ([`modules`](Self::modules)).
    ///
    /// # Errors
    /// As [`new`](Self::new), and those of the modules.
    ///
    /// # Safety
    /// As [`new`](Self::new); the modules are valid SPIR-V for the device, with the interfaces that ours have.
    pub unsafe fn with_modules(
        device: &ash::Device,
        layout: &Layout,
        cache: vk::PipelineCache,
        prepared: &Prepared,
        from: &dyn Modules,
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
            // SAFETY: this function's contract.
            match unsafe { compute_pipeline(device, layout, cache, &module(pass), from) } {
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

/// The module that fills a pass's cache.
fn module(pass: &Pass) -> String {
    format!("{}.comp", pass.shader)
}

impl Cache {
    /// Takes down that the points of the levels that there are are those of the tables now; tells which of them are to be computed again. Where that is not known none are
    /// there.
    fn edited(&mut self, tables: &Tables) -> Vec<(usize, Jobs)> {
        let Some(kept) = tables.kept_cache() else {
            return Vec::new();
        };
        let before = self.state.replace(kept.state());
        // What is left of an older state has other numbers by now.
        let is_left = !self.left.is_empty() && before != Some(kept.state());
        let (Some(level), Some(before)) = (self.level.filter(|_| !is_left), before) else {
            self.forget();
            return Vec::new();
        };
        let Some(jobs) = kept.since(before) else {
            self.forget();
            return Vec::new();
        };
        let known = jobs.into_iter().filter(|&(_, of, _)| of <= level);
        known.map(|(pass, _, jobs)| (pass, jobs)).collect()
    }
}

impl Pose {
    /// Says that control vertices were written on the device: what was cached of them is of no use any more.
    pub fn positions_changed(&mut self) {
        self.forget_cache();
    }

    /// Says that commands of [`cmd_cache`](Self::cmd_cache) were never executed: there is nothing in the cache.
    pub fn forget_cache(&mut self) {
        if let Some(cache) = &mut self.cache {
            cache.forget();
        }
    }

    /// Records the computation of all control points that a list is drawn with and that are not in the cache already: for a list of the same level or a
    /// lower one, and positions that have not changed, none; for one of a higher level, those of the levels between; after an edit of the tables those that it has
    /// changed. Returns how many are computed.
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
        let fill = Filling {
            list,
            most: u32::MAX,
        };
        // SAFETY: this function's contract.
        unsafe { self.cmd_cache_some(device, cmd, layout, pipelines, tables, fill) }
    }

    /// The same in slices, for what takes long: so many points at most, the rest by later calls. Nothing can be drawn before nothing is
    /// [left](Self::uncached).
    ///
    /// # Errors
    /// As [`cmd_cache`](Self::cmd_cache).
    ///
    /// # Safety
    /// As [`cmd_cache`](Self::cmd_cache).
    pub unsafe fn cmd_cache_some(
        &mut self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &CachePipelines,
        tables: &Tables,
        Filling { list, most }: Filling<'_>,
    ) -> Result<u32> {
        self.check(tables)?;
        let prepared = tables.prepared();
        let cache = self.cache.as_mut().zip(list.cached_level());
        let cached = cache.zip(tables.cached());
        let Some(((cache, needed), (_, points))) =
            cached.filter(|((_, needed), (deepest, _))| needed <= deepest)
        else {
            return Err(Error::Misuse(Misuse::NotCached));
        };
        let shaders = prepared.passes.iter().map(|pass| pass.shader);
        if !shaders.eq(pipelines.shaders.iter().copied()) {
            return Err(Error::Misuse(Misuse::OtherPipelines));
        }
        if !cache.has_room(tables) {
            return Err(Error::Misuse(Misuse::NotCached));
        }
        let edited = cache.edited(tables);
        let first = cache.level.map_or(0, |level| level + 1);
        let new = first as usize..(needed as usize + 1).max(first as usize);
        let jobs = (0..).zip(&points.passes).flat_map(|(pass, own)| {
            let levels = &own.jobs[new.clone()];
            levels.iter().map(move |&jobs| (pass, jobs))
        });
        let jobs = jobs.chain(edited).filter(|(_, jobs)| jobs.count > 0);
        cache.left.extend(jobs);
        cache.level = Some(needed.max(cache.level.unwrap_or(0)));
        let jobs = cache.take(most);
        if jobs.is_empty() {
            return Ok(0);
        }
        // SAFETY: this function's contract.
        unsafe { self.cmd_fill(device, cmd, layout, pipelines, tables, &jobs) };
        Ok(jobs.iter().map(|(_, jobs)| jobs.count).sum())
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
        jobs: &[(usize, Jobs)],
    ) {
        let compute = vk::PipelineStageFlags::COMPUTE_SHADER;
        let readers = self.readers();
        let read = vk::AccessFlags::SHADER_READ;
        let write = vk::AccessFlags::SHADER_WRITE;
        // Draws of earlier frames have read what is written now, and their own cache was written before.
        // SAFETY: this function's contract.
        unsafe { cmd_make_visible(device, cmd, readers | compute, compute, write) };
        let bind = vk::PipelineBindPoint::COMPUTE;
        let mut again = false;
        for &(pass, jobs) in jobs {
            let sets = [tables.set(pass), self.set()];
            // SAFETY: as above.
            unsafe {
                device.cmd_bind_pipeline(cmd, bind, pipelines.pipelines[pass]);
                device.cmd_bind_descriptor_sets(cmd, bind, layout.pipeline(), 0, &sets, &[]);
            }
            let most = MOST_GROUPS * abi::CONTROL_INVOCATIONS;
            for done in (0..jobs.count).step_by(most as usize) {
                let count = most.min(jobs.count - done);
                // What a cache is filled by has no draw: patches stand for jobs, and the counter for the first point.
                let frame = abi::Frame {
                    first_patch: jobs.first + done,
                    end_patch: jobs.first + done + count,
                    counter: jobs.first_point + done,
                    ..abi::Frame::default()
                };
                let constants = bytemuck::bytes_of(&frame);
                // SAFETY: as above.
                unsafe {
                    if std::mem::replace(&mut again, true) {
                        // Synchronization is a matter of whole buffers, though each dispatch writes points of its own.
                        cmd_make_visible(device, cmd, compute, compute, write);
                    }
                    device.cmd_push_constants(cmd, layout.pipeline(), STAGES, 0, constants);
                    device.cmd_dispatch(cmd, count.div_ceil(abi::CONTROL_INVOCATIONS), 1, 1);
                }
            }
        }
        // SAFETY: as above.
        unsafe { cmd_make_visible(device, cmd, compute, readers, read) };
    }

    /// How many control points [`cmd_cache`](Self::cmd_cache) computes before a list is drawn; behind an edit of the tables, all that it has.
    pub fn uncached(&self, tables: &Tables, list: &DrawList) -> u32 {
        let (Some(needed), Some((_, points))) = (list.cached_level(), tables.cached()) else {
            return 0;
        };
        let state = tables.kept_cache().map(KeptCache::state);
        let cache = self.cache.as_ref().filter(|cache| cache.state == state);
        let Some((cache, level)) = cache.and_then(|cache| Some((cache, cache.level?))) else {
            return points.count(needed);
        };
        let deeper = points.count(needed).saturating_sub(points.count(level));
        cache.count_left() + deeper
    }

    /// # Errors
    /// [`Misuse::NotCached`] where the cache has not all points that a list is drawn with.
    pub(super) fn check_cached(&self, tables: &Tables, list: &DrawList) -> Result<()> {
        let Some(needed) = list.cached_level() else {
            return Ok(());
        };
        let state = tables.kept_cache().map(KeptCache::state);
        let cache = self.cache.as_ref();
        let whole = cache.filter(|cache| cache.state == state && cache.left.is_empty());
        let level = whole.and_then(|cache| cache.level);
        if level.is_some_and(|level| needed <= level) {
            return Ok(());
        }
        Err(Error::Misuse(Misuse::NotCached))
    }
}
