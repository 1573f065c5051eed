//! The configuration of a face: all that shapes its limit but the positions (Brainerd et al. 2016, section 4.3).
//!
//! Faces of equal configuration share a plan. A configuration lists the faces of the 1-ring in the order of a walk around the face's
//! corners, each with its vertices numbered as they are first met; the sharpness of the corners; and that of the edges at the corners.
//! Nothing farther out has a say (see `subdivision::refine`), except that under Chaikin's rule the next sharpness at an edge's far end
//! does: it is part of what an edge brings along.

use std::cmp::Ordering;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::error::{Error, Misuse, Result};
use crate::mesh::places::Places;
use crate::mesh::sharpness::is_sharp;
use crate::mesh::topology::{FaceCorner, Topology};
use crate::mesh::{CreaseMethod, SchemeOptions, TriangleSubdivision};

/// What a plan depends on. Equal configurations are equal words; the words hold the whole local mesh, so no two differ by accident.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
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
    /// Whether the walk went clockwise: the face is the mirror image of what the plan is for, with u and v exchanged.
    pub mirrored: bool,
}

/// Where a walk begins, and which way it goes around.
#[derive(Clone, Copy)]
struct Start {
    face: u32,
    corner: u32,
    mirrored: bool,
}

impl Start {
    /// The `i`th corner of a face of `arity` corners that the walk meets, of at most two rounds.
    fn corner(self, i: u32, arity: u32) -> u32 {
        let wrapped = |corner: u32| {
            if corner < arity {
                corner
            } else {
                corner - arity
            }
        };
        let i = wrapped(i);
        wrapped(if self.mirrored {
            self.corner + arity - i
        } else {
            self.corner + i
        })
    }

    /// The edge from that corner to the next.
    fn edge(self, i: u32, arity: u32) -> u32 {
        self.corner(i + u32::from(self.mirrored), arity)
    }
}

impl Ring {
    /// The ring of a quad, beginning at the corner and going the way around whose configuration is the least, so that turned and mirrored faces find the
    /// same plan. None where there is no such quad.
    pub fn of_quad(topology: &Topology, face: u32) -> Option<Ring> {
        if topology.face(face).len() != 4 {
            return None;
        }
        let starts = least_starts(topology, face);
        Ring::smooth(topology, face, starts[0]).or_else(|| {
            let starts = starts.into_iter();
            Ring::least(starts.map(|start| Ring::around(topology, start, 4)))
        })
    }

    /// The ring of a quad around which all is smooth and quads, and no vertex met twice: its corners' valences tell all, and those of `start` are the least.
    /// None of others.
    fn smooth(topology: &Topology, face: u32, start: Start) -> Option<Ring> {
        let corners = topology.face(face);
        if !corners.iter().all(|&vertex| is_smooth(topology, vertex)) {
            return None;
        }
        let valences = corners.iter().map(|&v| topology.vertex_faces(v).len());
        let valences: usize = valences.sum();
        let ring = Ring::around(topology, start, 4);
        // Nine faces and sixteen vertices around four corners of four faces; a face and two vertices for each beyond.
        let is_simple =
            ring.faces.len() + 7 == valences && ring.vertices.len() + 16 == 2 * valences;
        is_simple.then_some(ring)
    }

    /// The ring of the part of a face of any arity at corner `corner`, going the way around whose configuration is the least. The configuration of an n-gon
    /// stands for its part at that corner. None where there is no such corner.
    pub fn of_part(topology: &Topology, face: u32, corner: u32) -> Option<Ring> {
        let arity = topology.face(face).len() as u32;
        let starts = [false, true].map(|mirrored| Start {
            face,
            corner,
            mirrored,
        });
        let starts = starts.into_iter().filter(|_| corner < arity);
        Ring::least(starts.map(|start| Ring::around(topology, start, arity)))
    }

    /// The ring of a face of any arity, beginning at corner `start`. The configuration of an n-gon stands for its part at that corner. None where
    /// there is no such corner.
    pub fn from_corner(topology: &Topology, face: u32, start: u32) -> Option<Ring> {
        let arity = topology.face(face).len() as u32;
        (start < arity).then(|| Ring::unmirrored(topology, face, start, arity))
    }

    /// The ring of the edge: the faces around its ends. It begins in one of the faces on the edge, and the edge runs from vertex 0 to
    /// vertex 1, so that the configuration is the least. None where there is no such edge.
    pub fn of_edge(topology: &Topology, edge: u32) -> Option<Ring> {
        let rings = few(topology.edge_faces(edge)).iter().map(|&face| {
            let edges = topology.face_edges(face).iter();
            let start = edges.into_iter().position(|&e| e == edge);
            let start = start.expect("a face on the edge has it") as u32;
            Ring::unmirrored(topology, face, start, 2)
        });
        Ring::least(rings)
    }

    /// The ring of a vertex: the faces around it. It begins in that face in which the configuration is the least. None of a vertex that no face has.
    pub fn of_vertex(topology: &Topology, vertex: u32) -> Option<Ring> {
        let corners = few(topology.vertex_faces(vertex)).iter();
        Ring::least(corners.map(|at| Ring::unmirrored(topology, at.face, at.corner, 1)))
    }

    fn least(rings: impl Iterator<Item = Ring>) -> Option<Ring> {
        rings.min_by(|a, b| a.configuration.cmp(&b.configuration))
    }

    fn unmirrored(topology: &Topology, face: u32, corner: u32, corners: u32) -> Ring {
        let start = Start {
            face,
            corner,
            mirrored: false,
        };
        Ring::around(topology, start, corners)
    }

    /// The faces around so many vertices of a face.
    fn around(topology: &Topology, start: Start, corners: u32) -> Ring {
        let faces = surrounding_faces(topology, start, corners);
        let sides = faces.iter().map(|at| topology.face(at.face).len());
        let mut walk = Walk::new(topology, sides.sum::<usize>() + faces.len());
        walk.options(topology.options());
        walk.words.push(faces.len() as u32);
        for &start in &faces {
            walk.face(start);
        }
        walk.words.push(corners);
        for corner in 0..corners as usize {
            walk.words.push(
                topology
                    .vertex_sharpness(walk.vertices.found()[corner])
                    .to_bits(),
            );
        }
        walk.edges(&faces, corners);
        Ring {
            vertices: walk.vertices.found().to_vec(),
            configuration: Configuration { words: walk.words },
            faces: faces.iter().map(|start| start.face).collect(),
            start: start.corner,
            mirrored: start.mirrored,
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

/// Whether a word is a sharpness.
fn is_float(word: u32) -> bool {
    f32::from_bits(word) >= 0.0
}

/// Whether nothing is sharp at a vertex, and all its faces are quads. So it is inside and manifold: all else is made sharp.
fn is_smooth(topology: &Topology, vertex: u32) -> bool {
    let faces = topology.vertex_faces(vertex).iter();
    !is_sharp(topology.vertex_sharpness(vertex))
        && topology.sharp_edges(vertex).next().is_none()
        && faces
            .into_iter()
            .all(|at| topology.face(at.face).len() == 4)
}

/// The starts in a quad at which what is seen at its corners and edges alone is the least: so few walks must be compared as a whole.
fn least_starts(topology: &Topology, face: u32) -> SmallVec<[Start; 8]> {
    let (vertices, edges) = (topology.face(face), topology.face_edges(face));
    let corners: SmallVec<[[u32; 3]; 4]> = vertices
        .iter()
        .map(|&vertex| {
            let faces = topology.vertex_faces(vertex).len() as u32;
            let sharp = topology.sharp_edges(vertex).count() as u32;
            [faces, sharp, topology.vertex_sharpness(vertex).to_bits()]
        })
        .collect();
    let sharpness = |edge: u32| topology.edge(edges[edge as usize]).sharpness.to_bits();
    let key = |start: Start| {
        [0, 1, 2, 3].map(|i| {
            let corner = corners[start.corner(i, 4) as usize];
            (corner, sharpness(start.edge(i, 4)))
        })
    };
    let mut least: SmallVec<[Start; 8]> = SmallVec::new();
    for i in 0..8 {
        let start = Start {
            face,
            corner: i % 4,
            mirrored: i >= 4,
        };
        match least.first().map(|&known| key(start).cmp(&key(known))) {
            Some(Ordering::Greater) => continue,
            Some(Ordering::Less) => least.clear(),
            _ => {}
        }
        least.push(start);
    }
    least
}

/// Every face that has one of so many vertices of the first one: around each corner in turn, counter-clockwise and then, where a boundary stopped the
/// walk, clockwise, or the other way around; last those that only a non-manifold vertex joins. Each with the corner at which its vertices begin.
fn surrounding_faces(topology: &Topology, start: Start, corners: u32) -> SmallVec<[Start; 16]> {
    let Start { face, mirrored, .. } = start;
    let arity = topology.face(face).len() as u32;
    let mut found = SmallVec::from_slice(&[start]);
    let mut known = Places::default();
    known.add(face);
    let mut add = |next: u32, vertex: u32| {
        if known.add(next) {
            found.push(Start {
                face: next,
                corner: topology.corner_of(next, vertex),
                mirrored,
            });
        }
    };
    'corners: for i in 0..corners {
        let vertex = topology.face(face)[start.corner(i, arity) as usize];
        let edges = topology.face_edges(face);
        let around = topology.vertex_faces(vertex);
        for i in [i + arity - 1, i] {
            let edge = edges[start.edge(i, arity) as usize];
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
    vertices: Places,
    words: Vec<u32>,
}

impl Walk<'_> {
    /// Nothing yet, with room for faces that take so many words.
    fn new(topology: &Topology, faces: usize) -> Walk<'_> {
        Walk {
            topology,
            vertices: Places::default(),
            words: Vec::with_capacity(6 + faces + 5),
        }
    }

    fn options(&mut self, options: SchemeOptions) {
        let chaikin = u32::from(options.creasing == CreaseMethod::Chaikin);
        let smooth = u32::from(options.triangles == TriangleSubdivision::Smooth);
        self.words.push(chaikin | smooth << 1);
    }

    fn face(&mut self, start: Start) {
        let vertices = self.topology.face(start.face);
        let arity = vertices.len() as u32;
        self.words.push(arity);
        for i in 0..arity {
            let vertex = vertices[start.corner(i, arity) as usize];
            self.words.push(self.vertices.of(vertex) as u32);
        }
    }

    /// The sharp edges at the first `corners` vertices, each once, in the order in which the faces show them. The words tell the numbers of the faces' vertices.
    fn edges(&mut self, faces: &[Start], corners: u32) {
        let topology = self.topology;
        let mut seen = Places::default();
        let mut at = 2;
        for start in faces {
            let (vertices, edges) = (topology.face(start.face), topology.face_edges(start.face));
            let arity = edges.len() as u32;
            for i in 0..arity {
                let next = if i + 1 == arity { 0 } else { i + 1 };
                let [a, b] = [i, next].map(|i| self.words[at + 1 + i as usize]);
                if a.min(b) >= corners {
                    continue;
                }
                let number = edges[start.edge(i, arity) as usize];
                let edge = topology.edge(number);
                let alone = topology.edge_faces(number).len() == 1;
                if !is_sharp(edge.sharpness) || !(alone || seen.add(number)) {
                    continue;
                }
                let [mut near, mut far] = topology.next_sharpness(number);
                if (vertices[start.corner(i, arity) as usize] == edge.vertices[0]) != (a < b) {
                    (near, far) = (far, near);
                }
                let [sharpness, near, far] = [edge.sharpness, near, far].map(f32::to_bits);
                let words = [a.min(b), a.max(b), sharpness, near, far];
                self.words.extend(words);
            }
            at += 1 + arity as usize;
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

    /// The configuration that [`words`](Self::words) gave, from where they were stored; None where they tell none.
    pub(super) fn from_words(words: &[u32]) -> Option<Configuration> {
        let (&[flags, faces], mut rest) = words.split_first_chunk()?;
        let mut vertices = 0;
        for _ in 0..faces {
            let (&arity, behind) = rest.split_first()?;
            let (face, behind) = behind.split_at_checked(arity as usize)?;
            for &vertex in face {
                if vertex > vertices {
                    return None;
                }
                vertices = vertices.max(vertex + 1);
            }
            rest = behind;
            if arity < 3 {
                return None;
            }
        }
        let (&corners, rest) = rest.split_first()?;
        let (sharpness, edges) = rest.split_at_checked(corners as usize)?;
        let edges = edges.chunks(5);
        let mut floats = sharpness.iter().copied();
        let sound = flags <= 3
            && (1..=*words.get(2)?).contains(&corners)
            && floats.all(is_float)
            && edges.into_iter().all(|edge| match *edge {
                [a, b, ref floats @ ..] if floats.len() == 3 => {
                    a < b && b < vertices && floats.iter().copied().all(is_float)
                }
                _ => false,
            });
        sound.then(|| Configuration {
            words: words.to_vec(),
        })
    }

    /// How many faces it lists.
    pub(super) fn face_count(&self) -> u32 {
        self.words[1]
    }

    /// How many vertices these have.
    pub(super) fn vertex_count(&self) -> u32 {
        let mut at = 2;
        let mut vertices = 0;
        for _ in 0..self.words[1] {
            let arity = self.words[at] as usize;
            let face = &self.words[at + 1..=at + arity];
            vertices = face.iter().fold(vertices, |most, &v| most.max(v + 1));
            at += 1 + arity;
        }
        vertices
    }

    /// The words, for storage.
    pub fn words(&self) -> &[u32] {
        &self.words
    }
}
