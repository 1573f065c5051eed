//! A face's cells along one of its edges, with the points that the edge is evaluated with.
//!
//! On an edge a B-spline is a sum of three rows of control points, those on the edge and those beside it. Where the faces on both sides have the
//! same cells along it, and the same points in these, both can evaluate the edge with their own points, and need no others.

use crate::plan::span::Span;
use crate::plan::tree::{Node, child_of_corner};

/// What is evaluated on a stretch of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crease {
    /// A B-spline.
    None,
    /// One with a semi-sharp crease along the edge.
    Along(f32),
    /// One with a semi-sharp crease across the stretch's beginning (0) or end (1).
    Across(u32, f32),
}

/// A stretch of an edge: from `at` / 2^`depth` to one more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// How often the edge is halved.
    pub depth: u32,
    /// Which of the halves' halves it is.
    pub at: u32,
    /// Control points, four along the edge in each of the rows outside, on the edge and inside. None where the edge ends in an extraordinary vertex.
    pub points: Option<[[u32; 4]; 3]>,
    /// The crease.
    pub crease: Crease,
    /// The point that the control points are relative to.
    pub base: u32,
}

impl Stretch {
    /// Which coordinates along the edge fall into it.
    pub(super) fn span(&self) -> Span {
        let mut span = Span::WHOLE;
        for bit in (0..self.depth).rev() {
            span = span.split(span.interior_half_is_upper())[(self.at >> bit & 1) as usize];
        }
        span
    }

    /// The control points, number x + 4 y, of the B-spline along whose v = 0 the stretch is; none where it ends in an extraordinary vertex. Row 3 has no
    /// weight there.
    pub(super) fn points(&self) -> impl Iterator<Item = u32> + use<> {
        let rows = self
            .points
            .map(|[outside, on, inside]| [outside, on, inside, on]);
        rows.into_iter().flatten().flatten()
    }

    /// The same as a node.
    pub(super) fn node(&self) -> Node {
        if self.points.is_none() {
            return Node::Extraordinary {
                corner: u32::from(self.at > 0),
            };
        }
        let mut all = self.points();
        let points = std::array::from_fn(|_| all.next().unwrap_or_default());
        let base = Some(self.base);
        match self.crease {
            Crease::None => Node::Regular {
                points,
                mirrored: false,
                base,
            },
            Crease::Along(sharpness) => Node::Crease {
                points,
                edge: 0,
                sharpness,
                base,
            },
            Crease::Across(end, sharpness) => Node::Crease {
                points,
                edge: [3, 1][end as usize],
                sharpness,
                base,
            },
        }
    }

    /// The same seen from the edge's other side and end.
    pub(super) fn reversed(&self) -> Stretch {
        let turned = |[outside, on, inside]: [[u32; 4]; 3]| [inside, on, outside];
        let mirrored = self.mirrored();
        Stretch {
            points: mirrored.points.map(turned),
            ..mirrored
        }
    }

    /// That of the face's mirror image: from the edge's other end, with the same rows inside and outside.
    fn mirrored(&self) -> Stretch {
        let backwards = |rows: [[u32; 4]; 3]| {
            rows.map(|mut row| {
                row.reverse();
                row
            })
        };
        Stretch {
            at: (1 << self.depth) - 1 - self.at,
            points: self.points.map(backwards),
            crease: match self.crease {
                Crease::Across(end, sharpness) => Crease::Across(1 - end, sharpness),
                crease => crease,
            },
            ..*self
        }
    }
}

/// The stretches of an edge from its first corner on, the face's inside to their left.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip(Vec<Stretch>);

impl Strip {
    /// Of stretches in the order along the edge.
    pub(super) fn from_stretches(stretches: Vec<Stretch>) -> Strip {
        Strip(stretches)
    }

    /// The cells of a tree along edge 0..=3, which runs from the corner of this number to the next. None where the face is one cell: its points are
    /// relative to nothing that both sides of the edge have.
    pub(super) fn of(nodes: &[Node], edge: u32) -> Option<Strip> {
        let mut stretches = Vec::new();
        let whole = nodes.first()?.clone();
        collect(nodes, &whole, edge, (0, 0), &mut stretches)?;
        stretches.shrink_to_fit();
        Some(Strip(stretches))
    }

    /// Replaces what a half of the edge is evaluated with.
    pub(super) fn replace(&mut self, half: u32, points: [[u32; 4]; 3], base: u32) {
        let halves = self.0.iter_mut().filter(|stretch| stretch.depth == 1);
        for stretch in halves.filter(|stretch| stretch.at == half) {
            (stretch.points, stretch.base) = (Some(points), base);
        }
    }

    /// The numbers of points, for writing.
    pub(super) fn numbers(&mut self) -> impl Iterator<Item = &mut u32> {
        self.0.iter_mut().flat_map(|stretch| {
            let points = stretch.points.as_mut();
            let base = points.is_some().then_some(&mut stretch.base);
            points.into_iter().flatten().flatten().chain(base)
        })
    }

    /// In the order along the edge.
    pub fn stretches(&self) -> impl Iterator<Item = &Stretch> {
        self.0.iter()
    }

    /// The stretch from `at` / 2^`depth` to one more, if it is one.
    pub(super) fn at(&self, depth: u32, at: u32) -> Option<&Stretch> {
        let is_it = |stretch: &&Stretch| (stretch.depth, stretch.at) == (depth, at);
        self.stretches().find(is_it)
    }

    /// The stretches of a part of the edge in which each is half of what is left towards an extraordinary vertex, if all are B-splines relative to the same point:
    /// at which of the part's ends that is, and the stretches from the other end on.
    pub(super) fn approach(&self, depth: u32, at: u32) -> Option<(u32, Vec<Stretch>)> {
        let towards = |end: u32| {
            let (mut depth, mut at) = (depth, at);
            let mut levels: Vec<Stretch> = Vec::new();
            loop {
                (depth, at) = (depth + 1, 2 * at + end);
                let far = *self.at(depth, at ^ 1)?;
                let is_alike = levels.last().is_none_or(|last| last.base == far.base);
                if far.points.is_none() || far.crease != Crease::None || !is_alike {
                    return None;
                }
                levels.push(far);
                if let Some(near) = self.at(depth, at) {
                    return near.points.is_none().then_some((end, levels));
                }
            }
        };
        [0, 1].into_iter().find_map(towards)
    }

    /// How many stretches there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The stretches of the face's mirror image, along the edge's direction there; or those seen from the edge's other side and end; or both.
    pub fn seen(&self, mirrored: bool, reversed: bool) -> impl Iterator<Item = Stretch> + '_ {
        let last = self.0.len().wrapping_sub(1);
        (0..self.0.len()).map(move |i| {
            let mut stretch = self.0[if mirrored != reversed { last - i } else { i }];
            if mirrored {
                stretch = stretch.mirrored();
            }
            if reversed {
                stretch = stretch.reversed();
            }
            stretch
        })
    }

    /// The same as a strip.
    pub fn turned(&self, mirrored: bool, reversed: bool) -> Strip {
        Strip(self.seen(mirrored, reversed).collect())
    }
}

fn collect(
    nodes: &[Node],
    node: &Node,
    edge: u32,
    (depth, at): (u32, u32),
    found: &mut Vec<Stretch>,
) -> Option<()> {
    let ends = [edge, (edge + 1) % 4];
    let (points, crease, base) = match node {
        Node::Internal { children } => {
            for (half, corner) in (0..).zip(ends) {
                let child = &nodes[*children as usize + child_of_corner(corner)];
                collect(nodes, child, edge, (depth + 1, 2 * at + half), found)?;
            }
            return Some(());
        }
        Node::Terminal { .. } => {
            for (half, corner) in (0..).zip(ends) {
                let child = node.child(corner)?;
                collect(nodes, &child, edge, (depth + 1, 2 * at + half), found)?;
            }
            return Some(());
        }
        Node::Extraordinary { .. } => (None, Crease::None, 0),
        Node::Regular { points, base, .. } => (Some(points), Crease::None, (*base)?),
        Node::Crease {
            points,
            edge: creased,
            sharpness,
            base,
        } => {
            let crease = match (creased + 4 - edge) % 4 {
                0 => Crease::Along(*sharpness),
                1 => Crease::Across(1, *sharpness),
                3 => Crease::Across(0, *sharpness),
                // Across the face nothing is left of it.
                _ => Crease::None,
            };
            (Some(points), crease, (*base)?)
        }
        Node::Curve { .. } => return None,
    };
    found.push(Stretch {
        depth,
        at,
        points: points.map(|points| rows(points, edge)),
        crease,
        base,
    });
    Some(())
}

/// The three rows beside an edge of a B-spline.
pub(super) fn rows<T: Copy>(points: &[T; 16], edge: u32) -> [[T; 4]; 3] {
    [0, 1, 2].map(|y| {
        [0, 1, 2, 3].map(|x| {
            let [x, y] = match edge {
                0 => [x, y],
                1 => [3 - y, x],
                2 => [3 - x, 3 - y],
                _ => [y, 3 - x],
            };
            points[x + 4 * y]
        })
    })
}
