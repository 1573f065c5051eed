//! The worker's side: runs cases that it is told by name, and answers each in a line.
//!
//! Both directions are lines of text. A request is `RUN NAME`, where RUN counts repetitions from 0. The answers are [`READY`] once, and for
//! each request `begin` and `end STATUS MEASURED`, all behind [`MARK`]: a driver may print whatever it likes.

use std::io::{BufRead, Write};
use std::sync::mpsc;

use crate::conformance::{Context, Finding, Registry, Status};

/// Stands before every line that is meant for the runner.
pub(super) const MARK: &str = "hullform-verify ";

/// The worker is ready for requests.
pub(super) const READY: &str = "ready";

/// An answer of a worker.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Answer {
    Ready,
    Begin,
    End(Finding),
}

impl Answer {
    pub(super) fn line(&self) -> String {
        match self {
            Answer::Ready => format!("{MARK}{READY}"),
            Answer::Begin => format!("{MARK}begin"),
            Answer::End(Finding { status, measured }) => {
                let measured = measured.replace(['\n', '\r'], " ");
                format!("{MARK}end {status} {measured}")
            }
        }
    }

    /// The answer in a line; None for lines that are none.
    pub(super) fn parse(line: &str) -> Option<Answer> {
        match line.strip_prefix(MARK)? {
            READY => Some(Answer::Ready),
            "begin" => Some(Answer::Begin),
            rest => {
                let (status, measured) = rest.strip_prefix("end ")?.split_once(' ')?;
                let status: Status = status.parse().ok()?;
                let measured = measured.into();
                Some(Answer::End(Finding { status, measured }))
            }
        }
    }
}

/// The request for a run of a case.
pub(super) fn request(name: &str, run: u32) -> String {
    format!("{run} {name}\n")
}

/// Runs the cases that `input` names until it ends, and answers on `output`. When `input` ends in the middle of a case, the process
/// exits: the runner has gone, and a case that hangs shall not stay behind.
pub fn work(
    context: &Context,
    registry: &Registry,
    input: impl BufRead + Send + 'static,
    mut output: impl Write,
) -> std::io::Result<()> {
    let (sender, requests) = mpsc::channel();
    std::thread::spawn(move || {
        for line in input.lines().map_while(|line| line.ok()) {
            if sender.send(line).is_err() {
                return;
            }
        }
        drop(sender);
        // Time to finish for one who is between cases; whoever hangs in one gets no more.
        std::thread::sleep(std::time::Duration::from_secs(5));
        std::process::exit(1);
    });
    let mut answer = |answer: Answer| {
        writeln!(output, "{}", answer.line())?;
        output.flush()
    };
    answer(Answer::Ready)?;
    for line in requests {
        let Some((run, name)) = line.split_once(' ') else {
            continue;
        };
        answer(Answer::Begin)?;
        context.seed_fault(name, run.parse().unwrap_or(0));
        let finding = registry.find(name).map_or_else(
            || Finding::fail("the worker knows no such case"),
            |case| case.run(context),
        );
        answer(Answer::End(finding))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_read_back() {
        for answer in [
            Answer::Ready,
            Answer::Begin,
            Answer::End(Finding::pass("3 of 3")),
            Answer::End(Finding::fail("")),
        ] {
            assert_eq!(Answer::parse(&answer.line()), Some(answer));
        }
        assert_eq!(Answer::parse("a driver's word"), None);
        let broken = Answer::End(Finding::warn("two\nlines")).line();
        assert_eq!(broken.lines().count(), 1);
    }
}
