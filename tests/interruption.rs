//! Signals: nothing half-written stays, workers end, what `verify` found is kept, and the process ends by the signal.
#![cfg(all(feature = "cli", unix))]

mod common;

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use common::cli::{has_device, hullform};

/// INT, TERM and HUP, by name and number.
const SIGNALS: [(&str, i32); 3] = [("INT", 2), ("TERM", 15), ("HUP", 1)];

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = hullform(arguments);
    command.current_dir(folder);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("the program starts")
}

fn send(signal: &str, child: &Child) {
    let mut kill = Command::new("kill");
    kill.args([format!("-{signal}"), child.id().to_string()]);
    assert!(kill.status().expect("kill is there").success());
}

fn end(mut child: Child) -> ExitStatus {
    child.wait().expect("it ends")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is there");
    let name = |entry: std::io::Result<fs::DirEntry>| entry.expect("an entry").file_name();
    let mut names: Vec<String> = entries
        .map(|entry| name(entry).to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Each subcommand that writes, and the names of what it writes.
const WRITERS: [(&[&str], &[&str]); 5] = [
    (
        &[
            "render", "-o", "a.png", "--stats", "a.json", "--size", "800x800",
        ],
        &["a.json", "a.png"],
    ),
    (
        &["tessellate", "builtin:hull", "--level", "24", "-o", "b.csv"],
        &["b.csv"],
    ),
    (
        &["compare", "builtin:cube", "--size", "64x64", "-o", "c.png"],
        &["c.png"],
    ),
    (
        &[
            "bench",
            "builtin:hull",
            "--methods",
            "flat",
            "--csv",
            "e.csv",
            "--json",
            "e.json",
            "--plot",
            "e.svg",
        ],
        &["e.csv", "e.json", "e.svg"],
    ),
    (
        &[
            "verify",
            "--filter",
            "coordinates.isolines*",
            "--csv",
            "d.csv",
            "--junit",
            "d.xml",
            "--json",
            "d.json",
        ],
        &["d.csv", "d.json", "d.xml"],
    ),
];

#[test]
fn signals_leave_all_or_nothing() {
    if !has_device() {
        return;
    }
    for (writer, (arguments, outputs)) in WRITERS.into_iter().enumerate() {
        for (turn, (signal, number)) in SIGNALS.into_iter().enumerate() {
            let folder = tempfile::tempdir().expect("a folder");
            let child = start(folder.path(), arguments);
            // Moments all over a run, which takes a second or so: while Vulkan is loaded, while it draws, while it writes.
            sleep(Duration::from_millis(
                40 + 110 * (3 * writer + turn) as u64 % 900,
            ));
            send(signal, &child);
            let status = end(child);
            assert!(
                status.signal() == Some(number) || status.success(),
                "{arguments:?}, {signal}: {status}"
            );
            let there = names(folder.path());
            assert!(
                there.is_empty() || there == outputs,
                "{arguments:?}, {signal}: {there:?}"
            );
        }
    }
}

/// Results of cases that were done before the signal; the case that hangs has none.
#[test]
fn verify_keeps_what_it_found() {
    if !has_device() {
        return;
    }
    let arguments = [
        "verify",
        "--jobs",
        "1",
        "--seed",
        "8051953",
        "--filter",
        "coordinates.quads-equal.*",
        "--fault",
        "hang:coordinates.quads-equal.symmetry",
        "--csv",
        "results.csv",
        "--json",
        "results.json",
        "--junit",
        "results.xml",
    ];
    for patience in [2, 4, 8, 12, 16, 24] {
        let folder = tempfile::tempdir().expect("a folder");
        let child = start(folder.path(), &arguments);
        sleep(Duration::from_secs(patience));
        send("INT", &child);
        assert_eq!(end(child).signal(), Some(2));
        assert_workers_end("--seed=8051953");
        if names(folder.path()).is_empty() {
            // Nothing was done yet: a busy machine.
            continue;
        }
        assert_eq!(
            names(folder.path()),
            ["results.csv", "results.json", "results.xml"]
        );
        let read = |name| fs::read_to_string(folder.path().join(name)).expect("readable");
        let csv = read("results.csv");
        assert!(csv.lines().all(|line| line.contains(",Pass,")), "{csv}");
        assert!(!csv.contains("symmetry"), "{csv}");
        let json: serde_json::Value = serde_json::from_str(&read("results.json")).expect("JSON");
        assert_eq!(json["complete"], false);
        let results = json["results"].as_array().expect("a list");
        assert_eq!(results.len(), csv.lines().count());
        assert!(read("results.xml").contains("coordinates.quads-equal"));
        return;
    }
    panic!("no case was done in 30 seconds");
}

/// That no process has `word` among its arguments, a moment after its runner has gone.
fn assert_workers_end(word: &str) {
    let patience = Instant::now() + Duration::from_secs(1);
    while cfg!(target_os = "linux") && is_running(word) {
        assert!(Instant::now() < patience, "a worker stayed behind");
        sleep(Duration::from_millis(20));
    }
}

fn is_running(word: &str) -> bool {
    let processes = fs::read_dir("/proc").expect("there on Linux").flatten();
    let lines = processes.filter_map(|process| fs::read(process.path().join("cmdline")).ok());
    let mut lines = lines.map(|line| String::from_utf8_lossy(&line).into_owned());
    lines.any(|line| line.split('\0').any(|other| other == word))
}

/// As under `nohup`.
#[test]
fn what_was_ignored_stays_ignored() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut shell = Command::new("sh");
    let program = env!("CARGO_BIN_EXE_hullform");
    let script = "trap '' HUP; \"$0\" render -o a.png & sleep 0.2; kill -HUP $!; wait $!";
    shell
        .args(["-c", script, program])
        .current_dir(folder.path());
    let output = shell.output().expect("sh starts");
    assert!(output.status.success(), "{output:?}");
    assert_eq!(names(folder.path()), ["a.png"]);
}
