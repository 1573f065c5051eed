//! `phong`: Phong tessellation (Boubekeur, Alexa 2008). Each point of a triangle is projected onto the tangent planes of the three vertices,
//! and moved towards the mean of the three by a share of 3/4. It needs vertex normals and nothing else.

use glam::{Vec2, Vec3};

use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::surface::{Controls, SurfacePoint, normalized};
use crate::method::triangles::{self, control_points, corner_weights, sum_of_three};
use crate::method::{self, Contract, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::tessellation::Domain;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "phong",
    summary: "Phong tessellation: triangles bent towards the tangent planes of their vertices",
    paper: "Boubekeur, Alexa 2008",
    schemes: &[Scheme::Loop, Scheme::Butterfly],
    domains: &[Domain::Triangles],
    contract: Contract {
        reproduces: Reproduces::Itself,
        normals: None,
        interpolates: true,
        watertight: true,
    },
    uses_tables: false,
    covers: method::every_mesh,
    prepare,
};

fn prepare(model: &Model, _options: MethodOptions) -> Result<Prepared> {
    Ok(triangles::by_vertices(model, "phong", twin))
}

/// How far points go to where the tangent planes want them; the paper's.
const SHARE: f32 = 0.75;

fn twin(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let (corners, normals): ([Vec3; 3], [Vec3; 3]) = control_points(pass, given, patch);
    let weights = corner_weights(uv);
    let flat = sum_of_three(weights, corners);
    let projected =
        std::array::from_fn(|i| flat - (flat - corners[i]).dot(normals[i]) * normals[i]);
    let bent = sum_of_three(weights, projected);
    SurfacePoint {
        position: (1.0 - SHARE) * flat + SHARE * bent,
        normal: normalized(sum_of_three(weights, normals)) + Vec3::ZERO,
    }
}
