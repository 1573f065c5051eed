//! The primitives of patches as transform feedback captures them.

use super::caught::{Primitive, most, primitives};
use crate::conformance::coordinates::TessLevels;
use crate::conformance::modes::{Domain, Modes, module};
use crate::conformance::raw::{Feedback, Program, Raster, Raw};
use crate::conformance::{Check, Context, Finding};
use crate::error::Result;

/// Words of a vertex: the patch's number and a tess coordinate.
const WORDS: usize = 4;

/// What no vertex has.
const UNTOUCHED: u32 = 0xdead_beef;

/// The picture's side in pixels: nobody looks.
const SIDE: u32 = 16;

/// Whose vertices are captured.
#[derive(Clone, Copy)]
enum Behind {
    Evaluation,
    /// Those of a geometry shader that hands each primitive on twice.
    Geometry,
}

struct Captured {
    /// Each with the number of its patch, as many as were written.
    primitives: Vec<(u32, Primitive)>,
    /// Primitives that were written, and that would have been with more room.
    counts: [u64; 2],
    /// Words beyond these that are no longer what they were.
    touched: usize,
}

/// Draws a patch an instance with the levels of a table, with room for so many primitives.
fn capture(
    context: &Context,
    modes: Modes,
    table: &[TessLevels],
    room: u32,
    behind: Behind,
) -> Result<Captured> {
    let device = context.full_device()?;
    let vertices = if modes.domain == Domain::Isolines {
        2
    } else {
        3
    };
    let words = vertices * WORDS;
    let bytes = 4 * words as u64 * u64::from(room);
    // A primitive more, which must stay as it is.
    let all = bytes + 4 * words as u64;
    let mut raw = Raw::new(device, &[size_of_val(table) as u64, all], SIDE)?;
    raw.write(0, table)?;
    raw.write(1, &vec![UNTOUCHED; all as usize / 4])?;
    let (evaluation, geometry) = match (behind, modes.domain) {
        (Behind::Evaluation, _) => ("feedback.tese", None),
        (Behind::Geometry, Domain::Isolines) => ("connectivity.tese", Some("feedback-lines.geom")),
        (Behind::Geometry, _) => ("connectivity.tese", Some("feedback.geom")),
    };
    let geometry = geometry.map(module).transpose()?;
    let evaluation = modes.rewrite(module(evaluation)?);
    let pipeline = raw.pipeline(&Program {
        geometry: geometry.map(Into::into),
        raster: Raster::Discard,
        ..Program::new(module("coordinates.tesc")?, evaluation)?
    })?;
    let feedback = Feedback::capture(device)?;
    raw.submit_behind(
        |cmd| feedback.reset(cmd),
        |cmd| {
            cmd.bind(pipeline, &0u32);
            let into = Some((&raw, 1, bytes));
            feedback.around(cmd, into, || cmd.draw(1, table.len() as u32, 0, 0));
        },
    )?;
    let counts = feedback.counts()?;
    context.saw(counts[0]);
    let written = (counts[0] as usize).min(room as usize) * words;
    let (captured, rest) = raw.words(1).split_at(written);
    let vertex = |words: &[u32]| [words[1], words[2], words[3]];
    let primitive = |own: &[u32]| {
        let vertex = |i: usize| vertex(&own[WORDS * (i % vertices)..]);
        (own[0], [0, 1, 2].map(vertex))
    };
    Ok(Captured {
        primitives: captured.chunks_exact(words).map(primitive).collect(),
        counts,
        touched: rest.iter().filter(|&&word| word != UNTOUCHED).count(),
    })
}

/// Whatever vertex a primitive begins with, and whatever way round it is; in no order.
fn sorted(primitives: impl Iterator<Item = (u32, Primitive)>) -> Vec<(u32, Primitive)> {
    let mut all: Vec<_> = primitives
        .map(|(number, mut primitive)| {
            primitive.sort_unstable();
            (number, primitive)
        })
        .collect();
    all.sort_unstable();
    all
}

/// What a geometry shader sees, where it has each line's first vertex twice.
fn seen(context: &Context, modes: Modes, table: &[TessLevels]) -> Result<Vec<(u32, Primitive)>> {
    let caught = primitives(context, modes, table)?;
    let numbered = (0..)
        .zip(caught)
        .flat_map(|(number, patch)| patch.into_iter().map(move |primitive| (number, primitive)));
    Ok(sorted(numbered))
}

fn lacks(context: &Context) -> Result<Option<Finding>> {
    let has = context.device()?.possible()?.transform_feedback;
    Ok((!has).then(|| Finding::skip("the device has no transformFeedback")))
}

/// Transform feedback has each primitive that a geometry shader sees, and none besides. What is lost on purpose is the last.
pub fn same(context: &Context, modes: Modes, table: &[TessLevels]) -> Result<Finding> {
    if let Some(skipped) = lacks(context)? {
        return Ok(skipped);
    }
    let seen = seen(context, modes, table)?;
    let room = table.iter().map(most).sum();
    let captured = capture(context, modes, table, room, Behind::Evaluation)?;
    let mut found = sorted(captured.primitives.into_iter());
    if context.is_wrong() {
        found.pop();
    }
    let mut check = Check::default();
    check.hold(found.len() == seen.len(), || {
        format!(
            "{} primitives are captured instead of {}",
            found.len(),
            seen.len()
        )
    });
    for (found, seen) in found.iter().zip(&seen) {
        check.hold(found == seen, || {
            format!("{found:?} is captured instead of {seen:?}")
        });
    }
    let all = [seen.len() as u64; 2];
    check.hold(captured.counts == all, || {
        format!("the query counts {:?} instead of {all:?}", captured.counts)
    });
    check.hold(captured.touched == 0, || {
        format!("{} words beyond them are written", captured.touched)
    });
    Ok(check.finish(format!("{} primitives", seen.len())))
}

/// Behind a geometry shader that hands each primitive on twice, each is captured twice. A seeded fault expects one more.
pub fn twice(context: &Context, modes: Modes, table: &[TessLevels]) -> Result<Finding> {
    if let Some(skipped) = lacks(context)? {
        return Ok(skipped);
    }
    if !context.device()?.info().support.optional.geometry_shader {
        return Ok(Finding::skip("the device has no geometryShader"));
    }
    let seen = seen(context, modes, table)?;
    let twice: Vec<_> = seen.iter().flat_map(|one| [one, one]).collect();
    let room = 2 * table.iter().map(most).sum::<u32>();
    let captured = capture(context, modes, table, room, Behind::Geometry)?;
    let found = sorted(captured.primitives.into_iter());
    let mut check = Check::default();
    let right = twice.len() as u64 + u64::from(context.is_wrong());
    check.hold(captured.counts == [right; 2], || {
        format!("the query counts {:?} instead of {right}", captured.counts)
    });
    for (found, &seen) in found.iter().zip(&twice) {
        check.hold(found == seen, || {
            format!("{found:?} is captured instead of {seen:?}")
        });
    }
    check.hold(captured.touched == 0, || {
        format!("{} words beyond them are written", captured.touched)
    });
    Ok(check.finish(format!("{} primitives, each twice", seen.len())))
}

/// Where there is no room, whole primitives are captured as long as they fit, all of them are counted, and nothing is written beyond. On purpose one more is
/// expected.
pub fn full(context: &Context, modes: Modes, table: &[TessLevels]) -> Result<Finding> {
    if let Some(skipped) = lacks(context)? {
        return Ok(skipped);
    }
    let seen = seen(context, modes, table)?;
    let mut check = Check::default();
    let all = seen.len() as u64;
    for room in [1, all / 2, all - 1].map(|room| room.max(1)) {
        let captured = capture(context, modes, table, room as u32, Behind::Evaluation)?;
        let right = [room + u64::from(context.is_wrong()), all];
        check.hold(captured.counts == right, || {
            format!(
                "the query counts {:?} instead of {right:?}",
                captured.counts
            )
        });
        check.hold(captured.touched == 0, || {
            format!("{} words are written beyond the end", captured.touched)
        });
        for found in sorted(captured.primitives.into_iter()) {
            let known = seen.binary_search(&found).is_ok();
            check.hold(known, || {
                format!("{found:?} is none that a geometry shader sees")
            });
        }
    }
    Ok(check.finish(format!("{all} primitives in less room")))
}
