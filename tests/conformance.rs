//! `hullform verify`: it finds seeded faults in every group, survives crashes and hangs, and says what it found in every format.
//!
//! The whole suite takes a minute and is not run here: a part of each group is.
#![cfg(feature = "cli")]

mod common;

use std::collections::BTreeMap;
use std::path::Path;

use common::cli::{fails, has_device, hullform, run, stderr, stdout};
use hullform::conformance::SMOKE;
use serde_json::Value;

/// Runs the suite and returns the statuses by name, from the CSV.
fn statuses(arguments: &[&str], code: i32) -> BTreeMap<String, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("results.csv");
    let csv = csv.to_str().expect("a plain name");
    let output = run(&[&["verify", "--csv", csv], arguments].concat());
    let words = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {words}");
    let text = std::fs::read_to_string(csv).expect("results were written");
    let read = |line: &str| {
        let [name, status, seconds] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("{line}: three columns");
        };
        assert!(seconds.parse::<f64>().expect("seconds are a number") >= 0.0);
        (name.to_owned(), status.to_owned())
    };
    text.lines().map(read).collect()
}

fn all_are(statuses: &BTreeMap<String, String>, wanted: &str) {
    assert!(!statuses.is_empty());
    for (name, status) in statuses {
        assert_eq!(status, wanted, "{name}");
    }
}

#[test]
fn a_part_of_each_group_passes_under_validation() {
    if !has_device() {
        return;
    }
    for part in SMOKE {
        all_are(&statuses(&["--validation", "--filter", part], 0), "Pass");
    }
}

#[test]
fn a_seeded_fault_is_caught_in_every_group() {
    if !has_device() {
        return;
    }
    for part in SMOKE {
        let found = statuses(&["--fault", "wrong:*", "--filter", part], 1);
        all_are(&found, "Fail");
    }
}

/// Its measurements are right or wrong as it happens; what is missing is seen all the same.
#[test]
fn a_missing_barrier_is_told_by_synchronization_validation() {
    if !has_device() {
        return;
    }
    let case = "compute_visibility.memory_barrier.control-300_patches";
    let arguments = ["--validation", "--filter", case, "--fault", "wrong:*"];
    let words = measured(&arguments, case);
    assert!(words.contains("SYNC-HAZARD-READ-AFTER-WRITE"), "{words}");
}

#[test]
fn odd_levels_draws_and_meshes_are_caught_as_well() {
    if !has_device() {
        return;
    }
    for part in [
        "robustness.empty.*",
        "robustness.mesh.one_*",
        "robustness.corrupted.weights-*",
    ] {
        let found = statuses(&["--fault", "wrong:*", "--filter", part], 1);
        all_are(&found, "Fail");
    }
}

const PART: &str = "coordinates.isolines-equal.*";
const VICTIM: &str = "coordinates.isolines-equal.counts";

/// Every case but the victim passes.
fn others_pass(mut statuses: BTreeMap<String, String>, victim: &str) {
    assert_eq!(statuses.remove(VICTIM).as_deref(), Some(victim));
    assert!(statuses.len() > 5);
    all_are(&statuses, "Pass");
}

#[test]
fn a_crash_ends_its_case_and_not_the_suite() {
    if !has_device() {
        return;
    }
    let fault = format!("crash:{VICTIM}");
    let found = statuses(&["--filter", PART, "--fault", &fault], 1);
    others_pass(found, "Crash");
}

/// What a case measured, from the JSON that a run with these arguments prints.
fn measured(arguments: &[&str], case: &str) -> String {
    let output = hullform(&[&["verify", "--json"], arguments].concat())
        .env("RUST_BACKTRACE", "1")
        .output()
        .expect("the program starts");
    let read: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let results = read["results"].as_array().expect("a list");
    let found = results.iter().find(|result| result["name"] == case);
    let measured = found.and_then(|result| result["measured"].as_str());
    measured.expect("the case has a result").to_owned()
}

#[test]
fn a_panic_is_told_as_our_own_and_with_its_message() {
    if !has_device() {
        return;
    }
    let fault = format!("panic:{VICTIM}");
    let arguments = ["--filter", PART, "--fault", &fault];
    others_pass(statuses(&arguments, 1), "Crash");
    let words = measured(&arguments, VICTIM);
    assert!(
        words.starts_with("hullform itself panicked at src"),
        "{words}"
    );
    assert!(words.contains("a fault was seeded"), "{words}");
    // A crash that is none of ours is told by how the process ended.
    let fault = format!("crash:{VICTIM}");
    let words = measured(&["--filter", PART, "--fault", &fault], VICTIM);
    assert!(words.contains("signal"), "{words}");
}

/// Nothing can be known of the driver then, but the report is there.
#[test]
fn a_driver_that_crashes_while_the_device_is_opened_is_reported() {
    if !has_device() {
        return;
    }
    let found = statuses(&["--filter", PART, "--fault", "crash:device"], 1);
    assert!(found.len() > 5);
    all_are(&found, "Crash");
    let arguments = ["--filter", PART, "--fault", "panic:device"];
    all_are(&statuses(&arguments, 1), "Crash");
    let words = measured(&arguments, VICTIM);
    assert!(
        words.starts_with("while the device was opened: "),
        "{words}"
    );
}

/// As when one builds anew while the cases run: the workers are still those of the program that was started.
#[cfg(target_os = "linux")]
#[test]
fn a_program_that_is_removed_finishes_its_run() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let program = folder.path().join("hullform");
    std::fs::copy(env!("CARGO_BIN_EXE_hullform"), &program).expect("a copy");
    let running = std::process::Command::new(&program)
        .args(["verify", "--json", "--filter", PART])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .expect("the copy starts");
    std::fs::remove_file(&program).expect("it is ours");
    let output = running.wait_with_output().expect("it ends");
    let read: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(read["unexpected"], 0);
    assert!(read["results"].as_array().expect("a list").len() > 5);
}

#[test]
fn a_hang_ends_its_case_and_not_the_suite() {
    if !has_device() {
        return;
    }
    let fault = format!("hang:{VICTIM}");
    let arguments = ["--filter", PART, "--fault", &fault, "--time-limit", "8"];
    others_pass(statuses(&arguments, 1), "Timeout");
}

#[test]
fn repetitions_that_differ_are_a_flake() {
    if !has_device() {
        return;
    }
    let fault = format!("flicker:{VICTIM}");
    let arguments = ["--filter", PART, "--fault", &fault, "--repeat", "3"];
    others_pass(statuses(&arguments, 1), "Flake");
    let quiet = ["--filter", PART, "--repeat", "3", "--jobs", "1"];
    all_are(&statuses(&quiet, 0), "Pass");
}

fn written(folder: &Path, text: &str) -> String {
    let path = folder.join("expectations.txt");
    std::fs::write(&path, text).expect("a file");
    path.to_str().expect("a plain name").to_owned()
}

#[test]
fn expectations_decide_what_is_unexpected() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let row = format!("{VICTIM} Fail it is a test");
    let list = written(folder.path(), &row);
    let part = ["--filter", PART, "--expectations", &list];
    others_pass(statuses(&part, 1), "UnexpectedImprovement");
    let fault = format!("wrong:{VICTIM}");
    let faulty = [&part[..], &["--fault", &fault]].concat();
    others_pass(statuses(&faulty, 0), "ExpectedFail");
    // A crash is not the failure that was expected.
    let fault = format!("crash:{VICTIM}");
    let crashing = [&part[..], &["--fault", &fault]].concat();
    others_pass(statuses(&crashing, 1), "Crash");
}

/// deqp-runner's lists: of fails with their statuses, of flakes, and of what is left out.
#[test]
fn what_a_run_exports_the_next_one_expects() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let name = folder.path().join("known").display().to_string();
    let fails = format!("{name}-fails.txt");
    let fault = format!("crash:{VICTIM}");
    let part = ["--filter", PART, "--fault", &fault];
    let export = ["--export-expectations", name.as_str()];
    others_pass(statuses(&[&part[..], &export].concat(), 1), "Crash");
    let text = std::fs::read_to_string(&fails).expect("it was written");
    assert_eq!(text, format!("hullform.{VICTIM},Crash\n"));
    let known = [&part[..], &["--expectations", &fails]].concat();
    others_pass(statuses(&known, 0), "ExpectedFail");
    std::fs::write(format!("{name}-skips.txt"), "isolines-equal\\.counts$\n").expect("written");
    others_pass(statuses(&known, 0), "Skip");
    let words = fails_to_write(&export);
    assert!(words.contains("known-fails.txt"), "{words}");
}

/// A list that is read is not written.
fn fails_to_write(export: &[&str; 2]) -> String {
    let list = format!("{}-fails.txt", export[1]);
    let arguments = ["verify", "--filter", PART, "--expectations", &list];
    fails(&[&arguments[..], export].concat(), 2)
}

#[test]
fn a_list_that_makes_no_sense_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let list = written(folder.path(), "# fine\ncoordinates.* Fial why");
    if has_device() {
        let words = fails(&["verify", "--expectations", &list], 2);
        assert!(words.contains("expectations.txt:2: "), "{words}");
        let words = fails(&["verify", "--expectations", "/no/such/file"], 2);
        assert!(words.contains("/no/such/file"), "{words}");
    }
}

#[test]
fn json_and_junit_tell_the_same() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| {
        let path = folder.path().join(name);
        path.to_str().expect("a plain name").to_owned()
    };
    let (json, junit) = (place("results.json"), place("results.xml"));
    let fault = format!("wrong:{VICTIM}");
    let output = run(&[
        "verify", "--filter", PART, "--json", &json, "--junit", &junit, "--fault", &fault,
        "--seed", "7",
    ]);
    assert_eq!(output.status.code(), Some(1));
    // One line for the failure, on stderr; the summary on stdout.
    let words = stderr(&output);
    assert_eq!(
        words.matches(&format!("Fail {VICTIM}: ")).count(),
        1,
        "{words}"
    );
    assert!(stdout(&output).contains("Fail 1"));
    let read: Value =
        serde_json::from_str(&std::fs::read_to_string(json).expect("written")).expect("JSON");
    let results = read["results"].as_array().expect("a list");
    assert_eq!(read["unexpected"], 1);
    assert_eq!(read["seed"], 7);
    for result in results {
        for key in ["name", "status", "rule", "source", "measured"] {
            let text = result[key].as_str().expect("a text");
            assert!(!text.is_empty(), "{result}");
        }
    }
    let xml = std::fs::read_to_string(junit).expect("written");
    assert!(xml.starts_with("<?xml"));
    assert_eq!(xml.matches("<testcase ").count(), results.len());
    assert_eq!(xml.matches("<failure ").count(), 1);
    // Nothing half-written stays.
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("a folder").count(),
        2
    );
}

#[test]
fn json_without_a_file_is_printed() {
    if !has_device() {
        return;
    }
    for arguments in [
        ["verify", "--filter", PART, "--json"],
        ["--json", "verify", "--filter", PART],
    ] {
        let output = run(&arguments);
        let read: Value = serde_json::from_str(&stdout(&output)).expect("JSON alone");
        assert_eq!(read["unexpected"], 0);
    }
}

#[test]
fn lists_and_filters() {
    let all = stdout(&run(&["verify", "--list"]));
    assert!(all.lines().count() > 300);
    let some = stdout(&run(&[
        "verify",
        "--list",
        "--filter",
        "visibility.*.batches",
    ]));
    assert!(some.lines().all(|line| line.starts_with("visibility.")));
    assert!(some.lines().count() > 3 && some.lines().all(|line| all.contains(line)));
    let output = run(&["verify", "--list", "--json", "--filter", "scale.*"]);
    let read: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert!(read["cases"][0]["rule"].as_str().is_some());
    let words = fails(&["verify", "--filter", "no.such.*"], 2);
    assert!(words.contains("no case matches 'no.such.*'"), "{words}");
}

#[test]
fn meshes_of_the_user_are_verified() {
    if !has_device() {
        return;
    }
    let mut found = statuses(&["builtin:cube", "builtin:ngons"], 0);
    // Every face of the second is beside a semi-sharp edge, which turns as fast as it likes.
    let nothing_to_say = found.remove("witness.corners.model_ngons");
    assert_eq!(nothing_to_say.as_deref(), Some("Skip"));
    all_are(&found, "Pass");
    for start in [
        "limit.model.cube",
        "edges.model.cube",
        "witness.corners.model_cube",
        "statistics.model.ngons",
    ] {
        assert!(found.keys().any(|name| name.starts_with(start)), "{start}");
    }
    let words = fails(&["verify", "/no/such.obj"], 2);
    assert!(words.contains("/no/such.obj"), "{words}");
}

/// A face between others, so that it has a surface whatever happens at the boundary, and tags.
fn sheet_with(tags: &str) -> String {
    let vertices = (0..16).map(|i| format!("v {} {} {}\n", i % 4, i / 4, i * i % 3));
    let corners = (0..9).map(|i| 4 * (i / 3) + i % 3 + 1);
    let faces = corners.map(|a| format!("f {} {} {} {}\n", a, a + 1, a + 5, a + 4));
    vertices.chain(faces).collect::<String>() + tags
}

/// What a mesh has no surface for, or no method a way to draw, is nobody's fault.
#[test]
fn meshes_that_cannot_be_compared_are_skipped() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let named = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_str().expect("a plain name").to_owned()
    };
    let one_face = "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nf 1 2 3 4\n";
    let no_boundary = "t interpolateboundary 1/0/0 0\n";
    let bare = named("bare.obj", &(one_face.to_owned() + no_boundary));
    for (name, status) in statuses(&[&bare], 0) {
        assert_eq!(status, "Skip", "{name}");
    }
    let alone = named("alone.obj", one_face);
    let found = statuses(&[&alone], 0);
    assert_eq!(found["limit.model.alone-equal"], "Pass");
    assert_eq!(found["edges.model.alone-equal"], "Skip");
    let sheet = named("sheet.obj", &sheet_with(""));
    let found = statuses(&["--scheme", "bilinear", &sheet], 0);
    assert_eq!(found["limit.model.sheet-equal"], "Pass");
    assert_eq!(found["edges.model.sheet-equal"], "Skip");
    // The only methods for triangles beside quads have no way to draw this crease.
    let creased = named("creased.obj", &sheet_with("t crease 2/1/0 5 6 1.5\n"));
    let output = run(&["verify", "--json", "--scheme", "loop-stam", &creased]);
    let read: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(read["unexpected"], 0, "{read:#}");
}

#[test]
fn files_that_cannot_be_written_are_known_before_the_work() {
    for option in ["--csv", "--json", "--junit"] {
        let words = fails(&["verify", option, "/no/such/folder/file"], 2);
        assert!(
            words.starts_with("hullform: /no/such/folder/file: "),
            "{words}"
        );
    }
}

#[test]
fn without_a_suitable_device_nothing_runs() {
    let words = fails(&["verify", "--device", "no such device"], 3);
    assert!(words.contains("no suitable Vulkan device"), "{words}");
}
