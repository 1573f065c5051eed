//! Group `io`: what a control shader gets and hands on: points, vertices, arrays, blocks, and what belongs to the patch.
//!
//! Shaders compare all of it themselves. A seeded fault lets them expect something else.

use crate::conformance::modes::{Domain, Modes, Spacing, module, with_invocations};
use crate::conformance::raw::{Program, Raster, Raw};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "io",
    about: "inputs and outputs of control and evaluation shaders",
    cases,
    model_cases: None,
};

/// Push constants. Twin of `Draw` in `glsl/conformance/io.glsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Constants {
    fault: u32,
    vertices: u32,
    outer: [f32; 4],
    inner: [f32; 2],
}

// As `tests/layout.rs` holds the shaders to.
const _: () = assert!(size_of::<Constants>() == 4 * 8);

/// `MODE` in `glsl/conformance/io.glsl`.
#[derive(Clone, Copy)]
enum Mode {
    First = 0,
    Turns = 1,
    Unwritten = 2,
    Beyond = 3,
}

/// A kind of patches.
#[derive(Clone, Copy)]
struct Subject {
    /// Control points in, and vertices out.
    points: u32,
    vertices: u32,
    mode: Mode,
    /// With as many outputs as there may be.
    greatest: bool,
    domain: Domain,
    spacing: Spacing,
    outer: [f32; 4],
    inner: [f32; 2],
}

impl Subject {
    fn new(points: u32, vertices: u32, mode: Mode) -> Subject {
        Subject {
            points,
            vertices,
            mode,
            greatest: false,
            domain: Domain::Quads,
            spacing: Spacing::Equal,
            outer: [2.0; 4],
            inner: [2.0; 2],
        }
    }

    /// Outer and inner levels of the domain.
    fn levels(&self) -> [u32; 2] {
        match self.domain {
            Domain::Quads => [4, 2],
            Domain::Triangles => [3, 1],
            Domain::Isolines => [2, 0],
        }
    }
}

const PATCHES: u32 = 37;

/// What the shaders compare, by `first_what`.
fn what(number: u32) -> &'static str {
    match number {
        0 | 100 => "gl_PatchVerticesIn",
        1 => "a vertex's number",
        2 => "gl_in[].gl_Position of the control shader",
        3 => "a number behind the patch's points",
        110 => "a vector of a vertex",
        120..=121 => "an array of a vertex",
        130 => "whole numbers of a vertex",
        135..=136 => "a block of a vertex",
        140 | 300 => "gl_in[].gl_Position of the evaluation shader",
        150 | 400 => "an array of the patch",
        160..=161 => "a block of the patch",
        170 => "gl_TessLevelOuter",
        180 => "gl_TessLevelInner",
        _ => "one of the greatest number of a vertex's vectors",
    }
}

fn arrives(context: &Context, subject: Subject) -> Result<Finding> {
    let mut raw = Raw::new(context.device()?, &[4 * 5], 16)?;
    let name = if subject.greatest {
        "io-greatest"
    } else {
        "io"
    };
    let control = with_invocations(module(&format!("{name}.tesc"))?, subject.vertices);
    let modes = Modes::new(subject.domain, subject.spacing);
    let evaluation = modes.rewrite(module(&format!("{name}.tese"))?);
    let [outers, inners] = subject.levels();
    let Subject {
        points, vertices, ..
    } = subject;
    let pipeline = raw.pipeline(&Program {
        control_points: points,
        constants: vec![points, subject.mode as u32, outers, inners],
        raster: Raster::Discard,
        ..Program::new(control, evaluation)?
    })?;
    let constants = Constants {
        fault: u32::from(context.is_wrong()),
        vertices,
        outer: subject.outer,
        inner: subject.inner,
    };
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &constants);
        cmd.draw(points * PATCHES, 1, 0, 0);
    })?;
    let [compared, wrong, first, patch, place] = raw.words(0)[..5] else {
        unreachable!("the buffer has five words");
    };
    context.saw(compared.into());
    let mut check = Check::default();
    check.hold(wrong == 0, || {
        let what = what(first);
        format!("{wrong} values are wrong, one of them {what}, place {place} of patch {patch}")
    });
    // Each of the patch's vertices compares what belongs to the patch, at least.
    let least = PATCHES * 4;
    check.hold(compared >= least, || {
        format!("{compared} values were compared, fewer than {least}")
    });
    Ok(check.finish(format!("{compared} values of {PATCHES} patches")))
}

const SIZES: [u32; 7] = [1, 2, 3, 4, 8, 31, 32];

/// Levels as they are written, within the device's limits and beyond: the evaluation shader reads them unclamped.
const LEVELS: [(&str, [f32; 4], [f32; 2]); 8] = [
    ("one", [1.0; 4], [1.0; 2]),
    ("whole", [2.0, 3.0, 4.0, 5.0], [6.0, 7.0]),
    ("between", [1.5, 2.25, 3.125, 4.0625], [5.7, 1.3]),
    ("little", [0.5, 0.25, 1e-3, 1e-10], [0.125, 1e-20]),
    ("much", [64.0, 1.0, 63.5, 2.0], [64.0, 3.0]),
    ("beyond", [65.0, 100.0, 1.0, 1e4], [70.0, 1e9]),
    ("negative_inside", [3.0; 4], [-1.0, -5.0]),
    (
        "infinite",
        [f32::INFINITY, 2.0, 2.0, 2.0],
        [2.0, f32::INFINITY],
    ),
];

const SOURCE: &str = "Vulkan, Shader Interfaces; Built-In Variables, PatchVertices, TessLevelOuter and TessLevelInner";

fn case(name: String, rule: &'static str, subject: Subject) -> Case {
    Case::new(format!("io.{name}"), rule, SOURCE, move |context| {
        arrives(context, subject)
    })
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (points, vertices) in SIZES
        .into_iter()
        .flat_map(|points| SIZES.map(|vertices| (points, vertices)))
    {
        let name = format!("vertices.{points}_in-{vertices}_out");
        let rule = "control shaders read all points of their patch, evaluation shaders all that was written for it";
        cases.push(case(
            name,
            rule,
            Subject::new(points, vertices, Mode::First),
        ));
    }
    for size in SIZES {
        for (name, rule, mode) in [
            (
                "writers",
                "each output of the patch may be another invocation's",
                Mode::Turns,
            ),
            (
                "unwritten",
                "an output that nobody writes or reads leaves the others alone",
                Mode::Unwritten,
            ),
            (
                "beyond",
                "what is read behind the patch's points is undefined, and does no harm",
                Mode::Beyond,
            ),
        ] {
            let name = format!("{name}.{size}_vertices");
            cases.push(case(name, rule, Subject::new(size, size, mode)));
        }
    }
    for vertices in [1, 2, 4, 16, 28] {
        let subject = Subject {
            greatest: true,
            ..Subject::new(1, vertices, Mode::First)
        };
        let name = format!("greatest.{vertices}_vertices");
        let rule = "64 components of each of 28 vertices, and 57 of the patch, are handed on";
        cases.push(case(name, rule, subject));
    }
    for (domain, spacing) in Domain::ALL
        .into_iter()
        .flat_map(|domain| Spacing::ALL.map(|spacing| (domain, spacing)))
    {
        for (levels, outer, inner) in LEVELS {
            let subject = Subject {
                domain,
                spacing,
                outer,
                inner,
                ..Subject::new(1, 1, Mode::First)
            };
            let name = format!("levels.{}-{}-{levels}", domain.name(), spacing.name());
            let rule = "the evaluation shader reads tess levels as the control shader wrote them";
            cases.push(case(name, rule, subject));
        }
    }
    cases
}
