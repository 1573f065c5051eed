//! Which side is which: normals on that from which faces are counter-clockwise, and triangles wound as their faces.

use ash::vk;
use glam::DVec3;

use super::differences::{has_own_normals, own_normals};
use super::drawn::{degrees, diagonal, each_patch, normal, position};
use super::{Looked, Rule, Subject};
use crate::abi::Captured;
use crate::conformance::capture::{capturing, cut};
use crate::conformance::meshes::{Parts, sheet};
use crate::conformance::{Case, Check, Context, Finding};
use crate::error::Result;
use crate::gpu::{Backend, SurfaceOptions, shaders};
use crate::mesh::{ControlMesh, Model, Scheme};
use crate::method::{METHODS, Method, MethodOptions};
use crate::tessellation::{Spacing, triangulate};

pub(super) const RULE: Rule = Rule {
    name: "sides",
    rule: "triangles lie with that side up on which the normals of their corners are",
    source: "README, Coordinates: faces are counter-clockwise from their front",
    concerns: has_own_normals,
    options: own_normals,
    look,
};

const LEVEL: f32 = 6.0;

fn look(context: &Context, subject: &Subject<'_>, check: &mut Check) -> Result<Looked> {
    let mut looked = Looked::default();
    let scale = diagonal(subject.model);
    each_patch(context, subject, LEVEL, upside_down, |patch| {
        let uv: Vec<[f32; 2]> = patch.vertices.iter().map(|vertex| vertex.uv).collect();
        for triangle in triangulate(patch.pass.domain, &uv) {
            let corners = triangle.map(|i| &patch.vertices[i as usize]);
            let Some(up) = firm(corners, scale) else {
                continue;
            };
            let normals = corners.map(normal);
            let sum: DVec3 = normals.iter().sum();
            // Where the surface turns faster than triangles can follow, they may lie anyhow.
            if !normals.iter().all(|&n| degrees(n, sum) < 40.0) {
                continue;
            }
            let off = degrees(up, sum);
            check.hold(off < 90.0, || {
                let (name, ptex) = (subject.method.name, patch.ptex());
                format!("{name}, ptex face {ptex}: a triangle is {off:.1} degrees off its normals")
            });
            looked.at(off);
        }
        Ok(())
    })?;
    Ok(looked)
}

/// The normal of a triangle that is neither narrow nor so small that its corners' rounding decides.
fn firm(corners: [&Captured; 3], scale: f64) -> Option<DVec3> {
    let [a, b, c] = corners.map(position);
    let up = (b - a).cross(c - a);
    let longest = [a.distance(b), b.distance(c), c.distance(a)];
    let longest = longest.into_iter().fold(0.0, f64::max);
    let height = up.length() / longest.max(f64::MIN_POSITIVE);
    (height > 0.01 * longest && height > 1e-4 * scale).then_some(up)
}

fn upside_down(vertex: &mut Captured) {
    vertex.normal = vertex.normal.map(|x| -x);
}

/// What is seen of a sheet from its front, by each way to cut it.
pub(super) fn windings() -> impl Iterator<Item = Case> {
    let all = METHODS.iter().flat_map(|method| {
        let alone = shaders::spirv(&format!("{}.geom", method.name)).is_some();
        let backends = if alone {
            &Backend::ALL[..]
        } else {
            &Backend::ALL[..1]
        };
        backends
            .iter()
            .map(move |&backend| (method, method.schemes[0], backend))
    });
    all.map(|(method, scheme, backend)| {
        let name = format!(
            "witness.winding.{}-{scheme}-{}",
            method.name,
            backend.name()
        );
        let rule = "with back faces culled a sheet is seen from its front, and not from behind";
        let source = "Vulkan, Basic Polygon Rasterization; Tessellator, VertexOrderCcw";
        Case::new(name, rule, source, move |context| {
            winding(context, method, scheme, backend)
        })
    })
}

fn winding(
    context: &Context,
    method: &'static Method,
    scheme: Scheme,
    backend: Backend,
) -> Result<Finding> {
    let has = context.device()?.info().support.optional.geometry_shader;
    if backend == Backend::Geometry && !has {
        return Ok(Finding::skip("the device has no geometry shaders"));
    }
    let mut parts = sheet(5);
    for position in &mut parts.positions {
        position[2] = 0.0;
    }
    let front = seen(context, method, scheme, backend, &parts)?;
    if !context.is_wrong() {
        parts.faces.iter_mut().for_each(|face| face.reverse());
    }
    let back = seen(context, method, scheme, backend, &parts)?;
    let mut check = Check::default();
    check.hold(front > 1000 && back == 0, || {
        format!("{front} pixels from the front, {back} from behind")
    });
    Ok(check.finish(format!("{front} pixels from the front")))
}

/// The pixels that are drawn with back faces culled.
fn seen(
    context: &Context,
    method: &'static Method,
    scheme: Scheme,
    backend: Backend,
    parts: &Parts,
) -> Result<usize> {
    let able = |mesh: &ControlMesh| method.check_model(&Model::new(mesh.clone())).is_ok();
    let model = Model::new(parts.open(scheme, able)?);
    let prepared = method.prepare(&model, MethodOptions::default())?;
    let cut = cut(4.0, Spacing::Equal);
    let options = SurfaceOptions {
        backend,
        ..capturing(context, &prepared, backend.cut(cut))
    };
    let workarounds = context.workarounds()?;
    let bench = context.bench()?;
    let mut loaded = bench.load(&model, prepared, &workarounds, options)?;
    loaded.cull = vk::CullModeFlags::BACK;
    let pixels = loaded.picture(cut)?;
    Ok(pixels.iter().filter(|&&alpha| alpha != 0).count())
}
