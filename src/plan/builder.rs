//! From a configuration to a plan: adaptive refinement, level by level, with every vertex kept as a row of weights over the 1-ring.

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::plan::base::{Bases, UNUSED};
use crate::plan::configuration::Configuration;
use crate::plan::growth::{Leaf, quarter};
use crate::plan::level::{Level, Steps};
use crate::plan::nearby;
use crate::plan::options::PlanOptions;
use crate::plan::required::{require, require_stretch};
use crate::plan::ring::Ring;
use crate::plan::rows::Rows;
use crate::plan::span::Span;
use crate::plan::stencil_rows::StencilRows;
use crate::plan::stencils::Stencils;
use crate::plan::strip::{self, Strip};
use crate::plan::tree::{Node, Tree};
use crate::subdivision::{ControlPoint, Mask, is_plain_edge};

/// The plan of a configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The number of vertices in the 1-ring.
    pub ring_size: usize,
    /// The deepest level.
    pub max_level: u32,
    /// The quadtree; node 0 is its root.
    pub nodes: Vec<Node>,
    /// Its points.
    pub stencils: Stencils,
    /// At each corner whose normal is that of its surroundings, see `plan/nearby.rs`: two tangents, weights of the ring.
    pub nearby: [Option<[Vec<f64>; 2]>; 4],
    /// Of a quad, its cells along each edge, as far as they have all points that the edge is evaluated with.
    pub strips: [Option<Strip>; 4],
}

impl Plan {
    /// Builds the plan of a face: what is inside of it. Edges and corners have plans of their own.
    ///
    /// # Errors
    /// As [`PlanOptions::check`]; [`Misuse::Ring`](crate::Misuse::Ring) for the configuration of an edge or vertex.
    pub fn build(configuration: &Configuration, options: PlanOptions) -> Result<Plan> {
        Plan::build_by(configuration, options, &Steps::default())
    }

    /// Its stencils, packed. A plan without nodes is a vertex's: its limit, and tangents.
    pub(super) fn packed_stencils(&self) -> Cow<'_, StencilRows> {
        self.stencils.packed(self.nodes.is_empty())
    }

    pub(super) fn build_by(
        configuration: &Configuration,
        options: PlanOptions,
        steps: &Steps,
    ) -> Result<Plan> {
        let options = options.check()?;
        configuration.check_corners(configuration.arity())?;
        let whole = Level::whole(configuration, steps);
        let base = whole.base();
        let nearby = nearby::tangents(&whole, &base);
        let bases = Bases::new(4);
        let mut builder = Builder {
            options,
            rows: bases.rows(steps.memory(), base.rows.width()),
            bases,
            numbers: FxHashMap::default(),
            edges: shared_edges(base.topology(), configuration),
            halves: Vec::new(),
        };
        let tree = builder.grow(&base, steps).fold();
        let Builder {
            mut rows,
            mut bases,
            edges,
            halves,
            ..
        } = builder;
        let mut levels = vec![options.max_level; rows.len()];
        require(
            &tree,
            Span::WHOLE,
            Span::WHOLE,
            options.max_level,
            &mut levels,
        );
        let nodes = tree.flatten();
        let mut strips: [Option<Strip>; 4] = Default::default();
        for edge in edges {
            strips[edge as usize] = Strip::of(&nodes, edge);
        }
        for half in halves {
            if let Some(strip) = &mut strips[half.edge as usize] {
                strip.replace(half.half, half.points, half.base);
            }
        }
        for stretch in strips.iter().flatten().flat_map(Strip::stretches) {
            require_stretch(stretch, options.max_level, &mut levels);
        }
        for corner in bases.used() {
            bases.found(corner, &limit_row(&base, corner, steps));
        }
        bases.apply(&mut rows, &mut levels);
        let corners = bases.of_rows();
        let plan = sorted(nodes, strips, &rows, &levels, &corners, options, steps);
        steps.leave(rows);
        Ok(Plan { nearby, ..plan })
    }
}

/// The edges that this face and the one on the other side may evaluate alike with points of their own: those of a quad that are not plain, which needs no plan.
fn shared_edges(topology: &Topology, configuration: &Configuration) -> Vec<u32> {
    let edges = topology.face_edges(0);
    let is_shared = |&edge: &u32| {
        let edge = edges[edge as usize];
        topology.edge_faces(edge).len() == 2 && !is_plain_edge(topology, edge)
    };
    let all = 0..if configuration.arity() == 4 { 4 } else { 0 };
    all.filter(is_shared).collect()
}

/// The weights of a corner's limit: from the vertex alone, so that all faces around have the same.
fn limit_row(base: &Level<'_>, corner: u32, steps: &Steps) -> Vec<f64> {
    let vertex = base.topology().face(0)[corner as usize];
    if let Some(hub) = base.topology().hub_at(vertex) {
        return base.rows.row(hub.limit() as usize).into_owned();
    }
    let ring = Ring::of_vertex(base.topology(), vertex).expect("the face has the vertex");
    let limit = steps.limit(ring.configuration);
    let mask: Mask = ring
        .vertices
        .into_iter()
        .zip(limit.iter().copied())
        .collect();
    let mut row = vec![0.0; base.rows.width()];
    base.rows.add_to(&mut row, &mask);
    row
}

struct Builder {
    options: PlanOptions,
    /// The control points as they are met.
    rows: Rows,
    /// What the rows are relative to.
    bases: Bases,
    /// The rows of this level's control points, for each base that they are relative to.
    numbers: FxHashMap<(Option<u32>, ControlPoint), u32>,
    /// The edges that the other side may evaluate alike.
    edges: Vec<u32>,
    halves: Vec<Half>,
}

/// A half of an edge that is a single stretch, whose points are not relative to what those of its cell are.
struct Half {
    edge: u32,
    half: u32,
    points: [[u32; 4]; 3],
    base: u32,
}

impl Builder {
    /// The face as one leaf, or as its quarters.
    fn grow(&mut self, base: &Level<'_>, steps: &Steps) -> Tree {
        if let Some(leaf) = Leaf::of(base, 0, None, 0, self.options) {
            return Tree::Leaf(leaf.node(None, |point| self.point(base, point, None)));
        }
        let level = base.refined(&[(0, 0), (0, 1), (0, 2), (0, 3)]);
        let leaves =
            [0, 1, 2, 3].map(|corner| Leaf::of(&level, corner, Some(corner), 1, self.options));
        let bases = bases(&leaves);
        self.numbers.clear();
        self.halves = self.halves(&level, &bases, &leaves);
        Tree::of_corners([0, 1, 2, 3].map(|corner| {
            let base = bases[corner as usize];
            match leaves[corner as usize] {
                Some(leaf) => {
                    Tree::Leaf(leaf.node(Some(base), |point| self.point(&level, point, Some(base))))
                }
                None => self.quarter(&level, corner, steps),
            }
        }))
    }

    /// What is below a quarter. Its points are relative to the limit at its corner.
    fn quarter(&mut self, level: &Level<'_>, corner: u32, steps: &Steps) -> Tree {
        let (quarter, placed) = quarter(level, corner, self.options, steps);
        let first = self.rows.len() as u32;
        quarter.each_sum(&placed, |sum| {
            self.rows.push(|row| level.rows.add_to(row, sum));
            self.bases.pushed(Some(corner));
        });
        quarter.tree(&placed, first)
    }

    /// The halves of edges that need points of their own, so that both sides of an edge can evaluate it alike: what a half's points are relative to is up
    /// to the edge alone. It is the limit at the half's end, or, where the surface is regular there but not at the other, at that one: so they are those
    /// of a terminal node around it.
    fn halves(
        &mut self,
        level: &Level<'_>,
        bases: &[u32; 4],
        leaves: &[Option<Leaf<'_>>; 4],
    ) -> Vec<Half> {
        let mut found = Vec::new();
        let edges = self.edges.clone();
        for (edge, half) in edges.into_iter().flat_map(|edge| [(edge, 0), (edge, 1)]) {
            let [own, other] = [half, 1 - half].map(|half| (edge + half) % 4);
            let Some(Leaf::Spline(patch)) = &leaves[own as usize] else {
                continue;
            };
            let is_spline = matches!(leaves[other as usize], Some(Leaf::Spline(_)));
            let base = if is_spline { own } else { other };
            if bases[own as usize] == base {
                continue;
            }
            let rows = strip::rows(&patch.points, edge);
            let points = rows.map(|row| row.map(|point| self.point(level, point, Some(base))));
            found.push(Half {
                edge,
                half,
                points,
                base,
            });
        }
        found
    }

    fn point(&mut self, level: &Level<'_>, point: ControlPoint, base: Option<u32>) -> u32 {
        *self.numbers.entry((base, point)).or_insert_with(|| {
            self.rows.push(|row| level.rows.add_to(row, &point.mask()));
            self.bases.pushed(base);
            self.rows.len() as u32 - 1
        })
    }
}

/// The corners at whose limits the quarters' points are relative to: their own; those of a quarter that is a leaf to that of a corner whose quarter is none,
/// where there is one: beside its own, so that they are among the points of its star; else opposite to it. Around a single extraordinary vertex they are those of
/// a terminal node.
fn bases(leaves: &[Option<Leaf<'_>>; 4]) -> [u32; 4] {
    let is_leaf = |corner: u32| matches!(leaves[corner as usize], Some(Leaf::Spline(_)));
    [0, 1, 2, 3].map(|own| {
        let others = [1, 3, 2].map(|turn| (own + turn) % 4);
        let star = others.into_iter().find(|&corner| !is_leaf(corner));
        star.filter(|_| is_leaf(own)).unwrap_or(own)
    })
}

/// Weights that are less are rounding of what is none.
const LEAST: f64 = 1e-13;

/// Sorts the stencils by level, leaves out those that nothing uses, and renumbers the points of the nodes. Bases are named by their rows.
pub(super) fn sorted(
    mut nodes: Vec<Node>,
    mut strips: [Option<Strip>; 4],
    rows: &Rows,
    levels: &[u32],
    corners: &[Option<u32>],
    PlanOptions { max_level, .. }: PlanOptions,
    steps: &Steps,
) -> Plan {
    let used = |&point: &u32| levels[point as usize] != UNUSED;
    let mut order: Vec<u32> = (0..rows.len() as u32).filter(used).collect();
    order.sort_by_key(|&point| levels[point as usize]);
    let mut place = vec![0; rows.len()];
    for (new, &old) in order.iter().enumerate() {
        place[old as usize] = new as u32;
    }
    let renumber = |points: &mut [u32]| {
        points
            .iter_mut()
            .for_each(|point| *point = place[*point as usize])
    };
    for node in &mut nodes {
        match node {
            Node::Regular { points, base, .. } | Node::Crease { points, base, .. } => {
                renumber(points);
                renumber(base.as_mut_slice());
            }
            Node::Terminal { levels, base, .. } => {
                levels.iter_mut().for_each(|grid| renumber(grid));
                renumber(base.as_mut_slice());
            }
            Node::Curve { points, base, .. } => {
                renumber(points);
                renumber(base.as_mut_slice());
            }
            Node::Internal { .. } | Node::Extraordinary { .. } => {}
        }
    }
    for number in strips.iter_mut().flatten().flat_map(Strip::numbers) {
        *number = place[*number as usize];
    }
    let mut stencils = Stencils::new(rows.width(), !steps.rounded);
    let mut known = steps.known_rows();
    for &old in &order {
        let row = rows.row(old as usize).iter();
        let weights = row.map(|&weight| if weight.abs() < LEAST { 0.0 } else { weight });
        let (level, corner) = (levels[old as usize], corners[old as usize]);
        stencils.push(level, corner, weights, false, &mut known);
    }
    Plan {
        nearby: Default::default(),
        strips,
        ring_size: rows.width(),
        max_level,
        nodes,
        stencils,
    }
}
