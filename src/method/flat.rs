//! `flat`: bilinear patches and plain triangles. The speed of light that other methods are compared with, and the plainest row of the table.
//!
//! Each of a patch's control points is the mean of some control vertices: of one at a corner of the mesh, of two in the middle of an
//! n-gon's edge, of all in its centre.

use glam::{Vec2, Vec3};
use smallvec::SmallVec;

use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::patches::{self, Part};
use crate::method::surface::{Controls, SurfacePoint, Tangents, UNIT, reach};
use crate::method::{self, Contract, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::plan::Database;
use crate::tessellation::Domain;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "flat",
    summary: "the faces of the control mesh themselves",
    paper: "none: the baseline",
    schemes: &Scheme::ALL,
    domains: &[Domain::Quads, Domain::Triangles],
    contract: Contract {
        reproduces: Reproduces::Faces(1e-6),
        normals: None,
        interpolates: true,
        watertight: false,
    },
    uses_tables: false,
    isolates: false,
    aggregates: false,
    dynamic: false,
    covers: method::every_mesh,
    prepare,
    edits: None,
};

fn prepare(model: &Model, _options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let topology = model.topology();
    let mut quads = Pass::new("flat", Domain::Quads, 4, quad).with_tangents(quad_tangents);
    let mut triangles = Pass::new("flat_triangles", Domain::Triangles, 3, triangle)
        .with_tangents(triangle_tangents);
    for part in patches::parts(model) {
        let pass = match part.domain {
            Domain::Quads => &mut quads,
            Domain::Triangles => &mut triangles,
        };
        let mut patch = patches::patch(model, part, 0);
        patch.controls = push_controls(&mut pass.controls, topology.face(part.face), part);
        pass.texture.push(patches::texture(model, part, 0));
        pass.patches.push(patch);
    }
    Ok(Prepared::of([quads, triangles]))
}

/// Adds the list of a part of a face with these vertices, and tells where it begins. Of a triangle its vertices. Of a quad where the vertices of each of the
/// four points begin and end, then the vertices; but those of an n-gon's centre stand once, before the list of its first part.
fn push_controls(controls: &mut Vec<u32>, vertices: &[u32], part: Part) -> u32 {
    if part.domain == Domain::Triangles {
        let list = controls.len() as u32;
        controls.extend_from_slice(vertices);
        return list;
    }
    let (n, i) = (vertices.len(), part.corner as usize);
    if n != 4 && i == 0 {
        controls.extend_from_slice(vertices);
    }
    let list = controls.len() as u32;
    let first = list + 8;
    let (ends, own) = if n == 4 {
        let ends = std::array::from_fn(|corner| [first + corner as u32, first + corner as u32 + 1]);
        (ends, SmallVec::<[u32; 4]>::from_slice(vertices))
    } else {
        let around = [n - 1, 0, 1].map(|turn| vertices[(i + turn) % n]);
        // The lists of the parts before lie between.
        let centre = list - n as u32 - part.corner * (8 + 3);
        let ends = [
            [first + 1, first + 2],
            [first + 1, first + 3],
            [centre, centre + n as u32],
            [first, first + 2],
        ];
        (ends, SmallVec::from_slice(&around))
    };
    controls.extend(ends.as_flattened());
    controls.extend_from_slice(&own);
    list
}

fn corners(pass: &Pass, given: &Controls, patch: usize) -> [Vec3; 4] {
    let list = pass.patches[patch].controls as usize;
    let point = |corner: usize| {
        let ends = [0, 1].map(|end| pass.controls[list + 2 * corner + end] as usize);
        let vertices = &pass.controls[ends[0]..ends[1]];
        vertices
            .iter()
            .map(|&vertex| given.vertices[vertex as usize])
            .sum::<Vec3>()
            / vertices.len() as f32
    };
    std::array::from_fn(point)
}

/// The points at the bottom and the top, and the derivative by u.
fn bilinear([a, b, c, d]: [Vec3; 4], uv: Vec2) -> [Vec3; 3] {
    [
        a * (1.0 - uv.x) + b * uv.x,
        d * (1.0 - uv.x) + c * uv.x,
        (b - a) * (1.0 - uv.y) + (c - d) * uv.y,
    ]
}

fn quad_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let [bottom, top, along] = bilinear(corners(pass, given, patch), uv);
    [along, top - bottom]
}

fn quad(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let corners = corners(pass, given, patch);
    let [bottom, top, along] = bilinear(corners, uv);
    let own = normal(along, top - bottom, &corners);
    let [a, b, c, d] = corners;
    SurfacePoint {
        position: bottom * (1.0 - uv.y) + top * uv.y,
        // Where the corner is straight, or two corners are one: of the diagonals, that is of the whole.
        normal: if own == Vec3::ZERO {
            normal(c - a, d - b, &corners)
        } else {
            own
        },
    }
}

/// Of two differences of points, each of which was rounded once.
fn normal(du: Vec3, dv: Vec3, points: &[Vec3]) -> Vec3 {
    let greatest = points.iter().map(|&point| reach(point));
    let error = 4.0 * UNIT * greatest.fold(0.0, f32::max);
    let tangents = Tangents {
        sums: [du, dv],
        errors: [error; 2],
    };
    tangents.normal()
}

fn vertices(pass: &Pass, given: &Controls, patch: usize) -> [Vec3; 3] {
    let controls = &pass.controls[pass.patches[patch].controls as usize..];
    [0, 1, 2].map(|corner| given.vertices[controls[corner] as usize])
}

fn triangle_tangents(pass: &Pass, given: &Controls, patch: usize, _: Vec2, _: u32) -> [Vec3; 2] {
    let [a, b, c] = vertices(pass, given, patch);
    [b - a, c - a]
}

fn triangle(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let [a, b, c] = vertices(pass, given, patch);
    SurfacePoint {
        position: a * (1.0 - uv.x - uv.y) + b * uv.x + c * uv.y,
        normal: normal(b - a, c - a, &[a, b, c]),
    }
}
