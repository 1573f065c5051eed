//! Which cases are asked for: by patterns, by lists of names, by tries.

use crate::options::Options;
use glob::Pattern;
use hullform::conformance::{Case, deqp};
use hullform::error::{Place, visible};
use hullform::{Error, Result};
use std::collections::HashSet;
use std::io::{self, Read, Write};

/// What the device is can be asked for like a case, as deqp-runner does (`--renderer-check`, `--version-check`); it is in no list.
pub const RENDERER: &str = "info.renderer";
pub const VERSION: &str = "info.version";

/// Keeps the cases that are asked for, and returns what is asked of the device. Says of each name without a case that there is none.
pub fn select(options: &Options, cases: &mut Vec<Case>) -> Result<Vec<&'static str>> {
    let known: HashSet<String> = cases.iter().map(|case| deqp::path(&case.name)).collect();
    let mut info = Vec::new();
    if let Some(names) = listed(options)? {
        let names: HashSet<String> = names.into_iter().collect();
        for unknown in names.iter().filter(|name| !known.contains(*name)) {
            say(&format!("there is no case '{unknown}'"));
        }
        cases.retain(|case| names.contains(&deqp::path(&case.name)));
    } else if !options.case.is_empty() {
        let wanted: Vec<Pattern> = options.case.iter().map(|name| pattern(name)).collect();
        for (name, pattern) in options.case.iter().zip(&wanted) {
            let own = [RENDERER, VERSION];
            let own = own.into_iter().filter(|case| {
                // A pattern for all shall not mean these.
                name.starts_with("hullform.info.") && pattern.matches(&deqp::path(case))
            });
            let before = info.len();
            info.extend(own);
            if info.len() == before && !known.iter().any(|case| pattern.matches(case)) {
                say(&format!("no case matches '{name}'"));
            }
        }
        cases.retain(|case| matches(&wanted, case));
    }
    let unwanted: Vec<Pattern> = options.exclude.iter().map(|name| pattern(name)).collect();
    cases.retain(|case| !matches(&unwanted, case));
    if let [first, step] = options.fraction[..] {
        let mut number = 0..;
        cases.retain(|_| number.next().is_some_and(|number| number % step == first));
    }
    Ok(info)
}

fn say(words: &str) {
    let _ = writeln!(io::stderr(), "hullform-deqp: {}", visible(words));
}

fn matches(patterns: &[Pattern], case: &Case) -> bool {
    let path = deqp::path(&case.name);
    patterns.iter().any(|pattern| pattern.matches(&path))
}

/// dEQP's patterns know `*` alone, for any part of a name with its dots.
pub fn pattern(text: &str) -> Pattern {
    let parts: Vec<String> = text.split('*').map(Pattern::escape).collect();
    let mut glob = parts.join("*");
    while glob.contains("**") {
        glob = glob.replace("**", "*");
    }
    Pattern::new(&glob).expect("all else is escaped")
}

/// The names that a list gives; None when cases are not asked for by one.
fn listed(options: &Options) -> Result<Option<Vec<String>>> {
    let failed = |path: &str, source| Error::File {
        path: path.into(),
        source,
    };
    let (place, text) = if let Some(file) = &options.caselist_file {
        let name = file.display().to_string();
        let text = std::fs::read_to_string(file).map_err(|source| failed(&name, source))?;
        (name, text)
    } else if options.stdin_caselist {
        let (name, mut text) = ("standard input", String::new());
        let read = io::stdin().read_to_string(&mut text);
        read.map_err(|source| failed(name, source))?;
        (name.into(), text)
    } else if let Some(trie) = &options.caselist {
        ("--deqp-caselist".into(), trie.clone())
    } else {
        return Ok(None);
    };
    let names = if text.starts_with('{') {
        trie(&text).map_err(|problem| {
            let remedy = "write groups and cases such as {hullform{scale{primitive_id{a,b}}}}";
            Error::input(Place::File(place), problem, remedy)
        })?
    } else {
        lines(&text)
    };
    Ok(Some(names))
}

/// Names a line each, as deqp-runner gives them or as `txt-caselist` writes them.
fn lines(text: &str) -> Vec<String> {
    let lines = text.lines().map(str::trim);
    let lines = lines
        .filter(|line| !line.is_empty() && !line.starts_with('#') && !line.starts_with("GROUP: "));
    lines
        .map(|line| line.strip_prefix("TEST: ").unwrap_or(line).to_owned())
        .collect()
}

/// The leaves of `{group{case,case},group{..}}`.
fn trie(text: &str) -> std::result::Result<Vec<String>, String> {
    let mut groups: Vec<String> = Vec::new();
    let (mut names, mut name) = (Vec::new(), String::new());
    // Whether a name must follow, and whether one may: `{{` and `},}` have none.
    let mut wanted = true;
    let mut open = 0;
    for c in text.trim_end().chars() {
        match c {
            '{' if open == 0 && names.is_empty() => open = 1,
            '{' if !name.is_empty() && open > 0 => {
                groups.push(std::mem::take(&mut name));
                open += 1;
                wanted = true;
            }
            ',' | '}' if open > 0 => {
                if !name.is_empty() {
                    let path = groups.iter().chain([&name]);
                    names.push(path.map(String::as_str).collect::<Vec<_>>().join("."));
                    name.clear();
                } else if wanted {
                    return Err("a name is missing".into());
                }
                wanted = c == ',';
                if c == '}' {
                    groups.pop();
                    open -= 1;
                }
            }
            c if open > 0 && (c.is_ascii_alphanumeric() || "_-".contains(c)) => {
                if name.is_empty() && !wanted {
                    return Err("a comma is missing".into());
                }
                name.push(c);
                wanted = false;
            }
            c => return Err(format!("'{c}' cannot stand there")),
        }
    }
    match open {
        0 => Ok(names),
        _ => Err("a closing brace is missing".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_stand_for_any_part_and_nothing_else_is_special() {
        for (text, name, wanted) in [
            ("hullform.*", "hullform.a.b.c", true),
            ("*.c", "hullform.a.b.c", true),
            ("hullform.a", "hullform.a.b.c", false),
            ("hullform.[ab].*", "hullform.a.b", false),
            ("h**c", "hullform.a.b.c", true),
            ("?ullform.a", "hullform.a", false),
        ] {
            assert_eq!(pattern(text).matches(name), wanted, "{text}");
        }
    }

    #[test]
    fn tries_are_names() {
        let names = trie("{hullform{scale{a{x,y-1},b{z}},io{c{d}}}}\n");
        let right = ["scale.a.x", "scale.a.y-1", "scale.b.z", "io.c.d"];
        assert_eq!(names, Ok(right.map(deqp::path).into()));
        for wrong in [
            "{", "{a", "{a{b}", "{,}", "{a,}", "{a{}}", "{a b}", "{a}}", "{{a}}", "{a{b}c}", "{}",
            "{a}{b}",
        ] {
            assert!(trie(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn lines_may_be_those_of_a_list_that_was_written() {
        let text = "# all\r\nGROUP: hullform.a\nTEST: hullform.a.b\r\n\nhullform.a.c";
        assert_eq!(lines(text), ["hullform.a.b", "hullform.a.c"]);
    }
}
