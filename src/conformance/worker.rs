//! The worker's side: runs cases that it is told by name, and answers each in a line.
//!
//! Both directions are lines of text. A request is `RUN NAME`, where RUN counts repetitions from 0. The answers are [`READY`] once, and for
//! each request `begin` and `end STATUS MEASURED`, all behind [`MARK`]: a driver may print whatever it likes.
//!
//! A panic is a fault of ours, and shall not look like one of the driver's: it is caught and told as what it is, and the process makes way for
//! another. So does one whose device is lost.

use std::io::{BufRead, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError, mpsc};

use crate::conformance::{Context, Finding, Opened, Picture, Registry, Status, pictures};

/// Stands before every line that is meant for the runner.
pub(super) const MARK: &str = "hullform-verify ";

/// The name of the request to open the device and say which it is.
pub(super) const DEVICE: &str = "device";

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

/// Runs the cases that `input` names until it ends, and answers on `output`. What a case found that did not pass goes to `keep`, with its name and the pictures that it drew
/// last. When `input` ends in the middle of a case, the process
/// exits: the runner has gone, and a case that hangs shall not stay behind.
pub fn work(
    context: &Context,
    registry: &Registry,
    input: impl BufRead + Send + 'static,
    mut output: impl Write,
    mut keep: impl FnMut(&str, &Finding, &[Picture]),
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
    let said = listen_to_panics();
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
        let run = run.parse().unwrap_or(0);
        // Nothing that a panic may have left half-done is used again.
        let found = catch_unwind(AssertUnwindSafe(|| {
            context.seed_fault(name, run);
            find_out(context, registry, name)
        }));
        let found = found.unwrap_or_else(|_| our_own(&said));
        let drawn = pictures::take();
        if !matches!(found.status, Status::Pass | Status::Skip) {
            keep(name, &found, &drawn);
        }
        let is_the_last = found.status.is_the_last();
        answer(Answer::End(found))?;
        if is_the_last {
            return Ok(());
        }
    }
    Ok(())
}

fn find_out(context: &Context, registry: &Registry, name: &str) -> Finding {
    if name == DEVICE {
        return match context.device() {
            Ok(device) => Finding::pass(Opened::of(device.info()).line()),
            Err(error) => match context.unsuitable() {
                Ok(Some(info)) => Finding::skip(Opened::of(&info).line()),
                _ => Finding::fail(error.to_string()),
            },
        };
    }
    registry.find(name).map_or_else(
        || Finding::fail("the worker knows no such case"),
        |case| case.run(context),
    )
}

/// Keeps what the last panic said, beside printing it as before.
fn listen_to_panics() -> Arc<Mutex<String>> {
    let said = Arc::<Mutex<String>>::default();
    let (kept, print) = (said.clone(), std::panic::take_hook());
    std::panic::set_hook(Box::new(move |panic| {
        *kept.lock().unwrap_or_else(PoisonError::into_inner) = panic.to_string();
        print(panic);
    }));
    said
}

/// The finding of a case that panicked.
fn our_own(said: &Mutex<String>) -> Finding {
    let said = said.lock().unwrap_or_else(PoisonError::into_inner);
    Finding {
        status: Status::Crash,
        measured: format!("hullform itself {said}; report this, it is no fault of the driver's"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_told_as_our_own() {
        let said = listen_to_panics();
        let caught = catch_unwind(|| panic!("no cuts at all"));
        assert!(caught.is_err());
        let found = our_own(&said);
        assert_eq!(found.status, Status::Crash);
        let words = &found.measured;
        assert!(
            words.contains("panicked at src/conformance/worker.rs:"),
            "{words}"
        );
        assert!(words.contains("no cuts at all"), "{words}");
    }

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
