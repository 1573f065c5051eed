//! `acc`: bicubic patches with tangent patches (Loop, Schaefer 2008, "Approximating Catmull-Clark subdivision surfaces with bicubic patches"). Sixteen control
//! points for positions, and two patches of tangents that agree along edges where positions do not: so normals are continuous and the surface itself need not
//! be.
//!
//! At corners positions and tangents are the limit's, and on regular faces all is. A tangent patch is as fine along u as 2 and along v as 3: at its
//! sides it has the tangents of these edges and the derivatives across the others, which `spokes.rs` tells.

use glam::{Vec2, Vec3};

use crate::abi;
use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::bicubic::{Bicubic, along_edges, cubic_weights, edges_on};
use crate::method::edge_field::Numbers;
use crate::method::points::Row;
use crate::method::quads::sum_of_four;
use crate::method::spokes::{self, Family, Spokes};
use crate::method::surface::{Controls, Surface, SurfacePoint};
use crate::method::{Contract, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::plan::Database;
use crate::tessellation::Domain;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "acc",
    summary: "bicubic patches with the limit at their corners, and normals from tangent patches",
    paper: "Loop, Schaefer 2008",
    schemes: &[Scheme::CatmullClark],
    domains: &[Domain::Quads],
    contract: Contract {
        reproduces: Reproduces::Itself,
        normals: None,
        interpolates: false,
        watertight: true,
    },
    uses_tables: false,
    isolates: false,
    aggregates: false,
    dynamic: false,
    covers: spokes::check,
    prepare,
    edits: None,
};

fn prepare(model: &Model, _options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let mut spokes = Spokes::new(model, Family::Bicubic);
    spokes.points.begin(abi::POINTS_BLEND, spokes.points.count);
    let inner = |spokes: &mut Spokes, face: u32| {
        (0..4)
            .map(|corner| {
                let number = spokes.points.count;
                let mask = spokes.inner(face, corner);
                spokes.points.push(Row::Blend(&mask));
                number
            })
            .collect()
    };
    Ok(spokes.fill(
        model,
        [Pass::new("acc", Domain::Quads, 1, quad).with_tangents(tangents)],
        inner,
    ))
}

/// The points of an edge: next to its beginning, the tangent there, its field, the tangent at its end, and next to that.
const NEAR: usize = 0;
const FIRST: usize = 1;
const FIELD: usize = 2;
const LAST: usize = 6;
const FAR: usize = 7;
const PER_EDGE: usize = 8;
/// The inner points stand behind those of the edges.
const INNER: usize = 4 + 4 * PER_EDGE;

const THIRD: f32 = 1.0 / 3.0;

/// What a face has along one of its edges, as it runs: the tangent's three vectors, and the derivative across at a third and two thirds.
struct Side {
    tangent: [Vec3; 3],
    across: [Vec3; 2],
}

fn tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let numbers = Numbers::new(pass, given, patch, [4, PER_EDGE]);
    let (bicubic, sides) = net(pass, &numbers, patch);
    let Surface { du, dv, .. } = tangent_patches(&bicubic, &sides, uv);
    [du, dv]
}

/// The points of a patch, and what it has along its edges.
fn net(pass: &Pass, numbers: &Numbers, patch: usize) -> (Bicubic, [Side; 4]) {
    let bicubic = Bicubic {
        corners: std::array::from_fn(|i| numbers.point(i)),
        near: std::array::from_fn(|i| numbers.edge_point(i, NEAR)),
        far: std::array::from_fn(|i| numbers.edge_point(i, FAR)),
        inner: std::array::from_fn(|i| numbers.point(INNER + i)),
    };
    let cosines = &pass.tables[0][4 * pass.patches[patch].plan as usize..];
    let cosine = |corner: usize| f32::from_bits(cosines[corner % 4]);
    let sides = std::array::from_fn(|i| side(numbers, &bicubic, i, [cosine(i), cosine(i + 1)]));
    (bicubic, sides)
}

fn quad(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let numbers = Numbers::new(pass, given, patch, [4, PER_EDGE]);
    let (bicubic, sides) = net(pass, &numbers, patch);
    let surface = tangent_patches(&bicubic, &sides, uv);
    let on = edges_on(uv);
    let Some(edge) = (0..4).find(|&edge| on[edge]) else {
        return surface.point();
    };
    let mut ends = [edge, (edge + 1) % 4].into_iter();
    if let Some(corner) = ends.find(|&corner| on[corner] && on[(corner + 3) % 4]) {
        return SurfacePoint {
            position: surface.position,
            normal: numbers.normal(corner),
        };
    }
    let along = along_edges(uv)[edge];
    numbers.on_edge(surface.position, [edge, FIELD], sides[edge].tangent, along)
}

/// The tangent along an edge, whose middle is that of the edge itself, and the derivatives across it: half of what both faces' sum is, and the field.
fn side(numbers: &Numbers, bicubic: &Bicubic, edge: usize, [c0, c1]: [f32; 2]) -> Side {
    let direction = numbers.direction_of(edge);
    let first = direction * numbers.edge_point(edge, FIRST);
    let last = direction * numbers.edge_point(edge, LAST);
    let middle = 3.0 * (bicubic.far[edge] - bicubic.near[edge]);
    let field = [1, 2].map(|i| direction * numbers.edge_point(edge, FIELD + i));
    let one = THIRD * ((2.0 * c0) * middle - c1 * first) + field[0];
    let two = THIRD * (c0 * last - (2.0 * c1) * middle) + field[1];
    Side {
        tangent: [first, middle, last],
        across: [one, two],
    }
}

/// Both tangent patches: quadratic along, cubic across.
fn tangent_patches(bicubic: &Bicubic, sides: &[Side; 4], uv: Vec2) -> Surface {
    let (u, v) = (uv.x, uv.y);
    let (s, t) = (1.0 - u, 1.0 - v);
    let inner = &bicubic.inner;
    let [first, second, third, fourth] = sides;
    let backwards = |side: &Side| [-side.tangent[2], -side.tangent[1], -side.tangent[0]];
    let by_u = [
        first.tangent,
        [
            fourth.across[1],
            3.0 * (inner[1] - inner[0]),
            -second.across[0],
        ],
        [
            fourth.across[0],
            3.0 * (inner[2] - inner[3]),
            -second.across[1],
        ],
        backwards(third),
    ];
    let by_v = [
        backwards(fourth),
        [
            first.across[0],
            3.0 * (inner[3] - inner[0]),
            -third.across[1],
        ],
        [
            first.across[1],
            3.0 * (inner[2] - inner[1]),
            -third.across[0],
        ],
        second.tangent,
    ];
    Surface {
        position: bicubic.position(uv),
        du: tangent(by_u, [s, u], [t, v]),
        dv: tangent(by_v, [t, v], [s, u]),
    }
}

fn tangent(rows: [[Vec3; 3]; 4], [s, u]: [f32; 2], across: [f32; 2]) -> Vec3 {
    let of_row = |[a, b, c]: [Vec3; 3]| ((s * s) * a + (u * u) * c) + (2.0 * (s * u)) * b;
    sum_of_four(cubic_weights(across), rows.map(of_row))
}

#[cfg(test)]
mod tests;
