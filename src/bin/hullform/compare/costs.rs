//! What drawing costs: the least time of some frames, of all methods in turn, so that whatever else the machine does meets all of them.

use std::time::Instant;

use hullform::gpu::{Backend, DrawList, Fill, SurfaceOptions};
use hullform::host::{Bench, Shot, Style};
use hullform::mesh::Model;
use hullform::{Error, Result};

use crate::drawing::{self, Drawing};
use crate::gpu::Gpu;
use crate::options::{Chosen, Cutting, Global};

/// The least seconds that a frame took, for each of some methods. Triangles are made and thrown away: what they cover would cost all methods the
/// same.
pub fn seconds(
    gpu: &Gpu,
    model: &Model,
    methods: &[Chosen],
    cutting: Cutting,
    frames: u32,
    global: &Global,
) -> Result<Vec<f64>> {
    let bench = drawing::blind(gpu)?;
    let prepare = |&chosen| prepare(gpu, &bench, model, chosen, cutting, global);
    let ready = methods.iter().map(prepare).collect::<Result<Vec<_>>>()?;
    let mut least = vec![f64::INFINITY; methods.len()];
    for _ in 0..frames {
        for ((drawing, list), least) in ready.iter().zip(&mut least) {
            *least = least.min(draw(&bench, drawing, list)?);
        }
    }
    Ok(least)
}

fn prepare<'a>(
    gpu: &Gpu,
    bench: &'a Bench,
    model: &Model,
    chosen: Chosen,
    cutting: Cutting,
    global: &Global,
) -> Result<(Drawing<'a>, DrawList)> {
    // Where the device does not count, the shaders do, and all methods bear an atomic operation a vertex.
    let device_counts = gpu.device.info().support.optional.pipeline_statistics_query
        && cutting.backend == Backend::Tessellator;
    let options = SurfaceOptions {
        count_vertices: !device_counts,
        backend: cutting.backend,
        residence: cutting.residence,
        ring_bytes: global.ring_bytes,
        slots: drawing::slots(global.slots),
        greatest_level: cutting.cut.level,
        ..SurfaceOptions::default()
    };
    let prepared = drawing::prepare(model, chosen)?;
    let mut drawing = Drawing::new(gpu, bench, model, prepared, options, global.points)?;
    let list = drawing.draw_list(cutting.cut)?;
    Ok((drawing, list))
}

/// Draws a frame and returns how many seconds it took.
fn draw(bench: &Bench, drawing: &Drawing<'_>, list: &DrawList) -> Result<f64> {
    let options = drawing.surface().options();
    let style = Style::new(options, list.cut().spacing, Fill::Discard);
    let pipelines = bench.pipelines(drawing.prepared(), style)?;
    let shot = Shot {
        pipelines: &pipelines,
        view: drawing::nowhere(),
        instances: 1,
        batches: list.batches().collect(),
    };
    let started = Instant::now();
    let counted = drawing.draw(&[shot])?;
    let seconds = started.elapsed().as_secs_f64();
    let evaluations = counted.map(|[_, evaluations, _]| evaluations);
    check(
        drawing,
        list,
        evaluations.filter(|_| !options.count_vertices),
    )?;
    Ok(seconds)
}

/// Refuses a frame of which something is missing: it would be a fast one.
fn check(drawing: &Drawing<'_>, list: &DrawList, evaluations: Option<u64>) -> Result<()> {
    // Patches without room in the ring are another matter.
    if drawing.surface().counters()?.overflows > 0 {
        return Ok(());
    }
    let Some(evaluations) = evaluations else {
        return drawing.surface().arrival(list.batches())?.check();
    };
    let vertices = list.batches().map(|batch| u64::from(batch.vertices()));
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
