//! The runner's side: worker processes, time limits, repetitions, and results that are never lost.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::ops::ControlFlow;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crate::conformance::worker::{Answer, DEVICE, request};
use crate::conformance::{Case, CaseResult, Expectations, Finding, Opened, Report, Status};

/// How long a worker may take until it is ready. Loading a driver takes less than a second; a busy machine gets more.
const START: Duration = Duration::from_secs(60);

/// How long the end of a worker may take whose input is closed.
const PATIENCE: Duration = Duration::from_secs(2);

/// How long a wait lasts before somebody looks whether it is still wanted.
const GLANCE: Duration = Duration::from_millis(50);

/// What is kept of the last that a worker said, in bytes: the backtrace of a panic, and what stands before it.
const LAST_WORDS: usize = 1 << 16;

/// How cases are run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Runs of each case; different ends make it a [`Status::Flake`].
    pub repeat: u32,
    /// Worker processes at a time.
    pub jobs: usize,
    /// A time limit for all cases instead of their own.
    pub limit: Option<Duration>,
}

/// What happens while cases run in turn.
#[derive(Debug)]
pub enum Turn<'a> {
    /// This one begins.
    Begin(&'a Case),
    /// It has ended so.
    End(&'a Case, &'a CaseResult),
}

/// Runs cases in worker processes.
pub struct Runner<'a> {
    /// Makes a worker: a process that calls [`work`](super::work) on its standard input and output.
    pub worker: &'a (dyn Fn() -> Command + Sync),
    /// What is known of the driver.
    pub expectations: &'a Expectations,
    /// How.
    pub options: RunOptions,
}

impl Runner<'_> {
    /// Lets a worker open the device and say which it is. A finding instead when the driver crashes or hangs meanwhile
    /// ([`Status::Crash`], [`Status::Timeout`]), and when there is no such device ([`Status::Fail`]). One that is there but lacks what every case needs says so
    /// ([`Opened::lacks`]), and no case can run. None once another thread sets `stop`.
    pub fn device(&self, stop: &AtomicBool) -> Option<Result<Opened, Finding>> {
        let found = self.once(DEVICE, 0, START, stop, &mut None)?;
        Some(match Opened::parse(&found.measured) {
            Some(opened) if matches!(found.status, Status::Pass | Status::Skip) => Ok(opened),
            _ => Err(found),
        })
    }

    /// Runs all cases; `done` hears of each result as it comes, and the report has them in the cases' order. Where no worker can be started, the
    /// case's result says so.
    ///
    /// Once another thread sets `stop`, no case begins, those that run are ended with their workers, and the report has what was done.
    pub fn run(
        &self,
        cases: &[Case],
        stop: &AtomicBool,
        mut done: impl FnMut(&CaseResult),
    ) -> Report {
        let next = AtomicUsize::new(0);
        let (sender, results) = mpsc::channel();
        thread::scope(|scope| {
            for _ in 0..self.options.jobs.max(1) {
                let (sender, next) = (sender.clone(), &next);
                scope.spawn(move || self.take_cases(cases, next, stop, &sender));
            }
            drop(sender);
            let mut report: Vec<Option<CaseResult>> = vec![None; cases.len()];
            for (place, result) in results {
                done(&result);
                report[place] = Some(result);
            }
            Report {
                results: report.into_iter().flatten().collect(),
            }
        })
    }

    /// Runs the cases one after the other, for who follows them: `tell` hears when each begins and how it ended. Where it breaks off, no other case
    /// begins. `stop` is as in [`run`](Self::run).
    pub fn run_in_turn(
        &self,
        cases: &[Case],
        stop: &AtomicBool,
        mut tell: impl FnMut(Turn<'_>) -> ControlFlow<()>,
    ) {
        let mut worker = None;
        for case in cases {
            if tell(Turn::Begin(case)).is_break() {
                return;
            }
            let Some(result) = self.repeated(case, stop, &mut worker) else {
                return;
            };
            if tell(Turn::End(case, &result)).is_break() {
                return;
            }
        }
    }

    /// One worker after another, until no case is left.
    fn take_cases(
        &self,
        cases: &[Case],
        next: &AtomicUsize,
        stop: &AtomicBool,
        results: &mpsc::Sender<(usize, CaseResult)>,
    ) {
        let mut worker = None;
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(place) else { return };
            let Some(result) = self.repeated(case, stop, &mut worker) else {
                return;
            };
            if results.send((place, result)).is_err() {
                return;
            }
        }
    }

    /// Runs a case as often as asked; None if it was stopped.
    fn repeated(
        &self,
        case: &Case,
        stop: &AtomicBool,
        worker: &mut Option<Worker>,
    ) -> Option<CaseResult> {
        let started = Instant::now();
        if let Some(row) = self.expectations.left_out(&case.name) {
            return Some(CaseResult {
                name: case.name.clone(),
                status: Status::Skip,
                found: Status::Skip,
                measured: "not run".into(),
                reason: Some(row.reason.clone()),
                seconds: 0.0,
            });
        }
        let limit = self.options.limit.unwrap_or(case.limit);
        let mut findings: Vec<Finding> = Vec::new();
        for run in 0..self.options.repeat.max(1) {
            let finding = self.once(&case.name, run, limit, stop, worker)?;
            let lost = finding.status.is_the_last();
            findings.push(finding);
            if lost {
                break;
            }
        }
        let Finding { status, measured } = together(findings);
        let (judged, reason) = self.expectations.judge(&case.name, status);
        Some(CaseResult {
            name: case.name.clone(),
            status: judged,
            found: status,
            measured,
            reason: reason.map(String::from),
            seconds: started.elapsed().as_secs_f64(),
        })
    }

    /// Runs a case once; None if it was stopped. A worker that is lost in it is replaced for the next.
    fn once(
        &self,
        name: &str,
        run: u32,
        limit: Duration,
        stop: &AtomicBool,
        worker: &mut Option<Worker>,
    ) -> Option<Finding> {
        let lost = |status, measured| Some(Finding { status, measured });
        for last_try in [false, true] {
            let started = worker
                .take()
                .map_or_else(|| Worker::start((self.worker)()), Ok);
            let mut at_work = match started {
                Ok(worker) => worker,
                Err(error) => {
                    let measured = format!("no worker could be started: {error}");
                    return lost(Status::Crash, measured);
                }
            };
            match at_work.run(name, run, limit, stop) {
                Outcome::Found(finding) => {
                    *worker = Some(at_work);
                    return Some(finding);
                }
                Outcome::Stopped => {
                    at_work.kill();
                    return None;
                }
                Outcome::Late(seconds) => {
                    at_work.kill();
                    return lost(Status::Timeout, format!("no answer after {seconds} s"));
                }
                // What an earlier case left behind shall not count against this one.
                Outcome::Lost { begun: false } if !last_try => drop(at_work.ended()),
                Outcome::Lost { .. } => return lost(Status::Crash, at_work.ended()),
            }
        }
        unreachable!("the last try returns")
    }
}

/// What repetitions come to.
fn together(findings: Vec<Finding>) -> Finding {
    let first = findings[0].clone();
    let other = findings
        .iter()
        .find(|finding| finding.status != first.status);
    match other {
        None => first,
        Some(other) => Finding {
            status: Status::Flake,
            measured: format!(
                "once {}: {}; once {}: {}",
                first.status, first.measured, other.status, other.measured
            ),
        },
    }
}

/// A worker process.
struct Worker {
    child: Child,
    requests: Option<ChildStdin>,
    answers: Receiver<Answer>,
    last_words: Arc<Mutex<Vec<u8>>>,
    listener: Option<JoinHandle<()>>,
    ready: bool,
}

/// How a request ended.
enum Outcome {
    /// With an answer.
    Found(Finding),
    /// Without one in time: after so many seconds.
    Late(f32),
    /// With the worker's end, before or after it began with the case.
    Lost { begun: bool },
    /// Without one, because the runner was told to stop.
    Stopped,
}

impl Worker {
    fn start(mut command: Command) -> io::Result<Worker> {
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let (sender, answers) = mpsc::channel();
        if let Some(out) = child.stdout.take() {
            thread::spawn(move || {
                let lines = BufReader::new(out).split(b'\n').map_while(|line| line.ok());
                let words = lines.map(|line| String::from_utf8_lossy(&line).into_owned());
                for answer in words.filter_map(|line| Answer::parse(&line)) {
                    if sender.send(answer).is_err() {
                        return;
                    }
                }
            });
        }
        let last_words = Arc::<Mutex<Vec<u8>>>::default();
        let listener = child.stderr.take().map(|errors| {
            let kept = last_words.clone();
            thread::spawn(move || keep_last(errors, &kept))
        });
        Ok(Worker {
            requests: child.stdin.take(),
            child,
            answers,
            last_words,
            listener,
            ready: false,
        })
    }

    /// Its next answer, at most `limit` from `since` on; or how the wait ended.
    fn answer(
        &self,
        since: Instant,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Answer, Outcome> {
        loop {
            if stop.load(Ordering::Relaxed) {
                return Err(Outcome::Stopped);
            }
            let left = limit.saturating_sub(since.elapsed());
            match self.answers.recv_timeout(left.min(GLANCE)) {
                Ok(answer) => return Ok(answer),
                Err(RecvTimeoutError::Timeout) if left > GLANCE => {}
                Err(RecvTimeoutError::Timeout) => return Err(Outcome::Late(limit.as_secs_f32())),
                Err(RecvTimeoutError::Disconnected) => return Err(Outcome::Lost { begun: false }),
            }
        }
    }

    fn run(&mut self, name: &str, run: u32, limit: Duration, stop: &AtomicBool) -> Outcome {
        if !self.ready {
            match self.answer(Instant::now(), START, stop) {
                Ok(_) => self.ready = true,
                Err(outcome) => return outcome,
            }
        }
        let asked = self
            .requests
            .as_mut()
            .is_some_and(|pipe| pipe.write_all(request(name, run).as_bytes()).is_ok());
        if !asked {
            return Outcome::Lost { begun: false };
        }
        let since = Instant::now();
        let mut begun = false;
        loop {
            match self.answer(since, limit, stop) {
                Ok(Answer::End(finding)) => return Outcome::Found(finding),
                Ok(_) => begun = true,
                Err(Outcome::Lost { .. }) => return Outcome::Lost { begun },
                Err(outcome) => return outcome,
            }
        }
    }

    /// How it ended, and the last that it said.
    fn ended(mut self) -> String {
        let how = self.reap();
        // What it said is complete when the pipe is closed, unless a child of its own still holds it.
        let listener = self.listener.take();
        within(PATIENCE, || {
            listener.as_ref().is_none_or(JoinHandle::is_finished)
        });
        let words = self
            .last_words
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        match last_message(&String::from_utf8_lossy(&words)) {
            Some(message) => format!("the process ended: {how}; the last it said: {message}"),
            None => format!("the process ended: {how}"),
        }
    }

    /// Waits for its end, with its input closed, and helps if it does not come. Says how it ended.
    fn reap(&mut self) -> String {
        drop(self.requests.take());
        within(PATIENCE, || !matches!(self.child.try_wait(), Ok(None)));
        match self.child.try_wait() {
            // Display says "exit status: 1" or "signal: 6 (SIGABRT)".
            Ok(Some(status)) => status.to_string(),
            _ => {
                self.kill();
                "it closed its output and hung".into()
            }
        }
    }

    fn kill(&mut self) {
        // Both fail only if it is gone already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.reap();
    }
}

/// The last message in what a process said: of a panic all but its backtrace and the hint how to get one, otherwise the last line.
fn last_message(words: &str) -> Option<String> {
    let mut lines = words.lines().skip_while(|line| !is_panic(line)).peekable();
    let panic = lines.next();
    let Some(panic) = panic else {
        let last = words.lines().rev().find(|line| !line.trim().is_empty());
        return last.map(String::from);
    };
    // The first panic is the cause of others; what it says goes on to the backtrace, or the hint in its place.
    let message = lines.take_while(|line| {
        !is_panic(line) && !line.starts_with("stack backtrace:") && !line.starts_with("note: ")
    });
    let all: Vec<&str> = std::iter::once(panic).chain(message).collect();
    Some(all.join(" ").trim().to_owned())
}

/// Whether this is how a panic begins: `thread 'main' panicked at src/x.rs:1:2:`.
fn is_panic(line: &str) -> bool {
    line.starts_with("thread ") && line.contains(" panicked at ")
}

/// Waits until `there` is, at most for `patience`.
fn within(patience: Duration, mut there: impl FnMut() -> bool) {
    let end = Instant::now() + patience;
    while !there() && Instant::now() < end {
        thread::sleep(Duration::from_millis(5));
    }
}

fn keep_last(mut from: impl Read, kept: &Mutex<Vec<u8>>) {
    let mut chunk = [0; 1024];
    while let Ok(count @ 1..) = from.read(&mut chunk) {
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.extend_from_slice(&chunk[..count]);
        let surplus = kept.len().saturating_sub(LAST_WORDS);
        kept.drain(..surplus);
    }
}

#[cfg(test)]
mod tests;
