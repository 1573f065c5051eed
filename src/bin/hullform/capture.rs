//! What the evaluation shader produces, read back from the device.

use crate::camera::Camera;
use crate::drawing::{self, Drawing};
use crate::framing::Subject;
use crate::gpu::Gpu;
use crate::options::{Chosen, Cutting, Global};
use crate::output::{Point, Surface};
use glam::Vec3;
use hullform::gpu::{Batch, Decides, Decision, Fill, SurfaceOptions, View};
use hullform::host::{Bench, Shot, Style};
use hullform::mesh::Model;
use hullform::method::{DepthTags, Displacement, Prepared, to_ptex};
use hullform::tessellation::Levels;
use hullform::{Error, Result, abi};

/// Vertices that are captured at once: as many as 64 MiB hold.
const CAPTURED: u32 = (64 << 20) / size_of::<abi::Captured>() as u32;

/// The picture in which depth tags see the surface: `render`'s own.
const SEEN: [u32; 2] = [1280, 720];

/// What levels go by.
#[derive(Clone, Debug)]
pub enum By {
    /// The cut alone.
    Cut,
    /// Depth tags.
    Tags(DepthTags),
    /// The device, of what is seen in a view. It leaves nothing out.
    #[cfg_attr(not(feature = "view"), expect(dead_code, reason = "for the window"))]
    Device(Decision, View),
}

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
    let prepared = drawing::prepare(model, chosen)?;
    let bench = drawing::blind(gpu)?;
    let camera = camera.filter(|_| cutting.adaptive.is_some());
    let seen = camera.map(|camera| {
        let subject = Subject {
            gpu,
            bench: &bench,
            fill: Fill::Discard,
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
    let by = tags.map_or(By::Cut, By::Tags);
    captured(gpu, &bench, model, prepared, (cutting, by), global)
}

/// The same of what has been prepared, by levels that are given.
pub fn captured(
    gpu: &Gpu,
    bench: &Bench,
    model: &Model,
    prepared: Prepared,
    (cutting, by): (Cutting, By),
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
        slots: drawing::slots(global.slots),
        capture_vertices: CAPTURED,
        greatest_level: cut.level,
        decides: match &by {
            By::Cut | By::Tags(_) => Decides::Host,
            By::Device(..) => Decides::Device,
        },
        ..Default::default()
    };
    let mut drawing = Drawing::new(gpu, bench, model, prepared, options, global.points)?;
    let mut view = drawing::nowhere();
    match by {
        By::Cut => {}
        By::Tags(tags) => drawing.tags = Some(tags),
        By::Device(decision, seen) => (drawing.decision, view) = (decision, seen),
    }
    let list = drawing.draw_list(cut)?;
    list.check_points(drawing.prepared())?;
    let style = Style::new(options, cut.spacing, Fill::Discard);
    let pipelines = bench.pipelines(drawing.prepared(), style)?;
    let mut surface = Surface::default();
    for batch in list.batches() {
        drawing.draw(&[Shot {
            pipelines: &pipelines,
            view,
            instances: 1,
            batches: vec![batch],
        }])?;
        drawing.check([batch])?;
        let captured = once_each(&drawing, batch)?;
        add_patches(&mut surface, &captured, model, &drawing, batch)?;
    }
    Ok(surface)
}

/// The captured vertices by patch, v and u, each once.
fn once_each(drawing: &Drawing<'_>, batch: Batch<'_>) -> Result<Vec<abi::Captured>> {
    let patches = drawing.surface().drawing().slot.drawn(batch, 0).iter();
    let patches = patches.filter_map(|&patch| {
        let levels = decided(drawing, batch.pass(), patch)?;
        Some(levels.vertices(batch.list().cut().spacing))
    });
    let expected = match drawing.surface().options().decides {
        Decides::Host => batch.vertices(),
        Decides::Device => patches.sum(),
    };
    let (vertices, _) = drawing.captured(expected)?;
    // Pieces share vertices.
    if !batch.list().has_sub_patches() && vertices.len() != expected as usize {
        tracing::warn!(
            "the device made {} vertices where {expected} were expected",
            vertices.len()
        );
    }
    Ok(vertices)
}

/// The levels of a patch that was drawn, where the device has decided about them.
fn decided(drawing: &Drawing<'_>, pass: usize, patch: u32) -> Option<Levels> {
    let surface = drawing.surface();
    let there = surface.options().decides == Decides::Device;
    let record = surface.decided(pass, 0).get(patch as usize);
    let record = record.filter(|_| there)?;
    Some(Levels {
        domain: drawing.prepared().passes[pass].domain,
        cells: [1; 2],
        edges: record.edges,
        inside: record.inside,
    })
}

/// Adds the points and triangles of captured patches.
fn add_patches(
    surface: &mut Surface,
    captured: &[abi::Captured],
    model: &Model,
    drawing: &Drawing<'_>,
    batch: Batch<'_>,
) -> Result<()> {
    let prepared = drawing.prepared();
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
        let list = batch.list();
        let triangles = match decided(drawing, batch.pass(), number) {
            None => batch.triangles(prepared, number, &uv),
            Some(levels) => list.join(&levels, &uv),
        };
        let triangles = triangles.ok_or_else(|| Error::Lost {
            what: format!("vertices of a patch of face {}", patch.ptex),
        })?;
        let triangles = triangles.into_iter();
        surface
            .triangles
            .extend(triangles.map(|triangle| triangle.map(|i| first + i)));
        surface.points.extend(vertices.iter().map(|vertex| {
            let (slot, uv) = pass.face_at(number as usize, vertex.uv);
            let face = &pass.patches[slot];
            Point {
                face: face.ptex,
                uv: to_ptex(face, uv),
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
