//! What methods for triangles have in common: weights of corners, and sums that have the same bits on both sides of an edge.

use glam::{Vec2, Vec3};

/// The weights of corner 0, 1 and 2 at (u, v). Twin of `corner_weights` in `glsl/lib/triangle.glsl`.
pub fn corner_weights(uv: Vec2) -> [f32; 3] {
    [(1.0 - uv.x) - uv.y, uv.x, uv.y]
}

/// What they change by with u, and with v.
pub const CORNER_WEIGHT_CHANGES: [[f32; 3]; 2] = [[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]];

/// A weighted sum over three corners, or over three edges. On an edge only two of the corners count, or one of the edges: so both sides have the
/// same bits. Twin of `sum_of_three` in `glsl/lib/triangle.glsl`.
pub fn sum_of_three(weights: [f32; 3], points: [Vec3; 3]) -> Vec3 {
    (weights[0] * points[0] + weights[1] * points[1]) + weights[2] * points[2]
}
