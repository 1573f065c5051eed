//! The `hullform` program: subdivision surfaces from the command line.

mod adaptive;
mod approximation;
mod bench;
mod camera;
mod capture;
mod compare;
mod db;
mod deciding;
mod devices;
mod drawing;
mod evaluation;
mod eye;
mod figures;
mod framing;
mod gpu;
mod interrupt;
#[cfg(test)]
mod manual;
mod model;
mod options;
mod output;
mod pipelines;
mod places;
mod plan;
mod progress;
mod refused;
mod render;
mod tessellate;
mod verify;
#[cfg(feature = "view")]
mod view;
mod window;

use clap::{Parser, Subcommand};
use hullform::error::visible;
use hullform::{Error, Result};
use options::Global;
use std::io::Write;
use std::process::ExitCode;

/// Subdivision surfaces through Vulkan's tessellation shaders.
///
/// Exit codes: 0 done; 1 failed, or the validation layer complained; 2 bad input or usage; 3 no suitable Vulkan device, or no display.
#[derive(Parser)]
#[command(version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    global: Global,
}

#[derive(Subcommand)]
enum Command {
    /// Draw a model into a PNG file
    Render(render::Arguments),
    /// Write the tessellated surface as points or triangles
    Tessellate(tessellate::Arguments),
    /// Draw methods side by side, with maps of their errors
    Compare(compare::Arguments),
    /// Measure what frames cost, in time and in work
    Bench(bench::Arguments),
    /// Make the papers' tables and figures again, with a verdict on each
    Figures(figures::Arguments),
    /// Tell how the faces of a model are planned
    Plan(plan::Arguments),
    /// Look after the file that plans are kept in
    Db(db::Arguments),
    /// List the Vulkan devices and how they suit us
    Devices,
    /// Find out whether a driver keeps the rules that we rely on, and whether we keep our own
    Verify(verify::Arguments),
    /// Open a window on models: look, cut, compare and change them
    View(window::Arguments),
}

fn main() -> ExitCode {
    log_to_stderr();
    let arguments = Arguments::parse();
    interrupt::listen();
    let global = &arguments.global;
    db::remember(global);
    let result = match &arguments.command {
        Command::Render(arguments) => {
            model::named(arguments.model.as_deref(), render::run(arguments, global))
        }
        Command::Tessellate(arguments) => {
            model::named(Some(&arguments.model), tessellate::run(arguments, global))
        }
        Command::Compare(arguments) => {
            model::named(Some(&arguments.model), compare::run(arguments, global))
        }
        Command::Bench(arguments) => bench::run(arguments, global),
        Command::Figures(arguments) => figures::run(arguments, global),
        Command::Plan(arguments) => {
            model::named(Some(&arguments.model), plan::run(arguments, global))
        }
        Command::Db(arguments) => db::run(arguments, global),
        Command::Devices => devices::run(global),
        Command::Verify(arguments) => verify::run(arguments, global),
        Command::View(arguments) => window::run(arguments, global),
    };
    exit_code(result)
}

fn exit_code(result: Result<()>) -> ExitCode {
    let Err(error) = result else {
        return ExitCode::SUCCESS;
    };
    let error = refused::in_words_of_options(error);
    // Not eprintln, which panics where nobody listens.
    let _ = writeln!(std::io::stderr(), "hullform: {}", plain(&error.to_string()));
    ExitCode::from(error.exit_code())
}

/// Warnings and errors, or what RUST_LOG asks for. Spans go to Tracy, in a build that knows it.
fn log_to_stderr() {
    use tracing_subscriber::filter::{EnvFilter, LevelFilter};
    use tracing_subscriber::prelude::*;
    let filter = EnvFilter::builder().with_default_directive(LevelFilter::WARN.into());
    let filter = match std::env::var_os("RUST_LOG") {
        Some(_) => filter.from_env_lossy(),
        // It warns of desktops that lack what we do not use.
        None => filter.parse_lossy("warn,winit=error"),
    };
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(|| Plain(std::io::stderr()))
        .with_target(false)
        .without_time()
        // It would report a closed stderr on stderr, and panic.
        .log_internal_errors(false)
        .with_filter(filter);
    let all = tracing_subscriber::registry().with(lines);
    #[cfg(feature = "tracy")]
    let all = all.with(tracing_tracy::TracyLayer::default());
    all.init();
}

/// Lines without other control characters: a terminal shall not obey what a driver or a file says.
fn plain(text: &str) -> String {
    let lines: Vec<_> = text.split('\n').map(visible).collect();
    lines.join("\n")
}

/// A writer of plain text.
struct Plain<W>(W);

impl<W: Write> Write for Plain<W> {
    /// Log lines come whole.
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let text = plain(&String::from_utf8_lossy(bytes));
        self.0.write_all(text.as_bytes()).map(|()| bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}

/// Prints `text` and a line break on standard output. That the reader has gone (`hullform devices | head -1`) is not an error.
fn print(text: &str) -> Result<()> {
    print_as_it_is(&plain(text))
}

/// Prints JSON, which has escapes of its own.
fn print_json(value: &serde_json::Value) -> Result<()> {
    print_as_it_is(&format!("{value:#}"))
}

fn print_as_it_is(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Error::Write {
            path: "standard output".into(),
            source: error,
        }),
        _ => Ok(()),
    }
}
