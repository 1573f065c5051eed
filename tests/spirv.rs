//! The SPIR-V that ships in `glsl/spirv` belongs to the sources in `glsl`.
//!
//! `scripts/update-spirv` runs these tests with `HULLFORM_UPDATE_SPIRV` set: then they write instead of compare.

#![cfg(feature = "vulkan")]

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use common::flow::{Flow, Output};
use common::spirv::instructions;
use hullform::abi;
use hullform::gpu::shaders::{COMPILER, FINGERPRINTS, MODULES};
use hullform::method::METHODS;

const REMEDY: &str = "run scripts/update-spirv and commit glsl/spirv";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("glsl/spirv")
}

/// The manifest that the present sources and compiler make.
fn manifest() -> String {
    let mut text = format!(
        "# What the modules here were compiled from, and by which compiler. Written by scripts/update-spirv.\n\
         compiler {COMPILER}\n"
    );
    for (name, fingerprint) in FINGERPRINTS {
        text += &format!("{name} {fingerprint:016x}\n");
    }
    text
}

/// The lines of a manifest, its comments aside, as names and values.
fn entries(manifest: &str) -> BTreeSet<(&str, &str)> {
    let lines = manifest.lines().filter(|line| !line.starts_with('#'));
    lines.filter_map(|line| line.split_once(' ')).collect()
}

fn update() {
    let shipped = fs::read_dir(folder()).expect("glsl/spirv is a folder");
    for file in shipped.map(|entry| entry.expect("glsl/spirv can be listed").path()) {
        if file.extension().is_some_and(|extension| extension == "spv") {
            fs::remove_file(file).expect("old modules can be removed");
        }
    }
    for (name, bytes) in MODULES {
        fs::write(folder().join(format!("{name}.spv")), bytes).expect("glsl/spirv can be written");
    }
    fs::write(folder().join("MANIFEST"), manifest()).expect("glsl/spirv can be written");
}

#[test]
fn shipped_modules_belong_to_the_sources() {
    if cfg!(feature = "shaderc") && std::env::var_os("HULLFORM_UPDATE_SPIRV").is_some() {
        update();
    }
    let shipped = fs::read_to_string(folder().join("MANIFEST")).expect("glsl/spirv has a MANIFEST");
    let fresh = manifest();
    let of_sources = |text| -> BTreeSet<_> {
        let modules = entries(text).into_iter();
        modules.filter(|(name, _)| *name != "compiler").collect()
    };
    assert_eq!(
        of_sources(&shipped),
        of_sources(&fresh),
        "stale SPIR-V: {REMEDY}"
    );

    let files: BTreeSet<String> = fs::read_dir(folder())
        .expect("glsl/spirv is a folder")
        .filter_map(|entry| {
            entry
                .expect("glsl/spirv can be listed")
                .file_name()
                .into_string()
                .ok()
        })
        .filter_map(|name| Some(name.strip_suffix(".spv")?.to_string()))
        .collect();
    let names: BTreeSet<String> = MODULES.iter().map(|(name, _)| name.to_string()).collect();
    assert_eq!(files, names, "modules and files differ: {REMEDY}");

    if cfg!(feature = "shaderc") {
        let same_compiler =
            COMPILER != "unknown" && entries(&shipped).contains(&("compiler", COMPILER));
        compare_with_compiled(same_compiler);
    } else {
        eprintln!("not compared with compiled modules: the feature shaderc is off");
    }
}

/// The same compiler gives the same bytes; another one at least the same interface.
fn compare_with_compiled(same_compiler: bool) {
    if !same_compiler {
        eprintln!(
            "compiled by {COMPILER}, the shipped modules by another: only interfaces are compared"
        );
    }
    for (name, compiled) in MODULES {
        let shipped =
            fs::read(folder().join(format!("{name}.spv"))).expect("the shipped module is there");
        if same_compiler {
            assert!(
                *compiled == shipped,
                "{name}: the compiled bytes differ from the shipped ones; {REMEDY}"
            );
        } else {
            assert_eq!(interface(compiled), interface(&shipped), "{name}: {REMEDY}");
        }
    }
}

/// One fact that a pipeline can see of a module.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fact {
    /// Execution model and name.
    EntryPoint(u32, String),
    /// Execution mode and its operands: patch size, spacing, local size.
    Mode(Vec<u32>),
    /// What decorates a variable, constant or block: storage class, binding, location, offsets.
    Decorations(Vec<Vec<u32>>),
}

/// What pipelines see of a module, sorted and without the compiler's own numbering.
fn interface(bytes: &[u8]) -> Vec<Fact> {
    const ENTRY_POINT: u32 = 15;
    const EXECUTION_MODE: u32 = 16;
    const VARIABLE: u32 = 59;
    const DECORATE: u32 = 71;
    const MEMBER_DECORATE: u32 = 72;
    let mut facts = Vec::new();
    let mut decorations: BTreeMap<u32, Vec<Vec<u32>>> = BTreeMap::new();
    for instruction in instructions(bytes) {
        let operands = &instruction[1..];
        match instruction[0] & 0xffff {
            ENTRY_POINT => {
                let name = operands[2..].iter().flat_map(|word| word.to_le_bytes());
                let name = name.take_while(|byte| *byte != 0).map(char::from).collect();
                facts.push(Fact::EntryPoint(operands[0], name));
            }
            EXECUTION_MODE => {
                facts.push(Fact::Mode(operands[1..].to_vec()));
            }
            DECORATE if seen_from_outside(operands[1]) => {
                let list = decorations.entry(operands[0]).or_default();
                list.push(operands[1..].to_vec());
            }
            MEMBER_DECORATE if seen_from_outside(operands[2]) => {
                let list = decorations.entry(operands[0]).or_default();
                list.push(operands[1..].to_vec());
            }
            // Decorations come before variables; the storage class tells inputs from outputs.
            VARIABLE => {
                if let Some(list) = decorations.get_mut(&operands[1]) {
                    list.push(vec![operands[2]]);
                }
            }
            _ => {}
        }
    }
    for mut list in decorations.into_values() {
        list.sort();
        facts.push(Fact::Decorations(list));
    }
    facts.sort();
    facts
}

/// Decorations that other stages, the layouts or the host rely on.
fn seen_from_outside(decoration: u32) -> bool {
    const SPEC_ID: u32 = 1;
    const BUILT_IN: u32 = 11;
    const PATCH: u32 = 15;
    const LOCATION_AND_COMPONENT: std::ops::RangeInclusive<u32> = 30..=31;
    const BINDING_SET_AND_OFFSET: std::ops::RangeInclusive<u32> = 33..=35;
    matches!(decoration, SPEC_ID | BUILT_IN | PATCH)
        || LOCATION_AND_COMPONENT.contains(&decoration)
        || BINDING_SET_AND_OFFSET.contains(&decoration)
}

/// The modules of a stage of all methods that promise the same bits on both sides of an edge.
fn watertight(stage: &str) -> Vec<(&'static str, &'static [u8])> {
    let methods = METHODS.iter().filter(|method| method.contract.watertight);
    let modules = methods.flat_map(|method| {
        let own = |name: &str| name.starts_with(method.name) && name.ends_with(stage);
        MODULES.iter().filter(move |(name, _)| own(name))
    });
    let modules: Vec<_> = modules.map(|&(name, bytes)| (name, bytes)).collect();
    assert!(!modules.is_empty(), "no module of stage {stage}");
    modules
}

/// Position, normal, and where in the patch, as `glsl/lib/vertex.glsl` has them. Clip coordinates and texture coordinates are left out: clip
/// coordinates come of the same instructions for all faces, and nobody compares texture coordinates across edges.
const EVALUATED: [Output; 4] = [
    Output::Location(0),
    Output::Location(1),
    Output::Location(2),
    Output::Binding(abi::BINDING_CAPTURE),
];

/// Tess levels.
const LEVELS: [Output; 2] = [Output::BuiltIn(11), Output::BuiltIn(12)];

/// Faces on an edge may be drawn by other modules, other pipelines, other inlined copies of a function: what a compiler fuses in one of them
/// only would be a crack (SPIR-V, NoContraction).
#[test]
fn nothing_that_flows_into_positions_normals_and_levels_may_be_contracted() {
    let mut total = 0;
    let evaluating = [".tese", ".pattern.vert", ".geom"].map(watertight);
    for (name, bytes) in evaluating.concat() {
        let (count, free) = Flow::of(bytes).contractible(&EVALUATED);
        assert!(
            free.is_empty(),
            "{name}: {} of {count}: {free:?}",
            free.len()
        );
        assert!(count > 50, "{name}: {count}");
        total += count;
    }
    for (name, bytes) in watertight(".tesc") {
        // Control points go on as outputs, or into the ring.
        let points = [Output::Location(2), Output::Binding(abi::BINDING_SCRATCH)];
        let outputs = [&LEVELS[..], &points].concat();
        let (count, free) = Flow::of(bytes).contractible(&outputs);
        assert!(
            free.is_empty(),
            "{name}: {} of {count}: {free:?}",
            free.len()
        );
        assert!(count > 0, "{name}: {count}");
        total += count;
    }
    let points = MODULES.iter().find(|(name, _)| *name == "points.comp");
    let (_, bytes) = points.expect("it is a module");
    let (count, free) = Flow::of(bytes).contractible(&[Output::Binding(abi::BINDING_POINTS)]);
    assert!(
        free.is_empty() && count > 50,
        "points.comp: {count}, {free:?}"
    );
    println!("{} instructions", total + count);
}

#[test]
fn every_instruction_that_may_be_contracted_is_noticed() {
    const DECORATE: u32 = 71;
    const NO_CONTRACTION: u32 = 42;
    let (name, bytes) = watertight(".equal.tese")[0];
    let (count, _) = Flow::of(bytes).contractible(&EVALUATED);
    let words = bytes
        .chunks_exact(4)
        .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
    let mut words: Vec<u32> = words.collect();
    let (mut at, mut taken) = (5, 0);
    while at < words.len() {
        let length = (words[at] >> 16) as usize;
        if words[at] & 0xffff == DECORATE && words[at + 2] == NO_CONTRACTION {
            // RelaxedPrecision instead, which says nothing about contraction.
            words[at + 2] = 0;
            taken += 1;
        }
        at += length;
    }
    let (_, free) = Flow::of(bytemuck::cast_slice(&words)).contractible(&EVALUATED);
    assert!(
        taken > 100 && free.len() > count / 2 && free.len() <= taken,
        "{name}: {taken}, {}",
        free.len()
    );
}

/// Without it a pre-pass that is compared with EQUAL is luck (SPIR-V, Invariant; Vulkan spec, "Invariance").
#[test]
fn every_position_is_invariant() {
    const MEMBER_DECORATE: u32 = 72;
    const DECORATE: u32 = 71;
    const TYPE_POINTER: u32 = 32;
    const VARIABLE: u32 = 59;
    const OUTPUT: u32 = 3;
    const INVARIANT: u32 = 18;
    const POSITION: [u32; 2] = [11, 0];
    let mut stages = BTreeSet::new();
    let ours = MODULES
        .iter()
        .filter(|(name, _)| !name.starts_with("conformance."));
    for (name, bytes) in ours {
        let all = instructions(bytes);
        let decorated = |target: &[u32], decoration: &[u32]| {
            all.iter().any(|words| {
                matches!(words[0] & 0xffff, DECORATE | MEMBER_DECORATE)
                    && words[1..].starts_with(target)
                    && words[1 + target.len()..] == *decoration
            })
        };
        let outputs = all
            .iter()
            .filter(|words| words[0] & 0xffff == VARIABLE && words[3] == OUTPUT);
        for variable in outputs {
            let pointer = all
                .iter()
                .find(|words| words[0] & 0xffff == TYPE_POINTER && words[1] == variable[1]);
            let block = pointer.expect("a variable is a pointer")[3];
            // A variable by itself, or the first member of the block of built-ins.
            let (single, member) = ([variable[2]], [block, 0]);
            let writes = |target: &[u32]| decorated(target, &POSITION);
            let invariant = |target: &[u32]| decorated(target, &[INVARIANT]);
            if writes(&single) || writes(&member) {
                assert!(
                    invariant(&single) || invariant(&member),
                    "{name}: gl_Position is not invariant"
                );
                stages.insert(name.rsplit('.').next().expect("it has an ending"));
            }
        }
    }
    assert_eq!(stages, BTreeSet::from(["geom", "tese", "vert"]));
}

/// A module of ours as an engine compiles it that has our sets elsewhere.
#[cfg(feature = "shaderc")]
fn compiled_by_engine(file: &str, first_set: Option<&str>) -> Vec<u32> {
    use hullform::gpu::shaders::source;
    use shaderc::{CompileOptions, Compiler, EnvVersion, ResolvedInclude, ShaderKind, TargetEnv};
    let mut options = CompileOptions::new().expect("the compiler is there");
    options.set_target_env(TargetEnv::Vulkan, EnvVersion::Vulkan1_2 as u32);
    options.add_macro_definition("STAGE_VERTEX", Some("1"));
    if let Some(set) = first_set {
        options.add_macro_definition("HULLFORM_SET", Some(set));
    }
    options.set_include_callback(|include, _, _, _| {
        let content = source(include).ok_or_else(|| format!("there is no {include}"))?;
        Ok(ResolvedInclude {
            resolved_name: include.to_string(),
            content: content.to_string(),
        })
    });
    let compiler = Compiler::new().expect("the compiler is there");
    let text = source(file).expect("it ships");
    let compiled =
        compiler.compile_into_spirv(text, ShaderKind::Vertex, file, "main", Some(&options));
    compiled.expect("it compiles").as_binary().to_vec()
}

/// The numbers of the sets that a module has, a resource each.
#[cfg(feature = "shaderc")]
fn sets(words: &[u32]) -> Vec<u32> {
    const DECORATE: u32 = 71;
    const DESCRIPTOR_SET: u32 = 34;
    let all = instructions(bytemuck::cast_slice(words)).into_iter();
    let of_set = |words: Vec<u32>| match words[..] {
        [first, _, DESCRIPTOR_SET, set] if first & 0xffff == DECORATE => Some(set),
        _ => None,
    };
    all.filter_map(of_set).collect()
}

/// Shaders of an engine that keeps lower sets for itself: the macro moves each of ours, as pipelines move those of our own modules.
#[cfg(feature = "shaderc")]
#[test]
fn the_macro_moves_our_sets() {
    let plain = sets(&compiled_by_engine("patches.vert", None));
    let moved = sets(&compiled_by_engine("patches.vert", Some("2")));
    assert!(
        plain.len() > 2 && plain.iter().all(|&set| set < 3),
        "{plain:?}"
    );
    let right: Vec<u32> = plain.iter().map(|set| set + 2).collect();
    assert_eq!(moved, right);
}
