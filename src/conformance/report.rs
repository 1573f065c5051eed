//! Results of a run, and what they come to.

use std::fmt::Write as _;

use crate::conformance::{Case, Finding, Status};

/// How a case ended.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseResult {
    /// The case.
    pub name: String,
    /// How it ended, the list of expectations considered.
    pub status: Status,
    /// How it ended by itself.
    pub found: Status,
    /// What it measured, or what its process last said.
    pub measured: String,
    /// Why this result was expected, when the list says something else than that it passes.
    pub reason: Option<String>,
    /// Seconds, over all repetitions.
    pub seconds: f64,
}

impl CaseResult {
    /// The group of its name.
    pub fn group(&self) -> &str {
        self.name.split('.').next().unwrap_or_default()
    }

    /// The result in a line.
    pub fn line(&self) -> String {
        let CaseResult {
            name,
            status,
            measured,
            ..
        } = self;
        format!("{status} {name}: {measured}")
    }
}

/// Results in the order of the registry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// The results.
    pub results: Vec<CaseResult>,
}

impl Report {
    /// The report of cases none of which could be run, for a reason that all have in common.
    pub fn lost(cases: &[Case], reason: &Finding) -> Report {
        let result = |case: &Case| CaseResult {
            name: case.name.clone(),
            status: reason.status,
            found: reason.status,
            measured: reason.measured.clone(),
            reason: None,
            seconds: 0.0,
        };
        Report {
            results: cases.iter().map(result).collect(),
        }
    }

    /// How many ended so.
    pub fn count(&self, status: Status) -> usize {
        let same = |result: &&CaseResult| result.status == status;
        self.results.iter().filter(same).count()
    }

    /// How many have an unexpected result.
    pub fn unexpected(&self) -> usize {
        let bad = |result: &&CaseResult| !result.status.is_expected();
        self.results.iter().filter(bad).count()
    }

    /// The groups, in order.
    pub fn groups(&self) -> Vec<&str> {
        let mut groups: Vec<&str> = self.results.iter().map(CaseResult::group).collect();
        groups.dedup();
        groups
    }

    /// Counts of each status that occurs: `Pass 12, Fail 1`.
    pub fn counts(&self) -> String {
        let counted = Status::ALL.map(|status| (status, self.count(status)));
        let there = counted.iter().filter(|(_, count)| *count > 0);
        let words: Vec<String> = there
            .map(|(status, count)| format!("{status} {count}"))
            .collect();
        words.join(", ")
    }

    /// The results as deqp-runner writes them: `name,Status,seconds`, without a header.
    pub fn csv(&self) -> String {
        let mut text = String::new();
        for result in &self.results {
            let CaseResult { name, seconds, .. } = result;
            let status = match result.status {
                Status::DeviceLost => Status::Crash,
                status => status,
            };
            // Names have neither commas nor quotes.
            let _ = writeln!(text, "{name},{status},{seconds:.6}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result(name: &str, status: Status) -> CaseResult {
        CaseResult {
            name: name.into(),
            status,
            found: status,
            measured: String::new(),
            reason: None,
            seconds: 0.25,
        }
    }

    #[test]
    fn counts_and_groups() {
        let report = Report {
            results: vec![
                result("a.x.1", Status::Pass),
                result("a.x.2", Status::Fail),
                result("b.x.1", Status::UnexpectedImprovement),
                result("b.x.2", Status::ExpectedFail),
            ],
        };
        assert_eq!(report.unexpected(), 2);
        assert_eq!(report.groups(), ["a", "b"]);
        assert_eq!(
            report.counts(),
            "Pass 1, Fail 1, ExpectedFail 1, UnexpectedImprovement 1"
        );
        assert_eq!(report.csv().lines().next(), Some("a.x.1,Pass,0.250000"));
    }
}
