//! At whatever depths of its irregularities: the surface is covered once, and levels meet without a gap.

use glam::Vec3;

use super::METHOD;
use crate::abi;
use crate::mesh::{Model, builtin};
use crate::method::{Controls, EndCaps, IsolationOptions, Pass, Prepared};
use crate::tessellation::{Spacing, levels_of_edges};

fn prepared(name: &str, level: u32) -> (Model, Prepared, Controls) {
    let model = Model::new(builtin(name).expect("it is built in"));
    let caps = EndCaps::default();
    let prepared = METHOD.prepare(&model, IsolationOptions { level, caps });
    let prepared = prepared.expect("it takes the model");
    let controls = prepared.controls(model.positions());
    (model, prepared, controls)
}

/// Levels of sides such that irregularities have other depths: of edges by the numbers of their vertices, of faces the greatest.
fn levels_of_sides(prepared: &Prepared, seed: u32) -> Vec<f32> {
    let outline = &prepared.outline;
    let tags: Vec<f32> = (0..prepared.vertex_count() as u32)
        .map(|vertex| ((vertex + seed).wrapping_mul(2_654_435_761) >> 30) as f32)
        .collect();
    let depths = outline.depths(&tags).expect("a tag a vertex");
    depths.into_iter().map(f32::exp2).collect()
}

/// What is drawn: pass, patch and record.
fn drawn<'a>(prepared: &'a Prepared, levels: &[f32]) -> Vec<(&'a Pass, usize, abi::Patch)> {
    let depths = prepared.depths_at(|side| levels[side as usize]);
    let passes = prepared.passes.iter();
    let all = passes.flat_map(|pass| (0..pass.patches.len()).map(move |patch| (pass, patch)));
    all.filter_map(|(pass, patch)| {
        let record = pass.at_depths(patch, |of| depths[of as usize])?;
        Some((pass, patch, record))
    })
    .collect()
}

const MODELS: [&str; 5] = ["cube", "ngons", "hull", "creased-torus", "sheet"];

#[test]
fn each_face_is_covered_once_at_all_depths() {
    for name in MODELS {
        let (_, prepared, _) = prepared(name, 3);
        let is_regular = ["sheet", "creased-torus"].contains(&name);
        assert_ne!(prepared.is_dynamic(), is_regular, "{name}");
        for seed in 0..4 {
            let levels = levels_of_sides(&prepared, seed);
            let mut areas = std::collections::BTreeMap::new();
            for (_, _, record) in drawn(&prepared, &levels) {
                let depth = record.plan >> abi::PIECE_DEPTH_SHIFT;
                *areas.entry(record.ptex).or_insert(0.0) += 0.25f64.powi(depth as i32);
            }
            assert!(areas.values().all(|&area| area == 1.0), "{name} {areas:?}");
        }
    }
}

#[test]
fn frames_that_need_less_draw_and_sum_less() {
    let (_, prepared, _) = prepared("cube", 6);
    let counts = |level: f32| {
        let levels = vec![level; 64];
        let depths = prepared.depths_at(|side| levels[side as usize]);
        let needed = prepared.points.spans.iter().flat_map(|span| {
            let parts = span.needed(&prepared.points.steps[span.step], &depths);
            parts.into_iter().map(|part| part.count)
        });
        (drawn(&prepared, &levels).len(), needed.sum::<u32>())
    };
    let [coarse, middle, fine] = [2.0, 8.0, 64.0].map(counts);
    println!("patches and points: {coarse:?} {middle:?} {fine:?}");
    // Six faces of four cells each, of which each has three B-splines and one cap a level.
    assert_eq!([coarse.0, middle.0, fine.0], [24, 24 * 7, 24 * 16]);
    assert!(coarse.1 < middle.1 / 2 && middle.1 < fine.1 / 2);
}

/// Each stretch of an edge is met by one the other way, at whatever depths and spacing; but for boundaries.
#[test]
fn depths_meet_without_a_gap() {
    // The sheet has holes, and nothing irregular.
    for name in MODELS.into_iter().filter(|&name| name != "sheet") {
        let (model, prepared, controls) = prepared(name, 3);
        for seed in 0..3 {
            let levels = levels_of_sides(&prepared, seed);
            // Of fractional levels the least is 2: beside creases the middle of a cap's edge is off then.
            let fractional = (name != "hull").then_some(Spacing::FractionalEven);
            for spacing in [Spacing::Equal].into_iter().chain(fractional) {
                let (all, open) = stretches(&model, (&prepared, &controls), &levels, spacing);
                assert!(all > 100);
                assert_eq!(open, 0, "{name} {seed} {spacing:?}, of {all}");
            }
        }
    }
}

/// The stretches of patches' edges: how many, and how many have none that runs the other way.
fn stretches(
    model: &Model,
    (prepared, controls): (&Prepared, &Controls),
    of_sides: &[f32],
    spacing: Spacing,
) -> (usize, usize) {
    let mut stretches: Vec<[Vec3; 2]> = Vec::new();
    for (pass, patch, record) in drawn(prepared, of_sides) {
        let edges = pass.sides[patch].map(|side| of_sides[side as usize]);
        let levels = levels_of_edges(pass.domain, &record, edges, spacing, pass.max_level);
        let topology = model.topology();
        let is_boundary = |side: u32| {
            (side as usize) < topology.edge_count() && topology.edge_faces(side).len() < 2
        };
        for edge in (0..4).filter(|&edge| !is_boundary(pass.sides[patch][edge])) {
            let segments = spacing.segments(levels.edges[edge]);
            let at = |i: u32| {
                let t = i as f32 / segments as f32;
                let uv = [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]][edge];
                pass.evaluate(controls, patch, uv.into()).position
            };
            stretches.extend((0..segments).map(|i| [at(i), at(i + 1)]));
        }
    }
    let middle = |[a, b]: &[Vec3; 2]| a.x + b.x;
    stretches.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
    let near = |a: Vec3, b: Vec3| a.distance(b) < 2e-6;
    let is_met = |own: &&[Vec3; 2]| {
        let from = stretches.partition_point(|other| middle(other) < middle(own) - 1e-5);
        let mut beside = stretches[from..].iter();
        beside.any(|other| near(other[0], own[1]) && near(other[1], own[0]))
    };
    let met = stretches.iter().filter(is_met).count();
    (stretches.len(), stretches.len() - met)
}
