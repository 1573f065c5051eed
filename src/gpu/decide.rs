//! Deciding about patches on the device: their levels, and which are not drawn.

use std::ops::Range;
use std::sync::PoisonError;
use std::sync::atomic::Ordering;

use ash::vk;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Decides, Decision, DrawList, Metric, Outcome, Samples};
use crate::gpu::barrier::cmd_make_visible;
use crate::gpu::points::compute_pipeline;
use crate::gpu::sets::STAGES;
use crate::gpu::shaders::Embedded;
use crate::gpu::{FrameSlot, Layout, Pose, Tables};

/// The pipelines that decide about patches, the same for all methods.
#[derive(Debug)]
pub struct DecidePipeline {
    limits: vk::Pipeline,
    patches: vk::Pipeline,
    compact: vk::Pipeline,
}

impl DecidePipeline {
    /// Builds them. The cache may go afterwards.
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
    ) -> Result<DecidePipeline> {
        // SAFETY: this function's contract.
        let made = |name| unsafe { compute_pipeline(device, layout, cache, name, &Embedded) };
        let mut all = DecidePipeline {
            limits: vk::Pipeline::null(),
            patches: vk::Pipeline::null(),
            compact: vk::Pipeline::null(),
        };
        let mut make = || {
            all.limits = made("limits.comp")?;
            all.patches = made("decide.comp")?;
            all.compact = made("compact.comp")?;
            Ok(())
        };
        match make() {
            Ok(()) => Ok(all),
            Err(error) => {
                // SAFETY: they were just made, and nothing uses them.
                unsafe { all.destroy(device) };
                Err(error)
            }
        }
    }

    pub(super) fn compact(&self) -> vk::Pipeline {
        self.compact
    }

    /// Destroys them.
    ///
    /// # Safety
    /// `device` made it, and no submitted command still uses it.
    pub unsafe fn destroy(self, device: &ash::Device) {
        // SAFETY: this function's contract; null handles are fine.
        unsafe {
            device.destroy_pipeline(self.limits, None);
            device.destroy_pipeline(self.patches, None);
            device.destroy_pipeline(self.compact, None);
        };
    }
}

/// What is decided about: of all that is drawn of a pose, in the views of a range. With multiview, `eyes` of them are drawn together: they get the levels that the one
/// of them needs that needs most, and what any of them sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Decided {
    /// The views, of those that `cmd_prepare` was given.
    pub views: Range<u32>,
    /// How many views an instance has: 1, but with multiview.
    pub eyes: u32,
}

impl FrameSlot {
    /// Records what the device decides about all patches, for the views of a range: needed behind [`cmd_prepare`](Self::cmd_prepare) before they are drawn, where
    /// [`Decides::Device`] says so. Nothing of it takes the host's time by patch, and no frame in flight waits for another: each has a slot of its own.
    ///
    /// Later draws wait for it. Binds a compute pipeline and sets 0 to 2, and pushes constants.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`]; [`Misuse::DecidedByDevice`] where the host decides, or the pose was made for that, and for patches that are left out where vertices are moved to show
    /// cracks; [`Misuse::View`], [`Misuse::Eyes`] for views that there are not; [`Misuse::Measure`], [`Misuse::Samples`], [`Misuse::Pictures`]. Nothing has
    /// been recorded then.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made all of this, after `cmd_prepare`, outside of a render pass, on a queue that also computes, and is submitted
    /// before whatever draws; control vertices are visible to `SHADER_READ` in the compute stage. All of it lives until the commands have been executed.
    #[allow(clippy::too_many_arguments)] // What is recorded, by what, and what about: as for the other commands.
    pub unsafe fn cmd_decide(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipeline: &DecidePipeline,
        (tables, pose): (&Tables, &Pose),
        list: &DrawList,
        decision: &Decision,
        decided: &Decided,
    ) -> Result<()> {
        pose.check(tables)?;
        self.check_owner(tables, list)?;
        self.check_decision(decision, decided)?;
        if pose.limit_buffer().is_none() {
            let what = "a pose that was made for decisions of the host";
            return Err(Error::Misuse(Misuse::DecidedByDevice { what }));
        }
        let Decided { views, eyes } = decided;
        let bind = vk::PipelineBindPoint::COMPUTE;
        let compute = vk::PipelineStageFlags::COMPUTE_SHADER;
        let readers = pose.readers();
        let passes = tables.prepared().passes.iter().enumerate();
        let vertices = tables.prepared().vertex_count() as u32;
        // SAFETY: this function's contract.
        unsafe {
            let write = vk::AccessFlags::SHADER_WRITE;
            let before = readers | compute | vk::PipelineStageFlags::DRAW_INDIRECT;
            cmd_make_visible(device, cmd, before, compute, write);
            if decision.metric != Metric::Cut || decision.frustum {
                self.cmd_limits(
                    device,
                    cmd,
                    layout,
                    pipeline,
                    (tables, pose),
                    decision,
                    list,
                );
            }
            device.cmd_bind_pipeline(cmd, bind, pipeline.patches);
        }
        for (number, pass) in passes.filter(|(_, pass)| !pass.patches.is_empty()) {
            let sets = [tables.set(number), pose.set(), self.set(number)];
            let record = decision.record(views.start, *eyes, list.cut(), pass.max_level, vertices);
            let groups = (pass.patches.len() as u32).div_ceil(abi::DECIDE_INVOCATIONS);
            let constants = bytemuck::bytes_of(&record);
            // SAFETY: as above.
            unsafe {
                device.cmd_bind_descriptor_sets(cmd, bind, layout.pipeline(), 0, &sets, &[]);
                device.cmd_push_constants(cmd, layout.pipeline(), STAGES, 0, constants);
                device.cmd_dispatch(cmd, groups, views.len() as u32 / eyes, 1);
            }
        }
        // SAFETY: as above.
        unsafe {
            self.cmd_compact(device, cmd, layout, pipeline, (tables, pose), list, decided);
        }
        self.set_decided(list, views.end);
        Ok(())
    }

    /// Records the computation of limits and normals, and of the box around all vertices, once for all views.
    ///
    /// # Safety
    /// As [`cmd_decide`](Self::cmd_decide), whose earlier reads of the pose have ended.
    #[allow(clippy::too_many_arguments)] // As `cmd_decide`.
    unsafe fn cmd_limits(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipeline: &DecidePipeline,
        (tables, pose): (&Tables, &Pose),
        decision: &Decision,
        list: &DrawList,
    ) {
        let prepared = tables.prepared();
        if prepared.passes.is_empty() {
            return;
        }
        let bind = vk::PipelineBindPoint::COMPUTE;
        let compute = vk::PipelineStageFlags::COMPUTE_SHADER;
        let (vertices, read) = (prepared.vertex_count() as u32, vk::AccessFlags::SHADER_READ);
        // The first pass' tables tell of all vertices.
        let sets = [tables.set(0), pose.set(), self.set(0)];
        let limits = decision.record(0, 1, list.cut(), abi::HIGHEST_LEVEL, vertices);
        let boxes = abi::Decision {
            flags: limits.flags | abi::DECIDE_BOX,
            ..limits
        };
        let groups = vertices.div_ceil(abi::DECIDE_INVOCATIONS);
        let whole = decision.frustum.then_some((boxes, 1));
        // SAFETY: this function's contract.
        unsafe {
            device.cmd_bind_pipeline(cmd, bind, pipeline.limits);
            device.cmd_bind_descriptor_sets(cmd, bind, layout.pipeline(), 0, &sets, &[]);
            for (record, groups) in [(limits, groups)].into_iter().chain(whole) {
                let constants = bytemuck::bytes_of(&record);
                device.cmd_push_constants(cmd, layout.pipeline(), STAGES, 0, constants);
                device.cmd_dispatch(cmd, groups, 1, 1);
                cmd_make_visible(device, cmd, compute, compute, read);
            }
        }
    }

    /// # Errors
    /// As [`cmd_decide`](Self::cmd_decide).
    fn check_decision(&self, decision: &Decision, decided: &Decided) -> Result<()> {
        if self.options().decides == Decides::Host {
            let what = "options by which the host decides";
            return Err(Error::Misuse(Misuse::DecidedByDevice { what }));
        }
        let Decided { views, eyes } = decided;
        let (count, eyes) = (views.len() as u32, *eyes);
        if eyes == 0 || count % eyes != 0 {
            let views = count;
            return Err(Error::Misuse(Misuse::Eyes { views, eyes }));
        }
        let given = self.views.load(Ordering::Relaxed);
        let seen = decision.seen_from.unwrap_or(views.start);
        for end in [u64::from(views.end), u64::from(seen) + u64::from(count)] {
            if end > u64::from(given) {
                let (view, views) = (end as u32 - 1, given);
                return Err(Error::Misuse(Misuse::View { view, views }));
            }
        }
        self.check_culling(decision)?;
        check_measures(decision)
    }

    /// # Errors
    /// [`Misuse::DecidedByDevice`] where what is left out may be seen after all; [`Misuse::Samples`].
    fn check_culling(&self, decision: &Decision) -> Result<()> {
        let culls = decision.frustum || decision.back || decision.small.is_some();
        if culls && self.options().amplify_cracks {
            let what = "amplified cracks, where patches are left out";
            return Err(Error::Misuse(Misuse::DecidedByDevice { what }));
        }
        match decision.small {
            Some(Samples { a_pixel, .. }) if ![1, 2, 4, 8].contains(&a_pixel) => {
                Err(Error::Misuse(Misuse::Samples { given: a_pixel }))
            }
            _ => Ok(()),
        }
    }

    /// What the device decided for a range of views, for a list of this cut; see [`decided`](Self::decided). Nothing where the host decides.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`]; [`Misuse::NotReadBack`].
    pub fn outcome(&self, tables: &Tables, list: &DrawList, views: Range<u32>) -> Result<Outcome> {
        self.check_owner(tables, list)?;
        self.counters()?;
        let mut outcome = Outcome::default();
        for view in views {
            for (number, pass) in tables.prepared().passes.iter().enumerate() {
                outcome += Outcome::of(pass, self.decided(number, view), list.cut());
            }
        }
        Ok(outcome)
    }

    /// Says at which cut, and up to which view, the device has decided.
    pub(super) fn set_decided(&self, list: &DrawList, end: u32) {
        let mut decided = self.decided.lock().unwrap_or_else(PoisonError::into_inner);
        let end = match *decided {
            Some((cut, known)) if cut == list.cut() => known.max(end),
            _ => end,
        };
        *decided = Some((list.cut(), end));
    }

    /// # Errors
    /// [`Misuse::NotDecided`] where the device decides, and has not yet.
    pub(super) fn check_decided(&self, views: &Range<u32>, list: &DrawList) -> Result<()> {
        let decided = *self.decided.lock().unwrap_or_else(PoisonError::into_inner);
        let known = decided.is_some_and(|(cut, end)| cut == list.cut() && views.end <= end);
        if known || self.options().decides == Decides::Host {
            return Ok(());
        }
        Err(Error::Misuse(Misuse::NotDecided))
    }
}

/// # Errors
/// [`Misuse::Measure`] for what is not greater than 0; [`Misuse::Pictures`].
fn check_measures(decision: &Decision) -> Result<()> {
    let [x, y] = decision.small.map_or([1.0; 2], |samples| samples.size);
    let measures = match decision.metric {
        Metric::Cut => [1.0, x, y],
        Metric::Distance(measure) | Metric::Curvature(measure) => [measure, x, y],
        Metric::Screen { size, .. } if decision.small.is_some() && size != [x, y] => {
            let (levels, samples) = (size, [x, y]);
            return Err(Error::Misuse(Misuse::Pictures { levels, samples }));
        }
        Metric::Screen {
            pixels,
            size: [x, y],
        } => [pixels, x, y],
    };
    // What is no number is not greater either.
    match measures
        .into_iter()
        .find(|&given| !(given > 0.0 && given.is_finite()))
    {
        Some(given) => Err(Error::Misuse(Misuse::Measure { given })),
        None => Ok(()),
    }
}
