//! `phong`: Phong tessellation (Boubekeur, Alexa 2008). Each point of a triangle or quad is projected onto the tangent planes of the vertices,
//! and moved towards the mean of these projections by a share of 3/4. It needs vertex normals and nothing else.
//!
//! Of a quad points and mean are bilinear. On an edge that is the same as of a triangle, so both may meet.

use glam::{Vec2, Vec3};

use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::quads::{quad_weight_changes, quad_weights, sum_of_four};
use crate::method::surface::{Controls, SurfacePoint};
use crate::method::triangles::{CORNER_WEIGHT_CHANGES, corner_weights, sum_of_three};
use crate::method::unit::unit;
use crate::method::vertices::{self, control_points};
use crate::method::{Contract, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::plan::Database;
use crate::tessellation::Domain;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "phong",
    summary: "Phong tessellation: triangles and quads bent towards the tangent planes of their vertices",
    paper: "Boubekeur, Alexa 2008",
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
    let quads = Pass::new("phong_quads", Domain::Quads, 1, quad).with_tangents(quad_tangents);
    let triangles =
        Pass::new("phong", Domain::Triangles, 1, triangle).with_tangents(triangle_tangents);
    Ok(vertices::by_vertices(model, [quads, triangles]))
}

/// How far points go to where the tangent planes want them; the paper's.
const SHARE: f32 = 0.75;

fn triangle(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let weights = corner_weights(uv);
    bent(control_points(pass, given, patch), |points| {
        sum_of_three(weights, points)
    })
}

fn quad(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let weights = quad_weights(uv);
    bent(control_points(pass, given, patch), |points| {
        sum_of_four(weights, points)
    })
}

fn triangle_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let points = control_points(pass, given, patch);
    let weights = corner_weights(uv);
    CORNER_WEIGHT_CHANGES.map(|change| bent_tangent(points, [weights, change], sum_of_three))
}

fn quad_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let points = control_points(pass, given, patch);
    let weights = quad_weights(uv);
    quad_weight_changes(uv).map(|change| bent_tangent(points, [weights, change], sum_of_four))
}

/// The derivative of such a point by a change of the weights.
fn bent_tangent<const N: usize>(
    (corners, normals): ([Vec3; N], [Vec3; N]),
    [weights, change]: [[f32; N]; 2],
    sum: fn([f32; N], [Vec3; N]) -> Vec3,
) -> Vec3 {
    let (flat, flat_tangent) = (sum(weights, corners), sum(change, corners));
    let on_plane = normals.map(|normal| flat_tangent - flat_tangent.dot(normal) * normal);
    let projected = projections(flat, corners, normals);
    (1.0 - SHARE) * flat_tangent + SHARE * (sum(weights, on_plane) + sum(change, projected))
}

/// A point on the tangent planes of the corners.
fn projections<const N: usize>(flat: Vec3, corners: [Vec3; N], normals: [Vec3; N]) -> [Vec3; N] {
    std::array::from_fn(|i| flat - (flat - corners[i]).dot(normals[i]) * normals[i])
}

/// The point of a face with these corners and normals whose weighted mean is `mean`.
fn bent<const N: usize>(
    (corners, normals): ([Vec3; N], [Vec3; N]),
    mean: impl Fn([Vec3; N]) -> Vec3,
) -> SurfacePoint {
    let flat = mean(corners);
    SurfacePoint {
        position: (1.0 - SHARE) * flat + SHARE * mean(projections(flat, corners, normals)),
        normal: unit(mean(normals)),
    }
}

#[cfg(test)]
mod tests;
