//! The rooms of the house: imports go only upwards, everything up to `method` is pure, and a method is a row and two files.

use std::path::{Path, PathBuf};

use hullform::method::METHODS;

/// From the ground up. A room may use those before it.
const ROOMS: [&str; 11] = [
    "abi",
    "error",
    "mesh",
    "patch",
    "subdivision",
    "tessellation",
    "plan",
    "method",
    "gpu",
    "host",
    "conformance",
];

/// The last room that knows nothing of Vulkan and has no unsafe code.
const LAST_PURE: &str = "method";

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

#[test]
fn rooms_up_to_the_methods_have_neither_unsafe_code_nor_vulkan() {
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

#[test]
fn every_method_has_its_files() {
    for method in METHODS {
        for file in [
            format!("src/method/{}.rs", method.name),
            format!("glsl/method/{}.glsl", method.name),
        ] {
            assert!(project().join(&file).is_file(), "{file} is missing");
        }
    }
}
