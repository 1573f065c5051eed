//! The programs in C beside the pages about drivers' faults: each finds its fault on the devices whose cases do, and on no other
#![cfg(feature = "cli")]

mod common;

use std::path::Path;
use std::process::Command;

use common::cli::{has_device, run};

/// A page, and the case that shows its fault.
const PAGES: [(&str, &str); 7] = [
    (
        "vertices_per_batch",
        "scale.vertices_per_batch.draw-16_patches-level_64-1_points",
    ),
    (
        "primitive_id",
        "scale.primitive_id.evaluation-draw-4097_patches-1_points",
    ),
    (
        "fragment_primitive_id",
        "primitive_id.fragment.draw-7_patches-3_points-level_1",
    ),
    (
        "patch_components",
        "barriers.patch_components.4_invocations-1_patches",
    ),
    ("loop_exits", "loops.control.tested_last"),
    (
        "query_without_pipeline",
        "statistics.begun.constants_pushed",
    ),
    (
        "culled_before_rounding",
        "winding.slivers.cull_back-beside_clipped",
    ),
];

/// Builds a program of one file; None where there is no compiler or no header of Vulkan.
fn built(source: &Path, folder: &Path) -> Option<std::path::PathBuf> {
    let program = folder.join(source.file_stem()?);
    let mut compiler = Command::new("cc");
    let options = ["-std=c11", "-Wall", "-Wextra", "-Werror"];
    compiler.args(options).arg(source).arg("-o").arg(&program);
    compiler.args(["-lvulkan"]);
    let output = compiler.output().ok()?;
    let words = String::from_utf8_lossy(&output.stderr);
    if words.contains("vulkan/vulkan.h") || words.contains("-lvulkan") {
        return None;
    }
    assert!(output.status.success(), "{}: {words}", source.display());
    Some(program)
}

#[test]
fn programs_find_the_faults_that_cases_find() {
    if !has_device() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/conformance/bugs");
    let nothing = folder.path().join("nothing.txt");
    std::fs::write(&nothing, "").expect("written");
    let nothing = nothing.to_str().expect("a plain name");
    for (page, case) in PAGES {
        assert!(sources.join(format!("{page}.md")).exists());
        let Some(program) = built(&sources.join(format!("{page}.c")), folder.path()) else {
            println!("skipped: no C compiler, or no headers of Vulkan");
            return;
        };
        let output = Command::new(program).output().expect("it starts");
        let verify = ["verify", "--filter", case, "--expectations", nothing];
        let verdict = run(&verify).status.code();
        let words = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), verdict, "{page}: {words}");
    }
}
