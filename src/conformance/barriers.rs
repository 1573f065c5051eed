//! Group `barriers`: invocations of a control shader that read what others of their patch wrote, round by round.
//!
//! Four rounds with two barriers each, over outputs of the vertices, arrays and vectors of the patch, positions, and a buffer; drivers have merged and dropped
//! such barriers, and lost what stood between them. A device may run the control shader of a patch twice: if it did so at the same time, the two would meet in the
//! buffer, and only there. A seeded fault lets the evaluation shader expect the next word.

use crate::conformance::modes::{module, with_invocations};
use crate::conformance::raw::{Program, Raster, Raw};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "barriers",
    about: "control shaders whose invocations read each other's outputs",
    cases,
    model_cases: None,
};

/// `FORM` in `glsl/conformance/barriers.glsl`, in order.
const FORMS: [&str; 5] = [
    "vertex_outputs",
    "patch_outputs",
    "positions",
    "buffer",
    "patch_components",
];

/// `FORM` of an array of the patch, and how many locations it has.
const PATCH_OUTPUTS: usize = 1;
const LOCATIONS: u32 = 16;

/// A kind of patches.
#[derive(Clone, Copy)]
struct Subject {
    form: u32,
    points: u32,
    invocations: u32,
    /// The vertex shader stores into a buffer as well.
    stores: bool,
    patches: u32,
}

/// `MOST` in `glsl/conformance/barriers.glsl`.
const MOST: u32 = 32;

fn rounds(context: &Context, subject: Subject) -> Result<Finding> {
    let Subject {
        form,
        points,
        invocations,
        stores,
        patches,
    } = subject;
    let words = [5, MOST * patches, points * patches];
    let mut raw = Raw::new(
        context.device()?,
        &words.map(|count| 4 * u64::from(count)),
        16,
    )?;
    let control = with_invocations(module("barriers.tesc")?, invocations);
    let pipeline = raw.pipeline(&Program {
        vertex: module("barriers.vert")?,
        control_points: points,
        constants: vec![points, invocations, form, u32::from(stores)],
        raster: Raster::Discard,
        ..Program::new(control, module("barriers.tese")?)?
    })?;
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &u32::from(context.is_wrong()));
        cmd.draw(points * patches, 1, 0, 0);
    })?;
    let [compared, wrong, patch, place, word] = raw.words(0)[..5] else {
        unreachable!("the buffer has five words");
    };
    context.saw(compared.into());
    let mut check = Check::default();
    check.hold(wrong == 0, || {
        format!("{wrong} words are wrong, one of them that of invocation {place} of patch {patch}: {word}")
    });
    // Level 2 makes nine vertices of a quad.
    let least = 9 * invocations * patches;
    check.hold(compared >= least, || {
        format!("{compared} words were compared, fewer than {least}")
    });
    let ran = raw.words(2).iter().filter(|&&count| count > 0).count() as u32;
    check.hold(!stores || ran == points * patches, || {
        format!(
            "the vertex shader stored for {ran} of {} points",
            points * patches
        )
    });
    Ok(check.finish(format!("{compared} words of {patches} patches")))
}

const SOURCE: &str =
    "GLSL 4.60, section 8.16, barrier; Vulkan, Tessellation Control Shader Execution";

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (form, stores) in (0..FORMS.len()).flat_map(|form| [false, true].map(|s| (form, s))) {
        for (invocations, patches) in [1, 2, 3, 4, 5, 7, 8, 15, 16, 31, 32]
            .into_iter()
            .flat_map(|count| [1, 300].map(|patches| (count, patches)))
        {
            if form == PATCH_OUTPUTS && invocations > LOCATIONS {
                continue;
            }
            let subject = Subject {
                form: form as u32,
                points: if stores { 3 } else { invocations },
                invocations,
                stores,
                patches,
            };
            let stored = if stores { "-behind_stores" } else { "" };
            let form = FORMS[form];
            let name =
                format!("barriers.{form}.{invocations}_invocations-{patches}_patches{stored}");
            let rule = "behind a barrier each invocation reads what the others wrote before it";
            let run = move |context: &Context| rounds(context, subject);
            cases.push(Case::new(name, rule, SOURCE, run));
        }
    }
    cases
}
