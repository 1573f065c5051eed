//! The rooms of the house: imports go only upwards, everything up to `frame` is pure, and a method is a row and its files, which alone name it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use hullform::method::METHODS;

/// From the ground up. A room may use those before it.
const ROOMS: [&str; 13] = [
    "abi",
    "error",
    "mesh",
    "patch",
    "subdivision",
    "tessellation",
    "plan",
    "method",
    "frame",
    "gpu",
    "host",
    "conformance",
    "manual",
];

/// The last room that knows nothing of Vulkan and has no unsafe code.
const LAST_PURE: &str = "frame";

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn place(room: &str) -> usize {
    let known = ROOMS.iter().position(|&known| known == room);
    known.unwrap_or_else(|| panic!("src/{room} is not among the rooms"))
}

/// Every Rust file of the library with the room it belongs to; `lib.rs` and programs belong to none.
fn sources() -> Vec<(String, PathBuf)> {
    let mut found = Vec::new();
    collect(&project().join("src"), &mut found);
    let in_room = |path: PathBuf| {
        let inside = path.strip_prefix(project().join("src")).ok()?;
        let first = inside.components().next()?.as_os_str().to_str()?;
        let room = first.trim_end_matches(".rs");
        (!["lib", "bin"].contains(&room)).then(|| (room.to_owned(), path.clone()))
    };
    found.into_iter().filter_map(in_room).collect()
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("src can be listed") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The text without comments, so that only code counts.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).expect("a source is text");
    let lines = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// The rooms named after `crate::`, alone or in braces that may go over several lines.
fn rooms_used(code: &str) -> Vec<String> {
    let mut rooms = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let after = &code[at + "crate::".len()..];
        match after.strip_prefix('{') {
            None => rooms.push(word(after)),
            Some(list) => rooms.extend(first_words(list)),
        }
    }
    rooms.retain(|room| ROOMS.contains(&room.as_str()));
    rooms
}

fn word(text: &str) -> String {
    text.trim_start()
        .chars()
        .take_while(|c| c.is_alphanumeric() || *c == '_')
        .collect()
}

/// The first word of each entry of a list in braces, whose opening brace is already gone.
fn first_words(list: &str) -> Vec<String> {
    let (mut depth, mut words, mut start) = (0, Vec::new(), 0);
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                words.push(word(&list[start..at]));
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    words
}

#[test]
fn imports_are_found_in_braces_of_any_depth() {
    let code = "use crate::{\n    mesh::{Model, topology::Topology},\n    plan::walk,\n    error::Error,\n};\nuse crate::abi;";
    assert_eq!(rooms_used(code), ["mesh", "plan", "error", "abi"]);
}

#[test]
fn imports_go_only_upwards() {
    let sources = sources();
    assert!(sources.len() > 20, "the sources were found");
    for (room, path) in sources {
        for used in rooms_used(&code(&path)) {
            assert!(
                place(&used) <= place(&room),
                "{} uses {used}, which stands above {room}",
                path.display()
            );
        }
    }
}

/// What code imports or names by a path from the crate's root, or from a module around it: paths from the root, without braces.
fn paths(code: &str, module: &str) -> Vec<String> {
    let mut found = Vec::new();
    let keyword = |at: usize| {
        code[..at]
            .chars()
            .next_back()
            .is_none_or(|c| !c.is_alphanumeric() && c != '_' && c != ':')
    };
    let up = |steps: usize| {
        let mut parts: Vec<&str> = module.split("::").collect();
        parts.truncate(parts.len().saturating_sub(steps));
        parts.join("::")
    };
    for (first, base) in [
        ("crate::", String::new()),
        ("super::", up(1)),
        ("self::", up(0)),
    ] {
        for (at, _) in code.match_indices(first).filter(|&(at, _)| keyword(at)) {
            let (mut base, mut rest) = (base.clone(), &code[at + first.len()..]);
            while let Some(further) = rest.strip_prefix("super::") {
                base = base.rsplit_once("::").map_or("", |(up, _)| up).into();
                rest = further;
            }
            let prefix = if base.is_empty() { base } else { base + "::" };
            spread(rest, &prefix, &mut found);
        }
    }
    found
}

/// A path, or each of a list in braces, behind what stands before it.
fn spread(text: &str, prefix: &str, found: &mut Vec<String>) {
    let text = text.trim_start();
    let plain = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let end = text.find(|c| !plain(c)).unwrap_or(text.len());
    let path = format!("{prefix}{}", &text[..end]);
    let Some(list) = text[end..]
        .strip_prefix('{')
        .filter(|_| path.ends_with("::"))
    else {
        found.push(path.trim_end_matches(':').to_owned());
        return;
    };
    let (mut depth, mut start) = (0, 0);
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                if !list[start..at].trim().is_empty() {
                    spread(&list[start..at], &path, found);
                }
                start = at + 1;
                if c == '}' {
                    return;
                }
            }
            _ => {}
        }
    }
}

/// The files of the library by module, each with those that it imports. What a module hands on (`pub use`) belongs to the file that it is from, and
/// is no import; and a file may use the module that it is a part of.
fn imports() -> BTreeMap<String, BTreeSet<String>> {
    let source = project().join("src");
    let module = |path: &Path| {
        let inside = path.strip_prefix(&source).expect("it lies in there");
        let name = inside.with_extension("");
        let name = name.to_string_lossy().replace(['/', '\\'], "::");
        name.trim_end_matches("::mod").to_owned()
    };
    let without_tests = |path: &Path| {
        let text = code(path);
        let end = text.find("#[cfg(test)]\nmod ").unwrap_or(text.len());
        text[..end].to_owned()
    };
    let files: BTreeMap<String, String> = sources()
        .iter()
        .map(|(_, path)| (module(path), without_tests(path)))
        .collect();
    let mut handed_on = BTreeMap::new();
    let mut own = BTreeMap::new();
    for (module, text) in &files {
        let mut rest = String::new();
        for statement in text.split_inclusive(';') {
            let mut lines = statement.split_whitespace();
            let public = lines.next().is_some_and(|word| word.starts_with("pub"));
            let Some(at) = statement.find(" use ").filter(|_| public) else {
                rest.push_str(statement);
                continue;
            };
            let mut paths = Vec::new();
            let used = statement[at + 5..].trim_start();
            match used.strip_prefix("crate::") {
                Some(from_root) => spread(from_root, "", &mut paths),
                None => spread(used, &format!("{module}::"), &mut paths),
            }
            for path in paths {
                let name = path.rsplit("::").next().unwrap_or_default();
                handed_on.insert(format!("{module}::{name}"), path.clone());
            }
        }
        own.insert(module.clone(), paths(&rest, module));
    }
    let file_of = |path: &str| {
        let mut path = path.to_owned();
        // Handed on once or twice.
        for _ in 0..3 {
            let parts: Vec<&str> = path.split("::").collect();
            let known = (1..=parts.len()).find_map(|n| {
                let behind = parts[n..].iter().map(|part| format!("::{part}"));
                let from = handed_on.get(&parts[..n].join("::"))?;
                Some(format!("{from}{}", behind.collect::<String>()))
            });
            path = known.unwrap_or(path);
        }
        let ends = (0..=path.len()).rev();
        let mut starts = ends
            .filter(|&end| path.is_char_boundary(end))
            .map(|end| &path[..end]);
        starts
            .find(|start| files.contains_key(*start))
            .map(str::to_owned)
    };
    let of = |(module, paths): (&String, &Vec<String>)| {
        let used = paths.iter().filter_map(|path| file_of(path));
        let around = |other: &String| format!("{module}::").starts_with(&format!("{other}::"));
        (
            module.clone(),
            used.filter(|other| !around(other)).collect(),
        )
    };
    own.iter().map(of).collect()
}

#[test]
fn no_files_import_each_other_in_circles() {
    let imports = imports();
    assert!(imports.len() > 100, "the sources were found");
    assert!(
        imports["frame::draw_list"].contains("method"),
        "and their imports"
    );
    let is_in_circle = |module: &&String| {
        let (mut reached, mut next) = (BTreeSet::new(), vec![module.as_str()]);
        while let Some(module) = next.pop() {
            for other in &imports[module] {
                if reached.insert(other.as_str()) {
                    next.push(other.as_str());
                }
            }
        }
        reached.contains(module.as_str())
    };
    let circles: Vec<&String> = imports.keys().filter(is_in_circle).collect();
    assert!(circles.is_empty(), "{circles:?}");
}

#[test]
fn rooms_up_to_the_draw_lists_have_neither_unsafe_code_nor_vulkan() {
    for (room, path) in sources() {
        if place(&room) > place(LAST_PURE) {
            continue;
        }
        let code = code(&path);
        for word in ["unsafe", "ash", "gpu_allocator"] {
            let mut words = code.split(|c: char| !c.is_alphanumeric() && c != '_');
            let path = path.display();
            assert!(!words.any(|w| w == word), "{path} has the word {word}");
        }
    }
}

/// The files of a folder with an ending, by their names without it.
fn stems(folder: &str, ending: &str) -> Vec<String> {
    let entries = std::fs::read_dir(project().join(folder)).expect("it can be listed");
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    let names = names.map(|name| name.to_string_lossy().into_owned());
    let mut stems: Vec<String> = names
        .filter_map(|name| Some(name.strip_suffix(ending)?.to_owned()))
        .collect();
    stems.sort();
    stems
}

/// Whether a shader, or a picture, is a method's: it has its name, or one that begins with it.
fn belongs(name: &str, method: &str) -> bool {
    name.strip_prefix(method)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with(['_', '-', '.']))
}

#[test]
fn every_method_has_its_files() {
    let pictures = stems("tests/pictures", ".png");
    for method in METHODS {
        for file in [
            format!("src/method/{}.rs", method.name),
            format!("glsl/method/{}.glsl", method.name),
        ] {
            assert!(project().join(&file).is_file(), "{file} is missing");
        }
        for domain in method.domains {
            let picture = format!("method-{}-{domain:?}", method.name).to_lowercase();
            assert!(
                pictures.contains(&picture),
                "tests/pictures/{picture}.png is missing"
            );
        }
    }
    let of_methods = pictures
        .iter()
        .filter_map(|name| name.strip_prefix("method-"));
    for name in of_methods {
        assert!(
            METHODS.iter().any(|method| belongs(name, method.name)),
            "tests/pictures/method-{name}.png is nobody's"
        );
    }
}

/// Each says in which file of its method its twin is.
#[test]
fn every_shader_of_a_method_has_its_twin() {
    let shaders = stems("glsl/method", ".glsl");
    assert!(shaders.len() >= METHODS.len());
    for shader in shaders {
        let mut methods = METHODS.iter();
        let owner = methods.find(|method| belongs(&shader, method.name));
        let owner = owner.unwrap_or_else(|| panic!("glsl/method/{shader}.glsl is nobody's"));
        let path = project().join(format!("glsl/method/{shader}.glsl"));
        let text = std::fs::read_to_string(path).expect("a shader is text");
        let (_, after) = text
            .split_once("Twin of `method/")
            .unwrap_or_else(|| panic!("{shader}.glsl does not name its twin"));
        let twin = after.split('`').next().expect("a split has a first part");
        let file = project().join("src/method").join(twin);
        assert!(file.is_file(), "src/method/{twin} is missing");
        let folder = format!("{}/", owner.name);
        assert!(
            twin == format!("{}.rs", owner.name) || twin.starts_with(&folder),
            "the twin of {shader}.glsl is another method's"
        );
        let code = code(&file);
        assert!(code.contains("SurfacePoint"), "{twin} evaluates nothing");
    }
}

/// Where else a method is named, and why.
const NAMED: [(&str, &str, &str); 56] = [
    (
        "src/bin/hullform/figures/list/together.rs",
        "quadtree",
        PAPERS,
    ),
    ("src/bin/hullform/figures/list/trees.rs", "quadtree", PAPERS),
    ("src/bin/hullform/figures/list/trees.rs", "fas", PAPERS),
    ("src/bin/hullform/figures/list/trees.rs", "refine", PAPERS),
    ("src/bin/hullform/figures/list/peers.rs", "quadtree", PAPERS),
    ("src/bin/hullform/figures/list/peers.rs", "gregory", PAPERS),
    ("src/bin/hullform/figures/list/peers.rs", "fas", PAPERS),
    ("src/bin/hullform/figures/list/peers.rs", "dfas", PAPERS),
    ("src/bin/hullform/figures/list/peers.rs", "refine", PAPERS),
    ("src/bin/hullform/figures/list/quadratic.rs", "qas", PAPERS),
    ("src/bin/hullform/figures/list/quadratic.rs", "pn", PAPERS),
    ("src/bin/hullform/figures/list/quadratic.rs", "flat", PAPERS),
    ("src/bin/hullform/figures/list/tables.rs", "qas", PAPERS),
    ("src/bin/hullform/figures/list/tables.rs", "bft", PAPERS),
    ("src/bin/hullform/figures/list/tables.rs", "pn", PAPERS),
    ("src/bin/hullform/figures/list/tables.rs", "phong", PAPERS),
    ("src/bin/hullform/plan.rs", "quadtree", PLANS),
    ("src/conformance/determinism.rs", "quadtree", RING),
    ("src/conformance/models.rs", "quadtree", SCHEME),
    ("src/conformance/edges/pictures.rs", "quadtree", RING),
    ("src/conformance/robustness.rs", "quadtree", RING),
    ("tests/common/surfaces.rs", "quadtree", PLANS),
    ("tests/plans.rs", "quadtree", PLANS),
    ("tests/database.rs", "quadtree", PLANS),
    ("tests/gpu/cache.rs", "quadtree", RING),
    ("tests/gpu/lifetimes.rs", "quadtree", RING),
    ("tests/gpu/ring.rs", "quadtree", RING),
    ("tests/gpu/scale.rs", "quadtree", RING),
    ("tests/gpu/work.rs", "quadtree", RING),
    ("tests/layout.rs", "quadtree", TABLES),
    ("tests/gpu/scale.rs", "flat", NO_RING),
    ("tests/cli_compare.rs", "quadtree", WORDS),
    ("tests/cli_compare.rs", "flat", WORDS),
    ("tests/cli_models.rs", "quadtree", WORDS),
    ("tests/cli_models.rs", "flat", WORDS),
    ("tests/cli_compare.rs", "bft", WORDS),
    ("tests/cli_outputs.rs", "quadtree", WORDS),
    ("tests/cli_outputs.rs", "bft", WORDS),
    ("tests/cli_outputs.rs", "qas", WORDS),
    ("tests/cli_outputs.rs", "flat", WORDS),
    ("tests/pictures.rs", "quadtree", WORDS),
    ("tests/pictures.rs", "flat", WORDS),
    ("tests/pictures.rs", "pn", WORDS),
    ("tests/cli_bench.rs", "quadtree", WORDS),
    ("tests/cli_bench.rs", "flat", WORDS),
    ("tests/cli_evaluation.rs", "qas", WORDS),
    ("tests/cli_evaluation.rs", "phong", WORDS),
    ("tests/cli_evaluation.rs", "flat", WORDS),
    ("tests/cli_evaluation.rs", "bft", WORDS),
    ("tests/corners.rs", "quadtree", PLANS),
    ("tests/interruption.rs", "flat", WORDS),
    ("tests/tangents.rs", "acc", TANGENTS),
    ("tests/view/steps.rs", "quadtree", WORDS),
    ("tests/view/steps.rs", "qas", WORDS),
    ("tests/view/steps.rs", "pn", WORDS),
    ("tests/view/steps.rs", "flat", WORDS),
];

const PAPERS: &str = "the papers' figures are about them";
const PLANS: &str = "it is about plans, which one method has";
const RING: &str = "it is about the scratch ring, which one method uses";
const NO_RING: &str = "it needs one that does not use the ring";
const SCHEME: &str = "its tests need one that refuses schemes";
const TABLES: &str = "it is about tables, which are a method's own";
const TANGENTS: &str = "its tangents are patches of their own";
const WORDS: &str = "it types what users type";

/// Whether code has a string that is a method's name, or the name of one of its shaders.
fn names(code: &str, method: &str) -> bool {
    let mut strings = code.match_indices('"').map(|(at, _)| &code[at + 1..]);
    strings.any(|text| {
        let end = text.find('"').unwrap_or(0);
        belongs(&text[..end], method)
    })
}

#[test]
fn nothing_but_its_own_files_names_a_method() {
    let mut files = Vec::new();
    for folder in ["src", "tests"] {
        collect(&project().join(folder), &mut files);
    }
    assert!(files.len() > 100, "the sources were found");
    let mut named = 0;
    for file in files {
        let path = file.strip_prefix(project()).expect("it lies in there");
        let path = path.to_string_lossy().replace('\\', "/");
        let code = code(&file);
        for method in METHODS {
            let own = path.strip_prefix("src/method/");
            let own = own.is_some_and(|rest| {
                rest == format!("{}.rs", method.name)
                    || rest.starts_with(&format!("{}/", method.name))
            });
            // This file has the list.
            if own || path == "tests/architecture.rs" || !names(&code, method.name) {
                continue;
            }
            let known = NAMED
                .iter()
                .any(|&(file, name, _)| file == path && name == method.name);
            assert!(known, "{path} names the method {}", method.name);
            named += 1;
        }
    }
    assert_eq!(named, NAMED.len(), "a row of the list is out of date");
}

#[test]
fn names_of_methods_and_their_shaders_are_found() {
    for code in ["prepare(\"qas\")", "[\"a\", \"qas_quads\"]", "\"qas.tese\""] {
        assert!(names(code, "qas"), "{code}");
    }
    for code in ["qas::METHOD", "\"quasar\"", "\"qasar\"", "\"a qas\""] {
        assert!(!names(code, "qas"), "{code}");
    }
}
