//! dEQP's options (`tcuCommandLine.cpp`). Those that mean nothing here are taken all the same: harnesses give the same ones to every program.

use clap::{Arg, ArgGroup, CommandFactory, FromArgMatches, Parser, ValueEnum};
use hullform::conformance::{Fault, Settings};
use std::path::PathBuf;

/// The conformance suite of hullform, behind dEQP's command line. Cases are those of `hullform verify`, with `hullform.` before their names.
///
/// Exit codes: 0 all passed, or was not supported; 1 something failed; 2 bad usage; 3 no suitable Vulkan device.
#[derive(Parser)]
// Harnesses add options of their own behind those of their users: the last one counts.
#[command(
    name = "hullform-deqp",
    version,
    max_term_width = 100,
    args_override_self = true
)]
#[command(group = ArgGroup::new("cases").multiple(false))]
pub struct Options {
    /// Cases to run: names in which * stands for any part, with commas between
    #[arg(
        short = 'n',
        long = "deqp-case",
        value_name = "NAMES",
        value_delimiter = ',',
        group = "cases"
    )]
    pub case: Vec<String>,
    /// Cases not to run
    #[arg(
        short = 'e',
        long = "deqp-exclude-case",
        value_name = "NAMES",
        value_delimiter = ','
    )]
    pub exclude: Vec<String>,
    /// Run the cases in a file: a name a line, or a trie
    #[arg(
        short = 'f',
        long = "deqp-caselist-file",
        value_name = "FILE",
        group = "cases"
    )]
    pub caselist_file: Option<PathBuf>,
    /// Run the cases of a trie, such as {hullform{scale{primitive_id{a,b}}}}
    #[arg(long = "deqp-caselist", value_name = "TRIE", group = "cases")]
    pub caselist: Option<String>,
    /// Run the cases that come on standard input
    #[arg(long = "deqp-stdin-caselist", group = "cases")]
    pub stdin_caselist: bool,
    /// Run every M-th case, from the N-th on
    #[arg(
        long = "deqp-fraction",
        value_name = "N,M",
        value_delimiter = ',',
        num_args = 1
    )]
    pub fraction: Vec<usize>,
    /// What to do
    #[arg(
        long = "deqp-runmode",
        value_name = "MODE",
        value_enum,
        default_value = "execute"
    )]
    pub runmode: RunMode,
    /// File for the lists of the two modes that write one
    #[arg(
        long = "deqp-caselist-export-file",
        value_name = "FILE",
        default_value = "${packageName}-cases.${typeExtension}"
    )]
    pub caselist_export: String,
    /// File for the log
    #[arg(
        long = "deqp-log-filename",
        value_name = "FILE",
        default_value = "TestResults.qpa"
    )]
    pub log_filename: PathBuf,
    /// Whether the log is on the disk after each case
    #[arg(
        long = "deqp-log-flush",
        value_name = "HOW",
        value_enum,
        default_value = "enable"
    )]
    pub log_flush: Switch,
    /// Vulkan device, from 1 on as `hullform devices` counts from 0 [default: the first discrete GPU that will do, else any]
    #[arg(long = "deqp-vk-device-id", value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub device_id: Option<u32>,
    /// Whether the validation layer watches; any message of it makes the case fail
    #[arg(
        long = "deqp-vk-validation",
        value_name = "HOW",
        value_enum,
        default_value = "disable"
    )]
    pub validation: Switch,
    /// Where random numbers begin
    #[arg(long = "deqp-base-seed", value_name = "S", default_value = "0")]
    pub seed: u64,
    /// Cases that are not run on some devices, as dEQP's XML
    #[arg(long = "deqp-waiver-file", value_name = "FILE")]
    pub waivers: Option<PathBuf>,
    /// Whether the first failure is the end
    #[arg(
        long = "deqp-terminate-on-fail",
        value_name = "HOW",
        value_enum,
        default_value = "disable"
    )]
    pub terminate_on_fail: Switch,
    /// Whether a lost device is the end; the next case has one of its own
    #[arg(
        long = "deqp-terminate-on-device-lost",
        value_name = "HOW",
        value_enum,
        default_value = "disable"
    )]
    pub terminate_on_device_lost: Switch,
    /// Print nothing
    #[arg(short = 'q', long)]
    pub quiet: bool,
    /// Results of runs that were killed: cases in FILE are told and not run, others are added to it
    #[arg(long = "hullform-resume", value_name = "FILE")]
    pub resume: Option<PathBuf>,
    /// A deliberate fault, for tests of the suite: KIND:GLOB
    #[arg(long = "hullform-fault", hide = true)]
    fault: Option<Fault>,
    /// Be a worker: cases come on standard input
    #[arg(long = "hullform-worker", hide = true)]
    pub worker: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    Enable,
    Disable,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RunMode {
    /// Run the cases
    Execute,
    /// Write their names as XML
    XmlCaselist,
    /// Write their names as text
    TxtCaselist,
    /// Print their names
    StdoutCaselist,
}

/// Options without a meaning here. There is neither window nor surface; the log has no images and no shaders; SPIR-V comes ready-made, so that no cache is needed;
/// and each case has a time limit and a process that may crash, whatever watches over dEQP.
const IGNORED: [&str; 44] = [
    "deqp-archive-dir",
    "deqp-cl-build-options",
    "deqp-cl-device-ids",
    "deqp-cl-platform-id",
    "deqp-command-buffer-min-size",
    "deqp-command-default-size",
    "deqp-command-pool-min-size",
    "deqp-compute-only",
    "deqp-crashhandler",
    "deqp-duplicate-case-name-check",
    "deqp-egl-config-id",
    "deqp-egl-config-name",
    "deqp-egl-display-type",
    "deqp-egl-pixmap-type",
    "deqp-egl-window-type",
    "deqp-gl-config-id",
    "deqp-gl-config-name",
    "deqp-gl-context-flags",
    "deqp-gl-context-type",
    "deqp-log-all-images",
    "deqp-log-compact",
    "deqp-log-decompiled-spirv",
    "deqp-log-empty-loginfo",
    "deqp-log-images",
    "deqp-log-shader-sources",
    "deqp-max-custom-vk-devices",
    "deqp-optimization-recipe",
    "deqp-optimize-spirv",
    "deqp-renderdoc",
    "deqp-runner-type",
    "deqp-screen-rotation",
    "deqp-shadercache",
    "deqp-shadercache-filename",
    "deqp-shadercache-ipc",
    "deqp-shadercache-truncate",
    "deqp-spirv-validation",
    "deqp-surface-height",
    "deqp-surface-type",
    "deqp-surface-width",
    "deqp-test-iteration-count",
    "deqp-test-oom",
    "deqp-visibility",
    "deqp-vk-device-group-id",
    "deqp-watchdog",
];

/// The options of this process's command line. Ends it where they make no sense.
pub fn parse() -> Options {
    let ignored = IGNORED.map(|name| {
        let arg = Arg::new(name).long(name).hide(true);
        arg.num_args(1).overrides_with(name)
    });
    let matches = Options::command().args(ignored).get_matches();
    let options = Options::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    if ![0, 2].contains(&options.fraction.len()) || options.fraction.get(1) == Some(&0) {
        let words = "--deqp-fraction: expected N,M: every M-th case, from the N-th on";
        Options::command()
            .error(clap::error::ErrorKind::ValueValidation, words)
            .exit();
    }
    options
}

impl Options {
    /// How the suite is run.
    pub fn settings(&self) -> Settings {
        Settings {
            device: self.device_id.map(|id| (id - 1).to_string()),
            validation: self.validation == Switch::Enable,
            seed: self.seed,
            fault: self.fault.clone(),
            ..Default::default()
        }
    }

    /// The options of a worker.
    pub fn of_worker(&self) -> Vec<String> {
        let mut words = vec![
            "--hullform-worker".into(),
            format!("--deqp-base-seed={}", self.seed),
        ];
        words.extend(self.device_id.map(|id| format!("--deqp-vk-device-id={id}")));
        words.extend(
            (self.validation == Switch::Enable).then(|| "--deqp-vk-validation=enable".into()),
        );
        words.extend(
            self.fault
                .iter()
                .map(|fault| format!("--hullform-fault={fault}")),
        );
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_option_is_there_twice() {
        Options::command()
            .args(IGNORED.map(|name| Arg::new(name).long(name)))
            .debug_assert();
    }
}
