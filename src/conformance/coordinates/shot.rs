//! What the tessellator makes of patches of given levels.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec3, Vec3};

use super::reference::TessLevels;
use crate::conformance::Context;
use crate::conformance::modes::{Domain, Modes, module};
use crate::conformance::raw::{Program, Raster, Raw, Recorder};
use crate::error::{Error, Result};
use crate::host::StatisticsQuery;

/// The picture's side in pixels.
pub const SIDE: u32 = 64;

/// A tess coordinate as bits, so that it can be a member of a set.
pub type Bits = [u32; 3];

/// The tess coordinates of some patches.
pub struct Shot {
    /// Of each patch: how often each coordinate came.
    pub patches: Vec<BTreeMap<Bits, u32>>,
    /// Pixels that were drawn.
    pub drawn: usize,
    /// Primitives that reached clipping, where the device counts them.
    pub primitives: Option<u64>,
}

/// Draws patches of the levels of a table with some modes, an instance each.
pub fn shoot(
    context: &Context,
    modes: Modes,
    table: &[TessLevels],
    raster: Raster,
) -> Result<Shot> {
    let patches = table.len() as u32;
    shoot_with(context, modes, table, raster, 1, |cmd| {
        cmd.draw(1, patches, 0, 0);
    })
}

/// The same with draws of one's own, of patches with `control_points`: instance i is a patch of the table's i-th levels.
pub fn shoot_with(
    context: &Context,
    modes: Modes,
    table: &[TessLevels],
    raster: Raster,
    control_points: u32,
    draws: impl FnOnce(&Recorder<'_>),
) -> Result<Shot> {
    let device = context.device()?;
    let room = room(table);
    let sizes = [size_of_val(table) as u64, 4 + 16 * u64::from(room)];
    let mut raw = Raw::new(device, &sizes, SIDE)?;
    raw.write(0, table)?;
    let evaluation = modes.rewrite(module("coordinates.tese")?);
    let pipeline = raw.pipeline(&Program {
        control_points,
        raster,
        ..Program::new(module("coordinates.tesc")?, evaluation)?
    })?;
    let counts = device.info().support.optional.pipeline_statistics_query;
    let query = counts.then(|| StatisticsQuery::new(device)).transpose()?;
    raw.submit(query.as_ref(), |cmd| {
        cmd.bind(pipeline, &room);
        draws(cmd);
    })?;
    let primitives = query.map(|query| query.read()).transpose()?;
    context.saw(raw.words(1)[0].into());
    Ok(Shot {
        patches: sorted(raw.words(1), room, table.len())?,
        drawn: raw.pixels().iter().filter(|&&pixel| pixel != 0).count(),
        primitives: primitives.map(|[_, _, primitives]| primitives),
    })
}

/// Room for every vertex several times.
fn room(table: &[TessLevels]) -> u32 {
    let of_patch = |levels: &TessLevels| {
        let all = levels.outer.iter().chain(&levels.inner);
        // Levels that are no numbers count as the greatest.
        let greatest = all.fold(2.0, |a: f32, &b| if b < 64.0 { a.max(b) } else { 64.0 });
        6 * (greatest.ceil() as u32 + 2).pow(2)
    };
    table.iter().map(of_patch).sum()
}

fn sorted(words: &[u32], room: u32, patches: usize) -> Result<Vec<BTreeMap<Bits, u32>>> {
    let count = words[0];
    if count > room {
        return Err(Error::Refused(format!(
            "{count} vertices came: the device runs evaluation shaders far too often"
        )));
    }
    let mut sorted = vec![BTreeMap::new(); patches];
    for record in words[1..][..4 * count as usize].chunks_exact(4) {
        let patch = record[0] as usize;
        let own = sorted.get_mut(patch).ok_or_else(|| {
            Error::Refused(format!("a vertex came of patch {patch}, which is none"))
        })?;
        *own.entry([record[1], record[2], record[3]]).or_default() += 1;
    }
    Ok(sorted)
}

/// The coordinate that bits mean.
pub fn point(bits: &Bits) -> DVec3 {
    Vec3::from(bits.map(f32::from_bits)).as_dvec3()
}

/// The places of an outer edge's vertices along it, as bits of their first coordinate that varies.
///
/// Triangles' edges are u = 0, v = 0, w = 0, those of quads u = 0, v = 0, u = 1, v = 1; isolines have their lines instead, of which this takes
/// number `edge`, from `v` = 0 on.
pub fn edge(domain: Domain, patch: &BTreeMap<Bits, u32>, edge: usize) -> BTreeSet<u32> {
    let (zero, one) = (0f32.to_bits(), 1f32.to_bits());
    let chosen = |bits: &&Bits| match (domain, edge) {
        (Domain::Isolines, _) => bits[1] == zero,
        (Domain::Quads, 2..) => bits[edge - 2] == one,
        _ => bits[edge] == zero,
    };
    let along = match (domain, edge) {
        (Domain::Isolines, _) => 0,
        (Domain::Quads, _) => (edge + 1) % 2,
        _ => (edge + 1) % 3,
    };
    patch
        .keys()
        .filter(chosen)
        .map(|bits| bits[along])
        .collect()
}

/// How many outer edges with vertices along them a domain has: isolines' lines are all alike.
pub fn edges(domain: Domain) -> usize {
    match domain {
        Domain::Quads => 4,
        Domain::Triangles => 3,
        Domain::Isolines => 1,
    }
}

/// The level that decides on an edge's vertices.
pub fn level_of_edge(domain: Domain, levels: &TessLevels, edge: usize) -> f32 {
    match domain {
        Domain::Isolines => levels.outer[1],
        _ => levels.outer[edge],
    }
}

/// The device's greatest level.
pub fn most(context: &Context) -> Result<f32> {
    Ok(context.device()?.limits().max_tessellation_generation_level as f32)
}
