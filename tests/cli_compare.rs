//! `hullform compare`: its numbers, its picture, and what it says when it cannot.
#![cfg(feature = "cli")]

mod common;

use common::cli::{fails, has_device, run, stderr};
use hullform::mesh::{Model, builtin};
use hullform::method::METHODS;
use serde_json::Value;

/// A folder to write into, and the path of a picture in it as an argument.
fn scratch() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.png");
    (folder, path.to_str().expect("UTF-8").to_string())
}

fn entries(folder: &tempfile::TempDir) -> usize {
    let entries = std::fs::read_dir(folder.path());
    entries.expect("the folder is there").count()
}

fn compare(more: &[&str]) -> Value {
    let (folder, png) = scratch();
    let small = ["--size", "96x64", "--level", "4", "--json", "-o", &png];
    let output = run(&[&["compare", "builtin:creased-torus"], more, &small].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let bytes = std::fs::read(&png).expect("it was written");
    assert!(bytes.starts_with(b"\x89PNG"));
    assert_eq!(entries(&folder), 1, "the picture and nothing else");
    serde_json::from_slice(&output.stdout).expect("JSON alone")
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn exact_methods_are_near_the_truth_and_flat_is_not() {
    if !has_device() {
        return;
    }
    let report = compare(&["--methods", "quadtree,flat,flat", "--validation"]);
    let methods = report["methods"].as_array().expect("a list");
    let [exact, flat] = &methods[..] else {
        panic!("{report}")
    };
    assert_eq!(
        (&exact["method"], &flat["method"]),
        (&"quadtree".into(), &"flat".into())
    );
    assert!(
        number(&exact["position_error"]["maximum"]) <= 1e-6,
        "{exact}"
    );
    assert!(
        number(&exact["normal_error_degrees"]["maximum"]) <= 0.1,
        "{exact}"
    );
    assert!(number(&flat["position_error"]["mean"]) > 1e-3, "{flat}");
    for method in methods {
        for count in ["triangles", "patches", "vertices"] {
            assert!(number(&method[count]) > 0.0, "{count} in {method}");
        }
        for kind in ["position_error", "normal_error_degrees"] {
            let [maximum, mean, rms] = ["maximum", "mean", "rms"].map(|f| number(&method[kind][f]));
            assert!(0.0 < mean && mean <= rms && rms <= maximum, "{method}");
            assert!(method[kind]["skipped_points"].is_u64(), "{method}");
        }
    }
}

#[test]
fn every_method_is_compared_or_refused_and_a_method_hardly_differs_from_its_twin() {
    if !has_device() {
        return;
    }
    let names: Vec<&str> = METHODS.iter().map(|method| method.name).collect();
    let report = compare(&["--against", "quadtree", "--methods", &names.join(",")]);
    let model = Model::new(builtin("creased-torus").expect("it is built in"));
    let able = METHODS.iter().filter(|m| m.check_model(&model).is_ok());
    let count = |list: &str| report[list].as_array().expect("a list").len();
    assert_eq!(count("methods"), able.count());
    assert_eq!(count("methods") + count("refused"), METHODS.len());
    assert_eq!(report["against"], "quadtree");
    let mut methods = report["methods"].as_array().expect("a list").iter();
    let twin = methods.find(|method| method["method"] == "quadtree");
    let twin = twin.expect("it can draw everything");
    assert!(number(&twin["position_error"]["maximum"]) <= 1e-6, "{twin}");
}

/// Options of tables go to every method that has any; where none has, they are refused.
#[test]
fn options_of_tables_are_used_or_refused() {
    let (folder, png) = scratch();
    let start = ["compare", "builtin:cube", "-o", &png, "--methods"];
    let refused = |more: &[&str], option: &str| {
        let words = fails(&[&start[..], more].concat(), 2);
        assert!(words.contains(option), "{words}");
    };
    refused(
        &["flat,quadtree", "--table-level", "3"],
        "--table-level: no tables are used by flat, quadtree",
    );
    refused(
        &["flat", "--geometric-normals"],
        "choose a method that has tables (bft)",
    );
    refused(&["bft", "--table-level", "7"], "1..=6");
    refused(
        &["bft", "--isolation", "2"],
        "--isolation: nothing is refined around features by bft",
    );
    refused(&["bft", "--shading-level", "3"], "0..=2");
    refused(
        &["bft", "--shading-level", "0", "--geometric-normals"],
        "cannot be used with",
    );
    let csv = folder.path().join("out.csv");
    let csv = csv.to_str().expect("UTF-8");
    let words = fails(
        &[
            "tessellate",
            "builtin:cube",
            "-o",
            csv,
            "--shading-level",
            "2",
        ],
        2,
    );
    assert!(
        words.contains("--shading-level: no tables are used by quadtree"),
        "{words}"
    );
    assert_eq!(entries(&folder), 0);
    if has_device() {
        let off = |level: &str| {
            let small = ["--size", "32x24", "--level", "8", "--json"];
            let more = ["bft,flat", "--table-level", level];
            let output = run(&[&start[..], &more, &small].concat());
            assert!(output.status.success(), "{}", stderr(&output));
            let report: Value = serde_json::from_slice(&output.stdout).expect("JSON alone");
            let bft = report["methods"][0].clone();
            (
                number(&bft["vertices"]),
                number(&bft["position_error"]["maximum"]),
            )
        };
        let (coarse, fine) = (off("1"), off("3"));
        // Level 1 bounds the tess level by 4.
        assert!(
            coarse.0 < fine.0 && coarse.1 <= 1e-6 && fine.1 <= 1e-6,
            "{coarse:?} {fine:?}"
        );
    }
}

#[test]
fn bad_input_is_named_and_writes_nothing() {
    let (folder, png) = scratch();
    let start = ["compare", "builtin:cube", "-o", &png];
    let words = fails(&[&start[..], &["--methods", "flat,nurbs"]].concat(), 2);
    assert!(
        words.contains("--methods: ") && words.contains("'nurbs'"),
        "{words}"
    );
    assert!(words.contains("choose one of quadtree, "), "{words}");
    let words = fails(&[&start[..], &["--against", "nurbs"]].concat(), 2);
    assert!(
        words.contains("--against: ") && words.contains("or truth"),
        "{words}"
    );
    let words = fails(&["compare", "builtin:cube", "-o", "out.jpg"], 2);
    assert!(words.contains(".png"), "{words}");
    let words = fails(&["compare", "no/such/model.obj", "-o", &png], 2);
    assert!(words.contains("no/such/model.obj: "), "{words}");
    fails(&["compare", "builtin:cube"], 2);
    assert_eq!(entries(&folder), 0);
}
