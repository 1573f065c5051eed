//! Turns `glsl/` into the SPIR-V modules that the crate embeds, and lists them in `shaders.rs` for `src/gpu/shaders.rs`.
//!
//! Every `glsl/method/NAME.glsl` makes up to ten modules, `NAME.vert`, `NAME.tesc`, `NAME.equal.tese`,
//! `NAME.fractional-even.tese`, both once more as `NAME.multiview.*`, `NAME.pattern.vert`, `NAME.geom` and `NAME.frag`: the shells `glsl/surface.*` with the method in the place of
//! their line `#include "method"`. Spacing is an execution mode, hence a module of its own. Methods that define `SCRATCH_RING` need control
//! shaders, and have neither of the modules that do without; they have `NAME.comp`, which fills a cache. Every other stage file in `glsl/` is a
//! module of its own, named like the file; those in `glsl/conformance/` are called `conformance.FILE`, and those of `examples/engine` likewise.
//!
//! With the feature `shaderc` the modules are compiled here. Without it they are the files in `glsl/spirv`, which
//! `scripts/update-spirv` writes and `tests/spirv.rs` holds to the sources.

use std::collections::BTreeMap;
use std::env;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

type Result<T> = std::result::Result<T, String>;

/// What the compiler is asked for, in words: a part of every fingerprint.
const OPTIONS: &str = "vulkan1.2 spirv1.5 performance";

/// The shells, by the ending of the module's name and of the file, and the value of the macro `SPACING`.
const SHELLS: [(&str, &str, Option<&str>); 10] = [
    ("vert", "vert", None),
    ("tesc", "tesc", None),
    ("equal.tese", "tese", Some("equal_spacing")),
    (
        "fractional-even.tese",
        "tese",
        Some("fractional_even_spacing"),
    ),
    ("multiview.equal.tese", "tese", Some("equal_spacing")),
    (
        "multiview.fractional-even.tese",
        "tese",
        Some("fractional_even_spacing"),
    ),
    ("pattern.vert", "pattern.vert", None),
    ("geom", "geom", None),
    ("frag", "frag", None),
    ("comp", "comp", None),
];

/// The shell that fills a cache with what control shaders compute for the ring.
const FOR_CACHE: &str = "comp";

/// The shells that evaluate patches without a control shader.
const WITHOUT_CONTROL: [&str; 2] = ["pattern.vert", "geom"];

/// File extension and the macro that says so to the shader.
const STAGES: [(&str, &str); 6] = [
    ("vert", "STAGE_VERTEX"),
    ("tesc", "STAGE_CONTROL"),
    ("tese", "STAGE_EVALUATION"),
    ("geom", "STAGE_GEOMETRY"),
    ("frag", "STAGE_FRAGMENT"),
    ("comp", "STAGE_COMPUTE"),
];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
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
    let sources = Sources::read()?;
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

/// One module to be: a stage file, and the method that stands for its `#include "method"`.
struct Module {
    name: String,
    file: String,
    method: Option<String>,
    stage: &'static str,
    spacing: Option<&'static str>,
    /// Whether it is for rendering with a view mask.
    multiview: bool,
}

/// All text under `glsl/`, by its path from there.
struct Sources(BTreeMap<String, String>);

impl Sources {
    fn read() -> Result<Sources> {
        let mut files = BTreeMap::new();
        let root = Path::new("glsl");
        if root.is_dir() {
            collect(root, "", &mut files)?;
        }
        Ok(Sources(files))
    }

    fn modules(&self) -> Result<Vec<Module>> {
        let methods: Vec<&str> = self
            .0
            .keys()
            .filter_map(|file| file.strip_prefix("method/")?.strip_suffix(".glsl"))
            .collect();
        let mut modules = Vec::new();
        for method in &methods {
            let has_ring =
                self.0[&format!("method/{method}.glsl")].contains("#define SCRATCH_RING");
            let shells = SHELLS.iter().filter(|(ending, _, _)| match *ending {
                FOR_CACHE => has_ring,
                ending => !(has_ring && WITHOUT_CONTROL.contains(&ending)),
            });
            for &(ending, extension, spacing) in shells {
                let file = format!("surface.{extension}");
                if !self.0.contains_key(&file) {
                    return Err(format!(
                        "glsl/{file} is missing: the method {method} needs it"
                    ));
                }
                modules.push(Module {
                    name: format!("{method}.{ending}"),
                    method: Some(format!("method/{method}.glsl")),
                    stage: stage(&file).expect("the shells are stage files"),
                    spacing,
                    multiview: ending.starts_with("multiview"),
                    file,
                });
            }
        }
        for file in self.0.keys().filter(|file| !is_shell(file)) {
            if let Some(stage) = stage(file) {
                modules.push(Module {
                    name: file.replace('/', "."),
                    method: None,
                    stage,
                    spacing: None,
                    multiview: false,
                    file: file.clone(),
                });
            }
        }
        match modules
            .iter()
            .find(|a| modules.iter().filter(|b| b.name == a.name).count() > 1)
        {
            Some(twice) => Err(format!(
                "two sources make the module {}: rename one",
                twice.name
            )),
            None => Ok(modules),
        }
    }

    /// The file that an include means.
    fn resolve<'a>(&'a self, module: &'a Module, include: &'a str) -> Result<(&'a str, &'a str)> {
        let file = match (include, &module.method) {
            ("method", Some(method)) => method,
            ("method", None) => {
                return Err(format!(
                    "glsl/{} includes a method, but only the surface shells can",
                    module.file
                ));
            }
            _ => include,
        };
        match self.0.get(file) {
            Some(text) => Ok((file, text)),
            None => Err(format!("include \"{include}\": there is no glsl/{file}")),
        }
    }

    /// A hash of everything that decides what the module becomes, the compiler aside.
    fn fingerprint(&self, module: &Module) -> Result<u64> {
        let mut hash = Fnv::new();
        hash.text(OPTIONS);
        hash.text(module.stage);
        hash.text(module.spacing.unwrap_or_default());
        if module.multiview {
            hash.text("MULTIVIEW");
        }
        let mut seen: Vec<&str> = Vec::new();
        let mut open = vec![module.file.as_str()];
        while let Some(file) = open.pop() {
            if seen.contains(&file) {
                continue;
            }
            seen.push(file);
            let text = self.0[file].as_str();
            hash.text(file);
            hash.text(text);
            for include in text.lines().filter_map(included) {
                let (file, _) = self
                    .resolve(module, include)
                    .map_err(|problem| format!("glsl/{file}: {problem}"))?;
                open.push(file);
            }
        }
        Ok(hash.0)
    }
}

/// Reads all shader text below `folder`, `glsl/spirv` and its binaries aside.
fn collect(folder: &Path, prefix: &str, files: &mut BTreeMap<String, String>) -> Result<()> {
    let say = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    for entry in fs::read_dir(folder).map_err(|error| say(folder, error))? {
        let path = entry.map_err(|error| say(folder, error))?.path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
            return Err(format!("{}: the name is not UTF-8", path.display()));
        };
        let name = format!("{prefix}{name}");
        if path.is_dir() {
            if name != "spirv" {
                collect(&path, &format!("{name}/"), files)?;
            }
        } else if name.ends_with(".glsl") || stage(&name).is_some() {
            let text = fs::read_to_string(&path).map_err(|error| say(&path, error))?;
            files.insert(name, text);
        }
    }
    Ok(())
}

/// Folders whose stage files are modules of their own.
const FOLDERS: [&str; 2] = ["conformance/", "engine/"];

/// The stage macro of a file that is a stage: one in `glsl/` itself or in one of the folders with a stage's extension.
fn stage(file: &str) -> Option<&'static str> {
    let (stem, extension) = file.rsplit_once('.')?;
    let (_, stage) = STAGES.iter().find(|(known, _)| *known == extension)?;
    let of_folder = |folder: &str| stem.strip_prefix(folder);
    let inside = FOLDERS.iter().find_map(|folder| of_folder(folder));
    let stem = inside.unwrap_or(stem);
    (!stem.contains('/')).then_some(stage)
}

fn is_shell(file: &str) -> bool {
    file.strip_prefix("surface.")
        .is_some_and(|extension| SHELLS.iter().any(|shell| shell.1 == extension))
}

/// The name in an `#include "name"` line.
fn included(line: &str) -> Option<&str> {
    let directive = line.trim_start().strip_prefix('#')?.trim_start();
    let name = directive.strip_prefix("include")?.trim_start();
    name.strip_prefix('"')?.split('"').next()
}

/// 64-bit FNV-1a: it tells versions of our own files apart, nobody attacks it, and it needs no crate.
struct Fnv(u64);

impl Fnv {
    fn new() -> Fnv {
        Fnv(0xcbf2_9ce4_8422_2325)
    }

    /// Adds a text and a terminator, so that "ab", "c" differs from "a", "bc".
    fn text(&mut self, text: &str) {
        for byte in text.bytes().chain([0xff]) {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
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
        let artifact = compile(&compiler, sources, module)?;
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

#[cfg(feature = "shaderc")]
fn compile(
    compiler: &shaderc::Compiler,
    sources: &Sources,
    module: &Module,
) -> Result<shaderc::CompilationArtifact> {
    use shaderc::{
        CompileOptions, EnvVersion, OptimizationLevel, ResolvedInclude, ShaderKind, SpirvVersion,
        TargetEnv,
    };
    let kind = match module.stage {
        "STAGE_VERTEX" => ShaderKind::Vertex,
        "STAGE_CONTROL" => ShaderKind::TessControl,
        "STAGE_EVALUATION" => ShaderKind::TessEvaluation,
        "STAGE_GEOMETRY" => ShaderKind::Geometry,
        "STAGE_FRAGMENT" => ShaderKind::Fragment,
        _ => ShaderKind::Compute,
    };
    let mut options = CompileOptions::new().map_err(|error| error.to_string())?;
    options.set_target_env(TargetEnv::Vulkan, EnvVersion::Vulkan1_2 as u32);
    options.set_target_spirv(SpirvVersion::V1_5);
    options.set_optimization_level(OptimizationLevel::Performance);
    options.add_macro_definition(module.stage, Some("1"));
    if let Some(spacing) = module.spacing {
        options.add_macro_definition("SPACING", Some(spacing));
    }
    if module.multiview {
        options.add_macro_definition("MULTIVIEW", Some("1"));
    }
    options.set_include_callback(|include, _, _, _| {
        let (file, text) = sources.resolve(module, include)?;
        Ok(ResolvedInclude {
            resolved_name: format!("glsl/{file}"),
            content: text.to_string(),
        })
    });
    let text = &sources.0[&module.file];
    compiler
        .compile_into_spirv(
            text,
            kind,
            &format!("glsl/{}", module.file),
            "main",
            Some(&options),
        )
        .map_err(|error| format!("{} does not compile: {error}", module.name))
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
