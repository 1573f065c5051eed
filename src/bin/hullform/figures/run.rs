//! Runs of this program: what their words mean, and what comes of them.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::options::Global;
use crate::output;

/// What words mean.
pub struct Words<'a> {
    /// The folder of models.
    pub models: Option<&'a Path>,
    /// The folder that is written into.
    pub output: &'a Path,
    /// Whether the quicker one of two is taken.
    pub quick: bool,
}

impl Words<'_> {
    /// The arguments that words stand for, or why there are none.
    pub fn arguments(&self, words: &str) -> Result<Vec<String>, String> {
        words
            .split_whitespace()
            .map(|word| self.word(word))
            .collect()
    }

    fn word(&self, word: &str) -> Result<String, String> {
        if let Some((slow, quick)) = word.strip_prefix('~').and_then(|two| two.split_once('~')) {
            return self.word(if self.quick { quick } else { slow });
        }
        let Some((kind, name)) = word.split_once(':') else {
            return Ok(word.into());
        };
        match kind {
            "model" => self.model(name),
            "any" => {
                let (model, shape) = name.split_once('/').unwrap_or((name, "hull"));
                Ok(self.model(model).unwrap_or(format!("builtin:{shape}")))
            }
            "box" | "crease" => self.block(name, kind == "crease"),
            _ => Ok(word.into()),
        }
    }

    /// A file of the folder of models.
    fn model(&self, name: &str) -> Result<String, String> {
        let Some(folder) = self.models else {
            return Err(format!(
                "the model {name} is not there: --models names no folder"
            ));
        };
        let path = folder.join(format!("{name}.obj"));
        match path.is_file() {
            true => Ok(path.to_string_lossy().into_owned()),
            false => Err(format!("there is no {name}.obj in {}", folder.display())),
        }
    }

    /// A block of so many quads along its sides, written beside the figures.
    fn block(&self, sizes: &str, creased: bool) -> Result<String, String> {
        let sides: Vec<u32> = sizes
            .split('x')
            .filter_map(|side| side.parse().ok())
            .collect();
        let [x, y, z] = sides[..] else {
            return Err(format!("{sizes} are no sides of a block"));
        };
        let path = self.output.join(match creased {
            true => format!("creased-block-{sizes}.obj"),
            false => format!("block-{sizes}.obj"),
        });
        let written = output::replace(&path, block([x, y, z], creased).as_bytes());
        written.map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(path.to_string_lossy().into_owned())
    }
}

/// The surface of a block as an OBJ file, bottom and top first. If it is creased, then along the edge of the first face on top that lies towards x.
fn block([x, y, z]: [u32; 3], creased: bool) -> String {
    let mut vertices: Vec<[u32; 3]> = Vec::new();
    let mut faces: Vec<[usize; 4]> = Vec::new();
    let mut number = |at: [u32; 3]| {
        let known = vertices.iter().position(|&vertex| vertex == at);
        known.unwrap_or_else(|| {
            vertices.push(at);
            vertices.len() - 1
        })
    };
    // Counter-clockwise from outside: first along `a`, then along `b`.
    let mut side = |a: usize, b: usize, turned: bool, plane: [usize; 2]| {
        let sizes = [x, y, z];
        for j in 0..sizes[b] {
            for i in 0..sizes[a] {
                let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[da, db]| {
                    let mut at = [0; 3];
                    at[plane[0]] = plane[1] as u32;
                    (at[a], at[b]) = (i + da, j + db);
                    number(at)
                });
                let [p, q, r, s] = corners;
                faces.push(if turned { [p, s, r, q] } else { [p, q, r, s] });
            }
        }
    };
    side(0, 1, true, [2, 0]);
    side(0, 1, false, [2, z as usize]);
    side(0, 2, false, [1, 0]);
    side(0, 2, true, [1, y as usize]);
    side(1, 2, true, [0, 0]);
    side(1, 2, false, [0, x as usize]);
    let mut text = String::new();
    for [x, y, z] in &vertices {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    for face in &faces {
        let [a, b, c, d] = face.map(|vertex| vertex + 1);
        let _ = writeln!(text, "f {a} {b} {c} {d}");
    }
    if creased {
        let [_, a, b, _] = faces[(x * y) as usize];
        let _ = writeln!(text, "t crease 2/1/0 {a} {b} 2");
    }
    text
}

/// The program with what all its runs have in common.
fn program(global: &Global) -> Result<Command, String> {
    let path = std::env::current_exe().map_err(|error| format!("no program: {error}"))?;
    let mut command = Command::new(path);
    let mut option = |name: &str, value: Option<&Path>| {
        if let Some(value) = value {
            command.arg(name).arg(value);
        }
    };
    option("--device", global.device.as_deref().map(Path::new));
    option("--db", global.db.as_deref());
    option("--pipeline-cache", global.pipeline_cache.as_deref());
    if global.validation {
        command.arg("--validation");
    }
    Ok(command)
}

/// Runs the program with arguments and files to write, and reads what it prints where that is JSON. Otherwise what it complained about.
pub fn run(
    global: &Global,
    arguments: &[String],
    files: &[(&str, PathBuf)],
    json: bool,
) -> Result<Value, String> {
    let mut command = program(global)?;
    command.args(arguments);
    for (option, file) in files {
        command.arg(option).arg(file);
    }
    if json {
        command.arg("--json");
    }
    let output = command.output();
    let output = output.map_err(|error| format!("it does not start: {error}"))?;
    if !output.status.success() {
        let words = String::from_utf8_lossy(&output.stderr);
        let last = words.lines().rev().find(|line| !line.trim().is_empty());
        let last = last.unwrap_or("it ended without a word");
        return Err(last.trim_start_matches("hullform: ").into());
    }
    match json {
        false => Ok(Value::Null),
        true => serde_json::from_slice(&output.stdout).map_err(|error| format!("no JSON: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stand_for_models_and_for_the_quicker_of_two() {
        let folder = tempfile::tempdir().expect("a folder");
        let words = |quick| Words {
            models: None,
            output: folder.path(),
            quick,
        };
        let line = "bench any:bigguy/cube --frames ~9~2";
        let slow = words(false).arguments(line).expect("it is there");
        assert_eq!(slow, ["bench", "builtin:cube", "--frames", "9"]);
        assert_eq!(words(true).arguments(line).expect("likewise")[3], "2");
        let missing = words(true).arguments("plan model:bigguy");
        assert!(missing.expect_err("there is no folder").contains("bigguy"));
    }

    #[test]
    fn blocks_are_closed_and_turned_outwards() {
        let text = block([2, 1, 3], true);
        let faces: Vec<Vec<u32>> = text
            .lines()
            .filter_map(|line| line.strip_prefix("f "))
            .map(|line| {
                line.split(' ')
                    .map(|n| n.parse().expect("a number"))
                    .collect()
            })
            .collect();
        assert_eq!(faces.len(), 2 * (2 + 6 + 3));
        let sides = |face: &Vec<u32>| -> Vec<[u32; 2]> {
            (0..4).map(|i| [face[i], face[(i + 1) % 4]]).collect()
        };
        let all: Vec<[u32; 2]> = faces.iter().flat_map(sides).collect();
        assert!(all.iter().all(|&[a, b]| all.contains(&[b, a])));
        assert!(text.contains("t crease 2/1/0 "));
    }
}
