//! `hullform-deqp` in dEQP's place: its options, what it prints and logs, and the verdicts of `hullform verify` under deqp-runner.
#![cfg(feature = "cli")]

mod common;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use common::cli::{has_device, run as hullform, stderr, stdout};

/// Quick cases, one of which can be made a victim.
const PART: &str = "hullform.coordinates.isolines-equal.*";
const VICTIM: &str = "coordinates.isolines-equal.counts";

fn deqp(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hullform-deqp"));
    command.args(arguments).current_dir(folder);
    command.output().expect("the program starts")
}

/// The names and statuses in what dEQP prints, as deqp-runner finds them.
fn printed(text: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut name = None;
    for line in text.lines() {
        if let Some(rest) = line.strip_prefix("Test case '") {
            assert_eq!(name, None, "the one before has no status");
            name = Some(rest.strip_suffix("'..").expect("as dEQP ends it"));
        } else if let Some((status, _)) = line.strip_prefix("  ").and_then(|s| s.split_once(" ("))
            && let Some(name) = name.take()
        {
            assert!(line.ends_with(')'), "{line}");
            found.insert(name.to_owned(), status.to_owned());
        }
    }
    assert_eq!(name, None, "the last has no status");
    found
}

fn listed(arguments: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let output = deqp(
        folder.path(),
        &[&["--deqp-runmode=stdout-caselist"], arguments].concat(),
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    let tests = text.lines().filter_map(|line| line.strip_prefix("TEST: "));
    tests.map(String::from).collect()
}

#[test]
fn what_is_printed_and_logged_is_what_deqp_prints_and_logs() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let case = format!("--deqp-case={PART}");
    let fault = format!("--hullform-fault=wrong:{VICTIM}");
    let arguments = [case.as_str(), &fault, "--deqp-log-filename=a.qpa"];
    let output = deqp(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let text = stdout(&output);
    let found = printed(&text);
    let count = found.len();
    assert!(count > 5);
    for (name, status) in &found {
        let wrong = *name == format!("hullform.{VICTIM}");
        assert_eq!(status, if wrong { "Fail" } else { "Pass" }, "{name}");
    }
    assert!(text.contains("\nDONE!\n\nTest run totals:\n"));
    let passed = format!("\n  Passed:        {}/{count} (", count - 1);
    assert!(text.contains(&passed), "{text}");
    assert!(text.contains(&format!("\n  Failed:        1/{count} (")));
    let log = std::fs::read_to_string(folder.path().join("a.qpa")).expect("a log");
    assert!(log.starts_with("#sessionInfo releaseName hullform-"));
    assert!(log.trim_end().ends_with("\n#endSession"));
    for (name, status) in &found {
        let own = log
            .split(&format!("#beginTestCaseResult {name}\n"))
            .nth(1)
            .and_then(|rest| rest.split("#endTestCaseResult").next())
            .expect("the log has it");
        assert!(own.starts_with("<?xml"));
        assert!(own.contains(&format!("<Result StatusCode=\"{status}\">")));
        assert!(own.contains("<Text>Rule: ") && own.contains("<Text>Source: Vulkan"));
    }
}

#[test]
fn crashes_and_panics_end_one_case() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let case = format!("--deqp-case={PART}");
    for kind in ["crash", "panic"] {
        let fault = format!("--hullform-fault={kind}:{VICTIM}");
        let output = deqp(folder.path(), &[&case, &fault]);
        let mut found = printed(&stdout(&output));
        let victim = found.remove(&format!("hullform.{VICTIM}"));
        assert_eq!(victim.as_deref(), Some("Crash"));
        assert!(found.len() > 5 && found.values().all(|status| status == "Pass"));
    }
    let fault = format!("--hullform-fault=wrong:{VICTIM}");
    let output = deqp(
        folder.path(),
        &[&case, &fault, "--deqp-terminate-on-fail=enable"],
    );
    let text = stdout(&output);
    assert!(text.contains("\nABORTED!\n"), "{text}");
    assert_eq!(printed(&text).values().filter(|s| *s == "Fail").count(), 1);
}

#[test]
fn waived_cases_are_not_run() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let waivers = format!(
        "<waiver_list><waiver vendor=\"*\" url=\"https://example.org/1\"><renderer_list><r>*</r></renderer_list>\
         <waived_tests><t>hullform.{VICTIM}</t></waived_tests></waiver></waiver_list>"
    );
    std::fs::write(folder.path().join("waivers.xml"), waivers).expect("written");
    let case = format!("--deqp-case={PART}");
    let fault = format!("--hullform-fault=wrong:{VICTIM}");
    let file = "--deqp-waiver-file=waivers.xml";
    let output = deqp(folder.path(), &[&case, &fault, file]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let victim = format!("hullform.{VICTIM}");
    assert_eq!(printed(&stdout(&output))[&victim], "Waiver");
}

#[test]
fn cases_are_asked_for_by_patterns_lists_and_tries() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("cases.txt");
    let all = listed(&[]);
    let suite = stdout(&hullform(&["verify", "--list"]));
    let suite: Vec<String> = suite
        .lines()
        .map(|name| format!("hullform.{name}"))
        .collect();
    assert_eq!(all, suite, "the cases are those of verify");
    let part = listed(&["-n", PART]);
    assert!(part.len() > 5 && part.iter().all(|name| all.contains(name)));
    assert_eq!(
        listed(&[&format!("--deqp-case={},{}", part[0], part[2])]).len(),
        2
    );
    std::fs::write(&file, part.join("\n")).expect("written");
    let by_file = format!("--deqp-caselist-file={}", file.display());
    assert_eq!(listed(&[&by_file]), part);
    let leaf = |name: &String| name.rsplit('.').next().expect("a leaf").to_owned();
    let leaves: Vec<String> = part.iter().map(leaf).collect();
    let trie = format!(
        "{{hullform{{coordinates{{isolines-equal{{{}}}}}}}}}",
        leaves.join(",")
    );
    assert_eq!(listed(&[&format!("--deqp-caselist={trie}")]), part);
    std::fs::write(&file, trie).expect("written");
    assert_eq!(listed(&[&by_file]), part);
    let without = format!("--deqp-exclude-case=*.{}", leaf(&part[0]));
    assert_eq!(listed(&[&by_file, &without]), part[1..]);
    let halves = ["0,2", "1,2"].map(|of| listed(&[&by_file, &format!("--deqp-fraction={of}")]));
    assert_eq!(halves[0].len() + halves[1].len(), part.len());
    assert!(halves[0].iter().all(|name| !halves[1].contains(name)));
}

#[test]
fn lists_are_written_as_text_and_as_xml() {
    let folder = tempfile::tempdir().expect("a folder");
    for (mode, file) in [
        ("txt-caselist", "hullform-cases.txt"),
        ("xml-caselist", "hullform-cases.xml"),
    ] {
        let output = deqp(folder.path(), &[&format!("--deqp-runmode={mode}")]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let text = std::fs::read_to_string(folder.path().join(file)).expect("a list");
        let count = listed(&[]).len();
        let found = match mode {
            "txt-caselist" => text.matches("TEST: ").count(),
            _ => text.matches("CaseType=\"SelfValidate\"").count(),
        };
        assert_eq!(found, count, "{mode}");
    }
}

#[test]
fn what_makes_no_sense_is_refused_and_what_is_not_there_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let fails = |arguments: &[&str]| {
        let output = deqp(folder.path(), arguments);
        let words = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {words}");
        words
    };
    assert!(fails(&["--deqp-colour=red"]).contains("--deqp-colour"));
    assert!(fails(&["--deqp-runmode=dance"]).contains("stdout-caselist"));
    assert!(fails(&["--deqp-case=a", "--deqp-caselist={a}"]).contains("cannot be used with"));
    assert!(fails(&["--deqp-fraction=1"]).contains("N,M"));
    assert!(fails(&["--deqp-caselist={a"]).contains("a closing brace is missing"));
    assert!(fails(&["--deqp-caselist-file=no.txt"]).contains("no.txt"));
    // What harnesses give to every program.
    let ignored = [
        "--deqp-surface-width=256",
        "--deqp-gl-config-name=rgba8888d24s8ms0",
        "--deqp-log-images=disable",
        "--deqp-log-images=enable",
        "--deqp-log-flush=enable",
        "--deqp-log-flush=disable",
        "--deqp-shadercache-filename=/nowhere/cache",
        "--deqp-case=hullform.no.such",
    ];
    let output = deqp(folder.path(), &ignored);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("no case matches 'hullform.no.such'"));
    assert!(stdout(&output).contains("  Passed:        0/0 (0.0%)"));
}

/// Without deqp-runner (`cargo install deqp-runner`) nothing can be said of it.
fn has_runner() -> bool {
    let found = Command::new("deqp-runner").arg("--version").output();
    if found.is_err() {
        println!("skipped: no deqp-runner");
    }
    found.is_ok() && has_device()
}

/// The statuses in a file of rows `name,Status,seconds`.
fn rows(text: &str) -> BTreeMap<String, String> {
    let rows = text.lines().map(|line| {
        let mut columns = line.split(',');
        let mut next = || columns.next().expect("three columns").to_owned();
        (next(), next())
    });
    rows.collect()
}

/// Ends a run when so many cases are done, and takes it up again: what was done is not done twice, and the results are those of a run that nobody ended.
fn resumed_after_a_kill(filter: &str, before: usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name).display().to_string();
    let list = stdout(&hullform(&["verify", "--list", "--filter", filter]));
    let names: Vec<String> = list
        .lines()
        .map(|name| format!("hullform.{name}"))
        .collect();
    std::fs::write(place("cases.txt"), names.join("\n")).expect("written");
    let journal = place("done.txt");
    let runner = || {
        let mut runner = Command::new("deqp-runner");
        runner.args(["run", "--deqp", env!("CARGO_BIN_EXE_hullform-deqp")]);
        runner.args(["--caselist", &place("cases.txt"), "--output", &place("out")]);
        runner.args(["--jobs", "2", "--timeout", "120", "--tests-per-group", "50"]);
        runner.arg("--").arg(format!("--hullform-resume={journal}"));
        runner
    };
    let ended = |text: &str| text.lines().filter(|line| line.ends_with("\t.")).count();
    let done = || std::fs::read_to_string(&journal).map_or(0, |text| ended(&text));
    let mut first = runner()
        .stdout(Stdio::null())
        .spawn()
        .expect("deqp-runner starts");
    while done() < before && first.try_wait().expect("it is ours").is_none() {
        std::thread::sleep(Duration::from_millis(20));
    }
    first.kill().expect("it is ours");
    first.wait().expect("it ends");
    // What it had started ends with it, when it has something to say.
    let mut last = usize::MAX;
    while done() != last {
        last = done();
        std::thread::sleep(Duration::from_secs(3));
    }
    assert!((before..names.len()).contains(&last), "{last} were done");
    let output = runner().output().expect("it starts");
    let words = stdout(&output) + &stderr(&output);
    let results = std::fs::read_to_string(place("out/results.csv")).expect("results");
    let results = rows(&results);
    assert_eq!(results.len(), names.len(), "{words}");
    let known: BTreeMap<String, String> = rows(
        &std::fs::read_to_string(&journal)
            .expect("it is")
            .lines()
            .filter(|line| line.ends_with("\t."))
            .map(|line| line.replace('\t', ",") + "\n")
            .collect::<String>(),
    );
    assert_eq!(known, results);
    assert_eq!(done(), names.len(), "each case once");
}

/// Runs these cases under deqp-runner, with what `verify` exported as its baseline, and holds the results to those of `verify`.
fn under_runner(filter: &str, fault: Option<&str>) {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name).display().to_string();
    let (csv, list) = (place("verify.csv"), place("cases.txt"));
    let mut arguments = vec!["verify", "--filter", filter, "--csv", &csv];
    let known = place("known");
    arguments.extend(["--export-expectations", &known]);
    if let Some(fault) = fault {
        arguments.extend(["--fault", fault]);
    }
    hullform(&arguments);
    let read = |file: &str| std::fs::read_to_string(file).expect(file);
    let verdicts = rows(&read(&csv));
    // What verify expects is found anew, and in the baseline.
    let expected = |(name, status): (&String, &String)| {
        let status = match status.as_str() {
            "Fail" | "Crash" => "ExpectedFail",
            other => other,
        };
        (format!("hullform.{name}"), status.to_owned())
    };
    let expected: BTreeMap<String, String> = verdicts.iter().map(expected).collect();
    let names: Vec<&str> = expected.keys().map(String::as_str).collect();
    std::fs::write(&list, names.join("\n")).expect("written");
    let out = place("out");
    let mut runner = Command::new("deqp-runner");
    runner.args(["run", "--deqp", env!("CARGO_BIN_EXE_hullform-deqp")]);
    runner.args(["--caselist", &list, "--output", &out, "--jobs", "2"]);
    runner.args(["--timeout", "120", "--tests-per-group", "100"]);
    for (option, ending) in [
        ("baseline", "fails"),
        ("flakes", "flakes"),
        ("skips", "skips"),
    ] {
        runner.args([format!("--{option}"), format!("{known}-{ending}.txt")]);
    }
    runner.args(["--renderer-check", ".", "--version-check", "."]);
    runner.arg("--").args(["--deqp-log-images=disable"]);
    runner.args(fault.map(|fault| format!("--hullform-fault={fault}")));
    let output = runner.output().expect("it starts");
    let words = stdout(&output) + &stderr(&output);
    assert!(output.status.success(), "{words}");
    assert!(words.contains("renderer: "), "{words}");
    assert_eq!(
        rows(&read(&format!("{out}/results.csv"))),
        expected,
        "{words}"
    );
    // And back: what verify exported it reads.
    let fails = format!("{known}-fails.txt");
    let mut arguments = vec!["verify", "--filter", filter, "--expectations", &fails];
    if let Some(fault) = fault {
        arguments.extend(["--fault", fault]);
    }
    let output = hullform(&arguments);
    assert!(output.status.success(), "{}", stderr(&output));
}

#[test]
fn deqp_runner_finds_what_verify_finds() {
    if has_runner() {
        under_runner("coordinates.isolines-*", Some("crash:*-equal.counts"));
        under_runner("coordinates.isolines-*", Some("wrong:*-equal.*"));
    }
}

#[test]
fn a_run_that_was_killed_goes_on_where_it_was() {
    if has_runner() {
        resumed_after_a_kill("winding.triangles.*", 60);
    }
}

/// Minutes: for `HULLFORM_DEQP=1`, or how many runs there shall be.
#[test]
fn deqp_runner_finds_in_the_whole_suite_what_verify_finds() {
    let runs = std::env::var("HULLFORM_DEQP").ok();
    let runs: u32 = runs.and_then(|runs| runs.parse().ok()).unwrap_or(0);
    assert!(runs == 0 || has_runner(), "it was asked for");
    for _ in 0..runs {
        under_runner("*", None);
    }
}

/// A device on which nothing can be tessellated, such as SwiftShader: `HULLFORM_LACKING` names a driver's manifest.
#[test]
fn what_a_device_lacks_is_not_supported() {
    let Some(manifest) = std::env::var_os("HULLFORM_LACKING") else {
        println!("skipped: no driver to lack anything");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_hullform-deqp"));
    command
        .arg(format!("--deqp-case={PART}"))
        .current_dir(folder.path());
    let drivers = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];
    let output = command
        .envs(drivers.map(|name| (name, &manifest)))
        .output()
        .expect("it starts");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found = printed(&stdout(&output));
    assert!(found.len() > 5);
    assert!(found.values().all(|status| status == "NotSupported"));
    assert!(stdout(&output).contains("tessellationShader"));
}
