//! Who touches whom: faces, edges and vertices with their sharpness, for a whole mesh or the surroundings of a few faces.
//!
//! Nothing here assumes a manifold: an edge may have any number of faces, and faces may disagree in orientation. What such places
//! mean for the limit is settled once, in [`Topology::new`], the way OpenSubdiv settles it: boundary and non-manifold edges
//! become infinitely sharp, and so do non-manifold vertices other than those on a plain non-manifold crease.

mod connect;
mod hubs;
mod manifold;
mod rejoin;
mod retag;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use smallvec::SmallVec;

use crate::mesh::control_mesh::creased_edges;
use crate::mesh::faces::Faces;
use crate::mesh::sharpness::{decayed_around_vertex, is_infinite, is_sharp};
use crate::mesh::{BoundaryInterpolation, ControlMesh, INFINITE_SHARPNESS, Scheme, SchemeOptions};

use connect::Lists;
pub(crate) use hubs::{Hub, Hubs};
pub(crate) use rejoin::{GONE, Rejoined};
pub(crate) use retag::Retagged;

/// An edge and how sharp it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Its ends.
    pub vertices: [u32; 2],
    /// Sharpness at this level.
    pub sharpness: f32,
}

impl Edge {
    /// The end that is not `vertex`.
    pub fn other(&self, vertex: u32) -> u32 {
        self.vertices[0] ^ self.vertices[1] ^ vertex
    }
}

/// A corner of a face: the face, and the number of the corner in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaceCorner {
    /// The face.
    pub face: u32,
    /// The corner, counted from the face's first vertex.
    pub corner: u32,
}

/// Faces, edges, vertices, how they touch, and their sharpness.
///
/// What is asked of a number that no face, edge or vertex has is answered as of one that touches nothing: by an empty list, no sharpness, no hole.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    faces: Arc<Faces>,
    face_edges: Vec<u32>,
    edges: Vec<Edge>,
    /// Sharpness, at the next level, of each edge's half at either end, which differ only under Chaikin's rule; empty where all are smooth.
    next: Vec<[f32; 2]>,
    edge_faces: Lists<u32>,
    vertex_faces: Lists<FaceCorner>,
    vertex_edges: Lists<u32>,
    vertex_sharpness: Vec<f32>,
    holes: Vec<bool>,
    hubs: Hubs,
    options: SchemeOptions,
}

impl Topology {
    /// The topology of a whole control mesh, with boundary rules and non-manifold places turned into sharpness.
    pub fn new(mesh: &ControlMesh) -> Topology {
        Topology::under(mesh, mesh.options().scheme)
    }

    /// The same under a scheme that may not be the mesh's own.
    pub(crate) fn under(mesh: &ControlMesh, scheme: Scheme) -> Topology {
        let options = SchemeOptions {
            scheme,
            ..mesh.options()
        };
        let creased = creased_edges(mesh);
        let mut vertex_sharpness = vec![0.0; mesh.vertex_count()];
        for corner in mesh.corners() {
            vertex_sharpness[corner.vertex as usize] = clamp(corner.sharpness);
        }
        let mut topology = Topology::of_faces(
            mesh.shared_faces().clone(),
            vertex_sharpness,
            options,
            |a, b| {
                let crease = creased.crease([a, b]);
                let sharpness = crease.map_or(0.0, |crease| mesh.creases()[crease].sharpness);
                (clamp(sharpness), [0.0; 2])
            },
        );
        for &hole in mesh.holes() {
            topology.holes[hole as usize] = true;
        }
        for &removed in topology.faces.removed().keys() {
            topology.holes[removed as usize] = true;
        }
        let open = topology.has_open_boundaries();
        if open {
            topology.open_boundary_faces();
        }
        topology.sharpen_non_manifold();
        // What holes leave of boundaries is not sharpened in OpenSubdiv: Chaikin's rule takes in what tags say of them.
        if !open {
            topology.sharpen_boundaries();
        }
        topology.foresee();
        topology.sharpen_boundaries();
        topology
    }

    /// Whether faces at a boundary have no limit. A scheme without rules for neighbours has one everywhere (OpenSubdiv's
    /// `GetLocalNeighborhoodSize`).
    fn has_open_boundaries(&self) -> bool {
        self.options.boundary == BoundaryInterpolation::None
            && self.options.scheme != Scheme::Bilinear
    }

    /// Boundary edges are infinitely sharp, now and for ever.
    fn sharpen_boundaries(&mut self) {
        for number in 0..self.edges.len() {
            if self.edge_faces.get(number as u32).len() < 2 {
                self.edges[number].sharpness = INFINITE_SHARPNESS;
                self.set_next(number as u32, [INFINITE_SHARPNESS; 2]);
            }
        }
    }

    /// Without boundary interpolation, faces that touch a boundary which no tag makes infinitely sharp have no limit: they are holes.
    fn open_boundary_faces(&mut self) {
        for edge in 0..self.edges.len() as u32 {
            if self.edge_faces.get(edge).len() >= 2
                || is_infinite(self.edges[edge as usize].sharpness)
            {
                continue;
            }
            for vertex in self.edges[edge as usize].vertices {
                for corner in self.vertex_faces.get(vertex) {
                    self.holes[corner.face as usize] = true;
                }
            }
        }
    }

    /// Computes each edge's sharpness at the next level.
    fn foresee(&mut self) {
        let mut at_sharp = vec![false; self.vertex_count()];
        for edge in self.edges.iter().filter(|edge| is_sharp(edge.sharpness)) {
            for vertex in edge.vertices {
                at_sharp[vertex as usize] = true;
            }
        }
        let all = 0..self.vertex_count() as u32;
        for vertex in all.filter(|&vertex| at_sharp[vertex as usize]) {
            let around = self.vertex_edges.get(vertex);
            let sharpness = around
                .iter()
                .map(|&edge| self.edges[edge as usize].sharpness);
            let sharpness: SmallVec<[f32; 8]> = sharpness.collect();
            let next = decayed_around_vertex(self.options.creasing, &sharpness);
            self.next.resize(self.edges.len(), [0.0; 2]);
            for (&edge, next) in around.iter().zip(next) {
                let end = self.edges[edge as usize].vertices[1] == vertex;
                self.next[edge as usize][usize::from(end)] = next;
            }
        }
    }

    /// The number of faces.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertex_sharpness.len()
    }

    /// The number of edges.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// The vertices of a face.
    pub fn face(&self, face: u32) -> &[u32] {
        self.faces.get(face as usize)
    }

    /// The faces, for those who keep them.
    pub(crate) fn shared_faces(&self) -> &Arc<Faces> {
        &self.faces
    }

    /// The number, among the sides of all faces, of that which begins at a corner of a face.
    pub(crate) fn side(&self, face: u32, corner: u32) -> u32 {
        self.faces.range(face as usize).start as u32 + corner
    }

    /// The vertices of all faces one after another, if all are quads.
    pub(crate) fn quads(&self) -> Option<&[u32]> {
        self.faces.quads()
    }

    /// The edges of a face; edge i joins its vertices i and i + 1.
    pub fn face_edges(&self, face: u32) -> &[u32] {
        &self.face_edges[self.faces.range(face as usize)]
    }

    /// The edges by number.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// An edge by number, which must be one.
    pub(crate) fn edge(&self, edge: u32) -> &Edge {
        &self.edges[edge as usize]
    }

    /// Sharpness, at the next level, of the half of an edge at each of its ends. The two differ only under Chaikin's rule.
    pub fn next_sharpness(&self, edge: u32) -> [f32; 2] {
        self.next.get(edge as usize).copied().unwrap_or_default()
    }

    /// Sharpness, at the next level, of the half of an edge that ends in `vertex`.
    pub(crate) fn next_at(&self, edge: u32, vertex: u32) -> f32 {
        let end = self.edge(edge).vertices[1] == vertex;
        self.next_sharpness(edge)[usize::from(end)]
    }

    fn set_next(&mut self, edge: u32, next: [f32; 2]) {
        if next != self.next_sharpness(edge) {
            self.next.resize(self.edges.len(), [0.0; 2]);
            self.next[edge as usize] = next;
        }
    }

    /// The faces on an edge.
    pub fn edge_faces(&self, edge: u32) -> &[u32] {
        self.edge_faces.get(edge)
    }

    /// The face corners at a vertex.
    pub fn vertex_faces(&self, vertex: u32) -> &[FaceCorner] {
        self.vertex_faces.get(vertex)
    }

    /// The edges at a vertex.
    pub fn vertex_edges(&self, vertex: u32) -> &[u32] {
        self.vertex_edges.get(vertex)
    }

    /// The sharpness of a vertex.
    pub fn vertex_sharpness(&self, vertex: u32) -> f32 {
        let sharpness = self.vertex_sharpness.get(vertex as usize);
        sharpness.copied().unwrap_or_default()
    }

    /// Whether a face is a hole: it shapes its neighbours but is not drawn.
    pub fn is_hole(&self, face: u32) -> bool {
        self.holes.get(face as usize) == Some(&true)
    }

    /// Whether any face is no hole.
    pub fn has_surface(&self) -> bool {
        self.holes.contains(&false)
    }

    /// The scheme's options.
    pub fn options(&self) -> SchemeOptions {
        self.options
    }

    /// The two edges of `face` that meet in `vertex`.
    fn edges_at(&self, face: u32, vertex: u32) -> [u32; 2] {
        let corner = self.corner_of(face, vertex) as usize;
        let edges = self.face_edges(face);
        // Without a division: walks ask this at every step.
        let before = if corner == 0 { edges.len() } else { corner } - 1;
        [edges[corner], edges[before]]
    }

    /// The corner at which `face`, which must have it, has `vertex`.
    pub(crate) fn corner_of(&self, face: u32, vertex: u32) -> u32 {
        let (vertices, around) = (self.face(face), self.vertex_faces.get(vertex));
        // Whichever list is shorter: corners of an n-gon have few faces, faces around a pole few corners.
        let found = if vertices.len() <= around.len() {
            let corner = vertices.iter().position(|&v| v == vertex);
            corner.map(|corner| corner as u32)
        } else {
            let corner = around.iter().find(|corner| corner.face == face);
            corner.map(|corner| corner.corner)
        };
        found.expect("the face has this vertex")
    }

    /// Steps around `vertex` from `face` across `edge`: the face on the other side and its other edge at the vertex.
    /// None where the edge has not exactly two faces.
    fn step(&self, vertex: u32, face: u32, edge: u32) -> Option<(u32, u32)> {
        let &[first, second] = self.edge_faces.get(edge) else {
            return None;
        };
        let beyond = if first == face { second } else { first };
        let [a, b] = self.edges_at(beyond, vertex);
        Some((beyond, if a == edge { b } else { a }))
    }

    /// The sector around a corner that infinitely sharp edges and boundaries leave, see [`Fan`]; None where there is no such corner.
    pub fn fan_at(&self, FaceCorner { face, corner }: FaceCorner) -> Option<Fan> {
        let is_corner = (corner as usize) < self.face(face).len();
        is_corner.then(|| self.fan(face, corner))
    }

    /// The sector around corner `corner` of `face`, which must be one; see [`Topology::fan_at`].
    pub(crate) fn fan(&self, face: u32, corner: u32) -> Fan {
        let fan = self.fan_within(face, corner, usize::MAX);
        fan.expect("no fan has so many faces")
    }

    /// The same if it has at most so many faces, which is found out without walking through more.
    pub(crate) fn fan_within(&self, face: u32, corner: u32, greatest: usize) -> Option<Fan> {
        let arity = self.face(face).len();
        let vertex = self.face(face)[corner as usize];
        let first = self.face_edges(face)[corner as usize];
        let last = self.face_edges(face)[(corner as usize + arity - 1) % arity];
        let mut fan = Fan {
            vertex,
            edges: SmallVec::from_slice(&[first, last]),
            faces: SmallVec::from_slice(&[face]),
            at: 0,
            closed: false,
        };
        while let Some((next, edge)) = self.crossing(
            &fan,
            *fan.faces.last().expect("never empty"),
            fan.edges[fan.edges.len() - 1],
        ) {
            if next == face {
                fan.closed = true;
                fan.edges.pop();
                return Some(fan);
            }
            fan.faces.push(next);
            fan.edges.push(edge);
            if fan.faces.len() > greatest {
                return None;
            }
        }
        let mut before: SmallVec<[(u32, u32); 8]> = SmallVec::new();
        let (mut here, mut across) = (face, first);
        while let Some((next, edge)) = self.crossing(&fan, here, across) {
            before.push((next, edge));
            (here, across) = (next, edge);
            if fan.faces.len() + before.len() > greatest {
                return None;
            }
        }
        fan.at = before.len();
        before.reverse();
        fan.faces
            .insert_many(0, before.iter().map(|&(face, _)| face));
        fan.edges
            .insert_many(0, before.iter().map(|&(_, edge)| edge));
        Some(fan)
    }

    fn crossing(&self, fan: &Fan, face: u32, edge: u32) -> Option<(u32, u32)> {
        if is_infinite(self.edges[edge as usize].sharpness) {
            None
        } else {
            self.step(fan.vertex, face, edge)
        }
    }

    /// Writes down all that tells it from other topologies under the same scheme and boundary rule.
    pub(crate) fn write_down(&self, words: &mut Vec<u32>) {
        let options = self.options;
        words.extend([options.creasing as u32, options.triangles as u32]);
        words.extend([self.face_count() as u32, self.vertex_count() as u32]);
        if self.quads().is_none() {
            words.extend(self.faces.iter().map(|face| face.len() as u32));
        }
        words.extend_from_slice(self.faces.vertices());
        for hubs in self.hubs.lists() {
            words.push(hubs.len() as u32);
            words.extend(hubs.iter().flat_map(|hub| [hub.at, hub.first, hub.count]));
        }
        let sharp = |(number, sharpness): (u32, &f32)| [number, sharpness.to_bits()];
        let vertices = (0..).zip(&self.vertex_sharpness);
        let vertices = vertices.filter(|vertex| is_sharp(*vertex.1));
        words.extend(vertices.flat_map(sharp));
        for (number, edge) in (0..).zip(&self.edges) {
            let next = self.next_sharpness(number);
            if is_sharp(edge.sharpness) || next != [0.0; 2] {
                let [near, far] = next.map(f32::to_bits);
                words.extend([u32::MAX, number, edge.sharpness.to_bits(), near, far]);
            }
        }
    }

    /// How many sharp edges meet in `vertex`.
    pub fn sharp_edges(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        self.vertex_edges
            .get(vertex)
            .iter()
            .copied()
            .filter(|&edge| is_sharp(self.edges[edge as usize].sharpness))
    }

    /// Every face around `vertex` and the edge across which it was reached, beginning behind `edge` of `face` and going on until
    /// the walk returns or a boundary or non-manifold edge ends it. Unlike [`Topology::fan`] it crosses sharp edges.
    pub(crate) fn walk(
        &self,
        vertex: u32,
        face: u32,
        edge: u32,
    ) -> impl Iterator<Item = (u32, u32)> + '_ {
        let mut state = (face, edge);
        std::iter::from_fn(move || {
            let across = state.1;
            let (next, edge) = self.step(vertex, state.0, across)?;
            if next == face {
                return None;
            }
            state = (next, edge);
            Some((next, across))
        })
    }
}

/// The faces around a vertex from one infinitely sharp (or boundary) edge to the next, or all the way round.
///
/// They are in counter-clockwise order as seen from the side that the asking face turns to: face j lies between edges j and j + 1.
/// A closed fan has as many edges as faces, an open one has one edge more.
#[derive(Clone, Debug)]
pub struct Fan {
    /// The vertex in the middle.
    pub vertex: u32,
    /// The edges in order.
    pub edges: SmallVec<[u32; 8]>,
    /// The faces in order.
    pub faces: SmallVec<[u32; 8]>,
    /// The number, among `faces`, of the face that asked.
    pub at: usize,
    /// Whether it goes all the way round.
    pub closed: bool,
}

/// Sharpness beyond infinity says nothing more; one value for it keeps equal configurations equal.
fn clamp(sharpness: f32) -> f32 {
    sharpness.min(INFINITE_SHARPNESS)
}
