//! `hullform-deqp`: the conformance suite with the command line, the output and the logs of dEQP (VK-GL-CTS), for harnesses that run that, such as deqp-runner.
//!
//! The cases are those of `hullform verify`, with `hullform.` before their names, and so is what runs them: each crash, hang or lost device ends one case.

mod caselist;
mod deqp;
mod journal;
mod log;
mod options;
mod selection;
mod session;
mod waivers;

use hullform::Result;
use hullform::conformance::{Context, Registry, work};
use hullform::error::visible;
use options::{Options, RunMode};
use std::io::{self, BufReader, Write};
use std::process::ExitCode;

fn main() -> ExitCode {
    let options = options::parse();
    let done = if options.worker {
        be_worker(&options).map(|()| true)
    } else {
        run(&options)
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            let _ = writeln!(
                io::stderr(),
                "hullform-deqp: {}",
                visible(&error.to_string())
            );
            ExitCode::from(error.exit_code())
        }
    }
}

/// Whether all went well. As with dEQP, a case that fails makes the exit code 1.
fn run(options: &Options) -> Result<bool> {
    let mut registry = Registry::suite();
    let info = selection::select(options, &mut registry.cases)?;
    match options.runmode {
        RunMode::Execute => session::run(options, &info, registry.cases),
        mode => caselist::write(options, mode, &registry.cases).map(|()| true),
    }
}

fn be_worker(options: &Options) -> Result<()> {
    let context = Context::new(options.settings(), Vec::new());
    let input = BufReader::new(io::stdin());
    let worked = work(
        &context,
        &Registry::suite(),
        input,
        io::stdout(),
        |_, _, _| (),
    );
    worked.map_err(|source| hullform::Error::File {
        path: "the runner's pipe".into(),
        source,
    })
}
