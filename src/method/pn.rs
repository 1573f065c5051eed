//! `pn`: curved PN triangles (Vlachos, Peters, Boyd, Mitchell 2001) and PN quads (Peters 2008). Cubic and bicubic Bezier patches for positions,
//! quadratic and biquadratic ones for normals, from the vertices and normals of the face alone.
//!
//! An edge has the same cubic in both, so triangles and quads may meet. The sum of normals is the one that is printed (2001, section 3.3), whose
//! products have no binomial factors; quads follow it.

use glam::{Vec2, Vec3};

use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::bicubic::Bicubic;
use crate::method::quads::{quad_weights, sum_of_four};
use crate::method::surface::{Controls, Surface, SurfacePoint};
use crate::method::triangles::{corner_weights, sum_of_three};
use crate::method::unit::{direction, unit};
use crate::method::vertices::{self, control_points};
use crate::method::{Contract, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::plan::Database;
use crate::tessellation::Domain;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "pn",
    summary: "curved PN triangles and quads: cubic positions and quadratic normals from vertex normals",
    paper: "Vlachos, Peters, Boyd, Mitchell 2001; Peters 2008",
    schemes: &[
        Scheme::Loop,
        Scheme::Butterfly,
        Scheme::CatmullClark,
        Scheme::LoopStam,
    ],
    domains: &[Domain::Quads, Domain::Triangles],
    contract: Contract {
        reproduces: Reproduces::Itself,
        normals: None,
        interpolates: true,
        watertight: true,
    },
    uses_tables: false,
    isolates: false,
    aggregates: false,
    dynamic: false,
    covers: vertices::whole_faces,
    prepare,
    edits: None,
};

fn prepare(model: &Model, _options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let quads = Pass::new("pn_quads", Domain::Quads, 1, quad).with_tangents(quad_tangents);
    let triangles =
        Pass::new("pn", Domain::Triangles, 1, triangle).with_tangents(triangle_tangents);
    Ok(vertices::by_vertices(model, [quads, triangles]))
}

const THIRD: f32 = 1.0 / 3.0;
const NINTH: f32 = 1.0 / 9.0;

/// The control point of the cubic on the edge from corner a to corner b, next to a (section 3.1).
fn edge_point(a: Vec3, b: Vec3, normal: Vec3) -> Vec3 {
    THIRD * ((2.0 * a + b) - (b - a).dot(normal) * normal)
}

/// The control point of the quadratic between two corners (section 3.3): the mean normal, mirrored at the plane across the edge.
fn edge_normal(a: Vec3, b: Vec3, na: Vec3, nb: Vec3) -> Vec3 {
    let (along, sum) = (direction(a, b), na + nb);
    unit(sum - (2.0 * along.dot(sum)) * along)
}

/// Of each edge from corner i to the next, the point next to i, and that next to the other.
fn edge_points<const N: usize>(p: [Vec3; N], n: [Vec3; N]) -> [[Vec3; N]; 2] {
    [
        std::array::from_fn(|i| edge_point(p[i], p[(i + 1) % N], n[i])),
        std::array::from_fn(|i| edge_point(p[(i + 1) % N], p[i], n[(i + 1) % N])),
    ]
}

/// The point in the middle.
fn middle_point(p: [Vec3; 3], [near, far]: [[Vec3; 3]; 2]) -> Vec3 {
    let mean = (0.5 * THIRD) * sum_of_three([1.0; 3], [0, 1, 2].map(|i| near[i] + far[i]));
    mean + 0.5 * (mean - THIRD * sum_of_three([1.0; 3], p))
}

fn triangle_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let (p, n): ([Vec3; 3], [Vec3; 3]) = control_points(pass, given, patch);
    let [near, far] = edge_points(p, n);
    let middle = middle_point(p, [near, far]);
    let w = corner_weights(uv);
    // By weight i, the three being free: over edge i, which leaves the corner, over edge k, which comes to it, and over the middle.
    let by = [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let leaving = w[j] * (2.0 * w[i] * near[i] + w[j] * far[i]);
        let coming = w[k] * (w[k] * near[k] + 2.0 * w[i] * far[k]);
        3.0 * (w[i] * w[i] * p[i] + (leaving + coming)) + (6.0 * w[j] * w[k]) * middle
    });
    [by[1] - by[0], by[2] - by[0]]
}

fn triangle(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let (p, n): ([Vec3; 3], [Vec3; 3]) = control_points(pass, given, patch);
    let [near, far] = edge_points(p, n);
    let between: [Vec3; 3] =
        [0, 1, 2].map(|i| edge_normal(p[i], p[(i + 1) % 3], n[i], n[(i + 1) % 3]));
    let middle = middle_point(p, [near, far]);
    let w = corner_weights(uv);
    let pairs = [w[0] * w[1], w[1] * w[2], w[2] * w[0]];
    let edges = [0, 1, 2].map(|i| w[i] * near[i] + w[(i + 1) % 3] * far[i]);
    let corners = sum_of_three(w.map(|w| w * w * w), p);
    let around = sum_of_three(pairs, edges);
    let inside = (6.0 * (pairs[0] * w[2])) * middle;
    let normal = sum_of_three(w.map(|w| w * w), n) + sum_of_three(pairs, between);
    SurfacePoint {
        position: (corners + 3.0 * around) + inside,
        normal: unit(normal),
    }
}

/// The bilinear patch of four points, a third of the way from the first to its neighbours.
fn third_of_the_way([a, b, c, d]: [Vec3; 4]) -> Vec3 {
    NINTH * ((4.0 * a + 2.0 * (b + d)) + c)
}

/// The inner control points, each E + (E - V) / 2 (Peters 2008): V is the bilinear patch of the corners there, E that of the means of both edge
/// points next to each corner, which is the published (2 (b10 + b01 + q) - (b32 + b23)) / 18.
///
/// A plane quad so stays in its plane, and quads that are turned have the same surface. But nothing linear is reproduced: edge points are pulled in
/// by a sixth, and so the inner points of the unit square lie at 5/12 instead of 1/3. Nor does a bicubic with zero twists come back.
fn inner_points(corners: [Vec3; 4], near: [Vec3; 4], far: [Vec3; 4]) -> [Vec3; 4] {
    let beside: [Vec3; 4] = std::array::from_fn(|i| 0.5 * (near[i] + far[(i + 3) % 4]));
    std::array::from_fn(|i| {
        let from = |points: [Vec3; 4]| std::array::from_fn(|k| points[(i + k) % 4]);
        let mean = third_of_the_way(from(beside));
        mean + 0.5 * (mean - third_of_the_way(from(corners)))
    })
}

fn quad_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let (corners, normals): ([Vec3; 4], [Vec3; 4]) = control_points(pass, given, patch);
    let [near, far] = edge_points(corners, normals);
    let bicubic = Bicubic {
        corners,
        near,
        far,
        inner: inner_points(corners, near, far),
    };
    let Surface { du, dv, .. } = bicubic.surface(uv);
    [du, dv]
}

fn quad(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let (p, n): ([Vec3; 4], [Vec3; 4]) = control_points(pass, given, patch);
    let [near, far] = edge_points(p, n);
    let between: [Vec3; 4] =
        std::array::from_fn(|i| edge_normal(p[i], p[(i + 1) % 4], n[i], n[(i + 1) % 4]));
    // The mean of the corners and twice that of the edges' normals, in shares of a third and two thirds.
    let centre = (0.25 * THIRD) * (sum_of_four([1.0; 4], n) + 2.0 * sum_of_four([1.0; 4], between));
    let (u, v) = (uv.x, uv.y);
    let (s, t) = (1.0 - u, 1.0 - v);
    // Across edge i, which runs from corner i to corner i + 1, and along it.
    let across = [t, u, v, s];
    let along = [[s, u], [t, v], [u, s], [v, t]];
    let (pair_u, pair_v) = (s * u, t * v);
    let pairs = [pair_u, pair_v, pair_u, pair_v];
    let squares = across.map(|x| x * x);
    let cubes: [f32; 4] = std::array::from_fn(|i| squares[i] * across[i]);
    // At corner i edges i and i - 1 meet.
    let at_corners = |powers: [f32; 4]| std::array::from_fn(|i| powers[i] * powers[(i + 3) % 4]);
    let at_edges = |powers: [f32; 4]| -> [f32; 4] { std::array::from_fn(|i| pairs[i] * powers[i]) };
    let edges = std::array::from_fn(|i| along[i][0] * near[i] + along[i][1] * far[i]);
    let corners = sum_of_four(at_corners(cubes), p);
    let around = sum_of_four(at_edges(cubes), edges);
    let inner = sum_of_four(quad_weights(uv), inner_points(p, near, far));
    let inside = (9.0 * (pair_u * pair_v)) * inner;
    let normal = (sum_of_four(at_corners(squares), n) + sum_of_four(at_edges(squares), between))
        + (pair_u * pair_v) * centre;
    SurfacePoint {
        position: (corners + 3.0 * around) + inside,
        normal: unit(normal),
    }
}

#[cfg(test)]
mod tests;
