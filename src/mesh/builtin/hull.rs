//! The default model: a small tugboat.
//!
//! A box of quads is bent into a hull, and everything else is pulled out of its faces.

use glam::DVec3;

use super::sketch::Sketch;
use crate::error::Result;
use crate::mesh::{ControlMesh, INFINITE_SHARPNESS};

/// Quads from stern to bow.
const LENGTH: usize = 12;
/// Quads from port to starboard.
const WIDTH: usize = 6;
/// Heights of the rows of quads on the hull's sides, from keel to rail; the third row is the rubbing strake.
const LEVELS: [f64; 5] = [0.0, 0.4, 0.66, 0.76, 1.0];
/// Quads from keel to rail.
const HEIGHT: usize = LEVELS.len() - 1;

/// The faces of the hull's box by side, as grids.
struct Sides {
    deck: Vec<usize>,
    strake: Vec<usize>,
}

/// Builds the tugboat: x is forward, y up, z to starboard.
pub(super) fn hull() -> Result<ControlMesh> {
    let mut sketch = Sketch::default();
    let sides = shell(&mut sketch);
    strake(&mut sketch, &sides.strake);
    bulwark(&mut sketch, &sides.deck);
    deckhouse(&mut sketch, &sides.deck);
    wheelhouse(&mut sketch, &sides.deck);
    funnel(&mut sketch, &sides.deck);
    sketch.build()
}

/// The faces of the deck from station `from` to `to` and column `left` to `right`.
fn deck_part(deck: &[usize], [from, to]: [usize; 2], [left, right]: [usize; 2]) -> Vec<usize> {
    (from..to)
        .flat_map(|i| (left..right).map(move |k| deck[i * WIDTH + k]))
        .collect()
}

/// Where point (i, j, k) of the box lies on the hull.
fn hull_point(i: usize, j: usize, k: usize) -> DVec3 {
    let along = i as f64 / LENGTH as f64;
    let up = LEVELS[j];
    let across = 2.0 * k as f64 / WIDTH as f64 - 1.0;
    let bow = ((along - 0.45) / 0.55).max(0.0);
    let stern = (1.0 - along / 0.3).max(0.0);
    let beam = (1.0 - 0.3 * stern * stern) * (1.0 - 0.86 * bow.powf(2.4));
    let fullness = 0.55 - 0.25 * bow + (0.45 + 0.25 * bow) * up.powf(0.65 + 0.3 * bow);
    let keel = 0.45 * stern * stern + 0.2 * bow.powi(3);
    let rail = 1.15 + 0.6 * bow * bow + 0.12 * stern;
    let bottom = keel + 0.2 * across.abs() * (1.0 - up);
    // The ends bulge, and lean outwards towards the rail.
    let bulge = 1.0 - across * across;
    let ahead = bow.powi(4) * (0.55 * up + 0.16 * bulge);
    let astern = stern.powi(3) * (0.3 * up + 0.3 * bulge);
    DVec3::new(
        6.0 * along - 3.0 + ahead - astern,
        bottom + (rail - bottom) * up,
        across * beam * fullness,
    )
}

/// The six sides of the box.
fn shell(sketch: &mut Sketch) -> Sides {
    let mut numbers = std::collections::HashMap::new();
    let mut quad = |sketch: &mut Sketch, corners: [[usize; 3]; 4]| {
        let vertices = corners.map(|corner| {
            let [i, j, k] = corner;
            *numbers.entry(corner).or_insert_with(|| {
                let p = hull_point(i, j, k);
                sketch.point(p.x, p.y, p.z)
            })
        });
        sketch.face(&vertices)
    };
    let mut sides = Sides {
        deck: Vec::new(),
        strake: Vec::new(),
    };
    for i in 0..LENGTH {
        for k in 0..WIDTH {
            let (h, i1, k1) = (HEIGHT, i + 1, k + 1);
            quad(sketch, [[i, 0, k], [i1, 0, k], [i1, 0, k1], [i, 0, k1]]);
            sides.deck.push(quad(
                sketch,
                [[i, h, k], [i, h, k1], [i1, h, k1], [i1, h, k]],
            ));
        }
        for j in 0..HEIGHT {
            let (w, i1, j1) = (WIDTH, i + 1, j + 1);
            let port = quad(sketch, [[i, j, 0], [i, j1, 0], [i1, j1, 0], [i1, j, 0]]);
            let starboard = quad(sketch, [[i, j, w], [i1, j, w], [i1, j1, w], [i, j1, w]]);
            if j == 2 {
                sides.strake.extend([port, starboard]);
            }
        }
    }
    for k in 0..WIDTH {
        for j in 0..HEIGHT {
            let (l, j1, k1) = (LENGTH, j + 1, k + 1);
            let stern = quad(sketch, [[0, j, k], [0, j, k1], [0, j1, k1], [0, j1, k]]);
            let bow = quad(sketch, [[l, j, k], [l, j1, k], [l, j1, k1], [l, j, k1]]);
            if j == 2 {
                sides.strake.extend([stern, bow]);
            }
        }
    }
    sides
}

/// `p` moved by `distance` along the outward normal of the waterline, roughly.
fn outwards(p: DVec3, distance: f64) -> DVec3 {
    p + DVec3::new(0.12 * p.x.powi(3) / 9.0, 0.0, p.z).normalize() * distance
}

/// The rubbing strake: a belt around the hull.
fn strake(sketch: &mut Sketch, belt: &[usize]) {
    sketch.crease_outline(belt, 4.0);
    sketch.extrude(belt, |p| outwards(p, 0.07));
    sketch.crease_outline(belt, 2.5);
}

/// The rail, the inside of the bulwark and the deck.
fn bulwark(sketch: &mut Sketch, deck: &[usize]) {
    sketch.crease_outline(deck, 3.0);
    sketch.extrude(deck, |p| p * DVec3::new(0.965, 1.0, 0.88) + DVec3::Y * 0.02);
    sketch.crease_outline(deck, 3.0);
    sketch.extrude(deck, |p| p * DVec3::new(0.96, 0.97, 0.95) - DVec3::Y * 0.22);
    sketch.crease_outline(deck, 2.0);
}

/// The deckhouse with its portholes.
fn deckhouse(sketch: &mut Sketch, deck: &[usize]) {
    let house = deck_part(deck, [3, 8], [1, 5]);
    sketch.extrude(&house, |p| p.with_z(p.z.clamp(-0.48, 0.48)));
    sketch.crease_outline(&house, 3.0);
    let walls = sketch.extrude(&house, |p| p.with_y(1.62));
    sketch.crease_outline(&house, 2.0);
    let middle = sketch.centre(&house).x;
    for wall in walls {
        let centre = sketch.centre(&[wall]);
        if centre.z.abs() > 0.45 && (centre.x - middle).abs() < 0.8 {
            porthole(sketch, wall, 0.14);
        }
    }
    roof(sketch, &house, 1.05);
}

/// An octagonal window with a raised rim.
fn porthole(sketch: &mut Sketch, wall: usize, radius: f64) {
    sketch.octagon(wall, radius);
    let window = [wall];
    let centre = sketch.centre(&window);
    let out = sketch.normal(wall);
    sketch.crease_outline(&window, INFINITE_SHARPNESS);
    sketch.extrude(&window, |p| p + out * 0.04);
    sketch.crease_outline(&window, 3.0);
    sketch.extrude(&window, |p| centre + (p - centre) * 0.72 - out * 0.02);
    sketch.crease_outline(&window, INFINITE_SHARPNESS);
}

/// A roof that stands over its walls by `scale`.
fn roof(sketch: &mut Sketch, house: &[usize], scale: f64) {
    let centre = sketch.centre(house);
    // As far over the ends as over the sides, which are about half as long.
    let scales = DVec3::new(scale, 1.0, 2.0 * scale - 1.0);
    sketch.extrude(house, |p| centre + (p - centre) * scales);
    sketch.crease_outline(house, 3.0);
    sketch.extrude(house, |p| p + DVec3::Y * 0.07);
    sketch.crease_outline(house, 3.0);
}

/// The wheelhouse with windows all around.
fn wheelhouse(sketch: &mut Sketch, deck: &[usize]) {
    let house = deck_part(deck, [6, 8], [1, 5]);
    let middle = sketch.centre(&house);
    sketch.extrude(&house, |p| middle + (p - middle) * 0.8);
    sketch.crease_outline(&house, 3.0);
    sketch.extrude(&house, |p| p + DVec3::Y * 0.14);
    let walls = sketch.extrude(&house, |p| p + DVec3::new(0.03, 0.46, -0.03 * p.z));
    for wall in walls {
        let window = [wall];
        let centre = sketch.centre(&window);
        // Frame and reveal are creased all around, so that the windows are flat and their corners square.
        let inwards = sketch.normal(wall) * -0.018;
        for frame in sketch.extrude(&window, |p| centre + (p - centre) * 0.72) {
            sketch.crease_outline(&[frame], 4.0);
        }
        for reveal in sketch.extrude(&window, |p| p + inwards) {
            sketch.crease_outline(&[reveal], INFINITE_SHARPNESS);
        }
    }
    sketch.extrude(&house, |p| p + DVec3::Y * 0.04);
    sketch.crease_outline(&house, 3.0);
    roof(sketch, &house, 1.12);
}

/// The funnel: round, with a collar, and open at the top.
fn funnel(sketch: &mut Sketch, deck: &[usize]) {
    let flue = deck_part(deck, [4, 6], [2, 4]);
    let axis = sketch.centre(&flue).with_z(0.0);
    // Radius, height over the roof, and the sharpness of the ring.
    for (radius, rise, sharpness) in [
        (0.32, 0.0, 3.0),
        (0.28, 0.55, 4.0),
        (0.33, 0.57, 4.0),
        (0.33, 0.70, 4.0),
        (0.28, 0.72, 4.0),
        (0.29, 0.98, INFINITE_SHARPNESS),
        (0.24, 0.98, INFINITE_SHARPNESS),
        (0.22, 0.55, INFINITE_SHARPNESS),
    ] {
        let middle = axis + DVec3::new(-0.14 * rise, rise, 0.0);
        let here = sketch.centre(&flue);
        sketch.extrude(&flue, |p| {
            middle + ((p - here) * DVec3::new(1.0, 0.0, 1.0)).normalize_or_zero() * radius
        });
        sketch.crease_outline(&flue, sharpness);
    }
    sketch.cut(&flue);
}
