//! `figures`: verdicts with their reasons, a page, and what is refused.
#![cfg(feature = "cli")]

mod common;

use std::collections::BTreeSet;
use std::path::Path;

use common::cli::{fails, run, stderr, stdout};
use serde_json::Value;

/// Every figure and table of the papers that is promised, and the one of our own.
fn promised() -> BTreeSet<String> {
    let trees = [2, 3, 5, 6, 7, 8, 9, 10, 11, 13, 14, 15, 16, 17, 18];
    let figures = |year: u32, numbers: &[u32]| {
        let of = |number: &u32| format!("{year}.figure.{number}");
        numbers.iter().map(of).collect::<Vec<_>>()
    };
    let tables = [(2016, 2), (2016, 3), (2016, 4), (2007, 1), (2011, 1)];
    let tables = tables.map(|(year, number)| format!("{year}.table.{number}"));
    figures(2016, &trees)
        .into_iter()
        .chain(figures(2007, &[1, 2, 3, 4, 5]))
        .chain(figures(2011, &[4, 5, 6, 7, 8]))
        .chain(tables)
        .chain(["methods".into()])
        .collect()
}

/// The names of what the page shows.
fn shown(page: &str) -> Vec<&str> {
    let parts = page
        .split("src=\"")
        .chain(page.split("href=\""))
        .filter_map(|rest| rest.split('"').next());
    parts
        .filter(|name| {
            [".png", ".svg", ".csv", ".json"]
                .iter()
                .any(|e| name.ends_with(e))
        })
        .collect()
}

fn is_whole(path: &Path) -> bool {
    let bytes = std::fs::read(path).unwrap_or_default();
    match path.extension().and_then(|e| e.to_str()) {
        Some("png") => bytes.starts_with(b"\x89PNG") && bytes.ends_with(b"IEND\xaeB`\x82"),
        Some("svg") => bytes.trim_ascii_end().ends_with(b"</svg>"),
        Some("json") => serde_json::from_slice::<Value>(&bytes).is_ok(),
        _ => bytes.ends_with(b"\n"),
    }
}

/// All of them, as quickly as can be: on two cores within two minutes, of which this takes half.
#[test]
fn every_figure_has_a_verdict_with_a_reason_and_its_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().join("new/figures");
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/models");
    let mut words = vec!["figures", "--quick", "--json", "-o"];
    words.push(output.to_str().expect("a plain path"));
    if Path::new(models).is_dir() {
        words.extend(["--models", models]);
    }
    let made = run(&words);
    assert!(made.status.success(), "{}", stderr(&made));
    let report: Value = serde_json::from_str(&stdout(&made)).expect("JSON alone");
    let rows = report["figures"].as_array().expect("rows");
    let ids = rows.iter().filter_map(|row| row["id"].as_str());
    assert_eq!(ids.map(String::from).collect::<BTreeSet<_>>(), promised());
    for row in rows {
        let has_reason = row["reason"].as_str().is_some_and(|text| !text.is_empty());
        match row["verdict"].as_str() {
            Some("reproduced") => assert!(!has_reason, "{row}"),
            Some("differs") => assert!(has_reason, "{row}"),
            Some("unavailable") => assert!(has_reason && row["measured"].is_null(), "{row}"),
            _ => panic!("{row}"),
        }
    }
    let of = |id: &str| {
        rows.iter()
            .filter(|row| row["id"] == id)
            .collect::<Vec<_>>()
    };
    // What needs no model, no GPU and no clock agrees.
    for id in [
        "2016.figure.3",
        "2016.figure.5",
        "2016.figure.6",
        "2016.figure.7",
        "2016.figure.9",
        "2016.figure.18",
        "2011.figure.6",
        "methods",
    ] {
        assert_eq!(of(id)[0]["verdict"], "reproduced", "{:?}", of(id)[0]);
    }
    let saved = of("2016.table.3")[2]["measured"].as_f64();
    assert!(saved.is_some_and(|share| share > 0.5), "{saved:?}");
    let page = std::fs::read_to_string(output.join("index.html")).expect("a page");
    for id in promised() {
        assert!(page.contains(&format!("<h2 id=\"{id}\">")), "{id}");
    }
    let files = shown(&page);
    assert!(files.len() > 40, "{files:?}");
    for name in files {
        assert!(is_whole(&output.join(name)), "{name}");
    }
    let table = std::fs::read_to_string(output.join("figures.csv")).expect("a table");
    assert_eq!(table.lines().count(), 1 + rows.len());
}

#[test]
fn figures_of_models_that_are_not_there_are_unavailable() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().to_str().expect("a plain path");
    let made = run(&["figures", "2016.table.4", "-o", output, "--json"]);
    let report: Value = serde_json::from_str(&stdout(&made)).expect("JSON alone");
    let rows = report["figures"].as_array().expect("rows");
    assert_eq!(rows.len(), 12);
    for row in rows {
        assert_eq!(row["verdict"], "unavailable");
        let reason = row["reason"].as_str().unwrap_or_default();
        assert!(reason.contains("--models"), "{reason}");
    }
}

#[test]
fn unknown_figures_and_folders_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("figures");
    let path = path.to_str().expect("a plain path");
    let words = fails(&["figures", "2016.figure.99", "-o", path], 2);
    assert!(
        words.contains("2016.figure.99") && words.contains("2011.table.1"),
        "{words}"
    );
    let words = fails(&["figures", "-o", path, "--models", "/no/such/folder"], 2);
    assert!(words.contains("--models"), "{words}");
    let words = fails(&["figures", "-o", "/proc/figures"], 2);
    assert!(words.contains("/proc/figures"), "{words}");
}
