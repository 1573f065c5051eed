//! The `hullform` program, run by its users' means.

use std::process::{Command, Output};

/// The program with some arguments.
pub fn hullform(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hullform"));
    command.args(arguments).env_remove("RUST_LOG");
    // Plans are kept from run to run, but not among the user's.
    command.env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"));
    command
}

/// Runs it to its end.
pub fn run(arguments: &[&str]) -> Output {
    let output = hullform(arguments).output();
    output.expect("the program starts")
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs, expects the exit code, and returns what it said on stderr.
pub fn fails(arguments: &[&str], code: i32) -> String {
    let output = run(arguments);
    let words = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {words}");
    assert!(!words.contains("panicked"), "{words}");
    words
}

/// Whether some device will do; says so if not.
pub fn has_device() -> bool {
    let found = run(&["devices"]).status.success();
    if !found {
        println!("skipped: no suitable Vulkan device");
    }
    found
}
