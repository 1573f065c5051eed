//! `tessellate --on cpu`: the same file as the device's, without one.
#![cfg(feature = "cli")]

mod common;

use common::cli::{fails, has_device, hullform, run, stderr};

struct Folder(tempfile::TempDir);

impl Folder {
    fn tessellated(&self, arguments: &[&str]) -> Vec<u8> {
        let path = self.0.path().join("out.ply");
        let path = path.to_str().expect("UTF-8");
        let output = run(&[&["tessellate", "-o", path], arguments].concat());
        assert!(
            output.status.success(),
            "{arguments:?}: {}",
            stderr(&output)
        );
        std::fs::read(path).expect("it was written")
    }
}

/// At levels that are powers of two the tess coordinates are the same on all devices, and the twins do what the shaders do.
#[test]
fn the_cpu_writes_the_same_bytes_as_the_device() {
    if !has_device() {
        return;
    }
    let folder = Folder(tempfile::tempdir().expect("a folder"));
    let cases: [&[&str]; 8] = [
        &["builtin:hull", "--level", "8"],
        &["builtin:hull", "--level", "1"],
        &["builtin:creased-torus", "--level", "16"],
        &["builtin:ngons", "--level", "4"],
        &[
            "builtin:pole-7",
            "--scheme",
            "loop",
            "--level",
            "4",
            "--method",
            "qas",
            "--backend",
            "pattern",
        ],
        &["builtin:cube", "--method", "phong", "--level", "2"],
        &["builtin:hull", "--method", "flat", "--level", "2"],
        &["builtin:cube", "--method", "bft", "--level", "8"],
    ];
    for case in cases {
        let [cpu, device] =
            ["cpu", "device"].map(|on| folder.tessellated(&[case, &["--on", on]].concat()));
        assert_eq!(cpu.len(), device.len(), "{case:?}");
        let differing = cpu.iter().zip(&device).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "{case:?}");
    }
}

/// Any level and spacing; and as many threads as one likes.
#[test]
fn the_cpu_needs_no_device_and_threads_change_nothing() {
    let folder = Folder(tempfile::tempdir().expect("a folder"));
    let path = folder.0.path().join("out.ply");
    let of_threads = |threads: &str, more: &[&str]| {
        let output = hullform(&["tessellate", "builtin:hull", "--on", "cpu", "-o"])
            .arg(&path)
            .args(more)
            .env("RAYON_NUM_THREADS", threads)
            .env("VK_DRIVER_FILES", "/nowhere")
            .env("VK_ICD_FILENAMES", "/nowhere")
            .output()
            .expect("the program starts");
        assert!(output.status.success(), "{}", stderr(&output));
        std::fs::read(&path).expect("it was written")
    };
    for more in [
        &["--level", "5"][..],
        &["--level", "6.5", "--spacing", "fractional-even"],
        &["--backend", "geometry", "--residence", "cache"],
    ] {
        let one = of_threads("1", more);
        assert!(
            one.len() > 100_000 && one == of_threads("3", more),
            "{more:?}"
        );
    }
    let words = fails(
        &[
            "tessellate",
            "builtin:cube",
            "-o",
            "never.ply",
            "--on",
            "cpu",
            "--adaptive",
            "screen",
        ],
        2,
    );
    assert!(
        words.contains("--adaptive") && words.contains("--on device"),
        "{words}"
    );
}
