//! What is below a quarter of a face that is no leaf.
//!
//! A quarter's limit is decided by its own surroundings, one level down, and these repeat more often than those of faces: the four quarters of a face meet
//! in all combinations. So each is grown once, as sums over its own ring, and the plans of faces put theirs together: turned and mirrored as the quarter
//! lies, with sums over the face's ring in place of the quarter's.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::plan::builder::PlanOptions;
use crate::plan::configuration::{Configuration, Ring};
use crate::plan::level::{Level, Steps};
use crate::plan::rows::Rows;
use crate::plan::tree::{Node, Tree, child_of_corner};
use crate::subdivision::{BsplinePatch, ControlPoint, Mask};

/// After one level every cell touches a corner of the face; the coordinates of tess level 2 need cells that do not.
pub(super) const SHALLOWEST: u32 = 2;

/// Semi-sharp features are gone after ten levels; a cell inside a face is a B-spline then.
pub(super) const DEEPEST: u32 = 11;

/// A quarter of more terms is of a pole.
const LARGE: usize = 1 << 13;

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

/// A quarter, seen from its corner of the face: that is corner 0 of both.
pub(super) struct Quarter {
    /// The cells, whose control points are numbers of sums.
    tree: Tree,
    /// Where the terms of each sum end.
    ends: Vec<usize>,
    /// Vertices of the quarter's ring, and their weights.
    terms: Vec<(u32, f64)>,
}

/// What became of a cell at its level.
enum Grown {
    Leaf(Node),
    /// Four cells of the next level, from this number on.
    Children(usize),
}

impl Quarter {
    /// The one of a face's level 1 that touches the corner, and how it lies there.
    pub fn of(
        level: &Level<'_>,
        corner: u32,
        options: PlanOptions,
        steps: &Steps,
    ) -> (Arc<Quarter>, Placed) {
        let ring = Ring::of_part(level.topology(), corner, corner);
        let ring = ring.expect("quarters have four corners");
        let placed = Placed {
            corner,
            mirrored: ring.mirrored,
            ring: ring.vertices,
        };
        (steps.quarter(ring.configuration, options), placed)
    }

    /// Refines level by level until every cell is a leaf.
    pub fn grow(configuration: &Configuration, options: PlanOptions, steps: &Steps) -> Quarter {
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
        Quarter {
            tree: join(&grown, 0, 0),
            ends,
            terms,
        }
    }

    /// Whether it is hardly ever needed again, and takes much memory.
    pub fn is_large(&self) -> bool {
        self.terms.len() > LARGE
    }

    /// The cells as they lie in a face, whose sums begin at this number.
    pub fn tree(&self, placed: &Placed, first: u32) -> Tree {
        placed.tree(&self.tree, first)
    }

    /// The sums over the vertices of the face's level 1.
    pub fn masks<'a>(&'a self, placed: &'a Placed) -> impl Iterator<Item = Mask> + 'a {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| {
            let terms = self.terms[start..end].iter();
            terms
                .map(|&(place, weight)| (placed.ring[place as usize], weight))
                .collect()
        })
    }
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

/// How a quarter lies in a face.
pub(super) struct Placed {
    /// The face's corner that is the quarter's corner 0.
    corner: u32,
    /// Whether it lies there as in a mirror.
    mirrored: bool,
    /// The vertices of its ring, by their numbers in the face's level 1.
    ring: Vec<u32>,
}

impl Placed {
    /// The face's corner at a corner of the quarter.
    fn corner(&self, own: u32) -> u32 {
        (self.corner + if self.mirrored { 4 - own } else { own }) % 4
    }

    /// The edge from a corner of the quarter to the next.
    fn edge(&self, own: u32) -> u32 {
        self.corner(own + u32::from(self.mirrored))
    }

    /// Control points, number x + 4 y.
    fn points(&self, own: &[u32; 16], first: u32) -> [u32; 16] {
        let mut points = [0; 16];
        for (i, point) in own.iter().enumerate() {
            let [mut x, mut y] = [i % 4, i / 4];
            if self.mirrored {
                (x, y) = (y, x);
            }
            for _ in 0..self.corner {
                (x, y) = (3 - y, x);
            }
            points[x + 4 * y] = first + point;
        }
        points
    }

    fn tree(&self, own: &Tree, first: u32) -> Tree {
        let node = match own {
            Tree::Inner(children) => {
                let mut corners: [Option<Tree>; 4] = Default::default();
                for corner in 0..4 {
                    let child = &children[child_of_corner(corner)];
                    corners[self.corner(corner) as usize] = Some(self.tree(child, first));
                }
                let corners = corners.map(|tree| tree.expect("each corner is one of the face's"));
                return Tree::of_corners(corners);
            }
            Tree::Leaf(node) => node,
        };
        let base = Some(self.corner);
        Tree::Leaf(match node {
            Node::Regular {
                points, mirrored, ..
            } => Node::Regular {
                points: self.points(points, first),
                mirrored: *mirrored,
                base,
            },
            Node::Crease {
                points,
                edge,
                sharpness,
                ..
            } => Node::Crease {
                points: self.points(points, first),
                edge: self.edge(*edge),
                sharpness: *sharpness,
                base,
            },
            Node::Extraordinary { corner } => Node::Extraordinary {
                corner: self.corner(*corner),
            },
            other => other.clone(),
        })
    }
}
