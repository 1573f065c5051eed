//! `--adaptive` and `--cull` of `render` and `bench`: what the device decides is counted, and what is left out is not seen.
#![cfg(feature = "cli")]

mod common;

use common::cli::{fails, has_device, run, stderr, stdout};
use hullform::method::{METHODS, Reproduces};
use serde_json::Value;

/// A picture of the built-in tugboat, and its statistics.
fn picture(more: &[&str]) -> (Vec<u8>, Value) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.png");
    let file = file.to_string_lossy();
    let usual = [
        "render",
        "builtin:hull",
        "--size",
        "320x180",
        "--json",
        "-o",
        &file,
    ];
    let output = run(&[&usual[..], more].concat());
    assert!(output.status.success(), "{more:?}: {}", stderr(&output));
    let stats = serde_json::from_str(&stdout(&output)).expect("JSON alone");
    (std::fs::read(&*file).expect("it is written"), stats)
}

fn number(value: &Value) -> u64 {
    value
        .as_u64()
        .unwrap_or_else(|| panic!("{value} is no count"))
}

#[test]
fn the_device_decides_about_levels_and_counts_come_true() {
    if !has_device() {
        return;
    }
    let whole = picture(&["--level", "32"]).1;
    assert!(whole["decided_by_device"].is_null());
    let all = number(&whole["pipeline_statistics"]["clipping_primitives"]);
    for how in ["distance:1", "screen:20", "curvature:20"] {
        for residence in ["ring", "cache"] {
            let stats = picture(&["--level", "32", "--adaptive", how, "--residence", residence]).1;
            let decided = &stats["decided_by_device"];
            let triangles = number(&decided["triangles"]);
            assert!(triangles < all / 2, "{how}: {triangles} of {all}");
            let counted = &stats["pipeline_statistics"];
            assert_eq!(number(&counted["clipping_primitives"]), triangles, "{how}");
            assert!(number(&counted["evaluation_invocations"]) >= number(&decided["vertices"]));
        }
    }
    // With slots from the host that decides, by depth tags.
    let tagged = picture(&["--adaptive", "screen:20", "--slots", "host"]).1;
    assert!(tagged["decided_by_device"].is_null());
}

#[test]
fn what_is_left_out_is_counted_and_not_seen() {
    if !has_device() {
        return;
    }
    let near = ["--camera", "40,22,4"];
    for (cull, without) in [
        ("frustum", "none"),
        ("small", "none"),
        ("frustum,small", "none"),
        ("back", "back"),
        ("all", "back"),
    ] {
        // With slots from the host no patch is left out.
        let whole = picture(&[&near[..], &["--cull", without, "--slots", "host"]].concat());
        let culled = picture(&[&near[..], &["--cull", cull]].concat());
        assert!(whole.0 == culled.0, "{cull}");
        let decided = &culled.1["decided_by_device"];
        let reasons = &decided["patches_culled"];
        let sum: u64 = ["frustum", "back", "small"]
            .map(|why| number(&reasons[why]))
            .iter()
            .sum();
        let drawn = number(&decided["patches_drawn"]);
        assert_eq!(drawn + sum, number(&culled.1["patches"]["total"]), "{cull}");
        assert_eq!(
            number(&reasons["frustum"]) > 0,
            cull.contains("frustum") || cull == "all"
        );
        let points = |stats: &Value| number(&stats["ring"]["points_computed"]);
        assert!(points(&culled.1) <= points(&whole.1));
    }
}

#[test]
fn what_nobody_can_decide_is_refused() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.png");
    let file = file.to_string_lossy();
    for (more, wanted) in [
        (
            &["--cull", "behind"][..],
            "none of none, frustum, back, small, all and front",
        ),
        (&["--cull", "back,front"], "nothing is left"),
        (
            &["--cull", "frustum", "--slots", "host"],
            "leave out --backend, --slots and levels above 64",
        ),
        (
            &[
                "--cull",
                "small",
                "--backend",
                "pattern",
                "--residence",
                "cache",
            ],
            "for the tessellator alone",
        ),
        (&["--cull", "small", "--wireframe"], "leave out small"),
        (
            &["--cull", "frustum", "--amplify-cracks"],
            "--amplify-cracks",
        ),
    ] {
        let usual = ["render", "builtin:cube", "-o", &file];
        let words = fails(&[&usual[..], more].concat(), 2);
        assert!(words.contains(wanted), "{more:?}: {words}");
    }
    let bench = [
        "bench",
        "builtin:cube",
        "--adaptive",
        "screen",
        "--backend",
        "pattern",
    ];
    assert!(fails(&bench, 2).contains("--adaptive"));
}

#[test]
fn benches_count_what_is_decided() {
    if !has_device() {
        return;
    }
    let rows = |more: &[&str]| {
        let usual = [
            "bench",
            "builtin:hull",
            "--levels",
            "16",
            "--frames",
            "1",
            "--json",
        ];
        let output = run(&[&usual[..], more].concat());
        assert!(output.status.success(), "{more:?}: {}", stderr(&output));
        let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON alone");
        report["rows"].as_array().expect("rows").clone()
    };
    let whole = rows(&["--residence", "ring,cache"]);
    let decided = rows(&[
        "--residence",
        "ring,cache",
        "--adaptive",
        "screen:16",
        "--cull",
        "all",
        "--camera",
        "40,22,4",
    ]);
    assert_eq!(whole.len(), decided.len());
    for (whole, decided) in whole.iter().zip(&decided) {
        assert_eq!(
            (&whole["decides"], &decided["decides"]),
            (&"host".into(), &"device".into())
        );
        // What is refined beforehand is drawn as it is: the device decides no level of it.
        let method = METHODS.iter().find(|row| decided["method"] == row.name);
        let method = method.expect("it is one of the table");
        let is_refined =
            method.isolates && matches!(method.contract.reproduces, Reproduces::Itself);
        for what in ["triangles", "evaluation_invocations"] {
            let (decided, whole) = (number(&decided[what]), number(&whole[what]));
            assert_eq!(decided == whole, is_refined, "{what}: {decided} of {whole}");
            assert!(decided <= whole, "{what}: {decided} of {whole}");
        }
        let culled = ["culled_frustum", "culled_back", "culled_small"];
        let culled: u64 = culled.map(|why| number(&decided[why])).iter().sum();
        assert_eq!(
            number(&decided["patches"]) + culled,
            number(&whole["patches"]),
            "{decided}"
        );
        assert!(number(&decided["points_computed"]) <= number(&whole["points_computed"]));
    }
}
