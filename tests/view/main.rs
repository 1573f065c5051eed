//! The window, driven by mouse and keys on a display that nobody sees: each step is held to the state that it tells and to the picture that is seen.

#![cfg(all(feature = "view", target_os = "linux"))]

mod display;
mod drag;
mod drop;
mod files;
mod losses;
mod pictures;
mod random;
#[cfg(feature = "shaderc")]
mod shaders;
mod steps;
mod window;

use std::process::Command;

use display::Display;

/// A display; None, with a word, where none can be had. The CI machine has it.
fn display() -> Option<Display> {
    let display = Display::start();
    if display.is_none() {
        assert!(
            std::env::var_os("CI").is_none(),
            "Xvfb is missing: run scripts/setup"
        );
        eprintln!("skipped: Xvfb is not installed (scripts/setup does it)");
    }
    display
}

/// A box with creases around its top.
const BOX: &str = "\
v -1 -1 -1\nv 1 -1 -1\nv 1 -1 1\nv -1 -1 1\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1\n\
f 1 2 3 4\nf 8 7 6 5\nf 4 3 7 8\nf 3 2 6 7\nf 2 1 5 6\nf 1 4 8 5\n\
t crease 2/1/0 4 5 2.5\nt crease 2/1/0 5 6 2.5\nt crease 2/1/0 6 7 2.5\nt crease 2/1/0 7 4 2.5\n";

#[test]
fn without_a_display_the_program_says_so_and_what_to_do() {
    let output = Command::new(env!("CARGO_BIN_EXE_hullform"))
        .arg("view")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .expect("the program starts");
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{words}");
    assert!(words.contains("hullform render"), "{words}");
    assert!(!words.contains("panicked"), "{words}");
}
