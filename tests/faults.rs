//! The conformance suite on drivers that break one rule: a layer changes commands, pipelines or shaders on their way, and a case of the group that the rule belongs to fails.
#![cfg(all(feature = "cli", target_os = "linux"))]

mod common;

use std::collections::BTreeSet;

use common::cli::{has_device, hullform, stderr, stdout};
use serde_json::Value;
use wrong_driver::{Fault, WrongDriver};

/// A fault, and a case that finds it.
const FOUND: &[(Fault, &str)] = &[
    (Fault::DrawsOneLess, "draws.instances.draw-3_of_5"),
    (Fault::DrawsNothing, "draws.empty.draw-no_vertices"),
    (
        Fault::ForgetsFirstInstance,
        "draws.first.draw-vertex_4-instance_1",
    ),
    (
        Fault::ForgetsFirstVertex,
        "draws.first.draw-vertex_1000-instance_0",
    ),
    (
        Fault::ForgetsOffset,
        "draws.index.indexed-32_bits-from_4-vertex_40000",
    ),
    (
        Fault::ShortIndices,
        "draws.index.indexed-32_bits-from_0-vertex_0",
    ),
    (
        Fault::DrawsFirstCommand,
        "draws.several.indirect-17_commands-together",
    ),
    (Fault::DropsManyPatches, "draws.many.draw-131073_patches"),
    (Fault::KeepsPatchSize, "state.dynamic_points.1"),
    (Fault::LosesSecondary, "state.secondary.1"),
    (Fault::ClearsRenderings, "state.rendering.1"),
    (
        Fault::KeepsPipeline,
        "state.domains.triangles_equal-quads_equal",
    ),
    (Fault::KeepsConstants, "state.mixed.1"),
    (Fault::DrawsFirstView, "state.views.pass-two-quads-equal"),
    (
        Fault::WrongViewNumber,
        "state.views.rendering-two-evaluation_reads",
    ),
    (
        Fault::FeedbackBeyond,
        "connectivity.feedback_room.quads-equal-whole-few",
    ),
    (
        Fault::EqualSpacing,
        "connectivity.count.quads-fractional_odd-between-some",
    ),
    (Fault::CountsOneMore, "geometry.occlusion.quads-equal"),
    (Fault::CountsOneMore, "geometry.statistics.quads-equal"),
    (Fault::CountsOneMore, "statistics.tessellator.quads-equal"),
    (Fault::InvokesOnce, "geometry.invocations.quads-equal-ccw-4"),
    (Fault::ClipsForCulls, "geometry.clip.quads-equal-0"),
    (Fault::ForgetsPoints, "geometry.point_size.quads-5"),
    (
        Fault::OriginAbove,
        "winding.triangles.quads-equal-ccw-cull_back-front_ccw-lower",
    ),
    (
        Fault::FrontsAreBacks,
        "winding.triangles.quads-equal-ccw-cull_none-front_ccw-upper",
    ),
    (
        Fault::CullsNothing,
        "winding.triangles.quads-equal-ccw-cull_both-front_ccw-upper",
    ),
    (
        Fault::OtherOrder,
        "winding.triangles.quads-equal-ccw-cull_none-front_cw-upper",
    ),
    (
        Fault::ForgetsPoints,
        "winding.points.quads-equal-ccw-cull_both",
    ),
    (Fault::PatchesAreLarger, "io.vertices.3_in-4_out"),
    (Fault::WrongPatchVertices, "io.vertices.3_in-4_out"),
    (
        Fault::EqualSpacing,
        "coordinates.quads-fractional_odd.counts",
    ),
    (
        Fault::ForgetsBarriers,
        "barriers.vertex_outputs.32_invocations-1_patches",
    ),
    (
        Fault::ForgetsBarriers,
        "barriers.buffer.32_invocations-300_patches",
    ),
    (
        Fault::WrongPatchNumber,
        "scale.primitive_id.evaluation-draw-1024_patches-1_points",
    ),
    (
        Fault::WrongFragmentNumber,
        "primitive_id.written.draw-7_patches-3_points-level_1",
    ),
    (Fault::Reassociates, "precision.evaluation.sum-unit"),
    (Fault::OneTurnMore, "loops.control.tested_first"),
    (Fault::ControlStoresNothing, "visibility.coherent.batches"),
    (Fault::ControlStoresNothing, "limit.kind.regular-equal"),
    (
        Fault::ComputeStoresNothing,
        "compute_visibility.memory_barrier.vertex-1_patches",
    ),
];

/// The groups that know nothing of subdivision, whose faults are a driver's.
const RAW: [&str; 14] = [
    "coordinates",
    "connectivity",
    "winding",
    "scale",
    "draws",
    "primitive_id",
    "io",
    "state",
    "geometry",
    "barriers",
    "loops",
    "precision",
    "visibility",
    "compute_visibility",
];

/// How cases end on a driver with a fault, and what they measured.
fn ends(layer: &WrongDriver, fault: Option<Fault>, filter: &str) -> Vec<(String, String)> {
    let arguments = ["verify", "--json", "--jobs", "1", "--filter", filter];
    let mut command = hullform(&arguments);
    layer.apply(&mut command, fault);
    let output = command.output().expect("the program starts");
    let words = stderr(&output);
    let read: Value = serde_json::from_str(&stdout(&output))
        .unwrap_or_else(|error| panic!("{fault:?}, {filter}: {error}: {words}"));
    let results = read["results"].as_array().expect("a list").iter();
    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    results
        .map(|result| (text(&result["status"]), text(&result["measured"])))
        .collect()
}

#[test]
fn each_broken_rule_is_found_by_a_case_of_its_group() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let layer = WrongDriver::install(folder.path());
    let mut wrong = Vec::new();
    for &(fault, case) in FOUND {
        for (status, measured) in ends(&layer, Some(fault), case) {
            if status == "Skip" {
                println!("skipped: {case}: {measured}");
            } else if status != "Fail" {
                wrong.push(format!("{}: {case}: {status}: {measured}", fault.name()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_fault_and_every_raw_group_has_a_case() {
    let faults: BTreeSet<Fault> = FOUND.iter().map(|(fault, _)| *fault).collect();
    let all: BTreeSet<Fault> = Fault::ALL.iter().copied().collect();
    assert_eq!(faults, all);
    assert!(all.len() >= 25, "{} faults", all.len());
    for group in RAW {
        let own = |case: &str| case.split('.').next() == Some(group);
        assert!(FOUND.iter().any(|(_, case)| own(case)), "{group}");
    }
}

/// What fails on wrong drivers fails for their faults, and not for the layer.
#[test]
fn without_a_fault_the_layer_changes_nothing() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let layer = WrongDriver::install(folder.path());
    for filter in ["*.quads-equal", "state.*.1", "precision.*.sum-unit"] {
        for (status, measured) in ends(&layer, None, filter) {
            assert!(
                ["Pass", "Skip"].contains(&&*status),
                "{filter}: {status}: {measured}"
            );
        }
    }
}
