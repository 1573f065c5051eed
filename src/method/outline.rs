//! The edges and faces of the control mesh, to which the edges of patches belong: levels that go by them agree on both sides of each.

use std::sync::{Arc, OnceLock};

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::mesh::faces::Faces;
use crate::mesh::topology::Topology;
use crate::mesh::{ChangeSet, Model};
use crate::method::limits::{self, Limits};
use crate::method::patches::{self, Part};
use crate::method::ptex::{Child, child};
use crate::tessellation::Domain;

/// The edges and faces of a control mesh. Both count as sides, edges first: a patch's edge is a part of one of its mesh's edges, or lies within
/// one of its faces. Behind them come the lines of edges that have one level, where there are [`MacroFaces`](crate::method::MacroFaces).
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// The control vertices of each edge.
    edges: Vec<[u32; 2]>,
    faces: Arc<Faces>,
    /// Each as a way along all of its edges that ends where it begins.
    lines: Faces,
    vertices: usize,
    /// Found when somebody asks.
    stars: OnceLock<Vec<Star>>,
    limits: Limits,
}

type Star = SmallVec<[[u32; 2]; 4]>;

impl Outline {
    /// The outline of a control mesh.
    pub(super) fn new(topology: &Topology, limits: Limits) -> Outline {
        let ends = |edge| topology.edge(edge).vertices;
        Outline {
            edges: (0..topology.edge_count() as u32).map(ends).collect(),
            faces: topology.shared_faces().clone(),
            lines: Faces::default(),
            vertices: topology.vertex_count(),
            stars: OnceLock::new(),
            limits,
        }
    }

    /// Gives it lines.
    pub(super) fn add_lines(&mut self, lines: Faces) {
        self.lines = lines;
    }

    /// How many edges and faces there are: lines come behind these.
    pub(super) fn first_line(&self) -> u32 {
        (self.edges.len() + self.faces.len()) as u32
    }

    /// The depth of each side, by one a control vertex: of an edge the greater of its ends', of a face or a line the greatest of its edges'.
    ///
    /// # Errors
    /// [`Misuse::Count`] for other than one depth a control vertex.
    pub fn depths(&self, tags: &[f32]) -> Result<Vec<f32>> {
        self.check_count("depth tags", tags.len())?;
        let greatest = |vertices: &[u32]| {
            let tags = vertices.iter().map(|&vertex| tags[vertex as usize]);
            tags.fold(0.0, f32::max)
        };
        let edges = self.edges.iter().map(|ends| greatest(ends));
        let all = edges.chain(self.faces.iter().map(greatest));
        Ok(all.chain(self.lines.iter().map(greatest)).collect())
    }

    /// Refuses lists that have not one entry a control vertex.
    pub(super) fn check_count(&self, what: &'static str, given: usize) -> Result<()> {
        let expected = self.vertices;
        if given == expected {
            return Ok(());
        }
        Err(Error::Misuse(Misuse::Count {
            what,
            given,
            expected,
        }))
    }

    /// The control vertices of each edge.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The control vertices of a side: of an edge its ends, of a face all in turn; of a line those of a way along all of its edges, there and back, so that it
    /// ends where it begins. None where there is no such side.
    pub fn side(&self, side: u32) -> &[u32] {
        let side = side as usize;
        let Some(face) = side.checked_sub(self.edges.len()) else {
            return &self.edges[side];
        };
        match face.checked_sub(self.faces.len()) {
            None => self.faces.get(face),
            Some(line) => self.lines.get(line),
        }
    }

    /// Where the control vertices at `vertices` are on the surface that is drawn, each by itself: on the limit, or where they are themselves for methods that
    /// draw through them. Levels of edges go by these places. What they are made of is found the first time, in rayon's current pool.
    ///
    /// # Errors
    /// [`Misuse::Count`] for other than one position a control vertex.
    pub fn limits(&self, vertices: &[Vec3]) -> Result<Vec<Vec3>> {
        self.check_count("positions", vertices.len())?;
        let limit = |vertex| self.limit(vertex, vertices);
        Ok((0..vertices.len() as u32).map(limit).collect())
    }

    /// The same of one vertex, of which there is one, and of as many positions as there are vertices.
    pub(crate) fn limit(&self, vertex: u32, vertices: &[Vec3]) -> Vec3 {
        match self.limits.row(vertex) {
            [] => vertices[vertex as usize],
            row => limits::sum(row, vertices, |face| self.faces.get(face as usize)),
        }
    }

    /// Whether all vertices are on the surface themselves.
    #[cfg(feature = "vulkan")]
    pub(super) fn is_on_surface(&self) -> bool {
        self.limits.is_empty()
    }

    /// The terms of a vertex' limit; see [`Limits::row`].
    #[cfg(feature = "vulkan")]
    pub(super) fn limit_row(&self, vertex: u32) -> &[(u32, f32)] {
        self.limits.row(vertex)
    }

    /// The side that a face is.
    #[cfg(feature = "vulkan")]
    pub(super) fn side_of_face(&self, face: u32) -> u32 {
        self.edges.len() as u32 + face
    }

    /// Brings the limits up to an edited model.
    pub(super) fn edit_limits(&mut self, model: &Model, changes: &ChangeSet) {
        self.limits.renew(model, changes);
    }

    /// The limits, for an outline of the same vertices.
    pub(super) fn take_limits(&mut self) -> Limits {
        std::mem::take(&mut self.limits)
    }

    /// Takes over those of another one.
    #[cfg(feature = "vulkan")]
    pub(super) fn adopt_limits(&mut self, other: &Outline) {
        self.limits = other.limits.clone();
    }

    /// The star of a vertex: in each face around, in the order of faces, the vertex behind it and the one before. None where there is no such vertex.
    pub fn star(&self, vertex: u32) -> &[[u32; 2]] {
        let stars = self.stars.get_or_init(|| self.find_stars());
        stars.get(vertex as usize).map_or(&[], |star| &star[..])
    }

    fn find_stars(&self) -> Vec<Star> {
        let mut stars = vec![Star::new(); self.vertices];
        for face in self.faces.iter() {
            let n = face.len();
            for (corner, &vertex) in face.iter().enumerate() {
                stars[vertex as usize].push([face[(corner + 1) % n], face[(corner + n - 1) % n]]);
            }
        }
        stars
    }

    /// Unit normals of the vertices: of the faces around each, by their areas.
    pub(super) fn normals(&self, vertices: &[Vec3]) -> Vec<Vec3> {
        // In f64 products of floats stay within its range.
        let mut normals = vec![DVec3::ZERO; vertices.len()];
        for face in self.faces.iter() {
            let at = |i: usize| vertices[face[i % face.len()] as usize].as_dvec3();
            // Twice the area as a vector, whatever the polygon (Newell).
            let area = (0..face.len()).fold(DVec3::ZERO, |sum, i| {
                sum + (at(i) - at(0)).cross(at(i + 1) - at(0))
            });
            for &vertex in face {
                normals[vertex as usize] += area;
            }
        }
        let unit = |normal: DVec3| normal.normalize_or_zero().as_vec3();
        normals.into_iter().map(unit).collect()
    }
}

/// The sides to which a patch's edges belong, from corner i to corner i + 1; a triangle's last one twice.
pub(super) fn sides(topology: &Topology, part: Part, patch: &abi::Patch) -> [u32; 4] {
    let edges = topology.face_edges(part.face);
    let within = topology.edge_count() as u32 + part.face;
    let n = part.domain.corners();
    let turn = (patch.flags >> abi::PATCH_TURN_SHIFT & 3) as usize;
    let is_part = edges.len() != n;
    if let (Child::Whole, &[a, b, c, d]) = (child(patch), edges) {
        let mut sides = [a, b, c, d];
        sides.rotate_left(turn);
        return sides;
    }
    // The part of an n-gon at a corner has half of the edges there, as its edges 0 and 3.
    let corner = part.corner as usize;
    let edges_of_part = [corner, corner + edges.len() - 1].map(|i| edges[i % edges.len()]);
    std::array::from_fn(|i| {
        let side = (i.min(n - 1) + turn) % n;
        match child(patch) {
            Child::Whole if is_part => match side {
                0 | 3 => edges_of_part[side / 3],
                _ => within,
            },
            Child::Whole => edges[side],
            Child::Corner(corner) => {
                let touches = side == corner || side == (corner + n - 1) % n;
                if touches { edges[side] } else { within }
            }
            Child::Middle => within,
            Child::Piece(piece) => match (piece.borders()[side], side) {
                (false, _) => within,
                (true, 0 | 3) if is_part => edges_of_part[side / 3],
                (true, _) if is_part => within,
                (true, _) => edges[side],
            },
        }
    })
}

/// The sides of all patches of each pass.
pub(super) fn sides_of<'a>(
    model: &Model,
    passes: impl Iterator<Item = &'a [abi::Patch]>,
) -> Vec<Vec<[u32; 4]>> {
    let whole = model.mesh().options().scheme.is_whole(4);
    if whole && model.topology().quads().is_some() {
        let part = |patch: &abi::Patch| Part {
            domain: Domain::Quads,
            face: patch.ptex,
            corner: 0,
            ptex: patch.ptex,
        };
        let side = |patch: &abi::Patch| sides(model.topology(), part(patch), patch);
        return passes
            .map(|patches| patches.iter().map(side).collect())
            .collect();
    }
    let parts = patches::parts(model);
    let last = parts.last().map_or(0, |part| part.ptex as usize + 1);
    let mut places = vec![0; last];
    for (place, part) in (0u32..).zip(&parts) {
        places[part.ptex as usize] = place;
    }
    let part = |patch: &abi::Patch| parts[places[patch.ptex as usize] as usize];
    let side = |patch: &abi::Patch| sides(model.topology(), part(patch), patch);
    passes
        .map(|patches| patches.iter().map(side).collect())
        .collect()
}
