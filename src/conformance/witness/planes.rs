//! A plane has its plane's normal, everywhere.

use glam::DVec3;

use super::drawn::{Patch, degrees, diagonal, each_patch, noise_at_corners, normal, position};
use super::{Looked, Subject, pairs};
use crate::conformance::meshes::{Planar, planar};
use crate::conformance::{Case, Check, Context, Finding};
use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::{Method, MethodOptions, Reproduces};
use crate::subdivision::LimitSurface;
use crate::tessellation::triangulate;

const RULE: &str = "a mesh that lies in a plane has its plane's normal at every sample, whatever its tags, turned, scaled and moved: within 5e-4 degrees on the device, 1e-8 in the truth";
const SOURCE: &str = "affine invariance: weights sum to 1";

/// Cases a method and scheme, and meshes a case.
const CASES: u32 = 2;
const MESHES: u32 = 5;

/// Of how many of these the truth is asked.
const ASKED: u32 = 2;

pub(super) fn cases() -> Vec<Case> {
    // A piece of two triangles does not tell whether it turns over between them, and where it does there is no side for normals to be on.
    let whole = pairs().filter(|(method, _)| !method.isolates);
    let numbered = whole.flat_map(|pair| (0..CASES).map(move |number| (pair, number)));
    let case = |((method, scheme), number): ((&'static Method, Scheme), u32)| {
        let name = format!("witness.plane.{}-{scheme}-{number}", method.name);
        Case::new(name.clone(), RULE, SOURCE, move |context| {
            planes(context, method, scheme, &name)
        })
    };
    numbered.map(case).collect()
}

fn planes(
    context: &Context,
    method: &'static Method,
    scheme: Scheme,
    stream: &str,
) -> Result<Finding> {
    let mut random = context.random(stream);
    let (mut check, mut looked, mut flat) = (Check::default(), Looked::default(), 0);
    for number in 0..MESHES {
        let able = |mesh: &_| {
            let model = Model::new(Clone::clone(mesh));
            let topology = model.topology();
            let mut faces = 0..topology.face_count() as u32;
            faces.any(|face| !topology.is_hole(face)) && method.check_model(&model).is_ok()
        };
        let plane = planar(&mut random, scheme, able)?;
        let model = Model::new(plane.mesh.clone());
        let subject = Subject {
            prepared: method.prepare(&model, MethodOptions::default())?,
            model: &model,
            method,
        };
        if subject.prepared.passes.is_empty() {
            continue;
        }
        flat += 1;
        // The baseline does every scheme: each truth is asked once, and of some meshes, for it takes its time.
        let is_asked = number < ASKED && matches!(method.contract.reproduces, Reproduces::Faces(_));
        if is_asked {
            hold_truth(&mut check, &model, &plane, number);
        }
        looked.add(hold_device(context, &mut check, &subject, &plane, number)?);
    }
    check.hold(flat > MESHES / 2, || {
        format!("only {flat} meshes have a surface")
    });
    Ok(check.finish(format!(
        "{flat} planes, {} normals, at most {:.2e} degrees off",
        looked.count, looked.worst
    )))
}

/// The level, which is odd: most vertices lie on no lattice.
const LEVEL: f32 = 5.0;

fn hold_device(
    context: &Context,
    check: &mut Check,
    subject: &Subject<'_>,
    plane: &Planar,
    number: u32,
) -> Result<Looked> {
    let mut looked = Looked::default();
    let scale = diagonal(subject.model);
    let origin = subject.model.placement().local(plane.mesh.positions()[0]);
    each_patch(context, subject, LEVEL, noise_at_corners, |patch| {
        if is_folded(patch, plane.normal, scale) {
            // Then there is no side for normals to be on.
            return Ok(());
        }
        let has_area = areas(patch, plane.normal).any(|area| area > 1e-9 * scale * scale);
        for vertex in patch.vertices {
            let height = (position(vertex) - origin).dot(plane.normal) / scale;
            let off = degrees(normal(vertex), plane.normal);
            let missing = vertex.normal == [0.0; 3] && has_area;
            check.hold(height.abs() < 1e-6 && off < 5e-4 && !missing, || {
                let (ptex, uv) = (patch.ptex(), vertex.uv);
                let given = normal(vertex);
                format!("plane {number}, {uv:?} of ptex face {ptex}: {height:.1e} above the plane, normal {given:.6} instead of {:.6}", plane.normal)
            });
            looked.at(off);
        }
        Ok(())
    })?;
    Ok(looked)
}

/// Whether a patch turns over: no face does, but boundaries and creases that are drawn to others' sides may.
fn is_folded(patch: &Patch<'_>, up: DVec3, scale: f64) -> bool {
    areas(patch, up).any(|area| area < -1e-9 * scale * scale)
}

/// Twice the areas of a patch's triangles.
fn areas(patch: &Patch<'_>, up: DVec3) -> impl Iterator<Item = f64> {
    let uv: Vec<[f32; 2]> = patch.vertices.iter().map(|vertex| vertex.uv).collect();
    let triangles = triangulate(patch.pass.domain, &uv).into_iter();
    triangles.map(move |triangle| {
        let [a, b, c] = triangle.map(|i| position(&patch.vertices[i as usize]));
        (b - a).cross(c - a).dot(up)
    })
}

/// Whether the surface next to a place turns over, as its positions tell.
fn turns_over(truth: &LimitSurface, ptex: usize, [u, v]: [f64; 2], up: DVec3) -> bool {
    const STEP: f64 = 1.0 / 64.0;
    let [along_u, along_v] = [u, v].map(|x| if x < 0.5 { STEP } else { -STEP });
    let places = [[u, v], [u + along_u, v], [u, v + along_v]];
    let points = places.map(|[u, v]| truth.evaluate(ptex, u, v).map(|sample| sample.position));
    let [Some(a), Some(b), Some(c)] = points else {
        return false;
    };
    (b - a).cross(c - a).dot(up) * (along_u * along_v).signum() < 0.0
}

/// The surface in f64, at corners and inside.
fn hold_truth(check: &mut Check, model: &Model, plane: &Planar, number: u32) {
    const PLACES: [[f64; 2]; 6] = [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [1.0, 1.0],
        [0.3, 0.0],
        [0.25, 0.4],
    ];
    let truth = LimitSurface::new(model.mesh());
    for ptex in 0..truth.ptex_count() {
        for [u, v] in PLACES {
            let Some(sample) = truth.evaluate(ptex, u, v) else {
                continue;
            };
            let off = degrees(sample.normal(), plane.normal);
            // Where the surface turns over, so may its normal.
            let is_turned = || off > 90.0 && turns_over(&truth, ptex, [u, v], plane.normal);
            let off = if is_turned() { 180.0 - off } else { off };
            check.hold(off < 1e-8 && sample.normal() != DVec3::ZERO, || {
                let given = sample.normal();
                format!("plane {number}, the truth at ({u}, {v}) of ptex face {ptex}: {given:.9} instead of {:.9}", plane.normal)
            });
        }
    }
}
