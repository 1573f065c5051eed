//! Group `primitive_id`: the number of a primitive behind the tessellator, in geometry and fragment shaders.
//!
//! Vulkan counts in a geometry shader "the number of primitives presented as input to the shader since the current set of rendering primitives was started"; what drivers
//! give behind a tessellator is that, or the number of the patch, as Direct3D has it. Both pass, and which it is is told; anything else, or
//! a mixture, fails. What a geometry shader writes has no such freedom. A seeded fault expects the next number.

use std::collections::BTreeSet;

use crate::conformance::loads::{Kind, Load, draw_with};
use crate::conformance::modes::module;
use crate::conformance::raw::Program;
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "primitive_id",
    about: "numbers of primitives behind the tessellator",
    cases,
    model_cases: None,
};

/// Who sees the number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The fragment shader, without a geometry shader.
    Fragment,
    /// The geometry shader.
    Geometry,
    /// The fragment shader, behind a geometry shader that hands its own number on.
    HandedOn,
    /// The same, with a number that is made of the patch's.
    Written,
}

impl Stage {
    const ALL: [Stage; 4] = [
        Stage::Fragment,
        Stage::Geometry,
        Stage::HandedOn,
        Stage::Written,
    ];

    fn name(self) -> &'static str {
        match self {
            Stage::Fragment => "fragment",
            Stage::Geometry => "geometry",
            Stage::HandedOn => "handed_on",
            Stage::Written => "written",
        }
    }

    /// What stands in which stage of the pipeline.
    fn of(self, program: Program) -> Result<Program> {
        // Constant 1 of the geometry shader: whether it makes a number of the patch's.
        let mut constants = program.constants.clone();
        constants.push(u32::from(self == Stage::Written));
        let geometry = match self {
            Stage::Fragment => None,
            _ => Some(module("primitive_id.geom")?.into()),
        };
        let fragment = match self {
            Stage::Geometry => "primitive_id-geometry.frag",
            _ => "primitive_id.frag",
        };
        Ok(Program {
            constants,
            geometry,
            fragment: module(fragment)?,
            ..program
        })
    }
}

/// What the geometry shader makes of a patch's number. Twin of `made` in `glsl/conformance/primitive_id.geom`.
fn made(patch: u32) -> u32 {
    7 * patch + 3
}

fn numbers(context: &Context, load: Load, stage: Stage) -> Result<Finding> {
    // A fragment shader's number needs the feature too (Vulkan, Built-In Variables, PrimitiveId).
    if !context.device()?.info().support.optional.geometry_shader {
        return Ok(Finding::skip("the device has no geometryShader"));
    }
    let traces = draw_with(context, load, |program| stage.of(program))?;
    let triangles = 2 * load.level * load.level;
    let wrong = u32::from(context.is_wrong());
    let (mut of_patch, mut counted) = (Check::default(), Check::default());
    // A seeded fault leaves out the last patch.
    for patch in 0..load.patches - wrong {
        let colours = traces.colours(load, patch);
        let found: BTreeSet<u32> = colours.into_iter().map(|colour| colour - 1).collect();
        let number = load.primitive(patch) + wrong;
        let told = |right: String| format!("patch {patch} has {found:?} instead of {right}");
        let one = match stage {
            Stage::Written => made(patch + wrong),
            _ => number,
        };
        of_patch.hold(found.iter().eq([&one]), || told(format!("{one}")));
        let own = triangles * number..triangles * (number + 1);
        let inside = found.len() == triangles as usize && found.iter().all(|id| own.contains(id));
        counted.hold(inside, || told(format!("{triangles} from {own:?}")));
    }
    if stage == Stage::Written {
        return Ok(of_patch.finish(format!("{} patches", load.patches)));
    }
    let is_of_patch = of_patch.finish(format!("{} patches, numbers of patches", load.patches));
    let is_counted = counted.finish(format!("{} patches, numbers of triangles", load.patches));
    Ok(if is_counted.is_pass() {
        is_counted
    } else {
        is_of_patch
    })
}

/// Patches and control points: few, and on both sides of where known drivers cut draws.
const SIZES: [(u32, u32); 8] = [
    (1, 1),
    (7, 3),
    (100, 1),
    (64, 32),
    (1023, 1),
    (1025, 1),
    (257, 16),
    (4097, 1),
];

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (stage, kind) in Stage::ALL
        .into_iter()
        .flat_map(|stage| Kind::ALL.map(|kind| (stage, kind)))
    {
        for ((patches, control_points), level) in SIZES
            .into_iter()
            .flat_map(|size| [1, 3].map(|level| (size, level)))
        {
            let load = Load {
                kind,
                patches,
                level,
                control_points,
                first: 0,
            };
            let name = format!(
                "primitive_id.{}.{}-{patches}_patches-{control_points}_points-level_{level}",
                stage.name(),
                kind.name()
            );
            let rule = match stage {
                Stage::Written => {
                    "the fragment shader has the number that the geometry shader wrote"
                }
                _ => {
                    "primitives behind the tessellator are numbered by their patches, or one after the other, from 0 in each instance"
                }
            };
            let source = "Vulkan, Built-In Variables, PrimitiveId";
            let run = move |context: &Context| numbers(context, load, stage);
            cases.push(Case::new(name, rule, source, run));
        }
    }
    cases
}
