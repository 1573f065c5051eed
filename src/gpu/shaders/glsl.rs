//! The shader text of a folder, and the modules that it makes: which there are, what each is made of, and, with the compiler, their SPIR-V.
//!
//! `build.rs` and the library share this file. Every `method/NAME.glsl` makes up to eleven modules, `NAME.vert`, `NAME.tesc`, `NAME.equal.tese`,
//! `NAME.fractional-even.tese`, both once more as `NAME.multiview.*`, `NAME.pattern.vert`, `NAME.geom`, the same with tangents as `NAME.tangents.geom`, and `NAME.frag`: the shells `surface.*` with
//! the method in the place of their line `#include "method"`. Spacing is an execution mode, hence a module of its own. Methods that define
//! `SCRATCH_RING` need control shaders, and have neither of the modules that do without; they have `NAME.comp`, which fills a cache. Every other
//! stage file is a module of its own, named like the file; those in `conformance/` are called `conformance.FILE`, and those in `engine/` likewise.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// What is wrong, in words.
pub type Result<T> = std::result::Result<T, String>;

/// What the compiler is asked for, in words: a part of every fingerprint.
const OPTIONS: &str = "vulkan1.2 spirv1.5 performance";

/// The shells, by the ending of the module's name and of the file, and the value of the macro `SPACING`.
const SHELLS: [(&str, &str, Option<&str>); 11] = [
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
    ("tangents.geom", "geom", None),
    ("frag", "frag", None),
    ("comp", "comp", None),
];

/// The shell that fills a cache with what control shaders compute for the ring.
const FOR_CACHE: &str = "comp";

/// The shells that evaluate patches without a control shader.
const WITHOUT_CONTROL: [&str; 3] = ["pattern.vert", "geom", "tangents.geom"];

/// File extension and the macro that says so to the shader.
const STAGES: [(&str, &str); 6] = [
    ("vert", "STAGE_VERTEX"),
    ("tesc", "STAGE_CONTROL"),
    ("tese", "STAGE_EVALUATION"),
    ("geom", "STAGE_GEOMETRY"),
    ("frag", "STAGE_FRAGMENT"),
    ("comp", "STAGE_COMPUTE"),
];

/// One module to be: a stage file, and the method that stands for its `#include "method"`.
pub struct Module {
    /// What pipelines ask for it by.
    pub name: String,
    file: String,
    method: Option<String>,
    stage: &'static str,
    spacing: Option<&'static str>,
    /// Whether it is for rendering with a view mask.
    multiview: bool,
    /// Whether it is a geometry shader that hands on tangents.
    tangents: bool,
}

/// All shader text of a folder, by its path from there.
pub struct Sources(pub BTreeMap<String, String>);

impl Sources {
    /// What a folder has; nothing where there is none.
    pub fn read(root: &Path) -> Result<Sources> {
        let mut files = BTreeMap::new();
        if root.is_dir() {
            collect(root, "", &mut files)?;
        }
        Ok(Sources(files))
    }

    /// The modules that it makes.
    pub fn modules(&self) -> Result<Vec<Module>> {
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
                    tangents: ending.starts_with("tangents"),
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
                    tangents: false,
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
    pub fn fingerprint(&self, module: &Module) -> Result<u64> {
        let mut hash = Fnv::new();
        hash.text(OPTIONS);
        hash.text(module.stage);
        hash.text(module.spacing.unwrap_or_default());
        if module.multiview {
            hash.text("MULTIVIEW");
        }
        if module.tangents {
            hash.text("WITH_TANGENTS");
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

/// The SPIR-V of a module.
#[cfg(feature = "shaderc")]
pub fn compile(
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
    if module.tangents {
        options.add_macro_definition("WITH_TANGENTS", Some("1"));
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
