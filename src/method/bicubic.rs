//! Bicubic patches by corners, edges and what lies inside. Twin of `glsl/lib/bicubic.glsl`.

use glam::{Vec2, Vec3};

use crate::method::quads::{quad_weights, sum_of_four};
use crate::method::surface::Surface;

/// Where a point lies: on which edges.
pub fn edges_on(uv: Vec2) -> [bool; 4] {
    [uv.y <= 0.0, uv.x >= 1.0, uv.y >= 1.0, uv.x <= 0.0]
}

/// How much of each edge is left, and how much is behind.
pub fn along_edges(uv: Vec2) -> [[f32; 2]; 4] {
    let (u, v) = (uv.x, uv.y);
    let (s, t) = (1.0 - u, 1.0 - v);
    [[s, u], [t, v], [u, s], [v, t]]
}

/// Control points: of corners, next to corner i on edge i, next to corner i + 1 there, and inside next to corner i.
pub struct Bicubic {
    /// Of corners.
    pub corners: [Vec3; 4],
    /// Next to corner i on edge i.
    pub near: [Vec3; 4],
    /// Next to corner i + 1 on edge i.
    pub far: [Vec3; 4],
    /// Inside, next to corner i.
    pub inner: [Vec3; 4],
}

impl Bicubic {
    /// The position; an edge has no terms but its own.
    pub fn position(&self, uv: Vec2) -> Vec3 {
        let (u, v) = (uv.x, uv.y);
        let (s, t) = (1.0 - u, 1.0 - v);
        let across = [t, u, v, s];
        let (pair_u, pair_v) = (s * u, t * v);
        let pairs = [pair_u, pair_v, pair_u, pair_v];
        let cubes: [f32; 4] = across.map(|x| (x * x) * x);
        let at_corners = std::array::from_fn(|i| cubes[i] * cubes[(i + 3) % 4]);
        let at_edges = std::array::from_fn(|i| pairs[i] * cubes[i]);
        let along = along_edges(uv);
        let edge = |i: usize| along[i][0] * self.near[i] + along[i][1] * self.far[i];
        let edges = std::array::from_fn(edge);
        (sum_of_four(at_corners, self.corners) + 3.0 * sum_of_four(at_edges, edges))
            + (9.0 * (pair_u * pair_v)) * sum_of_four(quad_weights(uv), self.inner)
    }

    /// The position with its derivatives, all points standing still.
    pub fn surface(&self, uv: Vec2) -> Surface {
        let (u, v) = (uv.x, uv.y);
        let (s, t) = (1.0 - u, 1.0 - v);
        let rows = self.rows();
        let columns: [[Vec3; 4]; 4] = std::array::from_fn(|i| rows.map(|row| row[i]));
        let derivative = |rows: [[Vec3; 4]; 4], [s, u]: [f32; 2], [t, v]: [f32; 2]| {
            let of_row = |[a, b, c, d]: [Vec3; 4]| {
                (s * s) * (b - a) + ((2.0 * (s * u)) * (c - b) + (u * u) * (d - c))
            };
            3.0 * sum_of_four(cubic_weights([t, v]), rows.map(of_row))
        };
        Surface {
            position: self.position(uv),
            du: derivative(rows, [s, u], [t, v]),
            dv: derivative(columns, [t, v], [s, u]),
        }
    }

    /// All sixteen, v by v.
    fn rows(&self) -> [[Vec3; 4]; 4] {
        let Bicubic {
            corners,
            near,
            far,
            inner,
        } = self;
        [
            [corners[0], near[0], far[0], corners[1]],
            [far[3], inner[0], inner[1], near[1]],
            [near[3], inner[3], inner[2], far[1]],
            [corners[3], far[2], near[2], corners[2]],
        ]
    }
}

/// Of the four points of a cubic.
pub fn cubic_weights([t, v]: [f32; 2]) -> [f32; 4] {
    [
        (t * t) * t,
        3.0 * ((t * t) * v),
        3.0 * (t * (v * v)),
        (v * v) * v,
    ]
}
