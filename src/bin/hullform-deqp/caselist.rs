//! Lists of the cases, in the forms of dEQP's run modes (`tcuTestHierarchyUtil.cpp`).

use crate::deqp::CASE_TYPE;
use crate::options::{Options, RunMode};
use hullform::conformance::{Case, deqp};
use hullform::{Error, Result};
use quick_xml::escape::escape;
use std::fmt::Write as _;
use std::io::{self, Write as _};

/// Writes the list that a mode asks for.
pub fn write(options: &Options, mode: RunMode, cases: &[Case]) -> Result<()> {
    let (text, extension) = match mode {
        RunMode::XmlCaselist => (xml(cases), "xml"),
        _ => (plain(cases), "txt"),
    };
    if mode == RunMode::StdoutCaselist {
        return print(&text);
    }
    let path = options
        .caselist_export
        .replace("${packageName}", deqp::PACKAGE);
    let path = path.replace("${typeExtension}", extension);
    if !options.quiet {
        print(&format!(
            "Writing test cases from '{}' to file '{path}'..\n",
            deqp::PACKAGE
        ))?;
    }
    std::fs::write(&path, text).map_err(|source| Error::File {
        path: path.into(),
        source,
    })
}

/// That the reader has gone is no error.
fn print(text: &str) -> Result<()> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(source) if source.kind() != io::ErrorKind::BrokenPipe => Err(Error::Write {
            path: "standard output".into(),
            source,
        }),
        _ => Ok(()),
    }
}

/// The groups above a case that are not above the one before it, from the outermost on, and how many of those before are left.
fn opened<'a>(before: &str, name: &'a str) -> (usize, Vec<&'a str>) {
    let groups = |name: &'a str| -> Vec<&'a str> {
        let mut parts: Vec<&str> = name.split('.').collect();
        parts.pop();
        parts
    };
    let own = groups(name);
    let mut old: Vec<&str> = before.split('.').collect();
    old.pop();
    let same = own.iter().zip(&old).take_while(|(a, b)| a == b).count();
    (old.len() - same, own[same..].into())
}

fn plain(cases: &[Case]) -> String {
    let (mut text, mut before) = (String::new(), "");
    for Case { name, .. } in cases {
        let (_, new) = opened(before, name);
        let depth = name.split('.').count() - 1 - new.len();
        for level in 0..new.len() {
            let path: Vec<&str> = name.split('.').take(depth + level + 1).collect();
            let path = deqp::path(&path.join("."));
            writeln!(text, "GROUP: {path}").expect("a string takes all");
        }
        writeln!(text, "TEST: {}", deqp::path(name)).expect("a string takes all");
        before = name;
    }
    text
}

fn xml(cases: &[Case]) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<TestCaseList PackageName=\"{}\" Description=\"Tessellation as subdivision surfaces need it\">\n",
        deqp::PACKAGE
    );
    let mut before = "";
    for Case { name, rule, .. } in cases {
        let (left, new) = opened(before, name);
        text.push_str(&"</TestCase>\n".repeat(left));
        for group in new {
            writeln!(
                text,
                "<TestCase Name=\"{group}\" CaseType=\"TestGroup\" Description=\"\">"
            )
            .expect("a string takes all");
        }
        let own = name.rsplit('.').next().unwrap_or(name);
        let rule = escape(rule);
        writeln!(
            text,
            "<TestCase Name=\"{own}\" CaseType=\"{CASE_TYPE}\" Description=\"{rule}\"></TestCase>"
        )
        .expect("a string takes all");
        before = name;
    }
    text.push_str(&"</TestCase>\n".repeat(before.split('.').count() - 1));
    text.push_str("</TestCaseList>\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use hullform::conformance::Finding;

    fn cases() -> Vec<Case> {
        let case = |name: &str| Case::new(name, "a < b", "source", |_| Ok(Finding::pass("")));
        ["a.x.1", "a.x.2", "a.y.1", "b.y.1"].map(case).into()
    }

    #[test]
    fn every_group_is_told_before_its_first_case() {
        let lines = "GROUP: a\nGROUP: a.x\nTEST: a.x.1\nTEST: a.x.2\nGROUP: a.y\nTEST: a.y.1\nGROUP: b\nGROUP: b.y\nTEST: b.y.1\n";
        assert_eq!(plain(&cases()), lines.replace(": ", ": hullform."));
    }

    #[test]
    fn elements_are_nested_and_escaped() {
        let text = xml(&cases());
        let count = |what: &str| text.matches(what).count();
        assert_eq!(count("<TestCase "), 9);
        assert_eq!(count("</TestCase>"), 9);
        assert_eq!(count("a &lt; b"), 4);
        assert!(xml(&[]).ends_with("\n</TestCaseList>\n"));
    }
}
