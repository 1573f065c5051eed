//! Group `loops`: what invocations have computed in a loop that they leave at different times.
//!
//! Each sums over a stretch of a table, of a length of its own, by a loop of one of several forms. Machines that run invocations abreast go on with a loop until the
//! last of them leaves it; what the others had must stay as it was. A seeded fault expects a term more.

use crate::conformance::modes::module;
use crate::conformance::raw::{Program, Raw};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "loops",
    about: "loops that invocations leave at different times",
    cases,
    model_cases: None,
};

/// Forms of loops. Twin of `FORM` in `glsl/conformance/loops.glsl`.
const FORMS: [&str; 7] = [
    "tested_first",
    "tested_last",
    "left_in_the_middle",
    "left_at_the_end",
    "skipped",
    "tested_last_outside",
    "tested_last_inside",
];

/// Terms in the table: a power of two.
const TERMS: u32 = 1024;
const PATCHES: u32 = 8;

/// A stage whose invocations sum, and how many sums a patch has.
#[derive(Clone, Copy)]
enum Stage {
    Control,
    Evaluation,
}

impl Stage {
    fn name(self) -> &'static str {
        match self {
            Stage::Control => "control",
            Stage::Evaluation => "evaluation",
        }
    }

    fn sums(self) -> u32 {
        match self {
            Stage::Control => 32,
            Stage::Evaluation => 64,
        }
    }

    fn program(self, form: u32) -> Result<Program> {
        let (control, evaluation) = match self {
            Stage::Control => ("loops.tesc", "loops.tese"),
            Stage::Evaluation => ("loops-evaluation.tesc", "loops-evaluation.tese"),
        };
        Ok(Program {
            constants: vec![form],
            ..Program::new(module(control)?, module(evaluation)?)?
        })
    }
}

/// A sum. Twin of `Sum` in `glsl/conformance/loops.glsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct Sum {
    value: u32,
    last: u32,
    turns: u32,
}

// As `tests/layout.rs` holds the shaders to.
const _: () = assert!(size_of::<Sum>() == 4 * 3);

fn sum(terms: &[u32], start: u32, count: u32) -> Sum {
    (0..count).fold(Sum::default(), |sum, turn| {
        let last = terms[((start + turn) % TERMS) as usize];
        Sum {
            value: sum.value.wrapping_mul(1_664_525).wrapping_add(last),
            last,
            turns: turn + 1,
        }
    })
}

fn sums(context: &Context, stage: Stage, form: u32) -> Result<Finding> {
    let mut random = context.random("loops");
    let terms: Vec<u32> = (0..TERMS).map(|_| random.below(1 << 20)).collect();
    let count = PATCHES * stage.sums();
    let sizes = [u64::from(4 * TERMS), u64::from(12 * count)];
    let mut raw = Raw::new(context.device()?, &sizes, 16)?;
    raw.write(0, &terms)?;
    let pipeline = raw.pipeline(&stage.program(form)?)?;
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &0u32);
        cmd.draw(PATCHES, 1, 0, 0);
    })?;
    let found: &[Sum] = bytemuck::cast_slice(raw.words(1));
    context.saw(found.iter().filter(|sum| sum.turns > 0).count() as u64);
    let mut check = Check::default();
    for (number, found) in (0..).zip(found) {
        let turns = 1 + terms[(number % TERMS) as usize] % 20;
        let right = sum(&terms, number, turns + u32::from(context.is_wrong()));
        check.hold(*found == right, || {
            format!("sum {number}, of {turns} terms, is {found:?} instead of {right:?}")
        });
    }
    Ok(check.finish(format!("{count} sums")))
}

fn cases() -> Vec<Case> {
    let rule =
        "what an invocation computed before it left a loop stays what it was while others go on";
    let source = "SPIR-V, Structured Control Flow; Vulkan, Shader Execution";
    let mut cases = Vec::new();
    for stage in [Stage::Control, Stage::Evaluation] {
        for (form, name) in (0..).zip(FORMS) {
            let name = format!("loops.{}.{name}", stage.name());
            cases.push(Case::new(name, rule, source, move |context| {
                sums(context, stage, form)
            }));
        }
    }
    cases
}
