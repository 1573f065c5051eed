//! Group `scale`: many patches in a draw, across the sizes at which drivers cut draws into batches of their own.
//!
//! Raw draws, hence without any workaround: this group is to find the faults that the workarounds are for. A seeded fault draws one
//! patch less than is expected.

use std::time::Duration;

use crate::conformance::loads::{Kind, Load, SIDE, Traces, draw};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "scale",
    about: "many patches in a draw, of every kind of draw",
    cases,
    model_cases: None,
};

/// Every patch arrives, with all of its vertices, and is drawn.
fn complete(context: &Context, load: Load) -> Result<Finding> {
    let Traces { notes, pixels } = draw(context, load)?;
    let mut check = Check::default();
    let vertices = (load.level + 1).pow(2);
    for (patch, note) in notes.iter().enumerate() {
        check.hold(note.evaluations >= vertices, || {
            format!(
                "patch {patch} has {} vertices instead of {vertices}",
                note.evaluations
            )
        });
    }
    let (cell, columns) = (load.cell(), load.columns());
    let (mut empty, mut all) = (0, 0);
    for patch in 0..load.patches {
        let (x, y) = (patch % columns * cell, patch / columns * cell);
        for (i, j) in (0..cell).flat_map(|j| (0..cell).map(move |i| (i, j))) {
            let pixel = pixels[((y + j) * SIDE + x + i) as usize];
            all += 1;
            empty += u32::from(pixel == 0);
            check.hold(pixel == patch + 1, || match pixel {
                0 => format!("patch {patch} has empty pixels"),
                other => format!("patch {} is drawn in the place of {patch}", other - 1),
            });
        }
    }
    Ok(check.finish(format!(
        "{} patches, {} vertices, {empty} of {all} pixels empty",
        load.patches,
        load.patches * vertices
    )))
}

/// gl_PrimitiveID counts the patches of a draw.
fn primitive_id(context: &Context, load: Load, evaluation: bool) -> Result<Finding> {
    let Traces { notes, .. } = draw(context, load)?;
    let mut check = Check::default();
    let mut restarts = 0;
    for (patch, note) in (0..).zip(&notes) {
        let (high, low) = if evaluation {
            (note.evaluation_high, note.evaluation_low)
        } else {
            (note.control_high, note.control_low)
        };
        let right = load.primitive(patch);
        restarts += u32::from(high == 1 && right != 0);
        check.hold(high == right + 1 && !low == right, || match high {
            0 => format!("patch {patch} never arrived"),
            high => format!(
                "patch {patch} has a number from {} to {} instead of {right}",
                !low,
                high - 1
            ),
        });
    }
    Ok(check.finish(format!(
        "{} patches, the number starts again {restarts} times",
        load.patches
    )))
}

/// gl_VertexIndex and gl_InstanceIndex are the vertex's and the instance's own.
fn vertex_index(context: &Context, load: Load) -> Result<Finding> {
    let Traces { notes, .. } = draw(context, load)?;
    let mut check = Check::default();
    for (patch, note) in notes.iter().enumerate() {
        check.hold(note.controls > 0 && note.bad_points == 0, || {
            format!(
                "patch {patch}: {} control shader runs, {} points of other patches",
                note.controls, note.bad_points
            )
        });
    }
    Ok(check.finish(format!(
        "{} patches of {} points from {}",
        load.patches, load.control_points, load.first
    )))
}

/// Patches, levels and control points. A draw's batches in known drivers hold 4096 or 1024 control points, and 65,536 vertices is where 16 bits
/// end: on both sides of these, and where they meet.
const VERTICES: [(u32, u32, u32); 18] = [
    (1023, 1, 1),
    (1025, 1, 1),
    (4095, 1, 1),
    (4097, 1, 1),
    (65_535, 1, 1),
    (65_537, 1, 1),
    (4096, 3, 1),
    (4096, 4, 1),
    (1024, 7, 1),
    (1024, 8, 1),
    (1024, 7, 4),
    (1024, 8, 4),
    (15, 64, 1),
    (16, 64, 1),
    (32, 64, 1),
    (256, 16, 16),
    (128, 22, 32),
    (33, 64, 32),
];

/// Patches and control points.
const PRIMITIVES: [(u32, u32); 8] = [
    (1024, 1),
    (1025, 1),
    (4096, 1),
    (4097, 1),
    (65_537, 1),
    (1025, 4),
    (257, 16),
    (129, 32),
];

/// Patches, control points, and where they begin.
const INDICES_CASES: [(u32, u32, u32); 5] = [
    (1025, 1, 0),
    (4097, 1, 1000),
    (65_537, 1, 7),
    (1025, 4, 70_000),
    (257, 32, 3),
];

const DRAWING: &str = "Vulkan, Programmable Primitive Shading and Patch Lists: every patch of a draw is processed, whatever their number";
const PRIMITIVE_ID: &str = "Vulkan, Built-In Variables, PrimitiveId";
const VERTEX_INDEX: &str = "Vulkan, Built-In Variables, VertexIndex and InstanceIndex";

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for kind in Kind::ALL {
        for (patches, level, control_points) in VERTICES {
            let load = Load {
                kind,
                patches,
                level,
                control_points,
                first: 0,
            };
            let name = format!(
                "scale.vertices_per_batch.{}-{patches}_patches-level_{level}-{control_points}_points",
                kind.name()
            );
            let rule = "every patch arrives with all of its vertices and is drawn";
            let case = Case::new(name, rule, DRAWING, move |context| complete(context, load));
            // Where a driver takes run-away time, there is no use in waiting for long.
            cases.push(case.within(Duration::from_secs(40)));
        }
        for (patches, control_points) in PRIMITIVES {
            cases.extend(primitive_cases(kind, patches, control_points));
        }
        for (patches, control_points, first) in INDICES_CASES {
            let load = Load {
                kind,
                patches,
                level: 1,
                control_points,
                first,
            };
            let name = format!(
                "scale.vertex_index.{}-{patches}_patches-{control_points}_points-from_{first}",
                kind.name()
            );
            let rule = "gl_VertexIndex and gl_InstanceIndex tell the patch";
            let run = move |context: &Context| vertex_index(context, load);
            cases.push(Case::new(name, rule, VERTEX_INDEX, run));
        }
    }
    cases
}

fn primitive_cases(kind: Kind, patches: u32, control_points: u32) -> [Case; 2] {
    let load = Load {
        kind,
        patches,
        level: 1,
        control_points,
        first: 0,
    };
    [("control", false), ("evaluation", true)].map(|(stage, evaluation)| {
        let name = format!(
            "scale.primitive_id.{stage}-{}-{patches}_patches-{control_points}_points",
            kind.name()
        );
        let rule = "gl_PrimitiveID counts the patches of a draw, from 0 in each instance";
        Case::new(name, rule, PRIMITIVE_ID, move |context| {
            primitive_id(context, load, evaluation)
        })
    })
}
