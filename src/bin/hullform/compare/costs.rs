//! What drawing costs: the least time of some frames, of all methods in turn, so that whatever else the machine does meets all of them.

use std::time::Instant;

use hullform::gpu::{Backend, DrawList, Fill, SurfaceOptions};
use hullform::host::{OffscreenTarget, StatisticsQuery};
use hullform::mesh::Model;
use hullform::{Error, Result};

use crate::drawing::{Drawing, OwnPipelines};
use crate::gpu::Gpu;
use crate::options::{Chosen, Cutting, Global};
use crate::render;

/// A method ready to be drawn again and again. Triangles are made and thrown away: what they cover would cost all methods the same.
struct Ready<'a> {
    drawing: Drawing<'a>,
    pipelines: OwnPipelines<'a>,
    list: DrawList,
    /// Tells whether frames were whole, where the device counts. Elsewhere the shaders do, and all methods bear an atomic operation a vertex.
    query: Option<StatisticsQuery>,
}

/// The least seconds that a frame took, for each of some methods.
pub fn seconds(
    gpu: &Gpu,
    model: &Model,
    methods: &[Chosen],
    cutting: Cutting,
    frames: u32,
    global: &Global,
) -> Result<Vec<f64>> {
    // Nothing is rasterised, but draws need a render pass.
    let target = OffscreenTarget::new(&gpu.device, 1, 1, 1)?;
    let prepare = |&chosen| prepare(gpu, model, chosen, cutting, &target, global);
    let ready = methods.iter().map(prepare).collect::<Result<Vec<_>>>()?;
    let mut least = vec![f64::INFINITY; methods.len()];
    for _ in 0..frames {
        for (ready, least) in ready.iter().zip(&mut least) {
            *least = least.min(draw(gpu, ready, &target)?);
        }
    }
    Ok(least)
}

fn prepare<'a>(
    gpu: &'a Gpu,
    model: &Model,
    chosen: Chosen,
    cutting: Cutting,
    target: &OffscreenTarget,
    global: &Global,
) -> Result<Ready<'a>> {
    let device_counts = gpu.device.info().support.optional.pipeline_statistics_query
        && cutting.backend == Backend::Tessellator;
    let options = SurfaceOptions {
        count_vertices: !device_counts,
        backend: cutting.backend,
        residence: cutting.residence,
        ring_bytes: global.ring_bytes,
        slots: Drawing::slots(global.slots),
        greatest_level: cutting.cut.level,
        ..SurfaceOptions::default()
    };
    let mut drawing = Drawing::new(gpu, model, chosen, options)?;
    drawing.upload(global.points)?;
    let query = device_counts.then(|| StatisticsQuery::new(&gpu.device));
    Ok(Ready {
        query: query.transpose()?,
        list: drawing.draw_list(cutting.cut, None)?,
        pipelines: drawing.pipelines(target, cutting.cut.spacing, Fill::Discard)?,
        drawing,
    })
}

/// Draws a frame and returns how many seconds it took.
fn draw(gpu: &Gpu, ready: &Ready<'_>, target: &OffscreenTarget) -> Result<f64> {
    let started = Instant::now();
    // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
    gpu.device.submit(|cmd| unsafe {
        let surface = ready.drawing.surface();
        surface.cmd_prepare(gpu.device.raw(), cmd, &[Drawing::nowhere()])?;
        if let Some(query) = &ready.query {
            query.cmd_reset(cmd);
        }
        target.begin(cmd, render::CLEAR);
        if let Some(query) = &ready.query {
            query.cmd_begin(cmd);
        }
        let (pipelines, batches) = (&ready.pipelines, ready.list.batches());
        let drawn = ready.drawing.cmd_draw(cmd, pipelines, batches);
        if let Some(query) = &ready.query {
            query.cmd_end(cmd);
        }
        target.end(cmd);
        surface.cmd_read_back(gpu.device.raw(), cmd);
        drawn
    })?;
    let seconds = started.elapsed().as_secs_f64();
    check(ready)?;
    Ok(seconds)
}

/// Refuses a frame of which something is missing: it would be a fast one.
fn check(ready: &Ready<'_>) -> Result<()> {
    // Patches without room in the ring are another matter.
    if ready.drawing.counters()?.overflows > 0 {
        return Ok(());
    }
    let Some(query) = &ready.query else {
        let arrival = ready.drawing.surface().arrival(ready.list.batches())?;
        return arrival.check();
    };
    let [_, evaluations, _] = query.read()?;
    let vertices = ready
        .list
        .batches()
        .map(|batch| u64::from(batch.vertices()));
    let predicted: u64 = vertices.sum();
    if evaluations >= predicted {
        return Ok(());
    }
    Err(Error::Lost {
        what: format!(
            "{} of {predicted} vertices of a frame",
            predicted - evaluations
        ),
    })
}
