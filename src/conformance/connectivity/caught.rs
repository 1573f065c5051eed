//! The primitives of patches as a geometry shader sees them.

use crate::conformance::Context;
use crate::conformance::coordinates::TessLevels;
use crate::conformance::modes::{Domain, Modes, module};
use crate::conformance::raw::{Program, Raster, Raw};
use crate::error::{Error, Result};

/// A tess coordinate as bits, so that it can be a member of a set.
pub type Bits = [u32; 3];

/// A triangle, or a line, whose third vertex is its first.
pub type Primitive = [Bits; 3];

/// The primitives of each patch, in the order in which they came.
pub type Caught = Vec<Vec<Primitive>>;

/// The picture's side in pixels: nobody looks.
const SIDE: u32 = 16;

/// Draws a patch an instance with the levels of a table.
pub fn primitives(context: &Context, modes: Modes, table: &[TessLevels]) -> Result<Caught> {
    let has_lines = modes.domain == Domain::Isolines;
    let (geometry, vertices) = if has_lines {
        ("connectivity-lines.geom", 2)
    } else {
        ("connectivity.geom", 3)
    };
    let room: u32 = table.iter().map(most).sum();
    let words = 1 + 3 * vertices;
    let sizes = [size_of_val(table) as u64, 4 + u64::from(4 * words * room)];
    let mut raw = Raw::new(context.device()?, &sizes, SIDE)?;
    raw.write(0, table)?;
    let evaluation = modes.rewrite(module("connectivity.tese")?);
    let pipeline = raw.pipeline(&Program {
        geometry: Some(module(geometry)?.into()),
        raster: Raster::Discard,
        ..Program::new(module("coordinates.tesc")?, evaluation)?
    })?;
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &room);
        cmd.draw(1, table.len() as u32, 0, 0);
    })?;
    let found = raw.words(1);
    let count = found[0];
    context.saw(count.into());
    if count > room {
        return Err(Error::Refused(format!(
            "{count} primitives came where {room} are too many already"
        )));
    }
    let mut caught = vec![Vec::new(); table.len()];
    for record in found[1..][..(count * words) as usize].chunks_exact(words as usize) {
        let own = caught.get_mut(record[0] as usize).ok_or_else(|| {
            Error::Refused(format!(
                "a primitive came of patch {}, which is none",
                record[0]
            ))
        })?;
        let vertex = |i: usize| [0, 1, 2].map(|k| record[1 + 3 * i + k]);
        own.push([0, 1, 2].map(|i| vertex(i % vertices as usize)));
    }
    Ok(caught)
}

/// More primitives than a patch of these levels has.
pub fn most(levels: &TessLevels) -> u32 {
    let all = levels.outer.iter().chain(&levels.inner);
    let greatest = all.fold(2.0, |a: f32, &b| a.max(b));
    3 * (greatest.ceil() as u32 + 2).pow(2)
}
