//! Several views at once: each is what one draws that is alone.
//!
//! Each stage may read the view's number: control shaders make more segments of it, evaluation shaders places, and each stage a part of the colour. What a view must be, a
//! draw without views leaves, whose shaders are told the number as a constant. A seeded fault compares with the next view.

use crate::conformance::modes::{Domain, Modes, Spacing, module};
use crate::conformance::raw::{Drawing, Program, Raw};
use crate::conformance::{Case, Check, Context, Finding};
use crate::error::Result;

/// The picture's side in pixels.
const SIDE: u32 = 64;

/// As many bits as a view's number has at most here.
const MOST: u32 = 8;

/// `ALL` in `glsl/conformance/views.glsl`: shaders read the number of the view that they draw.
const ALL: u32 = u32::MAX;

/// The stages that may read it, as `READERS` has them in `glsl/conformance/views.glsl`.
const STAGES: [&str; 4] = ["vertex", "control", "evaluation", "fragment"];
const EVERY_STAGE: u32 = 0b1111;
const EVALUATION: u32 = 0b100;

/// What is drawn.
#[derive(Clone, Copy)]
struct Subject {
    modes: Modes,
    drawing: Drawing,
    /// A bit a stage.
    readers: u32,
}

const LEVEL: f32 = 3.0;

/// The runs of the evaluation shader in each view, and the pixels of each view that is drawn; `view` is its number as shaders are told it.
fn draw(
    context: &Context,
    subject: Subject,
    drawing: Drawing,
    view: u32,
) -> Result<(Vec<u32>, Vec<Vec<u32>>)> {
    let sizes = [4 * u64::from(MOST)];
    let mut raw = Raw::drawing(context.device()?, &sizes, SIDE, drawing)?;
    let evaluation = subject.modes.rewrite(module("views.tese")?);
    let pipeline = raw.pipeline(&Program {
        vertex: module("views.vert")?,
        fragment: module("views.frag")?,
        constants: vec![view, subject.readers],
        ..Program::new(module("views.tesc")?, evaluation)?
    })?;
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &LEVEL);
        cmd.draw(1, 1, 0, 0);
    })?;
    let pixels = (0..MOST).map(|view| match drawing.views() >> view & 1 {
        0 => Vec::new(),
        _ => raw.pixels_of(view),
    });
    let pixels = if drawing.views() == 0 {
        vec![raw.pixels()]
    } else {
        pixels.collect()
    };
    Ok((raw.words(0).to_vec(), pixels))
}

/// The colour of a view: three bits of its number from each stage that reads it, above one.
fn colour(view: u32, readers: u32) -> u32 {
    let parts = (0..STAGES.len()).filter(|stage| readers >> stage & 1 == 1);
    1 + parts.map(|stage| view << (3 * stage + 1)).sum::<u32>()
}

fn seen(context: &Context, subject: Subject) -> Result<Finding> {
    let support = context.device()?.info().support.optional;
    if !support.multiview {
        return Ok(Finding::skip(
            "the device has no multiviewTessellationShader",
        ));
    }
    if matches!(subject.drawing, Drawing::Rendering(_)) && !support.dynamic_rendering {
        return Ok(Finding::skip("the device has no dynamicRendering"));
    }
    let (runs, pictures) = draw(context, subject, subject.drawing, ALL)?;
    let views = subject.drawing.views();
    let drawn = (0..MOST).filter(|view| views >> view & 1 == 1);
    let mut check = Check::default();
    let mut count = 0;
    for view in drawn.clone() {
        // The view that a seeded fault compares with is another one of these.
        let wrong = u32::from(context.is_wrong());
        let (_, right) = draw(context, subject, Drawing::Pass(0), view + wrong)?;
        let picture = &pictures[view as usize];
        let differ = picture.iter().zip(&right[0]).filter(|(a, b)| a != b);
        let differ = differ.count();
        check.hold(differ == 0, || {
            format!("view {view}: {differ} pixels differ from those of a draw that is alone")
        });
        let colour = colour(view, subject.readers);
        let colours = picture.iter().filter(|&&pixel| pixel != 0);
        let own = colours.clone().filter(|&&pixel| pixel == colour).count();
        let drawn = colours.count();
        check.hold(own == drawn && drawn > 0, || {
            format!("view {view}: {own} of {drawn} pixels have its colour, {colour}")
        });
        if subject.readers & EVALUATION != 0 {
            let ran = runs[view as usize];
            check.hold(ran > 0, || {
                format!("view {view}: the evaluation shader saw its number in {ran} runs")
            });
        }
        count += drawn as u64;
    }
    context.saw(count);
    Ok(check.finish(format!("{} views, {count} pixels", drawn.count())))
}

const SOURCE: &str = "Vulkan, Render Pass Multiview; Built-In Variables, ViewIndex";

fn case(name: String, subject: Subject) -> Case {
    let rule = "each view is drawn as if alone, by shaders that read its number";
    Case::new(format!("state.{name}"), rule, SOURCE, move |context| {
        seen(context, subject)
    })
}

/// Views side by side, with gaps, and one that is not the first.
const VIEWS: [(&str, u32); 4] = [
    ("two", 0b11),
    ("six", 0b11_1111),
    ("gaps", 0b10101),
    ("third", 0b100),
];

/// A way to draw so many views.
type Way = (&'static str, fn(u32) -> Drawing);

const WAYS: [Way; 2] = [("pass", Drawing::Pass), ("rendering", Drawing::Rendering)];

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for ((way, drawing), (name, views)) in WAYS
        .into_iter()
        .flat_map(|way| VIEWS.map(|views| (way, views)))
    {
        for (domain, spacing) in Domain::ALL
            .into_iter()
            .flat_map(|domain| Spacing::ALL.map(|spacing| (domain, spacing)))
        {
            let subject = Subject {
                modes: Modes::new(domain, spacing),
                drawing: drawing(views),
                readers: EVERY_STAGE,
            };
            let kind = format!("{}-{}", domain.name(), spacing.name());
            cases.push(case(format!("views.{way}-{name}-{kind}"), subject));
        }
        for (number, stage) in STAGES.iter().enumerate() {
            let subject = Subject {
                modes: Modes::new(Domain::Quads, Spacing::Equal),
                drawing: drawing(views),
                readers: 1 << number,
            };
            cases.push(case(format!("views.{way}-{name}-{stage}_reads"), subject));
        }
    }
    cases
}
