//! Distances by which evaluation shaders clip primitives, or leave them out.

use crate::conformance::coordinates::TessLevels;
use crate::conformance::modes::{Domain, Modes, Spacing, module};
use crate::conformance::raw::{Program, Raw};
use crate::conformance::{Case, Check, Context, Finding};
use crate::error::Result;

/// The picture's side in pixels.
const SIDE: u32 = 128;

/// No distance cuts.
const NONE: u32 = 8;

/// Half a pixel from the nearest centre.
const CUTS: [f32; 3] = [0.25, 0.5, 0.8125];

/// A picture of which the part with u < `cut` is cut off by one of eight distances.
fn picture(
    context: &Context,
    modes: Modes,
    kind: &str,
    level: f32,
    distance: u32,
    cut: f32,
) -> Result<Vec<u32>> {
    let table = [TessLevels::uniform(level)];
    let mut raw = Raw::new(context.full_device()?, &[size_of_val(&table) as u64], SIDE)?;
    raw.write(0, &table)?;
    let evaluation = modes.rewrite(module(&format!("{kind}.tese"))?);
    let pipeline = raw.pipeline(&Program {
        constants: vec![distance],
        ..Program::new(module("coordinates.tesc")?, evaluation)?
    })?;
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &cut);
        cmd.draw(1, 1, 0, 0);
    })?;
    let pixels = raw.pixels();
    context.saw(pixels.iter().filter(|&&pixel| pixel != 0).count() as u64);
    Ok(pixels)
}

/// Holds a picture to the whole one, of which the columns up to `cut` are missing.
fn compare(check: &mut Check, whole: &[u32], found: &[u32], cut: f32, what: impl Fn() -> String) {
    let cut = (cut * SIDE as f32) as usize;
    let right = |i: usize| {
        if i % (SIDE as usize) < cut {
            0
        } else {
            whole[i]
        }
    };
    let wrong = (0..whole.len()).filter(|&i| found[i] != right(i)).count();
    check.hold(wrong == 0, || format!("{}: {wrong} pixels", what()));
}

fn lacks(context: &Context) -> Result<Option<Finding>> {
    let has = context.device()?.possible()?.clip_and_cull_distances;
    Ok((!has)
        .then(|| Finding::skip("the device has no shaderClipDistance, or no shaderCullDistance")))
}

/// A seeded fault expects half of the picture to be cut off further.
fn clips(context: &Context, modes: Modes, distance: u32) -> Result<Finding> {
    if let Some(skipped) = lacks(context)? {
        return Ok(skipped);
    }
    let mut check = Check::default();
    let mut pictures = 0;
    for level in [1.0, 2.5, 7.0, 64.0] {
        let whole = picture(context, modes, "clip", level, NONE, 0.0)?;
        for cut in CUTS {
            let found = picture(context, modes, "clip", level, distance, cut)?;
            let shift = if context.is_wrong() { 0.125 } else { 0.0 };
            compare(&mut check, &whole, &found, cut + shift, || {
                format!("level {level}, clipped at u = {cut}")
            });
            pictures += 1;
        }
    }
    Ok(check.finish(format!("{pictures} pictures")))
}

/// Quads that are cut evenly: columns all of whose vertices lie before the cut are missing as a whole, others are whole.
fn culls(context: &Context, distance: u32) -> Result<Finding> {
    if let Some(skipped) = lacks(context)? {
        return Ok(skipped);
    }
    let modes = Modes::new(Domain::Quads, Spacing::Equal);
    let mut check = Check::default();
    let mut pictures = 0;
    for level in [1.0, 2.0, 8.0, 64.0] {
        let whole = picture(context, modes, "cull", level, NONE, 0.0)?;
        for cut in [0.3, 0.55, 0.8] {
            let found = picture(context, modes, "cull", level, distance, cut)?;
            let columns = (cut * level).floor() + if context.is_wrong() { 1.0 } else { 0.0 };
            compare(&mut check, &whole, &found, columns / level, || {
                format!("level {level}, culled before u = {cut}")
            });
            pictures += 1;
        }
    }
    Ok(check.finish(format!("{pictures} pictures")))
}

pub fn cases() -> Vec<Case> {
    let source = "Vulkan, Primitive Clipping: ClipDistance, CullDistance";
    let mut cases = Vec::new();
    for distance in 0..NONE {
        for domain in [Domain::Quads, Domain::Triangles] {
            for spacing in Spacing::ALL {
                let modes = Modes::new(domain, spacing);
                let (domain, spacing) = (domain.name(), spacing.name());
                let name = format!("geometry.clip.{domain}-{spacing}-{distance}");
                let rule = "what has a negative clip distance is not drawn, and all else is";
                cases.push(Case::new(name, rule, source, move |context| {
                    clips(context, modes, distance)
                }));
            }
        }
        let name = format!("geometry.cull.quads-equal-{distance}");
        let rule = "primitives are left out if a cull distance is negative at all their vertices";
        cases.push(Case::new(name, rule, source, move |context| {
            culls(context, distance)
        }));
    }
    cases
}
