//! A mesh in a plane has the plane's normal at every point, by every scheme and method: nothing else tells so surely whether a normal is one, or
//! what rounding left of it.

mod common;

use common::planar::{Planar, planar};
use glam::{DVec3, Vec2, Vec3};
use hullform::abi;
use hullform::mesh::{Model, Scheme};
use hullform::method::{METHODS, MethodOptions, to_ptex};
use hullform::subdivision::LimitSurface;
use hullform::tessellation::Domain;

/// Where patches are asked: at corners and next to them, on edges, and inside.
const PLACES: [[f64; 2]; 16] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [1.0, 1.0],
    [0.0, 1.0],
    [0.5, 0.0],
    [0.0, 0.25],
    [1.0, 0.5],
    [0.75, 1.0],
    [1.0 / 64.0, 1.0 / 64.0],
    [63.0 / 64.0, 63.0 / 64.0],
    [0.0, 1.0 / 64.0],
    [1.0, 63.0 / 64.0],
    [63.0 / 64.0, 0.0],
    [0.5, 0.5],
    [0.3, 0.45],
    [0.125, 0.625],
];

/// How many meshes of each scheme, unless HULLFORM_PLANAR says so.
fn count(default: u64) -> u64 {
    let asked = std::env::var("HULLFORM_PLANAR").ok();
    asked
        .and_then(|asked| asked.parse().ok())
        .unwrap_or(default)
}

/// The angle in degrees to the plane's normal or its opposite: where a surface folds over in its plane, its normal turns over as well. That of a
/// normal that is none is 999.
fn degrees(normal: DVec3, right: DVec3) -> f64 {
    if (normal.length() - 1.0).abs() > 1e-5 {
        return 999.0;
    }
    let aligned = normal.dot(right).abs();
    normal.cross(right).length().atan2(aligned).to_degrees()
}

fn is_outside(triangle: bool, [u, v]: [f64; 2]) -> bool {
    triangle && u + v > 1.0
}

fn hold(place: &str, planar: &Planar, angle: f64, bound: f64, failures: &mut Vec<String>) {
    if angle > bound {
        failures.push(format!(
            "seed {}, {place}: {angle:.1e} degrees",
            planar.seed
        ));
    }
}

/// The degrees by which f32 leaves a normal open: a position of about the model's size is rounded by half of f32's epsilon, and a derivative turns by that
/// over its own length; beside one that is nearly parallel by that over the sine between them. Derivatives of a piece are as much shorter as the piece is, and
/// its points were rounded at each level; those of an end cap are its own.
fn left_by_rounding(model: &Model, patch: &abi::Patch, uv: [f64; 2], own: [Vec3; 2]) -> f64 {
    let height = |[du, dv]: [DVec3; 2]| du.cross(dv).length() / du.length().max(dv.length());
    if patch.flags >> abi::PATCH_CHILD_SHIFT & 15 == abi::CHILD_PIECE {
        let depth = f64::from(patch.plan >> abi::PIECE_DEPTH_SHIFT);
        let rounding = f64::from(f32::EPSILON) * (1.0 + depth) * depth.exp2();
        return (rounding / height(own.map(|d| d.as_dvec3()))).to_degrees();
    }
    let [u, v] = to_ptex(patch, uv.map(|x| x as f32)).map(f64::from);
    let truth = LimitSurface::new(model.mesh());
    let sample = truth.evaluate(patch.ptex as usize, u, v);
    let sample = sample.expect("patches are no holes");
    let height = height([sample.du, sample.dv].map(|d| d / model.placement().scale));
    // Above that it is less than 1e-3 degrees even if all errors add up.
    match height < 0.01 {
        true => (f64::from(f32::EPSILON) / height).to_degrees(),
        false => 0.0,
    }
}

fn assert_none(failures: &[String]) {
    let some: Vec<&String> = failures.iter().take(12).collect();
    assert!(
        failures.is_empty(),
        "{} points, such as {some:#?}",
        failures.len()
    );
}

#[test]
fn the_limit_of_a_planar_mesh_has_the_planes_normal() {
    let mut failures = Vec::new();
    for scheme in Scheme::ALL {
        let (mut worst, mut points, mut turned) = (0.0f64, 0, 0);
        for seed in 0..count(60) {
            let planar = planar(seed, scheme);
            let surface = LimitSurface::new(&planar.mesh);
            for ptex in 0..surface.ptex_count() {
                let (face, _) = surface.face_corner(ptex).expect("it is a ptex face");
                let triangle = planar.mesh.face(face as usize).len() == 3 && scheme.is_whole(3);
                for [u, v] in PLACES {
                    if is_outside(triangle, [u, v]) {
                        continue;
                    }
                    let Some(sample) = surface.evaluate(ptex, u, v) else {
                        continue;
                    };
                    let angle = degrees(sample.normal(), planar.normal);
                    let place = format!("{scheme}, ptex face {ptex} at {u}, {v}");
                    hold(&place, &planar, angle, 1e-8, &mut failures);
                    (worst, points) = (worst.max(angle), points + 1);
                    if sample.normal().dot(planar.normal) < 0.0 {
                        turned += 1;
                        if std::env::var_os("HULLFORM_TURNED").is_some() {
                            println!("seed {seed}, {place} is turned over");
                        }
                    }
                }
            }
        }
        println!("{scheme}: {points} points, {worst:.1e} degrees at worst, {turned} turned over");
        // Folds are rare: cells are shaken by less than a third of their size.
        assert!(
            100 * turned < points,
            "{scheme}: {turned} of {points} are turned over"
        );
    }
    assert_none(&failures);
}

#[test]
fn every_method_draws_a_planar_mesh_with_the_planes_normal() {
    let mut failures = Vec::new();
    for method in METHODS {
        let (mut worst, mut points) = (0.0f64, 0);
        for &scheme in method.schemes {
            for seed in 0..count(25) {
                let planar = planar(seed, scheme);
                let model = Model::new(planar.mesh.clone());
                let Ok(prepared) = method.prepare(&model, MethodOptions::default()) else {
                    continue;
                };
                let controls = prepared.controls(model.positions());
                for pass in &prepared.passes {
                    for (number, patch) in pass.patches.iter().enumerate() {
                        for uv in PLACES {
                            if is_outside(pass.domain == Domain::Triangles, uv) {
                                continue;
                            }
                            let at = Vec2::from(uv.map(|x| x as f32));
                            let point = pass.evaluate(&controls, number, at);
                            let angle = degrees(point.normal.as_dvec3(), planar.normal);
                            let place = format!(
                                "{scheme} by {}, ptex face {} at {at}",
                                method.name, patch.ptex
                            );
                            if angle > 5e-4 {
                                let own = pass.tangents(&controls, number, at, 64.0);
                                let own = own.expect("all methods have tangents");
                                let bound = 5e-4 + left_by_rounding(&model, patch, uv, own);
                                hold(&place, &planar, angle, bound, &mut failures);
                            }
                            (worst, points) = (worst.max(angle), points + 1);
                        }
                    }
                }
            }
        }
        println!(
            "{}: {points} points, {worst:.1e} degrees at worst",
            method.name
        );
    }
    assert_none(&failures);
}
