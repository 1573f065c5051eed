//! Rust's structs and the compiled shaders agree on where every member lies.
#![cfg(feature = "vulkan")]

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use common::spirv::{Block, Part, Shape, blocks};
use hullform::abi;
use hullform::gpu::shaders::MODULES;

/// Every module that shares `abi` with the library: all but those of the conformance suite.
fn modules() -> Vec<(String, Vec<u8>)> {
    let all = all_modules().into_iter();
    // The suite's, those of coloured triangles, and those of an example have buffers of their own.
    let foreign = ["conformance.", "coloured.", "engine."];
    all.filter(|(name, _)| !foreign.iter().any(|start| name.starts_with(start)))
        .collect()
}

/// Every module: as it ships, and as this build has it.
fn all_modules() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("glsl/spirv");
    let shipped = fs::read_dir(folder).expect("glsl/spirv is a folder");
    let shipped = shipped
        .map(|entry| entry.expect("glsl/spirv can be listed").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "spv"))
        .map(|path| (common::stem(&path), fs::read(&path).expect("a module")));
    let built = MODULES.iter();
    let built = built.map(|(name, bytes)| (format!("{name}, built"), bytes.to_vec()));
    shipped.chain(built).collect()
}

/// The struct whose elements, or itself, a block holds; the name it has in Rust.
fn shared_struct(module: &str, block: Block, shape: &Shape) -> Option<&'static str> {
    match block {
        Block::PushConstants if module.starts_with("points.comp") => Some("PointStep"),
        Block::PushConstants if module.starts_with("decide.comp") => Some("Decision"),
        Block::PushConstants if module.starts_with("limits.comp") => Some("Decision"),
        Block::PushConstants if module.starts_with("compact.comp") => Some("Compaction"),
        Block::PushConstants => Some("Frame"),
        Block::Buffer { binding } => match binding {
            abi::BINDING_TABLES => in_tables(shape),
            abi::BINDING_BASES => Some("Bases"),
            abi::BINDING_VIEWS => Some("View"),
            abi::BINDING_CAPTURE => Some("Captured"),
            // Or the points of a cache, which are no structs.
            abi::BINDING_POINTS => inner(shape).1.map(|_| "Point"),
            abi::BINDING_LIMITS => Some("Point"),
            abi::BINDING_POINT_ROWS => Some("PointRow"),
            abi::BINDING_POINT_TERMS => Some("PointTerm"),
            // Or what is drawn of patches that are cut into pieces, which has two numbers more.
            abi::BINDING_DRAWS => inner(shape).1.map(|own| match own.offsets.len() {
                3 => "PatchDraw",
                _ => "SubPatch",
            }),
            _ => None,
        },
    }
}

/// The struct of a table, of all that are in one buffer. No two are of one size and as many members but `Patch` and `Use`, which are five words each.
fn in_tables(shape: &Shape) -> Option<&'static str> {
    let (stride, inner) = inner(shape);
    let count = inner?.offsets.len();
    let names = [
        "Patch",
        "PatchSides",
        "Border",
        "Ends",
        "TableFace",
        "TablePlace",
        "Eigenbasis",
    ];
    let size = |name: &str| abi::LAYOUTS.iter().find(|(own, _, _)| *own == name);
    let found = names.into_iter().find(|name| {
        size(name).is_some_and(|&(_, size, members)| {
            stride == Some(size as u32) && members.len() == count
        })
    });
    Some(found.expect("a table's elements have the size of a struct"))
}

/// The bytes an element, of buffers whose elements are no structs.
fn plain_stride(binding: u32) -> Option<u32> {
    match binding {
        abi::BINDING_POSITIONS => Some(12),
        abi::BINDING_COUNTERS | abi::BINDING_INSTANCES | abi::BINDING_DRAWS => Some(4),
        abi::BINDING_SCRATCH => Some(16),
        _ => None,
    }
}

/// The struct in a block's last member: as it is, or the elements of an array with their stride.
fn inner(shape: &Shape) -> (Option<u32>, Option<&Shape>) {
    match shape.members.last() {
        Some(Some(Part::Struct(inner))) => (None, Some(inner)),
        Some(Some(Part::Array(stride, element))) => match element.as_deref() {
            Some(Part::Struct(inner)) => (Some(*stride), Some(inner)),
            _ => (Some(*stride), None),
        },
        _ => (None, None),
    }
}

fn assert_as_in_rust(what: &str, name: &str, shape: &Shape) {
    let (_, size, members) = abi::LAYOUTS
        .iter()
        .find(|(rust, _, _)| *rust == name)
        .expect("the struct is declared in abi");
    let (stride, inner) = inner(shape);
    let inner = inner.unwrap_or_else(|| panic!("{what}: no {name} in {shape:?}"));
    let offsets: Vec<u32> = members.iter().map(|&(_, at)| at as u32).collect();
    assert_eq!(inner.offsets, offsets, "{what}: {name} {members:?}");
    if let Some(stride) = stride {
        assert_eq!(stride as usize, *size, "{what}: the size of {name}");
    }
}

#[test]
fn compiled_structs_lie_as_in_rust() {
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for (module, bytes) in modules() {
        for (block, shape) in blocks(&bytes) {
            let what = format!("{module} {block:?}");
            if let Some(name) = shared_struct(&module, block, &shape) {
                assert_as_in_rust(&what, name, &shape);
                *seen.entry(name).or_default() += 1;
            }
        }
    }
    // Five words each: what holds of the one holds of the other.
    let words = |name: &str| {
        let (_, size, members) = abi::LAYOUTS.iter().find(|(own, ..)| *own == name)?;
        Some((size, members.iter().map(|&(_, at)| at).collect::<Vec<_>>()))
    };
    assert_eq!(words("Use"), words("Patch"));
    let declared = abi::LAYOUTS.iter().map(|&(name, _, _)| name);
    // Shaders fetch its three words at once.
    assert_eq!(words("Node"), Some((&12, vec![0, 4, 8])));
    // Shaders write its words by numbers.
    let batch = (0..abi::BATCH_WORDS)
        .map(|word| 4 * word as usize)
        .collect();
    assert_eq!(words("DrawnBatch"), Some((&28, batch)));
    let declared: BTreeSet<&str> = declared
        .filter(|name| !["Use", "Node", "DrawnBatch"].contains(name))
        .collect();
    let compared: BTreeSet<&str> = seen.keys().copied().collect();
    assert_eq!(compared, declared, "each shared struct is in some module");
}

#[test]
fn compiled_arrays_have_the_strides_of_the_buffers() {
    let mut seen = BTreeSet::new();
    for (module, bytes) in modules() {
        for (block, shape) in blocks(&bytes) {
            let Block::Buffer { binding } = block else {
                continue;
            };
            if let Some(right) = plain_stride(binding) {
                let (stride, structs) = inner(&shape);
                // Decisions, which are structs, and behind these lists.
                if binding == abi::BINDING_DRAWS && structs.is_some() {
                    continue;
                }
                assert_eq!(stride, Some(right), "{module} binding {binding}");
                seen.insert(binding);
            }
        }
    }
    assert_eq!(seen.len(), 5, "each of these buffers is in some module");
}

/// Where members stand that are a word each.
const WORDS: [u32; 8] = [0, 4, 8, 12, 16, 20, 24, 28];

const fn words(count: usize) -> &'static [u32] {
    WORDS.split_at(count).0
}

/// The buffers and push constants of the conformance suite: the beginning of the modules' names, the block, and where the members of a struct stand there.
/// Each struct is declared once in Rust too, beside the code that fills it, where an assertion holds it to the same size.
const SUITE: [(&str, Block, &[u32]); 14] = [
    (
        "conformance.coordinates.tesc",
        Block::Buffer { binding: 0 },
        // Two arrays, of four levels and of two.
        &[0, 16],
    ),
    (
        "conformance.coordinates.tese",
        Block::Buffer { binding: 1 },
        words(2),
    ),
    (
        "conformance.connectivity.geom",
        Block::Buffer { binding: 1 },
        words(2),
    ),
    ("conformance.scale.", Block::PushConstants, words(7)),
    ("conformance.scale.", Block::Buffer { binding: 0 }, words(7)),
    ("conformance.visibility-", Block::PushConstants, words(8)),
    ("conformance.state.", Block::PushConstants, words(3)),
    ("conformance.points.tese", Block::PushConstants, words(4)),
    ("conformance.compute.", Block::PushConstants, words(3)),
    (
        "conformance.loops.tesc",
        Block::Buffer { binding: 1 },
        words(3),
    ),
    (
        "conformance.loops-evaluation.tese",
        Block::Buffer { binding: 1 },
        words(3),
    ),
    // The third and the fourth are arrays.
    ("conformance.io", Block::PushConstants, &[0, 4, 8, 24]),
    // Two vectors.
    (
        "conformance.precision.",
        Block::Buffer { binding: 0 },
        &[0, 16],
    ),
    (
        "conformance.connectivity-lines.geom",
        Block::Buffer { binding: 1 },
        words(2),
    ),
];

#[test]
fn members_of_the_suite_s_structs_stand_where_rust_has_them() {
    for (prefix, block, right) in SUITE {
        let modules = all_modules().into_iter();
        let own = modules.filter(|(name, _)| name.starts_with(prefix));
        let mut seen = 0;
        for (name, bytes) in own {
            let all = blocks(&bytes);
            let shape = &all
                .iter()
                .find(|(own, _)| *own == block)
                .expect("it is there")
                .1;
            let members = inner(shape).1.unwrap_or(shape);
            assert_eq!(members.offsets, right, "{name} {block:?}");
            seen += 1;
        }
        assert!(seen > 1, "{prefix}: shipped and built");
    }
}

/// Behind their count, captured vertices begin at once: the host splits the buffer there.
#[test]
fn captured_vertices_begin_behind_their_count() {
    for (module, bytes) in modules() {
        let binding = abi::BINDING_CAPTURE;
        let all = blocks(&bytes);
        for (_, shape) in all
            .iter()
            .filter(|(own, _)| *own == Block::Buffer { binding })
        {
            assert_eq!(shape.offsets, [0, 4], "{module}");
        }
    }
}

/// Arrays within structs: what tells where the points of a slot end.
#[test]
fn ends_of_a_slot_are_words() {
    let bytes = modules();
    let modules = bytes.iter().filter(|(name, _)| name == "quadtree.tesc");
    for (_, bytes) in modules {
        let all = blocks(bytes);
        let ends = all
            .iter()
            .find(|(_, shape)| inner(shape).0 == Some(size_of::<abi::Ends>() as u32));
        let ends = inner(&ends.expect("it reads ends").1).1.expect("ends");
        let level = Some(Box::new(Part::Array(4, None)));
        assert_eq!(ends.members, [Some(Part::Array(20, level))]);
    }
}

/// The push constants leave most of the 128 bytes that every device has to an engine.
#[test]
fn push_constants_are_few() {
    assert!(size_of::<abi::Frame>() <= 32);
}
