//! Group `precision`: `precise` expressions have the bits of their single operations, in every stage and module.
//!
//! Additions, subtractions and multiplications are correctly rounded, and `precise` forbids to contract or reorder them; so every stage has the bits that the CPU has. On
//! this the equality of edges rests that several patches evaluate. What is `invariant` need not have these bits, but the same ones in every pipeline that has its expression. A
//! seeded fault expects the next bits, or another patch's.

use crate::conformance::modes::module;
use crate::conformance::random::Random;
use crate::conformance::raw::{Feedback, Program, Raster, Raw};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "precision",
    about: "bits of precise expressions in every stage",
    cases,
    model_cases: None,
};

type Vector = [f32; 4];

/// Twins of `evaluated` in `glsl/conformance/precision.glsl`.
type Expression = (&'static str, fn(Vector, Vector) -> f32);

const EXPRESSIONS: [Expression; 9] = [
    ("multiply_add", |a, b| a[0] * b[0] + a[1]),
    ("dot", |a, b| {
        ((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]) + a[3] * b[3]
    }),
    ("cross", |a, b| a[0] * b[1] - a[1] * b[0]),
    ("bernstein", |a, b| {
        let (s, t) = (1.0 - b[0], b[0]);
        ((a[0] * (s * s * s) + a[1] * (3.0 * (t * (s * s)))) + a[2] * (3.0 * (t * t * s)))
            + a[3] * (t * t * t)
    }),
    ("de_casteljau", |a, b| {
        let t = b[0];
        let p = a[0] + t * (a[1] - a[0]);
        let q = a[1] + t * (a[2] - a[1]);
        let u = a[2] + t * (a[3] - a[2]);
        let (v, w) = (p + t * (q - p), q + t * (u - q));
        v + t * (w - v)
    }),
    ("horner", |a, b| {
        ((a[3] * b[0] + a[2]) * b[0] + a[1]) * b[0] + a[0]
    }),
    // What is lost in a sum (Knuth's TwoSum).
    ("two_sum", |a, b| {
        let sum = a[0] + b[0];
        let part = sum - a[0];
        (a[0] - (sum - part)) + (b[0] - part)
    }),
    ("sum", |a, b| {
        ((((((a[0] + a[1]) + a[2]) + a[3]) + b[0]) + b[1]) + b[2]) + b[3]
    }),
    ("same_products", |a, b| {
        (a[0] * b[0]) * (a[1] * b[1]) - (a[0] * b[1]) * (a[1] * b[0])
    }),
];

/// What numbers are like.
#[derive(Clone, Copy)]
enum Kind {
    Unit,
    Cancelling,
    Large,
    Small,
}

impl Kind {
    const ALL: [(Kind, &'static str); 4] = [
        (Kind::Unit, "unit"),
        (Kind::Cancelling, "cancelling"),
        (Kind::Large, "large"),
        (Kind::Small, "small"),
    ];

    /// Nothing overflows or becomes denormal, which devices may flush.
    fn numbers(self, random: &mut Random) -> [Vector; 2] {
        let mut some = |low: f64, high: f64| [(); 4].map(|()| random.between(low, high) as f32);
        match self {
            Kind::Unit => [some(-1.0, 1.0), some(0.0, 1.0)],
            Kind::Cancelling => {
                let (a, b) = (some(1.0, 2.0), some(0.5, 1.0));
                let near = |i: usize| -(a[0] * b[0]) * (1.0 + 1e-7 * i as f32);
                [[a[0], near(1), near(2), near(3)], b]
            }
            Kind::Large => [some(-1e7, 1e7), some(-1e7, 1e7)],
            Kind::Small => [some(1e-4, 2e-4), some(1e-3, 3e-3)],
        }
    }
}

const STAGES: [&str; 3] = ["vertex", "control", "evaluation"];

/// Two batches of what known drivers make of a draw.
const COUNT: u32 = 5000;

fn bits(context: &Context, expression: usize, kind: Kind, stage: usize) -> Result<Finding> {
    let (name, twin) = EXPRESSIONS[expression];
    let mut random = context.random(name);
    let numbers: Vec<[Vector; 2]> = (0..COUNT).map(|_| kind.numbers(&mut random)).collect();
    let mut raw = Raw::new(
        context.device()?,
        &[32 * u64::from(COUNT), 4 * u64::from(COUNT)],
        16,
    )?;
    raw.write(0, &numbers)?;
    // No result is this NaN.
    raw.write(1, &vec![u32::MAX; COUNT as usize])?;
    let pipeline = raw.pipeline(&Program {
        vertex: module("precision.vert")?,
        constants: vec![expression as u32, stage as u32],
        raster: Raster::Discard,
        ..Program::new(module("precision.tesc")?, module("precision.tese")?)?
    })?;
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &0u32);
        cmd.draw(COUNT, 1, 0, 0);
    })?;
    let found = raw.words(1);
    context.saw(found.iter().filter(|&&word| word != u32::MAX).count() as u64);
    let mut check = Check::default();
    for (&[a, b], &found) in numbers.iter().zip(found) {
        let right = twin(a, b).to_bits() + u32::from(context.is_wrong());
        // Zeros of either sign are equal.
        let same = found == right || f32::from_bits(found) == 0.0 && f32::from_bits(right) == 0.0;
        check.hold(same, || {
            let [found, right] = [found, right].map(f32::from_bits);
            format!("{name} of {a:?} and {b:?} is {found:e} instead of {right:e}")
        });
    }
    Ok(check.finish(format!("{COUNT} results")))
}

/// Patches of the two pipelines, two triangles each.
const PATCHES: u32 = 500;

/// Words of a captured vertex: the patch's number and the values.
const WORDS: usize = 3;

/// What a pipeline with this evaluation shader gives for each patch, at all vertices.
fn captured(
    context: &Context,
    evaluation: &str,
    expression: usize,
    numbers: &[[Vector; 2]],
) -> Result<Vec<Vec<[u32; 2]>>> {
    let device = context.full_device()?;
    let bytes = 4 * WORDS as u64 * 6 * u64::from(PATCHES);
    let sizes = [32 * u64::from(PATCHES), 4 * u64::from(PATCHES), bytes];
    let mut raw = Raw::new(device, &sizes, 16)?;
    raw.write(0, numbers)?;
    let pipeline = raw.pipeline(&Program {
        vertex: module("precision.vert")?,
        constants: vec![expression as u32, STAGES.len() as u32],
        raster: Raster::Discard,
        ..Program::new(module("precision.tesc")?, module(evaluation)?)?
    })?;
    let feedback = Feedback::capture(device)?;
    raw.submit_behind(
        |cmd| feedback.reset(cmd),
        |cmd| {
            cmd.bind(pipeline, &0u32);
            let into = Some((&raw, 2, bytes));
            feedback.around(cmd, into, || cmd.draw(PATCHES, 1, 0, 0));
        },
    )?;
    let [primitives, _] = feedback.counts()?;
    let mut values = vec![Vec::new(); PATCHES as usize];
    let vertices = raw.words(2).chunks_exact(WORDS);
    for vertex in vertices.take(3 * primitives as usize) {
        if let Some(own) = values.get_mut(vertex[0] as usize) {
            own.push([vertex[1], vertex[2]]);
        }
    }
    context.saw(primitives);
    Ok(values)
}

fn invariant(context: &Context, expression: usize, kind: Kind) -> Result<Finding> {
    if !context.device()?.possible()?.transform_feedback {
        return Ok(Finding::skip("the device has no transformFeedback"));
    }
    let (name, _) = EXPRESSIONS[expression];
    let mut random = context.random(name);
    let numbers: Vec<[Vector; 2]> = (0..PATCHES).map(|_| kind.numbers(&mut random)).collect();
    let one = captured(context, "invariant.tese", expression, &numbers)?;
    let mut other = captured(context, "invariant-other.tese", expression, &numbers)?;
    if context.is_wrong() {
        other.rotate_left(1);
    }
    let mut check = Check::default();
    for (patch, (one, other)) in one.iter().zip(&other).enumerate() {
        check.hold(one == other && one.len() == 6, || {
            format!("patch {patch} has {one:x?} in one pipeline and {other:x?} in the other")
        });
    }
    Ok(check.finish(format!("{PATCHES} patches in two pipelines")))
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (kind, kind_name) in Kind::ALL {
        for (number, (expression, _)) in EXPRESSIONS.iter().enumerate() {
            let name = format!("precision.invariant.{expression}-{kind_name}");
            let rule = "an invariant output has the same bits in all pipelines with the same expressions for it";
            let source = "GLSL 4.60, section 4.8, The Invariant Qualifier; SPIR-V, Invariant";
            let run = move |context: &Context| invariant(context, number, kind);
            cases.push(Case::new(name, rule, source, run));
        }
    }
    for (stage, (kind, kind_name)) in
        (0..STAGES.len()).flat_map(|stage| Kind::ALL.map(|kind| (stage, kind)))
    {
        for (number, (expression, _)) in EXPRESSIONS.iter().enumerate() {
            let name = format!("precision.{}.{expression}-{kind_name}", STAGES[stage]);
            let rule =
                "a precise expression has the bits of its operations, each correctly rounded";
            let source = "GLSL 4.60, section 4.9; Vulkan, Precision and Operation of SPIR-V Instructions; SPIR-V, NoContraction";
            let run = move |context: &Context| bits(context, number, kind, stage);
            cases.push(Case::new(name, rule, source, run));
        }
    }
    cases
}
