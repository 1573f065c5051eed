//! Results that outlive a harness which is killed: a row a case, from which another run takes up.
//!
//! Harnesses run several of these programs at once, so that rows are appended whole, each in one write. One that was cut off is none, and its case runs again.

use crate::deqp::RELEASE;
use hullform::conformance::Opened;
use hullform::error::visible;
use hullform::{Error, Result};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What begins the rows that say whose results these are.
const OWNER: &str = "#";

/// How a case ended, in dEQP's words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ended {
    pub status: String,
    pub details: String,
}

/// The results so far.
#[derive(Default)]
pub struct Journal {
    known: HashMap<String, Ended>,
    out: Option<(PathBuf, File)>,
}

impl Journal {
    /// Reads what is there, and goes on behind it. Nothing is kept without a file.
    ///
    /// # Errors
    /// When the file cannot be read or written, and when it has results of another device, driver or release.
    pub fn open(path: Option<&Path>, device: Option<&Opened>) -> Result<Journal> {
        let (Some(path), Some(device)) = (path, device) else {
            return Ok(Journal::default());
        };
        let owner = format!(
            "{OWNER}{RELEASE}\t{}\t{}",
            visible(&device.name),
            visible(&device.driver.info)
        );
        let read = |source| Error::File {
            path: path.into(),
            source,
        };
        let text = match std::fs::read(path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(read(error)),
        };
        let known = parse(&text, &owner).ok_or_else(|| Error::Option {
            option: "--hullform-resume",
            problem: format!("{} has results of another device", path.display()),
            remedy: "give another file, or remove this one".into(),
        })?;
        let file = OpenOptions::new().append(true).create(true).open(path);
        let mut journal = Journal {
            known,
            out: Some((path.into(), file.map_err(read)?)),
        };
        // What was cut off at the end shall not have a row of ours behind it.
        let separator = if text.is_empty() || text.ends_with('\n') {
            ""
        } else {
            "\n"
        };
        journal.append(&format!("{separator}{owner}\n"))?;
        Ok(journal)
    }

    /// How a case ended in an earlier run.
    pub fn known(&self, path: &str) -> Option<&Ended> {
        self.known.get(path)
    }

    /// Notes how a case ended.
    pub fn note(&mut self, path: &str, status: &str, details: &str) -> Result<()> {
        self.append(&format!("{path}\t{status}\t{}\t.\n", visible(details)))
    }

    fn append(&mut self, row: &str) -> Result<()> {
        let Some((path, file)) = &mut self.out else {
            return Ok(());
        };
        file.write_all(row.as_bytes())
            .map_err(|source| Error::Write {
                path: path.clone(),
                source,
            })
    }
}

/// The whole rows of a text; None where some of them are another's.
fn parse(text: &str, owner: &str) -> Option<HashMap<String, Ended>> {
    let mut known = HashMap::new();
    for line in text.lines() {
        if line.starts_with(OWNER) {
            if line != owner {
                return None;
            }
        } else if let [path, status, details, "."] = line.split('\t').collect::<Vec<_>>()[..] {
            let (status, details) = (status.into(), details.into());
            known.insert(path.into(), Ended { status, details });
        }
    }
    Some(known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_rows_are_read_and_others_run_again() {
        let text = "#a\nx.y\tPass\t3 of 3\t.\nx.z\tFail\n#a\nx.w\tCrash\tsig";
        let known = parse(text, "#a").expect("it is ours");
        assert_eq!(known.len(), 1);
        assert_eq!(known["x.y"].status, "Pass");
        assert_eq!(known["x.y"].details, "3 of 3");
        assert_eq!(parse(text, "#b"), None);
    }
}
