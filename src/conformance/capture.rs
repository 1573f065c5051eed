//! Our surfaces on the device, and every vertex that comes of them.

mod cuts;
mod pipelines;

use std::cell::RefCell;
use std::collections::HashMap;

use ash::vk;

use crate::abi::Captured;
use crate::conformance::Context;
use crate::conformance::context::Seen;
use crate::error::{Error, Result};
use crate::gpu::{
    Batch, CachePipelines, Counters, Cut, DrawList, Fill, Layout, Pipelines, Residence, Shading,
    SurfaceOptions, TessellatedSurface, View, Workaround, ring,
};
use crate::host::{Device, Encoding, OffscreenTarget, StatisticsQuery};
use crate::mesh::Model;
use crate::method::{DepthTags, Displacement, Prepared};

use cuts::key;
pub use cuts::{SPACINGS, bits, cut, over_patches, prepare, spacing_name, vertices};
use pipelines::PipelineKey;

/// The side of the picture that surfaces are drawn into.
pub const SIDE: u32 = 256;

/// The most vertices that are captured in one submission: 36 MB.
const MOST_CAPTURED: u32 = 1_000_000;

/// A device with what surfaces share, kept from case to case: pipelines take long to build.
pub struct Bench {
    device: Device,
    layout: Option<Layout>,
    target: OffscreenTarget,
    pipelines: RefCell<HashMap<PipelineKey, Pipelines>>,
    seen: Seen,
}

impl Bench {
    /// What surfaces need on a device; vertices and pixels that come back are counted in `seen`.
    pub fn new(device: &Device, seen: &Seen) -> Result<Bench> {
        let target = OffscreenTarget::with_encoding(device, SIDE, SIDE, 1, Encoding::Unorm)?;
        // SAFETY: the device is live.
        let layout = unsafe { Layout::new(device.raw(), device.enabled()) }?;
        Ok(Bench {
            device: device.clone(),
            layout: Some(layout),
            target,
            pipelines: RefCell::default(),
            seen: seen.clone(),
        })
    }

    fn layout(&self) -> &Layout {
        self.layout.as_ref().expect("there until it is dropped")
    }

    /// Brings a prepared model to the device.
    pub fn load(
        &self,
        model: &Model,
        prepared: Prepared,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<Loaded<'_>> {
        let device = self.device.raw();
        let layout = self.layout();
        // SAFETY: all of one live device, which was opened with every feature that `Support` asks for.
        let surface = unsafe {
            let allocator = &mut self.device.allocator();
            TessellatedSurface::new(
                device,
                allocator,
                layout,
                model,
                prepared,
                workarounds,
                options,
            )
        };
        let mut loaded = Loaded {
            bench: self,
            options,
            view: from_the_side(reach(model)),
            tags: None,
            cull: vk::CullModeFlags::NONE,
            surface: Some(surface?),
        };
        self.device.submit(|cmd| {
            // SAFETY: recording on the device that made the surface, outside of a render pass.
            unsafe { loaded.surface_mut().cmd_upload(device, cmd) };
            Ok(())
        })?;
        let surface = loaded.surface_mut();
        // SAFETY: the upload has been waited for.
        unsafe { surface.finish_upload(device, &mut self.device.allocator()) };
        Ok(loaded)
    }

    fn saw(&self, count: usize) {
        self.seen.set(self.seen.get() + count as u64);
    }

    fn forget(&self) {
        for (_, pipelines) in self.pipelines.borrow_mut().drain() {
            // SAFETY: every submission has been waited for.
            unsafe { pipelines.destroy(self.device.raw()) };
        }
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        if self.device.is_hung() {
            return;
        }
        self.forget();
        if let Some(layout) = self.layout.take() {
            // SAFETY: every submission has been waited for.
            unsafe { layout.destroy(self.device.raw()) };
        }
    }
}

/// Half of what a picture must show, so that no triangle is clipped: limits and linear faces stay within the control points' hull, and what
/// bulges out of it, within twice that.
fn reach(model: &Model) -> f32 {
    let positions = model.positions();
    let farthest = positions.iter().map(|p| p.abs().max_element());
    2.0 * farthest.fold(1e-30, f32::max)
}

/// A view of everything within `reach` of the middle.
fn from_the_side(reach: f32) -> View {
    let scale = 0.99 / reach;
    View {
        clip_from_model: [
            [scale, 0.0, 0.0, 0.0],
            [0.0, -scale, 0.0, 0.0],
            [0.0, 0.0, -0.5 * scale, 0.0],
            [0.0, 0.0, 0.5, 1.0],
        ],
        eye: [0.0, 0.0, 10.0 * reach],
        displacement: Displacement::default(),
    }
}

/// A model on the device.
pub struct Loaded<'a> {
    bench: &'a Bench,
    options: SurfaceOptions,
    /// What pictures show: from the side, everything within the picture and its depth.
    pub view: View,
    /// A depth for each control vertex, where levels go by them.
    pub tags: Option<DepthTags>,
    /// Which triangles pictures leave out.
    pub cull: vk::CullModeFlags,
    surface: Option<TessellatedSurface>,
}

/// What a submission, or one a pass, gave.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Captured vertices, a list a pass; each by patch, v and u, once.
    pub passes: Vec<Vec<Captured>>,
    /// What the control shaders counted.
    pub counters: Counters,
    /// Control shader patches, evaluation shader invocations, clipping primitives; where the device counts them.
    pub statistics: Option<[u64; 3]>,
    /// Vertices that came more than once, with different bits.
    pub differing: usize,
}

impl Frame {
    /// Everything that was captured, as words to compare.
    pub fn bits(&self) -> Vec<[u32; 9]> {
        self.passes.iter().flatten().map(bits).collect()
    }
}

impl Loaded<'_> {
    /// The surface.
    pub fn surface(&self) -> &TessellatedSurface {
        self.surface.as_ref().expect("there from load to drop")
    }

    fn surface_mut(&mut self) -> &mut TessellatedSurface {
        self.surface.as_mut().expect("there from load to drop")
    }

    /// What was prepared.
    pub fn prepared(&self) -> &Prepared {
        self.surface().prepared()
    }

    /// What is drawn at a cut, with what the host decides about it on the device.
    pub fn draw_list(&mut self, cut: Cut) -> Result<DrawList> {
        let list = self.surface().draw_list(cut, self.tags.as_ref())?;
        let device = &self.bench.device;
        let allocator = &mut device.allocator();
        // SAFETY: device and allocator made the surface; every submission has been waited for.
        unsafe {
            self.surface_mut()
                .write_draws(device.raw(), allocator, &list)?
        };
        if self.options.residence == Residence::Cache {
            self.cache(&list)?;
        }
        Ok(list)
    }

    /// Fills the cache with the control points that a list needs, in a submission of its own.
    fn cache(&mut self, list: &DrawList) -> Result<()> {
        let (device, layout) = (&self.bench.device, self.bench.layout());
        let cache = vk::PipelineCache::null();
        let prepared = self.prepared();
        // SAFETY: all of one live device.
        let pipelines = unsafe { CachePipelines::new(device.raw(), layout, cache, prepared)? };
        let surface = self.surface_mut();
        // SAFETY: recording on the device that made everything, outside of a render pass.
        let filled = device.submit(|cmd| unsafe {
            surface.cmd_cache(device.raw(), cmd, layout, &pipelines, list)
        });
        if !device.is_hung() {
            // SAFETY: the submission has been waited for.
            unsafe { pipelines.destroy(device.raw()) };
        }
        filled.map(|_| ())
    }

    /// Draws everything at a cut, a pass after the other: what is captured does not tell which pass it belongs to.
    pub fn capture(&mut self, cut: Cut, fill: Fill) -> Result<Frame> {
        let list = self.draw_list(cut)?;
        let batches: Vec<Batch<'_>> = list.batches().collect();
        let mut all = Frame {
            passes: vec![Vec::new(); self.prepared().passes.len()],
            ..Default::default()
        };
        for batches in self.submissions(&batches) {
            let mut frame = self.draw(cut, fill, batches)?;
            all.passes[batches[0].pass()].append(&mut frame.passes[0]);
            all.counters.overflows += frame.counters.overflows;
            all.counters.points = all.counters.points.wrapping_add(frame.counters.points);
            all.differing += frame.differing;
            all.statistics = match (all.statistics, frame.statistics) {
                (Some(a), Some(b)) => Some(std::array::from_fn(|i| a[i] + b[i])),
                (a, b) => a.or(b),
            };
        }
        Ok(all)
    }

    /// Batches of one pass in a row, not too many for the capture.
    fn submissions<'b, 'l>(&self, batches: &'b [Batch<'l>]) -> Vec<&'b [Batch<'l>]> {
        let room = self.options.capture_vertices / 2;
        let mut submissions = Vec::new();
        let (mut start, mut vertices) = (0, 0);
        for (number, batch) in batches.iter().enumerate() {
            let other = batch.pass() != batches[start].pass();
            if number > start && (other || vertices + batch.vertices() > room) {
                submissions.push(&batches[start..number]);
                (start, vertices) = (number, 0);
            }
            vertices += batch.vertices();
        }
        if !batches.is_empty() {
            submissions.push(&batches[start..]);
        }
        submissions
    }

    /// Draws batches in one submission. All that is captured counts as one pass's.
    fn draw(&self, cut: Cut, fill: Fill, batches: &[Batch<'_>]) -> Result<Frame> {
        let Bench { device, target, .. } = self.bench;
        let counts = device.info().support.optional.pipeline_statistics_query;
        let query = counts.then(|| StatisticsQuery::new(device)).transpose()?;
        let (raw, prepared) = (device.raw(), self.prepared());
        self.bench.with_pipelines(
            prepared,
            (self.options.backend, self.options.residence),
            cut.spacing,
            fill,
            self.cull,
            |pipelines| {
                // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
                device.submit(|cmd| unsafe {
                    self.surface().cmd_prepare(raw, cmd, &[self.view])?;
                    if let Some(query) = &query {
                        query.cmd_reset(cmd);
                    }
                    target.begin(cmd, [0.0; 4]);
                    if let Some(query) = &query {
                        query.cmd_begin(cmd);
                    }
                    let drawn = self.cmd_draws(cmd, pipelines, batches);
                    if let Some(query) = &query {
                        query.cmd_end(cmd);
                    }
                    target.end(cmd);
                    self.surface().cmd_read_back(raw, cmd);
                    drawn
                })
            },
        )?;
        let expected = batches.iter().map(|batch| batch.vertices()).sum();
        let (captured, differing) = self.captured(expected)?;
        self.bench.saw(captured.len());
        let patches = batches.first().map_or(0, |batch| {
            let pass = &prepared.passes[batch.pass()];
            pass.patches.len()
        });
        // They stand in order.
        if let Some(last) = captured
            .last()
            .filter(|v| v.patch_number as usize >= patches)
        {
            let number = last.patch_number;
            return Err(Error::Refused(format!(
                "a vertex of patch {number} was captured, and there are {patches}"
            )));
        }
        Ok(Frame {
            passes: vec![captured],
            counters: self.surface().counters()?,
            statistics: query.map(|query| query.read()).transpose()?,
            differing,
        })
    }

    /// # Safety
    /// As [`TessellatedSurface::cmd_draw`].
    unsafe fn cmd_draws(
        &self,
        cmd: vk::CommandBuffer,
        pipelines: &Pipelines,
        batches: &[Batch<'_>],
    ) -> Result<()> {
        let (device, layout) = (self.bench.device.raw(), self.bench.layout());
        for (number, &batch) in batches.iter().enumerate() {
            // SAFETY: this function's contract; the target's pass allows the barrier. The first batch of a submission may be one that would
            // not wait; after another one it must.
            unsafe {
                if number > 0 && batch.ring_batch() == 0 {
                    ring::cmd_ring_barrier(device, cmd);
                }
                self.surface()
                    .cmd_draw(device, cmd, layout, pipelines, 0, batch)?;
            }
        }
        Ok(())
    }

    /// Draws everything at a cut into one picture: the alpha of its pixels, 0 where nothing is.
    pub fn picture(&mut self, cut: Cut) -> Result<Vec<u8>> {
        let list = self.draw_list(cut)?;
        let batches: Vec<Batch<'_>> = list.batches().collect();
        let Bench { device, target, .. } = self.bench;
        let (raw, prepared) = (device.raw(), self.prepared());
        self.bench.with_pipelines(
            prepared,
            (self.options.backend, self.options.residence),
            cut.spacing,
            Fill::Solid(Shading::Patch),
            self.cull,
            |pipelines| {
                // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
                device.submit(|cmd| unsafe {
                    self.surface().cmd_prepare(raw, cmd, &[self.view])?;
                    target.begin(cmd, [0.0; 4]);
                    let drawn = self.cmd_draws(cmd, pipelines, &batches);
                    target.end(cmd);
                    self.surface().cmd_read_back(raw, cmd);
                    target.cmd_copy_to_host(cmd);
                    drawn
                })
            },
        )?;
        match self.surface().counters()?.overflows {
            0 => {
                let alphas = target.read_pixels().iter().copied().skip(3).step_by(4);
                let alphas: Vec<u8> = alphas.collect();
                self.bench
                    .saw(alphas.iter().filter(|&&alpha| alpha != 0).count());
                Ok(alphas)
            }
            patches => Err(Error::Refused(format!("{patches} patches were left out"))),
        }
    }

    /// The captured vertices in order, each once, and how many came again with other bits: an evaluation shader may run more than once
    /// a vertex.
    fn captured(&self, expected: u32) -> Result<(Vec<Captured>, usize)> {
        let mut vertices = self.surface().captured()?.to_vec();
        let room = self.options.capture_vertices;
        if room > expected && vertices.len() >= room as usize {
            return Err(Error::Refused(format!(
                "more than {room} vertices came: the device runs evaluation shaders far too often"
            )));
        }
        vertices.sort_unstable_by_key(key);
        let mut differing = 0;
        vertices.dedup_by(|a, b| {
            let same = key(a) == key(b);
            differing += usize::from(same && bits(a) != bits(b));
            same
        });
        Ok((vertices, differing))
    }
}

impl Drop for Loaded<'_> {
    fn drop(&mut self) {
        let device = &self.bench.device;
        // A queue that hangs may still use everything.
        if let Some(surface) = self.surface.take().filter(|_| !device.is_hung()) {
            // SAFETY: every submission has been waited for.
            unsafe { surface.destroy(device.raw(), &mut device.allocator()) };
        }
    }
}

/// Options for capturing everything at a cut, with room for vertices that come several times.
pub fn capturing(context: &Context, prepared: &Prepared, cut: Cut) -> SurfaceOptions {
    SurfaceOptions {
        ring_bytes: context.settings.ring_bytes,
        slots: context.settings.slots,
        capture_vertices: vertices(prepared, cut)
            .saturating_mul(4)
            .clamp(1 << 14, MOST_CAPTURED),
        greatest_level: cut.level.max(1.0),
        ..Default::default()
    }
}

/// Prepares a model by a method, draws it at a cut with the context's settings, and captures everything.
pub fn captured(
    context: &Context,
    model: &Model,
    prepared: Prepared,
    cut: Cut,
    fill: Fill,
) -> Result<Frame> {
    let options = capturing(context, &prepared, cut);
    let workarounds = context.workarounds()?;
    let mut loaded = context
        .bench()?
        .load(model, prepared, &workarounds, options)?;
    loaded.capture(cut, fill)
}
