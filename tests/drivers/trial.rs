//! Programs on the failing driver.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use failing_driver::{FailingDriver, Fault, Report};

use crate::common::cli::{hullform, stderr, stdout};

/// What is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    Hullform,
    /// An example of ours.
    Example(&'static str),
    /// A test of these that is else ignored.
    Test(&'static str),
}

/// A program with arguments; `OUT` in them is the scratch folder that it writes into.
#[derive(Clone, Copy, Debug)]
pub struct Program {
    /// What messages of tests call it.
    pub name: &'static str,
    pub what: What,
    /// With spaces between; none has one in it.
    pub arguments: &'static str,
}

/// What `hullform` does with arguments.
pub const fn program(name: &'static str, arguments: &'static str) -> Program {
    Program {
        name,
        what: What::Hullform,
        arguments,
    }
}

/// An example of ours with arguments.
pub const fn example(name: &'static str, arguments: &'static str) -> Program {
    Program {
        name,
        what: What::Example(name),
        arguments,
    }
}

/// A test of these, by its name.
pub const fn test(name: &'static str) -> Program {
    Program {
        name,
        what: What::Test(name),
        arguments: "",
    }
}

/// A place to run programs in, with a failing driver of its own.
pub struct Bench {
    _folder: tempfile::TempDir,
    driver: FailingDriver,
    out: PathBuf,
    /// Whether what the programs do is validated, beneath the driver that fails.
    validates: bool,
    /// Where windows are shown, as the variable DISPLAY names it.
    display: Option<String>,
}

/// What became of a program.
pub struct Outcome {
    pub output: Output,
    pub reports: Vec<Report>,
    /// What it wrote, by name.
    pub files: Vec<(String, Vec<u8>)>,
}

impl Bench {
    pub fn new() -> Bench {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().join("out");
        std::fs::create_dir(&out).expect("a folder in it");
        Bench {
            driver: FailingDriver::install(folder.path()),
            _folder: folder,
            out,
            validates: false,
            display: None,
        }
    }

    /// The same, where what the programs do is validated if so.
    pub fn validating(validates: bool) -> Bench {
        Bench {
            validates,
            ..Bench::new()
        }
    }

    /// The same, where windows are shown on a display.
    #[cfg(feature = "view")]
    pub fn shown_on(self, display: &str) -> Bench {
        Bench {
            display: Some(display.into()),
            ..self
        }
    }

    /// Runs a program to its end, and takes away what it wrote.
    pub fn run(&self, program: Program, fault: &Fault) -> Outcome {
        let out = self.out.to_str().expect("a plain path");
        let arguments = program.arguments.split_whitespace();
        let arguments: Vec<String> = arguments.map(|word| word.replace("OUT", out)).collect();
        let mut command = match program.what {
            What::Hullform => hullform(&[]),
            What::Example(name) => Command::new(path_of(name)),
            What::Test(name) => {
                let mut itself = Command::new(this_test());
                itself.args(["--exact", name, "--ignored", "--nocapture"]);
                itself
            }
        };
        command.args(&arguments).current_dir(&self.out);
        if self.validates {
            validate(&mut command);
        }
        if let Some(display) = &self.display {
            command.env("DISPLAY", display);
            command.env_remove("WAYLAND_DISPLAY");
        }
        self.driver.apply(&mut command, fault);
        let output = command.output().expect("the program starts");
        Outcome {
            output,
            reports: self.driver.reports(),
            files: taken(&self.out),
        }
    }
}

impl Outcome {
    pub fn code(&self) -> Option<i32> {
        self.output.status.code()
    }

    /// Whether the fault came to pass.
    pub fn fired(&self) -> bool {
        self.reports.iter().any(|report| report.fired)
    }

    /// What was left undestroyed or destroyed too early, in all processes.
    pub fn faults(&self) -> Vec<String> {
        self.reports.iter().flat_map(Report::faults).collect()
    }

    /// Everything that it said.
    pub fn words(&self) -> String {
        format!("{}{}", stdout(&self.output), stderr(&self.output))
    }

    /// All in one, for a test that fails.
    pub fn describe(&self) -> String {
        let names: Vec<_> = self.files.iter().map(|(name, _)| name).collect();
        format!(
            "{}, files {names:?}, faults {:?}\n{}",
            self.output.status,
            self.faults(),
            self.words()
        )
    }
}

/// Every file in a folder, which is empty afterwards.
fn taken(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut files: Vec<_> = entries
        .map(|entry| {
            let path = entry.expect("an entry").path();
            let bytes = std::fs::read(&path).expect("a file can be read");
            std::fs::remove_file(&path).expect("and removed");
            let name = path.file_name().expect("it has a name").to_string_lossy();
            (name.into_owned(), bytes)
        })
        .collect();
    files.sort();
    files
}

fn this_test() -> PathBuf {
    std::env::current_exe().expect("a test knows where it is")
}

/// Core and synchronization validation, whose messages are among the program's words.
fn validate(command: &mut Command) {
    command
        .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
        .env(
            "VK_LAYER_ENABLES",
            "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT",
        );
}

/// Where cargo puts examples. `cargo test` builds them, `cargo test --test drivers` does not.
pub fn path_of(name: &str) -> PathBuf {
    let test = this_test();
    let profile = test.ancestors().nth(2).expect("target/PROFILE/deps/TEST");
    profile.join("examples").join(name)
}

/// Whether a program is there; says so if not.
pub fn is_there(program: Program) -> bool {
    let What::Example(name) = program.what else {
        return true;
    };
    let is_there = path_of(name).is_file();
    if !is_there {
        println!("skipped: the example {name} is not built; cargo build --example {name}");
    }
    is_there
}
