//! Queries about samples of tessellated draws.

use crate::conformance::connectivity::captured_twice;
use crate::conformance::coordinates::TessLevels;
use crate::conformance::modes::{Domain, Modes, Spacing, module};
use crate::conformance::raw::{Feedback, Program, Raw};
use crate::conformance::{Case, Check, Context, Finding};
use crate::error::Result;

/// The picture's side in pixels.
const SIDE: u32 = 128;

/// A seeded fault expects one sample more.
fn samples(context: &Context, modes: Modes) -> Result<Finding> {
    let device = context.full_device()?;
    if !device.extra().precise_occlusion {
        return Ok(Finding::skip("the device has no occlusionQueryPrecise"));
    }
    let levels = [1.0, 2.5, 7.0, 20.0, 64.0];
    let table = levels.map(TessLevels::uniform);
    let mut raw = Raw::new(device, &[size_of_val(&table) as u64, 4], SIDE)?;
    raw.write(0, &table)?;
    let evaluation = modes.rewrite(module("connectivity.tese")?);
    let pipeline = raw.pipeline(&Program::new(module("coordinates.tesc")?, evaluation)?)?;
    let query = Feedback::samples(device)?;
    let mut check = Check::default();
    let mut all = 0;
    for (number, level) in (0..).zip(levels) {
        raw.submit_behind(
            |cmd| query.reset(cmd),
            |cmd| {
                cmd.bind(pipeline, &0u32);
                query.around(cmd, None, || cmd.draw(1, 1, 0, number));
            },
        )?;
        // No pixel of triangles is drawn twice, see the group `connectivity`; lines may meet in one, and one alone lies on the picture's edge.
        let drawn = raw.pixels().iter().filter(|&&pixel| pixel != 0).count() as u64;
        let [counted, _] = query.counts()?;
        let right = if modes.domain == Domain::Isolines {
            counted >= drawn
        } else {
            counted == drawn
        };
        check.hold(right && !context.is_wrong(), || {
            format!("level {level}: {counted} samples are counted, {drawn} pixels are drawn")
        });
        all += drawn;
    }
    context.saw(all);
    Ok(check.finish(format!("{all} pixels")))
}

/// The geometry shader notes each primitive, and hands it on: as often as it is counted. A seeded fault expects one more.
fn statistics(context: &Context, modes: Modes) -> Result<Finding> {
    let device = context.device()?;
    let optional = device.info().support.optional;
    if !optional.geometry_shader || !optional.pipeline_statistics_query {
        return Ok(Finding::skip(
            "the device has no geometryShader, or no pipelineStatisticsQuery",
        ));
    }
    let name = match modes.domain {
        Domain::Isolines => "connectivity-lines.geom",
        _ => "connectivity.geom",
    };
    let query = Feedback::geometry(device)?;
    let mut check = Check::default();
    let mut all = 0;
    for level in [1.0, 2.5, 7.0, 20.0] {
        let table = [TessLevels::uniform(level)];
        let mut raw = Raw::new(device, &[size_of_val(&table) as u64, 4], SIDE)?;
        raw.write(0, &table)?;
        let evaluation = modes.rewrite(module("connectivity.tese")?);
        let pipeline = raw.pipeline(&Program {
            geometry: Some(module(name)?.into()),
            ..Program::new(module("coordinates.tesc")?, evaluation)?
        })?;
        raw.submit_behind(
            |cmd| query.reset(cmd),
            |cmd| {
                cmd.bind(pipeline, &0u32);
                query.around(cmd, None, || cmd.draw(1, 1, 0, 0));
            },
        )?;
        // Each primitive once: only then are invocations that are counted those that were.
        let noted = u64::from(raw.words(1)[0]);
        let right = noted + u64::from(context.is_wrong());
        let [invocations, primitives] = query.counts()?;
        check.hold(invocations == right && primitives == right, || {
            format!("level {level}: {invocations} invocations and {primitives} primitives are counted instead of {right}")
        });
        all += noted;
    }
    context.saw(all);
    Ok(check.finish(format!("{all} primitives")))
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (domain, spacing) in Domain::ALL
        .into_iter()
        .flat_map(|domain| Spacing::ALL.map(|spacing| (domain, spacing)))
    {
        let modes = Modes::new(domain, spacing);
        let name = format!("geometry.occlusion.{}-{}", domain.name(), spacing.name());
        let rule = "a precise occlusion query counts the samples that are drawn";
        let source = "Vulkan, Occlusion Queries";
        cases.push(Case::new(name, rule, source, move |context| {
            samples(context, modes)
        }));
        let name = format!("geometry.statistics.{}-{}", domain.name(), spacing.name());
        let rule = "pipeline statistics count the geometry shader's invocations, and what it makes";
        let source = "Vulkan, Pipeline Statistics Queries";
        cases.push(Case::new(name, rule, source, move |context| {
            statistics(context, modes)
        }));
        let name = format!("geometry.feedback.{}-{}", domain.name(), spacing.name());
        let rule = "transform feedback captures what the geometry shader makes, and no more";
        let source = "Vulkan, Transform Feedback; Geometry Shader Output Primitives";
        cases.push(Case::new(name, rule, source, move |context| {
            let table = [1.0, 2.5, 7.0, 20.0].map(TessLevels::uniform);
            captured_twice(context, modes, &table)
        }));
    }
    cases
}
