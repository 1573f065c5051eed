//! The plain shapes: each shows one thing that tests and pictures need.

use std::f64::consts::TAU;

use super::sketch::Sketch;
use crate::error::Result;
use crate::mesh::{BoundaryInterpolation, ControlMesh};

/// The faces of a box whose corners are numbered x + 2 y + 4 z.
const BOX: [[u32; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

/// The faces of an icosahedron, counter-clockwise from outside: a top, two bands and a bottom.
const ICOSAHEDRON: [[usize; 3]; 20] = [
    [0, 1, 2],
    [0, 2, 3],
    [0, 3, 4],
    [0, 4, 5],
    [0, 5, 1],
    [1, 6, 2],
    [2, 7, 3],
    [3, 8, 4],
    [4, 9, 5],
    [5, 10, 1],
    [6, 7, 2],
    [7, 8, 3],
    [8, 9, 4],
    [9, 10, 5],
    [10, 6, 1],
    [11, 7, 6],
    [11, 8, 7],
    [11, 9, 8],
    [11, 10, 9],
    [11, 6, 10],
];

fn add_cube(sketch: &mut Sketch, least: [f64; 3], size: f64) {
    let corners: [u32; 8] = std::array::from_fn(|i| {
        let [x, y, z] = [0, 1, 2].map(|axis| least[axis] + size * ((i >> axis) & 1) as f64);
        sketch.point(x, y, z)
    });
    for face in BOX {
        sketch.face(&face.map(|corner| corners[corner as usize]));
    }
}

/// A cube from -1 to 1.
pub(super) fn cube() -> Result<ControlMesh> {
    let mut sketch = Sketch::default();
    add_cube(&mut sketch, [-1.0; 3], 2.0);
    sketch.build()
}

/// A lattice of separate cubes around the origin.
pub(super) fn cubes(counts: [u32; 3]) -> Result<ControlMesh> {
    const PITCH: f64 = 1.5;
    let mut sketch = Sketch::default();
    let least = |axis: usize, number: u32| {
        PITCH * (f64::from(number) - 0.5 * f64::from(counts[axis] - 1)) - 0.5
    };
    for z in 0..counts[2] {
        for y in 0..counts[1] {
            for x in 0..counts[0] {
                add_cube(&mut sketch, [least(0, x), least(1, y), least(2, z)], 1.0);
            }
        }
    }
    sketch.build()
}

/// A torus of 16 by 8 quads; three of its long loops are creases of sharpness 4.7.
pub(super) fn creased_torus() -> Result<ControlMesh> {
    const ROUND: u32 = 16;
    const TUBE: u32 = 8;
    let mut sketch = Sketch::default();
    for i in 0..ROUND {
        for j in 0..TUBE {
            let (long, short) = (
                TAU * f64::from(i) / f64::from(ROUND),
                TAU * f64::from(j) / f64::from(TUBE),
            );
            let radius = 1.0 + 0.4 * short.cos();
            sketch.point(radius * long.cos(), 0.4 * short.sin(), radius * long.sin());
        }
    }
    let number = |i: u32, j: u32| (i % ROUND) * TUBE + j % TUBE;
    for i in 0..ROUND {
        for j in 0..TUBE {
            sketch.face(&[
                number(i, j),
                number(i, j + 1),
                number(i + 1, j + 1),
                number(i + 1, j),
            ]);
        }
    }
    for j in [0, 2, 5] {
        let ring: Vec<u32> = (0..ROUND).map(|i| number(i, j)).collect();
        sketch.crease_loop(&ring, 4.7);
    }
    sketch.build()
}

/// A wavy sheet of 8 by 8 quads with sharp corners; two of its faces are holes.
pub(super) fn sheet() -> Result<ControlMesh> {
    const SIDE: u32 = 8;
    let mut sketch = Sketch::default();
    sketch.options.boundary = BoundaryInterpolation::EdgeAndCorner;
    for i in 0..=SIDE {
        for j in 0..=SIDE {
            let [x, z] = [i, j].map(|k| 2.0 * f64::from(k) / f64::from(SIDE) - 1.0);
            sketch.point(x, 0.3 * (3.0 * x).sin() * (2.0 * z).cos(), z);
        }
    }
    let number = |i: u32, j: u32| i * (SIDE + 1) + j;
    for i in 0..SIDE {
        for j in 0..SIDE {
            let face = sketch.face(&[
                number(i, j),
                number(i, j + 1),
                number(i + 1, j + 1),
                number(i + 1, j),
            ]);
            if matches!((i, j), (2, 5) | (5, 2)) {
                sketch.hole(face);
            }
        }
    }
    sketch.build()
}

/// A fan of `valence` triangles around one vertex, and a ring of quads around the fan.
pub(super) fn pole(valence: u32) -> Result<ControlMesh> {
    let mut sketch = Sketch::default();
    let top = sketch.point(0.0, 0.5, 0.0);
    for (radius, height) in [(0.5, 0.3), (1.0, -0.3)] {
        for i in 0..valence {
            let angle = TAU * f64::from(i) / f64::from(valence);
            sketch.point(radius * angle.cos(), height, radius * angle.sin());
        }
    }
    let number = |ring: u32, i: u32| 1 + ring * valence + i % valence;
    for i in 0..valence {
        sketch.face(&[top, number(0, i + 1), number(0, i)]);
    }
    for i in 0..valence {
        sketch.face(&[
            number(0, i),
            number(0, i + 1),
            number(1, i + 1),
            number(1, i),
        ]);
    }
    sketch.build()
}

/// A truncated icosahedron whose hexagons are whole, halved into quads or fanned into triangles, in turn.
pub(super) fn ngons() -> Result<ControlMesh> {
    let mut sketch = Sketch::default();
    let corners = icosahedron();
    // Point `cut[a][b]` lies on edge a-b, a third of the way from a.
    let mut cut = [[0; 12]; 12];
    for [a, b] in ICOSAHEDRON
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
    {
        let p = (corners[a] * 2.0 + corners[b]) / 3.0;
        cut[a][b] = sketch.point(p.x, p.y, p.z);
    }
    for (i, &[a, b, c]) in ICOSAHEDRON.iter().enumerate() {
        let rim = [
            cut[a][b], cut[b][a], cut[b][c], cut[c][b], cut[c][a], cut[a][c],
        ];
        match i % 3 {
            0 => {
                sketch.face(&rim);
            }
            1 => {
                sketch.face(&rim[..4]);
                sketch.face(&[rim[3], rim[4], rim[5], rim[0]]);
            }
            _ => {
                let p = (corners[a] + corners[b] + corners[c]) / 3.0;
                let middle = sketch.point(p.x, p.y, p.z);
                for j in 0..6 {
                    sketch.face(&[middle, rim[j], rim[(j + 1) % 6]]);
                }
            }
        }
    }
    for (a, around) in cut.iter().enumerate() {
        let pentagon: Vec<u32> = neighbours(a).into_iter().map(|b| around[b]).collect();
        sketch.face(&pentagon);
        sketch.crease_loop(&pentagon, 2.0);
    }
    sketch.build()
}

/// The neighbours of vertex `a` of the icosahedron, counter-clockwise from outside.
fn neighbours(a: usize) -> Vec<usize> {
    let after = |b: usize| {
        ICOSAHEDRON.iter().find_map(|&[p, q, r]| {
            [[p, q, r], [q, r, p], [r, p, q]]
                .into_iter()
                .find(|turned| turned[..2] == [a, b])
                .map(|turned| turned[2])
        })
    };
    let start = (0..12).find(|&b| after(b).is_some());
    let mut ring: Vec<usize> = start.into_iter().collect();
    while let Some(next) = ring.last().and_then(|&b| after(b)) {
        if Some(next) == start {
            break;
        }
        ring.push(next);
    }
    ring
}

/// The corners of an icosahedron of radius 1: top, two rings of five, bottom.
fn icosahedron() -> [glam::DVec3; 12] {
    let height = 0.2f64.sqrt();
    let radius = 2.0 * height;
    std::array::from_fn(|i| match i {
        0 => glam::DVec3::Y,
        11 => glam::DVec3::NEG_Y,
        _ => {
            let lower = i > 5;
            // The lower ring is turned by half a step, so that its vertex 6 lies between 1 and 2.
            let turn = (i - 1) % 5;
            let angle = -TAU * (turn as f64 + if lower { 0.5 } else { 0.0 }) / 5.0;
            let y = if lower { -height } else { height };
            glam::DVec3::new(radius * angle.cos(), y, radius * angle.sin())
        }
    })
}
