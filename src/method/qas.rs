//! `qas`: quadratic approximation of subdivision surfaces (Boubekeur, Schlick 2007).
//!
//! One refinement, projected to the limit, gives six points with normals to each triangle (the hexagon H_T, section 2.2). Two quadratic Bezier
//! triangles interpolate them, one for positions, one for normals (section 2.3).
//!
//! The printed listing passes an edge vertex twice (`pe0, pe2, pe2`) and pairs u with the second corner; this follows the section's formulas.

mod bounded;
mod hexagons;

use glam::{Vec2, Vec3};

use crate::abi;
use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::surface::{Controls, SurfacePoint};
use crate::method::triangles::{corner_weights, sum_of_three};
use crate::method::unit::unit;
use crate::method::vertices::{self, control_points};
use crate::method::{Contract, Method, MethodOptions, Pass, Prepared, Reproduces, patches};
use crate::plan::Database;
use crate::tessellation::Domain;

use hexagons::Hexagons;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "qas",
    summary: "quadratic triangles through the limits of one refinement",
    paper: "Boubekeur, Schlick 2007",
    schemes: &[Scheme::Loop, Scheme::Butterfly],
    domains: &[Domain::Triangles],
    contract: Contract {
        reproduces: Reproduces::LimitOnHexagon(1e-6),
        normals: None,
        interpolates: false,
        watertight: true,
    },
    uses_tables: false,
    isolates: false,
    aggregates: false,
    dynamic: false,
    covers: bounded::check,
    prepare,
    edits: None,
};

fn prepare(model: &Model, _options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let hexagons = Hexagons::new(model);
    let mut pass = Pass::new("qas", Domain::Triangles, 1, twin).with_tangents(tangents);
    for part in patches::parts(model) {
        let (points, flags) = hexagons.of(part.face);
        vertices::add(&mut pass, model, part, &points, flags);
    }
    Ok(Prepared {
        points: hexagons.points,
        ..Prepared::of([pass])
    })
}

/// The control point between two corners, such that the middle of the edge is `middle`: c110 = (4 e - p0 - p1) / 2.
fn edge_control(middle: Vec3, a: Vec3, b: Vec3) -> Vec3 {
    2.0 * middle - 0.5 * (a + b)
}

fn twin(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let (p, n): ([Vec3; 6], [Vec3; 6]) = control_points(pass, given, patch);
    SurfacePoint {
        position: quadratic(p, uv),
        normal: unit(quadratic(n, uv)),
    }
}

fn tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let (points, _): ([Vec3; 6], [Vec3; 6]) = control_points(pass, given, patch);
    let edges = edge_controls(points);
    let w = corner_weights(uv);
    // Half of the derivative by weight i, the three being free.
    let by = [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        w[i] * points[i] + (w[j] * edges[i] + w[k] * edges[k])
    });
    [1, 2].map(|i| 2.0 * (by[i] - by[0]))
}

/// Between the corners, on the edges from corner i to corner i + 1.
fn edge_controls([a, b, c, ab, bc, ca]: [Vec3; 6]) -> [Vec3; 3] {
    [
        edge_control(ab, a, b),
        edge_control(bc, b, c),
        edge_control(ca, c, a),
    ]
}

/// The quadratic triangle through three corners and the middles of the edges from corner i to corner i + 1.
fn quadratic(points: [Vec3; 6], uv: Vec2) -> Vec3 {
    let w = corner_weights(uv);
    let edges = edge_controls(points);
    let [a, b, c, ..] = points;
    let pairs = [w[0] * w[1], w[1] * w[2], w[2] * w[0]];
    sum_of_three(w.map(|w| w * w), [a, b, c]) + 2.0 * sum_of_three(pairs, edges)
}

/// The flag of a place, by the number of the control point there, where the surface has several normals.
fn creased(number: usize) -> u32 {
    // Flags count edges first, control points corners.
    abi::PATCH_CREASED << ((number + 3) % 6)
}
