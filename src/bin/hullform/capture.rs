//! What the evaluation shader produces, read back from the device.

use crate::camera::Camera;
use crate::drawing::Drawing;
use crate::framing::Subject;
use crate::gpu::Gpu;
use crate::options::{Chosen, Cutting, Global};
use crate::output::{Point, Surface};
use glam::Vec3;
use hullform::gpu::{Batch, Fill, Pipelines, SurfaceOptions, View};
use hullform::host::OffscreenTarget;
use hullform::mesh::Model;
use hullform::method::{Displacement, to_ptex};
use hullform::{Error, Result, abi};

/// Vertices that are captured at once: as many as 64 MiB hold.
const CAPTURED: u32 = (64 << 20) / size_of::<abi::Captured>() as u32;

/// The picture in which depth tags see the surface: `render`'s own.
const SEEN: [u32; 2] = [1280, 720];

/// Tessellates `model` on the device, some patches at a time, and gathers what the evaluating shader produced. Depth tags, if any, go by what
/// `camera` sees.
pub fn capture(
    gpu: &Gpu,
    model: &Model,
    chosen: Chosen,
    cutting: Cutting,
    camera: Option<Camera>,
    global: &Global,
) -> Result<Surface> {
    let Cutting {
        cut,
        backend,
        residence,
        ..
    } = cutting;
    let options = SurfaceOptions {
        backend,
        residence,
        ring_bytes: global.ring_bytes,
        slots: Drawing::slots(global.slots),
        capture_vertices: CAPTURED,
        greatest_level: cut.level,
        ..Default::default()
    };
    let prepared = Drawing::prepare(model, chosen)?;
    let camera = camera.filter(|_| cutting.adaptive.is_some());
    let seen = camera.map(|camera| {
        let subject = Subject {
            gpu,
            model,
            prepared: &prepared,
            cutting,
            displacement: Displacement::default(),
            ring_bytes: global.ring_bytes,
            points: global.points,
        };
        subject.framed(camera, SEEN)
    });
    let tags = seen.transpose()?.and_then(|framed| framed.tags);
    let mut drawing = Drawing::of(gpu, model, prepared, options)?;
    drawing.upload(global.points)?;
    // Nothing is rasterised, but draws need a render pass.
    let target = OffscreenTarget::new(&gpu.device, 1, 1, 1)?;
    let pipelines = drawing.pipelines(&target, cut.spacing, Fill::Discard)?;
    let list = drawing.draw_list(cut, tags.as_ref())?;
    let mut surface = Surface::default();
    for batch in list.batches() {
        let captured = capture_batch(gpu, &drawing, &target, &pipelines, batch)?;
        add_patches(&mut surface, &captured, model, &drawing, batch)?;
    }
    Ok(surface)
}

/// Draws a batch of which every vertex is recorded.
pub fn record(
    gpu: &Gpu,
    drawing: &Drawing<'_>,
    target: &OffscreenTarget,
    pipelines: &Pipelines,
    view: &View,
    batch: Batch<'_>,
) -> Result<()> {
    // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
    gpu.device.submit(|cmd| unsafe {
        let (surface, device) = (drawing.surface(), gpu.device.raw());
        surface.cmd_prepare(device, cmd, std::slice::from_ref(view))?;
        target.begin(cmd, [0.0; 4]);
        let drawn = drawing.cmd_draw(cmd, pipelines, [batch]);
        target.end(cmd);
        surface.cmd_read_back(device, cmd);
        drawn
    })?;
    let overflows = drawing.counters()?.overflows;
    if overflows > 0 {
        return Err(Error::Refused(format!(
            "{overflows} patches found no room in the scratch ring; use --slots host, or a larger --ring-bytes"
        )));
    }
    drawing.surface().arrival([batch])?.check()
}

/// Draws a batch and returns what was captured, patch by patch.
fn capture_batch(
    gpu: &Gpu,
    drawing: &Drawing<'_>,
    target: &OffscreenTarget,
    pipelines: &Pipelines,
    batch: Batch<'_>,
) -> Result<Vec<abi::Captured>> {
    record(gpu, drawing, target, pipelines, &Drawing::nowhere(), batch)?;
    let surface = drawing.surface();
    let expected = surface.arrival([batch])?.vertices;
    Ok(once_each(surface.captured()?, expected))
}

/// The captured vertices by patch, v and u, each once: the evaluating shader may run more than once a vertex.
fn once_each(captured: &[abi::Captured], expected: u64) -> Vec<abi::Captured> {
    let mut vertices = captured.to_vec();
    let key = |vertex: &abi::Captured| {
        (
            vertex.patch_number,
            vertex.uv[1].to_bits(),
            vertex.uv[0].to_bits(),
        )
    };
    vertices.sort_unstable_by_key(key);
    vertices.dedup_by_key(|vertex| key(vertex));
    if vertices.len() as u64 != expected {
        tracing::warn!(
            "the device made {} vertices where {expected} were expected",
            vertices.len()
        );
    }
    vertices
}

/// Adds the points and triangles of captured patches.
fn add_patches(
    surface: &mut Surface,
    captured: &[abi::Captured],
    model: &Model,
    drawing: &Drawing<'_>,
    batch: Batch<'_>,
) -> Result<()> {
    let prepared = drawing.surface().prepared();
    let pass = &prepared.passes[batch.pass()];
    let placement = model.placement();
    for vertices in captured.chunk_by(|a, b| a.patch_number == b.patch_number) {
        let number = vertices[0].patch_number;
        let Some(patch) = pass.patches.get(number as usize) else {
            return Err(Error::Refused(format!(
                "the device captured a vertex of patch {number}, and there are {}; choose another device, or update its driver",
                pass.patches.len()
            )));
        };
        let first = surface.points.len() as u32;
        let uv: Vec<[f32; 2]> = vertices.iter().map(|vertex| vertex.uv).collect();
        let triangles = batch
            .list()
            .triangles(prepared, batch.pass(), number, &uv)
            .ok_or_else(|| Error::Lost {
                what: format!("vertices of a patch of face {}", patch.ptex),
            })?;
        let triangles = triangles.into_iter();
        surface
            .triangles
            .extend(triangles.map(|triangle| triangle.map(|i| first + i)));
        surface.points.extend(vertices.iter().map(|vertex| {
            Point {
                face: patch.ptex,
                uv: to_ptex(patch, vertex.uv),
                position: placement
                    .position(Vec3::from(vertex.position).as_dvec3())
                    .to_array(),
                normal: vertex.normal,
                texture: pass.texture_coordinates(number as usize, vertex.uv),
            }
        }));
    }
    Ok(())
}
