//! Points that are computed from the control vertices before patches are drawn: limits, vertices of the next level, vertex normals.
//!
//! Each point has rows: lists of weighted vertices, made once a topology. A mesh that moves only applies them again, here with all cores, or
//! in `glsl/points.comp`, of which this is the twin. Both give the same bits: sums run in the order of the terms, and unit vectors are made
//! by additions and multiplications alone, which Vulkan wants correctly rounded (Vulkan spec, "Precision of Individual Operations"), where
//! square roots are not.

use glam::Vec3;
use rayon::prelude::*;

use crate::abi::{self, Point, PointRow, PointStep, PointTerm};
use crate::method::unit::unit;
use crate::subdivision::Mask;

/// How points are computed, step by step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// How many points there are.
    pub count: u32,
    /// The steps, each after the one before.
    pub steps: Vec<PointStep>,
    /// A row a point of each step.
    pub rows: Vec<PointRow>,
    /// What the rows consist of.
    pub terms: Vec<PointTerm>,
}

/// What a point becomes in a step. Masks of a limit may name different vertices.
#[derive(Clone, Copy, Debug)]
pub enum Row<'a> {
    /// Position from control vertices.
    Blend(&'a Mask),
    /// Position and tangents from control vertices.
    Limit([&'a Mask; 3]),
    /// Normal of the faces between the `ends` around a point, counter-clockwise.
    Ring {
        /// The point in the middle.
        middle: u32,
        /// The far ends of its edges.
        ends: &'a [u32],
        /// Whether there is no face between the last and the first.
        open: bool,
    },
    /// Normal from those of other points.
    Normals(&'a Mask),
}

impl Points {
    /// Begins a step whose rows compute the points from `first_point` on.
    pub fn begin(&mut self, kind: u32, first_point: u32) {
        self.steps.push(PointStep {
            kind,
            first_row: self.rows.len() as u32,
            first_point,
            count: 0,
        });
    }

    /// Adds the next row to the last step.
    pub fn push(&mut self, row: Row<'_>) {
        let first = self.terms.len() as u32;
        let mut flags = 0;
        match row {
            Row::Blend(mask) | Row::Normals(mask) => self
                .terms
                .extend(mask.iter().map(|&(v, w)| term(v, w, 0.0, 0.0))),
            Row::Limit(masks) => self.terms.extend(joined(masks)),
            Row::Ring { middle, ends, open } => {
                let all = std::iter::once(&middle).chain(ends);
                self.terms
                    .extend(all.map(|&vertex| term(vertex, 0.0, 0.0, 0.0)));
                flags = if open { abi::ROW_OPEN } else { 0 };
            }
        }
        let count = self.terms.len() as u32 - first;
        self.rows.push(PointRow {
            first,
            count: count | flags,
        });
        let step = self.steps.last_mut().expect("a step was begun");
        step.count += 1;
        self.count = self.count.max(step.first_point + step.count);
    }

    /// The points of control vertices.
    pub fn compute(&self, vertices: &[Vec3]) -> Vec<Point> {
        let mut points = vec![Point::default(); self.count as usize];
        for step in &self.steps {
            let computed: Vec<Point> = (0..step.count)
                .into_par_iter()
                .map(|i| {
                    let row = self.rows[(step.first_row + i) as usize];
                    let before = points[(step.first_point + i) as usize];
                    self.row(step.kind, row, vertices, &points, before)
                })
                .collect();
            let first = step.first_point as usize;
            points[first..first + computed.len()].copy_from_slice(&computed);
        }
        points
    }

    fn row(
        &self,
        kind: u32,
        row: PointRow,
        vertices: &[Vec3],
        points: &[Point],
        before: Point,
    ) -> Point {
        let count = (row.count & !abi::ROW_OPEN) as usize;
        let terms = &self.terms[row.first as usize..][..count];
        let vertex = |term: &PointTerm| vertices[term.source as usize];
        let sum = |weight: fn(&PointTerm) -> f32| {
            terms
                .iter()
                .fold(Vec3::ZERO, |sum, term| sum + weight(term) * vertex(term))
        };
        let position = |term: &PointTerm| Vec3::from(points[term.source as usize].position);
        match kind {
            abi::POINTS_BLEND => Point {
                position: sum(|term| term.position).to_array(),
                ..before
            },
            abi::POINTS_LIMIT => {
                let (du, dv) = (sum(|term| term.du), sum(|term| term.dv));
                let normal = unit(unit(du).cross(unit(dv)));
                Point {
                    position: sum(|term| term.position).to_array(),
                    normal: normal.to_array(),
                }
            }
            abi::POINTS_RING => {
                let middle = position(&terms[0]);
                let spokes: Vec<Vec3> = terms[1..]
                    .iter()
                    .map(|term| position(term) - middle)
                    .collect();
                let faces = spokes
                    .len()
                    .saturating_sub(usize::from(row.count & abi::ROW_OPEN != 0));
                let normal = (0..faces).fold(Vec3::ZERO, |sum, i| {
                    sum + spokes[i].cross(spokes[(i + 1) % spokes.len()])
                });
                Point {
                    normal: unit(normal).to_array(),
                    ..before
                }
            }
            _ => {
                let normal = terms.iter().fold(Vec3::ZERO, |sum, term| {
                    sum + term.position * Vec3::from(points[term.source as usize].normal)
                });
                Point {
                    normal: unit(normal).to_array(),
                    ..before
                }
            }
        }
    }
}

fn term(source: u32, position: f64, du: f64, dv: f64) -> PointTerm {
    PointTerm {
        source,
        position: position as f32,
        du: du as f32,
        dv: dv as f32,
    }
}

/// The terms of three masks, each vertex once, and the greatest weight of the position last: so a sum of hundreds keeps its last places.
fn joined(masks: [&Mask; 3]) -> Vec<PointTerm> {
    let mut vertices: Vec<u32> = masks
        .iter()
        .flat_map(|mask| mask.iter().map(|&(v, _)| v))
        .collect();
    vertices.sort_unstable();
    vertices.dedup();
    let weight = |mask: &Mask, vertex: u32| -> f64 {
        mask.iter()
            .filter(|&&(v, _)| v == vertex)
            .map(|&(_, w)| w)
            .sum()
    };
    let weights = |vertex: u32| (vertex, masks.map(|mask| weight(mask, vertex)));
    let mut terms: Vec<(u32, [f64; 3])> = vertices.into_iter().map(weights).collect();
    terms.sort_by(|(_, [a, ..]), (_, [b, ..])| a.abs().total_cmp(&b.abs()));
    terms
        .into_iter()
        .map(|(v, [position, du, dv])| term(v, position, du, dv))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_have_the_normal_of_their_plane() {
        let corners = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let mut vertices = vec![Vec3::new(0.0, 0.0, 5.0)];
        vertices.extend(corners.map(|[x, y]| Vec3::new(x, y, 5.0)));
        for (ends, open) in [
            (&[1, 2, 3, 4][..], false),
            (&[1, 2, 3], true),
            (&[2, 3], true),
        ] {
            let mut points = Points::default();
            points.begin(abi::POINTS_BLEND, 0);
            for vertex in 0..5 {
                points.push(Row::Blend(&Mask::from_slice(&[(vertex, 1.0)])));
            }
            points.begin(abi::POINTS_RING, 0);
            points.push(Row::Ring {
                middle: 0,
                ends,
                open,
            });
            let computed = points.compute(&vertices);
            assert_eq!(computed[0].position, [0.0, 0.0, 5.0]);
            assert!(Vec3::from(computed[0].normal).distance(Vec3::Z) < 3e-7);
        }
    }
}
