//! Triangles as pictures to which each adds.

use crate::conformance::coordinates::TessLevels;
use crate::conformance::modes::{Domain, Modes, module};
use crate::conformance::raw::{Program, Raster, Raw};
use crate::conformance::{Check, Context, Finding};
use crate::error::Result;

/// The picture's side in pixels.
const SIDE: u32 = 128;

/// How far from the third edge of a triangle's domain pixels are told from others, in pixels.
const MARGIN: f32 = 1.0;

/// Each pixel's centre inside of the domain lies in one triangle, and none outside does. A seeded fault expects two.
pub fn once(context: &Context, modes: Modes, table: &[TessLevels]) -> Result<Finding> {
    // No primitive is noted: there is no room.
    let mut raw = Raw::new(context.device()?, &[size_of_val(table) as u64, 4], SIDE)?;
    raw.write(0, table)?;
    let evaluation = modes.rewrite(module("connectivity.tese")?);
    let pipeline = raw.pipeline(&Program {
        raster: Raster::Added,
        ..Program::new(module("coordinates.tesc")?, evaluation)?
    })?;
    let mut check = Check::default();
    let mut count = 0;
    let times = 1 + u32::from(context.is_wrong());
    for (number, levels) in (0..).zip(table) {
        raw.submit(None, |cmd| {
            cmd.bind(pipeline, &0u32);
            cmd.draw(1, 1, 0, number);
        })?;
        let pixels = raw.pixels();
        for (i, &pixel) in (0..).zip(&pixels) {
            let beyond = beyond(modes.domain, i % SIDE, i / SIDE);
            let right = match beyond {
                Some(false) => pixel == times * (number + 1),
                Some(true) => pixel == 0,
                None => pixel == 0 || pixel == number + 1,
            };
            count += u64::from(pixel != 0);
            check.hold(right, || {
                let drawn = f64::from(pixel) / f64::from(number + 1);
                let (x, y) = (i % SIDE, i / SIDE);
                format!("{levels:?}: pixel ({x}, {y}) is drawn {drawn} times")
            });
        }
    }
    context.saw(count);
    Ok(check.finish(format!("{count} pixels, each once")))
}

/// Whether a pixel lies outside of the domain; None where its edge passes.
fn beyond(domain: Domain, x: u32, y: u32) -> Option<bool> {
    if domain == Domain::Quads {
        return Some(false);
    }
    let past = x as f32 + y as f32 + 1.0 - SIDE as f32;
    (past.abs() > MARGIN).then_some(past > 0.0)
}
