//! From faces to who touches whom.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::mesh::SchemeOptions;
use crate::mesh::faces::Faces;
use crate::mesh::topology::{Edge, FaceCorner, Topology};

/// Lists of different lengths, one after another.
#[derive(Clone, Debug, Default)]
pub struct Lists<T> {
    offsets: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Lists<T> {
    /// Room for `total` items in lists that are as long as the numbers of those to come tell, which must be below `count`.
    fn with_room(count: usize, total: usize, lists: impl Iterator<Item = u32>) -> Lists<T> {
        // Two places ahead of its list, an offset first counts, then sums up, and moves to its own place as the list fills.
        let mut offsets = vec![0u32; count + 2];
        lists.for_each(|list| offsets[list as usize + 2] += 1);
        let mut sum = 0;
        for offset in &mut offsets {
            sum += *offset;
            *offset = sum;
        }
        Lists {
            offsets,
            items: vec![T::default(); total],
        }
    }

    /// Appends to a list, which has room for it.
    fn push(&mut self, list: u32, item: T) {
        let next = &mut self.offsets[list as usize + 1];
        self.items[*next as usize] = item;
        *next += 1;
    }

    /// The list with number `number`; empty where there is none.
    pub fn get(&self, number: u32) -> &[T] {
        match self.offsets.get(number as usize..) {
            Some(&[start, end, ..]) => &self.items[start as usize..end as usize],
            _ => &[],
        }
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
        let faces = Faces::collect(faces).into();
        Topology::of_faces(faces, vertex_sharpness, options, edge)
    }

    /// The same of faces that are shared.
    pub(super) fn of_faces(
        faces: Arc<Faces>,
        vertex_sharpness: Vec<f32>,
        options: SchemeOptions,
        edge: impl Fn(u32, u32) -> (f32, [f32; 2]),
    ) -> Topology {
        let mut topology = Topology::apart(faces, vertex_sharpness, options);
        let first = topology.first_alike();
        topology.join(&first, |_, a, b| edge(a, b));
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
        let faces = Faces::collect(faces).into();
        let mut topology = Topology::apart(faces, vertex_sharpness, options);
        let mut first_of = FxHashMap::default();
        let first: Vec<u32> = (0..)
            .zip(keys)
            .map(|(side, &key)| *first_of.entry(key).or_insert(side))
            .collect();
        topology.join(&first, |side, a, b| edge(keys[side], a, b));
        topology
    }

    /// Faces that know their vertices, and vertices that know their faces.
    pub(super) fn apart(
        faces: Arc<Faces>,
        vertex_sharpness: Vec<f32>,
        options: SchemeOptions,
    ) -> Topology {
        let mut topology = Topology {
            holes: vec![false; faces.len()],
            faces,
            vertex_sharpness,
            options,
            ..Default::default()
        };
        let corners = topology.faces.vertices().len();
        let at_vertices = topology.faces.vertices().iter().copied();
        let mut vertex_faces = Lists::with_room(topology.vertex_count(), corners, at_vertices);
        for face in 0..topology.face_count() as u32 {
            for (corner, &vertex) in (0..).zip(topology.face(face)) {
                vertex_faces.push(vertex, FaceCorner { face, corner });
            }
        }
        topology.vertex_faces = vertex_faces;
        topology
    }

    /// The same with other holes.
    pub(crate) fn with_holes(mut self, holes: Vec<bool>) -> Topology {
        assert_eq!(holes.len(), self.face_count(), "one entry a face");
        self.holes = holes;
        self
    }

    /// For each side of a face, the first side that joins the same two vertices; linear in their number, however many meet in a vertex.
    fn first_alike(&self) -> Vec<u32> {
        let mut first: Vec<u32> = (0..self.faces.vertices().len() as u32).collect();
        let mut many = Vec::new();
        for vertex in 0..self.vertex_count() as u32 {
            let corners = self.vertex_faces.get(vertex);
            if corners.len() > FEW {
                many.resize(self.vertex_count(), (u32::MAX, 0));
                self.each_side_up(vertex, |side, other| {
                    // What another vertex left is stale.
                    let (of, known) = &mut many[other as usize];
                    if *of == vertex {
                        first[side as usize] = *known;
                    } else {
                        (*of, *known) = (vertex, side);
                    }
                });
                continue;
            }
            let (mut others, mut sides, mut met) = ([0; 2 * FEW], [0; 2 * FEW], 0);
            self.each_side_up(vertex, |side, other| {
                match others[..met].iter().position(|&known| known == other) {
                    Some(place) => first[side as usize] = sides[place],
                    None => {
                        (others[met], sides[met]) = (other, side);
                        met += 1;
                    }
                }
            });
        }
        first
    }

    /// Visits the sides at a vertex whose other end has a greater number, with that end; the earlier side first.
    fn each_side_up(&self, vertex: u32, mut visit: impl FnMut(u32, u32)) {
        for &FaceCorner { face, corner } in self.vertex_faces.get(vertex) {
            let range = self.faces.range(face as usize);
            let (start, vertices) = (range.start as u32, &self.faces.vertices()[range]);
            let last = vertices.len() as u32 - 1;
            let before = if corner == 0 { last } else { corner - 1 };
            let after = if corner == last { 0 } else { corner + 1 };
            let mut sides = [(before, before), (corner, after)];
            if corner == 0 {
                sides.swap(0, 1);
            }
            for (side, end) in sides {
                let other = vertices[end as usize];
                if other > vertex {
                    visit(start + side, other);
                }
            }
        }
    }

    /// Numbers the edges in the order in which the faces first show them; `first` tells for each side the first of its edge. Then fills the lists that
    /// answer "which faces and edges touch".
    pub(super) fn join(
        &mut self,
        first: &[u32],
        edge: impl Fn(usize, u32, u32) -> (f32, [f32; 2]),
    ) {
        let is_first = |&(side, &first): &(usize, &u32)| side == first as usize;
        let count = first.iter().enumerate().filter(is_first).count();
        let mut edges: Vec<Edge> = Vec::with_capacity(count);
        let mut nexts: Vec<[f32; 2]> = Vec::new();
        let mut face_edges: Vec<u32> = Vec::with_capacity(first.len());
        for face in 0..self.face_count() as u32 {
            let vertices = self.face(face);
            for (corner, &from) in vertices.iter().enumerate() {
                let side = face_edges.len();
                let known = first[side] as usize;
                if known < side {
                    face_edges.push(face_edges[known]);
                    continue;
                }
                let to = *vertices.get(corner + 1).unwrap_or(&vertices[0]);
                let (sharpness, next) = edge(side, from, to);
                face_edges.push(edges.len() as u32);
                if next != [0.0; 2] {
                    nexts.resize(count, [0.0; 2]);
                    nexts[edges.len()] = next;
                }
                edges.push(Edge {
                    vertices: [from, to],
                    sharpness,
                });
            }
        }
        let at_edges = face_edges.iter().copied();
        let mut edge_faces = Lists::with_room(count, face_edges.len(), at_edges);
        for face in 0..self.face_count() as u32 {
            for &edge in &face_edges[self.faces.range(face as usize)] {
                edge_faces.push(edge, face);
            }
        }
        let ends = edges.iter().flat_map(|edge| edge.vertices);
        let mut vertex_edges = Lists::with_room(self.vertex_count(), 2 * count, ends);
        for (number, edge) in (0..).zip(&edges) {
            vertex_edges.push(edge.vertices[0], number);
            vertex_edges.push(edge.vertices[1], number);
        }
        self.edges = edges;
        self.next = nexts;
        self.face_edges = face_edges;
        self.edge_faces = edge_faces;
        self.vertex_edges = vertex_edges;
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
                let next = [a, b].map(|local| self.next_at(edge, vertices[local as usize]));
                (self.edge(edge).sharpness, next)
            },
        );
        (topology, vertices)
    }
}

/// The corners at a vertex are few up to so many: what they show is searched one by one.
const FEW: usize = 12;
