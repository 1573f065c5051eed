//! From faces to who touches whom.

use rustc_hash::FxHashMap;

use crate::mesh::SchemeOptions;
use crate::mesh::topology::{Edge, FaceCorner, Topology};

/// Lists of different lengths, one after another.
#[derive(Clone, Debug, Default)]
pub struct Lists<T> {
    offsets: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Lists<T> {
    /// Sorts `(list, item)` pairs into `count` lists, keeping the order within each.
    fn gather(count: usize, pairs: impl Iterator<Item = (u32, T)> + Clone) -> Lists<T> {
        // Two places ahead of its list, an offset first counts, then sums up, and moves to its own place as the list fills.
        let mut offsets = vec![0u32; count + 2];
        let mut total = 0;
        for (list, _) in pairs.clone() {
            offsets[list as usize + 2] += 1;
            total += 1;
        }
        for i in 2..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let mut items = vec![T::default(); total];
        for (list, item) in pairs {
            let next = &mut offsets[list as usize + 1];
            items[*next as usize] = item;
            *next += 1;
        }
        Lists { offsets, items }
    }

    /// The list with number `number`; empty where there is none.
    pub fn get(&self, number: u32) -> &[T] {
        list(&self.offsets, &self.items, number)
    }
}

/// One of the lists that stand one after another in `items`, each from its offset to the next; empty where there is none of that number.
pub(super) fn list<'a, T>(offsets: &[u32], items: &'a [T], number: u32) -> &'a [T] {
    match offsets.get(number as usize..) {
        Some(&[start, end, ..]) => &items[start as usize..end as usize],
        _ => &[],
    }
}

impl Topology {
    /// Connects faces whose sharpness is known: `edge(a, b)` tells that of an edge now and, at the ends `a` and `b`, next.
    pub(crate) fn connect<'a>(
        faces: impl Iterator<Item = &'a [u32]> + Clone,
        vertex_sharpness: Vec<f32>,
        options: SchemeOptions,
        edge: impl Fn(u32, u32) -> (f32, [f32; 2]),
    ) -> Topology {
        let mut topology = Topology::of_faces(faces, vertex_sharpness, options);
        let sides = topology.sides();
        let first = first_alike(topology.vertex_count(), &sides);
        topology.join(&sides, &first, |_, a, b| edge(a, b));
        topology.relate();
        topology
    }

    /// As [`Topology::connect`], but sides are one edge when their keys are equal: two edges may join the same two vertices, as those do that
    /// cut off an interior vertex of two triangles. The keys stand in the order of the faces' sides; `edge` is told them.
    pub(crate) fn connect_keyed<'a>(
        faces: impl Iterator<Item = &'a [u32]> + Clone,
        keys: &[u32],
        vertex_sharpness: Vec<f32>,
        options: SchemeOptions,
        edge: impl Fn(u32, u32, u32) -> (f32, [f32; 2]),
    ) -> Topology {
        let mut topology = Topology::of_faces(faces, vertex_sharpness, options);
        let sides = topology.sides();
        let mut first_of = FxHashMap::default();
        let first: Vec<u32> = (0..)
            .zip(keys)
            .map(|(side, &key)| *first_of.entry(key).or_insert(side))
            .collect();
        topology.join(&sides, &first, |side, a, b| edge(keys[side], a, b));
        topology.relate();
        topology
    }

    /// Faces that do not know each other yet.
    fn of_faces<'a>(
        faces: impl Iterator<Item = &'a [u32]> + Clone,
        vertex_sharpness: Vec<f32>,
        options: SchemeOptions,
    ) -> Topology {
        let corners = faces.clone().map(<[u32]>::len).sum();
        let mut topology = Topology {
            face_offsets: Vec::with_capacity(faces.size_hint().0 + 1),
            face_vertices: Vec::with_capacity(corners),
            vertex_sharpness,
            options,
            ..Default::default()
        };
        topology.face_offsets.push(0);
        for face in faces {
            topology.face_vertices.extend_from_slice(face);
            topology
                .face_offsets
                .push(topology.face_vertices.len() as u32);
        }
        topology.holes = vec![false; topology.face_count()];
        topology
    }

    /// The same with other holes.
    pub(crate) fn with_holes(mut self, holes: Vec<bool>) -> Topology {
        assert_eq!(holes.len(), self.face_count(), "one entry a face");
        self.holes = holes;
        self
    }

    /// The two ends of every side of every face.
    fn sides(&self) -> Vec<[u32; 2]> {
        let mut sides = Vec::with_capacity(self.face_vertices.len());
        for face in 0..self.face_count() as u32 {
            let vertices = self.face(face);
            let ends = vertices[1..].iter().chain(&vertices[..1]);
            sides.extend(vertices.iter().zip(ends).map(|(&a, &b)| [a, b]));
        }
        sides
    }

    /// Numbers the edges in the order in which the faces first show them; `first` tells for each side the first of its edge.
    fn join(
        &mut self,
        sides: &[[u32; 2]],
        first: &[u32],
        edge: impl Fn(usize, u32, u32) -> (f32, [f32; 2]),
    ) {
        self.face_edges = Vec::with_capacity(sides.len());
        let is_first = |&(side, &first): &(usize, &u32)| side == first as usize;
        let edges = first.iter().enumerate().filter(is_first).count();
        self.edges = Vec::with_capacity(edges);
        for (side, &first) in first.iter().enumerate() {
            let number = if first as usize == side {
                let vertices = sides[side];
                let (sharpness, next) = edge(side, vertices[0], vertices[1]);
                self.edges.push(Edge {
                    vertices,
                    sharpness,
                    next,
                });
                self.edges.len() as u32 - 1
            } else {
                self.face_edges[first as usize]
            };
            self.face_edges.push(number);
        }
    }

    /// The given faces as a topology of their own, with the numbers that its vertices have here.
    pub(crate) fn excerpt(&self, faces: &[u32]) -> (Topology, Vec<u32>) {
        let mut numbers = FxHashMap::default();
        let mut vertices = Vec::new();
        let mut number = |vertex: u32| {
            *numbers.entry(vertex).or_insert_with(|| {
                vertices.push(vertex);
                vertices.len() as u32 - 1
            })
        };
        let local: Vec<Vec<u32>> = faces
            .iter()
            .map(|&face| self.face(face).iter().map(|&v| number(v)).collect())
            .collect();
        let sharpness = vertices
            .iter()
            .map(|&vertex| self.vertex_sharpness(vertex))
            .collect();
        let keys: Vec<u32> = faces
            .iter()
            .flat_map(|&face| self.face_edges(face))
            .copied()
            .collect();
        let topology = Topology::connect_keyed(
            local.iter().map(|face| &face[..]),
            &keys,
            sharpness,
            self.options,
            |edge, a, b| {
                let edge = self.edge(edge);
                let next = [a, b].map(|local| edge.next_at(vertices[local as usize]));
                (edge.sharpness, next)
            },
        );
        (topology, vertices)
    }

    /// Fills the lists that answer "which faces and edges touch".
    fn relate(&mut self) {
        let mut corners = Vec::with_capacity(self.face_vertices.len());
        for face in 0..self.face_count() as u32 {
            let arity = self.face(face).len() as u32;
            corners.extend((0..arity).map(|corner| FaceCorner { face, corner }));
        }
        let at_edges = self.face_edges.iter().copied();
        let faces = corners.iter().map(|corner| corner.face);
        let at_vertices = self.face_vertices.iter().copied();
        let ends = self.edges.iter().flat_map(|edge| edge.vertices);
        let edges = (0..2 * self.edges.len() as u32).map(|end| end / 2);
        let vertices = self.vertex_count();
        self.edge_faces = Lists::gather(self.edges.len(), at_edges.zip(faces));
        self.vertex_faces = Lists::gather(vertices, at_vertices.zip(corners.iter().copied()));
        self.vertex_edges = Lists::gather(vertices, ends.zip(edges));
    }
}

/// For each side of a face, the first side that joins the same two vertices; linear in their number, however many meet in a vertex.
fn first_alike(vertex_count: usize, sides: &[[u32; 2]]) -> Vec<u32> {
    let low = |side: usize| sides[side][0].min(sides[side][1]);
    let by_low = Lists::gather(
        vertex_count,
        (0..sides.len()).map(|side| (low(side), side as u32)),
    );
    let mut first: Vec<u32> = (0..sides.len() as u32).collect();
    // By its higher end, the latest side of its own kind; one from another lower end is stale.
    let mut latest = vec![None; vertex_count];
    for vertex in 0..vertex_count as u32 {
        for &side in by_low.get(vertex) {
            let [a, b] = sides[side as usize];
            match latest[a.max(b) as usize] {
                Some((known, low)) if low == vertex => first[side as usize] = known,
                _ => latest[a.max(b) as usize] = Some((side, vertex)),
            }
        }
    }
    first
}
