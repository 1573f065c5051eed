//! A Vulkan layer that makes any driver fail on purpose, and watches what becomes of it.
//!
//! It stands between the Vulkan loader and the driver. It fails calls, loses draws, and tells at the end
//! - how often each call that can fail was made,
//! - which objects were never destroyed, or destroyed twice,
//! - which were destroyed while a submission might still have used them,
//! - which functions were called that it does not know. A new call cannot be forgotten: calling it ends the process.
//!
//! How a test uses it (this crate is a dev-dependency, so cargo has built the layer beside the test):
//!
//! ```ignore
//! let driver = FailingDriver::install(folder.path());
//! let mut command = Command::new(env!("CARGO_BIN_EXE_hullform"));
//! driver.apply(&mut command, &Fault::Lose(Lost::All));
//! let output = command.output();
//! for report in driver.reports() { assert!(report.fired && report.faults().is_empty()); }
//! ```
//!
//! The loader finds it as an implicit layer, by a folder in front of `XDG_DATA_DIRS`: those see also the calls before there is an instance.
//! Linux only.

mod calls;
mod chain;
mod fault;
mod report;
mod state;
mod unknown;

use std::path::{Path, PathBuf};
use std::process::Command;

pub use fault::{Fault, Lost};
pub use report::Report;

/// What switches the layer on.
const SWITCH: &str = "FAILING_DRIVER";
/// What fails, as [`Fault`] writes it.
const FAULT: &str = "FAILING_DRIVER_FAULT";
/// Where reports go, a file a process.
const REPORTS: &str = "FAILING_DRIVER_REPORTS";

/// The layer, ready to be put under programs.
pub struct FailingDriver {
    data: PathBuf,
    reports: PathBuf,
}

impl FailingDriver {
    /// Writes the layer's manifest into a folder that outlives this.
    ///
    /// # Panics
    /// When the layer is not beside the running test, or the folder cannot be written to.
    pub fn install(folder: &Path) -> FailingDriver {
        let data = folder.join("data");
        let reports = folder.join("reports");
        let manifests = data.join("vulkan/implicit_layer.d");
        for folder in [&manifests, &reports] {
            std::fs::create_dir_all(folder).expect("a scratch folder can be written to");
        }
        let manifest = manifests.join("failing_driver.json");
        std::fs::write(manifest, self::manifest(&library()))
            .expect("a scratch folder can be written to");
        FailingDriver { data, reports }
    }

    /// Lets a program run on the failing driver.
    pub fn apply(&self, command: &mut Command, fault: &Fault) {
        let usual = std::env::var_os("XDG_DATA_DIRS").filter(|folders| !folders.is_empty());
        let usual = usual.unwrap_or_else(|| "/usr/local/share:/usr/share".into());
        let mut folders = self.data.clone().into_os_string();
        folders.push(":");
        folders.push(usual);
        command
            .env("XDG_DATA_DIRS", folders)
            .env(SWITCH, "1")
            .env(FAULT, fault.to_string())
            .env(REPORTS, &self.reports)
            // Mesa's layer that sorts devices would make calls of its own.
            .env("NODEVICE_SELECT", "1");
    }

    /// What the processes since the last call have to report, in no order.
    ///
    /// # Panics
    /// When a report cannot be read.
    pub fn reports(&self) -> Vec<Report> {
        let files = std::fs::read_dir(&self.reports).expect("the folder of reports is there");
        let read = |file: std::io::Result<std::fs::DirEntry>| {
            let path = file.expect("an entry").path();
            let text = std::fs::read_to_string(&path).expect("a report is text");
            std::fs::remove_file(&path).expect("a report can be removed");
            text.parse().expect("a report is written by the layer")
        };
        files.map(read).collect()
    }
}

/// Where cargo puts the layer: into the folder of the tests, by a name without a hash, as it is a path's.
fn library() -> PathBuf {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    let test = std::env::current_exe().expect("a test knows where it is");
    let name = format!("{DLL_PREFIX}failing_driver{DLL_SUFFIX}");
    let path = test.parent().expect("in a folder").join(name);
    assert!(path.is_file(), "{} was not built", path.display());
    path
}

fn manifest(library: &Path) -> String {
    let library = library.to_str().expect("a plain path").replace('\\', "/");
    let before: Vec<String> = chain::BEFORE_INSTANCE
        .iter()
        .map(|name| format!("\"{name}\": \"failing_driver_{name}\""))
        .collect();
    // The version is above all applications': an implicit layer of an older one is left out.
    format!(
        r#"{{
  "file_format_version": "1.1.2",
  "layer": {{
    "name": "VK_LAYER_HULLFORM_failing_driver",
    "type": "GLOBAL",
    "library_path": "{library}",
    "api_version": "1.4.0",
    "implementation_version": "1",
    "description": "Fails on purpose",
    "functions": {{ "vkNegotiateLoaderLayerInterfaceVersion": "vkNegotiateLoaderLayerInterfaceVersion" }},
    "pre_instance_functions": {{ {} }},
    "enable_environment": {{ "{SWITCH}": "1" }},
    "disable_environment": {{ "FAILING_DRIVER_DISABLE": "" }}
  }}
}}
"#,
        before.join(", ")
    )
}
