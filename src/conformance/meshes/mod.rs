//! Meshes for the suite, made in code: stars of any valence, sheets with creases, and random ones.

mod draft;
mod planar;

use std::f64::consts::TAU;

use crate::conformance::random::Random;
use crate::error::Result;
use crate::mesh::{
    BoundaryInterpolation, ControlMesh, ControlMeshBuilder, Model, Scheme, SchemeOptions,
    Triangulation, builtin, triangulated,
};
use crate::method::Method;

pub use draft::Draft;
pub use planar::{Planar, planar};

/// Positions and faces, to be tagged and built.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<Vec<u32>>,
}

impl Parts {
    /// The mesh without tags.
    pub fn build(&self) -> Result<ControlMesh> {
        self.tagged(|builder| builder)
    }

    /// The mesh with what `tag` adds.
    pub fn tagged(
        &self,
        tag: impl FnOnce(ControlMeshBuilder) -> ControlMeshBuilder,
    ) -> Result<ControlMesh> {
        let sizes: Vec<u32> = self.faces.iter().map(|face| face.len() as u32).collect();
        let builder = ControlMesh::builder(&self.positions, &sizes, &self.faces.concat());
        tag(builder).build()
    }

    /// The mesh under a scheme without tags; for those who are not able to draw boundaries, with holes for the faces there.
    pub fn open(&self, scheme: Scheme, able: impl Fn(&ControlMesh) -> bool) -> Result<ControlMesh> {
        let whole = under(self.build()?, scheme)?;
        if able(&whole) {
            return Ok(whole);
        }
        let options = SchemeOptions {
            boundary: BoundaryInterpolation::None,
            ..SchemeOptions::default()
        };
        under(self.tagged(|builder| builder.options(options))?, scheme)
    }

    /// Moves every vertex by up to `by`, the same way for the same seed: nothing is where symmetry would hide a mistake.
    pub fn scattered(mut self, by: f64) -> Parts {
        let mut random = Random::new(0, "scattered");
        for position in &mut self.positions {
            *position = position.map(|x| x + random.between(-by, by));
        }
        self
    }
}

/// Quads around a vertex of valence `valence`, and around these another ring of quads, so that the first ring is away from the boundary.
pub fn star(valence: u32) -> Parts {
    let n = valence;
    let at = |radius: f64, angle: f64| {
        let (sin, cos) = (TAU * angle / f64::from(n)).sin_cos();
        [radius * cos, radius * sin, 0.3 * (radius - 1.0).powi(2)]
    };
    let mut parts = Parts {
        positions: vec![at(0.0, 0.0)],
        faces: Vec::new(),
    };
    // Rings of 2 n vertices: on spokes and between them.
    for ring in 1..=2 {
        let radius = f64::from(ring);
        parts
            .positions
            .extend((0..2 * n).map(|i| at(radius, 0.5 * f64::from(i))));
    }
    let vertex = |ring: u32, i: u32| 1 + 2 * n * (ring - 1) + i % (2 * n);
    for i in 0..n {
        parts.faces.push(vec![
            0,
            vertex(1, 2 * i),
            vertex(1, 2 * i + 1),
            vertex(1, 2 * i + 2),
        ]);
    }
    for i in 0..2 * n {
        parts.faces.push(vec![
            vertex(1, i),
            vertex(2, i),
            vertex(2, i + 1),
            vertex(1, i + 1),
        ]);
    }
    parts.scattered(0.03)
}

/// `faces` quads around a boundary vertex.
pub fn open_star(faces: u32) -> Parts {
    let points = 2 * faces + 1;
    let at = |i: u32| {
        let angle = 0.7 * TAU * f64::from(i) / f64::from(points);
        [angle.cos(), angle.sin(), 0.2 * f64::from(i % 3)]
    };
    let mut parts = Parts {
        positions: vec![[0.0, 0.0, 0.3]],
        faces: Vec::new(),
    };
    parts.positions.extend((0..points).map(at));
    parts.faces = (0..faces)
        .map(|i| vec![0, 2 * i + 1, 2 * i + 2, 2 * i + 3])
        .collect();
    parts.scattered(0.03)
}

/// A polygon of `corners` corners with a ring of quads around it.
pub fn framed_polygon(corners: u32) -> Parts {
    let at = |radius: f64, i: u32| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(corners)).sin_cos();
        [radius * cos, radius * sin, 0.2 * radius]
    };
    let mut parts = Parts::default();
    for radius in [1.0, 2.0] {
        parts.positions.extend((0..corners).map(|i| at(radius, i)));
    }
    parts.faces.push((0..corners).collect());
    for i in 0..corners {
        let next = (i + 1) % corners;
        parts.faces.push(vec![i, corners + i, corners + next, next]);
    }
    parts.scattered(0.05)
}

/// A wavy sheet of `side` x `side` quads. Vertex (x, y) has number `x + (side + 1) y`.
pub fn sheet(side: u32) -> Parts {
    let n = side + 1;
    let at = |x: u32, y: u32| {
        let (x, y) = (f64::from(x), f64::from(y));
        [x, y, 0.5 * (0.9 * x).sin() * (0.7 * y).cos()]
    };
    let places = || (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    Parts {
        positions: (0..n * n).map(|i| at(i % n, i / n)).collect(),
        faces: places()
            .map(|(x, y)| {
                let corner = x + n * y;
                vec![corner, corner + 1, corner + 1 + n, corner + n]
            })
            .collect(),
    }
    .scattered(0.1)
}

/// A sheet whose middle row of edges is a crease: all of it, or one that ends inside.
pub fn creased_sheet(sharpness: f32, edges: u32, options: SchemeOptions) -> Result<ControlMesh> {
    const SIDE: u32 = 6;
    let row = (SIDE + 1) * (SIDE / 2);
    sheet(SIDE).tagged(|builder| {
        (0..edges)
            .fold(builder, |builder, x| {
                builder.crease(row + x, row + x + 1, sharpness)
            })
            .options(options)
    })
}

/// A sheet with a corner of this sharpness in its middle.
pub fn cornered_sheet(sharpness: f32) -> Result<ControlMesh> {
    sheet(4).tagged(|builder| builder.corner(2 + 5 * 2, sharpness))
}

/// Quads, triangles, pentagons and hexagons with creases of all kinds between them.
pub fn creased_polygons() -> Result<ControlMesh> {
    let mut parts = sheet(6);
    for face in [14, 15, 27] {
        split(&mut parts, face);
    }
    for edge in [[24, 31], [16, 23]] {
        merge(&mut parts, edge);
    }
    let rows = [(14, 10.0), (21, 2.5), (28, 0.7)];
    parts.tagged(|builder| {
        let edges = rows
            .into_iter()
            .flat_map(|(first, s)| (1..5).map(move |x| (first + x, s)));
        edges.fold(builder, |builder, (a, s)| builder.crease(a, a + 1, s))
    })
}

/// Cuts a quad in two triangles.
fn split(parts: &mut Parts, face: usize) {
    let [a, b, c, d] = parts.faces[face][..] else {
        return;
    };
    parts.faces[face] = vec![a, b, c];
    parts.faces.push(vec![a, c, d]);
}

/// Joins the two faces on an edge.
fn merge(parts: &mut Parts, [a, b]: [u32; 2]) {
    let starts = |face: &[u32], a, b| {
        (0..face.len()).find(|&i| face[i] == a && face[(i + 1) % face.len()] == b)
    };
    let mut joined = Vec::new();
    for (from, to) in [(a, b), (b, a)] {
        let found =
            (0..parts.faces.len()).find_map(|f| Some((f, starts(&parts.faces[f], from, to)?)));
        let (face, at) = found.expect("two faces have the edge");
        let mut vertices = parts.faces.remove(face);
        vertices.rotate_left(at + 1);
        // From the edge's end all the way round to just before it.
        vertices.pop();
        joined.extend(vertices);
    }
    parts.faces.push(joined);
}

/// A mesh with other positions, its faces and tags as before.
pub fn with_positions(mesh: &ControlMesh, positions: &[[f64; 3]]) -> Result<ControlMesh> {
    let parts = Parts {
        positions: positions.to_vec(),
        faces: mesh.faces().map(<[u32]>::to_vec).collect(),
    };
    parts.tagged(|mut builder| {
        builder = builder.options(mesh.options());
        for crease in mesh.creases() {
            let [a, b] = crease.vertices;
            builder = builder.crease(a, b, crease.sharpness);
        }
        for corner in mesh.corners() {
            builder = builder.corner(corner.vertex, corner.sharpness);
        }
        mesh.holes()
            .iter()
            .fold(builder, |builder, &hole| builder.hole(hole))
    })
}

/// A mesh scaled, then moved.
pub fn moved(mesh: &ControlMesh, scale: f64, by: f64) -> Result<ControlMesh> {
    let positions: Vec<[f64; 3]> = mesh
        .positions()
        .iter()
        .map(|p| p.to_array().map(|x| scale * x + by))
        .collect();
    with_positions(mesh, &positions)
}

/// A mesh under a scheme, cut into triangles if that takes no others.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) when the scheme knows nothing of the mesh's tags.
pub fn under(mesh: ControlMesh, scheme: Scheme) -> Result<ControlMesh> {
    if scheme.is_triangular() {
        triangulated(&mesh, Triangulation::default())?.with_scheme(scheme)
    } else {
        mesh.with_scheme(scheme)
    }
}

/// Whether a method can draw a built-in shape under a scheme.
pub fn can_draw(method: &Method, shape: &str, scheme: Scheme) -> bool {
    let mesh = builtin(shape).and_then(|mesh| under(mesh, scheme));
    mesh.is_ok_and(|mesh| method.check_model(&Model::new(mesh)).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn valences_are_the_wanted_ones() {
        for n in [3, 4, 5, 17, 64] {
            let star = Model::new(star(n).build().expect("a star is sound"));
            assert_eq!(star.topology().vertex_edges(0).len(), n as usize);
            let open = Model::new(open_star(n).build().expect("so is an open one"));
            assert_eq!(open.topology().vertex_edges(0).len(), n as usize + 1);
        }
    }

    #[test]
    fn tags_survive_new_positions() {
        let mesh = creased_sheet(2.5, 3, SchemeOptions::default()).expect("it is sound");
        let moved = moved(&mesh, 2.0, 1.0).expect("and stays so");
        assert_eq!(mesh.creases(), moved.creases());
        assert!(mesh.faces().eq(moved.faces()));
        assert_eq!(moved.positions()[0], 2.0 * mesh.positions()[0] + 1.0);
    }
}
