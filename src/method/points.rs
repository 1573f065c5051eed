//! Points that are computed from the control vertices before patches are drawn: limits, vertices of the next level, vertex normals.
//!
//! Each point has rows: lists of weighted vertices, made once a topology. A mesh that moves only applies them again, here with all cores, or
//! in `glsl/points.comp`, of which this is the twin. Both give the same bits: sums run in the order of the terms, and unit vectors are made
//! by additions and multiplications alone, which Vulkan wants correctly rounded (Vulkan spec, "Precision of Individual Operations"), where
//! square roots are not.
//!
//! An engine may write any floats as positions. For normals they are brought to about unit size first, by the power of two of the greatest of a row's: in
//! floats, squares leave the range beyond 1e19 and below 1e-19. Bits are not promised where some positions of a row are 2^100 times as large as
//! others, or subnormal.

use glam::Vec3;
use rayon::prelude::*;

use crate::abi::{self, Point, PointRow, PointStep, PointTerm};
use crate::method::stage::Span;
use crate::method::surface::{CLEAR, Tangents, UNIT, reach};
use crate::method::unit::{factor_for, greatest_exponent, sized, unit};
use crate::subdivision::{Blend, Mask};

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
    /// Of steps of which frames need parts.
    pub(super) spans: Vec<Span>,
}

/// What a point becomes in a step. Masks of a limit may name different vertices.
#[derive(Clone, Copy, Debug)]
pub(super) enum Row<'a> {
    /// Position from control vertices, or from points of earlier steps.
    Blend(&'a Mask),
    /// Position and tangents from control vertices.
    Limit([&'a Mask; 3]),
    /// The same; tangents that are nearly parallel, or of which one is far longer, give no normal.
    Firm([&'a Mask; 3]),
    /// Normal of the faces between the `ends` around a point, counter-clockwise.
    Ring {
        /// The point in the middle.
        middle: u32,
        /// The far ends of its edges.
        ends: &'a [u32],
        /// Whether there is no face between the last and the first.
        open: bool,
    },
    /// Position from control vertices, relative to one of them.
    Hub {
        /// Which.
        anchor: u32,
        /// The sum, whose weights have the sum 1.
        mask: &'a Mask,
    },
    /// Normal from those of other points; or that nearby.
    Normals(&'a Mask),
}

impl Points {
    /// Begins a step whose rows compute the points from `first_point` on.
    pub(super) fn begin(&mut self, kind: u32, first_point: u32) {
        self.steps.push(PointStep {
            kind,
            first_row: self.rows.len() as u32,
            first_point,
            count: 0,
        });
    }

    /// Adds the next row to the last step.
    pub(super) fn push(&mut self, row: Row<'_>) {
        let first = self.terms.len() as u32;
        let mut flags = 0;
        match row {
            Row::Blend(mask) | Row::Normals(mask) => self
                .terms
                .extend(mask.iter().map(|&(v, w)| term(v, w, 0.0, 0.0))),
            Row::Hub { anchor, mask } => {
                self.terms.push(term(anchor, 0.0, 0.0, 0.0));
                let beside = mask.iter().filter(|term| term.0 != anchor);
                let beside = beside.map(|&(v, w)| term(v, w, 0.0, 0.0));
                self.terms.extend(beside);
            }
            Row::Limit(masks) => self.terms.extend(joined(masks)),
            Row::Firm(masks) => {
                self.terms.extend(joined(masks));
                flags = abi::ROW_FIRM;
            }
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

    /// A step of positions from control vertices.
    pub(super) fn blend(&mut self, first_point: u32, masks: &[Mask]) {
        self.begin(abi::POINTS_BLEND, first_point);
        for mask in masks {
            self.push(Row::Blend(&ascending(mask)));
        }
    }

    /// Says of the last step where the rows of each irregularity end, and at which depths they are needed.
    pub(super) fn span(&mut self, depths: [u32; 2], ends: Vec<u32>) {
        let step = self.steps.len() - 1;
        self.spans.push(Span { step, depths, ends });
    }

    /// The steps, each of parts that do not wait for one another; at depths of irregularities those that are needed, else all.
    pub(crate) fn steps_at(&self, depths: Option<&[u32]>) -> Vec<Vec<PointStep>> {
        let parts = |(number, step): (usize, &PointStep)| {
            let span = self.spans.iter().find(|span| span.step == number);
            match (span, depths) {
                (Some(span), Some(depths)) => span.needed(step, depths),
                _ => vec![*step],
            }
        };
        let steps = self.steps.iter().enumerate().map(parts);
        let steps = steps.map(|mut parts| {
            parts.retain(|part| part.count > 0);
            parts
        });
        steps.filter(|parts| !parts.is_empty()).collect()
    }

    /// The points of control vertices, of which none that is named lacks.
    pub(crate) fn compute(&self, vertices: &[Vec3]) -> Vec<Point> {
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
        let count = (row.count & !(abi::ROW_OPEN | abi::ROW_FIRM)) as usize;
        let terms = &self.terms[row.first as usize..][..count];
        let sum = || {
            terms.iter().fold(Vec3::ZERO, |sum, term| {
                sum + term.position * vertices[term.source as usize]
            })
        };
        let of_points = || {
            let position = |term: &PointTerm| Vec3::from(points[term.source as usize].position);
            let weighted = terms.iter().map(|term| term.position * position(term));
            let (mut sum, mut lost) = (Vec3::ZERO, Vec3::ZERO);
            for term in weighted {
                let rest = term - lost;
                let next = sum + rest;
                // Of many terms, by what rounding takes away from each step (Kahan 1965).
                if count > abi::CONTROL_INVOCATIONS as usize {
                    lost = (next - sum) - rest;
                }
                sum = next;
            }
            sum
        };
        let normal = match kind {
            abi::POINTS_BLEND => {
                return Point {
                    position: sum().to_array(),
                    ..before
                };
            }
            abi::POINTS_REFINE => {
                return Point {
                    position: of_points().to_array(),
                    ..before
                };
            }
            abi::POINTS_HUB => return hub(terms, vertices),
            abi::POINTS_LIMIT => {
                let firm = row.count & abi::ROW_FIRM != 0;
                return Point {
                    position: sum().to_array(),
                    normal: tangent_normal(terms, vertices, firm).to_array(),
                };
            }
            abi::POINTS_SPARE if before.normal != [0.0; 3] => before.normal.into(),
            abi::POINTS_SPARE => tangent_normal(terms, vertices, false),
            abi::POINTS_NEARBY | abi::POINTS_CUSP => {
                let nearby = mean_normal(terms, points);
                let own = Vec3::from(before.normal);
                let counts = kind == abi::POINTS_NEARBY && Tangents::are_near(own, nearby);
                if nearby == Vec3::ZERO || counts {
                    own
                } else {
                    nearby
                }
            }
            abi::POINTS_RING => ring_normal(terms, points, row.count & abi::ROW_OPEN != 0),
            _ => mean_normal(terms, points),
        };
        Point {
            normal: normal.to_array(),
            ..before
        }
    }
}

/// A sum relative to the vertex of its first term, by what rounding takes away from each step (Kahan 1965): so it errs by what its distance from there has for
/// rounding, wherever that is and however many terms there are.
fn hub(terms: &[PointTerm], vertices: &[Vec3]) -> Point {
    let vertex = |term: &PointTerm| vertices[term.source as usize];
    let origin = terms.first().map_or(Vec3::ZERO, vertex);
    let (mut sum, mut lost) = (Vec3::ZERO, Vec3::ZERO);
    for term in terms {
        let rest = term.position * (vertex(term) - origin) - lost;
        let next = sum + rest;
        lost = (next - sum) - rest;
        sum = next;
    }
    Point {
        position: sum.to_array(),
        normal: origin.to_array(),
    }
}

/// The mask with each vertex once, and the greatest weight last: sums of hundreds of terms, at vertices of high valence, keep their last places
/// so.
pub(super) fn ascending(mask: &Mask) -> Mask {
    let mut merged = Mask::blend(&[(0, 1.0)], std::slice::from_ref(mask));
    merged.sort_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    merged
}

/// The normal of two tangents over the control vertices, relative to that of the last term, which has the greatest weight: so little is lost where
/// they are small beside the model. Zero where rounding may have made it.
fn tangent_normal(terms: &[PointTerm], vertices: &[Vec3], firm: bool) -> Vec3 {
    let given = |term: &PointTerm| vertices[term.source as usize];
    let factor = common_factor(terms.iter().map(given));
    if factor == 0.0 {
        return Vec3::ZERO;
    }
    let vertex = |term: &PointTerm| sized(given(term), factor);
    let origin = terms.last().map_or(Vec3::ZERO, vertex);
    let mut tangents = Tangents::default();
    let (mut spread, mut total) = ([0.0; 2], [0.0; 2]);
    for term in terms {
        let spoke = vertex(term) - origin;
        for (i, weight) in [term.du, term.dv].into_iter().enumerate() {
            tangents.sums[i] += weight * spoke;
            spread[i] += weight.abs() * reach(spoke);
            total[i] += weight.abs();
        }
    }
    let roundings = terms.len() as f32 + 4.0;
    tangents.errors = [0, 1].map(|i| UNIT * (roundings * spread[i] + reach(origin) * total[i]));
    if firm && !tangents.are_firm() {
        return Vec3::ZERO;
    }
    tangents.normal()
}

/// The weighted mean of other points' normals; zero where they cancel, as opposite ones do: what is left is then rounding.
fn mean_normal(terms: &[PointTerm], points: &[Point]) -> Vec3 {
    let sum = terms.iter().fold(Vec3::ZERO, |sum, term| {
        sum + term.position * Vec3::from(points[term.source as usize].normal)
    });
    if sum.dot(sum) > CANCELLED {
        unit(sum)
    } else {
        Vec3::ZERO
    }
}

/// The square of what a sum of unit normals has to be at least; as in `subdivision/normals.rs`.
const CANCELLED: f32 = 1.0 / 256.0;

/// The power of two that brings the greatest of some positions to about unit size; 0 where there is none.
fn common_factor(positions: impl Iterator<Item = Vec3>) -> f32 {
    factor_for(positions.map(greatest_exponent).max().unwrap_or(0))
}

/// The areas of the triangles between the spokes of a ring.
fn ring_normal(terms: &[PointTerm], points: &[Point], open: bool) -> Vec3 {
    let given = |term: &PointTerm| Vec3::from(points[term.source as usize].position);
    let factor = common_factor(terms.iter().map(given));
    if factor == 0.0 {
        return Vec3::ZERO;
    }
    let position = |term: &PointTerm| sized(given(term), factor);
    let middle = position(&terms[0]);
    let spokes: Vec<Vec3> = terms[1..]
        .iter()
        .map(|term| position(term) - middle)
        .collect();
    let faces = spokes.len().saturating_sub(usize::from(open));
    let (mut normal, mut spread, mut total) = (Vec3::ZERO, 0.0, 0.0);
    for i in 0..faces {
        let (a, b) = (spokes[i], spokes[(i + 1) % spokes.len()]);
        normal += a.cross(b);
        spread += reach(a) * reach(b);
        total += reach(a) + reach(b);
    }
    // Each spoke errs by the rounding of both its ends, and each product by that and by its own.
    let roundings = faces as f32 + 4.0;
    let error = UNIT * (2.0 * roundings * spread + 4.0 * reach(middle) * total);
    if reach(normal) > CLEAR * error {
        unit(normal)
    } else {
        Vec3::ZERO
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
    let of_mask = |(number, mask): (usize, &Mask)| {
        let weight = move |&(vertex, weight): &(u32, f64)| {
            let mut weights = [0.0; 3];
            weights[number] = weight;
            (vertex, weights)
        };
        mask.iter().map(weight).collect::<Vec<_>>()
    };
    let mut terms: Vec<(u32, [f64; 3])> = masks.into_iter().enumerate().flat_map(of_mask).collect();
    // What a vertex has in a mask is added in the mask's order.
    terms.sort_by_key(|&(vertex, _)| vertex);
    terms.dedup_by(|next, sum| {
        let alike = next.0 == sum.0;
        if alike {
            sum.1 = std::array::from_fn(|i| sum.1[i] + next.1[i]);
        }
        alike
    });
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
