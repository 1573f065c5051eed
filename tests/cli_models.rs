//! `render`, `tessellate` and `plan` on built-in shapes: what they write, and what they say when they cannot.
#![cfg(feature = "cli")]

mod common;

use std::path::Path;
use std::process::{Command, Output};

use common::cli::{fails, has_device, run, stderr, stdout};
use serde_json::Value;

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", stderr(output));
    serde_json::from_slice(&output.stdout).expect("JSON alone")
}

fn keys(value: &Value) -> Vec<&str> {
    let object = value.as_object().expect("an object");
    object.keys().map(String::as_str).collect()
}

fn number(value: &Value) -> u64 {
    value
        .as_u64()
        .unwrap_or_else(|| panic!("{value} is no whole number"))
}

/// A folder to write into, and the path of a file in it as an argument.
fn scratch(name: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    (folder, path.to_str().expect("UTF-8").to_string())
}

fn assert_empty(folder: &Path) {
    let left: Vec<_> = std::fs::read_dir(folder)
        .expect("the folder is there")
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

/// Whether the validation layer is installed; says so if not.
fn has_validation() -> bool {
    let words = stderr(&run(&["devices", "--validation"]));
    let missing = words.contains("is not installed");
    if missing {
        println!("skipped: {words}");
    }
    !missing
}

#[test]
fn a_plan_is_told_as_json() {
    let plan = json(&run(&["plan", "builtin:ngons", "--json"]));
    let facts = [
        "vertices",
        "faces",
        "patches",
        "regular",
        "irregular",
        "plans",
        "plans_without_sharing",
        "edge_plans",
        "vertex_plans",
        "nodes",
        "stencils",
        "bytes",
        "control_points",
        "build_seconds",
        "seconds",
        "faces_per_second",
        "threads",
        "peak_bytes",
    ];
    assert_eq!(keys(&plan), facts);
    let steps = ["reading", "topology", "preparing"];
    assert_eq!(keys(&plan["seconds"]), steps);
    let nodes = [
        "internal",
        "regular",
        "boundary",
        "crease",
        "terminal",
        "extraordinary",
    ];
    assert_eq!(keys(&plan["nodes"]), nodes);
    let bytes = [
        "vertices",
        "indices",
        "quadtree",
        "borders",
        "stencils",
        "scratch_worst_case",
    ];
    assert_eq!(keys(&plan["bytes"]), bytes);
    assert_eq!(
        keys(&plan["control_points"]),
        ["0", "1", "2", "3", "4", "5", "6"]
    );
    assert!(plan["build_seconds"].as_f64().expect("a number") >= 0.0);
    let patches = number(&plan["patches"]);
    assert_eq!(
        number(&plan["regular"]) + number(&plan["irregular"]),
        patches
    );
    assert!(patches > number(&plan["faces"]), "an n-gon gives n patches");
    let points = plan["control_points"].as_object().expect("an object");
    let points: Vec<u64> = points.values().map(number).collect();
    assert!(points.is_sorted(), "{points:?}");
}

#[test]
fn a_plan_of_another_depth_has_its_levels() {
    let plan = json(&run(&[
        "plan",
        "builtin:cube",
        "--json",
        "--max-level",
        "3",
    ]));
    assert_eq!(keys(&plan["control_points"]), ["0", "1", "2", "3"]);
    assert_eq!(plan["vertices"], 8);
    assert_eq!(plan["patches"], 6);
    assert_eq!(plan["irregular"], 6);
    assert_eq!(plan["bytes"]["vertices"], 8 * 12);
}

/// Copies share plans, and nothing of what is told depends on how many threads plan.
#[test]
fn copies_of_a_model_have_its_plans() {
    let plan = |more: &[&str]| json(&run(&[&["plan", "builtin:hull", "--json"], more].concat()));
    let one = plan(&["--threads", "1"]);
    let nine = plan(&["--replicate", "9", "--threads", "3"]);
    assert_eq!([&one["threads"], &nine["threads"]], [1, 3]);
    for fact in ["plans", "edge_plans", "vertex_plans", "stencils", "nodes"] {
        assert_eq!(one[fact], nine[fact], "{fact}");
    }
    for fact in ["faces", "patches", "regular", "irregular"] {
        assert_eq!(9 * number(&one[fact]), number(&nine[fact]), "{fact}");
    }
    let words = fails(&["plan", "builtin:hull", "--replicate", "4000000000"], 2);
    assert!(words.contains("--replicate"), "{words}");
}

#[test]
fn creases_that_are_refined_away_leave_no_crease_nodes() {
    let with = json(&run(&["plan", "builtin:creased-torus", "--json"]));
    let arguments = [
        "plan",
        "builtin:creased-torus",
        "--json",
        "--no-direct-creases",
    ];
    let without = json(&run(&arguments));
    assert!(number(&with["nodes"]["crease"]) > 0);
    assert_eq!(without["nodes"]["crease"], 0);
    assert!(number(&with["stencils"]) < number(&without["stencils"]));
}

#[test]
fn a_plan_is_told_in_words() {
    let words = stdout(&run(&["plan", "builtin:hull"]));
    assert!(
        words.contains("control points") && words.contains("build seconds"),
        "{words}"
    );
}

/// By its whole path: scripts are called from anywhere.
#[test]
fn a_picture_is_said_to_be_where_it_is() {
    if !has_device() {
        return;
    }
    let (_folder, png) = scratch("out.png");
    let drawn = run(&["render", "builtin:cube", "-o", &png, "--size", "32x32"]);
    assert_eq!(
        stdout(&drawn),
        format!("wrote {png}\n"),
        "{}",
        stderr(&drawn)
    );
    let compared = run(&[
        "compare",
        "builtin:cube",
        "-o",
        &png,
        "--size",
        "32x32",
        "--level",
        "2",
    ]);
    assert!(stdout(&compared).ends_with(&format!("wrote {png}\n")));
}

#[test]
fn an_unknown_method_or_device_is_named() {
    let (folder, png) = scratch("out.png");
    let csv = folder.path().join("out.csv");
    let csv = csv.to_str().expect("UTF-8");
    let words = fails(
        &["render", "builtin:cube", "-o", &png, "--method", "nurbs"],
        2,
    );
    assert!(
        words.contains("'nurbs'") && words.contains("choose one of quadtree, "),
        "{words}"
    );
    let words = fails(
        &["tessellate", "builtin:cube", "-o", csv, "--method", "nurbs"],
        2,
    );
    assert!(words.contains("'nurbs'"), "{words}");
    for command in ["render", "tessellate"] {
        let output = if command == "render" { &png } else { csv };
        let arguments = [
            command,
            "builtin:cube",
            "-o",
            output,
            "--device",
            "no such device",
        ];
        let words = fails(&arguments, 3);
        assert!(words.contains("no suitable Vulkan device"), "{words}");
    }
    assert_empty(folder.path());
}

#[test]
fn a_ring_too_small_names_the_remedy_and_writes_nothing() {
    if !has_device() {
        return;
    }
    let (folder, png) = scratch("out.png");
    let csv = folder.path().join("out.csv");
    let csv = csv.to_str().expect("UTF-8");
    for (command, output) in [("render", png.as_str()), ("tessellate", csv)] {
        let arguments = [command, "builtin:cube", "-o", output, "--ring-bytes", "64"];
        let words = fails(&arguments, 2);
        assert!(
            words.contains("--ring-bytes") && words.contains("give a larger ring"),
            "{words}"
        );
        assert_empty(folder.path());
    }
}

#[test]
fn a_failure_leaves_the_old_file_as_it_was() {
    let (folder, csv) = scratch("out.csv");
    std::fs::write(&csv, "old").expect("it can be written");
    fails(
        &[
            "tessellate",
            "builtin:cube",
            "-o",
            &csv,
            "--ring-bytes",
            "64",
        ],
        if has_device() { 2 } else { 3 },
    );
    assert_eq!(std::fs::read_to_string(&csv).expect("it is there"), "old");
    let entries = std::fs::read_dir(folder.path()).expect("a folder");
    assert_eq!(entries.count(), 1);
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let words = fails(
        &["render", "builtin:cube", "-o", "no/such/folder/out.png"],
        2,
    );
    assert!(words.contains("no/such/folder/out.png"), "{words}");
}

/// Points as a table: the ptex face, where in it, and what is there.
#[test]
fn points_are_written_as_csv() {
    if !has_device() {
        return;
    }
    let (_folder, csv) = scratch("out.csv");
    let arguments = [
        "tessellate",
        "builtin:cube",
        "-o",
        &csv,
        "--level",
        "3",
        "--json",
    ];
    let report = json(&run(&arguments));
    assert_eq!(keys(&report), ["output", "points", "triangles"]);
    assert_eq!(number(&report["points"]), 6 * 16);
    assert_eq!(number(&report["triangles"]), 6 * 18);
    let text = std::fs::read_to_string(&csv).expect("it was written");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("face,u,v,px,py,pz,nx,ny,nz"));
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            line.split(',')
                .map(|cell| cell.parse().expect("a number"))
                .collect()
        })
        .collect();
    assert_eq!(rows.len(), 6 * 16);
    for row in rows {
        let [face, u, v, .., nx, ny, nz] = row[..] else {
            panic!("{row:?}");
        };
        assert_eq!(row.len(), 9);
        assert!((0.0..6.0).contains(&face) && (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v));
        assert!(((nx * nx + ny * ny + nz * nz).sqrt() - 1.0).abs() < 1e-5);
    }
}

#[test]
fn triangles_are_written_as_obj_and_ply() {
    if !has_device() {
        return;
    }
    let (folder, obj) = scratch("out.obj");
    let ply = folder.path().join("out.ply");
    let ply = ply.to_str().expect("UTF-8");
    for path in [obj.as_str(), ply] {
        let output = run(&["tessellate", "builtin:ngons", "-o", path, "--level", "4"]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stdout(&output).contains("triangles"), "{}", stdout(&output));
    }
    let mesh = hullform::mesh::read_obj(Path::new(&obj)).expect("what is written can be read");
    assert!(mesh.face_count() > 1000 && mesh.faces().all(|face| face.len() == 3));
    let bytes = std::fs::read(ply).expect("it was written");
    assert!(bytes.starts_with(b"ply\n"));
}

#[test]
fn statistics_are_written_beside_the_picture() {
    if !has_device() {
        return;
    }
    let (folder, png) = scratch("out.png");
    let stats = folder.path().join("out.json");
    let stats = stats.to_str().expect("UTF-8");
    let mut arguments = vec!["render", "builtin:hull", "-o", &png, "--size", "64x48"];
    arguments.extend(["--stats", stats, "--ring-bytes", "64KiB"]);
    let output = run(&arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = std::fs::read(stats).expect("it was written");
    let stats: Value = serde_json::from_slice(&text).expect("JSON");
    for field in [
        "device",
        "driver",
        "method",
        "level",
        "spacing",
        "workarounds",
        "seconds",
    ] {
        assert!(!stats[field].is_null(), "{field} in {stats}");
    }
    assert_eq!(stats["method"], "quadtree");
    let patches = &stats["patches"];
    let (regular, irregular) = (number(&patches["regular"]), number(&patches["irregular"]));
    assert_eq!(number(&patches["total"]), regular + irregular);
    assert!(
        number(&stats["batches"]) > 1 && number(&stats["draws"]) > 1,
        "{stats}"
    );
    assert_eq!(stats["ring"]["overflows"], 0);
    assert_eq!(stats["ring"]["bytes"], 64 << 10);
    assert!(number(&stats["ring"]["points_computed"]) > 0);
    let counted = &stats["pipeline_statistics"];
    if !counted.is_null() {
        assert_eq!(counted["control_shader_patches"], patches["total"]);
    }
    for step in ["load", "plan", "upload", "first_frame"] {
        assert!(stats["seconds"][step].is_number(), "{step} in {stats}");
    }
}

#[test]
fn drawing_and_tessellating_are_clean_under_validation() {
    if !has_device() || !has_validation() {
        return;
    }
    let (folder, png) = scratch("out.png");
    let csv = folder.path().join("out.csv");
    let csv = csv.to_str().expect("UTF-8");
    let small = ["--size", "64x48", "--validation", "--ring-bytes", "32KiB"];
    let commands: [&[&str]; 4] = [
        &["render", "builtin:hull", "-o", &png, "--wireframe"],
        &["render", "builtin:ngons", "-o", &png, "--slots", "host"],
        &["render", "builtin:sheet", "-o", &png, "--method", "flat"],
        &["tessellate", "builtin:hull", "-o", csv, "--validation"],
    ];
    for arguments in commands {
        let rest: &[&str] = if arguments[0] == "render" {
            &small
        } else {
            &[]
        };
        let output = run(&[arguments, rest].concat());
        let words = stderr(&output);
        assert!(
            output.status.success() && words.is_empty(),
            "{arguments:?}: {words}"
        );
    }
}

/// Who gives slots does not matter, nor how many batches there are.
#[test]
fn tessellations_do_not_depend_on_the_ring() {
    if !has_device() {
        return;
    }
    let (_folder, csv) = scratch("out.csv");
    let tessellate = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hullform"));
        command
            .args(["tessellate", "builtin:ngons", "-o", &csv])
            .args(more);
        let output = command.output().expect("the program starts");
        assert!(output.status.success(), "{}", stderr(&output));
        std::fs::read(&csv).expect("it was written")
    };
    let reference = tessellate(&[]);
    assert!(tessellate(&["--ring-bytes", "16KiB"]) == reference);
    assert!(tessellate(&["--slots", "host"]) == reference);
    assert!(tessellate(&["--residence", "cache"]) == reference);
}

/// Patterns and geometry shaders give the same file; 21 triangles are 21 x 4^3 at level 8, and depth tags need fewer.
#[test]
fn backends_and_depth_tags_are_options() {
    if !has_device() {
        return;
    }
    let (_folder, csv) = scratch("out.csv");
    let model = [
        "tessellate",
        "builtin:pole-7",
        "--scheme",
        "loop",
        "-o",
        &csv,
    ];
    let tessellate = |more: &[&str]| {
        let report = json(&run(&[&model, more, &["--json"][..]].concat()));
        let file = std::fs::read(&csv).expect("it was written");
        (number(&report["triangles"]), file)
    };
    let pattern = tessellate(&["--backend", "pattern"]);
    assert_eq!(pattern.0, 21 << 6);
    assert!(tessellate(&["--backend", "geometry"]) == pattern);
    assert!(tessellate(&["--backend", "pattern", "--points", "device"]) == pattern);
    for how in ["curvature:10", "screen:120", "distance:1"] {
        let (triangles, _) = tessellate(&["--backend", "pattern", "--adaptive", how]);
        assert!((21..pattern.0).contains(&triangles), "{how}: {triangles}");
    }
    let refused = |more: &[&str], wanted: &str| {
        let words = fails(&[&model, more].concat(), 2);
        assert!(words.contains(wanted), "{more:?}: {words}");
    };
    refused(&["--backend", "geometry", "--level", "33"], "--level");
    refused(&["--adaptive", "screen:0"], "greater than 0");
    let ring = [
        "tessellate",
        "builtin:cube",
        "-o",
        &csv,
        "--backend",
        "pattern",
    ];
    assert!(fails(&ring, 2).contains("--backend"));
    // With cached control points it goes.
    let [pattern, geometry] = ["pattern", "geometry"].map(|backend| {
        let cached = ["--residence", "cache", "--backend", backend];
        let report = json(&run(&[&ring[..4], &cached, &["--json"]].concat()));
        assert_eq!(number(&report["triangles"]), 6 * 128);
        std::fs::read(&csv).expect("it was written")
    });
    assert!(pattern == geometry);
}
