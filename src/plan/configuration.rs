//! The configuration of a face: all that shapes its limit but the positions (Brainerd et al. 2016, section 4.3).
//!
//! Faces of equal configuration share a plan. A configuration lists the faces of the 1-ring in the order of a walk around the face's
//! corners, each with its vertices numbered as they are first met; the sharpness of the corners; and that of the edges at the corners.
//! Nothing farther out has a say (see `subdivision::refine`), except that under Chaikin's rule the next sharpness at an edge's far end
//! does: it is part of what an edge brings along.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::error::{Error, Misuse, Result};
use crate::mesh::places::Places;
use crate::mesh::sharpness::is_sharp;
use crate::mesh::topology::{FaceCorner, Topology};
use crate::mesh::{CreaseMethod, SchemeOptions, TriangleSubdivision};

/// What a plan depends on. Equal configurations are equal words; the words hold the whole local mesh, so no two differ by accident.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Configuration {
    words: Vec<u32>,
}

/// A face's surroundings in canonical order.
#[derive(Clone, Debug)]
pub struct Ring {
    /// The vertices of the 1-ring, by their numbers in the mesh, in the order in which the configuration numbers them.
    pub vertices: Vec<u32>,
    /// The configuration.
    pub configuration: Configuration,
    /// The faces of the 1-ring, by their numbers in the mesh, in the order of the configuration.
    pub faces: Vec<u32>,
    /// The corner of the first face at which the walk began: the plan's corner 0.
    pub start: u32,
}

impl Ring {
    /// The ring of a quad, beginning at the corner whose configuration is the least, so that turned faces find the same plan. None where there is no
    /// such quad.
    pub fn of_quad(topology: &Topology, face: u32) -> Option<Ring> {
        let corners = (0..4).map(|start| Ring::from_corner(topology, face, start));
        let corners: Option<Vec<Ring>> = corners.collect();
        Ring::least(corners?.into_iter()).filter(|_| topology.face(face).len() == 4)
    }

    /// The ring of a face of any arity, beginning at corner `start`. The configuration of an n-gon stands for its part at that corner. None where
    /// there is no such corner.
    pub fn from_corner(topology: &Topology, face: u32, start: u32) -> Option<Ring> {
        let arity = topology.face(face).len() as u32;
        (start < arity).then(|| Ring::around(topology, face, start, arity))
    }

    /// The ring of the edge: the faces around its ends. It begins in one of the faces on the edge, and the edge runs from vertex 0 to
    /// vertex 1, so that the configuration is the least. None where there is no such edge.
    pub fn of_edge(topology: &Topology, edge: u32) -> Option<Ring> {
        let rings = few(topology.edge_faces(edge)).iter().map(|&face| {
            let [a, b] = topology.edge(edge).vertices;
            let corner = topology.corner_of(face, a);
            let runs_from_a = topology.face_edges(face)[corner as usize] == edge;
            let start = if runs_from_a {
                corner
            } else {
                topology.corner_of(face, b)
            };
            Ring::around(topology, face, start, 2)
        });
        Ring::least(rings)
    }

    /// The ring of a vertex: the faces around it. It begins in that face in which the configuration is the least. None of a vertex that no face has.
    pub fn of_vertex(topology: &Topology, vertex: u32) -> Option<Ring> {
        let corners = few(topology.vertex_faces(vertex)).iter();
        Ring::least(corners.map(|at| Ring::around(topology, at.face, at.corner, 1)))
    }

    fn least(rings: impl Iterator<Item = Ring>) -> Option<Ring> {
        rings.min_by(|a, b| a.configuration.cmp(&b.configuration))
    }

    /// The faces around so many vertices of a face, beginning with its corner `start`.
    fn around(topology: &Topology, face: u32, start: u32, corners: u32) -> Ring {
        let faces = surrounding_faces(topology, face, start, corners);
        let mut walk = Walk::new(topology, faces.len());
        walk.options(topology.options());
        walk.words.push(faces.len() as u32);
        for &(face, start) in &faces {
            walk.face(face, start);
        }
        walk.words.push(corners);
        for corner in 0..corners as usize {
            walk.words
                .push(topology.vertex_sharpness(walk.vertices[corner]).to_bits());
        }
        walk.edges(&faces, corners as usize);
        Ring {
            vertices: walk.vertices,
            configuration: Configuration { words: walk.words },
            faces: faces.iter().map(|&(face, _)| face).collect(),
            start,
        }
    }
}

/// More faces than that around a vertex are many.
const FEW: usize = 64;

/// Where to begin, of the faces around a vertex or an edge: anywhere, so that what looks alike finds the same plan; but trying all of hundreds takes the square
/// of their number, and hardly ever are two so large.
fn few<T>(all: &[T]) -> &[T] {
    if all.len() <= FEW { all } else { &all[..1] }
}

/// Every face that has one of so many vertices of `face`, which comes first: around each corner in turn, beginning with `start`, counter-clockwise and then, where a boundary stopped the
/// walk, clockwise; last those that only a non-manifold vertex joins. Each with the corner at which its vertices begin.
fn surrounding_faces(
    topology: &Topology,
    face: u32,
    start: u32,
    corners: u32,
) -> SmallVec<[(u32, u32); 16]> {
    let arity = topology.face(face).len() as u32;
    let mut found = SmallVec::from_slice(&[(face, start)]);
    let mut known = Places::default();
    known.add(face);
    let mut add = |next: u32, vertex: u32| {
        if known.add(next) {
            found.push((next, topology.corner_of(next, vertex)));
        }
    };
    'corners: for corner in (0..corners).map(|i| (start + i) % arity) {
        let vertex = topology.face(face)[corner as usize];
        let edges = topology.face_edges(face);
        let around = topology.vertex_faces(vertex);
        for edge in [
            edges[((corner + arity - 1) % arity) as usize],
            edges[corner as usize],
        ] {
            let mut met = 1;
            for (next, _) in topology.walk(vertex, face, edge) {
                add(next, vertex);
                met += 1;
            }
            if met == around.len() {
                continue 'corners;
            }
        }
        apart(topology, around).for_each(|corner| add(corner.face, vertex));
    }
    found
}

/// Faces around a vertex, some of which only it joins. Copies of a face have the same plan if many others follow in an order that does not depend on
/// which copy asks.
fn apart<'a>(
    topology: &Topology,
    around: &'a [FaceCorner],
) -> impl Iterator<Item = FaceCorner> + use<'a> {
    let mut sorted = Vec::new();
    if around.len() > FEW {
        sorted.extend_from_slice(around);
        sorted.sort_by_cached_key(|at| -> SmallVec<[u32; 8]> {
            let mut vertices = SmallVec::from_slice(topology.face(at.face));
            vertices.rotate_left(at.corner as usize);
            vertices
        });
    }
    let few = if sorted.is_empty() { around } else { &[] };
    few.iter().copied().chain(sorted)
}

/// Writes down a ring and numbers its vertices on the way.
struct Walk<'a> {
    topology: &'a Topology,
    numbers: FxHashMap<u32, u32>,
    vertices: Vec<u32>,
    words: Vec<u32>,
}

impl Walk<'_> {
    /// Nothing yet, with room for what a ring of so many quads takes.
    fn new(topology: &Topology, faces: usize) -> Walk<'_> {
        let vertices = 2 * faces;
        Walk {
            topology,
            numbers: FxHashMap::with_capacity_and_hasher(vertices, Default::default()),
            vertices: Vec::with_capacity(vertices),
            words: Vec::with_capacity(6 + 5 * faces + 5),
        }
    }

    fn options(&mut self, options: SchemeOptions) {
        let chaikin = u32::from(options.creasing == CreaseMethod::Chaikin);
        let smooth = u32::from(options.triangles == TriangleSubdivision::Smooth);
        self.words.push(chaikin | smooth << 1);
    }

    fn number(&mut self, vertex: u32) -> u32 {
        *self.numbers.entry(vertex).or_insert_with(|| {
            self.vertices.push(vertex);
            self.vertices.len() as u32 - 1
        })
    }

    fn face(&mut self, face: u32, start: u32) {
        let vertices = self.topology.face(face);
        self.words.push(vertices.len() as u32);
        for i in 0..vertices.len() {
            let number = self.number(vertices[(start as usize + i) % vertices.len()]);
            self.words.push(number);
        }
    }

    /// The sharp edges at the first `corners` vertices, each once, in the order in which the faces show them.
    fn edges(&mut self, faces: &[(u32, u32)], corners: usize) {
        let mut seen = Places::default();
        for &(face, start) in faces {
            let edges = self.topology.face_edges(face);
            for &number in (0..edges.len()).map(|i| &edges[(start as usize + i) % edges.len()]) {
                let edge = self.topology.edge(number);
                if !is_sharp(edge.sharpness) {
                    continue;
                }
                let [a, b] = edge.vertices.map(|vertex| self.numbers[&vertex]);
                if (a.min(b) as usize) < corners && seen.add(number) {
                    let ends = if a < b { [a, b] } else { [b, a] };
                    let next = if a < b {
                        edge.next
                    } else {
                        [edge.next[1], edge.next[0]]
                    };
                    self.words.extend(ends);
                    self.words
                        .extend([edge.sharpness, next[0], next[1]].map(f32::to_bits));
                }
            }
        }
    }
}

impl Configuration {
    /// The local mesh that the words tell: face 0 is the face itself, vertices are numbered as in [`Ring::vertices`].
    pub fn topology(&self) -> Topology {
        let mut words = self.words.iter().copied();
        let mut word = || {
            words
                .next()
                .expect("a configuration is written as it is read")
        };
        let flags = word();
        let options = SchemeOptions {
            creasing: if flags & 1 != 0 {
                CreaseMethod::Chaikin
            } else {
                CreaseMethod::Uniform
            },
            triangles: if flags & 2 != 0 {
                TriangleSubdivision::Smooth
            } else {
                TriangleSubdivision::CatmullClark
            },
            ..SchemeOptions::default()
        };
        let faces: Vec<SmallVec<[u32; 4]>> = (0..word())
            .map(|_| (0..word()).map(|_| word()).collect())
            .collect();
        let corners = word() as usize;
        let vertices = faces.iter().flatten().max().expect("a face has vertices") + 1;
        let mut sharpness = vec![0.0; vertices as usize];
        for sharpness in &mut sharpness[..corners] {
            *sharpness = f32::from_bits(word());
        }
        let rest: Vec<u32> = words.collect();
        let edges: FxHashMap<[u32; 2], [f32; 3]> = rest
            .chunks_exact(5)
            .map(|edge| {
                (
                    [edge[0], edge[1]],
                    [edge[2], edge[3], edge[4]].map(f32::from_bits),
                )
            })
            .collect();
        Topology::connect(
            faces.iter().map(|face| &face[..]),
            sharpness,
            options,
            |a, b| {
                let [sharpness, near, far] = edges
                    .get(&[a.min(b), a.max(b)])
                    .copied()
                    .unwrap_or_default();
                (sharpness, if a < b { [near, far] } else { [far, near] })
            },
        )
    }

    /// Around how many corners of face 0 it has all faces: all of its corners in the ring of a face, 2 in that of an edge, 1 in that of a vertex.
    fn corners(&self) -> u32 {
        let faces = self.words[1];
        let end = (0..faces).fold(2, |at, _| at + 1 + self.words[at] as usize);
        self.words[end]
    }

    /// Refuses to plan for what lies around more corners than the configuration tells of.
    ///
    /// # Errors
    /// [`Misuse::Ring`].
    pub(super) fn check_corners(&self, needed: u32) -> Result<()> {
        match self.corners() {
            given if given < needed => Err(Error::Misuse(Misuse::Ring { needed, given })),
            _ => Ok(()),
        }
    }

    /// The number of corners of face 0.
    pub(super) fn arity(&self) -> u32 {
        self.words[2]
    }

    /// The words, for storage.
    pub fn words(&self) -> &[u32] {
        &self.words
    }
}
