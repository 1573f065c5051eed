//! The figures and tables of the three papers, with what they print, a file a paper.

mod peers;
mod quadratic;
mod tables;
mod together;
mod trees;

use super::figure::{Agrees, Check, Curves, Figure, Make, Results, Step, Writes};

const POSITION: &str = "position_error";

const fn step(name: &'static str, words: &'static str, writes: Writes) -> Step {
    Step {
        name,
        words,
        writes,
        slow: false,
    }
}

const fn slow(name: &'static str, words: &'static str, writes: Writes) -> Step {
    Step {
        name,
        words,
        writes,
        slow: true,
    }
}

const fn check(
    what: &'static str,
    printed: &'static str,
    measured: fn(&Results) -> Option<f64>,
    agrees: Agrees,
) -> Check {
    Check {
        what,
        printed,
        measured,
        agrees,
    }
}

const fn figure(id: &'static str, title: &'static str, make: Make) -> Figure {
    Figure { id, title, make }
}

const fn steps(steps: &'static [Step], checks: &'static [Check], lacks: &'static str) -> Make {
    Make::Steps {
        steps,
        checks,
        lacks,
    }
}

/// The quotient of the root mean square distances of two methods.
fn farther(results: &Results, step: &str, [method, than]: [&str; 2]) -> Option<f64> {
    let [own, other] = [method, than].map(|method| results.error(step, method, [POSITION, "rms"]));
    Some(own? / other?)
}

/// Nanoseconds a vertex at a level.
fn nanoseconds(results: &Results, step: &str, method: &str, level: f64) -> Option<f64> {
    let row = results.row(step, method, Some(level), None)?;
    let vertices = row["evaluation_invocations"].as_f64()?;
    Some(1e6 * results.milliseconds(step, row)? / vertices)
}

/// What is of no paper.
const OWN: &[Figure] = &[figure(
    "methods",
    "Errors and costs of all methods over triangles",
    Make::Curves(&[
        Curves {
            name: "quads",
            model: "any:bigguy/cube",
            scheme: "catmull-clark",
        },
        Curves {
            name: "triangles",
            model: "any:monsterfrog/pole-18",
            scheme: "loop",
        },
    ]),
)];

/// All of them, in the order of the papers.
pub fn figures() -> impl Iterator<Item = &'static Figure> {
    let papers = [trees::FIGURES, quadratic::FIGURES, tables::FIGURES, OWN];
    papers.into_iter().flatten()
}
