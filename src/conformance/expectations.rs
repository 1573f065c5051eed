//! What a driver is known to do wrong, as data: a list a driver and version.
//!
//! A list is text. A row is a pattern of case names, the status in which they end, and the reason; what follows `#` is a comment:
//!
//! ```text
//! scale.vertices.draw.* Fail more than 65,535 vertices in a batch: bugs/vertices_per_batch.md
//! ```
//!
//! The first row that matches a case counts. A case without a row is expected to pass. One whose row says `Skip` is not run at all, and one whose row says `Flake`
//! may end as it likes. Lists of deqp-runner's are read as well, see [`Lists`].

mod lists;

use ash::vk;
use glob::Pattern;
use regex::Regex;

use crate::conformance::{Status, deqp};
use crate::error::{Error, Place, Result};
use crate::gpu::{Driver, Version};

pub use lists::Lists;

/// Which cases a row is for.
#[derive(Clone, Debug)]
pub enum Cases {
    /// Those whose names match a pattern in which `*` stands for any part.
    Matching(Pattern),
    /// Those in whose names, with [`PACKAGE`](crate::conformance::deqp::PACKAGE) before them, an expression is found: deqp-runner's form.
    Containing(Regex),
    /// One.
    Named(String),
}

impl Cases {
    fn has(&self, case: &str) -> bool {
        match self {
            Cases::Matching(pattern) => pattern.matches(case),
            Cases::Containing(expression) => expression.is_match(&deqp::path(case)),
            Cases::Named(name) => name == case,
        }
    }
}

/// A row of a list.
#[derive(Clone, Debug)]
pub struct Expectation {
    /// The cases.
    pub cases: Cases,
    /// How they end.
    pub status: Status,
    /// Why.
    pub reason: String,
}

/// The list for a driver.
#[derive(Clone, Debug, Default)]
pub struct Expectations {
    /// Its name: that of a shipped list, or of the user's file; empty for none.
    pub name: String,
    /// Its rows.
    pub rows: Vec<Expectation>,
}

/// A list that comes with the crate.
struct Shipped {
    name: &'static str,
    driver: vk::DriverId,
    /// The first version that it is for.
    from: Version,
    text: &'static str,
}

/// In the order of drivers and versions.
const SHIPPED: &[Shipped] = &[
    Shipped {
        name: "lavapipe-22.3",
        driver: vk::DriverId::MESA_LLVMPIPE,
        from: Version(22, 3, 0),
        text: include_str!("expectations/lavapipe-22.3.txt"),
    },
    Shipped {
        name: "lavapipe-25.0",
        driver: vk::DriverId::MESA_LLVMPIPE,
        from: Version(25, 0, 0),
        text: include_str!("expectations/lavapipe-25.0.txt"),
    },
];

impl Expectations {
    /// The shipped list for a driver: the newest that is not newer than it, or the oldest. Empty for drivers that have none.
    pub fn of(driver: &Driver) -> Expectations {
        let lists: Vec<&Shipped> = SHIPPED
            .iter()
            .filter(|list| list.driver == driver.id)
            .collect();
        let fitting = lists
            .iter()
            .rev()
            .find(|list| list.from <= driver.version)
            .or(lists.first());
        fitting.map_or_else(Expectations::default, |list| {
            Expectations::parse(list.name, list.text).expect("tests read every shipped list")
        })
    }

    /// Reads a list; `name` is what messages call it.
    ///
    /// # Errors
    /// [`Error::Input`] names the line.
    pub fn parse(name: &str, text: &str) -> Result<Expectations> {
        let remedy = "write a pattern of case names, a status and the reason";
        Ok(Expectations {
            name: name.into(),
            rows: rows(name, text, remedy, row)?,
        })
    }

    /// The row for a case.
    pub fn row(&self, case: &str) -> Option<&Expectation> {
        self.rows.iter().find(|row| row.cases.has(case))
    }

    /// The row for a case that says not to run it.
    pub fn left_out(&self, case: &str) -> Option<&Expectation> {
        self.row(case).filter(|row| row.status == Status::Skip)
    }

    /// What a case's own status comes to, and why.
    pub fn judge(&self, case: &str, found: Status) -> (Status, Option<&str>) {
        let Some(row) = self.row(case) else {
            return (found, None);
        };
        let reason = Some(row.reason.as_str());
        match found {
            // A row may say that a case passes, before another one that catches more.
            Status::Pass if row.status == Status::Pass => (Status::Pass, None),
            // What is skipped says nothing about the fault.
            Status::Skip => (Status::Skip, None),
            Status::Pass if row.status == Status::Flake => (Status::Pass, None),
            _ if row.status == Status::Flake => (Status::ExpectedFail, reason),
            Status::Pass => (Status::UnexpectedImprovement, reason),
            found if found == row.status => (Status::ExpectedFail, reason),
            found => (found, None),
        }
    }
}

/// Reads the rows of a text, a line each, by `read`; what follows `#` is a comment.
fn rows(
    name: &str,
    text: &str,
    remedy: &str,
    read: impl Fn(&str) -> std::result::Result<Expectation, String>,
) -> Result<Vec<Expectation>> {
    let lines = text
        .lines()
        .map(|line| line.split('#').next().unwrap_or_default().trim());
    let lines = (1..).zip(lines).filter(|(_, line)| !line.is_empty());
    let rows = lines.map(|(number, line)| {
        read(line)
            .map_err(|problem| Error::input(Place::Line(name.into(), number), problem, remedy))
    });
    rows.collect()
}

fn row(line: &str) -> std::result::Result<Expectation, String> {
    let (cases, rest) = line
        .split_once(char::is_whitespace)
        .ok_or("the status is missing")?;
    let (status, reason) = rest
        .trim_start()
        .split_once(char::is_whitespace)
        .ok_or("the reason is missing")?;
    let pattern =
        Pattern::new(cases).map_err(|error| format!("'{cases}' is no pattern: {error}"))?;
    Ok(Expectation {
        cases: Cases::Matching(pattern),
        status: status.parse().map_err(|error: Error| error.to_string())?,
        reason: reason.trim_start().into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lavapipe(version: Version) -> Driver {
        Driver {
            id: vk::DriverId::MESA_LLVMPIPE,
            name: "llvmpipe".into(),
            info: String::new(),
            version,
        }
    }

    #[test]
    fn every_shipped_list_can_be_read_and_names_reasons() {
        for list in SHIPPED {
            let read = Expectations::parse(list.name, list.text).expect(list.name);
            assert!(read.rows.iter().all(|row| row.reason.len() > 10));
        }
    }

    #[test]
    fn the_newest_list_that_is_not_newer_counts() {
        let name = |a, b, c| Expectations::of(&lavapipe(Version(a, b, c))).name;
        assert_eq!(name(22, 3, 6), "lavapipe-22.3");
        assert_eq!(name(24, 1, 0), "lavapipe-22.3");
        assert_eq!(name(25, 0, 7), "lavapipe-25.0");
        assert_eq!(name(26, 1, 0), "lavapipe-25.0");
        assert_eq!(name(20, 0, 0), "lavapipe-22.3");
        let other = Driver {
            id: vk::DriverId::MESA_RADV,
            ..lavapipe(Version(25, 0, 0))
        };
        assert!(Expectations::of(&other).rows.is_empty());
    }

    #[test]
    fn rows_decide() {
        let text = "# a comment\na.good.* Pass it is only the others\na.* Fail known # and a remark\n\nb.* Crash it does\nf.* Flake now and then";
        let list = Expectations::parse("list", text).expect("it is one");
        let judge = |case, found| list.judge(case, found).0;
        assert_eq!(judge("a.x.y", Status::Fail), Status::ExpectedFail);
        assert_eq!(judge("a.x.y", Status::Pass), Status::UnexpectedImprovement);
        assert_eq!(judge("a.x.y", Status::Crash), Status::Crash);
        assert_eq!(judge("a.x.y", Status::Skip), Status::Skip);
        assert_eq!(judge("a.good.y", Status::Pass), Status::Pass);
        assert_eq!(judge("a.good.y", Status::Fail), Status::Fail);
        assert_eq!(judge("b.x.y", Status::Crash), Status::ExpectedFail);
        assert_eq!(judge("c.x.y", Status::Fail), Status::Fail);
        assert_eq!(judge("f.x.y", Status::Fail), Status::ExpectedFail);
        assert_eq!(judge("f.x.y", Status::Pass), Status::Pass);
        assert_eq!(list.judge("a.x.y", Status::Fail).1, Some("known"));
    }

    #[test]
    fn what_is_wrong_names_its_line() {
        for (text, words) in [
            ("a.b.c", "list:1: the status is missing"),
            ("\na.b.c Fail", "list:2: the reason is missing"),
            ("a.b.c Fial because", "there is no status 'Fial'"),
            ("[ Fail because", "is no pattern"),
        ] {
            let error = Expectations::parse("list", text).expect_err(text);
            assert!(error.to_string().contains(words), "{error}");
            assert_eq!(error.exit_code(), 2);
        }
    }
}
