//! Gregory patches (Loop, Schaefer, Ni, Castaño 2009): bicubic, but for points inside that are means of two. Twin of `glsl/lib/blended.glsl`.

use glam::{Vec2, Vec3};

use crate::method::bicubic::Bicubic;
use crate::method::quads::{quad_weights, sum_of_four};
use crate::method::surface::Surface;

/// A patch of N corners. `near` is next to corner i on edge i, `far` next to corner i + 1; `before` and `behind` are inside of these.
pub struct Net<const N: usize> {
    pub corners: [Vec3; N],
    pub near: [Vec3; N],
    pub far: [Vec3; N],
    pub before: [Vec3; N],
    pub behind: [Vec3; N],
}

/// A mean of two inner points that differ, whose weights vanish together at a corner: there it counts for nothing.
pub fn blended([a, b]: [f32; 2], [before, behind]: [Vec3; 2]) -> (Vec3, Vec3) {
    let whole = (a + b).max(1e-9);
    let mean = (a * before + b * behind) / whole;
    // By b times this it changes with a, and by -a times this with b.
    (mean, (before - behind) / (whole * whole))
}

/// Position and derivatives as they are inside.
pub fn quad_surface(net: &Net<4>, uv: Vec2) -> Surface {
    let (u, v) = (uv.x, uv.y);
    let (s, t) = (1.0 - u, 1.0 - v);
    // From corner i along edge i, and along edge i - 1.
    let (a, b) = ([u, v, s, t], [v, s, t, u]);
    let blend: [(Vec3, Vec3); 4] =
        std::array::from_fn(|i| blended([a[i], b[i]], [net.before[i], net.behind[(i + 3) % 4]]));
    let patch = Bicubic {
        corners: net.corners,
        near: net.near,
        far: net.far,
        inner: blend.map(|(mean, _)| mean),
    };
    let surface = patch.surface(uv);
    // What the inner points themselves change by.
    let inside = 9.0 * ((s * u) * (t * v));
    let weights = quad_weights(uv);
    let turning = |signs: [f32; 4]| {
        let weights = std::array::from_fn(|i| weights[i] * signs[i]);
        inside * sum_of_four(weights, blend.map(|(_, change)| change))
    };
    Surface {
        du: surface.du + turning([v, v, -t, -t]),
        dv: surface.dv + turning([-u, s, s, -u]),
        ..surface
    }
}
