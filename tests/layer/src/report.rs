//! What the layer saw of a process, as text from the layer to the test.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

/// What the layer saw of a process.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Whether the fault came to pass.
    pub fired: bool,
    /// How often each function was called that can fail.
    pub calls: BTreeMap<String, u32>,
    /// Draws that were recorded, those that got lost included.
    pub draws: u32,
    /// What was made and is not destroyed, by kind.
    pub left: BTreeMap<String, u32>,
    /// What was destroyed twice, or too early: each in words.
    pub wrong: Vec<String>,
}

impl Report {
    /// Everything that is wrong, in words; empty if the process did well.
    pub fn faults(&self) -> Vec<String> {
        let left = self.left.iter();
        let left = left.map(|(kind, count)| format!("{count} {kind} were never destroyed"));
        self.wrong.iter().cloned().chain(left).collect()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "fired {}", self.fired)?;
        writeln!(f, "draws {}", self.draws)?;
        for (name, count) in &self.calls {
            writeln!(f, "call {name} {count}")?;
        }
        for (kind, count) in &self.left {
            writeln!(f, "left {kind} {count}")?;
        }
        for wrong in &self.wrong {
            writeln!(f, "wrong {wrong}")?;
        }
        Ok(())
    }
}

impl FromStr for Report {
    type Err = String;

    fn from_str(text: &str) -> Result<Report, String> {
        let mut report = Report::default();
        for line in text.lines() {
            let unknown = || format!("'{line}' is no line of a report");
            let (word, rest) = line.split_once(' ').ok_or_else(unknown)?;
            let counted = || {
                let (name, count) = rest.split_once(' ').ok_or_else(unknown)?;
                Ok::<_, String>((name.into(), count.parse().map_err(|_| unknown())?))
            };
            match word {
                "fired" => report.fired = rest == "true",
                "draws" => report.draws = rest.parse().map_err(|_| unknown())?,
                "call" => report.calls.extend([counted()?]),
                "left" => report.left.extend([counted()?]),
                "wrong" => report.wrong.push(rest.into()),
                _ => return Err(unknown()),
            }
        }
        Ok(report)
    }
}
