//! Group `draws`: what of a draw's arguments becomes patches, by every kind of draw.
//!
//! Control points that make no whole patch are dropped, draws of nothing draw nothing, and where a draw begins, how many commands one call has and how many patches a
//! command, is no matter. The shaders are those of `scale`. A seeded fault expects the patch behind the last one of each draw as well.

mod kind;
mod recording;

use std::time::Duration;

use ash::vk;

use crate::conformance::loads::{Constants, Note};
use crate::conformance::modes::module;
use crate::conformance::raw::{Program, Raster, Raw};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;
use crate::host::Device;
use kind::Kind;

/// The group.
pub const GROUP: Group = Group {
    name: "draws",
    about: "arguments of draws, and the patches that they make",
    cases,
    model_cases: None,
};

/// A command: of vertices and instances the first and how many, behind the plan's own first.
#[derive(Clone, Copy, Debug)]
struct Command {
    vertices: [u32; 2],
    instances: [u32; 2],
}

impl Command {
    /// All of the first instance from the first vertex on.
    fn of(vertices: u32) -> Command {
        Command {
            vertices: [0, vertices],
            instances: [0, 1],
        }
    }
}

/// Commands, and what their numbers mean.
#[derive(Clone, Debug)]
struct Plan {
    kind: Kind,
    control_points: u32,
    commands: Vec<Command>,
    /// All in one call, where they are indirect.
    together: bool,
    /// Where vertices, instances and indices begin.
    first_vertex: u32,
    first_instance: u32,
    first_index: u32,
    short_indices: bool,
}

impl Plan {
    fn new(kind: Kind, control_points: u32, commands: Vec<Command>) -> Plan {
        Plan {
            kind,
            control_points,
            commands,
            together: false,
            first_vertex: 0,
            first_instance: 0,
            first_index: 0,
            short_indices: false,
        }
    }

    /// Patches an instance, with room for one behind the last.
    fn per_instance(&self) -> u32 {
        let end = |command: &Command| command.vertices[0] + command.vertices[1];
        let most = self.commands.iter().map(end).max().unwrap_or(0);
        most / self.control_points + 1
    }

    fn instances(&self) -> u32 {
        let end = |command: &Command| command.instances[0] + command.instances[1];
        self.commands.iter().map(end).max().unwrap_or(0).max(1)
    }

    /// How often each patch is drawn. `more` are patches beyond the end.
    fn drawn(&self, more: u32) -> Vec<u32> {
        let per_instance = self.per_instance();
        let mut drawn = vec![0; (per_instance * self.instances()) as usize];
        for Command {
            vertices: [first, count],
            instances: [instance, instances],
        } in &self.commands
        {
            for instance in *instance..instance + instances {
                let start = instance * per_instance + first / self.control_points;
                let end = start + count / self.control_points + more;
                let own = start as usize..(end as usize).min(drawn.len());
                drawn[own].iter_mut().for_each(|count| *count += 1);
            }
        }
        drawn
    }

    fn arguments(&self, command: &Command) -> vk::DrawIndirectCommand {
        vk::DrawIndirectCommand {
            vertex_count: command.vertices[1],
            instance_count: command.instances[1],
            first_vertex: self.first_vertex + command.vertices[0],
            first_instance: self.first_instance + command.instances[0],
        }
    }

    /// Index i is i: so what a command begins with stands in the offset, or in the first index.
    fn indexed_arguments(&self, command: &Command) -> vk::DrawIndexedIndirectCommand {
        vk::DrawIndexedIndirectCommand {
            index_count: command.vertices[1],
            instance_count: command.instances[1],
            first_index: self.first_index + command.vertices[0],
            vertex_offset: self.first_vertex as i32 - self.first_index as i32,
            first_instance: self.first_instance + command.instances[0],
        }
    }

    /// What the device lacks for it.
    fn lacks(&self, context: &Context) -> Result<Option<&'static str>> {
        let needs = self.kind.is_indirect()
            && (self.together && self.commands.len() > 1
                || self.first_instance > 0
                || self.commands.iter().any(|command| command.instances[0] > 0));
        let has = context
            .device()?
            .info()
            .support
            .optional
            .multi_draw_indirect;
        if needs && !has {
            return Ok(Some("multiDrawIndirect or drawIndirectFirstInstance"));
        }
        let extra = self.device(context)?.extra();
        Ok(match self.kind {
            _ if self.kind.is_multi() && !extra.multi_draw => Some("multiDraw"),
            _ if self.kind.is_counted() && !extra.draw_indirect_count => Some("drawIndirectCount"),
            _ => None,
        })
    }

    /// The device that has what its calls need.
    fn device<'a>(&self, context: &'a Context) -> Result<&'a Device> {
        if self.kind.is_multi() || self.kind.is_counted() {
            context.full_device()
        } else {
            context.device()
        }
    }

    /// What stands behind the commands of a draw whose number is in a buffer: the patch that is drawn by nobody.
    fn beyond(&self) -> Command {
        Command {
            vertices: [
                (self.per_instance() - 1) * self.control_points,
                self.control_points,
            ],
            instances: [0, 1],
        }
    }

    /// Words of the arguments of all commands.
    fn argument_words(&self) -> Vec<u32> {
        let words = |command: &Command| -> Vec<u32> {
            if self.kind.has_indices() {
                let a = self.indexed_arguments(command);
                let offset = a.vertex_offset as u32;
                vec![
                    a.index_count,
                    a.instance_count,
                    a.first_index,
                    offset,
                    a.first_instance,
                ]
            } else {
                let a = self.arguments(command);
                vec![
                    a.vertex_count,
                    a.instance_count,
                    a.first_vertex,
                    a.first_instance,
                ]
            }
        };
        let beyond = self.kind.is_counted().then(|| self.beyond());
        self.commands
            .iter()
            .chain(&beyond)
            .flat_map(words)
            .collect()
    }

    /// The indices, two in a word where they are short.
    fn index_words(&self) -> Vec<u32> {
        let count = self.first_index + self.per_instance() * self.control_points;
        if self.short_indices {
            let pair = |i: u32| (2 * i) & 0xffff | (2 * i + 1) << 16;
            (0..count.div_ceil(2)).map(pair).collect()
        } else {
            (0..count).collect()
        }
    }
}

const NOTES: usize = 0;
const INDICES: usize = 1;
const ARGUMENTS: usize = 2;
const COUNTS: usize = 3;

fn arrives(context: &Context, plan: &Plan) -> Result<Finding> {
    if let Some(lacking) = plan.lacks(context)? {
        return Ok(Finding::skip(format!("the device has no {lacking}")));
    }
    let more = u32::from(context.is_wrong());
    let drawn = plan.drawn(more);
    let indices = if plan.kind.has_indices() {
        plan.index_words()
    } else {
        Vec::new()
    };
    // One patch at the end, drawn by itself, tells that anything is drawn at all.
    let patches = drawn.len() as u32 + 1;
    let arguments = plan.argument_words();
    let bytes = |words: usize| 4 * words.max(1) as u64;
    let sizes = [
        u64::from(patches) * size_of::<Note>() as u64,
        bytes(indices.len()),
        bytes(arguments.len()),
        bytes(2),
    ];
    let mut raw = Raw::new(plan.device(context)?, &sizes, 16)?;
    raw.write(INDICES, &indices)?;
    raw.write(ARGUMENTS, &arguments)?;
    raw.write(COUNTS, &[plan.commands.len() as u32, 1])?;
    let pipeline = raw.pipeline(&Program {
        control_points: plan.control_points,
        constants: vec![plan.control_points],
        raster: Raster::Discard,
        ..Program::new(module("scale.tesc")?, module("scale.tese")?)?
    })?;
    let mut constants = Constants {
        per_instance: plan.per_instance(),
        patches,
        first_vertex: plan.first_vertex,
        first_instance: plan.first_instance,
        columns: 1,
        side: 0.0,
        level: 1.0,
    };
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &constants);
        if plan.kind.has_indices() {
            let short = plan.short_indices;
            let kind = if short {
                vk::IndexType::UINT16
            } else {
                vk::IndexType::UINT32
            };
            cmd.bind_indices(INDICES, kind);
        }
        recording::record(cmd, plan);
        cmd.barrier();
        constants.first_vertex = 0;
        constants.first_instance = 0;
        constants.per_instance = 1;
        cmd.bind(pipeline, &constants);
        cmd.draw(plan.control_points, 1, 0, patches - 1);
    })?;
    let notes: &[Note] = bytemuck::cast_slice(raw.words(NOTES));
    context.saw(notes.iter().map(|note| u64::from(note.evaluations)).sum());
    let mut check = Check::default();
    for (patch, (note, &times)) in notes
        .iter()
        .zip(drawn.iter().chain(&[1 + more]))
        .enumerate()
    {
        // A quad of level 1 has four vertices, each of which may be evaluated more than once.
        let right = if times == 0 {
            note.controls == 0 && note.evaluations == 0
        } else {
            note.controls >= times && note.evaluations >= 4 * times && note.bad_points == 0
        };
        check.hold(right, || {
            format!(
                "patch {patch} is drawn {times} times: {} control shader runs, {} evaluations, {} points of other patches",
                note.controls, note.evaluations, note.bad_points
            )
        });
    }
    let count: u32 = drawn.iter().sum();
    Ok(check.finish(format!(
        "{count} patches in {} commands",
        plan.commands.len()
    )))
}

const SOURCE: &str =
    "Vulkan, Drawing Commands; Patch Lists: vertices that make no whole patch are discarded";

fn case(name: String, rule: &'static str, plan: Plan) -> Case {
    Case::new(format!("draws.{name}"), rule, SOURCE, move |context| {
        arrives(context, &plan)
    })
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for kind in Kind::ALL {
        cases.extend(remainders(kind));
        cases.extend(empty(kind));
        cases.extend(beginnings(kind));
        cases.extend(instances(kind));
        cases.extend(many(kind));
        if kind.has_indices() {
            cases.extend(indices(kind));
        }
        if kind.is_indirect() || kind.is_multi() {
            cases.extend(several(kind));
        }
    }
    cases
}

fn remainders(kind: Kind) -> impl Iterator<Item = Case> {
    let sizes = [2, 3, 4, 16, 32].into_iter();
    let sizes = sizes.flat_map(|points| [0, 1, 9].map(move |patches| (points, patches)));
    let sizes =
        sizes.flat_map(|(points, patches)| [1, points - 1].map(|more| (points, patches, more)));
    let sizes = sizes.filter(|(points, _, more)| *points > 2 || *more == 1);
    let mut before = None;
    let sizes = sizes.filter(move |size| before.replace(*size) != Some(*size));
    sizes.map(move |(points, patches, more)| {
        let name = format!(
            "remainder.{}-{points}_points-{patches}_patches-{more}_more",
            kind.name()
        );
        let rule = "control points that make no whole patch are dropped, in each instance";
        let command = Command {
            instances: [0, 2],
            ..Command::of(points * patches + more)
        };
        case(name, rule, Plan::new(kind, points, vec![command]))
    })
}

fn empty(kind: Kind) -> [Case; 4] {
    let some = Command::of(12);
    let nothing = [
        ("no_vertices", Command::of(0)),
        (
            "no_instances",
            Command {
                instances: [0, 0],
                ..some
            },
        ),
        (
            "neither",
            Command {
                instances: [0, 0],
                ..Command::of(0)
            },
        ),
        ("too_few", Command::of(2)),
    ];
    nothing.map(|(what, command)| {
        let name = format!("empty.{}-{what}", kind.name());
        let rule = "a draw of nothing draws nothing, and those beside it are whole";
        case(name, rule, Plan::new(kind, 3, vec![some, command, some]))
    })
}

fn beginnings(kind: Kind) -> impl Iterator<Item = Case> {
    let firsts = [0, 4, 1000, 1_000_000].into_iter();
    let firsts = firsts.flat_map(|vertex| [0, 1, 70_000].map(|instance| (vertex, instance)));
    firsts.map(move |(vertex, instance)| {
        let name = format!("first.{}-vertex_{vertex}-instance_{instance}", kind.name());
        let rule = "gl_VertexIndex and gl_InstanceIndex begin where the draw does";
        let command = Command {
            instances: [0, 3],
            ..Command::of(4 * 7)
        };
        let plan = Plan {
            first_vertex: vertex,
            first_instance: instance,
            ..Plan::new(kind, 4, vec![command])
        };
        case(name, rule, plan)
    })
}

fn instances(kind: Kind) -> impl Iterator<Item = Case> {
    let sizes = [1, 2, 3, 64, 1000, 5000].into_iter();
    let sizes = sizes.flat_map(|instances| [1, 5].map(|patches| (instances, patches)));
    sizes.map(move |(instances, patches)| {
        let name = format!("instances.{}-{instances}_of_{patches}", kind.name());
        let rule = "each instance has all patches";
        let command = Command {
            instances: [0, instances],
            ..Command::of(3 * patches)
        };
        case(name, rule, Plan::new(kind, 3, vec![command]))
    })
}

/// Beyond 128 Ki patches a draw; MoltenVK once dropped those of indirect draws.
fn many(kind: Kind) -> [Case; 4] {
    [65_535, 131_072, 131_073, 200_000].map(|patches| {
        let name = format!("many.{}-{patches}_patches", kind.name());
        let rule = "every patch of a draw is processed, whatever their number";
        let plan = Plan::new(kind, 1, vec![Command::of(patches)]);
        case(name, rule, plan).within(Duration::from_secs(120))
    })
}

fn indices(kind: Kind) -> impl Iterator<Item = Case> {
    let firsts = [0, 4, 20_000].into_iter();
    let firsts = firsts.flat_map(|index| [0, 40_000].map(|vertex| (index, vertex)));
    let all = firsts.flat_map(|(index, vertex)| [true, false].map(|short| (index, vertex, short)));
    all.map(move |(index, vertex, short)| {
        let bits = if short { 16 } else { 32 };
        let name = format!(
            "index.{}-{bits}_bits-from_{index}-vertex_{vertex}",
            kind.name()
        );
        let rule = "indices are taken from the first on, and the offset is added to them";
        let command = Command {
            instances: [0, 2],
            ..Command::of(4 * 11)
        };
        let plan = Plan {
            first_index: index,
            first_vertex: vertex,
            short_indices: short,
            ..Plan::new(kind, 4, vec![command])
        };
        case(name, rule, plan)
    })
}

fn several(kind: Kind) -> impl Iterator<Item = Case> {
    let counts = [0, 1, 2, 3, 17, 500].into_iter();
    let counts = counts.flat_map(|count| [true, false].map(|together| (count, together)));
    counts.map(move |(count, together)| {
        let how = if together { "together" } else { "one_by_one" };
        let name = format!("several.{}-{count}_commands-{how}", kind.name());
        let rule = "each command of several in a call draws what it says, and no other is drawn";
        let command = |i: u32| Command {
            vertices: [3 * (i % 7), 3 * (1 + i % 3) + i % 2],
            instances: if kind.is_multi() {
                [2, 3]
            } else {
                [i % 5, 1 + i % 2]
            },
        };
        let plan = Plan {
            together,
            ..Plan::new(kind, 3, (0..count).map(command).collect())
        };
        case(name, rule, plan)
    })
}
