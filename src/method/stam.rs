//! `stam`: direct evaluation of Catmull and Clark's limit (Stam 1998, "Exact evaluation of Catmull-Clark subdivision surfaces at arbitrary parameter values").
//!
//! Far down towards an extraordinary vertex the limit is the same B-splines, of control vertices that one matrix was applied to again and again. In the
//! basis of its eigenvectors that is a power of each eigenvalue (`stam/eigenbasis.rs`): so any place costs one sum over 2 N + 8 vectors, of which each is a
//! bicubic B-spline, however deep it lies. The paper's patches have one extraordinary vertex at most. Where a mesh has others it is refined once (section 2).
//!
//! The paper leaves what faces share to rounding. Here edges away from extraordinary vertices are B-splines, summed as in regular faces, and an edge at one
//! is evaluated by the face that it leaves the vertex in: so all faces there have the same bits.

mod eigenbasis;
mod net;

use glam::{Vec2, Vec3};
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::points::{Points, Row};
use crate::method::regular::{regular_surface, turned_corners};
use crate::method::surface::{Controls, Surface, SurfacePoint};
use crate::method::{Contract, Method, MethodOptions, Pass, Prepared, Reproduces, Table};
use crate::patch::bspline::basis;
use crate::plan::{Database, SmoothQuads};
use crate::subdivision::{Blend, Mask, limit_stencil};
use crate::tessellation::Domain;
use eigenbasis::{Eigenbasis, PIECES, on_grid};
use net::{Face, Net};

/// The row of the table.
pub const METHOD: Method = Method {
    name: "stam",
    summary: "the exact Catmull-Clark limit of smooth closed meshes, by eigenbases",
    paper: "Stam 1998",
    schemes: &[Scheme::CatmullClark],
    domains: &[Domain::Quads],
    contract: Contract {
        reproduces: Reproduces::Limit(1e-6),
        normals: Some(0.1),
        interpolates: false,
        watertight: true,
    },
    uses_tables: false,
    isolates: false,
    aggregates: false,
    dynamic: false,
    covers: net::check,
    prepare,
    edits: None,
};

fn prepare(model: &Model, _options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let net = Net::new(model);
    let smooth = SmoothQuads::new(&net.topology);
    let mut builder = Builder {
        model,
        net: &net,
        smooth: &smooth,
        irregular: Pass::new("stam", Domain::Quads, 1, irregular).with_tangents(irregular_tangents),
        regular: Pass::new("stam_regular", Domain::Quads, 1, regular)
            .with_tangents(regular_tangents),
        bases: Bases::default(),
        limits: FxHashMap::default(),
        blends: Vec::new(),
        vectors: FxHashMap::default(),
    };
    let mut points = Points::default();
    points.blend(0, &net.masks);
    points.begin(abi::POINTS_LIMIT, points.count);
    for face in &net.faces {
        builder.add_limit(face, &mut points);
    }
    let first = points.count;
    for face in &net.faces {
        builder.add_vectors(face, first);
    }
    for face in &net.faces {
        builder.add(face);
    }
    let Builder {
        mut irregular,
        regular,
        bases,
        blends,
        ..
    } = builder;
    points.blend(first, &blends);
    irregular.tables = vec![Table::of(&bases.records), Table::of(&bases.floats)];
    Ok(Prepared {
        points,
        ..Prepared::of([irregular, regular])
    })
}

/// The eigenbases of the valences that there are, as shaders read them.
#[derive(Default)]
struct Bases {
    numbers: FxHashMap<usize, u32>,
    /// Rows of the inverses, by number.
    inverses: Vec<Vec<Vec<f64>>>,
    records: Vec<abi::Eigenbasis>,
    floats: Vec<f32>,
}

impl Bases {
    /// The number of a valence's.
    fn number(&mut self, valence: usize) -> u32 {
        if let Some(&number) = self.numbers.get(&valence) {
            return number;
        }
        let basis = Eigenbasis::new(valence);
        let count = eigenbasis::vertices(valence);
        let coefficients = self.floats.len() as u32;
        for piece in PIECES {
            let vectors = (0..count).flat_map(|vector| basis.coefficients(vector, piece));
            self.floats.extend(vectors.map(|weight| weight as f32));
        }
        let powers = self.floats.len() as u32;
        for level in 0..abi::EIGEN_LEVELS as i32 {
            let values = basis.values().map(|value| value.powi(level) as f32);
            self.floats.extend(values);
        }
        self.records.push(abi::Eigenbasis {
            count: count as u32,
            coefficients,
            powers,
        });
        self.inverses.push(basis.inverse());
        let number = self.numbers.len() as u32;
        self.numbers.insert(valence, number);
        number
    }
}

/// Puts patches together.
struct Builder<'a> {
    model: &'a Model,
    net: &'a Net,
    smooth: &'a SmoothQuads<'a>,
    irregular: Pass,
    regular: Pass,
    bases: Bases,
    /// The points of the limits at extraordinary vertices.
    limits: FxHashMap<u32, u32>,
    /// What the points of vectors are sums of.
    blends: Vec<Mask>,
    /// Before the point of a face's second vector.
    vectors: FxHashMap<u32, u32>,
}

impl Builder<'_> {
    /// The point of the limit at a face's extraordinary vertex, if it has one.
    fn add_limit(&mut self, face: &Face, points: &mut Points) {
        let Some(corner) = face.extraordinary else {
            return;
        };
        let vertex = self.net.topology.face(face.number)[corner as usize];
        if self.limits.contains_key(&vertex) {
            return;
        }
        let limit = limit_stencil(&self.net.topology, face.number, corner);
        let limit = limit.expect("nothing is sharp at a vertex that is let through");
        let masks = [limit.position, limit.du, limit.dv];
        let [position, du, dv] = masks.map(|mask| Mask::blend(&mask, &self.net.masks));
        self.limits.insert(vertex, points.count);
        points.push(Row::Limit([&position, &du, &dv]));
    }

    /// The points of a face's vectors but the first, which is the limit.
    fn add_vectors(&mut self, face: &Face, first: u32) {
        let Some(corner) = face.extraordinary else {
            return;
        };
        let vertices = self.around(face.number, corner);
        let number = self.bases.number((vertices.len() - 8) / 2);
        let inverse = &self.bases.inverses[number as usize];
        self.vectors
            .insert(face.number, first + self.blends.len() as u32 - 1);
        for row in &inverse[1..] {
            let mask: Mask = vertices.iter().copied().zip(row.iter().copied()).collect();
            self.blends.push(Mask::blend(&mask, &self.net.masks));
        }
    }

    /// The vertices that the limit of a face depends on, as they are numbered in `stam/eigenbasis.rs`, from its corner on.
    fn around(&self, face: u32, corner: u32) -> Vec<u32> {
        let smooth = self.smooth;
        let side = |i: u32| 4 * face + (corner + i) % 4;
        let mut vertices = vec![smooth.vertex_after(side(0), 0)];
        let mut at = side(0);
        loop {
            vertices.extend([1, 2].map(|steps| smooth.vertex_after(at, steps)));
            at = smooth.around(at);
            if at == side(0) {
                break;
            }
        }
        // Across the face's other corners, by quarters around them.
        let beyond = [
            (1, 2, 2),
            (1, 2, 3),
            (1, 3, 2),
            (2, 2, 2),
            (2, 2, 3),
            (2, 3, 2),
            (3, 2, 2),
        ];
        let beyond = beyond.map(|(corner, quarters, steps)| {
            let at = (0..quarters).fold(side(corner), |at, _| smooth.around(at));
            smooth.vertex_after(at, steps)
        });
        vertices.extend(beyond);
        vertices
    }

    fn add(&mut self, face: &Face) {
        let turn = face.extraordinary.unwrap_or(0);
        let (mut patch, texture) = face.patch(self.model, &self.net.topology, turn);
        patch.flags |= turned_corners(self.smooth, face.number, turn);
        let pass = match face.extraordinary {
            None => &mut self.regular,
            Some(_) => &mut self.irregular,
        };
        patch.controls = pass.controls.len() as u32;
        if let Some(vertices) = self.smooth.regular(face.number) {
            self.regular.controls.extend(vertices);
        } else {
            let vertices = self.around(face.number, turn);
            let valence = (vertices.len() - 8) / 2;
            patch.plan = self.bases.number(valence);
            let next = self.smooth.around(4 * face.number + turn) / 4;
            let controls = &mut self.irregular.controls;
            // In the order of `EIGEN_LIMIT`, `EIGEN_VECTORS`, `EIGEN_NEXT`, `EIGEN_GRID`.
            controls.push(self.limits[&vertices[0]]);
            let vectors = |face: u32| self.vectors.get(&face).copied().unwrap_or(abi::EIGEN_HOLE);
            controls.extend([face.number, next].map(vectors));
            // Where there is no vertex, none counts on the edges that the grid is for.
            let grid = (0..16).map(|i| [i % 4 - 1, i / 4 - 1]);
            controls.extend(grid.map(|place| vertices[on_grid(valence, place).unwrap_or(0)]));
        }
        let pass = match face.extraordinary {
            None => &mut self.regular,
            Some(_) => &mut self.irregular,
        };
        pass.texture.push(texture);
        pass.patches.push(patch);
    }
}

fn regular(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    on_grid_of(pass, given, patch, 0, uv).point()
}

fn regular_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let Surface { du, dv, .. } = on_grid_of(pass, given, patch, 0, uv);
    [du, dv]
}

/// The B-spline of the grid that stands behind so many of a patch's numbers.
fn on_grid_of(pass: &Pass, given: &Controls, patch: usize, first: usize, uv: Vec2) -> Surface {
    let record = &pass.patches[patch];
    let numbers = &pass.controls[record.controls as usize + first..];
    let point = |x: usize, y: usize| given.points[numbers[x + 4 * y] as usize].position.into();
    regular_surface(record.flags, uv, point)
}

fn irregular(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let record = &pass.patches[patch];
    if uv == Vec2::ZERO {
        let limit = pass.controls[record.controls as usize + abi::EIGEN_LIMIT as usize];
        let limit = given.points[limit as usize];
        return SurfacePoint {
            position: limit.position.into(),
            normal: limit.normal.into(),
        };
    }
    irregular_surface(pass, given, patch, uv).point()
}

/// At an extraordinary vertex derivatives have no limit, or zero, and their directions along the edges have: those of the level's first vertices.
fn irregular_tangents(
    pass: &Pass,
    given: &Controls,
    patch: usize,
    uv: Vec2,
    level: u32,
) -> [Vec3; 2] {
    let at = |uv: Vec2| irregular_surface(pass, given, patch, uv);
    if uv == Vec2::ZERO {
        let nearest = f32::from_bits((127 - level) << 23);
        return [at(nearest * Vec2::X).du, at(nearest * Vec2::Y).dv];
    }
    let Surface { du, dv, .. } = at(uv);
    [du, dv]
}

/// Away from the extraordinary vertex itself.
fn irregular_surface(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> Surface {
    if uv.max_element() >= 1.0 {
        return on_grid_of(pass, given, patch, abi::EIGEN_GRID as usize, uv);
    }
    let record = &pass.patches[patch];
    let number = |place: u32| pass.controls[(record.controls + place) as usize];
    let position = |number: u32| Vec3::from(given.points[number as usize].position);
    let next = uv.x <= 0.0 && number(abi::EIGEN_NEXT) != abi::EIGEN_HOLE;
    let vectors = number(if next {
        abi::EIGEN_NEXT
    } else {
        abi::EIGEN_VECTORS
    });
    let own = if next { Vec2::new(uv.y, uv.x) } else { uv };
    let limit = position(number(abi::EIGEN_LIMIT));
    let point = |vector: u32| position(vectors + vector);
    let surface = eigen_surface(pass, record.plan, own, limit, point);
    if !next {
        return surface;
    }
    // The next face's u is this one's v, and its v runs against this one's u.
    Surface {
        du: -surface.dv,
        dv: surface.du,
        ..surface
    }
}

/// Sum of four products, in the order of a B-spline's.
fn weighted(w: [f32; 4], p: [f32; 4]) -> f32 {
    (w[0] * p[0] + w[2] * p[2]) + (w[1] * p[1] + w[3] * p[3])
}

/// The sum of eigenvectors (section 4, equation 14), where it is not the limit itself. The first vector is one everywhere: it has no derivatives, and its point is
/// the limit.
fn eigen_surface(
    pass: &Pass,
    plan: u32,
    uv: Vec2,
    limit: Vec3,
    point: impl Fn(u32) -> Vec3,
) -> Surface {
    let [bases, floats] = &pass.tables[..] else {
        return Surface::default();
    };
    let bases: &[abi::Eigenbasis] = bytemuck::cast_slice(bases);
    let floats: &[f32] = bytemuck::cast_slice(floats);
    // How often the patch is halved: floor(-log2) of the larger coordinate, read off the exponent of the float.
    let exponent = uv.max_element().to_bits() >> 23;
    let level = ((127 - exponent.min(126)) - 1).min(abi::EIGEN_LEVELS - 1);
    let grown = f32::from_bits((127 + level) << 23);
    let local = grown * uv;
    let [beyond_u, beyond_v] = [local.x, local.y].map(|x| u32::from(x >= 0.5));
    let own = 2.0 * local - Vec2::new(beyond_u as f32, beyond_v as f32);
    let piece = (beyond_u + 2 * beyond_v).max(1) - 1;
    let (u, v) = (basis(own.x), basis(own.y));
    let abi::Eigenbasis {
        count,
        coefficients,
        powers,
    } = bases[plan as usize];
    let first = coefficients + 16 * (piece * count);
    let power = powers + level * count;
    let (mut position, mut du, mut dv) = (limit, Vec3::ZERO, Vec3::ZERO);
    for i in 1..count {
        let rows = [0, 1, 2, 3].map(|y| {
            let at = (first + 16 * i + 4 * y) as usize;
            [floats[at], floats[at + 1], floats[at + 2], floats[at + 3]]
        });
        let values = rows.map(|row| weighted(u.value, row));
        let slopes = rows.map(|row| weighted(u.derivative, row));
        let point = floats[(power + i) as usize] * point(i);
        position += weighted(v.value, values) * point;
        du += weighted(v.value, slopes) * point;
        dv += weighted(v.derivative, values) * point;
    }
    // Each halving doubles derivatives, and the pieces are quarters.
    let scale = 2.0 * grown;
    Surface {
        position,
        du: scale * du,
        dv: scale * dv,
    }
}

#[cfg(test)]
mod tests;
