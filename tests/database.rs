//! The database of plans on disk: what comes back is what was built, and whatever happens to the file costs plans at most, never a surface.
#![cfg(feature = "cli")]

mod common;

use common::cli::{hullform, run, stderr, stdout};
use hullform::mesh::{Model, builtin};
use hullform::method::{Prepared, method};
use hullform::plan::database::{FileState, VERSION};
use hullform::plan::{Database, PlanOptions};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

/// A small model with all kinds of plans: n-gons, creases, a boundary.
fn model(name: &str) -> Model {
    Model::new(builtin(name).expect("it is built in"))
}

fn prepare(model: &Model, database: &Database) -> Prepared {
    let options = PlanOptions {
        max_level: 3,
        ..PlanOptions::default()
    };
    let quadtree = method("quadtree").expect("it is in the table");
    let prepared = quadtree.prepare_with(model, options, database);
    prepared.expect("the options are sound")
}

/// All bytes that a device gets.
fn tables(prepared: &Prepared) -> Vec<Vec<u32>> {
    prepared
        .passes
        .iter()
        .map(|pass| pass.packed(&[]).0)
        .collect()
}

fn open(path: &Path) -> Database {
    Database::open(path).expect("it is ours")
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder")
}

fn state(path: &Path) -> FileState {
    open(path).verify().expect("it is on disk")
}

/// A file with the plans of a model.
fn written(folder: &tempfile::TempDir, model: &Model) -> PathBuf {
    let path = folder.path().join("plans.db");
    prepare(model, &open(&path));
    path
}

#[test]
fn one_over_another_finds_what_that_has_and_leaves_it_as_it_is() {
    let folder = folder();
    let (known, new) = (model("ngons"), model("creased-torus"));
    let path = written(&folder, &known);
    let under = std::sync::Arc::new(open(&path));
    let before = (state(&path), under.len());
    let over = Database::over(under.clone());
    assert_eq!(
        tables(&prepare(&new, &over)),
        tables(&prepare(&new, &Database::default()))
    );
    assert!(!over.is_empty());
    assert_eq!((state(&path), under.len()), before);
    // What the file has is read from it, and what the other has in memory is found there.
    prepare(&known, &under);
    let (held, own) = (under.len(), over.len());
    prepare(&known, &over);
    assert_eq!((under.len(), over.len()), (held, own));
    assert_eq!(state(&path), before.0);
}

#[test]
fn plans_that_were_kept_are_packed_to_the_same_bytes() {
    let folder = folder();
    for name in ["hull", "ngons", "creased-torus", "pole-40"] {
        let model = model(name);
        let built = tables(&prepare(&model, &Database::default()));
        let path = folder.path().join(name);
        prepare(&model, &open(&path));
        let before = state(&path);
        assert_eq!(
            (before.lost_bytes, before.repeated, before.unsound),
            (0, 0, 0)
        );
        assert!(before.entries[0] > 0);
        let again = open(&path);
        assert_eq!(tables(&prepare(&model, &again)), built, "{name}");
        assert_eq!(state(&path), before, "{name}: nothing was to be added");
    }
}

#[test]
fn a_database_in_memory_gives_models_the_plans_of_others() {
    let (database, model) = (Database::default(), model("hull"));
    let first = prepare(&model, &database);
    let count = database.len();
    assert!(count > 0);
    assert_eq!(tables(&prepare(&model, &database)), tables(&first));
    assert_eq!(database.len(), count);
}

/// Every byte matters to something, and whatever it is, the surface is the same and the next run finds the file whole.
#[test]
fn a_damaged_byte_costs_plans_and_no_surface() {
    let rounds: usize = std::env::var("HULLFORM_DAMAGES")
        .ok()
        .and_then(|rounds| rounds.parse().ok())
        .unwrap_or(300);
    let (folder, model) = (folder(), model("ngons"));
    let path = written(&folder, &model);
    let right = tables(&prepare(&model, &Database::default()));
    let sound = std::fs::read(&path).expect("it was written");
    let all: usize = state(&path).entries.iter().sum();
    for round in 0..rounds {
        let at = (round * 7919 * 31 + round) % sound.len();
        let mut bytes = sound.clone();
        bytes[at] ^= 1 << (round % 8);
        std::fs::write(&path, &bytes).expect("it can be written");
        let Ok(database) = Database::open(&path) else {
            assert!(at < 24, "byte {at}: only a header is refused");
            continue;
        };
        let kept: usize = database.state().expect("on disk").entries.iter().sum();
        assert!(at < 24 || kept + 1 == all, "byte {at}: {kept} of {all}");
        assert_eq!(tables(&prepare(&model, &database)), right, "byte {at}");
        drop(database);
        let mended = state(&path);
        assert_eq!(
            (mended.entries.iter().sum::<usize>(), mended.unsound),
            (all, 0)
        );
    }
}

#[test]
fn a_file_cut_anywhere_is_continued() {
    let (folder, model) = (folder(), model("cube"));
    let path = written(&folder, &model);
    let right = tables(&prepare(&model, &Database::default()));
    let sound = std::fs::read(&path).expect("it was written");
    for length in (0..sound.len()).step_by(1 + sound.len() / 97) {
        std::fs::write(&path, &sound[..length]).expect("it can be written");
        assert_eq!(
            tables(&prepare(&model, &open(&path))),
            right,
            "{length} bytes"
        );
        let state = state(&path);
        assert_eq!(state.unsound, 0);
        let database = open(&path);
        database.prune(u64::MAX).expect("there is room");
        assert_eq!(database.state().expect("on disk").lost_bytes, 0);
        assert_eq!(
            std::fs::metadata(&path).expect("there").len(),
            sound.len() as u64
        );
    }
}

#[test]
fn what_is_no_database_is_left_alone_and_one_of_another_version_begun_anew() {
    let folder = folder();
    let path = folder.path().join("model.obj");
    std::fs::write(&path, "v 0 0 0 # not ours at all\n").expect("a file");
    let error = Database::open(&path).expect_err("it is foreign");
    assert!(
        error.to_string().contains("no database of plans"),
        "{error}"
    );
    assert_eq!(error.exit_code(), 2);
    let kept = std::fs::read_to_string(&path).expect("there");
    assert_eq!(kept, "v 0 0 0 # not ours at all\n");

    let (model, path) = (model("cube"), folder.path().join("old.db"));
    prepare(&model, &open(&path));
    let mut bytes = std::fs::read(&path).expect("it was written");
    bytes[16..20].copy_from_slice(&(VERSION + 1).to_le_bytes());
    let sum = crc32fast::hash(&bytes[..20]);
    bytes[20..24].copy_from_slice(&sum.to_le_bytes());
    std::fs::write(&path, &bytes).expect("it can be written");
    let database = open(&path);
    assert_eq!(database.state().expect("on disk").entries, [0; 5]);
    prepare(&model, &database);
    assert_eq!(state(&path).unsound, 0);
}

#[test]
fn pruning_keeps_the_latest_entries_that_fit() {
    let (folder, first, second) = (folder(), model("hull"), model("cube"));
    let path = written(&folder, &first);
    let database = open(&path);
    prepare(&second, &database);
    let alone = prepare(&second, &Database::default()).plans.expect("plans");
    let before = database.state().expect("on disk");
    database.prune(before.bytes / 2).expect("there is room");
    let after = state(&path);
    assert!(after.bytes <= before.bytes / 2 && after.entries[0] >= alone.plans);
    // Another process that has the old file open goes on with the new one.
    let other = open(&path);
    database.prune(0).expect("there is room");
    assert_eq!(state(&path).entries, [0; 5]);
    prepare(&model("ngons"), &other);
    assert!(state(&path).entries[0] > 0);
}

/// Says what is to be done when plans change: files of old ones must not be read any more.
#[test]
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
fn the_version_changes_when_plans_do() {
    let (folder, model) = (folder(), model("hull"));
    let bytes = std::fs::read(written(&folder, &model)).expect("it was written");
    let found = format!("{VERSION}: {:08x}", crc32fast::hash(&bytes));
    assert_eq!(
        found, FINGERPRINT,
        "plans of before would be read for those of now: count VERSION in src/plan/database/records.rs up, and write down the new sum here"
    );
}

#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
const FINGERPRINT: &str = "4: ad9279d0";

fn plan(path: &str) -> std::process::Command {
    hullform(&["plan", "builtin:hull", "--json", "--db", path])
}

#[test]
fn processes_that_are_killed_leave_what_they_had_finished() {
    let kills: u64 = std::env::var("HULLFORM_KILLS")
        .ok()
        .and_then(|kills| kills.parse().ok())
        .unwrap_or(12);
    let folder = folder();
    let path = folder.path().join("plans.db");
    let name = path.to_str().expect("a name");
    let right = tables(&prepare(&model("cube"), &Database::default()));
    prepare(&model("cube"), &open(&path));
    let acknowledged: usize = state(&path).entries.iter().sum();
    for kill in 0..kills {
        let mut running = plan(name)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("it starts");
        std::thread::sleep(Duration::from_micros(kill * 7919 % 40_000));
        running.kill().expect("it is ours");
        running.wait().expect("it ended");
        let state = state(&path);
        assert_eq!(state.unsound, 0);
        assert!(state.entries.iter().sum::<usize>() >= acknowledged);
        assert_eq!(tables(&prepare(&model("cube"), &open(&path))), right);
    }
    let output = plan(name).output().expect("it starts");
    assert!(output.status.success(), "{}", stderr(&output));
    let all: usize = state(&path).entries.iter().sum();
    assert!(all > acknowledged);
}

#[test]
fn eight_processes_share_a_file() {
    let folder = folder();
    let path = folder.path().join("plans.db");
    let name = path.to_str().expect("a name");
    let running: Vec<_> = (0..8)
        .map(|_| {
            plan(name)
                .stdout(Stdio::piped())
                .spawn()
                .expect("it starts")
        })
        .collect();
    let results: Vec<Value> = running
        .into_iter()
        .map(|process| {
            let output = process.wait_with_output().expect("it ends");
            assert!(output.status.success());
            let mut facts: Value = serde_json::from_slice(&output.stdout).expect("JSON");
            for measured in ["build_seconds", "seconds", "faces_per_second", "peak_bytes"] {
                facts[measured] = Value::Null;
            }
            facts
        })
        .collect();
    assert!(results.iter().all(|facts| facts == &results[0]));
    let state = state(&path);
    assert_eq!((state.lost_bytes, state.unsound, state.repeated), (0, 0, 0));
    let insides = results[0]["plans"].as_u64().expect("a count");
    assert_eq!(state.entries[0] as u64, insides);
}

#[test]
fn the_program_tells_verifies_prunes_and_exports() {
    let folder = folder();
    let path = folder.path().join("plans.db");
    let name = path.to_str().expect("a name");
    let missing = run(&["db", "info", "--db", name]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(plan(name).output().expect("it starts").status.success());
    let info = run(&["db", "info", "--json", "--db", name]);
    let info: Value = serde_json::from_slice(&info.stdout).expect("JSON");
    assert_eq!(info["lost_bytes"], 0);
    let entries: u64 = info["entries"]
        .as_object()
        .expect("counts")
        .values()
        .filter_map(Value::as_u64)
        .sum();
    let exported = run(&["db", "export", "--db", name]);
    let exported: Value = serde_json::from_slice(&exported.stdout).expect("JSON");
    assert_eq!(
        exported["entries"].as_array().map(Vec::len),
        Some(entries as usize)
    );
    assert!(run(&["db", "verify", "--db", name]).status.success());

    let mut bytes = std::fs::read(&path).expect("it was written");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 16;
    std::fs::write(&path, bytes).expect("it can be written");
    let damaged = run(&["db", "verify", "--db", name]);
    assert_eq!(damaged.status.code(), Some(1));
    assert!(
        stderr(&damaged).contains("hullform db prune"),
        "{}",
        stderr(&damaged)
    );
    assert!(run(&["db", "prune", "--db", name]).status.success());
    let verified = run(&["db", "verify", "--db", name]);
    assert!(verified.status.success());
    assert!(
        stdout(&verified).contains("lost bytes              0"),
        "{}",
        stdout(&verified)
    );
    let none = hullform(&["plan", "builtin:cube", "--db", "none"]).output();
    assert!(none.expect("it starts").status.success());
}
