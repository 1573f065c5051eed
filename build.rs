//! Turns `glsl/` into the SPIR-V modules that the crate embeds, and lists them in `shaders.rs` for `src/gpu/shaders.rs`.
//!
//! Which there are and how they are compiled tells `src/gpu/shaders/glsl.rs`.
//!
//! With the feature `shaderc` the modules are compiled here. Without it they are the files in `glsl/spirv`, which
//! `scripts/update-spirv` writes and `tests/spirv.rs` holds to the sources.

use std::env;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

#[path = "src/gpu/shaders/glsl.rs"]
mod glsl;

use glsl::{Module, Result, Sources};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/gpu/shaders/glsl.rs");
    if env::var_os("CARGO_FEATURE_VULKAN").is_none() {
        return;
    }
    println!("cargo::rerun-if-changed=glsl");
    if let Err(problem) = build() {
        for line in problem.lines() {
            println!("cargo::error={line}");
        }
    }
}

fn build() -> Result<()> {
    let sources = Sources::read(Path::new("glsl"))?;
    let mut modules = sources.modules()?;
    modules.sort_by(|a, b| a.name.cmp(&b.name));
    let fingerprints = modules
        .iter()
        .map(|module| sources.fingerprint(module))
        .collect::<Result<Vec<_>>>()?;
    let compiler = provide(&sources, &modules, &fingerprints)?;
    let text = listing(&sources, &modules, &fingerprints, &compiler);
    write(&out_dir().join("shaders.rs"), text.as_bytes())
}

/// `shaders.rs`: the modules, the sources, the fingerprints and the compiler.
fn listing(sources: &Sources, modules: &[Module], fingerprints: &[u64], compiler: &str) -> String {
    let mut modules_text = String::new();
    let mut fingerprints_text = String::new();
    let mut sources_text = String::new();
    for (Module { name, .. }, fingerprint) in modules.iter().zip(fingerprints) {
        let bytes = if cfg!(feature = "shaderc") {
            format!("concat!(env!(\"OUT_DIR\"), \"/spirv/{name}.spv\")")
        } else {
            format!("concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/glsl/spirv/{name}.spv\")")
        };
        let _ = writeln!(
            modules_text,
            "    (\"{name}\", &Aligned(*include_bytes!({bytes})).0),"
        );
        let _ = writeln!(fingerprints_text, "    (\"{name}\", 0x{fingerprint:016x}),");
    }
    for file in sources.0.keys() {
        let path = format!("concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/glsl/{file}\")");
        let _ = writeln!(sources_text, "    (\"{file}\", include_str!({path})),");
    }
    format!(
        "/// Every SPIR-V module: its name and its bytes, which start at a multiple of four.\n\
         pub static MODULES: &[(&str, &[u8])] = &[\n{modules_text}];\n\n\
         /// Every GLSL source: its path below `glsl/`, as `#include` lines spell it, and its text.\n\
         pub static SOURCES: &[(&str, &str)] = &[\n{sources_text}];\n\n\
         /// A hash for each module of all that decides what it becomes: sources, macros, options.\n\
         pub static FINGERPRINTS: &[(&str, u64)] = &[\n{fingerprints_text}];\n\n\
         /// The compiler that made the modules, in words.\n\
         pub static COMPILER: &str = {compiler:?};\n"
    )
}

fn out_dir() -> std::path::PathBuf {
    env::var_os("OUT_DIR").expect("cargo sets OUT_DIR").into()
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    fs::write(path, bytes).map_err(|error| format!("{}: {error}", path.display()))
}

/// Without the compiler: sees that the shipped modules are there, warns if they are stale; returns who compiled them.
#[cfg(not(feature = "shaderc"))]
fn provide(_: &Sources, modules: &[Module], fingerprints: &[u64]) -> Result<String> {
    const REMEDY: &str = "run scripts/update-spirv, or build with --features shaderc";
    let manifest = fs::read_to_string("glsl/spirv/MANIFEST")
        .map_err(|error| format!("glsl/spirv/MANIFEST: {error}; {REMEDY}"))?;
    let recorded = |name: &str| {
        manifest
            .lines()
            .find_map(|line| Some(line.strip_prefix(name)?.strip_prefix(' ')?.trim()))
    };
    for (Module { name, .. }, fingerprint) in modules.iter().zip(fingerprints) {
        let file = format!("glsl/spirv/{name}.spv");
        if !Path::new(&file).exists() {
            return Err(format!("{file} is missing; {REMEDY}"));
        }
        if recorded(name) != Some(&format!("{fingerprint:016x}")) {
            println!("cargo::warning={file} was compiled from other sources than these; {REMEDY}");
        }
    }
    Ok(recorded("compiler").unwrap_or("unknown").to_string())
}

/// With the compiler: compiles all modules into `OUT_DIR/spirv`; returns who compiled them.
#[cfg(feature = "shaderc")]
fn provide(sources: &Sources, modules: &[Module], _: &[u64]) -> Result<String> {
    let compiler = shaderc::Compiler::new().map_err(|error| error.to_string())?;
    let folder = out_dir().join("spirv");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for module in modules {
        let artifact = glsl::compile(&compiler, sources, module)?;
        for line in artifact.get_warning_messages().lines() {
            println!("cargo::warning={}: {line}", module.name);
        }
        write(
            &folder.join(format!("{}.spv", module.name)),
            artifact.as_binary_u8(),
        )?;
    }
    Ok(compiler_version())
}

/// What `scripts/setup` noted beside the library: shaderc itself does not tell its version.
#[cfg(feature = "shaderc")]
fn compiler_version() -> String {
    println!("cargo::rerun-if-env-changed=SHADERC_LIB_DIR");
    let Some(folder) = env::var_os("SHADERC_LIB_DIR") else {
        return "unknown".to_string();
    };
    let note = Path::new(&folder).join("VERSION");
    println!("cargo::rerun-if-changed={}", note.display());
    fs::read_to_string(note).map_or("unknown".to_string(), |text| text.trim().to_string())
}
