//! A case: a rule, where it stands, and the code that finds out whether it holds.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use crate::conformance::Context;
use crate::error::{Error, Result};

/// How a case ended, in the words of deqp-runner, which counts a lost device among the crashes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Status {
    /// The rule holds.
    Pass,
    /// It does not.
    Fail,
    /// The device lacks what the case needs.
    Skip,
    /// The process ended in the middle of the case, or the case panicked, which is our own fault.
    Crash,
    /// The driver gave the device up in it.
    DeviceLost,
    /// Repetitions ended differently.
    Flake,
    /// Allowed, but not what one would wish.
    Warn,
    /// The case took longer than its limit.
    Timeout,
    /// It ended badly, as the list for this driver says.
    ExpectedFail,
    /// It passed although the list for this driver says otherwise: the list is out of date.
    UnexpectedImprovement,
}

impl Status {
    /// Every status.
    pub const ALL: [Status; 10] = [
        Status::Pass,
        Status::Fail,
        Status::Skip,
        Status::Crash,
        Status::DeviceLost,
        Status::Flake,
        Status::Warn,
        Status::Timeout,
        Status::ExpectedFail,
        Status::UnexpectedImprovement,
    ];

    /// Whether nothing is wrong: a driver may lack features, but not have faults that nobody knows.
    pub fn is_expected(self) -> bool {
        matches!(
            self,
            Status::Pass | Status::Skip | Status::Warn | Status::ExpectedFail
        )
    }

    /// Whether no other case can run in a process where one ended so.
    pub(super) fn is_the_last(self) -> bool {
        matches!(self, Status::Crash | Status::DeviceLost | Status::Timeout)
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The names are the words.
        write!(f, "{self:?}")
    }
}

impl FromStr for Status {
    type Err = Error;

    fn from_str(word: &str) -> Result<Status> {
        let found = Status::ALL.iter().find(|status| status.to_string() == word);
        found.copied().ok_or_else(|| Error::Option {
            option: "status",
            problem: format!("there is no status '{word}'"),
            remedy: format!(
                "write one of {}",
                Status::ALL.map(|status| status.to_string()).join(", ")
            ),
        })
    }
}

/// What a case found out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How it ended.
    pub status: Status,
    /// What was measured, and what is wrong if something is.
    pub measured: String,
}

impl Finding {
    /// The rule holds.
    pub fn pass(measured: impl Into<String>) -> Finding {
        Finding {
            status: Status::Pass,
            measured: measured.into(),
        }
    }

    /// The rule does not hold.
    pub fn fail(measured: impl Into<String>) -> Finding {
        Finding {
            status: Status::Fail,
            measured: measured.into(),
        }
    }

    /// The device lacks `what`.
    pub fn skip(what: impl Into<String>) -> Finding {
        Finding {
            status: Status::Skip,
            measured: what.into(),
        }
    }

    /// Allowed, but not what one would wish.
    pub fn warn(measured: impl Into<String>) -> Finding {
        Finding {
            status: Status::Warn,
            measured: measured.into(),
        }
    }

    /// Whether the rule holds.
    pub(super) fn is_pass(&self) -> bool {
        self.status == Status::Pass
    }

    /// The finding of a case that saw so many vertices, words or pixels of what it drew. Where all that was compared is missing, everything
    /// seems to agree; so who saw nothing found nothing out. No case is an exception: one that expects nothing to arrive also draws
    /// something that must.
    fn unless_blind(self, seen: u64) -> Finding {
        match self.status {
            Status::Pass | Status::Warn if seen == 0 => Finding::fail(format!(
                "nothing that was drawn arrived, neither vertex nor pixel; {}",
                self.measured
            )),
            _ => self,
        }
    }
}

/// Collects what does not hold, and tells the first of it.
#[derive(Debug, Default)]
pub struct Check {
    held: u64,
    broken: u64,
    first: Option<String>,
}

impl Check {
    /// Notes whether something holds; `what` says what is wrong if not.
    pub fn hold(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if holds {
            self.held += 1;
        } else {
            self.broken += 1;
            self.first.get_or_insert_with(what);
        }
    }

    /// Whether nothing was looked at yet.
    pub fn is_empty(&self) -> bool {
        self.held + self.broken == 0
    }

    /// The finding: a failure if something did not hold, or if nothing at all was looked at.
    pub fn finish(self, measured: impl fmt::Display) -> Finding {
        match self.first {
            None if self.held == 0 => Finding::fail(format!("nothing was compared; {measured}")),
            None => Finding::pass(format!("{measured}")),
            Some(first) => Finding::fail(format!(
                "{} of {} do not hold, first: {first}; {measured}",
                self.broken,
                self.broken + self.held
            )),
        }
    }
}

/// The code of a case.
pub type Run = Box<dyn Fn(&Context) -> Result<Finding> + Send + Sync>;

/// A case of the suite.
pub struct Case {
    /// `group.subgroup.case`, in lower case.
    pub name: String,
    /// What must hold.
    pub rule: String,
    /// Where that is written: a section of a specification or of a paper.
    pub source: &'static str,
    /// How long it may take on the slowest device that is worth waiting for.
    pub limit: Duration,
    run: Run,
}

/// What a case may take if it says nothing else. A software device on a busy machine needs a tenth of it.
pub const LIMIT: Duration = Duration::from_secs(60);

impl Case {
    /// A case with the usual time limit.
    pub fn new(
        name: impl Into<String>,
        rule: impl Into<String>,
        source: &'static str,
        run: impl Fn(&Context) -> Result<Finding> + Send + Sync + 'static,
    ) -> Case {
        Case {
            name: name.into(),
            rule: rule.into(),
            source,
            limit: LIMIT,
            run: Box::new(run),
        }
    }

    /// The same with another time limit.
    pub fn within(self, limit: Duration) -> Case {
        Case { limit, ..self }
    }

    /// Runs it. A Vulkan call that fails, or a message of the validation layer, is a failure of the case; so is it when nothing of what
    /// was drawn came back.
    pub fn run(&self, context: &Context) -> Finding {
        let before = context.validation_messages().len();
        context.take_seen();
        let found = (self.run)(context).unwrap_or_else(|error| Finding {
            status: match error {
                Error::DeviceLost { .. } => Status::DeviceLost,
                _ => Status::Fail,
            },
            measured: error.to_string(),
        });
        let found = found.unless_blind(context.take_seen());
        match context.validation_messages().get(before) {
            Some(message) if !found.status.is_the_last() => {
                Finding::fail(format!("validation: {message}; {}", found.measured))
            }
            _ => found,
        }
    }
}

impl fmt::Debug for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Case").field(&self.name).finish()
    }
}

/// A group of cases: a file of this folder.
pub struct Group {
    /// The first word of its cases' names.
    pub name: &'static str,
    /// What it is about, in a line.
    pub about: &'static str,
    /// Its cases.
    pub cases: fn() -> Vec<Case>,
    /// Its cases for a mesh of the user's, by the name that [`Context::models`](super::Context::models) gives it; None when meshes do not
    /// concern it.
    pub model_cases: Option<fn(&str) -> Vec<Case>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_read_back() {
        for status in Status::ALL {
            assert_eq!(status.to_string().parse::<Status>().ok(), Some(status));
        }
        assert!("pass".parse::<Status>().is_err());
    }

    #[test]
    fn a_check_of_nothing_fails() {
        assert_eq!(Check::default().finish("").status, Status::Fail);
    }

    #[test]
    fn who_sees_nothing_does_not_pass() {
        for found in [Finding::pass("56 of 56"), Finding::warn("slow")] {
            assert_eq!(found.clone().unless_blind(1), found);
            assert_eq!(found.unless_blind(0).status, Status::Fail);
        }
        let skipped = Finding::skip("no such feature");
        assert_eq!(skipped.clone().unless_blind(0), skipped);
    }

    #[test]
    fn a_check_tells_the_first_and_counts_all() {
        let mut check = Check::default();
        check.hold(true, String::new);
        check.hold(false, || "one".into());
        check.hold(false, || "two".into());
        let found = check.finish("3 looked at");
        assert_eq!(found.status, Status::Fail);
        assert_eq!(
            found.measured,
            "2 of 3 do not hold, first: one; 3 looked at"
        );
    }
}
