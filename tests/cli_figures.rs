//! `figures`: verdicts with their reasons, a page, and what is refused.
#![cfg(feature = "cli")]

mod common;

use common::cli::{fails, run, stderr, stdout};
use serde_json::Value;

fn rows(text: &str) -> Vec<Value> {
    let report: Value = serde_json::from_str(text).expect("JSON alone");
    report["figures"].as_array().expect("rows").clone()
}

/// Plans need no device.
#[test]
fn what_can_be_made_has_numbers_and_what_cannot_has_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().join("new/figures");
    let output_word = output.to_str().expect("a plain path");
    let ids = [
        "2016.table.3",
        "2016.table.4",
        "2016.figure.5",
        "2016.figure.16",
    ];
    let words = [
        &["figures"],
        &ids[..],
        &["-o", output_word, "--quick", "--json"],
    ]
    .concat();
    let made = run(&words);
    assert!(made.status.success(), "{}", stderr(&made));
    let rows = rows(&stdout(&made));
    let of = |id: &str| {
        rows.iter()
            .filter(|row| row["id"] == id)
            .collect::<Vec<_>>()
    };
    let saved = of("2016.table.3");
    assert_eq!(saved.len(), 3);
    assert!(
        saved[2]["measured"]
            .as_f64()
            .is_some_and(|share| share > 0.5),
        "{saved:?}"
    );
    for row in of("2016.table.4") {
        assert_eq!(row["verdict"], "unavailable");
        assert!(
            row["reason"]
                .as_str()
                .is_some_and(|reason| reason.contains("--models"))
        );
    }
    let trees = of("2016.figure.5");
    assert_eq!(trees[0]["verdict"], "reproduced", "{trees:?}");
    assert!(
        of("2016.figure.16")[0]["reason"]
            .as_str()
            .is_some_and(|reason| reason.contains("figure 17"))
    );
    let page = std::fs::read_to_string(output.join("index.html")).expect("a page");
    for id in ids {
        assert!(page.contains(&format!("<h2 id=\"{id}\">")), "{id}");
    }
    for picture in ["2016.figure.5-recursive.svg", "2016.figure.5-direct.svg"] {
        assert!(
            page.contains(picture) && output.join(picture).is_file(),
            "{picture}"
        );
    }
    let table = std::fs::read_to_string(output.join("figures.csv")).expect("a table");
    assert_eq!(table.lines().count(), 1 + rows.len());
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
