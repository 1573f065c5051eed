//! Where a user's programs keep what they remember (XDG Base Directory Specification 0.8).

use std::env;
use std::path::PathBuf;

/// Our folder for what can be made anew; None where there is no home.
pub fn caches() -> Option<PathBuf> {
    folder("XDG_CACHE_HOME", ".cache")
}

/// Our folder for what the user has chosen; None where there is no home.
#[cfg(feature = "view")]
pub fn settings() -> Option<PathBuf> {
    folder("XDG_CONFIG_HOME", ".config")
}

/// In the folder that a variable names, or the usual one in the home. A relative one does not count, as the specification says.
fn folder(variable: &str, usual: &str) -> Option<PathBuf> {
    let absolute = |name| {
        let path = env::var_os(name).map(PathBuf::from);
        path.filter(|path| path.is_absolute())
    };
    let base = absolute(variable).or_else(|| Some(absolute("HOME")?.join(usual)))?;
    Some(base.join("hullform"))
}
