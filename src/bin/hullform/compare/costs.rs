//! What drawing costs: the least time of some frames, of all methods in turn, so that whatever else the machine does meets all of them.

use std::time::Instant;

use hullform::Result;
use hullform::gpu::{Batch, Fill, SurfaceOptions};
use hullform::host::OffscreenTarget;
use hullform::mesh::Model;

use crate::drawing::{Drawing, OwnPipelines};
use crate::gpu::Gpu;
use crate::options::{Chosen, Cutting, Global};
use crate::render;

/// A method ready to be drawn again and again. Triangles are made and thrown away: what they cover would cost all methods the same.
struct Ready<'a> {
    drawing: Drawing<'a>,
    pipelines: OwnPipelines<'a>,
    batches: Vec<Batch>,
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
            *least = least.min(draw(gpu, ready, cutting, &target)?);
        }
    }
    Ok(least)}

fn prepare<'a>(
    gpu: &'a Gpu,
    model: &Model,
    chosen: Chosen,
    cutting: Cutting,
    target: &OffscreenTarget,
    global: &Global,
) -> Result<Ready<'a>> {
    let options = SurfaceOptions {
        backend: cutting.backend,
        ring_bytes: global.ring_bytes,
        slots: Drawing::slots(global.slots),
        greatest_level: cutting.cut.level,
        ..SurfaceOptions::default()
    };
    let mut drawing = Drawing::new(gpu, model, chosen, options)?;
    drawing.upload(global.points)?;
    Ok(Ready {
        batches: drawing.batches(cutting.cut, None)?,
        pipelines: drawing.pipelines(target, cutting.cut.spacing, Fill::Discard)?,
        drawing,
    })
}

/// Draws a frame and returns how many seconds it took.
fn draw(gpu: &Gpu, ready: &Ready<'_>, cutting: Cutting, target: &OffscreenTarget) -> Result<f64> {
    let started = Instant::now();
    // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
    gpu.device.submit(|cmd| unsafe {
        let surface = ready.drawing.surface();
        surface.cmd_prepare(gpu.device.raw(), cmd);
        target.begin(cmd, render::CLEAR);
        let (pipelines, batches) = (&ready.pipelines, &ready.batches);
        let view = &Drawing::nowhere();
        ready
            .drawing
            .cmd_draw(cmd, pipelines, view, cutting.cut, batches);
        target.end(cmd);
        surface.cmd_read_back(gpu.device.raw(), cmd);
        Ok(())
    })?;
    Ok(started.elapsed().as_secs_f64())
}
