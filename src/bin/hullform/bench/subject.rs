//! A model on the device by a method, drawn again and again at some levels.

use std::path::Path;
use std::rc::Rc;

use ash::vk;
use hullform::gpu::{
    Backend, Batch, Cut, Decides, DrawList, Fill, Outcome, Pipelines, PointPipeline, Residence,
    SurfaceOptions, View,
};
use hullform::host::{Bench, Owned, Shot, Style, TimestampQuery};
use hullform::mesh::Model;
use hullform::method::{Displacement, Prepared};
use hullform::{Error, Result};

use super::Arguments;
use super::row::{Row, Work};
use crate::adaptive::{Adaptive, Seen};
use crate::drawing::{self, Drawing};
use crate::gpu::Gpu;
use crate::options::{Global, Size};

/// What is drawn at several levels, each with its times. Triangles are made and thrown away: what they cover costs all methods the same.
pub struct Subject<'a> {
    gpu: &'a Gpu,
    bench: &'a Bench,
    model: String,
    method: &'static str,
    backend: Backend,
    residence: Residence,
    is_static: bool,
    passes: u32,
    instances: Instances,
    ring_bytes: u64,
    device_bytes: u64,
    drawing: Drawing<'a>,
    pipelines: Rc<Owned<Pipelines>>,
    view: View,
    clock: Option<TimestampQuery>,
    /// What computes points from the control vertices in each frame; None where nothing moves, or there are none.
    points: Option<Owned<PointPipeline>>,
    /// Whether the device tells if frames are whole. Elsewhere the shaders do, and all methods bear an atomic operation a vertex.
    device_counts: bool,
    levels: Vec<Level>,
}

/// How instances are drawn.
#[derive(Clone, Copy)]
struct Instances {
    /// How many a draw has: all of them, but one where it fills the ring.
    a_draw: u32,
    /// How many draws of each batch that takes in a pass.
    draws: u32,
}

/// A level, and what its frames took and did.
struct Level {
    list: DrawList,
    work: Option<Work>,
    cpu: Vec<f64>,
    gpu: Vec<f64>,
}

impl<'a> Subject<'a> {
    /// Brings a model to the device, as a method prepared it for these levels.
    #[allow(clippy::too_many_arguments)]
    pub fn new(
        gpu: &'a Gpu,
        bench: &'a Bench,
        path: &Path,
        model: &Model,
        prepared: Prepared,
        (method, backend, residence): (&'static str, Backend, Residence),
        levels: &[f32],
        arguments: &Arguments,
        global: &Global,
    ) -> Result<Subject<'a>> {
        let in_ring = residence == Residence::Ring
            && prepared.passes.iter().any(|pass| pass.cached.is_some());
        let instances = match in_ring {
            true => Instances {
                a_draw: 1,
                draws: arguments.instances,
            },
            false => Instances {
                a_draw: arguments.instances,
                draws: 1,
            },
        };
        let greatest = levels.iter().copied().fold(1.0, f32::max);
        let device_counts = gpu.device.info().support.optional.pipeline_statistics_query
            && backend == Backend::Tessellator;
        let slots = drawing::slots(global.slots);
        let decides = arguments.wanted();
        let decides = decides.decides((backend, arguments.is_dynamic()), slots, greatest)?;
        let options = SurfaceOptions {
            backend,
            residence,
            decides,
            count_vertices: !device_counts && decides == Decides::Host,
            ring_bytes: global.ring_bytes,
            slots,
            greatest_level: greatest,
            rounds: arguments.passes * instances.draws,
            views: instances.a_draw,
            ..SurfaceOptions::default()
        };
        let before = gpu.device.allocated_bytes();
        let mut drawing = Drawing::new(gpu, bench, model, prepared, options, global.points)?;
        let device_bytes = gpu.device.allocated_bytes() - before;
        let view = match decides {
            Decides::Host => drawing::nowhere(),
            Decides::Device => {
                let seen = seen(model, arguments);
                let (outline, vertices) = (&drawing.prepared().outline, model.positions());
                drawing.decision = arguments.wanted().decision(outline, &vertices, seen, 1)?;
                View {
                    clip_from_model: seen.clip_from_model.to_cols_array_2d(),
                    eye: seen.eye.to_array(),
                    displacement: Displacement::default(),
                }
            }
        };
        let spacing = arguments.spacing.into();
        let style = Style::new(options, spacing, Fill::Discard);
        let list = |&level: &f32| {
            let cut = Cut { level, spacing };
            // Whom the device decides for has no tags.
            let adaptive = arguments.adaptive.filter(|_| decides == Decides::Host);
            let tags = |adaptive: Adaptive| {
                let outline = &drawing.prepared().outline;
                adaptive.tags(outline, &model.positions(), level, seen(model, arguments))
            };
            let tags = adaptive.map(tags).transpose()?;
            Ok(Level {
                list: drawing.surface().draw_list(cut, tags.as_ref())?,
                work: None,
                cpu: Vec::new(),
                gpu: Vec::new(),
            })
        };
        let computes = !arguments.is_static && drawing.prepared().points.count > 0;
        let points = computes.then(|| drawing.point_pipeline()).transpose()?;
        let levels = levels.iter().map(list).collect::<Result<_>>()?;
        Ok(Subject {
            gpu,
            bench,
            model: model_name(path),
            method,
            backend,
            residence,
            is_static: arguments.is_static,
            passes: arguments.passes,
            instances,
            ring_bytes: match residence {
                Residence::Ring => global.ring_bytes,
                Residence::Cache => 0,
            },
            device_bytes,
            pipelines: bench.pipelines(drawing.prepared(), style)?,
            view,
            drawing,
            clock: TimestampQuery::new(&gpu.device)?,
            points,
            device_counts,
            levels,
        })
    }

    /// Draws a frame of each level. The first ones warm up.
    pub fn draw(&mut self) -> Result<()> {
        for number in 0..self.levels.len() {
            self.drawing.bring(&self.levels[number].list)?;
            let before = cpu_seconds();
            let (cached, counted) = self.submit(number)?;
            let after = cpu_seconds();
            let work = self.work(number, cached, counted)?;
            let level = &mut self.levels[number];
            if level.work.replace(work).is_none() {
                continue;
            }
            let spent = before.zip(after).map(|(before, after)| after - before);
            level.cpu.extend(spent);
            if let Some(clock) = &self.clock {
                level.gpu.push(clock.read()?);
            }
        }
        Ok(())
    }

    /// Draws a frame, with the points that the method computes before; how many control points it brought into the cache, and what the device counted.
    fn submit(&mut self, number: usize) -> Result<(u32, Option<[u64; 3]>)> {
        let list = &self.levels[number].list;
        if !self.is_static {
            self.drawing.surface_mut().positions_changed();
        }
        let clock = self.clock.as_ref();
        let begin = |cmd| {
            if let Some(clock) = clock {
                // SAFETY: recording on the query's device, outside of a render pass.
                unsafe { clock.cmd_begin(cmd) };
            }
        };
        let end = |cmd| {
            if let Some(clock) = clock {
                // SAFETY: as above, after the beginning.
                unsafe { clock.cmd_end(cmd) };
            }
        };
        // In a submission of its own, as `render` does it.
        let fills = !self.drawing.surface().is_cached(list);
        let cached = match (fills, &self.points) {
            (true, _) => self.drawing.cache_after(list, begin)?,
            (_, Some(pipeline)) => {
                self.compute_points(pipeline, list, begin)?;
                0
            }
            (false, None) => 0,
        };
        let begun = fills || self.points.is_some();
        let mut batches = Vec::new();
        for round in 0..self.rounds() {
            batches.extend(list.round(round)?);
        }
        let shot = Shot {
            pipelines: &self.pipelines,
            view: self.view,
            instances: self.instances.a_draw,
            batches,
        };
        let begin = |cmd| {
            if !begun {
                begin(cmd);
            }
        };
        let counted = self.drawing.draw_between(&[shot], begin, end)?;
        Ok((cached, counted))
    }

    /// Computes the points that a list needs, after what else is recorded: in a submission of its own, as above.
    fn compute_points(
        &self,
        pipeline: &PointPipeline,
        list: &DrawList,
        begin: impl FnOnce(vk::CommandBuffer),
    ) -> Result<()> {
        let (device, layout) = (&self.gpu.device, self.bench.layout());
        device.submit(|cmd| {
            begin(cmd);
            // SAFETY: recording on the device that made everything, outside of a render pass; control vertices are there since the upload.
            unsafe {
                let surface = self.drawing.surface();
                surface.cmd_points_of(device.raw(), cmd, layout, pipeline, list);
            }
            Ok(())
        })
    }

    /// How often a frame draws each batch.
    fn rounds(&self) -> u32 {
        self.passes * self.instances.draws
    }

    /// What the frame just drawn did. One of which something is missing would be a fast one, and is refused.
    fn work(&self, number: usize, cached: u32, counted: Option<[u64; 3]>) -> Result<Work> {
        let list = &self.levels[number].list;
        let batches = || {
            (0..self.rounds())
                .filter_map(|round| list.round(round).ok())
                .flatten()
        };
        // Once for each instance.
        let drawn = || (0..self.instances.a_draw).flat_map(|_| batches());
        let counters = self.drawing.surface().counters()?;
        if counters.overflows > 0 {
            return Err(Error::Refused(format!(
                "{} patches found no room in the ring; give it more --ring-bytes, or --slots host",
                counters.overflows
            )));
        }
        let decided = self.decided(list)?;
        let predicted = decided.vertices;
        let evaluations = match counted.filter(|_| self.device_counts) {
            Some([_, evaluations, _]) => evaluations,
            None => {
                if self.drawing.surface().options().count_vertices {
                    self.drawing.surface().arrival(drawn())?.check()?;
                }
                predicted
            }
        };
        if evaluations < predicted {
            let missing = predicted - evaluations;
            let what = format!("{missing} of {predicted} vertices of a frame");
            return Err(Error::Lost { what });
        }
        let products = match self.residence {
            Residence::Ring => decided.products,
            Residence::Cache if cached > 0 => self.cached_products(list),
            Residence::Cache => 0,
        };
        let [computed, terms] = match self.points {
            Some(_) => list.computed(self.drawing.prepared()),
            None => [0; 2],
        };
        Ok(Work {
            evaluations,
            control_patches: counted
                .filter(|_| self.device_counts)
                .map(|[patches, ..]| patches),
            points: u64::from(counters.points) + u64::from(cached) + computed,
            products: products + terms,
            draws: batches().map(|batch| self.draws(batch)).sum(),
            barriers: batches()
                .filter(|&batch| batch.waits() && self.draws(batch) > 0)
                .count() as u64,
            decided,
        })
    }

    /// How often something is drawn of a batch: of those that the device makes of what it decides some may be left over, in the view of the round or, without a ring, in all.
    fn draws(&self, batch: Batch<'_>) -> u64 {
        let surface = self.drawing.surface();
        if surface.options().decides == Decides::Host {
            return batch.draws().len() as u64;
        }
        let drawing = surface.drawing();
        let mut views = 0..self.instances.a_draw;
        u64::from(views.any(|view| !drawing.slot.drawn(batch, view).is_empty()))
    }

    /// What was decided about all patches, by the host or the device, each time that they were drawn.
    fn decided(&self, list: &DrawList) -> Result<Outcome> {
        let (surface, views) = (self.drawing.surface(), self.instances.a_draw);
        if surface.options().decides == Decides::Device {
            return Ok(surface
                .outcome(list, 0..views)?
                .times(u64::from(self.rounds())));
        }
        let prepared = self.drawing.prepared();
        Ok(list
            .outcome(prepared)
            .times(u64::from(views * self.rounds())))
    }

    /// The products of all that a list needs in a cache.
    fn cached_products(&self, list: &DrawList) -> u64 {
        let points = self.drawing.surface().cached_points();
        let level = list.cached_level().zip(points);
        level.map_or(0, |(level, points)| points.products(level))
    }

    /// A row a level.
    pub fn rows(&self) -> impl Iterator<Item = Row> + '_ {
        self.levels.iter().map(|level| Row {
            model: self.model.clone(),
            method: self.method,
            level: level.list.cut().level,
            backend: self.backend.name(),
            residence: self.residence.name(),
            is_static: self.is_static,
            decides: match self.drawing.surface().options().decides {
                Decides::Host => "host",
                Decides::Device => "device",
            },
            passes: self.passes,
            instances: self.instances.a_draw * self.instances.draws,
            cpu: level.cpu.clone(),
            gpu: level.gpu.clone(),
            is_software: self.gpu.device.is_software(),
            ratio_to_flat: None,
            work: level.work.unwrap_or_default(),
            ring_bytes: self.ring_bytes,
            device_bytes: self.device_bytes,
            storage_buffers: hullform::gpu::Layout::STORAGE_BUFFERS,
        })
    }
}

/// From where decisions see a model: all of it.
fn seen(model: &Model, arguments: &Arguments) -> Seen {
    let Size { width, height } = arguments.size;
    let size = [width, height].map(|side| side as f32);
    let view = arguments
        .sight
        .camera
        .frame(&model.positions(), size[0] / size[1]);
    Seen {
        clip_from_model: view.clip_from_model,
        eye: view.eye,
        scale: model.placement().scale,
        size,
    }
}

/// A file's name without its folder, a built-in one as it is.
fn model_name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or(path.as_os_str());
    stem.to_string_lossy().into_owned()
}

/// Seconds that all threads of this process have computed; llvmpipe's threads draw within it.
fn cpu_seconds() -> Option<f64> {
    #[cfg(target_os = "linux")]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(target_os = "linux"))]
    None
}
