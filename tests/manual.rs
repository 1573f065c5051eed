//! The manual tells what is there: its tables of methods, workarounds, groups and tests are made from the code, and its chapters are all listed.
//!
//! `HULLFORM_UPDATE=1 cargo test --test manual` writes the tables anew.
#![cfg(feature = "host")]

use std::fmt::Write;
use std::path::{Path, PathBuf};

use hullform::conformance::{GROUPS, Registry};
use hullform::gpu::workaround::WORKAROUNDS;
use hullform::method::{METHODS, Method, Reproduces};

fn project(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

fn text(file: &str) -> String {
    std::fs::read_to_string(project(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Holds the table behind `<!-- generated: NAME -->` to what it should be, or writes it.
fn hold(file: &str, name: &str, table: &str) {
    let old = text(file);
    let begin = format!("<!-- generated: {name} -->\n");
    let (before, rest) = old
        .split_once(&begin)
        .unwrap_or_else(|| panic!("{file} has no table '{name}'"));
    let (_, after) = rest
        .split_once("\n<!-- end -->")
        .unwrap_or_else(|| panic!("{file}: the table '{name}' has no end"));
    let new = format!("{before}{begin}\n{table}\n<!-- end -->{after}");
    if std::env::var_os("HULLFORM_UPDATE").is_some() {
        std::fs::write(project(file), new).expect("the manual can be written");
    } else {
        assert!(
            old == new,
            "{file}: the table '{name}' is old; HULLFORM_UPDATE=1 cargo test --test manual writes it anew. It should be\n{table}"
        );
    }
}

fn nearness(method: &Method) -> String {
    match method.contract.reproduces {
        Reproduces::Limit(error) => format!("{error:e} of the diagonal"),
        Reproduces::LimitOnLattice(error) => {
            format!("{error:e} of the diagonal on a lattice, linear between")
        }
        Reproduces::LimitBesideCaps(error) => {
            format!("{error:e} of the diagonal, end caps approximate")
        }
        Reproduces::LimitOnHexagon(error) => {
            format!(
                "{error:e} of the diagonal at corners and middles of edges, approximates between"
            )
        }
        Reproduces::Faces(_) => "another surface".into(),
        Reproduces::Itself => "a surface of its own".into(),
    }
}

fn methods() -> String {
    let mut table = String::from(
        "| method | what it draws | paper | schemes | distance from the limit | through the control vertices | same bits on both sides of an edge |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for method in METHODS {
        let schemes: Vec<String> = method.schemes.iter().map(|s| format!("`{s}`")).collect();
        let says = |yes: bool, else_: &'static str| if yes { "yes" } else { else_ };
        writeln!(
            table,
            "| `{}` | {} | {} | {} | {} | {} | {} |",
            method.name,
            method.summary,
            method.paper,
            schemes.join(", "),
            nearness(method),
            says(method.contract.interpolates, "no"),
            says(method.contract.watertight, "not promised"),
        )
        .expect("a string takes all");
    }
    table
}

#[test]
fn methods_are_those_of_the_table() {
    hold("README.md", "methods", &methods());
    hold("src/manual/drawing.md", "methods", &methods());
}

#[test]
fn workarounds_are_those_of_the_table() {
    let mut table = String::from(
        "| workaround | seen in | what goes wrong without it | case |\n| --- | --- | --- | --- |\n",
    );
    for row in WORKAROUNDS {
        let (name, seen, reason, case) = (row.name, row.seen, row.reason, row.case);
        writeln!(table, "| `{name}` | {seen} | {reason} | `{case}` |").expect("a string takes all");
    }
    hold("src/manual/devices.md", "workarounds", &table);
}

#[test]
fn groups_of_the_suite_and_its_cases_are_told() {
    let manual = text("src/manual/verify.md");
    for group in GROUPS {
        let row = format!("| `{}` | ", group.name);
        assert!(manual.contains(&row), "verify.md lacks {}", group.name);
    }
    let count = format!("All {} cases", Registry::suite().cases.len());
    assert!(manual.contains(&count), "verify.md should say: {count}");
}

/// What the first lines of a file of tests say, up to the first full stop or line of its own.
fn says(path: &Path) -> String {
    let text = std::fs::read_to_string(path).expect("a test is text");
    let lines = text.lines().map_while(|line| line.strip_prefix("//!"));
    let head: Vec<&str> = lines
        .map(str::trim)
        .take_while(|line| !line.is_empty())
        .collect();
    head.join(" ").trim_end_matches('.').to_owned()
}

#[test]
fn tests_are_those_of_the_folder() {
    let mut rows = Vec::new();
    for entry in std::fs::read_dir(project("tests")).expect("tests can be listed") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().and_then(|name| name.to_str());
        let name = name.expect("tests have names").to_owned();
        let head = if path.is_dir() {
            path.join("main.rs")
        } else {
            path.clone()
        };
        if head.extension().is_some_and(|extension| extension == "rs") && head.exists() {
            rows.push(format!("| `{name}` | {} |\n", says(&head)));
        }
    }
    rows.sort();
    let table = format!("| test | what it holds |\n| --- | --- |\n{}", rows.concat());
    hold("src/manual/tests.md", "tests", &table);
}

#[test]
fn every_chapter_is_listed_and_a_module() {
    let (readme, module) = (text("README.md"), text("src/manual/mod.rs"));
    for entry in std::fs::read_dir(project("src/manual")).expect("the manual can be listed") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "md") {
            let name = path
                .file_stem()
                .and_then(|name| name.to_str())
                .expect("a name");
            assert!(
                readme.contains(&format!("(src/manual/{name}.md)")),
                "README lacks {name}"
            );
            assert!(
                module.contains(&format!("]({name}):")),
                "mod.rs does not list {name}"
            );
            assert!(
                module.contains(&format!("\n    {name}\n")),
                "{name} is no module"
            );
        }
    }
}
