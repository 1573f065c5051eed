//! How cells become leaves of a tree: adaptive refinement, level by level (Brainerd et al. 2016, section 4.1).

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::plan::configuration::Configuration;
use crate::plan::level::{Level, Steps};
use crate::plan::options::PlanOptions;
use crate::plan::quarter::{Placed, Quarter};
use crate::plan::ring::Ring;
use crate::plan::rows::Rows;
use crate::plan::tree::{Node, Tree};
use crate::subdivision::{BsplinePatch, ControlPoint};

/// After one level every cell touches a corner of the face; the coordinates of tess level 2 need cells that do not.
pub(super) const SHALLOWEST: u32 = 2;

/// Semi-sharp features are gone after ten levels; a cell inside a face is a B-spline then.
pub(super) const DEEPEST: u32 = 11;

/// A cell that needs no children.
#[derive(Clone, Copy)]
pub(super) enum Leaf<'a> {
    Spline(&'a BsplinePatch),
    Extraordinary(u32),
}

impl<'a> Leaf<'a> {
    /// A cell of a level as a leaf, or None when it must be refined. `corner` is that of the face that it touches, if any.
    pub fn of(
        level: &'a Level<'_>,
        cell: u32,
        corner: Option<u32>,
        depth: u32,
        options: PlanOptions,
    ) -> Option<Leaf<'a>> {
        let last = depth >= options.max_level.max(SHALLOWEST);
        let direct = options.direct_creases || last;
        match (level.patch(cell), corner) {
            (Some(patch), _) if patch.crease.is_none() || direct => Some(Leaf::Spline(patch)),
            (_, Some(corner)) if last => Some(Leaf::Extraordinary(corner)),
            _ => {
                assert!(
                    depth < DEEPEST,
                    "a cell inside a face is a B-spline once no semi-sharp crease is left"
                );
                None
            }
        }
    }

    /// The leaf as a node, its control points by their numbers.
    pub fn node(self, base: Option<u32>, number: impl FnMut(ControlPoint) -> u32) -> Node {
        let patch = match self {
            Leaf::Spline(patch) => patch,
            Leaf::Extraordinary(corner) => return Node::Extraordinary { corner },
        };
        let points = patch.points.map(number);
        match patch.crease {
            None => Node::Regular {
                points,
                mirrored: patch.mirrored,
                base,
            },
            Some((edge, sharpness)) => Node::Crease {
                points,
                edge,
                sharpness,
                base,
            },
        }
    }
}

/// The quarter of a face's level 1 that touches the corner, and how it lies there.
pub(super) fn quarter(
    level: &Level<'_>,
    corner: u32,
    options: PlanOptions,
    steps: &Steps,
) -> (Arc<Quarter>, Placed) {
    let ring = Ring::of_part(level.topology(), corner, corner);
    let ring = ring.expect("quarters have four corners");
    let placed = Placed::new(corner, ring.mirrored, ring.vertices);
    let key = (options, ring.configuration);
    if let Some(known) = steps.quarters.get(&key) {
        return (known, placed);
    }
    let quarter = grow(&key.1, options, steps);
    let quarter = match quarter.is_large() {
        true => quarter.into(),
        false => steps.quarters.keep(key, quarter),
    };
    (quarter, placed)
}

/// What became of a cell at its level.
enum Grown {
    Leaf(Node),
    /// Four cells of the next level, from this number on.
    Children(usize),
}

/// Refines level by level until every cell is a leaf.
fn grow(configuration: &Configuration, options: PlanOptions, steps: &Steps) -> Quarter {
    let mut level = Level::whole(configuration, steps);
    let mut rows = Rows::zero_in(steps.memory(), level.rows.width(), 0);
    let mut grown: Vec<Vec<Grown>> = Vec::new();
    let mut cells = vec![Some(0)];
    for depth in 1.. {
        let mut numbers: FxHashMap<ControlPoint, u32> = FxHashMap::default();
        let mut number = |point: ControlPoint| {
            *numbers.entry(point).or_insert_with(|| {
                rows.push(|row| level.rows.add_to(row, &point.mask()));
                rows.len() as u32 - 1
            })
        };
        let mut next = Vec::new();
        let mut parents = Vec::new();
        let mut row = Vec::with_capacity(cells.len());
        for (cell, &corner) in (0..).zip(&cells) {
            if let Some(leaf) = Leaf::of(&level, cell, corner, depth, options) {
                row.push(Grown::Leaf(leaf.node(Some(0), &mut number)));
                continue;
            }
            row.push(Grown::Children(next.len()));
            next.extend((0..4).map(|own| corner.filter(|&corner| corner == own)));
            parents.extend((0..4).map(|corner| (cell, corner)));
        }
        grown.push(row);
        if next.is_empty() {
            break;
        }
        level = level.refined(&parents);
        cells = next;
    }
    let mut terms = Vec::new();
    let ends = (0..rows.len()).map(|number| {
        let weights = (0..).zip(rows.row(number).iter().copied());
        terms.extend(weights.filter(|term| term.1 != 0.0));
        terms.len()
    });
    let ends = ends.collect();
    steps.leave(rows);
    Quarter::new(join(&grown, 0, 0), ends, terms)
}

/// The tree under cell `number` of level `depth`.
fn join(grown: &[Vec<Grown>], depth: usize, number: usize) -> Tree {
    match &grown[depth][number] {
        Grown::Leaf(node) => Tree::Leaf(node.clone()),
        Grown::Children(first) => Tree::of_corners(
            [0, 1, 2, 3].map(|corner| join(grown, depth + 1, first + corner as usize)),
        ),
    }
}
