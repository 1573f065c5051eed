//! What changed since a run that was saved: times as multiples of the yardstick's, which the machine's load touches less, and the work.

use std::fmt::Write;
use std::path::Path;

use hullform::{Error, Result};
use serde_json::Value;

/// What rows are told apart by.
const KEYS: [&str; 8] = [
    "model",
    "method",
    "level",
    "residence",
    "backend",
    "instances",
    "passes",
    "static",
];

/// The work that is counted, and is the same on each run.
const WORK: [(&str, &str); 5] = [
    ("evaluation_invocations", "evaluations"),
    ("points_computed", "points"),
    ("multiply_adds", "multiplies"),
    ("draws", "draws"),
    ("device_bytes", "bytes"),
];

/// A run that was saved.
pub struct Saved {
    name: String,
    report: Value,
}

impl Saved {
    /// Reads what `--json FILE` wrote.
    ///
    /// # Errors
    /// [`Error::Option`] where there is no such file, or nothing that `bench` wrote.
    pub fn read(path: &Path) -> Result<Saved> {
        let refuse = |problem: String| Error::Option {
            option: "--against",
            problem: format!("{}: {problem}", path.display()),
            remedy: "name a file that `hullform bench --json FILE` wrote".into(),
        };
        let bytes = std::fs::read(path).map_err(|error| refuse(error.to_string()))?;
        let report: Value =
            serde_json::from_slice(&bytes).map_err(|error| refuse(error.to_string()))?;
        match report["rows"].is_array() {
            false => Err(refuse("it has no rows".into())),
            true => Ok(Saved {
                name: path.display().to_string(),
                report,
            }),
        }
    }

    /// A line for each row of a report that the saved one has too.
    pub fn compared(&self, report: &Value) -> String {
        let mut text = format!(
            "against {}: times over those, as multiples of flat",
            self.name
        );
        for key in ["device", "driver"] {
            if report[key] != self.report[key] {
                let _ = write!(
                    text,
                    "\nanother {key}: {} there, {} here",
                    self.report[key], report[key]
                );
            }
        }
        let rows = |report: &Value| report["rows"].as_array().cloned().unwrap_or_default();
        let old = rows(&self.report);
        let is_same = |a: &Value, b: &Value| KEYS.iter().all(|&key| a[key] == b[key]);
        let (mut met, new) = (0, rows(report));
        for row in &new {
            let Some(before) = old.iter().find(|before| is_same(before, row)) else {
                continue;
            };
            met += 1;
            let _ = write!(text, "\n{}", line(before, row));
        }
        let _ = write!(text, "\n{met} of {} rows are in both", new.len());
        text
    }
}

fn line(before: &Value, now: &Value) -> String {
    let word = |key: &str| match &now[key] {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let [model, method, level] = ["model", "method", "level"].map(word);
    let times = quotient(before, now, "ratio_to_flat");
    let times = times.map_or("-".into(), |times| format!("x {times:.2}"));
    let mut line = format!("{model:16} {method:10} {level:>5} {times:>8}");
    for (key, name) in WORK {
        match quotient(before, now, key) {
            Some(times) if times != 1.0 => {
                let _ = write!(line, "  {name} x {times:.3}");
            }
            None if before[key] != now[key] => {
                let _ = write!(line, "  {name} {} instead of {}", now[key], before[key]);
            }
            _ => {}
        }
    }
    line
}

/// None where either is missing, or was nothing.
fn quotient(before: &Value, now: &Value, key: &str) -> Option<f64> {
    let before = before[key].as_f64().filter(|&before| before > 0.0)?;
    Some(now[key].as_f64()? / before)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn report(ratio: f64, points: u64) -> Value {
        json!({ "device": "a", "driver": "b", "rows": [
            { "model": "m", "method": "one", "level": 8.0, "ratio_to_flat": ratio, "points_computed": points },
            { "model": "m", "method": "two", "level": 8.0, "ratio_to_flat": null, "points_computed": 0 },
        ]})
    }

    #[test]
    fn what_is_slower_or_does_more_is_told() {
        let saved = Saved {
            name: "old".into(),
            report: report(2.0, 100),
        };
        let text = saved.compared(&report(3.0, 110));
        assert!(text.contains("x 1.50  points x 1.100"), "{text}");
        assert!(text.ends_with("2 of 2 rows are in both"), "{text}");
        let text = saved.compared(&report(2.0, 100));
        assert!(
            text.contains("x 1.00\n") && !text.contains("points"),
            "{text}"
        );
    }
}
