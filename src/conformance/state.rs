//! Group `state`: draws of one submission with pipelines of other domains, spacings, patch sizes, or without patches; made and recorded in several ways.
//!
//! Each draw has a cell of the picture, and must leave there what it leaves when it is alone. A seeded fault compares with the next one's. Several views at once have a
//! file of their own.

mod views;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use ash::vk;

use crate::conformance::modes::{Domain, Modes, Spacing, module};
use crate::conformance::random::Random;
use crate::conformance::raw::{Assembly, Drawing, Objects, Program, Raw, Recorder};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;
use crate::gpu::ExtraFeatures;
use crate::host::Device;

/// The group.
pub const GROUP: Group = Group {
    name: "state",
    about: "switches of pipelines between draws",
    cases,
    model_cases: None,
};

/// Push constants. Twin of `Draw` in `glsl/conformance/state.glsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Constants {
    number: u32,
    columns: u32,
    level: f32,
}

// As `tests/layout.rs` holds the shaders to.
const _: () = assert!(size_of::<Constants>() == 4 * 3);

/// A pipeline: patches of so many points, or triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum State {
    Triangles,
    Patches {
        domain: usize,
        spacing: usize,
        points: u32,
    },
}

impl State {
    /// Every domain and spacing, and none.
    fn all() -> Vec<State> {
        let patches = (0..9).map(|number| State::Patches {
            domain: number / 3,
            spacing: number % 3,
            points: 1,
        });
        patches.chain([State::Triangles]).collect()
    }

    fn name(self) -> String {
        match self {
            State::Triangles => "no_patches".into(),
            State::Patches {
                domain,
                spacing,
                points,
            } => {
                let (domain, spacing) = (Domain::ALL[domain].name(), Spacing::ALL[spacing].name());
                match points {
                    1 => format!("{domain}_{spacing}"),
                    _ => format!("{domain}_{spacing}_{points}"),
                }
            }
        }
    }

    fn points(self) -> u32 {
        match self {
            State::Triangles => 0,
            State::Patches { points, .. } => points,
        }
    }

    fn program(self, assembly: Assembly) -> Result<Program> {
        let State::Patches {
            domain,
            spacing,
            points,
        } = self
        else {
            let none: &'static [u32] = &[];
            return Ok(Program {
                vertex: module("state.vert")?,
                tessellation: None,
                constants: vec![0],
                assembly,
                ..Program::new(none, none)?
            });
        };
        let modes = Modes::new(Domain::ALL[domain], Spacing::ALL[spacing]);
        let evaluation = modes.rewrite(module("state.tese")?);
        Ok(Program {
            vertex: module("state.vert")?,
            control_points: points,
            constants: vec![points],
            assembly,
            ..Program::new(module("state.tesc")?, evaluation)?
        })
    }
}

/// The picture's side in pixels, and its cells in a row.
const SIDE: u32 = 64;
const COLUMNS: u32 = 4;
const MOST: usize = (COLUMNS * COLUMNS) as usize;
const LEVEL: f32 = 3.5;

/// What draws leave: of each the runs of the last stage, the points of a patch, and the pixels of its cell that are drawn.
type Left = Vec<[u32; 3]>;

/// Where draws are recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Recording {
    /// In a render pass, one after the other.
    Pass,
    /// Each in a secondary command buffer.
    Secondary,
    /// Each in a dynamic rendering of its own.
    Renderings,
}

/// What shaders are bound as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bound {
    Pipelines,
    /// Shader objects, each made by itself.
    Objects,
    /// The same, made together.
    LinkedObjects,
    /// By turns.
    Both,
}

/// How pipelines are made and draws recorded.
#[derive(Clone, Copy)]
struct Way {
    name: &'static str,
    assembly: Assembly,
    recording: Recording,
    bound: Bound,
    rule: &'static str,
    /// What the device must have.
    has: fn(&Device, &ExtraFeatures) -> bool,
}

const PLAIN: Way = Way {
    name: "",
    assembly: Assembly::Whole,
    recording: Recording::Pass,
    bound: Bound::Pipelines,
    rule: "a draw leaves what it leaves when it is alone, whatever pipelines were bound before",
    has: |_, _| true,
};

const OBJECTS: Way = Way {
    name: "objects",
    recording: Recording::Renderings,
    bound: Bound::Objects,
    rule: "shaders that are bound one by one draw what a pipeline of them draws",
    has: |device, extra| extra.shader_objects && device.info().support.optional.dynamic_rendering,
    ..PLAIN
};

const WAYS: [Way; 8] = [
    Way {
        name: "dynamic_points",
        assembly: Assembly::DynamicPatchSize,
        rule: "patches have as many control points as the draw says, not the pipeline",
        has: |_, extra| extra.dynamic_patch_size,
        ..PLAIN
    },
    Way {
        name: "linked",
        assembly: Assembly::Linked,
        rule: "a pipeline that is linked from parts draws what one draws that was made at once",
        has: |_, extra| extra.pipeline_libraries,
        ..PLAIN
    },
    Way {
        name: "optimised",
        assembly: Assembly::Optimised,
        rule: "the same when it is optimised as it is linked",
        has: |_, extra| extra.pipeline_libraries,
        ..PLAIN
    },
    Way {
        name: "secondary",
        recording: Recording::Secondary,
        rule: "a draw in a secondary command buffer leaves what it leaves in the primary one",
        ..PLAIN
    },
    Way {
        name: "rendering",
        recording: Recording::Renderings,
        rule: "dynamic rendering leaves what a render pass leaves",
        has: |device, _| device.info().support.optional.dynamic_rendering,
        ..PLAIN
    },
    OBJECTS,
    Way {
        name: "objects_linked",
        bound: Bound::LinkedObjects,
        ..OBJECTS
    },
    Way {
        name: "objects_and_pipelines",
        bound: Bound::Both,
        rule: "pipelines and shaders that are bound one by one leave nothing for each other",
        ..OBJECTS
    },
];

/// What a draw binds.
enum Made {
    Pipeline(vk::Pipeline),
    Objects(Box<Objects>),
}

impl Way {
    /// Makes what a state is drawn with. `turn` counts the states.
    fn make(self, raw: &mut Raw<'_>, state: State, turn: usize) -> Result<Made> {
        let program = state.program(self.assembly)?;
        let linked = match self.bound {
            Bound::Objects => false,
            Bound::LinkedObjects => true,
            Bound::Both if turn.is_multiple_of(2) => false,
            Bound::Pipelines | Bound::Both => return raw.pipeline(&program).map(Made::Pipeline),
        };
        let objects = raw.objects(&program, linked)?;
        Ok(Made::Objects(Box::new(objects)))
    }

    /// Draws that are alone, or in a pass, wait for each other by a barrier in it.
    fn record(self, cmd: &Recorder<'_>, made: &Made, state: State, place: usize) {
        let constants = Constants {
            number: place as u32,
            columns: COLUMNS,
            level: LEVEL,
        };
        if self.recording != Recording::Renderings {
            cmd.barrier();
        }
        match made {
            Made::Pipeline(pipeline) => cmd.bind(*pipeline, &constants),
            Made::Objects(objects) => cmd.bind_objects(objects, &constants),
        }
        if self.assembly == Assembly::DynamicPatchSize && state.points() > 0 {
            cmd.patch_size(state.points());
        }
        let vertices = if state.points() == 0 {
            6
        } else {
            state.points()
        };
        cmd.draw(vertices, 1, 0, 0);
    }
}

/// Draws some of the states, each by its place among all of them.
fn draw(context: &Context, way: Way, states: &[State], which: &[usize]) -> Result<Left> {
    let device = match (way.assembly, way.bound) {
        (Assembly::Whole, Bound::Pipelines) => context.device()?,
        _ => context.full_device()?,
    };
    let sizes = [8 * MOST as u64];
    let mut raw = match way.recording {
        Recording::Renderings => Raw::drawing(device, &sizes, SIDE, Drawing::Rendering(0))?,
        _ => Raw::new(device, &sizes, SIDE)?,
    };
    let mut all = BTreeMap::new();
    for (turn, &place) in which.iter().enumerate() {
        let state = states[place];
        if let Entry::Vacant(entry) = all.entry(state) {
            entry.insert(way.make(&mut raw, state, turn)?);
        }
    }
    let record = |cmd: &Recorder<'_>, i: usize| {
        let state = states[which[i]];
        way.record(cmd, &all[&state], state, which[i]);
    };
    match way.recording {
        Recording::Pass => raw.submit(None, |cmd| {
            for i in 0..which.len() {
                record(cmd, i);
            }
        })?,
        Recording::Secondary => raw.submit_secondary(which.len(), record)?,
        Recording::Renderings => raw.submit_renderings(which.len(), record)?,
    }
    let (counts, pixels) = (raw.words(0), raw.pixels());
    context.saw(pixels.iter().filter(|&&pixel| pixel != 0).count() as u64);
    let cell = SIDE / COLUMNS;
    let drawn = |place: u32| {
        let (x, y) = (place % COLUMNS * cell, place / COLUMNS * cell);
        let own = (0..cell * cell).map(|i| pixels[((y + i / cell) * SIDE + x + i % cell) as usize]);
        own.filter(|&pixel| pixel == place + 1).count() as u32
    };
    let left = |place: usize| {
        let [runs, points] = [counts[2 * place], counts[2 * place + 1]];
        [runs, points, drawn(place as u32)]
    };
    Ok((0..states.len()).map(left).collect())
}

fn switches(context: &Context, way: Way, states: &[State]) -> Result<Finding> {
    let device = context.device()?;
    if !(way.has)(device, &device.possible()?) {
        return Ok(Finding::skip(format!(
            "the device has nothing for {}",
            way.name
        )));
    }
    let mut check = Check::default();
    let all: Vec<usize> = (0..states.len()).collect();
    let together = draw(context, way, states, &all)?;
    for (place, state) in states.iter().enumerate() {
        // Alone it is as plain as can be.
        let alone = draw(context, PLAIN, states, &[place])?;
        let shift = usize::from(context.is_wrong());
        let [found, right] = [together[(place + shift) % states.len()], alone[place]];
        // Shaders may run more often than once a vertex.
        let same = found[0] >= right[0] && found[1..] == right[1..] && right[0] > 0;
        let points = state.points() == right[1];
        check.hold(same && points, || {
            let name = state.name();
            format!("draw {place}, {name}: runs, points and pixels are {found:?}, and {right:?} when it is alone")
        });
    }
    let pixels: u32 = together.iter().map(|left| left[2]).sum();
    Ok(check.finish(format!("{} draws, {pixels} pixels", states.len())))
}

const SOURCE: &str = "Vulkan, Pipelines, Binding; Fundamentals, Queue Operation: draws are independent of those before";

fn case(name: String, way: Way, states: Vec<State>) -> Case {
    let name = format!("state.{name}");
    Case::new(name, way.rule, SOURCE, move |context| {
        switches(context, way, &states)
    })
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let all = State::all();
    for (i, &a) in all.iter().enumerate() {
        // Both orders are in it.
        for &b in &all[i + 1..] {
            let name = format!("domains.{}-{}", a.name(), b.name());
            cases.push(case(name, PLAIN, vec![a, b, a, b]));
        }
    }
    let sizes = [1, 2, 3, 4, 16, 31, 32].map(|points| State::Patches {
        domain: 1,
        spacing: 0,
        points,
    });
    for (i, &a) in sizes.iter().enumerate() {
        for &b in &sizes[i + 1..] {
            let name = format!("points.{}-{}", a.points(), b.points());
            cases.push(case(name, PLAIN, vec![a, b, a, b]));
        }
        let name = format!("points.{}-none", a.points());
        cases.push(case(name, PLAIN, vec![a, State::Triangles, a]));
    }
    for number in 0..20 {
        let name = format!("mixed.{number}");
        // Which states a case has is part of its name: the seed does not change it.
        let mut random = Random::new(0, &name);
        let state = |_| match *random.one_of(&all) {
            State::Triangles => State::Triangles,
            State::Patches {
                domain, spacing, ..
            } => State::Patches {
                domain,
                spacing,
                points: 1 + random.below(32),
            },
        };
        let states: Vec<State> = (0..12).map(state).collect();
        for way in WAYS {
            let name = format!("{}.{number}", way.name);
            cases.push(case(name, way, states.clone()));
        }
        cases.push(case(name, PLAIN, states));
    }
    cases.extend(views::cases());
    cases
}
