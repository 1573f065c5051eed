//! `gregory`: Gregory patches (Loop, Schaefer, Ni, Castano 2009, "Approximating subdivision surfaces with Gregory patches for hardware tessellation"). Twenty
//! control points a quad, fifteen a triangle; one plane along every edge.
//!
//! At corners they have the limit and its tangent plane, and on regular quads all of it. Positions on edges are the paper's cubics for both shapes, so quads and triangles
//! may meet. For triangles the paper takes Catmull and Clark's masks; here corners have the limit of the scheme, and what crosses an edge of regular triangles
//! is the box spline's own, derived in `spokes/ring.rs`: what quads have there would
//! not reproduce planes. At a vertex among both the plane is the paper's own.
//!
//! The derivatives are those of the surface, with the quotients at the inner points; on edges the plane comes from the edge's field (`spokes.rs`), which is
//! the same for both faces to the last bit.

use glam::{Vec2, Vec3};

use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::bicubic::{along_edges, edges_on};
use crate::method::blended::{Net, blended, quad_surface};
use crate::method::edge_field::Numbers;
use crate::method::spokes::{self, Family, Spokes};
use crate::method::surface::{Controls, Surface, SurfacePoint};
use crate::method::triangles::{corner_weights, sum_of_three};
use crate::method::{Contract, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::plan::Database;
use crate::tessellation::Domain;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "gregory",
    summary: "Gregory patches: quads and triangles with the limit at their corners and one plane along edges",
    paper: "Loop, Schaefer, Ni, Castaño 2009",
    schemes: &[Scheme::CatmullClark, Scheme::LoopStam, Scheme::Loop],
    domains: &[Domain::Quads, Domain::Triangles],
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
    let quads = Pass::new("gregory_quads", Domain::Quads, 1, quad).with_tangents(quad_tangents);
    let triangles =
        Pass::new("gregory", Domain::Triangles, 1, triangle).with_tangents(triangle_tangents);
    let spokes = Spokes::new(model, Family::Gregory);
    Ok(spokes.fill(model, [quads, triangles], |_, _| Vec::new()))
}

/// The points of an edge: next to its beginning, its field, next to its end.
const NEAR: usize = 0;
const FIELD: usize = 1;
const FAR: usize = 5;
const PER_EDGE: usize = 6;

const THIRD: f32 = 1.0 / 3.0;

fn net<const N: usize>(pass: &Pass, numbers: &Numbers, patch: usize) -> Net<N> {
    let cosines = &pass.tables[0][4 * pass.patches[patch].plan as usize..];
    let corners: [Vec3; N] = std::array::from_fn(|i| numbers.point(i));
    let near: [Vec3; N] = std::array::from_fn(|i| numbers.edge_point(i, NEAR));
    let far: [Vec3; N] = std::array::from_fn(|i| numbers.edge_point(i, FAR));
    let inside = |i: usize, at_end: bool| {
        let j = (i + 1) % N;
        let [own, other] = if at_end { [j, i] } else { [i, j] };
        let [next, beyond] = if at_end {
            [far[i], near[i]]
        } else {
            [near[i], far[i]]
        };
        let field = numbers.edge_point(i, FIELD + if at_end { 2 } else { 1 });
        let cosines = [own, other].map(|corner| f32::from_bits(cosines[corner]));
        inner_point::<N>(
            corners[own],
            [next, beyond],
            numbers.direction_of(i) * field,
            cosines,
        )
    };
    Net {
        corners,
        near,
        far,
        before: std::array::from_fn(|i| inside(i, false)),
        behind: std::array::from_fn(|i| inside(i, true)),
    }
}

/// The point inside of one next to a corner, by what the edge's field has there and the cosines at this corner and the edge's other one. For a quad
/// (c1 p + (3 - 2 c0 - c1) e + 2 c0 e' + r) / 3, for a triangle (c1 p + (4 - 2 c0 - c1) e + 2 c0 e' + r) / 4.
fn inner_point<const N: usize>(
    corner: Vec3,
    [next, beyond]: [Vec3; 2],
    field: Vec3,
    [own, other]: [f32; 2],
) -> Vec3 {
    let (rows, share) = if N == 4 { (3.0, THIRD) } else { (4.0, 0.25) };
    let along = other * corner + ((rows - 2.0 * own) - other) * next;
    share * ((along + (2.0 * own) * beyond) + field)
}

fn quad_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let numbers = Numbers::new(pass, given, patch, [4, PER_EDGE]);
    let Surface { du, dv, .. } = quad_surface(&net::<4>(pass, &numbers, patch), uv);
    [du, dv]
}

fn triangle_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let numbers = Numbers::new(pass, given, patch, [3, PER_EDGE]);
    let net = net::<3>(pass, &numbers, patch);
    let Surface { du, dv, .. } = triangle_surface(&net, corner_weights(uv));
    [du, dv]
}

fn quad(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let numbers = Numbers::new(pass, given, patch, [4, PER_EDGE]);
    let net = net::<4>(pass, &numbers, patch);
    let surface = quad_surface(&net, uv);
    on_border(&net, &numbers, surface, edges_on(uv), along_edges(uv))
}

/// On edges and at corners normals are what all faces have there.
fn on_border<const N: usize>(
    net: &Net<N>,
    numbers: &Numbers,
    surface: Surface,
    on: [bool; N],
    along: [[f32; 2]; N],
) -> SurfacePoint {
    let Some(edge) = (0..N).find(|&edge| on[edge]) else {
        return surface.point();
    };
    let next = (edge + 1) % N;
    let corner = [edge, next]
        .into_iter()
        .find(|&corner| on[corner] && on[(corner + N - 1) % N]);
    if let Some(corner) = corner {
        return SurfacePoint {
            position: surface.position,
            normal: numbers.normal(corner),
        };
    }
    let tangent = [
        net.near[edge] - net.corners[edge],
        net.far[edge] - net.near[edge],
        net.corners[next] - net.far[edge],
    ];
    numbers.on_edge(surface.position, [edge, FIELD], tangent, along[edge])
}

fn triangle(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let numbers = Numbers::new(pass, given, patch, [3, PER_EDGE]);
    let net = net::<3>(pass, &numbers, patch);
    let w = corner_weights(uv);
    let surface = triangle_surface(&net, w);
    let along = [0, 1, 2].map(|i| [w[i], w[(i + 1) % 3]]);
    // Edge i is where the corner that it does not have counts for nothing.
    let on = [0, 1, 2].map(|i| w[(i + 2) % 3] <= 0.0);
    on_border(&net, &numbers, surface, on, along)
}

/// The sums over corners, over edges and inside, with the derivative of each by its weights.
fn triangle_surface(net: &Net<3>, w: [f32; 3]) -> Surface {
    let Net {
        corners: p,
        near,
        far,
        ..
    } = net;
    let (next, last) = ([1, 2, 0], [2, 0, 1]);
    let blend: [(Vec3, Vec3); 3] = [0, 1, 2].map(|i| {
        let points = [net.before[i], net.behind[last[i]]];
        blended([w[next[i]], w[last[i]]], points)
    });
    let pairs = [0, 1, 2].map(|i| w[i] * w[next[i]]);
    // On edge i exactly 1.
    let lengths = [0, 1, 2].map(|i| 1.0 - w[last[i]]);
    let edges = [0, 1, 2].map(|i| w[i] * near[i] + w[next[i]] * far[i]);
    let shares = [0, 1, 2].map(|i| pairs[i] * lengths[i]);
    let inner = sum_of_three(w, blend.map(|(mean, _)| mean));
    let product = 12.0 * (pairs[0] * w[2]);
    let position = (sum_of_three(w.map(|w| (w * w) * w), *p) + 3.0 * sum_of_three(shares, edges))
        + product * inner;
    // By weight i, the three being free: 1 - w of the opposite corner is the sum of both others.
    let by = [0, 1, 2].map(|i| {
        let (j, k) = (next[i], last[i]);
        let corner = (3.0 * (w[i] * w[i])) * p[i];
        // Edge i leaves corner i, edge k comes to it; edge j is opposite.
        let leaving = (w[j] * (lengths[i] + w[i])) * edges[i] + shares[i] * near[i];
        let coming = (w[k] * (lengths[k] + w[i])) * edges[k] + shares[k] * far[k];
        let own = blend[i].0;
        let turning = (w[j] * w[k]) * (blend[k].1 - blend[j].1);
        let around = leaving + coming;
        let inside = (12.0 * (w[j] * w[k])) * inner + product * (own + turning);
        (corner + 3.0 * around) + inside
    });
    Surface {
        position,
        du: by[1] - by[0],
        dv: by[2] - by[0],
    }
}

#[cfg(test)]
mod tests;
