//! deqp-runner's three lists of what is known of a driver, as Mesa's CI keeps them: `NAME-fails.txt` has rows `case,Status`, `NAME-flakes.txt` and
//! `NAME-skips.txt` a regular expression a line. Names have [`PACKAGE`](crate::conformance::deqp::PACKAGE) before them.

use std::fmt::Write;

use regex::Regex;

use crate::conformance::expectations::{Cases, Expectation, Expectations, rows};
use crate::conformance::{Report, Status, deqp};
use crate::error::Result;

/// The texts of the lists.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lists {
    /// What fails, and how.
    pub fails: String,
    /// What fails now and then.
    pub flakes: String,
    /// What shall not be run.
    pub skips: String,
}

/// The endings of their files' names, in the order of the fields.
const ENDINGS: [&str; 3] = ["-fails.txt", "-flakes.txt", "-skips.txt"];

impl Lists {
    /// The names of their files.
    pub fn files(name: &str) -> [String; 3] {
        ENDINGS.map(|ending| format!("{name}{ending}"))
    }

    /// The name of lists of which one is in a file of this name, if it is called so.
    pub fn name(file: &str) -> Option<&str> {
        ENDINGS.iter().find_map(|ending| file.strip_suffix(ending))
    }

    /// What a run found, so that another of the same driver expects it.
    pub fn of(report: &Report) -> Lists {
        let mut lists = Lists::default();
        for result in &report.results {
            let path = deqp::path(&result.name);
            let added = match result.found {
                Status::Fail | Status::Crash | Status::Timeout => {
                    writeln!(lists.fails, "{path},{}", result.found)
                }
                Status::DeviceLost => writeln!(lists.fails, "{path},{}", Status::Crash),
                Status::Flake => writeln!(lists.flakes, "^{}$", regex::escape(&path)),
                // A case that was left out; not one whose device lacks something.
                Status::Skip if result.reason.is_some() => {
                    writeln!(lists.skips, "^{}$", regex::escape(&path))
                }
                _ => Ok(()),
            };
            added.expect("a string takes all");
        }
        lists
    }

    /// Reads them; `name` is what messages call them by, with the endings of their files.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names file and line.
    pub fn read(&self, name: &str) -> Result<Expectations> {
        let [fails, flakes, skips] = Lists::files(name);
        let known = |status, reason: &'static str| {
            move |line: &str| {
                Ok(Expectation {
                    cases: Cases::Containing(expression(line)?),
                    status,
                    reason: reason.into(),
                })
            }
        };
        let one = "write a regular expression a line, for the names of cases";
        let skip = known(Status::Skip, "the list of skips has it");
        let flake = known(Status::Flake, "the list of flakes has it");
        let mut all = rows(&skips, &self.skips, one, skip)?;
        all.extend(rows(&flakes, &self.flakes, one, flake)?);
        let remedy = "write a case's name, a comma and a status";
        all.extend(rows(&fails, &self.fails, remedy, fail)?);
        Ok(Expectations {
            name: name.into(),
            rows: all,
        })
    }
}

/// `name,Status`; deqp-runner's own results have the seconds behind another comma.
fn fail(line: &str) -> std::result::Result<Expectation, String> {
    let mut columns = line.split(',');
    let (name, status) = (columns.next().unwrap_or_default(), columns.next());
    let status = status.ok_or("the status is missing")?.trim();
    Ok(Expectation {
        cases: Cases::Named(deqp::case(name.trim()).to_owned()),
        status: status
            .parse()
            .map_err(|error: crate::Error| error.to_string())?,
        reason: "the list of fails has it".into(),
    })
}

/// deqp-runner takes lines without anything special for names, dots included, and finds them anywhere.
fn expression(line: &str) -> std::result::Result<Regex, String> {
    let special = line.contains(|c| r"*+?()[]{}|^$\".contains(c));
    let text = if special {
        line.to_owned()
    } else {
        regex::escape(line)
    };
    Regex::new(&text).map_err(|error| {
        let words = error.to_string();
        let last = words.lines().last().unwrap_or_default().trim().to_owned();
        format!("'{line}' is no regular expression: {last}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::CaseResult;

    #[test]
    fn what_a_run_found_is_expected_of_the_next() {
        let found = |name: &str, found: Status, reason: Option<&str>| CaseResult {
            name: name.into(),
            status: found,
            found,
            measured: String::new(),
            reason: reason.map(String::from),
            seconds: 0.0,
        };
        let report = Report {
            results: vec![
                found("a.b.c1", Status::Fail, None),
                found("a.b.c10", Status::Pass, None),
                found("a.b.d", Status::DeviceLost, None),
                found("a.b.e1", Status::Flake, None),
                found("a.b.f", Status::Skip, Some("it hangs")),
                found("a.b.g", Status::Skip, None),
            ],
        };
        let lists = Lists::of(&report);
        assert_eq!(lists.fails, "hullform.a.b.c1,Fail\nhullform.a.b.d,Crash\n");
        let known = lists.read("list").expect("it is ours");
        let judge = |case, found| known.judge(case, found).0;
        assert_eq!(judge("a.b.c1", Status::Fail), Status::ExpectedFail);
        assert_eq!(judge("a.b.c1", Status::Pass), Status::UnexpectedImprovement);
        assert_eq!(judge("a.b.c10", Status::Fail), Status::Fail);
        assert_eq!(judge("a.b.e1", Status::Fail), Status::ExpectedFail);
        assert_eq!(judge("a.b.e10", Status::Fail), Status::Fail);
        assert!(known.left_out("a.b.f").is_some() && known.left_out("a.b.g").is_none());
    }

    #[test]
    fn lines_are_names_or_expressions() {
        let lists = Lists {
            fails: "# old\na.b.c,Crash,0.5\n".into(),
            flakes: "hullform.x.y\n^hullform\\.z\\.[12]$\n".into(),
            skips: String::new(),
        };
        let known = lists.read("list").expect("they are well formed");
        let status = |case: &str| known.row(case).map(|row| row.status);
        assert_eq!(status("a.b.c"), Some(Status::Crash));
        assert_eq!(status("x.yz"), Some(Status::Flake));
        assert_eq!(status("xly"), None);
        assert_eq!(status("z.2"), Some(Status::Flake));
        assert_eq!(status("z.12"), None);
    }

    #[test]
    fn what_is_wrong_names_its_file_and_line() {
        let wrong = |fails: &str, skips: &str| {
            let lists = Lists {
                fails: fails.into(),
                skips: skips.into(),
                ..Default::default()
            };
            let error = lists.read("a/b").expect_err("it is wrong");
            assert_eq!(error.exit_code(), 2);
            error.to_string()
        };
        assert!(wrong("\na.b.c\n", "").starts_with("a/b-fails.txt:2: the status is missing"));
        assert!(wrong("a,Fial", "").contains("there is no status 'Fial'"));
        let words = wrong("", "x\n(");
        assert!(words.starts_with("a/b-skips.txt:2: '(' is no"), "{words}");
    }
}
