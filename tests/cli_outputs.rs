//! What the program writes and says: outputs that are refused, full disks, names with control characters, and which method draws by default.
#![cfg(feature = "cli")]

mod common;

use std::fs;
use std::path::Path;

use common::cli::{fails, has_device, run, stderr};
use serde_json::Value;

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

fn name(path: &Path) -> &str {
    path.to_str().expect("a plain name")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is there").flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[cfg(unix)]
#[test]
fn what_is_read_is_not_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("model.obj");
    fs::write(&model, CUBE).expect("written");
    let (soft, hard) = (
        folder.path().join("soft.obj"),
        folder.path().join("hard.obj"),
    );
    let picture = folder.path().join("model.png");
    std::os::unix::fs::symlink("model.obj", &soft).expect("linked");
    std::os::unix::fs::symlink("model.obj", &picture).expect("linked");
    fs::hard_link(&model, &hard).expect("linked");
    let before = names(folder.path());
    let model_name = name(&model);
    let refused = |arguments: &[&str]| {
        let words = fails(arguments, 2);
        assert!(words.contains(" is what "), "{words}");
        assert_eq!(fs::read_to_string(&model).expect("readable"), CUBE);
        assert_eq!(names(folder.path()), before);
    };
    for output in [&model, &soft, &hard] {
        refused(&["tessellate", model_name, "-o", name(output)]);
        refused(&["tessellate", name(output), "-o", model_name]);
        refused(&[
            "render",
            model_name,
            "-o",
            "never.png",
            "--stats",
            name(output),
        ]);
        refused(&["verify", model_name, "--csv", name(output)]);
    }
    refused(&["render", model_name, "-o", name(&picture)]);
    refused(&["compare", model_name, "-o", name(&picture)]);
    let (same, again) = (folder.path().join("s.png"), folder.path().join("./s.png"));
    refused(&["render", "-o", name(&same), "--stats", name(&again)]);
    refused(&["verify", "--csv", name(&same), "--junit", name(&again)]);
    refused(&["verify", "--json", name(&same), "--csv", name(&again)]);
    refused(&["verify", "--expectations", name(&hard), "--csv", model_name]);
}

/// Of two outputs neither is written if one cannot be.
#[test]
fn a_full_disk_is_a_failure_and_leaves_nothing() {
    if !Path::new("/dev/full").exists() || !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("a.png");
    let words = fails(
        &[
            "render",
            "-o",
            name(&picture),
            "--size",
            "64x64",
            "--stats",
            "/dev/full",
        ],
        1,
    );
    assert!(words.contains("/dev/full: "), "{words}");
    fails(
        &[
            "verify",
            "--filter",
            "coordinates.isolines-equal.*",
            "--csv",
            "/dev/full",
        ],
        1,
    );
    assert!(names(folder.path()).is_empty());
}

#[test]
fn numbers_of_devices_are_no_parts_of_their_names() {
    if !has_device() {
        return;
    }
    for number in ["15", "99", "4294967296000000000000"] {
        let words = fails(&["devices", "--device", number], 3);
        assert!(words.contains(&format!("'{number}'")), "{words}");
    }
    for nothing in ["--device=", "--device= "] {
        fails(&["devices", nothing], 2);
    }
}

#[test]
fn names_do_not_reach_the_terminal_with_control_characters() {
    let odd = "no\u{1b}[2J\r\n\u{7}\u{202e}such";
    let plain = |words: String| {
        let control = |c: char| c != '\n' && (c.is_control() || c == '\u{202e}');
        assert!(!words.contains(control), "{words:?}");
        assert_eq!(words.lines().count(), 1, "{words:?}");
    };
    plain(fails(&["plan", &format!("{odd}.obj")], 2));
    plain(fails(&["plan", &format!("builtin:{odd}")], 2));
    plain(fails(&["tessellate", "builtin:cube", "-o", odd], 2));
    plain(fails(
        &[
            "tessellate",
            "builtin:cube",
            "--method",
            odd,
            "-o",
            "never.csv",
        ],
        2,
    ));
    plain(fails(&["verify", "--filter", odd], 2));
    if has_device() {
        plain(fails(&["devices", "--device", odd], 3));
    }
}

/// A warning names a file too.
#[test]
fn warnings_and_results_escape_names() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let odd = folder.path().join("odd\u{1b}[31m.obj");
    fs::write(&odd, format!("{CUBE}t oddity 0/0/0\n")).expect("written");
    let output = folder.path().join("odd\u{1b}[31m.csv");
    let done = run(&[
        "tessellate",
        name(&odd),
        "--level",
        "1",
        "-o",
        name(&output),
    ]);
    assert!(done.status.success());
    assert!(stderr(&done).contains("oddity"), "{}", stderr(&done));
    for words in [done.stderr, done.stdout] {
        assert!(
            !words.contains(&0x1b),
            "{}",
            String::from_utf8_lossy(&words)
        );
    }
}

/// The method that draws, and what is said about it.
fn drawn(model: &str, scheme: &str) -> (String, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("a.png");
    let arguments = [
        "render",
        model,
        "--scheme",
        scheme,
        "--level",
        "4",
        "--size",
        "64x64",
        "--json",
        "-o",
        name(&picture),
    ];
    let output = run(&arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    let stats: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let method = stats["method"].as_str().expect("a name").to_owned();
    (method, stderr(&output))
}

#[test]
fn the_limit_is_drawn_where_a_method_has_it() {
    if !has_device() {
        return;
    }
    for (model, scheme, method) in [
        ("builtin:creased-torus", "catmull-clark", "quadtree"),
        ("builtin:pole-7", "loop", "bft"),
        ("builtin:pole-7", "butterfly", "bft"),
        ("builtin:pole-7", "loop-stam", "bft"),
        ("builtin:ngons", "bilinear", "flat"),
    ] {
        let (drawn, words) = drawn(model, scheme);
        assert_eq!(drawn, method, "{model}, {scheme}");
        assert!(!words.contains("approximates"), "{words}");
    }
    let (drawn, words) = drawn("builtin:creased-torus", "loop");
    assert_eq!(drawn, "qas");
    let told = [
        "qas approximates the limit of the scheme loop",
        "% of the model's diagonal",
        "bft would draw the limit, but: edge ",
    ];
    assert!(told.iter().all(|part| words.contains(part)), "{words}");
}

#[test]
fn pipelines_are_kept_in_one_file_a_device_and_what_is_damaged_or_in_the_way_is_no_error() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let cache = folder.path().join("a/b");
    let picture = folder.path().join("p.png");
    let render = |cache: &str| {
        let size = ["--size", "32x32", "--pipeline-cache", cache];
        let output = run(&[&["render", "builtin:cube", "-o", name(&picture)], &size[..]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(stderr(&output), "");
        fs::read(&picture).expect("written")
    };
    let drawn = render("none");
    assert_eq!(names(folder.path()), ["p.png"]);
    assert_eq!(render(name(&cache)), drawn);
    let [file] = &names(&cache)[..] else {
        panic!("{:?}", names(&cache));
    };
    let file = cache.join(file);
    let kept = fs::read(&file).expect("written");
    for garbage in [
        &kept[..kept.len() - 1],
        b"",
        b"hullform pipelines 1\n",
        &[0; 4096],
    ] {
        fs::write(&file, garbage).expect("written");
        assert_eq!(render(name(&cache)), drawn);
        assert_eq!(names(&cache).len(), 1);
        assert!(
            fs::read(&file)
                .expect("written")
                .starts_with(b"hullform pipelines 1\n")
        );
    }
    // A file where the folder should be.
    assert_eq!(render(name(&picture)), drawn);
}
