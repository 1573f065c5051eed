//! `hullform verify`: the conformance suite.

mod files;
mod kept;
mod known;

use crate::drawing;
use crate::options::{self, Global, Json};
use crate::{interrupt, model, print, print_json};
use clap::Args;
use files::Files;
use hullform::conformance::{
    Case, CaseResult, Context, Expectations, Fault, Finding, Opened, Registry, Report, RunOptions,
    Runner, Settings, Status, own_program, work,
};
use hullform::host::{Device, Instance};
use hullform::mesh::Model;
use hullform::{Error, Result};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::ffi::OsString;
use std::io::{self, BufReader};
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Options of `verify`.
#[derive(Args)]
pub struct Arguments {
    /// Meshes of your own: OBJ files, or builtin:NAME. Only the cases that concern meshes run, on these
    #[arg(value_name = "MODEL")]
    models: Vec<PathBuf>,
    #[command(flatten)]
    shape: options::Shape,
    /// Cases to run: a pattern such as 'scale.*' or '*.quads-*'; 'smoke.*' is a quick part of each group
    #[arg(long, value_name = "GLOB")]
    filter: Option<String>,
    /// List the cases instead of running them
    #[arg(long)]
    list: bool,
    /// Write results as JSON into a file; without FILE print them
    #[arg(long, id = "json", value_name = "FILE", num_args = 0..=1, default_missing_value = "-", value_parser = Json::anywhere)]
    json: Option<Json>,
    /// Write results as JUnit's XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Write results as lines of name,Status,seconds
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// What the driver is known to do wrong: rows of pattern, status and reason, or deqp-runner's NAME-fails.txt, with which NAME-flakes.txt and NAME-skips.txt
    /// are read [default: the list that is shipped for it, if any]
    #[arg(long, value_name = "FILE")]
    expectations: Option<PathBuf>,
    /// Write what went wrong as deqp-runner's lists: NAME-fails.txt, NAME-flakes.txt, NAME-skips.txt
    #[arg(long, value_name = "NAME")]
    export_expectations: Option<String>,
    /// Keep what cases that do not pass drew last and what they measured: FOLDER/NAME-K.png, the last picture first, and FOLDER/NAME.txt
    #[arg(long, value_name = "FOLDER")]
    keep: Option<PathBuf>,
    /// Run each case so often; different results are a flake
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Where random numbers begin
    #[arg(long, value_name = "S", default_value = "0")]
    seed: u64,
    /// Worker processes at a time [default: one a core, four at most]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    jobs: Option<u32>,
    /// Time limit of each case in seconds, instead of its own
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    time_limit: Option<Duration>,
    /// A deliberate fault, for tests of the suite: KIND:GLOB
    #[arg(long, hide = true)]
    fault: Option<Fault>,
    /// Be a worker: cases come on standard input
    #[arg(long, hide = true)]
    worker: bool,
}

fn seconds(text: &str) -> std::result::Result<Duration, &'static str> {
    let number: Option<f64> = text.parse().ok();
    match number {
        Some(number) if number > 0.0 && number <= 1e6 => Ok(Duration::from_secs_f64(number)),
        _ => Err("expected a number of seconds"),
    }
}

/// Lists the cases, runs them, or is one of the workers that do.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    let names = model_names(&arguments.models);
    let mut registry = match names.as_slice() {
        [] => Registry::suite(),
        names => Registry::of_models(names.iter().map(String::as_str)),
    };
    if arguments.worker {
        interrupt::ignore();
        return be_worker(arguments, global, &names, &registry);
    }
    if let Some(filter) = &arguments.filter {
        registry.filter(filter)?;
    }
    if arguments.list {
        return list(&registry.cases, global);
    }
    verify(arguments, global, &registry.cases)
}

/// Names for the meshes: those of their files in small letters, each different.
fn model_names(models: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for model in models {
        let file = || model.file_stem().unwrap_or_default().to_string_lossy();
        let stem = model::builtin_name(model).map_or_else(file, Into::into);
        let plain = |c: char| {
            if c.is_ascii_alphanumeric() {
                c.to_ascii_lowercase()
            } else {
                '_'
            }
        };
        let stem: String = stem.chars().map(plain).collect();
        let numbered = (2..).map(|number| format!("{stem}_{number}"));
        let mut candidates = std::iter::once(stem.clone()).chain(numbered);
        let name = candidates.find(|name| !names.contains(name));
        names.extend(name);
    }
    names
}

fn be_worker(
    arguments: &Arguments,
    global: &Global,
    names: &[String],
    registry: &Registry,
) -> Result<()> {
    let models = names.iter().zip(&arguments.models).map(|(name, path)| {
        let mesh = model::load(Some(path), &arguments.shape)?;
        Ok((name.clone(), Model::new(mesh)))
    });
    let settings = Settings {
        device: global.device.clone(),
        validation: global.validation,
        workarounds: !global.no_workarounds,
        ring_bytes: global.ring_bytes,
        slots: drawing::slots(global.slots),
        seed: arguments.seed,
        fault: arguments.fault.clone(),
    };
    let context = Context::new(settings, models.collect::<Result<_>>()?);
    let worked = work(
        &context,
        registry,
        BufReader::new(io::stdin()),
        io::stdout(),
        |name, finding, drawn| {
            let folder = arguments.keep.as_deref();
            let kept = folder.map_or(Ok(()), |folder| kept::keep(folder, name, finding, drawn));
            // The runner tells the last words of a worker that ends.
            if let Err(error) = kept {
                eprint_line(&format!("hullform: {error}"));
            }
        },
    );
    worked.map_err(|source| Error::File {
        path: "the runner's pipe".into(),
        source,
    })
}

fn list(cases: &[Case], global: &Global) -> Result<()> {
    if global.prints_json() {
        let cases = cases.iter().map(|case| {
            json!({
                "name": case.name,
                "rule": case.rule,
                "source": case.source,
                "limit_seconds": case.limit.as_secs_f64(),
            })
        });
        let cases: Vec<Value> = cases.collect();
        return print_json(&json!({ "cases": cases }));
    }
    let names: Vec<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    print(&names.join("\n"))
}

fn verify(arguments: &Arguments, global: &Global, cases: &[Case]) -> Result<()> {
    for model in &arguments.models {
        model::load(Some(model), &arguments.shape)?;
    }
    let files = Files::create(arguments)?;
    if let Some(folder) = &arguments.keep {
        kept::prepare(folder)?;
    }
    let worker = worker(arguments, global)?;
    let mut runner = Runner {
        worker: &|| command(&worker),
        expectations: &Expectations::default(),
        options: RunOptions {
            repeat: arguments.repeat,
            jobs: jobs(arguments),
            limit: arguments.time_limit,
        },
    };
    let started = Instant::now();
    let asking = interrupt::ask();
    let device = chosen_device(&runner, asking.asked(), global)?;
    let opened = device.as_ref().and_then(|found| found.as_ref().ok());
    let expectations = known::expectations(arguments.expectations.as_deref(), opened)?;
    runner.expectations = &expectations;
    let report = match &device {
        // Interrupted before anything began.
        None => Report::default(),
        Some(Ok(device)) if device.lacks().is_some() => {
            Report::lost(cases, &Finding::skip(device.lacks().unwrap_or_default()))
        }
        Some(Ok(_)) => {
            let bar = progress(cases.len());
            let report = runner.run(cases, asking.asked(), |result| show(&bar, result));
            bar.finish_and_clear();
            report
        }
        Some(Err(lost)) => lost_device(cases, lost),
    };
    let seconds = started.elapsed().as_secs_f64();
    let json = as_json(arguments, opened, &expectations, cases, &report, seconds);
    // Of a run that found nothing, interrupted early, nothing is written over an older one's results.
    if cases.is_empty() || !report.results.is_empty() {
        files.write(&report, &json)?;
    }
    if global.prints_json() {
        print_json(&json)?;
    } else {
        print(&summary(opened, &expectations, &report, seconds))?;
    }
    if report.results.len() < cases.len() {
        let (done, all) = (report.results.len(), cases.len());
        eprint_line(&format!(
            "hullform: interrupted after {done} of {all} cases"
        ));
    }
    asking.answer();
    match report.unexpected() {
        0 => Ok(()),
        1 => Err(Error::Refused("1 unexpected result".into())),
        count => Err(Error::Refused(format!("{count} unexpected results"))),
    }
}

/// The device that workers open, as one of them says; a finding where the driver crashes or hangs meanwhile, and None when interrupted.
fn chosen_device(
    runner: &Runner<'_>,
    stop: &AtomicBool,
    global: &Global,
) -> Result<Option<std::result::Result<Opened, Finding>>> {
    let found = runner.device(stop);
    if matches!(&found, Some(Err(finding)) if finding.status == Status::Fail) {
        // It ended in order there, and so does here, with an error that has an exit code.
        let instance = Instance::new(global.validation)?;
        Device::open(&instance, global.device.as_deref())?;
    }
    Ok(found)
}

/// No case can run, and the report says of each why.
fn lost_device(cases: &[Case], lost: &Finding) -> Report {
    let measured = format!("while the device was opened: {}", lost.measured);
    eprint_line(&format!("{} {measured}", lost.status));
    let reason = Finding {
        measured,
        ..lost.clone()
    };
    Report::lost(cases, &reason)
}

fn jobs(arguments: &Arguments) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
    arguments.jobs.map_or(cores.min(4), |jobs| jobs as usize)
}

/// The command line of a worker.
fn worker(arguments: &Arguments, global: &Global) -> Result<Vec<OsString>> {
    let mut words: Vec<String> = vec!["verify".into(), "--worker".into()];
    words.push(format!("--seed={}", arguments.seed));
    words.push(format!("--ring-bytes={}", global.ring_bytes));
    words.push(format!("--slots={}", global.slots.name()));
    words.extend(
        global
            .device
            .iter()
            .map(|device| format!("--device={device}")),
    );
    words.extend(global.validation.then(|| "--validation".into()));
    words.extend(global.no_workarounds.then(|| "--no-workarounds".into()));
    words.extend(
        arguments
            .fault
            .iter()
            .map(|fault| format!("--fault={fault}")),
    );
    words.extend(arguments.shape.words());
    let mut words: Vec<OsString> = words.into_iter().map(Into::into).collect();
    if let Some(folder) = &arguments.keep {
        words.extend(["--keep".into(), folder.clone().into_os_string()]);
    }
    words.push("--".into());
    words.insert(0, own_program()?.into());
    words.extend(
        arguments
            .models
            .iter()
            .map(|model| model.clone().into_os_string()),
    );
    Ok(words)
}

fn command(words: &[OsString]) -> Command {
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]);
    command
}

fn progress(cases: usize) -> ProgressBar {
    let bar = ProgressBar::new(cases as u64);
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {eta} {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

/// A line for each unexpected result, on stderr.
fn show(bar: &ProgressBar, result: &CaseResult) {
    bar.inc(1);
    bar.set_message(result.group().to_owned());
    if !result.status.is_expected() {
        // `println` would say nothing where stderr is no terminal.
        bar.suspend(|| eprint_line(&result.line()));
    }
}

fn eprint_line(line: &str) {
    use io::Write;
    let _ = writeln!(io::stderr(), "{}", crate::plain(line));
}

fn summary(
    device: Option<&Opened>,
    expectations: &Expectations,
    report: &Report,
    seconds: f64,
) -> String {
    let mut lines = vec![match device {
        Some(device) => format!("{}, {}", device.name, device.driver.info),
        None => "a device that could not be opened".into(),
    }];
    if !expectations.name.is_empty() {
        lines.push(format!("expectations: {}", expectations.name));
    }
    for group in report.groups() {
        let own = report.results.iter();
        let own = own.filter(|result| result.group() == group).cloned();
        let own = Report {
            results: own.collect(),
        };
        lines.push(format!("{group:14} {}", own.counts()));
    }
    let count = report.results.len();
    lines.push(format!(
        "{count} cases in {seconds:.0} s: {}",
        report.counts()
    ));
    lines.join("\n")
}

fn as_json(
    arguments: &Arguments,
    device: Option<&Opened>,
    expectations: &Expectations,
    cases: &[Case],
    report: &Report,
    seconds: f64,
) -> Value {
    let by_name: HashMap<&str, &Case> = cases.iter().map(|case| (&*case.name, case)).collect();
    let results = report.results.iter().map(|result| {
        let case = by_name[result.name.as_str()];
        json!({
            "name": result.name,
            "status": result.status.to_string(),
            "found": result.found.to_string(),
            "rule": case.rule,
            "source": case.source,
            "measured": result.measured,
            "reason": result.reason,
            "seconds": result.seconds,
        })
    });
    json!({
        "device": device.map(|device| &device.name),
        "driver": device.map(|Opened { driver, .. }| json!({
            "id": driver.id.as_raw(),
            "name": driver.name,
            "info": driver.info,
            "version": driver.version.to_string(),
        })),
        "expectations": (!expectations.name.is_empty()).then_some(&expectations.name),
        "seed": arguments.seed,
        "repeat": arguments.repeat,
        "seconds": seconds,
        "complete": report.results.len() == cases.len(),
        "unexpected": report.unexpected(),
        "results": results.collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_meshes_are_plain_and_different() {
        let models = [
            "a/Ship.obj",
            "b/ship.obj",
            "builtin:cubes-2x1x1",
            "my car.obj",
        ];
        let names = model_names(&models.map(PathBuf::from));
        assert_eq!(names, ["ship", "ship_2", "cubes_2x1x1", "my_car"]);
    }

    #[test]
    fn limits_are_seconds() {
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
        for wrong in ["0", "-1", "NaN", "inf", "x"] {
            assert!(seconds(wrong).is_err(), "{wrong}");
        }
    }
}
