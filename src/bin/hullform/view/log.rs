//! The log of the window's states, a line of JSON a frame: for tests, and for who drives the window by script.

use std::fs::File;
use std::io::Write;
use std::path::Path;

use hullform::{Error, Result};
use serde_json::Value;

/// A log, if one was asked for.
pub struct Log(Option<File>);

impl Log {
    /// Begins a log.
    pub fn new(path: Option<&Path>) -> Result<Log> {
        let file = path.map(|path| {
            File::create(path).map_err(|source| Error::File {
                path: path.into(),
                source,
            })
        });
        Ok(Log(file.transpose()?))
    }

    /// Adds a state, made only where somebody asked for it.
    pub fn add(&mut self, state: impl FnOnce() -> Value) {
        if let Some(file) = &mut self.0 {
            // A line at once: whoever reads along sees whole ones, but for the last. A full disk does not close the window.
            let _ = file.write_all(format!("{}\n", state()).as_bytes());
        }
    }
}
