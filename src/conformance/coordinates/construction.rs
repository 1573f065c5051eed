//! Whole patches against their construction.

use std::collections::HashMap;

use glam::DVec3;

use super::reference::{Cuts, TessLevels, barely_divided, equal_cuts, segments, vertices};
use super::rules::{TOLERANCE, UNIT, levels, random_tables, uniform};
use super::shot::{Shot, edge, most, point, shoot};
use crate::conformance::modes::{Domain, Modes, Spacing};
use crate::conformance::raw::Raster;
use crate::conformance::{Check, Context, Finding};
use crate::error::{Error, Result};

/// The cuts of levels as the device makes them, on the first edge of patches of one level each; equal ones as they are defined.
fn cuts(context: &Context, modes: Modes, levels: &[f32]) -> Result<HashMap<u32, Cuts>> {
    let most = most(context)?;
    if modes.spacing == Spacing::Equal {
        let cut = |&level: &f32| {
            let segments = segments(modes.spacing, level, most);
            (level.to_bits(), equal_cuts(segments))
        };
        return Ok(levels.iter().map(cut).collect());
    }
    let table: Vec<TessLevels> = levels.iter().map(|&l| TessLevels::uniform(l)).collect();
    let shot = shoot(context, modes, &table, Raster::Discard)?;
    let measured = levels.iter().zip(&shot.patches).map(|(level, patch)| {
        let places = edge(modes.domain, patch, 0);
        // Both ends at least: everything else is constructed from them.
        if places.len() < 2 {
            return Err(Error::Refused(format!(
                "level {level}: {} vertices on the first edge",
                places.len()
            )));
        }
        let cuts = places.iter().map(|&bits| f64::from(f32::from_bits(bits)));
        Ok((level.to_bits(), cuts.collect()))
    });
    measured.collect()
}

/// The vertices that a patch should have.
fn constructed(
    modes: Modes,
    levels: &TessLevels,
    cuts: &HashMap<u32, Cuts>,
    most: f32,
) -> Vec<DVec3> {
    let count = |&level: &f32| segments(modes.spacing, level, most);
    let of = |level: &f32| cuts[&level.to_bits()].clone();
    let (outer, inner) = (levels.outer(modes.domain), levels.inner(modes.domain));
    let divided = outer.iter().chain(inner).any(|level| count(level) > 1);
    let mut outer_cuts: Vec<Cuts> = outer.iter().map(of).collect();
    if modes.domain == Domain::Isolines {
        // The lines are spaced equally whatever the spacing is.
        outer_cuts[0] = equal_cuts(segments(Spacing::Equal, outer[0], most));
    }
    let inner_cuts: Vec<Cuts> = inner
        .iter()
        .map(|level| match count(level) {
            1 if divided => barely_divided(modes.spacing),
            _ => of(level),
        })
        .collect();
    vertices(modes.domain, &outer_cuts, &inner_cuts)
}

/// Compares patches with their construction; returns the greatest deviation too.
fn compare(
    check: &mut Check,
    modes: Modes,
    table: &[TessLevels],
    shot: &Shot,
    cuts: &HashMap<u32, Cuts>,
    most: f32,
) -> f64 {
    let mut worst: f64 = 0.0;
    for (levels, patch) in table.iter().zip(&shot.patches) {
        let right = constructed(modes, levels, cuts, most);
        let found: Vec<DVec3> = patch.keys().map(point).collect();
        let barely = modes.spacing == Spacing::FractionalOdd
            && levels.inner(modes.domain).iter().any(|&inner| inner <= 1.0);
        // How small "barely divided" is nobody says; in fixed point inner vertices may lie where those of the edge do.
        check.hold(
            found.len() == right.len() || barely && found.len() < right.len(),
            || {
                format!(
                    "{levels:?}: {} vertices instead of {}",
                    found.len(),
                    right.len()
                )
            },
        );
        let tolerance = if barely { 0.01 } else { TOLERANCE };
        for (from, to, what) in [(&right, &found, "missing"), (&found, &right, "surplus")] {
            let (off, place) = farthest(from, to);
            check.hold(off <= tolerance, || {
                format!("{levels:?}: a vertex {what} near {place}, {off:.6} off")
            });
            if !barely {
                worst = worst.max(off);
            }
        }
    }
    worst
}

/// The greatest distance of one of `from` to the nearest of `to`, and where.
fn farthest(from: &[DVec3], to: &[DVec3]) -> (f64, DVec3) {
    const CELLS: f64 = 128.0;
    let cell = |p: DVec3| ((p.x * CELLS) as i32, (p.y * CELLS) as i32);
    let mut grid: HashMap<(i32, i32), Vec<DVec3>> = HashMap::new();
    for &p in to {
        grid.entry(cell(p)).or_default().push(p);
    }
    let nearest = |p: DVec3| {
        let (x, y) = cell(p);
        let around = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| (x, y)));
        let near = around.filter_map(|cell| grid.get(&cell)).flatten();
        near.map(|q| q.distance(p)).fold(1.0, f64::min)
    };
    from.iter()
        .map(|&p| (nearest(p), p))
        .fold((0.0, DVec3::ZERO), |a, b| if b.0 > a.0 { b } else { a })
}

pub fn sets(context: &Context, modes: Modes) -> Result<Finding> {
    let (levels, most) = (levels(), most(context)?);
    let cuts = cuts(context, modes, &levels)?;
    let table: Vec<TessLevels> = levels.iter().map(|&l| TessLevels::uniform(l)).collect();
    let shot = uniform(context, modes, &levels)?;
    let mut check = Check::default();
    let worst = compare(&mut check, modes, &table, &shot, &cuts, most);
    Ok(check.finish(deviation(levels.len(), worst)))
}

fn deviation(patches: usize, worst: f64) -> String {
    format!("{patches} patches, at most {:.2}/65536 off", worst / UNIT)
}

pub fn mixed_sets(context: &Context, modes: Modes) -> Result<Finding> {
    let (levels, most) = (levels(), most(context)?);
    let cuts = cuts(context, modes, &levels)?;
    let table = random_tables(context, "coordinates.mixed", 60);
    let mut given = table.clone();
    if context.is_wrong() {
        given[7].outer[1] += 2.0;
    }
    let shot = shoot(context, modes, &given, Raster::Discard)?;
    let mut check = Check::default();
    let worst = compare(&mut check, modes, &table, &shot, &cuts, most);
    Ok(check.finish(deviation(table.len(), worst)))
}
