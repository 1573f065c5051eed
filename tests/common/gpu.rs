//! A model on whatever Vulkan device there is, drawn and captured through the library's public interface.

mod cuts;
mod poses;

use std::cell::{Cell, RefCell};
use std::collections::HashMap;

use ash::vk;
use hullform::abi::Captured;
use hullform::gpu::{
    Backend, Batch, CachePipelines, Counters, Cut, DrawList, Fill, Layout, Pipelines,
    PointPipeline, Residence, SurfaceOptions, Target, TessellatedSurface, View, Workaround, ring,
};
use hullform::host::{Device, Encoding, Instance, OffscreenTarget, StatisticsQuery};
use hullform::mesh::Model;
use hullform::method::{DepthTags, Displacement, Prepared};
use hullform::tessellation::Spacing;
use hullform::{Error, Result};

use cuts::key;
pub use cuts::{SPACINGS, bits, capturing, cut, over_patches, prepare, vertices};

/// The side of the picture that everything is drawn into.
pub const SIDE: u32 = 64;

/// What pipelines depend on here: the shaders of the passes, who cuts, spacing, what becomes of the triangles and which are left out.
type PipelineKey = (
    Vec<&'static str>,
    (Backend, Residence),
    Spacing,
    &'static str,
    vk::CullModeFlags,
);

/// A validated device with all that surfaces share. [`Gpu::finish`] ends it.
pub struct Gpu {
    instance: Instance,
    pub device: Device,
    layout: Option<Layout>,
    target: Option<OffscreenTarget>,
    pipelines: RefCell<HashMap<PipelineKey, Pipelines>>,
    /// What pipelines that are built from now on leave out.
    pub cull: Cell<vk::CullModeFlags>,
}

impl Gpu {
    /// The device, or `None` (with a line that says so) where there is no Vulkan, or no validation layer, to test with.
    pub fn open() -> Option<Gpu> {
        let opened =
            Instance::new(true).and_then(|instance| Ok((Device::open(&instance, None)?, instance)));
        let (device, instance) = match opened {
            Ok(opened) => opened,
            Err(error @ (Error::NoDevice(_) | Error::Option { .. })) => {
                println!("skipped: {error}");
                return None;
            }
            Err(error) => panic!("{error}"),
        };
        // SAFETY: the device is live.
        let layout = unsafe { Layout::new(device.raw(), device.enabled()) };
        let layout = layout.expect("every device has such layouts");
        let target = OffscreenTarget::with_encoding(&device, SIDE, SIDE, 1, Encoding::Unorm);
        Some(Gpu {
            instance,
            target: Some(target.expect("a small picture fits every device")),
            device,
            layout: Some(layout),
            pipelines: RefCell::default(),
            cull: Cell::new(vk::CullModeFlags::NONE),
        })
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
        let allocator = &mut self.device.allocator();
        let layout = self.layout();
        // SAFETY: all of one live device, which was opened with every feature that `Support` asks for.
        let surface = unsafe {
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
            gpu: self,
            options,
            reach: reach(model),
            displacement: Displacement::default(),
            tags: None,
            surface: Some(surface?),
        };
        self.device.submit(|cmd| {
            // SAFETY: recording on the device that made the surface, outside of a render pass.
            unsafe { loaded.surface_mut().cmd_upload(device, cmd) };
            Ok(())
        })?;
        // SAFETY: the upload has been waited for.
        unsafe { loaded.surface_mut().finish_upload(device, allocator) };
        Ok(loaded)
    }

    /// Closes the device and expects that the validation layer never had anything to say.
    pub fn finish(mut self) {
        for (_, pipelines) in self.pipelines.take() {
            // SAFETY: every submission has been waited for.
            unsafe { pipelines.destroy(self.device.raw()) };
        }
        if let Some(layout) = self.layout.take() {
            // SAFETY: as above.
            unsafe { layout.destroy(self.device.raw()) };
        }
        let instance = self.instance.clone();
        drop(self);
        let messages = instance.validation_messages();
        assert!(messages.is_empty(), "{}", messages.join("\n"));
    }

    pub fn layout(&self) -> &Layout {
        self.layout.as_ref().expect("there until it is finished")
    }

    pub fn target(&self) -> &OffscreenTarget {
        self.target.as_ref().expect("there until it is finished")
    }

    /// Pipelines that the caller destroys.
    pub fn build(
        &self,
        prepared: &Prepared,
        (backend, residence): (Backend, Residence),
        spacing: Spacing,
        fill: Fill,
        compare: vk::CompareOp,
    ) -> Pipelines {
        let target = Target {
            render_pass: self.target().render_pass(),
            samples: self.target().samples(),
            cull: self.cull.get(),
            compare,
        };
        let (device, cache) = (self.device.raw(), vk::PipelineCache::null());
        // SAFETY: all of one live device.
        let built = unsafe {
            Pipelines::new(
                device,
                self.layout(),
                cache,
                prepared,
                target,
                backend,
                residence,
                spacing,
                fill,
            )
        };
        built.expect("the shipped modules make pipelines")
    }

    /// Lets `use_them` use the pipelines for a prepared model, which are built once.
    fn with_pipelines<T>(
        &self,
        prepared: &Prepared,
        makers: (Backend, Residence),
        spacing: Spacing,
        fill: Fill,
        use_them: impl FnOnce(&Pipelines) -> T,
    ) -> T {
        let shaders = prepared.passes.iter().map(|pass| pass.shader).collect();
        let fill_name = match fill {
            Fill::Solid(_) => "solid",
            Fill::Lines => "lines",
            Fill::Depth => "depth",
            Fill::Discard => "discard",
        };
        let mut all = self.pipelines.borrow_mut();
        let pipelines = all
            .entry((shaders, makers, spacing, fill_name, self.cull.get()))
            .or_insert_with(|| {
                let compare = vk::CompareOp::LESS_OR_EQUAL;
                self.build(prepared, makers, spacing, fill, compare)
            });
        use_them(pipelines)
    }
}

/// Half of what a picture must show, so that no triangle is clipped: limits and linear faces stay within the control points' hull, and what
/// bulges out of it, within twice that.
fn reach(model: &Model) -> f32 {
    let positions = model.positions();
    let farthest = positions
        .iter()
        .map(|position| position.abs().max_element());
    2.0 * farthest.fold(1e-30, f32::max)
}

/// A model on the device.
pub struct Loaded<'a> {
    gpu: &'a Gpu,
    options: SurfaceOptions,
    reach: f32,
    pub displacement: Displacement,
    /// A depth for each control vertex, where levels go by them.
    pub tags: Option<DepthTags>,
    surface: Option<TessellatedSurface>,
}

/// What a submission, or one a pass, gave.
#[derive(Default)]
pub struct Frame {
    /// Captured vertices, a list a pass; each by patch, v and u, once.
    pub passes: Vec<Vec<Captured>>,
    /// What the control shaders counted.
    pub counters: Counters,
    /// Control shader patches, evaluation shader invocations, clipping primitives; where the device counts them.
    pub statistics: Option<[u64; 3]>,
}

impl Loaded<'_> {
    pub fn surface(&self) -> &TessellatedSurface {
        self.surface.as_ref().expect("there from load to drop")
    }

    pub fn surface_mut(&mut self) -> &mut TessellatedSurface {
        self.surface.as_mut().expect("there from load to drop")
    }

    pub fn prepared(&self) -> &Prepared {
        self.surface().prepared()
    }

    /// What is drawn at a cut, with what the host decides about it on the device.
    pub fn draw_list(&mut self, cut: Cut) -> Result<DrawList> {
        let list = self.surface().draw_list(cut, self.tags.as_ref())?;
        let device = &self.gpu.device;
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
            all.counters.points += frame.counters.points;
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
        submissions.push(&batches[start..]);
        submissions
    }

    /// Draws batches in one submission. All that is captured counts as one pass's.
    ///
    /// Between two that do not know of each other (each is the first to use the ring, or they share a counter) there is a barrier.
    pub fn draw(&self, cut: Cut, fill: Fill, batches: &[Batch<'_>]) -> Result<Frame> {
        let gpu = self.gpu;
        let device = gpu.device.raw();
        let counts = gpu.device.info().support.optional.pipeline_statistics_query;
        let query = counts
            .then(|| StatisticsQuery::new(&gpu.device))
            .transpose()?;
        gpu.with_pipelines(
            self.prepared(),
            (self.options.backend, self.options.residence),
            cut.spacing,
            fill,
            |pipelines| {
                // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
                gpu.device.submit(|cmd| unsafe {
                    self.surface().cmd_prepare(device, cmd, &[self.view()])?;
                    if let Some(query) = &query {
                        query.cmd_reset(cmd);
                    }
                    gpu.target().begin(cmd, [0.0; 4]);
                    if let Some(query) = &query {
                        query.cmd_begin(cmd);
                    }
                    let drawn = self.cmd_draws(cmd, pipelines, batches);
                    if let Some(query) = &query {
                        query.cmd_end(cmd);
                    }
                    gpu.target().end(cmd);
                    self.surface().cmd_read_back(device, cmd);
                    gpu.target().cmd_copy_to_host(cmd);
                    drawn
                })
            },
        )?;
        Ok(Frame {
            passes: vec![self.captured()],
            counters: self.surface().counters()?,
            statistics: query.map(|query| query.read()).transpose()?,
        })
    }

    /// Draws with some pipelines after the other into one picture, each time all batches of a list, displaced.
    pub fn draw_over(&self, list: &DrawList, all: &[(&Pipelines, Displacement)]) -> Vec<u8> {
        let gpu = self.gpu;
        let device = gpu.device.raw();
        let views = all.iter().map(|&(_, displacement)| View {
            displacement,
            ..self.view()
        });
        let views: Vec<View> = views.collect();
        // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
        let drawn = gpu.device.submit(|cmd| unsafe {
            self.surface().cmd_prepare(device, cmd, &views)?;
            gpu.target().begin(cmd, [0.0; 4]);
            for (round, &(pipelines, _)) in (0..).zip(all) {
                for batch in list.round(round)? {
                    let (surface, layout) = (self.surface(), gpu.layout());
                    surface.cmd_draw(device, cmd, layout, pipelines, round, batch)?;
                }
            }
            gpu.target().end(cmd);
            gpu.target().cmd_copy_to_host(cmd);
            Ok(())
        });
        drawn.expect("it is executed");
        self.pixels()
    }

    /// # Safety
    /// As `TessellatedSurface::cmd_draw`.
    unsafe fn cmd_draws(
        &self,
        cmd: vk::CommandBuffer,
        pipelines: &Pipelines,
        batches: &[Batch<'_>],
    ) -> Result<()> {
        let device = self.gpu.device.raw();
        for (number, &batch) in batches.iter().enumerate() {
            // SAFETY: this function's contract; the target's pass allows the barrier.
            unsafe {
                let alone = !self.options.barriers && batch.waits();
                if number > 0 && (batch.ring_batch() == 0 || alone) {
                    ring::cmd_ring_barrier(device, cmd);
                }
                let layout = self.gpu.layout();
                self.surface()
                    .cmd_draw(device, cmd, layout, pipelines, 0, batch)?;
            }
        }
        Ok(())
    }

    /// From the side, everything within the picture and its depth.
    fn view(&self) -> View {
        let scale = 0.99 / self.reach;
        View {
            clip_from_model: [
                [scale, 0.0, 0.0, 0.0],
                [0.0, -scale, 0.0, 0.0],
                [0.0, 0.0, -0.5 * scale, 0.0],
                [0.0, 0.0, 0.5, 1.0],
            ],
            eye: [0.0, 0.0, 10.0 * self.reach],
            displacement: self.displacement,
        }
    }

    /// The picture of the last draw, four bytes a pixel.
    pub fn pixels(&self) -> Vec<u8> {
        self.gpu.target().read_pixels().to_vec()
    }

    /// The captured vertices in order, each once: an evaluation shader may run more than once a vertex, with the same result.
    fn captured(&self) -> Vec<Captured> {
        let mut vertices = self
            .surface()
            .captured()
            .expect("it was read back")
            .to_vec();
        let room = self.options.capture_vertices as usize;
        assert!(room == 0 || vertices.len() < room, "the capture is full");
        vertices.sort_unstable_by_key(key);
        vertices.dedup_by(|a, b| {
            let same = key(a) == key(b);
            assert!(
                !same || bits(a) == bits(b),
                "two runs, two results: {a:?} {b:?}"
            );
            same
        });
        vertices
    }
}

impl Drop for Loaded<'_> {
    fn drop(&mut self) {
        let device = &self.gpu.device;
        // A queue that hangs may still use everything.
        if let Some(surface) = self.surface.take().filter(|_| !device.is_hung()) {
            // SAFETY: every submission has been waited for.
            unsafe { surface.destroy(device.raw(), &mut device.allocator()) };
        }
    }
}
