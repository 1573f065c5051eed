//! Group `geometry`: what comes behind the tessellator.
//!
//! A geometry shader that hands triangles and lines on changes no pixel, and one with several invocations sees each triangle once in each. A seeded fault expects
//! another patch. Distances, the sizes of points, and queries have files of their own.

mod distances;
mod points;
mod queries;

use crate::conformance::coordinates::TessLevels;
use crate::conformance::modes::{Domain, Modes, Spacing, module, with_geometry_invocations};
use crate::conformance::raw::{Program, Raster, Raw};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "geometry",
    about: "geometry shaders, distances, points and queries behind the tessellator",
    cases,
    model_cases: None,
};

/// The picture's side in pixels.
const SIDE: u32 = 128;

const LEVELS: [f32; 6] = [1.0, 2.0, 3.5, 7.0, 20.0, 64.0];

fn lacks(context: &Context) -> Result<Option<Finding>> {
    let has = context.device()?.info().support.optional.geometry_shader;
    Ok((!has).then(|| Finding::skip("the device has no geometryShader")))
}

/// The picture of a patch of this number, 0 or 1, drawn by a program with `connectivity.tese`.
fn picture(
    context: &Context,
    modes: Modes,
    level: f32,
    number: u32,
    differ: impl FnOnce(Program) -> Result<Program>,
) -> Result<Vec<u32>> {
    let table = [TessLevels::uniform(level); 2];
    // No primitive is noted: there is no room.
    let sizes = [size_of_val(&table) as u64, 4];
    let mut raw = Raw::new(context.device()?, &sizes, SIDE)?;
    raw.write(0, &table)?;
    let evaluation = modes.rewrite(module("connectivity.tese")?);
    let program = Program {
        raster: Raster::Solid,
        ..Program::new(module("coordinates.tesc")?, evaluation)?
    };
    let pipeline = raw.pipeline(&differ(program)?)?;
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &0u32);
        cmd.draw(1, 1, 0, number);
    })?;
    let pixels = raw.pixels();
    context.saw(pixels.iter().filter(|&&pixel| pixel != 0).count() as u64);
    Ok(pixels)
}

fn passes_through(context: &Context, modes: Modes) -> Result<Finding> {
    if let Some(skipped) = lacks(context)? {
        return Ok(skipped);
    }
    let name = match modes.domain {
        Domain::Isolines => "connectivity-lines.geom",
        _ => "connectivity.geom",
    };
    let mut check = Check::default();
    let mut drawn = 0;
    let number = u32::from(context.is_wrong());
    for level in LEVELS {
        let without = picture(context, modes, level, 0, Ok)?;
        let with = picture(context, modes, level, number, |program| {
            Ok(Program {
                geometry: Some(module(name)?.into()),
                ..program
            })
        })?;
        let differ = without.iter().zip(&with).filter(|(a, b)| a != b).count();
        drawn += without.iter().filter(|&&pixel| pixel != 0).count();
        check.hold(differ == 0, || {
            format!("level {level}: {differ} pixels differ")
        });
    }
    Ok(check.finish(format!("{drawn} pixels at {} levels", LEVELS.len())))
}

fn invocations(context: &Context, modes: Modes, count: u32) -> Result<Finding> {
    if let Some(skipped) = lacks(context)? {
        return Ok(skipped);
    }
    let words = with_geometry_invocations(module("geometry.geom")?, count);
    let pixels = picture(context, modes, 5.0, 0, |program| {
        Ok(Program {
            constants: vec![count],
            geometry: Some(words.into()),
            ..program
        })
    })?;
    let mut check = Check::default();
    let width = SIDE / count;
    let wrong = u32::from(context.is_wrong());
    for invocation in 0..count {
        let own = |i: &usize| (*i as u32 % SIDE) / width == invocation;
        let column = (0..pixels.len()).filter(own).map(|i| pixels[i]);
        let column: Vec<u32> = column.filter(|&pixel| pixel != 0).collect();
        let all = (SIDE * width) as usize;
        let least = if modes.domain == Domain::Quads {
            all
        } else {
            all * 2 / 5
        };
        let colour = 16 * (invocation + wrong) + 1;
        let right = column.len() >= least && column.iter().all(|&pixel| pixel == colour);
        check.hold(right, || {
            format!(
                "{} of {all} pixels are drawn in column {invocation}",
                column.len()
            )
        });
    }
    let drawn = pixels.iter().filter(|&&pixel| pixel != 0).count();
    Ok(check.finish(format!("{drawn} pixels by {count} invocations")))
}

const SOURCE: &str = "Vulkan, Geometry Shading; Tessellation Evaluation Shader Output Patches";

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (domain, spacing) in Domain::ALL
        .into_iter()
        .flat_map(|domain| Spacing::ALL.map(|spacing| (domain, spacing)))
    {
        for clockwise in [false, true] {
            let modes = Modes {
                clockwise,
                ..Modes::new(domain, spacing)
            };
            let order = if clockwise { "cw" } else { "ccw" };
            let kind = format!("{}-{}-{order}", domain.name(), spacing.name());
            let name = format!("geometry.passes_through.{kind}");
            let rule = "a geometry shader that hands primitives on changes no pixel";
            let run = move |context: &Context| passes_through(context, modes);
            cases.push(Case::new(name, rule, SOURCE, run));
            if domain == Domain::Isolines {
                continue;
            }
            // As many as every device has (maxGeometryShaderInvocations).
            for count in [1, 2, 4, 8, 16, 32] {
                let name = format!("geometry.invocations.{kind}-{count}");
                let rule = "each invocation of a geometry shader sees every triangle once";
                let run = move |context: &Context| invocations(context, modes, count);
                cases.push(Case::new(name, rule, SOURCE, run));
            }
        }
    }
    cases.extend(distances::cases());
    cases.extend(points::cases());
    cases.extend(queries::cases());
    cases
}
