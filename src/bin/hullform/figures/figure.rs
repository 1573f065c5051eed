//! What a figure or table of a paper is, how it is made, and what is said of it.

use std::collections::BTreeMap;

use serde_json::{Value, json};

/// A figure or a table, as the list has it.
pub struct Figure {
    /// The year of its paper, what it is, and its number.
    pub id: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// How it is made.
    pub make: Make,
}

/// How a figure is made.
pub enum Make {
    /// Not at all, and why.
    Cannot(&'static str),
    /// By runs of this program.
    Steps {
        /// These.
        steps: &'static [Step],
        /// What is compared with what is printed.
        checks: &'static [Check],
        /// What the figure has that cannot be made here; empty where that is all.
        lacks: &'static str,
    },
    /// Errors and costs of all methods over triangles.
    Curves(&'static [Curves]),
}

/// A run of this program.
pub struct Step {
    /// What its files and its results are called.
    pub name: &'static str,
    /// Its words. `model:NAME` is a file of the folder of models, `any:NAME/OTHER` that or else a built-in shape, `box:XxYxZ` one that is made, and
    /// `~A~B` is A, or B with `--quick`.
    pub words: &'static str,
    /// What it writes.
    pub writes: Writes,
    /// Whether it takes longer than `--quick` allows.
    pub slow: bool,
}

/// What a step writes, apart from what it prints.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Writes {
    /// Nothing: its results as JSON are all.
    Facts,
    /// A picture.
    Picture,
    /// A picture that stands beside the others of the figure, under the step's name.
    Panel,
    /// A picture, and its results as JSON.
    Both,
    /// A drawing.
    Drawing,
    /// A plot of its results, and these.
    Plot,
}

/// A number that a paper prints, or what it claims of one.
pub struct Check {
    /// What is measured.
    pub what: &'static str,
    /// In the paper's words.
    pub printed: &'static str,
    /// The number, out of the results.
    pub measured: fn(&Results) -> Option<f64>,
    /// When it agrees.
    pub agrees: Agrees,
}

/// When a measured number agrees with what is printed.
#[derive(Clone, Copy)]
pub enum Agrees {
    /// It is this.
    Exactly(f64),
    /// It is no more than this.
    AtMost(f64),
    /// It is no less than this.
    AtLeast(f64),
    /// It lies between these.
    Between(f64, f64),
    /// It is another machine's or another model's, and is shown alone.
    Shown,
}

impl Agrees {
    fn with(self, measured: f64) -> bool {
        match self {
            Agrees::Exactly(right) => measured == right,
            Agrees::AtMost(most) => measured <= most,
            Agrees::AtLeast(least) => measured >= least,
            Agrees::Between(least, most) => (least..=most).contains(&measured),
            Agrees::Shown => true,
        }
    }
}

/// The methods of a scheme on a model.
pub struct Curves {
    /// What its files are called.
    pub name: &'static str,
    /// As a step has it.
    pub model: &'static str,
    /// The scheme.
    pub scheme: &'static str,
}

/// What steps printed, by their names.
#[derive(Default)]
pub struct Results(pub BTreeMap<&'static str, Value>);

impl Results {
    /// A number by the step's name and a JSON pointer.
    pub fn number(&self, step: &str, pointer: &str) -> Option<f64> {
        self.0.get(step)?.pointer(pointer)?.as_f64()
    }

    /// What `compare` found of a method: `position_error` or `normal_error_degrees`, and which number of it.
    pub fn error(&self, step: &str, method: &str, [of, which]: [&str; 2]) -> Option<f64> {
        let methods = self.0.get(step)?.get("methods")?.as_array()?;
        let row = methods.iter().find(|row| row["method"] == method)?;
        row[of][which].as_f64()
    }

    /// A row of `bench`; any level or residence where none is named.
    pub fn row(
        &self,
        step: &str,
        method: &str,
        level: Option<f64>,
        residence: Option<&str>,
    ) -> Option<&Value> {
        let rows = self.0.get(step)?.get("rows")?.as_array()?;
        rows.iter().find(|row| {
            row["method"] == method
                && level.is_none_or(|level| row["level"].as_f64() == Some(level))
                && residence.is_none_or(|residence| row["residence"] == residence)
        })
    }

    /// How many frames of the faces themselves one of a method takes.
    pub fn times_flat(&self, step: &str, method: &str, level: Option<f64>) -> Option<f64> {
        self.row(step, method, level, None)?["ratio_to_flat"].as_f64()
    }

    /// The milliseconds that count of a row: the processor's where that draws.
    pub fn milliseconds(&self, step: &str, row: &Value) -> Option<f64> {
        let device = self.0.get(step)?["device"].as_str().unwrap_or_default();
        let [first, second] = match device.contains("llvmpipe") {
            true => ["cpu_ms", "gpu_ms"],
            false => ["gpu_ms", "cpu_ms"],
        };
        row[first].as_f64().or(row[second].as_f64())
    }
}

/// What is said of a figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All of it is there, and agrees.
    Reproduced,
    /// Why not all does.
    Differs(String),
    /// Why none of it is there.
    Unavailable(String),
}

impl Verdict {
    /// In a word.
    pub fn word(&self) -> &'static str {
        match self {
            Verdict::Reproduced => "reproduced",
            Verdict::Differs(_) => "differs",
            Verdict::Unavailable(_) => "unavailable",
        }
    }

    /// Why.
    pub fn reason(&self) -> &str {
        match self {
            Verdict::Reproduced => "",
            Verdict::Differs(reason) | Verdict::Unavailable(reason) => reason,
        }
    }
}

/// A check with what came out.
pub struct Checked {
    pub what: &'static str,
    pub printed: &'static str,
    /// None where the model or the method is not there.
    pub measured: Option<f64>,
    pub agrees: bool,
}

/// A figure that was made, or not.
pub struct Made {
    pub id: &'static str,
    pub title: &'static str,
    pub checked: Vec<Checked>,
    /// Names in the folder.
    pub files: Vec<String>,
    pub verdict: Verdict,
    pub seconds: f64,
}

impl Made {
    /// As JSON, a row a number that is printed, or one for the whole.
    pub fn rows(&self) -> Vec<Value> {
        let row = |what: &str, printed: Value, measured: Value| {
            json!({
                "id": self.id,
                "paper": paper(self.id),
                "what": what,
                "printed": printed,
                "measured": measured,
                "verdict": self.verdict.word(),
                "reason": self.verdict.reason(),
            })
        };
        if self.checked.is_empty() {
            return vec![row(self.title, Value::Null, Value::Null)];
        }
        let rows = self.checked.iter();
        rows.map(|check| row(check.what, json!(check.printed), json!(check.measured)))
            .collect()
    }
}

/// The paper of an id.
pub fn paper(id: &str) -> &'static str {
    match id.split('.').next() {
        Some("2016") => "Brainerd, Foley, Kraemer, Moreton, Nießner 2016",
        Some("2007") => "Boubekeur, Schlick 2007",
        Some("2011") => "Holländer, Boubekeur 2011",
        _ => "this library",
    }
}

/// Compares results with what is printed. `failed` are the reasons of steps that came to nothing, `made` is whether any came to something.
pub fn judge(
    checks: &[Check],
    results: &Results,
    failed: &[String],
    made: bool,
    lacks: &str,
) -> (Vec<Checked>, Verdict) {
    let checked: Vec<Checked> = checks
        .iter()
        .map(|check| {
            let measured = (check.measured)(results).filter(|number| number.is_finite());
            Checked {
                what: check.what,
                printed: check.printed,
                measured,
                agrees: measured.is_some_and(|number| check.agrees.with(number)),
            }
        })
        .collect();
    if !made {
        return (checked, Verdict::Unavailable(failed.join("; ")));
    }
    let mut reasons: Vec<String> = checked
        .iter()
        .filter(|check| !check.agrees)
        .map(|check| match check.measured {
            Some(number) => format!(
                "{}: {} is printed, {} is measured",
                check.what,
                check.printed,
                rounded(number)
            ),
            None => format!("{}: nothing is measured", check.what),
        })
        .collect();
    reasons.extend(failed.iter().cloned());
    if !lacks.is_empty() {
        reasons.push(lacks.into());
    }
    let verdict = match reasons.is_empty() {
        true => Verdict::Reproduced,
        false => Verdict::Differs(reasons.join("; ")),
    };
    (checked, verdict)
}

/// Four digits, and no more noughts than needed.
pub fn rounded(number: f64) -> String {
    let whole = number.abs();
    match number {
        _ if number == 0.0 => "0".into(),
        _ if !(1e-3..1e12).contains(&whole) => format!("{number:.2e}"),
        _ if number.fract() == 0.0 || whole >= 1e4 => format!("{number:.0}"),
        _ if whole >= 100.0 => format!("{number:.1}"),
        _ => format!("{number:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHECK: Check = Check {
        what: "plans",
        printed: "19",
        measured: |results| results.number("plan", "/plans"),
        agrees: Agrees::AtMost(19.0),
    };

    fn with(plans: u32) -> Results {
        Results([("plan", json!({ "plans": plans }))].into())
    }

    #[test]
    fn verdicts_say_what_differs_and_what_is_missing() {
        let verdict = |results: &Results, failed: &[String], made, lacks| {
            judge(&[CHECK], results, failed, made, lacks).1
        };
        assert_eq!(verdict(&with(18), &[], true, ""), Verdict::Reproduced);
        let differs = verdict(&with(20), &[], true, "");
        assert_eq!(
            differs,
            Verdict::Differs("plans: 19 is printed, 20 is measured".into())
        );
        let lacks = verdict(&with(18), &[], true, "no such method");
        assert_eq!(lacks, Verdict::Differs("no such method".into()));
        let missing = verdict(&Results::default(), &["no model".into()], false, "");
        assert_eq!(missing, Verdict::Unavailable("no model".into()));
        let half = verdict(&Results::default(), &["no model".into()], true, "");
        assert!(matches!(half, Verdict::Differs(_)), "{half:?}");
    }

    #[test]
    fn numbers_agree_or_not() {
        assert!(Agrees::Exactly(19.0).with(19.0) && !Agrees::Exactly(19.0).with(19.1));
        assert!(Agrees::AtLeast(3.0).with(3.0) && !Agrees::AtLeast(3.0).with(2.9));
        assert!(Agrees::Between(0.3, 0.54).with(0.4) && !Agrees::Between(0.3, 0.54).with(0.6));
    }
}
