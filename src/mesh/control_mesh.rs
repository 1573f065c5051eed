//! The control mesh: positions, faces and the tags that shape their limit surface.

mod checks;
mod tags;

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::error::Result;
use crate::mesh::Scheme;
use crate::mesh::creased_edges::CreasedEdges;
use crate::mesh::faces::Faces;
use crate::mesh::placement::{Placement, bounds};

pub(super) use checks::{check_face, check_position, check_sharpness};

/// A sharpness of 10 or more is infinite (DeRose, Kass, Truong 1998; OpenSubdiv's `SHARPNESS_INFINITE`).
pub const INFINITE_SHARPNESS: f32 = 10.0;

/// How the surface behaves at the mesh's boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BoundaryInterpolation {
    /// Faces that touch a boundary have no limit surface.
    None,
    /// Boundary edges are infinitely sharp creases.
    #[default]
    EdgeOnly,
    /// As `EdgeOnly`, and vertices with a single face are infinitely sharp corners.
    EdgeAndCorner,
}

/// How the sharpness of a crease decays from one refinement to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CreaseMethod {
    /// Each edge loses 1 a level (DeRose, Kass, Truong 1998).
    #[default]
    Uniform,
    /// Sharpness is smoothed along the crease by Chaikin's rule before it loses 1.
    Chaikin,
}

/// How the first refinement treats edges of triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TriangleSubdivision {
    /// Catmull and Clark's weights for every face.
    #[default]
    CatmullClark,
    /// The edge weights of `smoothtriangles`, which avoid ripples over triangles.
    Smooth,
}

/// The scheme, and its options as the tags of an OBJ file give them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SchemeOptions {
    /// Which scheme refines the mesh.
    pub scheme: Scheme,
    /// Boundary rule (`interpolateboundary`).
    pub boundary: BoundaryInterpolation,
    /// Crease decay (`creasemethod`).
    pub creasing: CreaseMethod,
    /// Triangle rule (`smoothtriangles`).
    pub triangles: TriangleSubdivision,
}

/// A creased edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease {
    /// The edge's two vertices, in either order.
    pub vertices: [u32; 2],
    /// 0 or more; 10 or more is infinite.
    pub sharpness: f32,
}

/// A sharp vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The vertex.
    pub vertex: u32,
    /// 0 or more; 10 or more is infinite.
    pub sharpness: f32,
}

/// Texture coordinates: values, and for each corner of each face the index of its value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaceVarying {
    /// The values.
    pub values: Vec<DVec2>,
    /// One index a face corner, in the order of the faces' vertices.
    pub indices: Vec<u32>,
}

/// Positions, faces of any arity >= 3, and tags. Checked when made: every index is in range, every number finite.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlMesh {
    positions: Vec<DVec3>,
    faces: Arc<Faces>,
    creases: Vec<Crease>,
    corners: Vec<Corner>,
    holes: Vec<u32>,
    texture: Option<FaceVarying>,
    options: SchemeOptions,
}

/// Collects what a [`ControlMesh`] is made of; [`build`](ControlMeshBuilder::build) checks it.
///
/// ```
/// use hullform::mesh::ControlMesh;
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = ControlMesh::builder(&positions, &[4], &[0, 1, 2, 3]).crease(0, 1, 2.5).build()?;
/// assert_eq!(mesh.face(0), [0, 1, 2, 3]);
/// # Ok::<(), hullform::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct ControlMeshBuilder {
    mesh: ControlMesh,
    face_sizes: Vec<u32>,
    face_vertices: Vec<u32>,
}

impl ControlMesh {
    /// Starts a mesh from `positions`, the arity of each face, and the faces' vertices one after another.
    pub fn builder(
        positions: &[[f64; 3]],
        face_sizes: &[u32],
        face_vertices: &[u32],
    ) -> ControlMeshBuilder {
        ControlMeshBuilder::of_parts(
            positions.iter().copied().map(DVec3::from).collect(),
            face_sizes.to_vec(),
            face_vertices.to_vec(),
        )
    }

    /// The vertices' positions, as given.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// The number of faces, holes and removed ones included.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Whether a face was removed by an [`Edit`](crate::mesh::Edit): it keeps its number, and has no vertices.
    pub fn is_removed(&self, face: usize) -> bool {
        face < self.face_count() && self.face(face).is_empty()
    }

    /// The vertices of face `face`, in file order; none where there is no such face, or no more.
    pub fn face(&self, face: usize) -> &[u32] {
        self.faces.get(face)
    }

    /// Where the corners of face `face` stand in arrays with one entry a face corner; nowhere if there is no such face.
    pub fn corner_range(&self, face: usize) -> std::ops::Range<usize> {
        self.faces.range(face)
    }

    /// The vertices of every face in file order; none of those that were removed.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        self.faces.iter()
    }

    /// The faces, for those who keep them.
    pub(crate) fn shared_faces(&self) -> &Arc<Faces> {
        &self.faces
    }

    /// The creased edges, as given.
    pub fn creases(&self) -> &[Crease] {
        &self.creases
    }

    /// The sharp vertices, as given.
    pub fn corners(&self) -> &[Corner] {
        &self.corners
    }

    /// The faces that are holes: they shape their neighbours but are not drawn.
    pub fn holes(&self) -> &[u32] {
        &self.holes
    }

    /// Texture coordinates, when the mesh has any.
    pub fn texture(&self) -> Option<&FaceVarying> {
        self.texture.as_ref()
    }

    /// The scheme's options.
    pub fn options(&self) -> SchemeOptions {
        self.options
    }

    /// The same mesh under another scheme.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for faces and tags that the scheme knows nothing of, see [`Scheme::check`].
    pub fn with_scheme(mut self, scheme: Scheme) -> Result<ControlMesh> {
        self.options.scheme = scheme;
        scheme.check(&self)?;
        Ok(self)
    }

    /// The number of ptex faces: one a quad, n an n-gon; holes and removed faces keep their numbers. Triangles that the scheme takes whole have one.
    pub fn ptex_count(&self) -> usize {
        (0..self.face_count())
            .map(|face| self.ptex_faces(face))
            .sum()
    }

    /// The first ptex number of each face.
    pub fn ptex_offsets(&self) -> Vec<u32> {
        let mut next = 0;
        (0..self.face_count())
            .map(|face| {
                let first = next;
                next += self.ptex_faces(face) as u32;
                first
            })
            .collect()
    }

    /// The ptex faces of a face, or of one that was removed.
    pub(crate) fn ptex_faces(&self, face: usize) -> usize {
        self.options.scheme.ptex_faces(self.faces.corners(face))
    }

    /// The least and greatest corner of the bounding box of the control vertices that faces use.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        bounds(self.used_positions())
    }

    /// Where the mesh lies and how large it is, by the vertices that faces use.
    pub fn placement(&self) -> Placement {
        Placement::of(self.used_positions())
    }

    /// The positions of the vertices that faces use, one for each corner of a face.
    fn used_positions(&self) -> impl Iterator<Item = DVec3> {
        let corners = self.faces.vertices().iter();
        corners.map(|&vertex| self.positions[vertex as usize])
    }
}

impl ControlMeshBuilder {
    /// Starts a mesh as [`ControlMesh::builder`] does, from what need not be copied.
    pub(super) fn of_parts(
        positions: Vec<DVec3>,
        face_sizes: Vec<u32>,
        face_vertices: Vec<u32>,
    ) -> ControlMeshBuilder {
        ControlMeshBuilder {
            face_sizes,
            face_vertices,
            mesh: ControlMesh {
                positions,
                faces: Arc::default(),
                creases: Vec::new(),
                corners: Vec::new(),
                holes: Vec::new(),
                texture: None,
                options: SchemeOptions::default(),
            },
        }
    }

    /// Makes the edge `a`-`b` a crease. Sharpness 0 or more; 10 or more is infinite.
    pub fn crease(mut self, a: u32, b: u32, sharpness: f32) -> Self {
        self.mesh.creases.push(Crease {
            vertices: [a, b],
            sharpness,
        });
        self
    }

    /// Makes `vertex` a corner. Sharpness 0 or more; 10 or more is infinite.
    pub fn corner(mut self, vertex: u32, sharpness: f32) -> Self {
        self.mesh.corners.push(Corner { vertex, sharpness });
        self
    }

    /// Makes `face` a hole.
    pub fn hole(mut self, face: u32) -> Self {
        self.mesh.holes.push(face);
        self
    }

    /// Adds texture coordinates: values and one index a face corner.
    pub fn texture(mut self, texture: FaceVarying) -> Self {
        self.mesh.texture = Some(texture);
        self
    }

    /// Sets the scheme's options.
    pub fn options(mut self, options: SchemeOptions) -> Self {
        self.mesh.options = options;
        self
    }

    /// Sets the scheme and leaves its options.
    pub fn scheme(mut self, scheme: Scheme) -> Self {
        self.mesh.options.scheme = scheme;
        self
    }

    /// Checks everything and hands out the mesh.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for a mesh without faces, a face of fewer than three vertices or one that names a vertex twice,
    /// an index out of range, a position that is not finite, one of a face's beyond 1e300, a tag that names no edge, vertex or face of the mesh, and what
    /// the scheme knows nothing of.
    pub fn build(self) -> Result<ControlMesh> {
        let ControlMeshBuilder {
            mut mesh,
            face_sizes,
            face_vertices,
        } = self;
        let offsets = checks::offsets(&face_sizes, face_vertices.len())?;
        mesh.faces = Faces::new(offsets, face_vertices).into();
        checks::check_faces(&mesh)?;
        checks::check_positions(&mesh)?;
        checks::check_tags(&mesh)?;
        mesh.options.scheme.check(&mesh)?;
        Ok(mesh)
    }
}

/// The greatest coordinate of a vertex that a face uses: so what is computed from several of them, derivatives too, stays within f64.
pub(crate) const GREATEST_COORDINATE: f64 = 1e300;

/// The greatest texture coordinate of a face's corner: what is interpolated between two of them stays within f32.
pub(crate) const GREATEST_TEXTURE_COORDINATE: f64 = 1e30;

/// The edges that creases of a mesh name.
pub(super) fn creased_edges(mesh: &ControlMesh) -> CreasedEdges {
    let ends = mesh.creases.iter().map(|crease| crease.vertices);
    CreasedEdges::new(mesh.vertex_count(), ends)
}
