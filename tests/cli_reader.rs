//! What the program says about the files that it reads: each message names its file, and reading ends.
#![cfg(feature = "cli")]

mod common;

use common::cli::{fails, hullform, run, stderr};
use std::io::Write;
use std::path::PathBuf;
use std::process::{Output, Stdio};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/// Files in a folder of their own.
struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Files {
        Files(tempfile::tempdir().expect("a folder"))
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        std::fs::write(&path, text).expect("room for a file");
        path.to_str().expect("UTF-8").to_string()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

/// What `plan` says on stderr of a file that it reads.
fn warnings(path: &str, more: &[&str]) -> String {
    let output = run(&[&["plan", path], more].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    stderr(&output)
}

#[test]
fn what_is_unusual_is_read_with_a_warning_that_names_file_and_line() {
    let files = Files::new();
    let cases = [
        (
            "vt nan nan\n",
            ":6: \"vt\": a texture coordinate is not finite: (0, 0) instead",
        ),
        (
            "usemtl x\\\nf 1 2 3\n",
            ":6: \"usemtl\": its backslash makes line 7 a part of it",
        ),
        (
            "# fine\ng x\\",
            ":7: \"g\": the file ends behind its backslash",
        ),
        (
            "curv 0 1 1 2\n",
            ":6: \"curv\": this statement is unknown and ignored",
        ),
        (
            "v 0 0 1 7\n",
            ":6: \"v\": the fourth value, a weight, is ignored",
        ),
        (
            "v 0 0 1 nan\n",
            ":6: \"v\": the fourth value, a weight, is ignored",
        ),
    ];
    for (line, words) in cases {
        let path = files.write("odd.obj", format!("{SQUARE}{line}"));
        let warned = warnings(&path, &[]);
        assert!(
            warned.contains(&format!("{path}{words}")),
            "{line:?}: {warned}"
        );
    }
    let silent = [
        "s 1\ng a b\nl 1 2\np 3\nvn 0 0 1\no x\nusemtl \u{fffd}\n",
        "vt 0.5\n",
        "v 0 0 1 1\n",
        "g x\\\ny z\n",
        "\\\n\\\nv 0 0 1\n",
    ];
    for line in silent {
        let path = files.write("plain.obj", format!("{SQUARE}{line}").replace('\n', "\r"));
        assert_eq!(warnings(&path, &[]), "", "{line:?}");
    }
    // Whatever a file is, it does not fill the screen.
    let many: String = (0..500).map(|i| format!("x{i}\n")).collect();
    let warned = warnings(&files.write("many.obj", format!("{many}{SQUARE}")), &[]);
    assert!(
        warned.contains("no further warnings") && warned.lines().count() < 30,
        "{warned}"
    );
}

#[test]
fn a_mesh_without_a_surface_says_so() {
    let files = Files::new();
    let hole = files.write("hole.obj", format!("{SQUARE}t hole 1/0/0 0\n"));
    let none = files.write(
        "none.obj",
        format!("{SQUARE}t interpolateboundary 1/0/0 0\n"),
    );
    for path in [&hole, &none] {
        let warned = warnings(path, &[]);
        assert!(
            warned.contains(&format!("{path}: there is no surface")),
            "{warned}"
        );
    }
    // Without rules for neighbours there is one at the boundary.
    let (scheme, mesh) = (["--scheme", "bilinear"], files.write("some.obj", SQUARE));
    let output = run(&[&["plan", &none], &scheme[..]].concat());
    assert!(
        !stderr(&output).contains("no surface"),
        "{}",
        stderr(&output)
    );
    assert_eq!(warnings(&mesh, &[]), "");
}

#[test]
fn messages_about_models_name_their_file() {
    let files = Files::new();
    let crease = files.write(
        "semi.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nt crease 2/1/0 0 2 2.5\n",
    );
    let square = files.write("square.obj", SQUARE);
    let commands: [&[&str]; 4] = [
        &["plan"],
        &["render", "-o", "never.png"],
        &["tessellate", "-o", "never.csv"],
        &["compare", "-o", "never.png"],
    ];
    for command in commands {
        let words = fails(&[command, &[&crease, "--scheme", "butterfly"]].concat(), 2);
        let expected = format!("hullform: {crease}: edge 0-2: its sharpness is 2.5");
        assert!(words.starts_with(&expected), "{command:?}: {words}");
        let words = fails(&[command, &["builtin:cube-7"]].concat(), 2);
        assert!(words.contains("cube-7"), "{command:?}: {words}");
    }
    // Of several files, the one that is meant.
    let words = fails(&["verify", &square, &crease, "--scheme", "butterfly"], 2);
    assert!(
        words.contains(&format!("hullform: {crease}: edge 0-2: ")),
        "{words}"
    );
    assert!(
        words.contains(&format!("{square}: the scheme butterfly takes triangles")),
        "{words}"
    );
    assert!(!std::path::Path::new("never.png").exists());
}

/// Names are those of the system, whatever their encoding.
#[cfg(unix)]
#[test]
fn a_file_s_name_need_not_be_utf_8() {
    use std::os::unix::ffi::OsStrExt;
    let files = Files::new();
    let path = files
        .0
        .path()
        .join(std::ffi::OsStr::from_bytes(b"loop_mod\xe8le.obj"));
    if std::fs::write(&path, SQUARE).is_err() {
        println!("skipped: this file system wants names of UTF-8");
        return;
    }
    let output = hullform(&["plan"]).arg(&path).output().expect("it starts");
    // Its scheme is that of its name, which `plan` does not do.
    assert!(
        stderr(&output).contains("le.obj: the scheme loop takes triangles"),
        "{}",
        stderr(&output)
    );
    let output = hullform(&["plan", "--scheme=catmull-clark"])
        .arg(&path)
        .output();
    assert!(output.expect("it starts").status.success());
}

fn plan_of_stdin(text: &[u8]) -> Output {
    let mut child = hullform(&["plan", "/dev/stdin"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut pipe = child.stdin.take().expect("a pipe");
    pipe.write_all(text).expect("it listens");
    drop(pipe);
    child.wait_with_output().expect("it ends")
}

#[cfg(target_os = "linux")]
#[test]
fn pipes_are_read_and_what_has_no_end_is_refused() {
    let output = plan_of_stdin(SQUARE.as_bytes());
    assert!(output.status.success(), "{}", stderr(&output));
    let output = plan_of_stdin(b"f 1 2\n");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).starts_with("hullform: /dev/stdin:1: the face has 2 vertices"));
    for device in ["/dev/zero", "/dev/urandom", "/dev/full", "/dev/null"] {
        let words = fails(&["plan", device], 2);
        assert!(
            words.starts_with(&format!("hullform: {device}: it is a device")),
            "{words}"
        );
    }
    let words = fails(&["plan", "/"], 2);
    assert!(words.contains("directory"), "{words}");
}

/// Files with holes take no room on the disk.
#[test]
fn files_that_are_too_large_are_refused_before_they_are_read() {
    let files = Files::new();
    let path = files.path("large.obj");
    let file = std::fs::File::create(&path).expect("a file");
    if file.set_len(5 << 30).is_err() {
        println!("skipped: no files with holes here");
        return;
    }
    let path = path.to_str().expect("UTF-8");
    let words = fails(&["plan", path], 2);
    let expected = format!("hullform: {path}: it has 5368709120 bytes");
    assert!(
        words.starts_with(&expected) && words.contains("4294967296"),
        "{words}"
    );
}
