//! Whether an entry that was read can be drawn with: every number that leads somewhere leads to what is there, and every walk ends.

use crate::plan::builder::Plan;
use crate::plan::database::entry::{Entry, Key, Kind};
use crate::plan::growth::DEEPEST;
use crate::plan::strip::{Crease, Strip};
use crate::plan::tree::Node;

/// Bases are among a plan's first stencils; nodes have four bits for their numbers.
const MOST_BASES: u32 = 15;

/// Whether an entry is one that its key may have.
pub fn is_sound(key: &Key, entry: &Entry) -> bool {
    let plan = entry.plan();
    let children = match key.kind {
        Kind::Inside => 4,
        _ => 2,
    };
    is_plan(key, plan)
        && is_tree(plan, children)
        && match entry {
            Entry::Inside(_) => !plan.nodes.is_empty(),
            Entry::Edge(edge) => {
                let faces = key.configuration.face_count();
                !plan.nodes.is_empty()
                    && edge.sides.iter().all(|&side| side < faces)
                    && plan.nodes.iter().all(|node| curves(node, edge.sides.len()))
            }
            Entry::Vertex(vertex) => {
                let pairs = plan.stencils.len().saturating_sub(1) as u32 / 2;
                let reach = |side: &crate::plan::vertex::Side| {
                    side.pair.map_or(0, |pair| pair.saturating_add(1)) + u32::from(side.spare)
                };
                plan.nodes.is_empty()
                    && !plan.stencils.is_empty()
                    && !vertex.sides.is_empty()
                    && vertex.planes <= vertex.sides.len()
                    && vertex.sides.iter().all(|side| reach(side) <= pairs)
            }
        }
}

fn curves(node: &Node, sides: usize) -> bool {
    match node {
        Node::Curve { points, .. } => points.len() == 16 * sides.max(1),
        Node::Internal { .. } | Node::Extraordinary { .. } => true,
        _ => false,
    }
}

fn is_plan(key: &Key, plan: &Plan) -> bool {
    let deeper = if matches!(key.kind, Kind::Edge | Kind::Spoke) {
        1
    } else {
        0
    };
    let levels = key.options.max_level..=key.options.max_level + deeper;
    // A weighted mean, a difference of two, or a tangent.
    let is_row = |[sum, size]: [f64; 2]| {
        size.is_finite() && (sum - sum.round()).abs() <= 1e-4 * (1.0 + size)
    };
    let sums = |weights: &[f64]| {
        let size = weights.iter().map(|weight| weight.abs()).sum();
        [weights.iter().sum(), size]
    };
    let stencils = &plan.stencils;
    levels.contains(&plan.max_level)
        && plan.ring_size == key.configuration.vertex_count() as usize
        && stencils.len() <= usize::from(u16::MAX)
        && (0..stencils.len()).is_sorted_by_key(|number| stencils.level(number))
        && (0..stencils.len()).all(|number| {
            stencils.level(number) <= plan.max_level
                && stencils.corner(number).is_none_or(|corner| corner < 4)
        })
        && plan.packed_stencils().sums().all(is_row)
        && plan
            .nearby
            .iter()
            .flatten()
            .flatten()
            .all(|row| is_row(sums(row)))
        && plan
            .strips
            .iter()
            .flatten()
            .all(|strip| is_strip(plan, strip))
}

fn is_base(plan: &Plan, base: u32) -> bool {
    base < MOST_BASES && (base as usize) < plan.stencils.len()
}

fn is_sharpness(sharpness: f32) -> bool {
    sharpness.is_finite() && sharpness >= 0.0
}

/// Nodes are in breadth-first order, the children of each parent side by side, and none is deeper than a walk goes.
fn is_tree(plan: &Plan, children: u32) -> bool {
    let count = plan.nodes.len();
    let mut depths: Vec<Option<u32>> = vec![None; count];
    if count > 0 {
        depths[0] = Some(0);
    }
    let points = |points: &[u32], base: &Option<u32>| {
        let known = points
            .iter()
            .all(|&point| (point as usize) < plan.stencils.len());
        known && base.is_none_or(|base| is_base(plan, base))
    };
    let mut next = 1;
    for (number, node) in plan.nodes.iter().enumerate() {
        let Some(depth) = depths[number].filter(|&depth| depth <= DEEPEST) else {
            return false;
        };
        let sound = match node {
            Node::Internal { children: first } => {
                let first = *first as usize;
                let own = first..first.saturating_add(children as usize);
                let follows = first == next && own.end <= count;
                if follows {
                    next = own.end;
                    depths[own].fill(Some(depth + 1));
                }
                follows
            }
            Node::Regular {
                points: own, base, ..
            } => points(own, base),
            Node::Crease {
                points: own,
                edge,
                sharpness,
                base,
            } => points(own, base) && *edge < 4 && is_sharpness(*sharpness),
            Node::Terminal {
                corner,
                levels,
                base,
            } => {
                *corner < 4
                    && !levels.is_empty()
                    && levels.len() + depth as usize <= DEEPEST as usize
                    && levels.iter().all(|grid| points(grid, base))
            }
            Node::Curve {
                points: own,
                edge,
                sharpness,
                base,
            } => points(own, base) && [1, 3].contains(edge) && is_sharpness(*sharpness),
            Node::Extraordinary { corner } => *corner < 4,
        };
        if !sound {
            return false;
        }
    }
    true
}

/// The stretches are those of a tree, from the edge's beginning to its end.
fn is_strip(plan: &Plan, strip: &Strip) -> bool {
    let mut next = 0u64;
    for stretch in strip.stretches() {
        if stretch.depth > DEEPEST + 1 {
            return false;
        }
        let length = 1u64 << (DEEPEST + 1 - stretch.depth);
        if u64::from(stretch.at) * length != next {
            return false;
        }
        next += length;
        let points = stretch.points.iter().flatten().flatten();
        let known = points
            .into_iter()
            .all(|&point| (point as usize) < plan.stencils.len());
        let crease = match stretch.crease {
            Crease::None => true,
            Crease::Along(sharpness) | Crease::Across(_, sharpness) => is_sharpness(sharpness),
        };
        let based = stretch.points.is_none() || is_base(plan, stretch.base);
        if !(known && crease && based) {
            return false;
        }
    }
    next == 1 << (DEEPEST + 1)
}
