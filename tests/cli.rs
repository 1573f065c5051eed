//! The `hullform` program as its users meet it: exit codes, messages, and what it prints.
#![cfg(feature = "cli")]

mod common;

use common::cli::{fails, has_device, hullform, run, stderr, stdout};
use serde_json::Value;
use std::process::Stdio;

#[test]
fn every_subcommand_has_help() {
    for command in ["render", "tessellate", "plan", "devices"] {
        let output = run(&[command, "--help"]);
        assert!(output.status.success());
        let help = stdout(&output);
        assert!(help.contains("--device <INDEX|NAME>"), "{help}");
        assert!(help.contains("--ring-bytes"), "{help}");
    }
    assert!(stdout(&run(&["--help"])).contains("Exit codes"));
    assert!(stdout(&run(&["--version"])).starts_with("hullform "));
}

#[test]
#[cfg(not(feature = "view"))]
fn a_build_without_the_window_says_so_and_how_to_have_it() {
    let output = run(&["view"]);
    let words = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{words}");
    assert!(
        words.contains("--features view") && words.contains("hullform render"),
        "{words}"
    );
}

#[test]
fn usage_errors_exit_with_2() {
    let wrong: [&[&str]; 14] = [
        &[],
        &["paint"],
        &["tessellate"],
        &["tessellate", "cube.obj"],
        &["plan"],
        &["plan", "cube.obj", "--max-level", "11"],
        &["plan", "cube.obj", "--max-level", "0"],
        &["render", "--level", "1025"],
        &["render", "--level", "NaN"],
        &["render", "--size", "10"],
        &["render", "--camera", "1,2"],
        &["render", "--shading", "pink"],
        &["render", "--spacing", "fractional-odd"],
        &["render", "--ring-bytes", "1GB"],
    ];
    for arguments in wrong {
        fails(arguments, 2);
    }
    // It is no slip of the pen: whoever knows Vulkan is told why.
    for command in ["render", "bench"] {
        let words = fails(&[command, "--spacing", "fractional-odd"], 2);
        assert!(
            words.contains("n-gons") && words.contains("choose fractional-even"),
            "{words}"
        );
    }
}

#[test]
fn a_model_that_is_not_there_is_named() {
    let commands: [&[&str]; 3] = [
        &["plan", "no/such/model.obj"],
        &["tessellate", "no/such/model.obj", "-o", "never.csv"],
        &["render", "no/such/model.obj", "-o", "never.png"],
    ];
    for arguments in commands {
        let words = fails(arguments, 2);
        assert!(
            words.starts_with("hullform: no/such/model.obj: "),
            "{words}"
        );
    }
    assert!(!std::path::Path::new("never.csv").exists());
    assert!(!std::path::Path::new("never.png").exists());
}

#[test]
fn an_unknown_extension_is_refused_before_any_work() {
    let words = fails(&["tessellate", "no/such/model.obj", "-o", "out.stl"], 2);
    assert!(words.contains("out.stl") && words.contains(".csv, .obj, .ply"));
    let words = fails(&["render", "no/such/model.obj", "-o", "out.jpg"], 2);
    assert!(words.contains("out.jpg") && words.contains(".png"));
}

#[test]
fn an_unknown_device_exits_with_3() {
    let words = fails(&["devices", "--device", "no such device"], 3);
    assert!(words.contains("no suitable Vulkan device"), "{words}");
}

#[test]
fn without_a_driver_the_remedy_is_named() {
    let output = hullform(&["devices"])
        .env("VK_DRIVER_FILES", "/no/such/driver.json")
        .env("VK_ICD_FILENAMES", "/no/such/driver.json")
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(3));
    let words = stderr(&output);
    assert!(words.contains("install"), "{words}");
}

#[test]
fn devices_are_listed_as_json() {
    if !has_device() {
        return;
    }
    let list = |arguments: &[&str]| -> Value {
        let output = run(arguments);
        assert!(output.status.success());
        serde_json::from_slice(&output.stdout).expect("JSON alone")
    };
    let devices = list(&["devices", "--json"])["devices"].clone();
    let devices = devices.as_array().expect("a list");
    assert!(devices.iter().any(|device| device["suitable"] == true));
    for (index, device) in devices.iter().enumerate() {
        assert_eq!(device["index"], index);
        let missing = device["missing"].as_array().expect("a list");
        assert_eq!(device["suitable"], missing.is_empty());
        let lavapipe = device["driver"]["name"] == "llvmpipe";
        let workarounds = device["workarounds"].as_array().expect("a list");
        let split = workarounds.iter().any(|row| row["name"] == "split-batches");
        assert_eq!(split, lavapipe);
    }
    let bare = list(&["devices", "--json", "--no-workarounds"]);
    assert_eq!(bare["devices"][0]["workarounds"], Value::Array(Vec::new()));
}

#[test]
fn listing_devices_is_clean_under_validation() {
    if !has_device() {
        return;
    }
    let output = run(&["devices", "--validation"]);
    let words = stderr(&output);
    if words.contains("is not installed") {
        println!("skipped: {words}");
        return;
    }
    assert!(output.status.success(), "{words}");
    assert!(words.is_empty(), "{words}");
}

#[test]
fn a_reader_who_leaves_early_is_no_error() {
    if !has_device() {
        return;
    }
    let mut child = hullform(&["devices", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
}
