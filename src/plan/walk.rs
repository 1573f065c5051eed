//! From (u, v) to the B-spline or extraordinary vertex that is evaluated there (Brainerd et al. 2016, section 6.1), on the packed bytes.
//! Twin of `glsl/lib/quadtree.glsl`.

use glam::Vec2;

use crate::abi;
use crate::plan::packing::Plans;

/// Where a walk ends: in a B-spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaf {
    /// Where its sixteen points begin in the list, number x + 4 y.
    pub points: u32,
    /// Where in it.
    pub uv: Vec2,
    /// By how much its derivatives are shorter than the patch's: 2^depth.
    pub scale: f32,
    /// The edge of a semi-sharp crease, and its sharpness; 0 without one.
    pub edge: u32,
    /// What is left of the sharpness.
    pub sharpness: f32,
    /// The number, among the plan's stencils, of the point that its points are relative to, plus 1; 0 without one.
    pub base: u32,
    /// The use of the corner whose vertex that point is relative to; 0 where it is relative to the ring's first.
    pub origin: u32,
    /// The kind of the node. [`NodeKind::Extraordinary`](crate::plan::NodeKind) has no points: no tess coordinate inside gets there.
    pub kind: u32,
}

/// Whether corner `corner` lies at u = 1, and whether at v = 1.
fn sides(corner: u32) -> [bool; 2] {
    [corner == 1 || corner == 2, corner >= 2]
}

/// No tree is deeper.
const DEEPEST: u32 = abi::HIGHEST_LEVEL + 2;

/// Walks the quadtree whose root is given. The tree of an edge is walked along v = 0. None where there is no such tree.
pub fn walk(plans: Plans, root: u32, uv: Vec2) -> Option<Leaf> {
    // On a split plane the half nearer to the patch's middle is taken; at the middle itself the upper one.
    let upper = uv.cmpge(Vec2::splat(0.5));
    let mut node = *plans.nodes.get(root as usize)?;
    let mut uv = uv;
    let mut scale = 1.0;
    let mut inside = false;
    for _ in 0..=DEEPEST {
        if node.kind & 15 != abi::NODE_INTERNAL {
            return Some(leaf(&node, uv, scale));
        }
        let half = |x: f32, upper: bool| if inside && upper { x > 0.5 } else { x >= 0.5 };
        let (x, y) = (half(uv.x, upper.x), half(uv.y, upper.y));
        uv = 2.0 * uv - Vec2::new(f32::from(x as u8), f32::from(y as u8));
        scale *= 2.0;
        inside = true;
        let child = node.points.checked_add(x as u32 + 2 * y as u32)?;
        node = *plans.nodes.get(child as usize)?;
    }
    None
}

fn leaf(node: &abi::Node, uv: Vec2, scale: f32) -> Leaf {
    let (kind, place, levels) = (node.kind & 15, node.kind >> 4 & 15, node.kind >> 8 & 255);
    let leaf = Leaf {
        points: node.points,
        uv,
        scale,
        edge: place,
        sharpness: node.sharpness,
        base: node.kind >> abi::NODE_BASE_SHIFT & 15,
        origin: node.kind >> abi::NODE_ORIGIN_SHIFT & 15,
        kind,
    };
    match kind {
        abi::NODE_TERMINAL | abi::NODE_CURVE_TERMINAL => terminal(leaf, levels),
        _ => leaf,
    }
}

/// The level is that of the larger distance from the extraordinary vertex: floor(-log2), read off the exponent of the float. Along an edge each is one B-spline.
fn terminal(leaf: Leaf, levels: u32) -> Leaf {
    let Leaf {
        points,
        uv,
        scale,
        edge: corner,
        kind,
        ..
    } = leaf;
    let [at_u, at_v] = sides(corner);
    let mirror = |x: f32, at: bool| if at { 1.0 - x } else { x };
    let distance = Vec2::new(mirror(uv.x, at_u), mirror(uv.y, at_v));
    let level = level_of(distance.max_element());
    if level >= levels {
        return Leaf {
            points: 0,
            uv: Vec2::ZERO,
            kind: abi::NODE_EXTRAORDINARY,
            ..leaf
        };
    }
    let grown = power_of_two(level);
    let local = distance * grown;
    let (far_u, far_v) = (local.x >= 0.5, local.y >= 0.5);
    let (x, y) = (far_u != at_u, far_v != at_v);
    let local = Vec2::new(mirror(local.x, at_u), mirror(local.y, at_v));
    let number = |x: bool, y: bool| x as u32 + 2 * y as u32;
    let number = number(x, y).wrapping_sub(number(at_u, at_v) + 1) & 3;
    let (place, kind) = match kind {
        abi::NODE_CURVE_TERMINAL => (16 * level, abi::NODE_REGULAR),
        _ => (abi::TERMINAL_POINTS * level + 16 * number, kind),
    };
    Leaf {
        points: points + place,
        kind,
        uv: 2.0 * local - Vec2::new(f32::from(x as u8), f32::from(y as u8)),
        scale: scale * grown * 2.0,
        edge: 0,
        ..leaf
    }
}

/// floor(-log2 x) for x in 0..=1, and 0 for 1 itself.
fn level_of(x: f32) -> u32 {
    let exponent = x.to_bits() >> 23;
    (127 - exponent.min(126)) - 1
}

fn power_of_two(exponent: u32) -> f32 {
    f32::from_bits((127 + exponent) << 23)
}
