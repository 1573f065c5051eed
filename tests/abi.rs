//! The shared layouts: `glsl/abi.glsl` is what `src/abi.rs` says, and compiled shaders put every member where Rust does.

use hullform::abi;

#[test]
fn committed_glsl_is_the_generated_one() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/glsl/abi.glsl");
    if std::env::var_os("HULLFORM_UPDATE").is_some() {
        std::fs::write(path, abi::glsl()).expect("glsl/abi.glsl can be written");
    }
    let committed = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        committed == abi::glsl(),
        "glsl/abi.glsl is stale: run HULLFORM_UPDATE=1 cargo test --test abi"
    );
}
