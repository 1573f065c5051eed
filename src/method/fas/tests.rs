//! Patches beside end caps are the limit, corners of caps too, and levels meet without a gap.

use glam::Vec3;

use super::METHOD;
use crate::mesh::{Model, builtin};
use crate::method::{Controls, EndCaps, IsolationOptions, Pass, Prepared, to_ptex};
use crate::subdivision::LimitSurface;
use crate::tessellation::{Spacing, levels};

fn prepared(name: &str, level: u32, caps: EndCaps) -> (Model, Prepared, Controls) {
    let model = Model::new(builtin(name).expect("it is built in"));
    let prepared = METHOD.prepare(&model, IsolationOptions { level, caps });
    let prepared = prepared.expect("it takes the model");
    let controls = prepared.controls(model.positions());
    (model, prepared, controls)
}

const CAPS: [EndCaps; 4] = [
    EndCaps::Bicubic,
    EndCaps::Gregory,
    EndCaps::Legacy,
    EndCaps::Bspline,
];

const MODELS: [&str; 5] = ["cube", "ngons", "hull", "creased-torus", "sheet"];

/// How far a point of a patch is from the truth, over the diagonal, and by how many degrees its normal.
fn error(
    model: &Model,
    truth: &LimitSurface,
    (pass, controls): (&Pass, &Controls),
    patch: usize,
    uv: [f32; 2],
) -> [f64; 2] {
    let record = &pass.patches[patch];
    let [u, v] = to_ptex(record, uv).map(f64::from);
    let right = truth.evaluate(record.ptex as usize, u, v);
    let right = right.expect("it has a surface");
    let point = pass.evaluate(controls, patch, uv.into());
    let away = model.placement().local(right.position);
    let away = away.distance(point.position.as_dvec3()) / model.diagonal();
    let (own, normal) = (point.normal.as_dvec3(), right.normal());
    let turned = own.cross(normal).length().atan2(own.dot(normal));
    [away, turned.to_degrees()]
}

/// At no refinement too, where caps have several extraordinary corners.
#[test]
fn patches_beside_caps_and_corners_of_caps_are_the_limit() {
    for (name, caps, level) in MODELS
        .into_iter()
        .flat_map(|name| CAPS.map(|caps| (name, caps, 3)))
        .chain([("cube", EndCaps::Gregory, 0), ("hull", EndCaps::Bspline, 0)])
    {
        let (model, prepared, controls) = prepared(name, level, caps);
        let truth = LimitSurface::new(model.mesh());
        let (mut beside, mut turned, mut corners, mut within) = (0.0f64, 0.0f64, 0.0f64, 0.0f64);
        for pass in &prepared.passes {
            for patch in 0..pass.patches.len() {
                for i in 0..25 {
                    let uv = [i % 5, i / 5].map(|x| x as f32 / 4.0);
                    let given = (pass, &controls);
                    let [away, degrees] = error(&model, &truth, given, patch, uv);
                    let is_corner = uv.iter().all(|x| x.fract() == 0.0);
                    match (pass.caps, is_corner) {
                        (false, _) => {
                            beside = beside.max(away);
                            turned = turned.max(degrees);
                        }
                        (true, true) => corners = corners.max(away),
                        (true, false) => within = within.max(away),
                    }
                }
            }
        }
        println!(
            "{name} {caps:?} {level}: {beside:.1e} and {turned:.4} degrees beside caps, {corners:.1e} at their corners, {within:.1e} within"
        );
        assert!(
            beside < 1e-6 && corners < 1e-6,
            "{name} {caps:?}: {beside} {corners}"
        );
        assert!(turned < 0.1, "{name}: {turned}");
        assert!(level == 0 || within < 4e-3, "{name} {caps:?}: {within}");
    }
}

/// Gregory caps are smooth across their edges; bicubic ones and B-splines are not. Those that are summed in shaders are the same.
#[test]
fn gregory_caps_have_one_plane_along_edges() {
    let greatest = |caps: EndCaps| {
        let (_, prepared, controls) = prepared("cube", 2, caps);
        let mut normals: Vec<(Vec3, Vec3)> = Vec::new();
        for pass in prepared.passes.iter().filter(|pass| pass.caps) {
            for patch in 0..pass.patches.len() {
                for uv in [[0.25, 0.0], [1.0, 0.25], [0.25, 1.0], [0.0, 0.25]] {
                    for uv in [uv, uv.map(|x| if x == 0.25 { 0.75 } else { x })] {
                        let point = pass.evaluate(&controls, patch, uv.into());
                        normals.push((point.position, point.normal));
                    }
                }
            }
        }
        let mut turned = 0.0f32;
        let mut pairs = 0;
        for (i, a) in normals.iter().enumerate() {
            for b in normals[..i].iter().filter(|b| b.0.distance(a.0) < 1e-6) {
                turned = turned.max(a.1.cross(b.1).length().asin().to_degrees());
                pairs += 1;
            }
        }
        assert_eq!(pairs, 8 * 3 * 2, "both sides of three edges at each corner");
        turned
    };
    let [bicubic, gregory, legacy, bspline] = CAPS.map(greatest);
    println!("degrees across edges: {bicubic}, {gregory}, {legacy}, {bspline}");
    assert!(gregory < 0.01 && legacy < 0.01, "{gregory} {legacy}");
    assert!(bicubic > 0.05 && bspline > 0.05, "{bicubic} {bspline}");
}

/// Each stretch of an edge is met by one the other way, at whatever level and spacing.
#[test]
fn levels_meet_without_a_gap() {
    for (name, level, caps) in [
        ("cube", 2, EndCaps::Bicubic),
        ("cube", 0, EndCaps::Gregory),
        ("ngons", 3, EndCaps::Bspline),
        ("ngons", 0, EndCaps::Legacy),
        ("creased-torus", 2, EndCaps::Gregory),
    ] {
        let (_, prepared, controls) = prepared(name, level, caps);
        for level in [1.0, 3.0, 8.0, 13.5] {
            for spacing in [Spacing::Equal, Spacing::FractionalEven] {
                let (all, open, differing) = stretches(&prepared, &controls, level, spacing);
                println!("{name} {level} {spacing:?}: {differing} of {all} ends have other bits");
                assert_eq!(open, 0, "{name} {level} {spacing:?}");
            }
        }
    }
}

/// The stretches of patches' edges: how many, how many have none that runs the other way, and how many have one whose beginning differs in a bit.
fn stretches(
    prepared: &Prepared,
    controls: &Controls,
    level: f32,
    spacing: Spacing,
) -> (usize, usize, usize) {
    let mut stretches: Vec<[Vec3; 2]> = Vec::new();
    for pass in &prepared.passes {
        for patch in 0..pass.patches.len() {
            let record = &pass.patches[patch];
            let levels = levels(pass.domain, record, level, spacing, pass.max_level);
            for edge in 0..4 {
                let segments = spacing.segments(levels.edges[edge]);
                let at = |i: u32| {
                    let t = i as f32 / segments as f32;
                    let uv = [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]][edge];
                    pass.evaluate(controls, patch, uv.into()).position
                };
                stretches.extend((0..segments).map(|i| [at(i), at(i + 1)]));
            }
        }
    }
    let middle = |[a, b]: &[Vec3; 2]| a.x + b.x;
    stretches.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
    let near = |a: Vec3, b: Vec3| a.distance(b) < 2e-6;
    let partner = |own: &[Vec3; 2]| {
        let from = stretches.partition_point(|other| middle(other) < middle(own) - 1e-5);
        let mut beside = stretches[from..].iter();
        beside.find(|other| near(other[0], own[1]) && near(other[1], own[0]))
    };
    let partners = stretches.iter().map(|own| (own, partner(own)));
    let (mut open, mut differing) = (0, 0);
    for (own, partner) in partners {
        open += usize::from(partner.is_none());
        differing += usize::from(partner.is_some_and(|other| other[1] != own[0]));
    }
    (stretches.len(), open, differing)
}
