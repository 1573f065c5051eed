//! A session: the cases one after the other, told as dEQP tells them.

use crate::deqp::{RELEASE, RELEASE_ID, TARGET};
use crate::journal::Journal;
use crate::log::{Entry, Log};
use crate::options::{Options, Switch};
use crate::selection::RENDERER;
use crate::waivers;
use hullform::conformance::{
    Case, CaseResult, Expectations, Finding, Opened, Report, RunOptions, Runner, Status, Turn,
    deqp, own_program,
};
use hullform::error::visible;
use hullform::host::{Device, Instance};
use hullform::{Error, Result};
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::process::Command;
use std::sync::atomic::AtomicBool;

/// Results so far, as dEQP counts them.
#[derive(Default)]
struct Totals {
    all: usize,
    passed: usize,
    failed: usize,
    not_supported: usize,
    warnings: usize,
    waived: usize,
}

impl Totals {
    fn count(&mut self, status: &str) {
        self.all += 1;
        *match status {
            "Pass" => &mut self.passed,
            "NotSupported" => &mut self.not_supported,
            "QualityWarning" => &mut self.warnings,
            "Waiver" => &mut self.waived,
            _ => &mut self.failed,
        } += 1;
    }

    fn text(&self) -> String {
        let rows = [
            ("Passed:", self.passed),
            ("Failed:", self.failed),
            ("Not supported:", self.not_supported),
            ("Warnings:", self.warnings),
            ("Waived:", self.waived),
        ];
        let row = |(name, count): (&str, usize)| {
            let share = 100.0 * count as f64 / self.all.max(1) as f64;
            format!("\n  {name:14} {count}/{} ({share:.1}%)", self.all)
        };
        format!("\nTest run totals:{}\n", rows.map(row).concat())
    }
}

/// The two places where results go.
struct Told {
    log: Log,
    quiet: bool,
    totals: Totals,
    /// And what outlives this run.
    journal: Journal,
}

impl Told {
    fn print(&self, text: &str) -> Result<()> {
        if self.quiet {
            return Ok(());
        }
        let mut out = io::stdout();
        let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
        written.map_err(|source| Error::Write {
            path: "standard output".into(),
            source,
        })
    }

    fn begin(&mut self, path: &str) -> Result<()> {
        self.print(&format!("\nTest case '{path}'..\n"))?;
        self.log.begin(path)
    }

    /// Tells the cases that an earlier run has results of, and returns the others.
    fn resume(&mut self, cases: Vec<Case>) -> Result<Vec<Case>> {
        let mut left = Vec::new();
        for case in cases {
            let path = deqp::path(&case.name);
            let Some(ended) = self.journal.known(&path).cloned() else {
                left.push(case);
                continue;
            };
            let texts = texts(&case);
            self.begin(&path)?;
            self.end(&Entry {
                path: &path,
                texts: &texts.each_ref().map(String::as_str),
                duration: 0,
                status: &ended.status,
                details: &ended.details,
            })?;
        }
        Ok(left)
    }

    fn end(&mut self, entry: &Entry<'_>) -> Result<()> {
        self.totals.count(entry.status);
        let details = visible(entry.details);
        self.print(&format!("  {} ({details})\n", entry.status))?;
        self.log.end(entry)
    }
}

/// Runs the cases behind what is asked of the device, and says whether none failed.
pub fn run(options: &Options, info: &[&str], cases: Vec<Case>) -> Result<bool> {
    let program = own_program()?;
    let none = Expectations::default();
    let mut runner = Runner {
        worker: &|| {
            let mut command = Command::new(&program);
            command.args(options.of_worker());
            command
        },
        expectations: &none,
        options: RunOptions {
            repeat: 1,
            jobs: 1,
            limit: None,
        },
    };
    let mut told = Told {
        log: Log::create(&options.log_filename, options.log_flush == Switch::Enable)?,
        quiet: options.quiet,
        totals: Totals::default(),
        journal: Journal::default(),
    };
    told.print(&format!(
        "Writing test log into {}\ndEQP Core {RELEASE} (0x{RELEASE_ID:08x}) starting..\n  target implementation = '{TARGET}'\n",
        visible(&options.log_filename.to_string_lossy())
    ))?;
    let wanted = !info.is_empty() || !cases.is_empty();
    let device = if wanted {
        opened(&runner, options)?
    } else {
        None
    };
    let waived = match (&options.waivers, &device) {
        (Some(path), Some(device)) => waivers::read(path, device, &cases)?,
        _ => Expectations::default(),
    };
    runner.expectations = &waived;
    told.log.begin_session(&session_info(device.as_ref()))?;
    if let Some(device) = &device {
        tell_device(&mut told, info, device)?;
    }
    let lacks = device.as_ref().and_then(Opened::lacks);
    let complete = match lacks {
        Some(lacks) => lack(options, &cases, lacks, &mut told)?,
        None => {
            told.journal = Journal::open(options.resume.as_deref(), device.as_ref())?;
            let left = told.resume(cases)?;
            run_cases(options, &runner, &left, &mut told)?
        }
    };
    let ending = if complete { "DONE" } else { "ABORTED" };
    told.print(&format!("\n{ending}!\n{}", told.totals.text()))?;
    let failed = told.totals.failed;
    told.log.end_session()?;
    Ok(complete && failed == 0)
}

/// The device that workers open; None where the driver crashes or hangs meanwhile, which each case will tell.
fn opened(runner: &Runner<'_>, options: &Options) -> Result<Option<Opened>> {
    match runner.device(&AtomicBool::new(false)) {
        Some(Ok(device)) => Ok(Some(device)),
        Some(Err(found)) if found.status == Status::Fail => {
            // It ended in order there, and so does here, with an error that has an exit code.
            let settings = options.settings();
            let instance = Instance::new(settings.validation)?;
            Device::open(&instance, settings.device.as_deref())?;
            Err(Error::Refused(found.measured))
        }
        _ => Ok(None),
    }
}

fn session_info(device: Option<&Opened>) -> Vec<(&'static str, String)> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut info = Vec::new();
    if let Some(device) = device {
        info.push(("vendor", device.driver.name.clone()));
        info.push(("renderer", device.name.clone()));
        info.push(("driver", device.driver.info.clone()));
    }
    info.push(("commandLineParameters", arguments.join(" ")));
    info
}

fn tell_device(told: &mut Told, info: &[&str], device: &Opened) -> Result<()> {
    for &name in info {
        let path = deqp::path(name);
        let words = match name {
            RENDERER => &device.name,
            _ => &device.driver.info,
        };
        told.begin(&path)?;
        told.end(&Entry {
            path: &path,
            texts: &[words],
            duration: 0,
            status: "Pass",
            details: "Not validated",
        })?;
    }
    Ok(())
}

/// Tells of each case that the device cannot run it.
fn lack(options: &Options, cases: &[Case], lacks: String, told: &mut Told) -> Result<bool> {
    let report = Report::lost(cases, &Finding::skip(lacks));
    for (case, result) in cases.iter().zip(&report.results) {
        told.begin(&deqp::path(&case.name))?;
        end(options, case, result, told)?;
    }
    Ok(true)
}

/// Runs the cases; false if one was the end before the last.
fn run_cases(
    options: &Options,
    runner: &Runner<'_>,
    cases: &[Case],
    told: &mut Told,
) -> Result<bool> {
    let mut ended = 0;
    let mut failed = Ok(());
    runner.run_in_turn(cases, &AtomicBool::new(false), |turn| {
        let told = match turn {
            Turn::Begin(case) => told.begin(&deqp::path(&case.name)).map(|()| false),
            Turn::End(case, result) => {
                ended += 1;
                end(options, case, result, told)
            }
        };
        match told {
            Ok(false) => ControlFlow::Continue(()),
            Ok(true) => ControlFlow::Break(()),
            Err(error) => {
                failed = Err(error);
                ControlFlow::Break(())
            }
        }
    });
    failed.map(|()| ended == cases.len())
}

/// Words about a case.
fn texts(case: &Case) -> [String; 2] {
    [
        format!("Rule: {}", case.rule),
        format!("Source: {}", case.source),
    ]
}

/// Tells how a case ended, and returns whether that is the end of all.
fn end(options: &Options, case: &Case, result: &CaseResult, told: &mut Told) -> Result<bool> {
    let path = deqp::path(&case.name);
    let texts = texts(case);
    // The only reason that there can be here is a waiver's.
    let (status, details) = match &result.reason {
        Some(reason) => ("Waiver", reason),
        None => (deqp::status(result.found), &result.measured),
    };
    told.end(&Entry {
        path: &path,
        texts: &texts.each_ref().map(String::as_str),
        duration: (result.seconds * 1e6) as u64,
        status,
        details,
    })?;
    told.journal.note(&path, status, details)?;
    let failed = told.totals.failed > 0 && options.terminate_on_fail == Switch::Enable;
    let lost =
        result.found == Status::DeviceLost && options.terminate_on_device_lost == Switch::Enable;
    Ok(failed || lost)
}
