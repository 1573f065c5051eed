//! `plan --face`: the quadtree of a face, as a picture and in numbers.
#![cfg(feature = "cli")]

mod common;

use std::collections::BTreeSet;

use common::cli::{fails, run, stderr};
use serde_json::Value;

fn plan(arguments: &[&str]) {
    let output = run(arguments);
    assert!(output.status.success(), "{}", stderr(&output));
}

/// The leaves of a face's quadtree cover it once, whichever way its plan lies in it.
#[test]
fn the_quadtree_of_a_face_is_drawn_and_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| {
        folder
            .path()
            .join(name)
            .to_str()
            .expect("UTF-8")
            .to_string()
    };
    let told = path("face.json");
    let mut kinds = BTreeSet::new();
    for face in ["0", "1", "4", "7"] {
        plan(&["plan", "builtin:ngons", "--face", face, "-o", &told]);
        let text = std::fs::read(&told).expect("it was written");
        let plans: Value = serde_json::from_slice(&text).expect("JSON");
        for plan in plans["plans"].as_array().expect("a list") {
            let nodes = plan["nodes"].as_array().expect("a list");
            let mut area = 0.0;
            for node in nodes {
                let [u, v, size] =
                    ["u", "v", "size"].map(|key| node[key].as_f64().expect("a number"));
                assert!(
                    u >= 0.0 && v >= 0.0 && u + size <= 1.0 && v + size <= 1.0,
                    "{node}"
                );
                kinds.insert(node["kind"].to_string());
                if node["kind"] != "internal" {
                    area += size * size;
                }
                for corner in node["corner"].as_array().into_iter().flatten() {
                    assert!(*corner == 0.0 || *corner == 1.0, "{node}");
                }
            }
            assert_eq!(area, 1.0, "face {face}");
        }
    }
    assert!(kinds.len() > 2, "{kinds:?}");
    let path = path("face.svg");
    plan(&["plan", "builtin:ngons", "--face", "1", "-o", &path]);
    let picture = std::fs::read_to_string(&path).expect("it was written");
    assert!(
        picture.starts_with("<svg")
            && picture.contains("terminal")
            && picture.contains("valence 3")
    );
    for (arguments, word) in [
        (["--face", "4000", "-o", &path], "there is no face 4000"),
        (["--face", "1", "-o", "face.png"], ".svg, .json"),
    ] {
        let words = fails(&[&["plan", "builtin:ngons"][..], &arguments].concat(), 2);
        assert!(words.contains(word), "{words}");
    }
    fails(&["plan", "builtin:ngons", "--face", "1"], 2);
}
