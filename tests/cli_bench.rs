//! `bench`: what it counts, what it writes, and what it refuses.
#![cfg(feature = "cli")]

mod common;

use common::cli::{fails, has_device, run, stderr, stdout};
use serde_json::Value;

#[test]
fn work_is_counted_and_every_file_says_on_what() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let files = ["b.json", "b.csv", "b.svg"].map(path);
    let [json, csv, svg] = files.each_ref().map(String::as_str);
    let output = run(&[
        "bench",
        "builtin:ngons",
        "builtin:cube",
        "--methods",
        "quadtree",
        "--levels",
        "4,1",
        "--passes",
        "2",
        "--frames",
        "2",
        "--json",
        json,
        "--csv",
        csv,
        "--plot",
        svg,
    ]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    assert_eq!(text.lines().count(), 2 + 8, "{text}");
    let read = |path: &str| std::fs::read_to_string(path).expect("the file is written");
    let report: Value = serde_json::from_str(&read(json)).expect("JSON alone");
    let device = report["device"].as_str().expect("a name");
    assert!(!report["driver"].as_str().expect("a name").is_empty());
    let rows = report["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 8);
    for row in rows {
        let model = if row["model"] == "builtin:ngons" {
            "ngons"
        } else {
            "cube"
        };
        let flat = row["method"] == "flat";
        let number = |key: &str| {
            row[key]
                .as_f64()
                .unwrap_or_else(|| panic!("{key} of {row}"))
        };
        assert_eq!(number("passes"), 2.0);
        assert!(number("draws") >= 2.0, "{row}");
        assert_eq!(flat, number("points_computed") == 0.0, "{row}");
        assert_eq!(flat, number("multiply_adds") == 0.0, "{row}");
        assert!(!flat || number("ratio_to_flat") == 1.0, "{row}");
        assert!(
            number("ratio_to_flat") > 0.0 && number("device_bytes") > 0.0,
            "{row}"
        );
        if model == "cube" && flat {
            // Six quads of (level + 1)^2 vertices, drawn twice.
            let vertices = 12.0 * (number("level") + 1.0).powi(2);
            assert_eq!(number("evaluation_invocations"), vertices, "{row}");
            assert_eq!(number("patches"), 12.0);
        }
    }
    let lines = read(csv);
    assert_eq!(lines.lines().count(), 1 + 8);
    assert!(
        lines
            .lines()
            .skip(1)
            .all(|line| line.trim_start_matches('"').starts_with(device))
    );
    let picture = read(svg);
    assert!(picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"));
    assert!(picture.contains(device) && picture.contains("quadtree"));
}

#[test]
fn what_cannot_be_measured_is_refused_before_anything_is_written() {
    let words = fails(&["bench", "builtin:cube", "--levels", "0.5"], 2);
    assert!(words.contains("from 1 to 1024"), "{words}");
    let words = fails(&["bench", "builtin:cube", "--methods", "pink"], 2);
    assert!(words.contains("pink"), "{words}");
    let words = fails(&["bench", "--levels", "2"], 2);
    assert!(words.contains("MODEL"), "{words}");
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("b.csv");
    let csv = csv.to_str().expect("a plain path");
    // A ring that holds no patch.
    let words = fails(
        &[
            "bench",
            "builtin:ngons",
            "--ring-bytes",
            "64",
            "--methods",
            "quadtree",
            "--csv",
            csv,
        ],
        2,
    );
    assert!(words.contains("ring"), "{words}");
    assert!(
        std::fs::read_dir(folder.path())
            .expect("it is there")
            .next()
            .is_none()
    );
}

#[test]
fn instances_are_one_draw_from_the_cache_and_one_each_in_the_ring() {
    if !has_device() {
        return;
    }
    let rows = |instances: &str| {
        let output = run(&[
            "bench",
            "builtin:cube",
            "--methods",
            "quadtree",
            "--levels",
            "4",
            "--residence",
            "cache,ring",
            "--instances",
            instances,
            "--frames",
            "1",
            "--json",
        ]);
        assert!(output.status.success(), "{}", stderr(&output));
        let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON alone");
        let rows = report["rows"].as_array().expect("rows").clone();
        let of = |residence: &str| {
            let row = rows
                .iter()
                .find(|row| row["residence"] == residence && row["method"] == "quadtree");
            let row = row.unwrap_or_else(|| panic!("no row of {residence}"));
            ["draws", "points_computed", "evaluation_invocations"]
                .map(|key| row[key].as_u64().expect("a number"))
        };
        [of("cache"), of("ring")]
    };
    let [one, five] = ["1", "5"].map(rows);
    let [[draws, points, vertices], _] = one;
    assert_eq!(five[0], [draws, points, 5 * vertices]);
    assert_eq!(five[1], one[1].map(|count| 5 * count));
}

/// Of the same run twice the work is the same, and of another level nothing is known.
#[test]
fn a_saved_run_is_compared_row_by_row() {
    let words = fails(&["bench", "builtin:cube", "--against", "/no/such/file"], 2);
    assert!(words.contains("--against"), "{words}");
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let old = folder.path().join("old.json");
    let old = old.to_str().expect("a plain path");
    let bench = |levels: &'static str, more: &[&str]| {
        let words = [
            "bench",
            "builtin:cube",
            "--methods",
            "flat",
            "--frames",
            "1",
        ];
        let output = run(&[&words[..], &["--levels", levels], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output)
    };
    bench("2,4", &["--json", old]);
    let text = bench("4,8", &["--against", old]);
    assert!(text.ends_with("1 of 2 rows are in both\n"), "{text}");
    assert!(
        text.contains("x 1.00") && !text.contains("evaluations x"),
        "{text}"
    );
    let words = fails(
        &["bench", "builtin:cube", "--against", old, "--json", old],
        2,
    );
    assert!(words.contains("what is read"), "{words}");
}
