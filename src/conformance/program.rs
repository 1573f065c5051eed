//! Where the program is that starts workers of its own kind.

use std::path::PathBuf;

use crate::error::{Error, Result};

/// Linux's name for the program that a process was started from, whatever has become of its file since: a process that has just been forked has the
/// runner's.
const OWN: &str = "/proc/self/exe";

/// This program, for a [`Runner`](super::Runner) whose workers are this program as well. Without `/proc`, as in some containers, where it was or what it
/// was called by. A program that is built anew while its cases run shall not take its results for theirs, nor be missing.
///
/// # Errors
/// [`Error::Refused`] where the system tells nothing of it.
pub fn own_program() -> Result<PathBuf> {
    if std::fs::metadata(OWN).is_ok() {
        return Ok(OWN.into());
    }
    let called = || std::env::args_os().next().map(PathBuf::from);
    let path = std::env::current_exe().ok().or_else(called);
    path.ok_or_else(|| {
        Error::Refused("this program cannot find itself, to start its workers".into())
    })
}
