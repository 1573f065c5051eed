//! What is kept of cases that do not pass.

use crate::output::{self, png};
use hullform::conformance::{Finding, Picture};
use hullform::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// Makes the folder, before any case runs.
pub fn prepare(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(|source| Error::File {
        path: folder.into(),
        source,
    })
}

/// Writes the pictures and what was measured.
pub fn keep(folder: &Path, name: &str, finding: &Finding, drawn: &[Picture]) -> Result<()> {
    let text = format!("{name}\n{}: {}\n", finding.status, finding.measured);
    write(folder.join(format!("{name}.txt")), text.as_bytes())?;
    for (number, Picture { width, pixels }) in drawn.iter().enumerate() {
        let height = (pixels.len() / 4) as u32 / width;
        let mut bytes = Vec::new();
        png::write(&mut bytes, *width, height, pixels).expect("memory takes all that is written");
        write(folder.join(format!("{name}-{number}.png")), &bytes)?;
    }
    Ok(())
}

fn write(path: PathBuf, bytes: &[u8]) -> Result<()> {
    output::replace(&path, bytes).map_err(|source| Error::File { path, source })
}
