//! From which level on each stencil is needed (Brainerd et al. 2016, section 4.2).

use crate::plan::span::{Span, required_level};
use crate::plan::strip::Stretch;
use crate::plan::tree::{Node, Tree, child_of_corner};

/// Lowers `levels` of every stencil to the first level at which a tess coordinate falls into a cell that uses it.
pub(super) fn require(tree: &Tree, u: Span, v: Span, deepest: u32, levels: &mut [u32]) {
    let mut lower = |points: &[u32], u: Span, v: Span| {
        let level = required_level(u, v, deepest);
        for &point in points {
            let known = &mut levels[point as usize];
            *known = level.min(*known);
        }
    };
    match tree {
        Tree::Inner(children) => {
            let (us, vs) = (
                u.split(u.interior_half_is_upper()),
                v.split(v.interior_half_is_upper()),
            );
            for (number, child) in children.iter().enumerate() {
                require(child, us[number % 2], vs[number / 2], deepest, levels);
            }
        }
        Tree::Leaf(Node::Regular { points, .. } | Node::Crease { points, .. }) => {
            lower(points, u, v)
        }
        Tree::Leaf(Node::Terminal {
            corner,
            levels: grids,
            ..
        }) => {
            let end = child_of_corner(*corner);
            let (mut u, mut v) = (u, v);
            for grid in grids {
                let (us, vs) = (u.split(end.is_multiple_of(2)), v.split(end < 2));
                for number in (0..4).filter(|&number| number != end) {
                    let points: Vec<u32> = (0..16)
                        .map(|i| grid[(i % 4 + number % 2) + 5 * (i / 4 + number / 2)])
                        .collect();
                    lower(&points, us[number % 2], vs[number / 2]);
                }
                (u, v) = (us[end % 2], vs[end / 2]);
            }
        }
        Tree::Leaf(Node::Curve { .. } | Node::Extraordinary { .. } | Node::Internal { .. }) => {}
    }
}

/// Lowers the levels of the stencils of a stretch to the first level at which a tess coordinate on the edge falls into it.
pub(super) fn require_stretch(stretch: &Stretch, deepest: u32, levels: &mut [u32]) {
    // The middle of an edge is in the half behind it, of whichever direction the edge has.
    let spans = [stretch.span(), stretch.reversed().span()];
    let level = spans.map(|span| span.required_level(deepest));
    let level = level[0].min(level[1]);
    for &point in stretch.points.iter().flatten().flatten() {
        let known = &mut levels[point as usize];
        *known = level.min(*known);
    }
}
