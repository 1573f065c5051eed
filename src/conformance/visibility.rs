//! Group `visibility`: what a control shader stores, the evaluation shader of the same patch loads.
//!
//! Every form in which GLSL lets one say that: qualifiers, barriers, atomic operations, the Vulkan memory model. That a software device passes
//! proves little, for it runs one stage after the other; the group is for those that do not. A seeded fault lets the reader expect something
//! else than was written.

use crate::conformance::modes::{module, with_invocations};
use crate::conformance::raw::{Program, Raster, Raw, Recorder};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "visibility",
    about: "stores of control shaders, loads of evaluation shaders",
    cases,
    model_cases: None,
};

/// Push constants. Twin of `Draw` in `glsl/conformance/visibility.glsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Constants {
    first_patch: u32,
    words: u32,
    room: u32,
    counter: u32,
    host: u32,
    round: u32,
    fault: u32,
    level: f32,
}

// As `tests/layout.rs` holds the shaders to.
const _: () = assert!(size_of::<Constants>() == 4 * 8);

/// A way to say it: the name of its two shaders.
#[derive(Clone, Copy, Debug)]
struct Form {
    name: &'static str,
    source: &'static str,
}

const GLSL: &str =
    "GLSL 4.60, sections 4.10 and 8.17; Vulkan, Memory Model, Availability and Visibility";
const MODEL: &str = "Vulkan, Memory Model; GL_KHR_memory_scope_semantics";

const FORMS: [Form; 9] = [
    form("coherent", GLSL),
    form("memory-barrier", GLSL),
    form("volatile", GLSL),
    form("volatile-coherent", GLSL),
    form("restrict", GLSL),
    form("one-way", GLSL),
    form("atomic", GLSL),
    form("memory-model", MODEL),
    form("control-barrier", MODEL),
];

const fn form(name: &'static str, source: &'static str) -> Form {
    Form { name, source }
}

impl Form {
    /// Whether it speaks the memory model, which is a feature.
    fn needs_model(self) -> bool {
        self.source == MODEL
    }
}

/// What the shaders found: `results` in `glsl/conformance/visibility.glsl`.
#[derive(Clone, Copy, Debug)]
struct Found {
    compared: u32,
    wrong: u32,
    refused: u32,
    first: [u32; 3],
}

const SLOTS: usize = 0;
const COUNTERS: usize = 1;
const RESULTS: usize = 2;

/// Counters, enough for the batches of any case.
const BATCHES: u32 = 16;

/// Words and results on the device, and a pipeline for a form.
struct Bed<'a> {
    context: &'a Context,
    raw: Raw<'a>,
    pipeline: ash::vk::Pipeline,
}

/// A device without the memory model cannot run forms that speak it.
fn lacks(context: &Context, form: Form) -> Result<Option<Finding>> {
    let lacks = form.needs_model() && !context.device()?.possible()?.vulkan_memory_model;
    Ok(lacks.then(|| Finding::skip("the device has no vulkanMemoryModelDeviceScope")))
}

impl Bed<'_> {
    fn new(context: &Context, form: Form, invocations: u32, room: u32) -> Result<Bed<'_>> {
        let sizes = [u64::from(4 * room), u64::from(4 * BATCHES), 24];
        let device = if form.needs_model() {
            context.memory_model_device()?
        } else {
            context.device()?
        };
        let mut raw = Raw::new(device, &sizes, 16)?;
        let control = module(&format!("visibility-{}.tesc", form.name))?;
        let evaluation = module(&format!("visibility-{}.tese", form.name))?;
        let pipeline = raw.pipeline(&Program {
            constants: vec![invocations],
            raster: Raster::Discard,
            ..Program::new(with_invocations(control, invocations), evaluation)?
        })?;
        Ok(Bed {
            context,
            raw,
            pipeline,
        })
    }

    fn run(&self, draws: impl FnOnce(&Recorder<'_>)) -> Result<Found> {
        self.raw.submit(None, draws)?;
        let words = self.raw.words(RESULTS);
        self.context.saw(words[0].into());
        Ok(Found {
            compared: words[0],
            wrong: words[1],
            refused: words[2],
            first: [words[3], words[4], words[5]],
        })
    }
}

/// A slot of `words` words for each of `patches` patches.
#[derive(Clone, Copy, Debug)]
struct Size {
    patches: u32,
    words: u32,
    level: u32,
}

impl Size {
    fn constants(self, context: &Context) -> Constants {
        Constants {
            first_patch: 0,
            words: self.words,
            room: self.patches * self.words,
            counter: 0,
            host: 0,
            round: 0,
            fault: u32::from(context.is_wrong()),
            level: self.level as f32,
        }
    }

    /// Words that are compared when `patches` arrive: each vertex compares them all.
    fn comparisons(self, patches: u32) -> u32 {
        patches * self.words * (self.level + 1).pow(2)
    }
}

fn judge(check: &mut Check, found: Found, least: u32) {
    check.hold(found.wrong == 0, || {
        let [patch, number, value] = found.first;
        format!(
            "{} of {} words were wrong, one of them word {number} of patch {patch}: {value:#010x}",
            found.wrong, found.compared
        )
    });
    check.hold(found.compared >= least, || {
        format!("{} words were compared instead of {least}", found.compared)
    });
}

/// One batch, everything fits.
fn batch(
    context: &Context,
    form: Form,
    invocations: u32,
    size: Size,
    host: bool,
) -> Result<Finding> {
    if let Some(skipped) = lacks(context, form)? {
        return Ok(skipped);
    }
    // A control shader may run more than once for a patch: twice the room, so that a counter does not run over.
    let room = 2 * size.patches * size.words;
    let bed = Bed::new(context, form, invocations, room)?;
    let constants = Constants {
        host: u32::from(host),
        room,
        ..size.constants(context)
    };
    let found = bed.run(|cmd| {
        cmd.bind(bed.pipeline, &constants);
        cmd.draw(size.patches, 1, 0, 0);
    })?;
    let mut check = Check::default();
    judge(&mut check, found, size.comparisons(size.patches));
    Ok(check.finish(format!(
        "{} words of {} patches compared",
        found.compared, size.patches
    )))
}

/// Batches that use the same slots one after the other, in one render pass with a barrier between them.
fn batches(context: &Context, form: Form) -> Result<Finding> {
    if let Some(skipped) = lacks(context, form)? {
        return Ok(skipped);
    }
    let size = Size {
        patches: 200,
        words: 24,
        level: 3,
    };
    let room = 2 * size.patches * size.words;
    let bed = Bed::new(context, form, 32, room)?;
    let found = bed.run(|cmd| {
        for number in 0..BATCHES {
            if number > 0 {
                cmd.barrier();
            }
            let constants = Constants {
                first_patch: number * size.patches,
                counter: number,
                round: number,
                room,
                ..size.constants(context)
            };
            cmd.bind(bed.pipeline, &constants);
            cmd.draw(size.patches, 1, 0, 0);
        }
    })?;
    let mut check = Check::default();
    judge(&mut check, found, BATCHES * size.comparisons(size.patches));
    Ok(check.finish(format!(
        "{} words compared in {BATCHES} batches",
        found.compared
    )))
}

/// Submissions that use the same slots one after the other.
fn frames(context: &Context, form: Form) -> Result<Finding> {
    if let Some(skipped) = lacks(context, form)? {
        return Ok(skipped);
    }
    const FRAMES: u32 = 5;
    let size = Size {
        patches: 300,
        words: 17,
        level: 4,
    };
    let room = 2 * size.patches * size.words;
    let mut bed = Bed::new(context, form, 32, room)?;
    let mut check = Check::default();
    let mut compared = 0;
    for round in 0..FRAMES {
        bed.raw.clear(COUNTERS)?;
        bed.raw.clear(RESULTS)?;
        let constants = Constants {
            round,
            room,
            ..size.constants(context)
        };
        let found = bed.run(|cmd| {
            cmd.bind(bed.pipeline, &constants);
            cmd.draw(size.patches, 1, 0, 0);
        })?;
        compared += found.compared;
        judge(&mut check, found, size.comparisons(size.patches));
    }
    Ok(check.finish(format!("{compared} words compared in {FRAMES} frames")))
}

/// Room for some patches only: the others are refused and left out, and nothing is wrong.
fn over_allocation(context: &Context, form: Form) -> Result<Finding> {
    if let Some(skipped) = lacks(context, form)? {
        return Ok(skipped);
    }
    let size = Size {
        patches: 500,
        words: 20,
        level: 3,
    };
    let fitting = 123;
    let room = fitting * size.words + size.words / 2;
    let bed = Bed::new(context, form, 32, room)?;
    let constants = Constants {
        room,
        ..size.constants(context)
    };
    let found = bed.run(|cmd| {
        cmd.bind(bed.pipeline, &constants);
        cmd.draw(size.patches, 1, 0, 0);
    })?;
    let mut check = Check::default();
    judge(&mut check, found, 0);
    let arrived = found.compared / size.comparisons(1).max(1);
    // A control shader that runs twice takes two slots.
    check.hold((1..=fitting).contains(&arrived), || {
        format!("{arrived} patches arrived where {fitting} have room")
    });
    check.hold(found.refused >= size.patches - fitting, || {
        format!("{} patches were refused", found.refused)
    });
    check.hold(bed.raw.words(SLOTS).len() as u32 == room, String::new);
    Ok(check.finish(format!(
        "{arrived} patches arrived, {} refused",
        found.refused
    )))
}

fn cases() -> Vec<Case> {
    FORMS.into_iter().flat_map(cases_of).collect()
}

fn cases_of(form: Form) -> Vec<Case> {
    let Form { name, source } = form;
    let case = |last: &str, rule: &str, run: fn(&Context, Form) -> Result<Finding>| {
        let name = format!("visibility.{name}.{last}");
        Case::new(name, rule, source, move |context| run(context, form))
    };
    let mut cases: Vec<Case> = [1, 2, 3, 7, 16, 31, 32]
        .map(|invocations| {
            let size = Size {
                patches: 400,
                words: 33,
                level: 3,
            };
            let name = format!("visibility.{name}.{invocations}_invocations");
            let rule =
                "what all invocations of a control shader store is what evaluation shaders load";
            Case::new(name, rule, source, move |context| {
                batch(context, form, invocations, size, false)
            })
        })
        .into();
    cases.push(case(
        "host_slots",
        "the same, with slots that do not depend on who runs when",
        |context, form| {
            let size = Size {
                patches: 1000,
                words: 16,
                level: 2,
            };
            batch(context, form, 32, size, true)
        },
    ));
    cases.push(case(
        "many_patches",
        "the same for thousands of patches in a draw",
        |context, form| {
            let size = Size {
                patches: 5000,
                words: 40,
                level: 1,
            };
            batch(context, form, 32, size, false)
        },
    ));
    let rule = "a batch that uses the memory again, behind a barrier, sees only its own";
    cases.push(case("batches", rule, batches));
    let rule = "so does a later submission";
    cases.push(case("frames", rule, frames));
    let rule = "patches without room are refused and left out, the others are whole";
    cases.push(case("over_allocation", rule, over_allocation));
    cases
}
