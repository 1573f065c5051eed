//! How figures come about.

use std::path::{Path, PathBuf};
use std::time::Instant;

use hullform::Result;

use super::figure::{Check, Figure, Made, Make, Results, Step, Verdict, Writes, judge};
use super::run::{self, Words};
use super::{Arguments, curves, panels};
use crate::options::Global;
use crate::output;

/// Of pictures that are to be there soon.
const QUICK_SIZE: &str = "320x180";

/// What figures are made with.
pub struct Workshop<'a> {
    output: PathBuf,
    words: Words<'a>,
    global: &'a Global,
}

impl<'a> Workshop<'a> {
    /// In the folder that is asked for, by its whole path.
    pub fn new(arguments: &'a Arguments, global: &'a Global) -> Result<Workshop<'a>> {
        Ok(Workshop {
            output: arguments.output.clone(),
            words: Words {
                models: arguments.models.as_deref(),
                output: &arguments.output,
                quick: arguments.quick,
            },
            global,
        })
    }

    /// Makes one; what goes wrong is its verdict.
    pub fn make(&self, figure: &Figure) -> Made {
        let started = Instant::now();
        let mut made = Made {
            id: figure.id,
            title: figure.title,
            checked: Vec::new(),
            files: Vec::new(),
            verdict: Verdict::Reproduced,
            seconds: 0.0,
        };
        match &figure.make {
            Make::Cannot(reason) => made.verdict = Verdict::Unavailable((*reason).into()),
            Make::Steps {
                steps,
                checks,
                lacks,
            } => self.make_steps(&mut made, steps, checks, lacks),
            Make::Curves(all) => {
                let mut failed = Vec::new();
                for one in *all {
                    match curves::make(one, &self.words, self.global) {
                        Ok(files) => made.files.extend(files),
                        Err(reason) => failed.push(format!("{}: {reason}", one.name)),
                    }
                }
                made.verdict = match (failed.is_empty(), made.files.is_empty()) {
                    (true, _) => Verdict::Reproduced,
                    (_, true) => Verdict::Unavailable(failed.join("; ")),
                    (_, false) => Verdict::Differs(failed.join("; ")),
                };
            }
        }
        made.seconds = started.elapsed().as_secs_f64();
        made
    }

    fn make_steps(
        &self,
        made: &mut Made,
        steps: &'static [Step],
        checks: &'static [Check],
        lacks: &str,
    ) {
        let mut results = Results::default();
        let (mut failed, mut some) = (Vec::new(), false);
        for step in steps {
            if step.slow && self.words.quick {
                failed.push(format!("{}: left out by --quick", step.name));
                continue;
            }
            match self.step(made.id, step) {
                Ok((value, files)) => {
                    some = true;
                    made.files.extend(files);
                    results.0.insert(step.name, value);
                }
                Err(reason) => failed.push(reason),
            }
        }
        if let Err(reason) = self.join(made, steps) {
            failed.push(reason);
        }
        failed.dedup();
        (made.checked, made.verdict) = judge(checks, &results, &failed, some, lacks);
    }

    /// Puts the panels that were made side by side, and these in the place of all.
    fn join(&self, made: &mut Made, steps: &[Step]) -> std::result::Result<(), String> {
        let panels = steps.iter().filter(|step| step.writes == Writes::Panel);
        let panels: Vec<(&str, PathBuf)> = panels
            .map(|step| (step.name, self.file(&stem(made.id, step), "png")))
            .filter(|(_, path)| made.files.contains(&name(path)))
            .collect();
        if panels.is_empty() {
            return Ok(());
        }
        let path = self.file(made.id, "png");
        let failed = |error: std::io::Error| format!("{}: {error}", path.display());
        let joined = panels::side_by_side(&panels)?;
        output::replace(&path, &joined).map_err(failed)?;
        for (_, panel) in &panels {
            made.files.retain(|file| *file != name(panel));
            std::fs::remove_file(panel).map_err(failed)?;
        }
        made.files.push(name(&path));
        Ok(())
    }

    /// Runs a step; what it printed, and the names of what it wrote.
    fn step(
        &self,
        id: &str,
        step: &Step,
    ) -> std::result::Result<(serde_json::Value, Vec<String>), String> {
        let mut arguments = self.words.arguments(step.words)?;
        let has_picture = matches!(step.writes, Writes::Picture | Writes::Both);
        if self.words.quick && has_picture {
            arguments.extend(["--size", QUICK_SIZE].map(String::from));
        }
        let stem = stem(id, step);
        let files: Vec<(&str, PathBuf)> = match step.writes {
            Writes::Facts => Vec::new(),
            Writes::Picture | Writes::Panel | Writes::Both => {
                vec![("--output", self.file(&stem, "png"))]
            }
            Writes::Drawing => vec![("--output", self.file(&stem, "svg"))],
            Writes::Plot => vec![
                ("--plot", self.file(&stem, "svg")),
                ("--csv", self.file(&stem, "csv")),
            ],
        };
        let json = !matches!(
            step.writes,
            Writes::Picture | Writes::Panel | Writes::Drawing
        );
        let value = run::run(self.global, &arguments, &files, json)?;
        let mut names: Vec<String> = files.iter().map(|(_, path)| name(path)).collect();
        if json {
            let path = self.file(&stem, "json");
            let written = output::replace(&path, format!("{value:#}\n").as_bytes());
            written.map_err(|error| format!("{}: {error}", path.display()))?;
            names.push(name(&path));
        }
        Ok((value, names))
    }

    fn file(&self, stem: &str, ending: &str) -> PathBuf {
        self.output.join(format!("{stem}.{ending}"))
    }
}

/// What the files of a step are called.
fn stem(id: &str, step: &Step) -> String {
    format!("{id}-{}", step.name)
}

/// Without its folder.
pub fn name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}
