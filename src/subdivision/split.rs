//! One step of refinement of a whole topology, or of what surrounds one child, under any scheme.
//!
//! Edges of the next level are halves of edges of this one, or lie inside a face. They are told apart by what they come from and not by their ends:
//! around an interior vertex of two triangles two edges join the same two points.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::mesh::Scheme;
use crate::mesh::sharpness::decayed;
use crate::mesh::topology::Topology;
use crate::subdivision::masks::Mask;
use crate::subdivision::refine::{Origin, Refinement, half};
use crate::subdivision::schemes::{point, rings, rules};

/// A child face: where its vertices come from, and its sides, each from its vertex i to the next.
struct Child {
    parent: u32,
    vertices: SmallVec<[Origin; 4]>,
    sides: SmallVec<[Side; 4]>,
}

/// A side of a child face: half of an edge of its parent, or an edge inside of it.
#[derive(Clone, Copy)]
enum Side {
    Half(u32, u32),
    Inner(u32, u32),
}

/// Refines every face.
///
/// Vertices come in the order of the parent's vertices, then of its edges, then of those of its faces that get a point: all but triangles
/// that stay triangles. Faces come in the order of the parent's faces and of these children:
///
/// - A triangle under a scheme for triangles has the children at its corners 0, 1 and 2, each with that corner as its own, and then the
///   middle one, whose corner i lies opposite to the parent's. A child's (u, v) is `2 (u, v) - (0, 0)`, `(1, 0)`, `(0, 1)`, and in the middle `1 - 2 (u, v)`.
/// - A quad has a child at each corner, which is that child's corner of the same number; (u, v) is `2 (u, v) - (0, 0)`, `(1, 0)`, `(1, 1)`, `(0, 1)`.
/// - Any other face has a quad at each corner, which begins there; its (u, v) is that of the face's ptex face.
///
/// Children of holes are holes.
pub fn refine_all(parent: &Topology, scheme: Scheme) -> Refinement {
    let children: Vec<Child> = all_children(parent, scheme);
    let has_point = |&face: &u32| !is_split_into_triangles(parent, scheme, face);
    let origins = (0..parent.vertex_count() as u32)
        .map(Origin::Vertex)
        .chain((0..parent.edge_count() as u32).map(Origin::Edge))
        .chain(
            (0..parent.face_count() as u32)
                .filter(has_point)
                .map(Origin::Face),
        );
    let mut numbers = Numbers::new(parent);
    origins.for_each(|origin| {
        numbers.number(origin);
    });
    let cells = children.len() as u32;
    numbers.finish(parent, scheme, &children, cells)
}

/// Refines one child of face 0, by its number in [`refine_all`]'s order, with as many rings of faces around it as the scheme's rules see.
pub(super) fn refine_child(parent: &Topology, scheme: Scheme, child: u32) -> Refinement {
    let mut rest = all_children(parent, scheme);
    let mut kept = vec![rest.remove(child as usize)];
    let mut numbers = Numbers::new(parent);
    for _ in 0..rings(scheme) {
        kept.iter().for_each(|child| numbers.meet(child));
        let (near, far): (Vec<Child>, Vec<Child>) =
            rest.into_iter().partition(|child| numbers.touches(child));
        kept.extend(near);
        rest = far;
    }
    kept.iter().for_each(|child| numbers.meet(child));
    numbers.finish(parent, scheme, &kept, 1)
}

fn is_split_into_triangles(topology: &Topology, scheme: Scheme, face: u32) -> bool {
    topology.face(face).len() == 3 && scheme.is_whole(3)
}

fn all_children(parent: &Topology, scheme: Scheme) -> Vec<Child> {
    let faces = 0..parent.face_count() as u32;
    faces
        .flat_map(|face| {
            if is_split_into_triangles(parent, scheme, face) {
                triangles(parent, face)
            } else {
                quads(parent, face)
            }
        })
        .collect()
}

/// Three corner triangles and the middle one.
fn triangles(topology: &Topology, face: u32) -> Vec<Child> {
    let (vertices, edges) = (topology.face(face), topology.face_edges(face));
    let half = |edge: usize, vertex: usize| Side::Half(edges[edge % 3], vertices[vertex % 3]);
    let inner = |opposite: usize| Side::Inner(face, opposite as u32 % 3);
    let middle = |edge: usize| Origin::Edge(edges[edge % 3]);
    let corner = |c: usize| {
        let mut child = Child {
            parent: face,
            vertices: SmallVec::from_slice(&[
                Origin::Vertex(vertices[c]),
                middle(c),
                middle(c + 2),
            ]),
            sides: SmallVec::from_slice(&[half(c, c), inner(c), half(c + 2, c)]),
        };
        child.vertices.rotate_right(c);
        child.sides.rotate_right(c);
        child
    };
    let mut children: Vec<Child> = (0..3).map(corner).collect();
    children.push(Child {
        parent: face,
        vertices: SmallVec::from_slice(&[middle(1), middle(2), middle(0)]),
        sides: SmallVec::from_slice(&[inner(2), inner(0), inner(1)]),
    });
    children
}

/// A quad at each corner. Those of a quad turn so that the corner keeps its number.
fn quads(topology: &Topology, face: u32) -> Vec<Child> {
    let (vertices, edges) = (topology.face(face), topology.face_edges(face));
    let n = vertices.len();
    let corner = |c: usize| {
        let before = (c + n - 1) % n;
        let mut child = Child {
            parent: face,
            vertices: SmallVec::from_slice(&[
                Origin::Vertex(vertices[c]),
                Origin::Edge(edges[c]),
                Origin::Face(face),
                Origin::Edge(edges[before]),
            ]),
            sides: SmallVec::from_slice(&[
                Side::Half(edges[c], vertices[c]),
                Side::Inner(face, c as u32),
                Side::Inner(face, before as u32),
                Side::Half(edges[before], vertices[c]),
            ]),
        };
        if n == 4 {
            child.vertices.rotate_right(c);
            child.sides.rotate_right(c);
        }
        child
    };
    (0..n).map(corner).collect()
}

/// The vertices of the next level, numbered as they are met.
struct Numbers {
    /// By origin: of the parent's faces, then its edges, then its vertices.
    numbers: Vec<u32>,
    origins: Vec<Origin>,
    faces: usize,
    edges: usize,
}

/// The number of an origin that has none yet.
const UNKNOWN: u32 = u32::MAX;

impl Numbers {
    fn new(parent: &Topology) -> Numbers {
        let (faces, edges) = (parent.face_count(), parent.edge_count());
        Numbers {
            numbers: vec![UNKNOWN; faces + edges + parent.vertex_count()],
            origins: Vec::new(),
            faces,
            edges,
        }
    }

    fn place(&self, origin: Origin) -> usize {
        match origin {
            Origin::Face(face) => face as usize,
            Origin::Edge(edge) => self.faces + edge as usize,
            Origin::Vertex(vertex) => self.faces + self.edges + vertex as usize,
        }
    }

    fn number(&mut self, origin: Origin) -> u32 {
        let place = self.place(origin);
        if self.numbers[place] == UNKNOWN {
            self.numbers[place] = self.origins.len() as u32;
            self.origins.push(origin);
        }
        self.numbers[place]
    }

    /// Numbers the vertices of a child.
    fn meet(&mut self, child: &Child) {
        for &origin in &child.vertices {
            self.number(origin);
        }
    }

    /// Whether a child has a vertex with a number.
    fn touches(&self, child: &Child) -> bool {
        let mut origins = child.vertices.iter();
        origins.any(|&origin| self.numbers[self.place(origin)] != UNKNOWN)
    }

    /// Connects the children, all of whose vertices have numbers.
    fn finish(
        self,
        parent: &Topology,
        scheme: Scheme,
        children: &[Child],
        cells: u32,
    ) -> Refinement {
        let faces: Vec<SmallVec<[u32; 4]>> = children
            .iter()
            .map(|child| {
                child
                    .vertices
                    .iter()
                    .map(|&o| self.numbers[self.place(o)])
                    .collect()
            })
            .collect();
        let (keys, sources) = keys(parent, children);
        let sharpness = self.origins.iter().map(|&origin| match origin {
            Origin::Vertex(vertex) => decayed(parent.vertex_sharpness(vertex)),
            _ => 0.0,
        });
        let topology = Topology::connect_keyed(
            faces.iter().map(|face| &face[..]),
            &keys,
            sharpness.collect(),
            parent.options(),
            |key, a, _| match sources[key as usize] {
                Side::Inner(..) => (0.0, [0.0; 2]),
                Side::Half(edge, vertex) => {
                    let (sharpness, [near, far]) = half(parent, edge, vertex);
                    let begins = matches!(self.origins[a as usize], Origin::Vertex(_));
                    (sharpness, if begins { [near, far] } else { [far, near] })
                }
            },
        );
        let holes = children.iter().map(|child| parent.is_hole(child.parent));
        let rules = rules(scheme);
        let mask = |&origin: &Origin| -> Mask { point(&rules, parent, origin) };
        Refinement {
            topology: topology.with_holes(holes.collect()),
            masks: self.origins.iter().map(mask).collect(),
            cells,
        }
    }
}

/// A key for each side of each child, equal for sides that are one edge, and what each key stands for.
fn keys(parent: &Topology, children: &[Child]) -> (Vec<u32>, Vec<Side>) {
    let mut known = FxHashMap::default();
    let mut sources = Vec::new();
    let sides = children.iter().flat_map(|child| &child.sides);
    let keys = sides.map(|&side| {
        let source = match side {
            Side::Half(edge, vertex) => (edge, vertex),
            Side::Inner(face, number) => (parent.edge_count() as u32 + face, number),
        };
        *known.entry(source).or_insert_with(|| {
            sources.push(side);
            sources.len() as u32 - 1
        })
    });
    (keys.collect(), sources)
}
