//! `pn`: curved PN triangles (Vlachos, Peters, Boyd, Mitchell 2001). A cubic Bezier triangle for positions and a quadratic one for normals,
//! from the vertices and normals of the triangle alone.

use glam::{Vec2, Vec3};

use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::surface::{Controls, SurfacePoint, normalized};
use crate::method::triangles::{self, control_points, corner_weights, sum_of_three};
use crate::method::{self, Contract, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::tessellation::Domain;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "pn",
    summary: "curved PN triangles: cubic positions and quadratic normals from vertex normals",
    paper: "Vlachos, Peters, Boyd, Mitchell 2001",
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
    Ok(triangles::by_vertices(model, "pn", twin))
}

const THIRD: f32 = 1.0 / 3.0;

/// The control point of the cubic patch on the edge from corner a to corner b, next to a (section 3.1).
fn edge_point(a: Vec3, b: Vec3, normal: Vec3) -> Vec3 {
    THIRD * ((2.0 * a + b) - (b - a).dot(normal) * normal)
}

/// The control point of the quadratic patch between two corners (section 3.3): the mean normal, mirrored at the plane across the edge.
fn edge_normal(a: Vec3, b: Vec3, na: Vec3, nb: Vec3) -> Vec3 {
    let (along, sum) = (b - a, na + nb);
    let square = along.dot(along);
    let share = if square > 0.0 {
        2.0 * along.dot(sum) / square
    } else {
        0.0
    };
    normalized(sum - share * along)
}

fn twin(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let (p, n): ([Vec3; 3], [Vec3; 3]) = control_points(pass, given, patch);
    // Of the edge from corner i to corner j = i + 1, the point next to i, and that next to j.
    let near: [Vec3; 3] = [0, 1, 2].map(|i| edge_point(p[i], p[(i + 1) % 3], n[i]));
    let far: [Vec3; 3] = [0, 1, 2].map(|i| edge_point(p[(i + 1) % 3], p[i], n[(i + 1) % 3]));
    let between: [Vec3; 3] =
        [0, 1, 2].map(|i| edge_normal(p[i], p[(i + 1) % 3], n[i], n[(i + 1) % 3]));
    let mean = (0.5 * THIRD) * sum_of_three([1.0; 3], [0, 1, 2].map(|i| near[i] + far[i]));
    let middle = mean + 0.5 * (mean - THIRD * sum_of_three([1.0; 3], p));
    let w = corner_weights(uv);
    let pairs = [w[0] * w[1], w[1] * w[2], w[2] * w[0]];
    let edges = [0, 1, 2].map(|i| w[i] * near[i] + w[(i + 1) % 3] * far[i]);
    let corners = sum_of_three(w.map(|w| w * w * w), p);
    let around = sum_of_three(pairs, edges);
    let inside = (6.0 * (pairs[0] * w[2])) * middle;
    let normal = sum_of_three(w.map(|w| w * w), n) + 2.0 * sum_of_three(pairs, between);
    SurfacePoint {
        position: (corners + 3.0 * around) + inside,
        normal: normalized(normal) + Vec3::ZERO,
    }
}
