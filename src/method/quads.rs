//! What methods for quads have in common: weights of corners, and sums that have the same bits on both sides of an edge.

use glam::{Vec2, Vec3};

/// The weights of the four corners at (u, v). Twin of `quad_weights` in `glsl/lib/quad.glsl`.
pub fn quad_weights(uv: Vec2) -> [f32; 4] {
    let (s, t) = (1.0 - uv.x, 1.0 - uv.y);
    [s * t, uv.x * t, uv.x * uv.y, s * uv.y]
}

/// What they change by with u, and with v. Twin of `weights_by_u` and `weights_by_v` in `glsl/lib/quad.glsl`.
pub fn quad_weight_changes(uv: Vec2) -> [[f32; 4]; 2] {
    let Vec2 { x: u, y: v } = uv;
    [[v - 1.0, 1.0 - v, v, -v], [u - 1.0, -u, u, 1.0 - u]]
}

/// A weighted sum over four corners, or over four edges. On an edge only two of the corners count, or one of the edges: so both sides have the
/// same bits, be the other a quad or a triangle. Twin of `sum_of_four` in `glsl/lib/quad.glsl`.
pub fn sum_of_four(weights: [f32; 4], points: [Vec3; 4]) -> Vec3 {
    ((weights[0] * points[0] + weights[1] * points[1]) + weights[2] * points[2])
        + weights[3] * points[3]
}
