//! Faces that are one bicubic B-spline, and what they share with the patches around: on edges and at corners their sums run in an order that all faces
//! there have, and so give the same bits. Twin of `glsl/lib/regular.glsl`, `glsl/lib/border.glsl` and `glsl/lib/bspline.glsl`.

use glam::{Vec2, Vec3};

use crate::abi;
use crate::method::spline::bspline;
use crate::method::surface::Surface;
use crate::patch::bspline::basis_of;
use crate::plan::SmoothQuads;

/// Where a point of a patch lies. Twin of `glsl/lib/border.glsl`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    Inside,
    /// On an edge: where along it, counter-clockwise, and what is left of it.
    Edge(u32, [f32; 2]),
    Corner(u32),
}

pub fn place(flags: u32, uv: Vec2) -> Place {
    let (low, high) = (uv.cmple(Vec2::ZERO), uv.cmpge(Vec2::ONE));
    let corner = match (high.x, high.y) {
        (false, false) => 0,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    };
    // Corners 1 and 3 of an n-gon's part are the middles of edges.
    let middle = flags & abi::PATCH_HALF != 0 && corner % 2 == 1;
    if (low.x || high.x) && (low.y || high.y) && !middle {
        return Place::Corner(corner);
    }
    let (edge, along, backwards) = match () {
        () if low.y => (0, uv.x, false),
        () if low.x => (3, uv.y, true),
        () if high.x => (1, uv.y, false),
        () if high.y => (2, uv.x, true),
        () => return Place::Inside,
    };
    Place::Edge(edge, turned_round(along, backwards))
}

/// t and 1 - t, exchanged if `backwards`. The smaller of both is exact: so both directions have the same pair.
pub fn turned_round(t: f32, backwards: bool) -> [f32; 2] {
    let small = if t > 0.5 { 1.0 - t } else { t };
    let pair = [small, 1.0 - small];
    if (t > 0.5) != backwards {
        [pair[1], pair[0]]
    } else {
        pair
    }
}

/// A plain B-spline patch, with vertices at all its corners. On edges the sums go along the edge first, at corners along the direction that the vertex prefers.
/// Twin of `regular_surface` in `glsl/lib/regular.glsl`.
pub fn regular_surface(flags: u32, uv: Vec2, point: impl Fn(usize, usize) -> Vec3) -> Surface {
    let turned = match place(flags & !abi::PATCH_HALF, uv) {
        Place::Inside => false,
        Place::Edge(edge, _) => edge % 2 == 1,
        Place::Corner(corner) => flags & (abi::PATCH_TURNED_CORNER << corner) != 0,
    };
    let [u, v] = [uv.x, uv.y].map(|t| {
        let [t, s] = turned_round(t, false);
        basis_of(t, s)
    });
    if !turned {
        return bspline(u, v, 1.0, point);
    }
    exchanged(bspline(v, u, 1.0, |x, y| point(y, x)))
}

/// Seen with u and v exchanged.
pub fn exchanged(Surface { position, du, dv }: Surface) -> Surface {
    Surface {
        position,
        du: dv,
        dv: du,
    }
}

/// Whether sums at a plain vertex go first along the edge that enters the corner of a face at which a side begins, instead of along the side itself. It is up to
/// the lowest of the four sides that begin at the vertex: there they go first along the side if it is the first of its face, and all faces around agree.
pub fn is_turned_corner(smooth: &SmoothQuads<'_>, side: u32) -> bool {
    let [before, after] = smooth.beside(side);
    let opposite = smooth.around(after);
    let (even, odd) = (side.min(opposite), before.min(after));
    // From face to face, what leaves and what enters change places.
    (even.min(odd) % 4 != 0) != (odd < even)
}

/// The flags of those plain corners of a patch at which sums go along v first. Corner 0 of the patch is the face's corner `turn`.
pub fn turned_corners(smooth: &SmoothQuads<'_>, face: u32, turn: u32) -> u32 {
    let is_turned = |&corner: &u32| {
        let side = SmoothQuads::after(4 * face, turn + corner);
        smooth.valence(smooth.vertex_after(side, 0)) == Some(4)
            && is_turned_corner(smooth, side) != (corner % 2 == 1)
    };
    let turned = (0..4).filter(is_turned);
    turned
        .map(|corner| abi::PATCH_TURNED_CORNER << corner)
        .sum()
}
