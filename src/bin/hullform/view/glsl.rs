//! Where the shaders' text is that is compiled anew when it changes.

use std::path::{Path, PathBuf};

use hullform::{Error, Result};

/// What every such folder has.
const MARK: &str = "surface.tese";

/// The folder that was asked for, or that of the source tree that this program was built in, if it still lies there.
///
/// # Errors
/// When one was asked for and is none, or cannot be compiled.
pub fn folder(asked: Option<&Path>) -> Result<Option<PathBuf>> {
    let wrong = |problem: String, remedy: &str| Error::Option {
        option: "--glsl",
        problem,
        remedy: remedy.into(),
    };
    match asked {
        Some(_) if !cfg!(feature = "shaderc") => Err(wrong(
            "this hullform was built without the shader compiler".into(),
            "build it with `--features shaderc`",
        )),
        Some(folder) if !folder.join(MARK).is_file() => Err(wrong(
            format!("{} has no {MARK}", folder.display()),
            "name a folder that has all of hullform's shaders",
        )),
        Some(folder) => Ok(Some(real(folder))),
        None if !cfg!(feature = "shaderc") => Ok(None),
        None => Ok(beside()),
    }
}

/// The shaders of the source tree around this program.
fn beside() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    let trees = program.ancestors().skip(1);
    let mut trees = trees.filter(|tree| tree.join("Cargo.toml").is_file());
    let folder = trees.next()?.join("glsl");
    folder.join(MARK).is_file().then(|| real(&folder))
}

/// By its real name, by which changes are told.
fn real(folder: &Path) -> PathBuf {
    folder.canonicalize().unwrap_or_else(|_| folder.into())
}
