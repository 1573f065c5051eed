//! A model on a bench: drawn, captured and counted, submission by submission.

use std::ops::Range;

use ash::vk;

use super::frame::{Frame, vertex_bits, vertex_key};
use super::{Bench, Shot, Style};
use crate::abi::Captured;
use crate::error::{Error, Result};
use crate::frame::{Batch, Cut, Decides, Decision, DrawList, Residence, SurfaceOptions};
use crate::gpu::{
    CachePipelines, DecidePipeline, Decided, Fill, Pipelines, PointPipeline, TessellatedSurface,
    View, Workaround, ring,
};
use crate::host::Owned;
use crate::mesh::Model;
use crate::method::{DepthTags, Displacement, Prepared};

/// A prepared model on the device of a bench.
pub struct Loaded<'a> {
    bench: &'a Bench,
    surface: Owned<TessellatedSurface>,
    cache_pipelines: Option<Owned<CachePipelines>>,
    decide_pipeline: Option<Owned<DecidePipeline>>,
    /// What the device decides by, where it does.
    pub decision: Decision,
    /// What [`capture`](Self::capture) and [`picture`](Self::picture) show: at first everything from the side, within the picture and its depth.
    pub view: View,
    /// A depth for each control vertex, where levels of [`draw_list`](Self::draw_list) go by them.
    pub tags: Option<DepthTags>,
    /// Which triangles captures and pictures leave out.
    pub cull: vk::CullModeFlags,
}

impl Bench {
    /// Makes the buffers of a prepared model, for [`Loaded::upload`] to fill.
    ///
    /// # Errors
    /// As [`TessellatedSurface::new`].
    pub fn place(
        &self,
        model: &Model,
        prepared: Prepared,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<Loaded<'_>> {
        let (device, layout) = (self.device().raw(), self.layout());
        // SAFETY: all of one live device, which was opened with every feature that `Support` asks for.
        let surface = unsafe {
            let memory = &mut self.device().memory();
            TessellatedSurface::new(
                device,
                memory,
                layout,
                model,
                prepared,
                workarounds,
                options,
            )
        }?;
        // SAFETY: it was just made by this device.
        let surface = unsafe { Owned::new(self.device(), surface) };
        let cache = vk::PipelineCache::null();
        let cached = (options.residence == Residence::Cache)
            // SAFETY: all of one live device.
            .then(|| unsafe {
                let (prepared, from) = (surface.prepared(), self.modules());
                CachePipelines::with_modules(device, layout, cache, prepared, from)
            });
        // SAFETY: as above.
        let own = |pipelines| unsafe { Owned::new(self.device(), pipelines) };
        let cached = cached.transpose()?.map(own);
        let decides = (options.decides == Decides::Device)
            // SAFETY: as above.
            .then(|| unsafe { DecidePipeline::new(device, layout, cache) });
        // SAFETY: as above.
        let decides = decides
            .transpose()?
            .map(|made| unsafe { Owned::new(self.device(), made) });
        Ok(Loaded {
            bench: self,
            decide_pipeline: decides,
            decision: Decision::default(),
            cache_pipelines: cached,
            surface,
            view: from_the_side(model),
            tags: None,
            cull: vk::CullModeFlags::NONE,
        })
    }

    /// Brings a prepared model to the device, points computed by the host.
    ///
    /// # Errors
    /// As [`TessellatedSurface::new`].
    pub fn load(
        &self,
        model: &Model,
        prepared: Prepared,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<Loaded<'_>> {
        let mut loaded = self.place(model, prepared, workarounds, options)?;
        loaded.upload(false)?;
        Ok(loaded)
    }
}

/// A view of everything: limits and linear faces stay within the control points' hull, and what bulges out of it, within twice that.
fn from_the_side(model: &Model) -> View {
    let positions = model.positions();
    let farthest = positions.iter().map(|p| p.abs().max_element());
    let reach = 2.0 * farthest.fold(1e-30, f32::max);
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

impl Loaded<'_> {
    /// The surface.
    pub fn surface(&self) -> &TessellatedSurface {
        &self.surface
    }

    /// The surface, to be changed between submissions.
    pub fn surface_mut(&mut self) -> &mut TessellatedSurface {
        &mut self.surface
    }

    /// What was prepared.
    pub fn prepared(&self) -> &Prepared {
        self.surface.prepared()
    }

    /// Copies everything to the device, which computes points again if it is asked to.
    ///
    /// # Errors
    /// Vulkan's own.
    pub fn upload(&mut self, points_on_device: bool) -> Result<()> {
        let device = self.bench.device();
        let points = points_on_device
            .then(|| self.point_pipeline())
            .transpose()?;
        device.submit(|cmd| {
            // SAFETY: recording on the device that made everything, outside of a render pass; the upload makes control vertices visible.
            unsafe {
                self.surface.cmd_upload(device.raw(), cmd);
                if let Some(pipeline) = &points {
                    let layout = self.bench.layout();
                    self.surface.cmd_points(device.raw(), cmd, layout, pipeline);
                }
            }
            Ok(())
        })?;
        // SAFETY: the upload has been waited for.
        unsafe {
            self.surface
                .finish_upload(device.raw(), &mut device.memory());
        }
        Ok(())
    }

    /// What computes points on the device.
    ///
    /// # Errors
    /// As [`PointPipeline::new`].
    pub fn point_pipeline(&self) -> Result<Owned<PointPipeline>> {
        let (device, layout) = (self.bench.device(), self.bench.layout());
        // SAFETY: the device is live, the layout its own.
        let made = unsafe { PointPipeline::new(device.raw(), layout, vk::PipelineCache::null()) };
        // SAFETY: it was just made by this device.
        made.map(|pipeline| unsafe { Owned::new(device, pipeline) })
    }

    /// Replaces the positions, and brings them to the device with what the host computes from them.
    ///
    /// # Errors
    /// As [`TessellatedSurface::write_positions`]; Vulkan's own.
    pub fn replace_positions(&mut self, positions: &[[f32; 3]]) -> Result<()> {
        self.surface.write_positions(positions)?;
        self.upload(false)
    }

    /// What is drawn at a cut, with what the host decides about patches on the device, and control points in their cache.
    ///
    /// # Errors
    /// As [`TessellatedSurface::draw_list`], [`TessellatedSurface::write_draws`] and [`TessellatedSurface::cmd_cache`].
    pub fn draw_list(&mut self, cut: Cut) -> Result<DrawList> {
        let list = self.surface.draw_list(cut, self.tags.as_ref())?;
        self.bring(&list)?;
        self.cache(&list)?;
        Ok(list)
    }

    /// Brings to the device what the host decided about patches, unless it was the last to be brought.
    ///
    /// # Errors
    /// As [`TessellatedSurface::write_draws`].
    pub fn bring(&mut self, list: &DrawList) -> Result<()> {
        let device = self.bench.device();
        let memory = &mut device.memory();
        // SAFETY: device and memory made the surface; every submission has been waited for.
        unsafe { self.surface.write_draws(device.raw(), memory, list) }
    }

    /// Computes the control points that a list needs and no cache has, where they are cached: how many these are. In a submission of its own.
    ///
    /// # Errors
    /// As [`TessellatedSurface::cmd_cache`].
    pub fn cache(&mut self, list: &DrawList) -> Result<u32> {
        match &self.cache_pipelines {
            None => Ok(0),
            Some(_) => self.cache_after(list, |_| {}),
        }
    }

    /// As [`cache`](Self::cache), after what else `before` records.
    ///
    /// # Errors
    /// As there.
    pub fn cache_after(
        &mut self,
        list: &DrawList,
        before: impl FnOnce(vk::CommandBuffer),
    ) -> Result<u32> {
        let (device, layout) = (self.bench.device(), self.bench.layout());
        let (surface, pipelines) = (&mut self.surface, self.cache_pipelines.as_ref());
        device.submit(|cmd| {
            before(cmd);
            // SAFETY: recording on the device that made everything, outside of a render pass.
            let fill = |pipelines: &Owned<CachePipelines>| unsafe {
                surface.cmd_cache(device.raw(), cmd, layout, pipelines, list)
            };
            pipelines.map_or(Ok(0), fill)
        })
    }

    /// Draws into the target of the bench and copies the picture to the host. What counts, by the control shaders and by the device's statistics, is the
    /// first shot, of which the counters are read with the others'.
    ///
    /// # Errors
    /// As [`TessellatedSurface::cmd_draw`].
    pub fn draw(&self, shots: &[Shot<'_>]) -> Result<Option<[u64; 3]>> {
        self.draw_between(shots, |_| {}, |_| {})
    }

    /// As [`draw`](Self::draw), between what else is recorded.
    ///
    /// # Errors
    /// As there.
    pub fn draw_between(
        &self,
        shots: &[Shot<'_>],
        before: impl FnOnce(vk::CommandBuffer),
        after: impl FnOnce(vk::CommandBuffer),
    ) -> Result<Option<[u64; 3]>> {
        let target = self.bench.target();
        let query = self.bench.statistics.as_ref();
        let views = shots
            .iter()
            .flat_map(|shot| vec![shot.view; shot.instances as usize]);
        let views: Vec<View> = views.collect();
        let device = self.bench.device();
        // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
        device.submit(|cmd| unsafe {
            before(cmd);
            self.surface.cmd_prepare(device.raw(), cmd, &views)?;
            self.cmd_decide(cmd, shots)?;
            if let Some(query) = query {
                query.cmd_reset(cmd);
            }
            target.begin(cmd, [0.0; 4]);
            let mut first = 0;
            for (number, shot) in (0..).zip(shots) {
                let query = query.filter(|_| number == 0);
                let views = first..first + shot.instances;
                first = views.end;
                if let Some(query) = query {
                    self.cmd_bind(cmd, shot.pipelines);
                    query.cmd_begin(cmd);
                }
                self.cmd_draws(cmd, views, shot)?;
                if let Some(query) = query {
                    query.cmd_end(cmd);
                }
            }
            target.end(cmd);
            self.surface.cmd_read_back(device.raw(), cmd);
            target.cmd_copy_to_host(cmd);
            after(cmd);
            Ok(())
        })?;
        query.map(|query| query.read()).transpose()
    }

    /// Binds a pipeline, whichever: see [`Remedy::PipelineBeforeQuery`](crate::gpu::Remedy::PipelineBeforeQuery).
    ///
    /// # Safety
    /// `cmd` is recording on the device of the pipelines, which live until it has been executed.
    unsafe fn cmd_bind(&self, cmd: vk::CommandBuffer, pipelines: &Pipelines) {
        if let Some(pipeline) = pipelines.get(0) {
            let graphics = vk::PipelineBindPoint::GRAPHICS;
            // SAFETY: this function's contract.
            unsafe {
                self.bench
                    .device()
                    .raw()
                    .cmd_bind_pipeline(cmd, graphics, pipeline)
            };
        }
    }

    /// Where the device decides, it does so for all shots, whose lists have one cut.
    ///
    /// # Safety
    /// `cmd` is recording, after `cmd_prepare`, outside of a render pass.
    unsafe fn cmd_decide(&self, cmd: vk::CommandBuffer, shots: &[Shot<'_>]) -> Result<()> {
        let (device, layout) = (self.bench.device().raw(), self.bench.layout());
        let list = shots.iter().flat_map(|shot| &shot.batches).next();
        let Some((pipeline, batch)) = self.decide_pipeline.as_ref().zip(list) else {
            return Ok(());
        };
        let decided = Decided {
            views: 0..shots.iter().map(|shot| shot.instances).sum(),
            eyes: 1,
        };
        let (surface, decision) = (&self.surface, &self.decision);
        // SAFETY: this function's contract; all of one device.
        unsafe {
            surface.cmd_decide(
                device,
                cmd,
                layout,
                pipeline,
                batch.list(),
                decision,
                &decided,
            )
        }
    }

    /// Between two batches that do not know of each other (each is the first to use the ring) there is a barrier; and where the surface records
    /// none itself, between all that share the ring.
    ///
    /// # Safety
    /// As [`TessellatedSurface::cmd_draw`].
    unsafe fn cmd_draws(
        &self,
        cmd: vk::CommandBuffer,
        views: Range<u32>,
        shot: &Shot<'_>,
    ) -> Result<()> {
        let (device, layout) = (self.bench.device().raw(), self.bench.layout());
        let own_barriers = self.surface.options().barriers;
        for (number, &batch) in shot.batches.iter().enumerate() {
            let first = batch.points() > 0 && batch.ring_batch() == 0;
            let waits = first || !own_barriers && batch.waits();
            // SAFETY: this function's contract; the target's pass allows the barrier.
            unsafe {
                if number > 0 && waits {
                    ring::cmd_ring_barrier(device, cmd);
                }
                let pipelines = shot.pipelines;
                self.surface
                    .cmd_draw(device, cmd, layout, pipelines, views.clone(), batch)?;
            }
        }
        Ok(())
    }

    /// Draws batches of one pass in one submission. All that is captured counts as one pass's.
    ///
    /// # Errors
    /// As [`draw`](Self::draw) and [`captured`](Self::captured).
    pub fn draw_batches(&self, cut: Cut, fill: Fill, batches: &[Batch<'_>]) -> Result<Frame> {
        let pipelines = self
            .bench
            .pipelines(self.prepared(), self.style(cut, fill))?;
        let shot = Shot {
            pipelines: &pipelines,
            view: self.view,
            instances: 1,
            batches: batches.to_vec(),
        };
        let statistics = self.draw(&[shot])?;
        let expected = batches.iter().map(|batch| batch.vertices()).sum();
        let (captured, differing) = self.captured(expected)?;
        let patches = batches.first().map_or(0, |batch| {
            let pass = &self.prepared().passes[batch.pass()];
            pass.patches.len()
        });
        // They stand in order.
        let last = captured.last().map(|vertex| vertex.patch_number);
        if let Some(number) = last.filter(|&number| number as usize >= patches) {
            return Err(Error::Refused(format!(
                "the device captured a vertex of patch {number}, and there are {patches}; choose another device, or update its driver"
            )));
        }
        Ok(Frame {
            passes: vec![captured],
            counters: self.surface.counters()?,
            statistics,
            differing,
        })
    }

    fn style(&self, cut: Cut, fill: Fill) -> Style {
        Style {
            cull: self.cull,
            ..Style::new(self.surface.options(), cut.spacing, fill)
        }
    }

    /// Draws everything at a cut, a pass after the other: what is captured does not tell which pass it belongs to.
    ///
    /// # Errors
    /// As [`draw_list`](Self::draw_list) and [`draw_batches`](Self::draw_batches).
    pub fn capture(&mut self, cut: Cut, fill: Fill) -> Result<Frame> {
        let list = self.draw_list(cut)?;
        let batches: Vec<Batch<'_>> = list.batches().collect();
        let mut all = Frame {
            passes: vec![Vec::new(); self.prepared().passes.len()],
            ..Default::default()
        };
        let room = self.surface.options().capture_vertices / 2;
        for batches in submissions(&batches, room) {
            let frame = self.draw_batches(cut, fill, batches)?;
            all.add(frame, batches[0].pass());
        }
        Ok(all)
    }

    /// Draws everything at a cut into one picture: its pixels, RGBA.
    ///
    /// # Errors
    /// As [`draw_list`](Self::draw_list) and [`draw`](Self::draw); [`Error::Refused`] when patches found no room in the ring.
    pub fn picture(&mut self, cut: Cut, fill: Fill) -> Result<&[u8]> {
        let list = self.draw_list(cut)?;
        let pipelines = self
            .bench
            .pipelines(self.prepared(), self.style(cut, fill))?;
        self.draw(&[Shot {
            pipelines: &pipelines,
            view: self.view,
            instances: 1,
            batches: list.batches().collect(),
        }])?;
        match self.surface.counters()?.overflows {
            0 => Ok(self.bench.target().read_pixels()),
            patches => Err(Error::Refused(format!("{patches} patches were left out"))),
        }
    }

    /// The captured vertices in order, each once, and how many came again with other bits: an evaluation shader may run more than once a vertex.
    ///
    /// # Errors
    /// As [`TessellatedSurface::captured`]; [`Error::Refused`] when more came than there is room for, where there is for those that are expected.
    pub fn captured(&self, expected: u32) -> Result<(Vec<Captured>, usize)> {
        let mut vertices = self.surface.captured()?.to_vec();
        let room = self.surface.options().capture_vertices;
        if room > expected && vertices.len() >= room as usize {
            return Err(Error::Refused(format!(
                "more than {room} vertices came: the device runs evaluation shaders far too often"
            )));
        }
        vertices.sort_unstable_by_key(vertex_key);
        let mut differing = 0;
        vertices.dedup_by(|a, b| {
            let same = vertex_key(a) == vertex_key(b);
            differing += usize::from(same && vertex_bits(a) != vertex_bits(b));
            same
        });
        Ok((vertices, differing))
    }
}

/// Batches of one pass in a row, not too many for the capture.
fn submissions<'b, 'l>(batches: &'b [Batch<'l>], room: u32) -> Vec<&'b [Batch<'l>]> {
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
