//! Commands of a plan as the calls of its kind.

use ash::vk;

use super::{ARGUMENTS, COUNTS, Command, Plan};
use crate::conformance::raw::Recorder;

/// Records all of a plan. Buffers and, where it has some, indices are bound.
pub fn record(cmd: &Recorder<'_>, plan: &Plan) {
    if plan.kind.is_indirect() {
        record_indirect(cmd, plan);
    } else if plan.kind.is_multi() {
        record_multi(cmd, plan);
    } else {
        record_each(cmd, plan);
    }
}

/// A call a command.
fn record_each(cmd: &Recorder<'_>, plan: &Plan) {
    for command in &plan.commands {
        cmd.barrier();
        if plan.kind.has_indices() {
            cmd.draw_bound(plan.indexed_arguments(command));
            continue;
        }
        let a = plan.arguments(command);
        let (vertices, instances) = (a.vertex_count, a.instance_count);
        cmd.draw(vertices, instances, a.first_vertex, a.first_instance);
    }
}

/// With arguments, and their number, in buffers.
fn record_indirect(cmd: &Recorder<'_>, plan: &Plan) {
    let indexed = plan.kind.has_indices();
    let stride = if indexed { 20 } else { 16 };
    let count = plan.commands.len() as u32;
    let calls = if plan.together { 1 } else { u64::from(count) };
    for i in 0..calls {
        cmd.barrier();
        let (from, own) = if plan.together {
            (0, count)
        } else {
            (stride * i, 1)
        };
        if plan.kind.is_counted() {
            // There could be one more than there are.
            let number = if plan.together { 0 } else { 4 };
            cmd.draw_counted(indexed, [ARGUMENTS, COUNTS], [from, number], own + 1);
        } else {
            cmd.draw_several(indexed, ARGUMENTS, from, own);
        }
    }
}

/// With ranges in a call: all of those whose instances are the same.
fn record_multi(cmd: &Recorder<'_>, plan: &Plan) {
    let alike = |a: &Command, b: &Command| plan.together && a.instances == b.instances;
    for commands in plan.commands.chunk_by(alike) {
        cmd.barrier();
        let instances = plan.arguments(&commands[0]);
        if plan.kind.has_indices() {
            let ranges: Vec<_> = commands
                .iter()
                .map(|command| plan.indexed_arguments(command))
                .map(|a| vk::MultiDrawIndexedInfoEXT {
                    first_index: a.first_index,
                    index_count: a.index_count,
                    vertex_offset: a.vertex_offset,
                })
                .collect();
            cmd.draw_multi_bound(&ranges, instances.instance_count, instances.first_instance);
        } else {
            let ranges: Vec<_> = commands
                .iter()
                .map(|command| plan.arguments(command))
                .map(|a| vk::MultiDrawInfoEXT {
                    first_vertex: a.first_vertex,
                    vertex_count: a.vertex_count,
                })
                .collect();
            cmd.draw_multi(&ranges, instances.instance_count, instances.first_instance);
        }
    }
}
