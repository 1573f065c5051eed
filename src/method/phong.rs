//! `phong`: Phong tessellation (Boubekeur, Alexa 2008). Each point of a triangle or quad is projected onto the tangent planes of the vertices,
//! and moved towards the mean of these projections by a share of 3/4. It needs vertex normals and nothing else.
//!
//! Of a quad points and mean are bilinear. On an edge that is the same as of a triangle, so both may meet.

use glam::{Vec2, Vec3};

use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::quads::{quad_weights, sum_of_four};
use crate::method::surface::{Controls, SurfacePoint};
use crate::method::triangles::{corner_weights, sum_of_three};
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
    covers: vertices::whole_faces,
    prepare,
    edits: None,
};

fn prepare(model: &Model, _options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let quads = Pass::new("phong_quads", Domain::Quads, 1, quad);
    let triangles = Pass::new("phong", Domain::Triangles, 1, triangle);
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

/// The point of a face with these corners and normals whose weighted mean is `mean`.
fn bent<const N: usize>(
    (corners, normals): ([Vec3; N], [Vec3; N]),
    mean: impl Fn([Vec3; N]) -> Vec3,
) -> SurfacePoint {
    let flat = mean(corners);
    let projected =
        std::array::from_fn(|i| flat - (flat - corners[i]).dot(normals[i]) * normals[i]);
    SurfacePoint {
        position: (1.0 - SHARE) * flat + SHARE * mean(projected),
        normal: unit(mean(normals)),
    }
}

#[cfg(test)]
mod tests;
