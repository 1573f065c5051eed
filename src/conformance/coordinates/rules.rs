//! The rules, each as a check of what the device makes.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::reference::{TessLevels, segments};
use super::shot::{Bits, SIDE, Shot, edge, edges, level_of_edge, most, shoot};
use crate::conformance::modes::{Domain, Modes, Spacing};
use crate::conformance::raw::Raster;
use crate::conformance::{Check, Context, Finding};
use crate::error::Result;

/// How far a coordinate may lie from where it is constructed. No specification says; devices step along an edge from both ends in fixed point
/// with 16 bits behind the point, so that half a last place a step adds up to 16 of them in the middle, and inside of triangles to more.
pub const TOLERANCE: f64 = 32.0 * UNIT;

/// A step of 16.16 fixed point.
pub const UNIT: f64 = 1.0 / 65536.0;

/// Ninety levels: all whole ones, and some between.
pub fn levels() -> Vec<f32> {
    let between = [
        1.1, 1.5, 1.9, 2.5, 3.3, 3.5, 4.1, 4.75, 5.5, 6.25, 7.9, 9.5, 10.1, 12.6, 15.5, 17.3, 20.2,
        24.9, 31.5, 33.3, 40.7, 47.1, 55.5, 60.1, 62.5, 63.5,
    ];
    (1..=64).map(|level| level as f32).chain(between).collect()
}

/// Patches of one level each; a seeded fault gives the device a little more than it should get.
pub fn uniform(context: &Context, modes: Modes, levels: &[f32]) -> Result<Shot> {
    let more = if context.is_wrong() { 1.3 } else { 1.0 };
    let table: Vec<TessLevels> = levels
        .iter()
        .map(|level| TessLevels::uniform(level * more))
        .collect();
    shoot(context, modes, &table, Raster::Discard)
}

pub fn counts(context: &Context, modes: Modes) -> Result<Finding> {
    let (mut levels, most) = (levels(), most(context)?);
    levels.sort_by(f32::total_cmp);
    let shot = uniform(context, modes, &levels)?;
    let mut check = Check::default();
    let mut before = 0;
    for (&level, patch) in levels.iter().zip(&shot.patches) {
        let right = segments(modes.spacing, level, most) as usize + 1;
        for number in 0..edges(modes.domain) {
            let found = edge(modes.domain, patch, number).len();
            check.hold(found == right && found >= before, || {
                format!("level {level}, edge {number}: {found} vertices instead of {right}")
            });
        }
        before = right;
    }
    Ok(check.finish(format!("{} levels", levels.len())))
}

/// The segments' lengths along an edge.
fn lengths_along(places: &BTreeSet<u32>) -> Vec<f64> {
    // The bits of positive floats are in the floats' order.
    let places: Vec<f64> = places
        .iter()
        .map(|&bits| f32::from_bits(bits).into())
        .collect();
    places.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// The segments that are shorter than most, and whether some are longer than rounding explains.
fn odd_segments(segments: &[f64]) -> (f64, Vec<usize>, bool) {
    let mut sorted = segments.to_vec();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted.get(sorted.len() / 2).copied().unwrap_or_default();
    let last = segments.len().saturating_sub(1);
    let short = |&i: &usize| {
        // What is lost by rounding on the way from both ends is gone, or left over, in the middle.
        let middle = (2 * i).abs_diff(last) <= 1;
        segments[i] < usual - if middle { 2.0 * TOLERANCE } else { 4.0 * UNIT }
    };
    let long = segments.iter().any(|&x| x > usual + 2.0 * TOLERANCE);
    (usual, (0..segments.len()).filter(short).collect(), long)
}

/// Holds the segments of an edge to the spacing; returns the length of the short ones relative to the others.
fn hold_lengths(check: &mut Check, modes: Modes, level: f32, segments: &[f64]) -> f64 {
    let (usual, short, long) = odd_segments(segments);
    let last = segments.len().saturating_sub(1);
    check.hold(!segments.is_empty() && !long, || {
        format!("level {level}: segments of {segments:?}")
    });
    match (modes.spacing, &short[..]) {
        (_, []) => 1.0,
        (Spacing::FractionalEven | Spacing::FractionalOdd, &[a, b]) => {
            let alike = (segments[a] - segments[b]).abs() <= 2.0 * UNIT;
            check.hold(alike && a + b == last, || {
                format!("level {level}: segments {a} and {b} are no symmetric pair")
            });
            segments[a] / usual
        }
        _ => {
            check.hold(false, || {
                format!("level {level}: segments {short:?} are shorter")
            });
            0.0
        }
    }
}

pub fn lengths(context: &Context, modes: Modes) -> Result<Finding> {
    // Twenty steps between two numbers of segments, three times.
    let ramp = |from: f32| (0..=20).map(move |i| from + 0.1 * i as f32);
    let start = if modes.spacing == Spacing::FractionalOdd {
        5.0
    } else {
        4.0
    };
    let starts = [start, start + 10.0, start + 40.0];
    let ramps: Vec<f32> = starts.into_iter().flat_map(ramp).collect();
    let most = most(context)?;
    let shot = uniform(context, modes, &ramps)?;
    let mut check = Check::default();
    let mut before = (0, 0.0);
    for (&level, patch) in ramps.iter().zip(&shot.patches) {
        let segments_found = lengths_along(&edge(modes.domain, patch, 0));
        let right = segments(modes.spacing, level, most);
        check.hold(segments_found.len() == right as usize, || {
            format!("level {level}: {} segments", segments_found.len())
        });
        let relative = hold_lengths(&mut check, modes, level, &segments_found);
        check.hold(before.0 != right || relative >= before.1 - 0.01, || {
            format!("level {level}: the short segments shrink while the level grows")
        });
        before = (right, relative);
    }
    Ok(check.finish(format!("{} levels", ramps.len())))
}

pub fn symmetry(context: &Context, modes: Modes) -> Result<Finding> {
    let levels = levels();
    let shot = uniform(context, modes, &levels)?;
    let mut check = Check::default();
    for (level, patch) in levels.iter().zip(&shot.patches) {
        for number in 0..edges(modes.domain) {
            let mut places = edge(modes.domain, patch, number);
            if context.is_wrong() {
                places.pop_last();
            }
            for &bits in &places {
                let mirrored = (1.0 - f32::from_bits(bits)).to_bits();
                check.hold(places.contains(&mirrored), || {
                    let x = f32::from_bits(bits);
                    format!("level {level}, edge {number}: {x} without 1 - {x}")
                });
            }
        }
    }
    Ok(check.finish(format!("{} levels", levels.len())))
}

pub fn any_edge(context: &Context, modes: Modes) -> Result<Finding> {
    let levels = levels();
    let mut table: Vec<TessLevels> = levels.iter().map(|&l| TessLevels::uniform(l)).collect();
    if context.is_wrong() {
        table[20].outer[2] += 2.0;
    }
    let shot = shoot(context, modes, &table, Raster::Discard)?;
    let mut check = Check::default();
    for (level, patch) in levels.iter().zip(&shot.patches) {
        let first = edge(modes.domain, patch, 0);
        for number in 1..edges(modes.domain) {
            check.hold(edge(modes.domain, patch, number) == first, || {
                format!("level {level}: edge {number} differs from edge 0")
            });
        }
    }
    Ok(check.finish(format!("{} levels", levels.len())))
}

/// Patches of random levels.
pub fn random_tables(context: &Context, stream: &str, count: usize) -> Vec<TessLevels> {
    let levels = levels();
    let mut random = context.random(stream);
    (0..count)
        .map(|_| TessLevels {
            outer: [0; 4].map(|_| *random.one_of(&levels)),
            inner: [0; 2].map(|_| *random.one_of(&levels)),
        })
        .collect()
}

pub fn outer_alone(context: &Context, modes: Modes) -> Result<Finding> {
    let mut table = random_tables(context, "coordinates.outer", 90);
    for level in table.iter_mut().flat_map(|levels| &mut levels.inner) {
        // With fractional-odd spacing an inner level of 1 may put inner vertices on the edge ("Quad Tessellation").
        *level = level.max(1.5);
    }
    let shot = shoot(context, modes, &table, Raster::Discard)?;
    let mut seen: HashMap<u32, BTreeSet<u32>> = HashMap::new();
    let mut check = Check::default();
    for (levels, patch) in table.iter().zip(&shot.patches) {
        for number in 0..edges(modes.domain) {
            let mut level = level_of_edge(modes.domain, levels, number);
            if context.is_wrong() {
                level = level.max(20.0);
            }
            let found = edge(modes.domain, patch, number);
            let first = seen.entry(level.to_bits()).or_insert_with(|| found.clone());
            check.hold(*first == found, || {
                format!("edge {number} of {levels:?} differs from another of level {level}")
            });
        }
    }
    Ok(check.finish(format!("{} patches, {} levels", table.len(), seen.len())))
}

/// The vertices that lie on no outer edge.
fn inside(domain: Domain, patch: &BTreeMap<Bits, u32>) -> BTreeSet<Bits> {
    let on_edge = |bits: &Bits| {
        let [u, v, w] = bits.map(f32::from_bits);
        match domain {
            Domain::Triangles => u == 0.0 || v == 0.0 || w == 0.0,
            _ => u == 0.0 || v == 0.0 || u == 1.0 || v == 1.0,
        }
    };
    patch
        .keys()
        .filter(|bits| !on_edge(bits))
        .copied()
        .collect()
}

pub fn inner_alone(context: &Context, modes: Modes) -> Result<Finding> {
    let outers = random_tables(context, "coordinates.inner", 90);
    let inner = [2.5, 3.0, 5.0, 8.0, 13.0, 31.5];
    let table: Vec<TessLevels> = outers
        .iter()
        .enumerate()
        .map(|(i, levels)| TessLevels {
            inner: [inner[i % 6], inner[(i / 6) % 6]],
            ..*levels
        })
        .collect();
    let shot = shoot(context, modes, &table, Raster::Discard)?;
    let mut seen: HashMap<[u32; 2], BTreeSet<Bits>> = HashMap::new();
    let mut check = Check::default();
    for (levels, patch) in table.iter().zip(&shot.patches) {
        let mut key = [0; 2];
        for (place, level) in key.iter_mut().zip(levels.inner(modes.domain)) {
            *place = if context.is_wrong() {
                0
            } else {
                level.to_bits()
            };
        }
        let found = inside(modes.domain, patch);
        let first = seen.entry(key).or_insert_with(|| found.clone());
        check.hold(*first == found, || {
            format!("the inside of {levels:?} differs from another of these inner levels")
        });
    }
    Ok(check.finish(format!(
        "{} patches, {} kinds of inside",
        table.len(),
        seen.len()
    )))
}

pub fn repeated(context: &Context, modes: Modes) -> Result<Finding> {
    let table = random_tables(context, "coordinates.repeated", 40);
    let mut backwards: Vec<TessLevels> = table.iter().rev().copied().collect();
    if context.is_wrong() {
        backwards[3].outer[1] += 2.0;
    }
    let first = shoot(context, modes, &table, Raster::Discard)?;
    let second = shoot(context, modes, &backwards, Raster::Discard)?;
    let mut check = Check::default();
    let pairs = first.patches.iter().zip(second.patches.iter().rev());
    for (levels, (a, b)) in table.iter().zip(pairs) {
        check.hold(a.keys().eq(b.keys()), || {
            format!("{levels:?} is cut in two ways")
        });
    }
    Ok(check.finish(format!("{} patches, in two orders", table.len())))
}

pub fn exact(context: &Context, modes: Modes) -> Result<Finding> {
    let levels = levels();
    let shot = uniform(context, modes, &levels)?;
    let mut check = Check::default();
    let beyond = if context.is_wrong() { 0.99 } else { 1.0 };
    for (level, patch) in levels.iter().zip(&shot.patches) {
        for bits in patch.keys() {
            let all = bits.map(f32::from_bits);
            let right = all.iter().all(|&x| {
                let rest = 1.0 - x;
                (0.0..=beyond).contains(&x) && f64::from(rest) == 1.0 - f64::from(x)
            });
            check.hold(right, || format!("level {level}: {all:?}"));
            let sum: f64 = all.iter().map(|&x| f64::from(x)).sum();
            let barycentric = modes.domain != Domain::Triangles || (sum - 1.0).abs() <= TOLERANCE;
            check.hold(barycentric, || {
                format!("level {level}: {all:?} sum to {sum}")
            });
        }
        for corner in corners(modes.domain) {
            check.hold(patch.contains_key(&corner.map(f32::to_bits)), || {
                format!("level {level}: no vertex at {corner:?}")
            });
        }
    }
    Ok(check.finish(format!("{} levels", levels.len())))
}

fn corners(domain: Domain) -> Vec<[f32; 3]> {
    let square = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    match domain {
        Domain::Quads => square.to_vec(),
        Domain::Isolines => square[..2].to_vec(),
        Domain::Triangles => vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    }
}

pub fn winding(context: &Context, modes: Modes) -> Result<Finding> {
    let levels = levels();
    let table: Vec<TessLevels> = levels.iter().map(|&l| TessLevels::uniform(l)).collect();
    let clockwise = Modes {
        clockwise: !context.is_wrong(),
        ..modes
    };
    let front = shoot(context, modes, &table, Raster::Front)?;
    let back = shoot(context, clockwise, &table, Raster::Front)?;
    let mut check = Check::default();
    for (level, (a, b)) in levels.iter().zip(front.patches.iter().zip(&back.patches)) {
        check.hold(a.keys().eq(b.keys()), || {
            format!("level {level}: other vertices when clockwise")
        });
    }
    let whole = (SIDE * SIDE) as usize / if modes.domain == Domain::Quads { 1 } else { 3 };
    check.hold(front.drawn >= whole, || {
        format!("counter-clockwise: {} pixels face front", front.drawn)
    });
    check.hold(back.drawn == 0, || {
        format!("clockwise: {} pixels face front", back.drawn)
    });
    Ok(check.finish(format!(
        "{} levels, {} and {} pixels face front",
        levels.len(),
        front.drawn,
        back.drawn
    )))
}

pub fn points(context: &Context, modes: Modes) -> Result<Finding> {
    let levels = levels();
    let table: Vec<TessLevels> = levels.iter().map(|&l| TessLevels::uniform(l)).collect();
    let point_mode = Modes {
        points: true,
        ..modes
    };
    let primitives = shoot(context, modes, &table, Raster::Discard)?;
    let points = shoot(context, point_mode, &table, Raster::Solid)?;
    let mut check = Check::default();
    for (level, (a, b)) in levels
        .iter()
        .zip(primitives.patches.iter().zip(&points.patches))
    {
        check.hold(a.keys().eq(b.keys()), || {
            format!("level {level}: other vertices in point mode")
        });
    }
    let vertices: u64 = points.patches.iter().map(|patch| patch.len() as u64).sum();
    let wanted = vertices + u64::from(context.is_wrong());
    if let Some(counted) = points.primitives {
        check.hold(counted == wanted, || {
            format!("{counted} points for {wanted} vertices")
        });
    }
    Ok(check.finish(format!("{} levels, {vertices} points", levels.len())))
}

pub fn clamped(context: &Context, modes: Modes) -> Result<Finding> {
    let most = most(context)?;
    let pairs = [
        (most + 0.5, most),
        (most + 1.0, most),
        (2.0 * most, most),
        (1e9, most),
        (f32::INFINITY, most),
        (0.5, 1.0),
        (0.001, 1.0),
        (f32::MIN_POSITIVE, 1.0),
    ];
    let table: Vec<TessLevels> = pairs
        .iter()
        .flat_map(|&(a, b)| [a, b])
        .map(TessLevels::uniform)
        .collect();
    let mut given = table.clone();
    if context.is_wrong() {
        given[1] = TessLevels::uniform(most - 2.0);
    }
    let shot = shoot(context, modes, &given, Raster::Discard)?;
    let mut check = Check::default();
    for (&(beyond, limit), both) in pairs.iter().zip(shot.patches.chunks(2)) {
        let same = !both[0].is_empty() && both[0].keys().eq(both[1].keys());
        check.hold(same, || format!("level {beyond} is not cut like {limit}"));
    }
    Ok(check.finish(format!("{} levels, greatest {most}", pairs.len())))
}
