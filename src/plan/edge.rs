//! Plans of edges: the limit along an edge and the derivative across it, from the edge's own surroundings.
//!
//! Every face on an edge evaluates the edge by the same plan from the same vertices in the same order, and so gets the same bits. It is a
//! tree like a face's, in one dimension.

use std::collections::VecDeque;

use crate::error::Result;
use crate::mesh::sharpness::is_infinite;
use crate::plan::base::{Bases, UNUSED};
use crate::plan::builder::{Plan, sorted};
use crate::plan::configuration::Configuration;
use crate::plan::growth::{DEEPEST, SHALLOWEST};
use crate::plan::level::{Level, Steps};
use crate::plan::options::PlanOptions;
use crate::plan::rows::Rows;
use crate::plan::span::Span;
use crate::plan::tree::Node;
use crate::subdivision::{EdgeCurve, Mask, edge_curve};

/// Which edge of a configuration is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EdgeKind {
    /// The one from vertex 0 to vertex 1.
    Whole,
    /// Inside an n-gon, whose ring it is: from the middle of edge 0 to the n-gon's centre.
    Spoke,
}

/// The plan of an edge. `sides` faces of the configuration lie on it, in the order in which the plan's nodes have their derivatives across.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgePlan {
    /// Nodes are [`Node::Curve`], inner ones have two children.
    pub plan: Plan,
    /// Faces of the configuration on each side of an infinite crease; empty for other edges, whose sides agree.
    pub sides: Vec<u32>,
}

/// A stretch of the edge at some level.
struct Stretch {
    edge: u32,
    from: u32,
    sides: Vec<u32>,
    /// Whether it touches the whole edge's ends.
    ends: [bool; 2],
    span: Span,
}

/// A stretch's subtree.
enum Branch {
    Inner(Box<[Branch; 2]>),
    Leaf(Node),
}

struct Builder {
    options: PlanOptions,
    rows: Rows,
    bases: Bases,
    levels: Vec<u32>,
}

impl EdgePlan {
    /// Builds the plan of an edge.
    ///
    /// # Errors
    /// As [`PlanOptions::check`]; [`Misuse::Ring`](crate::Misuse::Ring) for a configuration that has not all faces around the edge.
    pub fn build(
        configuration: &Configuration,
        kind: EdgeKind,
        options: PlanOptions,
    ) -> Result<EdgePlan> {
        EdgePlan::build_by(configuration, kind, options, &Steps::default())
    }

    pub(super) fn build_by(
        configuration: &Configuration,
        kind: EdgeKind,
        options: PlanOptions,
        steps: &Steps,
    ) -> Result<EdgePlan> {
        let options = options.check()?;
        configuration.check_corners(match kind {
            EdgeKind::Whole => 2,
            EdgeKind::Spoke => configuration.arity(),
        })?;
        let whole = Level::whole(configuration, steps);
        let base = match kind {
            EdgeKind::Whole => whole,
            EdgeKind::Spoke => whole.refined(&[(0, 0)]),
        };
        // A spoke leads from corner 1 of the n-gon's first part to its corner 2.
        let corner = match kind {
            EdgeKind::Whole => 0,
            EdgeKind::Spoke => 1,
        };
        let edge = base.topology().face_edges(0)[corner];
        let sides = base.topology().edge_faces(edge).to_vec();
        let sharp = is_infinite(base.topology().edge(edge).sharpness);
        // The patches of an n-gon have half of an edge each.
        let halved = |&face: &u32| base.topology().face(face).len() != 4;
        let deeper = u32::from(sides.iter().any(halved));
        let options = PlanOptions {
            max_level: options.max_level + deeper,
            ..options
        };
        let stretch = Stretch {
            edge,
            from: base.topology().face(0)[corner],
            sides: sides.clone(),
            ends: [true; 2],
            span: Span::WHOLE,
        };
        let bases = Bases::new(2);
        let mut builder = Builder {
            options,
            rows: bases.rows(steps.memory(), base.rows.width()),
            bases,
            levels: vec![UNUSED; 2],
        };
        let branch = builder.grow(&base, stretch, 0);
        let Builder {
            mut rows,
            bases,
            mut levels,
            ..
        } = builder;
        bases.apply(&mut rows, &mut levels);
        let plan = sorted(
            flatten(branch),
            Default::default(),
            &rows,
            &levels,
            &vec![None; rows.len()],
            options,
            steps,
        );
        steps.leave(rows);
        Ok(EdgePlan {
            plan,
            sides: if sharp { sides } else { Vec::new() },
        })
    }
}

impl Builder {
    fn grow(&mut self, level: &Level<'_>, stretch: Stretch, depth: u32) -> Branch {
        let Stretch {
            edge,
            from,
            ref sides,
            ends,
            span,
        } = stretch;
        // The half of the edge that it is or lies in.
        let half = u32::from(!span.interior_half_is_upper());
        let both = [from, level.topology().edge(edge).other(from)];
        for (vertex, _) in both.iter().zip(ends).filter(|(_, end)| depth > 0 && *end) {
            self.bases.found(half, &level.rows.row(*vertex as usize));
        }
        if let Some(curve) = edge_curve(level.topology(), edge, from, sides) {
            return Branch::Leaf(self.leaf(level, &curve, span, depth));
        }
        let last = depth >= self.options.max_level.max(SHALLOWEST);
        if let Some(end) = ends.iter().position(|&touches| touches).filter(|_| last) {
            return Branch::Leaf(Node::Extraordinary { corner: end as u32 });
        }
        assert!(
            depth < DEEPEST,
            "an edge's middle is a B-spline once no semi-sharp crease is left"
        );
        let next = level.refined_edge(edge, from, sides);
        let spans = span.split(span.interior_half_is_upper());
        let halves = [0u32, 1].map(|half| {
            // The first vertices are the edge's start, middle and end; each side has a child at the start and one at the end.
            let from = half;
            let sides: Vec<u32> = (0..sides.len() as u32)
                .map(|side| 2 * side + half)
                .collect();
            let shared = |&edge: &u32| next.topology().edge(edge).vertices.contains(&(half + 1));
            let edges = next.topology().vertex_edges(from);
            let edge = edges.iter().copied().find(shared);
            let stretch = Stretch {
                edge: edge.expect("the halves of an edge are edges"),
                from,
                sides,
                ends: [ends[0] && half == 0, ends[1] && half == 1],
                span: spans[half as usize],
            };
            self.grow(&next, stretch, depth + 1)
        });
        Branch::Inner(Box::new(halves))
    }

    fn leaf(&mut self, level: &Level<'_>, curve: &EdgeCurve, span: Span, depth: u32) -> Node {
        let half = u32::from(!span.interior_half_is_upper());
        let required = span.required_level(self.options.max_level);
        // Both halves may share points at depth 1.
        let base = (depth > 1).then_some(half);
        let mut row = |masks: &[Mask; 4]| {
            let first = self.rows.len() as u32;
            for mask in masks {
                self.rows.push(|row| level.rows.add_to(row, mask));
                self.levels.push(required);
                self.bases.pushed(base);
            }
            [0, 1, 2, 3].map(|x| first + x)
        };
        let position = row(&curve.position);
        let sides = curve.beside.iter().map(&mut row);
        let points = sides.flat_map(|beside| [position, position, beside, beside].concat());
        let points = points.collect();
        let (end, sharpness) = curve.crossing.unwrap_or_default();
        Node::Curve {
            points,
            edge: [3, 1][end as usize],
            sharpness,
            base,
        }
    }
}

/// The nodes in breadth-first order, both children of a node side by side.
fn flatten(root: Branch) -> Vec<Node> {
    let mut nodes = Vec::new();
    let mut queue = VecDeque::from([root]);
    let mut next = 1;
    while let Some(branch) = queue.pop_front() {
        match branch {
            Branch::Leaf(node) => nodes.push(node),
            Branch::Inner(children) => {
                nodes.push(Node::Internal { children: next });
                next += 2;
                queue.extend(*children);
            }
        }
    }
    nodes
}
