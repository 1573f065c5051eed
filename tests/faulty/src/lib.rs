//! A Vulkan layer that makes any driver break one rule: what the conformance suite must find.
//!
//! It stands between the Vulkan loader and the driver, changes commands, pipelines or shaders on their way, and leaves all else as it is. [`Fault`] is the list of what
//! it can break.
//!
//! How a test uses it (this crate is a dev-dependency, so cargo has built the layer beside the test):
//!
//! ```ignore
//! let layer = WrongDriver::install(folder.path());
//! let mut command = Command::new(env!("CARGO_BIN_EXE_hullform"));
//! layer.apply(&mut command, Fault::CullsNothing);
//! ```
//!
//! Linux only.

mod chain;
mod commands;
mod fault;
mod modules;
mod pipelines;

use std::path::{Path, PathBuf};
use std::process::Command;

pub use fault::Fault;

/// The layer's name.
const NAME: &str = "VK_LAYER_HULLFORM_wrong_driver";

/// The layer, ready to be put under programs.
pub struct WrongDriver {
    manifests: PathBuf,
}

impl WrongDriver {
    /// Writes the layer's manifest into a folder that outlives this.
    ///
    /// # Panics
    /// When the layer is not beside the running test, or the folder cannot be written to.
    pub fn install(folder: &Path) -> WrongDriver {
        let manifest = folder.join("wrong_driver.json");
        let text = self::manifest(&library());
        std::fs::write(manifest, text).expect("a scratch folder can be written to");
        WrongDriver {
            manifests: folder.into(),
        }
    }

    /// Lets a program run on a driver with a fault, or, with none, through the layer all the same.
    pub fn apply(&self, command: &mut Command, fault: Option<Fault>) {
        let name = fault.map_or("", Fault::name);
        command
            .env("VK_LAYER_PATH", &self.manifests)
            .env("VK_INSTANCE_LAYERS", NAME)
            .env(fault::VARIABLE, name);
    }
}

/// Where cargo puts the layer: into the folder of the tests, by a name without a hash, as it is a path's.
fn library() -> PathBuf {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    let test = std::env::current_exe().expect("a test knows where it is");
    let name = format!("{DLL_PREFIX}wrong_driver{DLL_SUFFIX}");
    let path = test.parent().expect("in a folder").join(name);
    assert!(path.is_file(), "{} was not built", path.display());
    path
}

fn manifest(library: &Path) -> String {
    let library = library.to_str().expect("a plain path").replace('\\', "/");
    format!(
        r#"{{
  "file_format_version": "1.1.2",
  "layer": {{
    "name": "{NAME}",
    "type": "GLOBAL",
    "library_path": "{library}",
    "api_version": "1.4.0",
    "implementation_version": "1",
    "description": "Breaks a rule",
    "functions": {{ "vkNegotiateLoaderLayerInterfaceVersion": "vkNegotiateLoaderLayerInterfaceVersion" }}
  }}
}}
"#
    )
}
