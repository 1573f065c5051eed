//! The log of a session in dEQP's format (`qpTestLog.c`, version 0.3.4): lines that begin with `#`, and XML for each case.

use crate::deqp::{CASE_TYPE, RELEASE, RELEASE_ID, TARGET};
use hullform::error::visible;
use hullform::{Error, Result};
use quick_xml::escape::escape;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A log in the making. It is written where it stays: harnesses read it of processes that were killed, too.
pub struct Log {
    path: PathBuf,
    out: BufWriter<File>,
    /// Whether all of it is handed over after each case.
    flushes: bool,
}

/// What a case left behind.
pub struct Entry<'a> {
    /// The case with the package before it.
    pub path: &'a str,
    /// Words about it.
    pub texts: &'a [&'a str],
    /// Microseconds that it took.
    pub duration: u64,
    /// How it ended, in dEQP's words.
    pub status: &'a str,
    /// What was measured.
    pub details: &'a str,
}

impl Log {
    pub fn create(path: &Path, flushes: bool) -> Result<Log> {
        let file = File::create(path).map_err(|source| Error::File {
            path: path.into(),
            source,
        })?;
        Ok(Log {
            path: path.into(),
            out: BufWriter::new(file),
            flushes,
        })
    }

    fn wrote(&self, written: io::Result<()>) -> Result<()> {
        written.map_err(|source| Error::Write {
            path: self.path.clone(),
            source,
        })
    }

    /// Begins the session; `info` are facts with their names.
    pub fn begin_session(&mut self, info: &[(&str, String)]) -> Result<()> {
        let written = begin_session(&mut self.out, info).and_then(|()| self.out.flush());
        self.wrote(written)
    }

    /// Notes that a case begins, so that a log that breaks off tells in which.
    pub fn begin(&mut self, path: &str) -> Result<()> {
        let written = writeln!(self.out, "#beginTestCaseResult {path}");
        let written = written.and_then(|()| self.may_flush());
        self.wrote(written)
    }

    /// Notes how the case ended that began last.
    pub fn end(&mut self, entry: &Entry<'_>) -> Result<()> {
        let written = end(&mut self.out, entry).and_then(|()| self.may_flush());
        self.wrote(written)
    }

    /// Ends the session.
    pub fn end_session(mut self) -> Result<()> {
        let written = writeln!(self.out, "#endSession").and_then(|()| self.out.flush());
        self.wrote(written)
    }

    fn may_flush(&mut self) -> io::Result<()> {
        if self.flushes {
            self.out.flush()
        } else {
            Ok(())
        }
    }
}

fn begin_session(out: &mut impl Write, info: &[(&str, String)]) -> io::Result<()> {
    writeln!(out, "#sessionInfo releaseName {RELEASE}")?;
    writeln!(out, "#sessionInfo releaseId 0x{RELEASE_ID:08x}")?;
    writeln!(out, "#sessionInfo targetName \"{TARGET}\"")?;
    for (name, value) in info {
        writeln!(out, "#sessionInfo {name} \"{}\"", visible(value))?;
    }
    writeln!(out, "\n#beginSession")
}

fn end(out: &mut impl Write, entry: &Entry<'_>) -> io::Result<()> {
    let Entry {
        path,
        texts,
        duration,
        status,
        details,
    } = entry;
    let plain = |text: &str| escape(visible(text).into_owned()).into_owned();
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(
        out,
        "<TestCaseResult Version=\"0.3.4\" CasePath=\"{path}\" CaseType=\"{CASE_TYPE}\">"
    )?;
    for text in *texts {
        writeln!(out, " <Text>{}</Text>", plain(text))?;
    }
    writeln!(
        out,
        " <Number Name=\"TestDuration\" Description=\"Test case duration in microseconds\" Tag=\"Time\" Unit=\"us\">{duration}</Number>"
    )?;
    writeln!(
        out,
        " <Result StatusCode=\"{status}\">{}</Result>",
        plain(details)
    )?;
    writeln!(out, "</TestCaseResult>\n\n#endTestCaseResult\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_is_xml_whatever_a_driver_says() {
        let mut out = Vec::new();
        let entry = Entry {
            path: "hullform.a.b.c",
            texts: &["n < 4 & \u{1}"],
            duration: 12,
            status: "Fail",
            details: "a\nb \"x\"",
        };
        end(&mut out, &entry).expect("memory takes all");
        let text = String::from_utf8(out).expect("it is text");
        assert!(text.contains(" <Text>n &lt; 4 &amp; \\u{1}</Text>\n"));
        assert!(text.contains(">a\\nb &quot;x&quot;</Result>\n"), "{text}");
        assert!(text.ends_with("</TestCaseResult>\n\n#endTestCaseResult\n\n"));
    }
}
