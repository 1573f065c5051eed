//! Queries about samples of tessellated draws.

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
    }
    cases
}
