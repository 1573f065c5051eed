//! Group `compute_visibility`: what a compute shader stores, the stages of a later draw load.
//!
//! As where points are computed beforehand. Each case says in another way what must be visible, round after round over the same memory, so that a draw must also be done with it
//! before the next round is stored. A seeded fault says it not at all, which synchronization validation tells, and expects another round.

use ash::vk;

use crate::conformance::modes::module;
use crate::conformance::raw::{Drawing, Event, Program, Raster, Raw, Recorder, Scope};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;
use vk::{AccessFlags as Access, PipelineStageFlags as Stage};

/// The group.
pub const GROUP: Group = Group {
    name: "compute_visibility",
    about: "stores of compute shaders, loads of tessellation",
    cases,
    model_cases: None,
};

/// Push constants. Twin of `Draw` in `glsl/conformance/compute.glsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Constants {
    count: u32,
    round: u32,
    expected: u32,
}

// As `tests/layout.rs` holds the shaders to.
const _: () = assert!(size_of::<Constants>() == 4 * 3);

/// The ways to say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// A memory barrier between the two stages.
    Memory,
    /// One for the buffer.
    Buffer,
    /// One for all memory and all stages.
    Everything,
    /// Two, by way of a stage that does nothing in between.
    Chain,
    /// A barrier in a submission of its own.
    Submission,
    /// An event that is set and waited for.
    Event,
    /// A memory barrier of Vulkan 1.3.
    Barrier2,
    /// An event of Vulkan 1.3.
    Event2,
    /// The dependency that the pass itself has on what came before.
    Pass,
}

impl Way {
    const ALL: [(Way, &'static str); 9] = [
        (Way::Memory, "memory_barrier"),
        (Way::Buffer, "buffer_barrier"),
        (Way::Everything, "everything"),
        (Way::Chain, "chain"),
        (Way::Submission, "submission"),
        (Way::Event, "event"),
        (Way::Barrier2, "barrier2"),
        (Way::Event2, "event2"),
        (Way::Pass, "pass_dependency"),
    ];

    fn is_of_1_3(self) -> bool {
        matches!(self, Way::Barrier2 | Way::Event2)
    }

    /// Records it, from one stage to the other.
    fn record(self, cmd: &Recorder<'_>, event: &Event<'_>, from: Scope, to: Scope) {
        match self {
            Way::Memory | Way::Submission => cmd.memory_barrier(from, to),
            Way::Buffer => cmd.buffer_barrier(WORDS, from, to),
            Way::Everything => {
                let all = Stage::ALL_COMMANDS;
                cmd.memory_barrier(
                    (all, Access::MEMORY_WRITE),
                    (all, Access::MEMORY_READ | Access::MEMORY_WRITE),
                );
            }
            Way::Chain => {
                let between = (
                    Stage::TRANSFER,
                    Access::TRANSFER_READ | Access::TRANSFER_WRITE,
                );
                cmd.memory_barrier(from, between);
                // What the first made available this makes visible.
                cmd.memory_barrier((Stage::TRANSFER, Access::empty()), to);
            }
            Way::Event => cmd.event(event, from, to),
            Way::Barrier2 => cmd.memory_barrier2(from, to),
            Way::Event2 => cmd.event2(event, from, to),
            // It begins with the pass.
            Way::Pass => {}
        }
    }
}

const READERS: [(&str, Stage); 3] = [
    ("vertex", Stage::VERTEX_SHADER),
    ("control", Stage::TESSELLATION_CONTROL_SHADER),
    ("evaluation", Stage::TESSELLATION_EVALUATION_SHADER),
];

/// Shaders of which one reads: no other one names the words.
fn program(reader: usize) -> Result<Program> {
    let of = |number, reads, reads_nothing| {
        module(if reader == number {
            reads
        } else {
            reads_nothing
        })
    };
    let control = of(1, "compute.tesc", "compute-reads_nothing.tesc")?;
    let evaluation = of(2, "compute.tese", "compute-reads_nothing.tese")?;
    Ok(Program {
        vertex: of(0, "compute.vert", "patch.vert")?,
        raster: Raster::Discard,
        ..Program::new(control, evaluation)?
    })
}

const WORDS: usize = 0;
const RESULTS: usize = 1;

/// `WORDS` in `glsl/conformance/compute.glsl`.
const WORDS_A_PATCH: u32 = 16;

const ROUNDS: u32 = 4;

fn seen(context: &Context, way: Way, reader: usize, patches: u32) -> Result<Finding> {
    let device = if way.is_of_1_3() {
        context.full_device()?
    } else {
        context.device()?
    };
    if way.is_of_1_3() && !device.extra().synchronization2 {
        return Ok(Finding::skip("the device has no synchronization2"));
    }
    let count = WORDS_A_PATCH * patches;
    let wrong = context.is_wrong();
    let (_, stage) = READERS[reader];
    let written = (Stage::COMPUTE_SHADER, Access::SHADER_WRITE);
    let read = (stage, Access::SHADER_READ);
    let sizes = [4 * u64::from(count), 4 * 4];
    let mut raw = if way == Way::Pass && !wrong {
        Raw::drawing(device, &sizes, 16, Drawing::Behind(written, read))?
    } else {
        Raw::new(device, &sizes, 16)?
    };
    let compute = raw.compute_pipeline(module("compute.comp")?)?;
    let draw = raw.pipeline(&program(reader)?)?;
    let mut check = Check::default();
    for round in 0..ROUNDS {
        let constants = Constants {
            count,
            round,
            expected: round + u32::from(wrong),
        };
        let event = Event::new(device)?;
        let dispatch = |cmd: &Recorder<'_>| {
            cmd.bind_compute(compute, &constants);
            cmd.dispatch(count.div_ceil(64));
        };
        if way == Way::Submission {
            raw.submit_outside(dispatch)?;
        }
        raw.submit_behind(
            |cmd| {
                if way != Way::Submission {
                    dispatch(cmd);
                }
                if !wrong {
                    way.record(cmd, &event, written, read);
                }
            },
            |cmd| {
                cmd.bind(draw, &constants);
                cmd.draw(patches, 1, 0, 0);
            },
        )?;
        let [compared, bad, number, word] = raw.words(RESULTS)[..4] else {
            unreachable!("the buffer has four words");
        };
        context.saw(compared.into());
        check.hold(bad == 0, || {
            format!("round {round}: {bad} of {compared} words are wrong, one of them word {number}: {word:#010x}")
        });
        check.hold(compared >= count, || {
            format!("round {round}: {compared} words were compared instead of {count}")
        });
        raw.clear(RESULTS)?;
    }
    Ok(check.finish(format!("{count} words in {ROUNDS} rounds")))
}

const SOURCE: &str =
    "Vulkan, Synchronization and Cache Control; Memory Model, Availability and Visibility";

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (way, name) in Way::ALL {
        for (reader, (stage, _)) in READERS.iter().enumerate() {
            for patches in [1, 300, 8000] {
                let name = format!("compute_visibility.{name}.{stage}-{patches}_patches");
                let rule =
                    "what a compute shader stored, a later draw loads behind a memory dependency";
                let run = move |context: &Context| seen(context, way, reader, patches);
                cases.push(Case::new(name, rule, SOURCE, run));
            }
        }
    }
    cases
}
