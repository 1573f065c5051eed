//! Bicubic B-splines of sixteen points, also across one semi-sharp crease. Twin of `glsl/lib/bspline.glsl` and `glsl/lib/crease.glsl`.

use glam::{Vec2, Vec3};

use crate::method::surface::Surface;
use crate::patch::bspline::{Basis, basis};
use crate::patch::crease::crease_basis;

/// Sum of four weighted points, the same bits from either end: on edges and at corners one of the outer weights is zero, and the others
/// are symmetric about the second or third point. Twin of `blend` in `glsl/lib/bspline.glsl`.
fn blend(w: [f32; 4], p: [Vec3; 4]) -> Vec3 {
    (w[0] * p[0] + w[2] * p[2]) + (w[1] * p[1] + w[3] * p[3])
}

/// The products of two bases, with control points from `point`; rows along u first.
pub fn bspline(
    u: Basis<f32>,
    v: Basis<f32>,
    scale: f32,
    point: impl Fn(usize, usize) -> Vec3,
) -> Surface {
    let rows = [0, 1, 2, 3].map(|y| [0, 1, 2, 3].map(|x| point(x, y)));
    let values = rows.map(|row| blend(u.value, row));
    let derivatives = rows.map(|row| blend(u.derivative, row));
    Surface {
        position: blend(v.value, values),
        du: scale * blend(v.value, derivatives),
        dv: scale * blend(v.derivative, values),
    }
}

/// The bases in both directions; across a crease on one of the edges the crease's own. Twin of `glsl/lib/crease.glsl`.
pub fn creased(uv: Vec2, edge: u32, sharpness: f32) -> (Basis<f32>, Basis<f32>) {
    let (mut u, mut v) = (basis(uv.x), basis(uv.y));
    if sharpness > 0.0 {
        match edge {
            0 => v = crease_basis(uv.y, sharpness),
            1 => u = reversed(crease_basis(1.0 - uv.x, sharpness)),
            2 => v = reversed(crease_basis(1.0 - uv.y, sharpness)),
            _ => u = crease_basis(uv.x, sharpness),
        }
    }
    (u, v)
}

/// The basis of the curve run backwards.
fn reversed(basis: Basis<f32>) -> Basis<f32> {
    let Basis {
        mut value,
        mut derivative,
    } = basis;
    value.reverse();
    derivative.reverse();
    Basis {
        value,
        derivative: derivative.map(|weight| -weight),
    }
}
