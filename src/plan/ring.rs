//! The surroundings of a face, edge or vertex, in the order that gives the least [`Configuration`].
//!
//! Around hubs ([`Hubs`](crate::mesh::topology::Hubs)) the surroundings are what is near: what a hub becomes is given, and a vertex beside one needs, level by
//! level, what is one face farther on, and no more.

use std::cmp::Ordering;

use smallvec::SmallVec;

use crate::mesh::INFINITE_SHARPNESS;
use crate::mesh::places::Places;
use crate::mesh::sharpness::is_sharp;
use crate::mesh::topology::{FaceCorner, Topology};
use crate::mesh::{CreaseMethod, SchemeOptions, TriangleSubdivision};
use crate::plan::around::{BESIDE, EDGE_REACH, FACE_REACH, Listed, Start, few, surrounding_faces};
use crate::plan::configuration::{Configuration, GIVEN, HUB_FACE, HUB_VERTEX};

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
            Ring::least(starts.map(|start| Ring::around(topology, start, 4, FACE_REACH)))
        })
    }

    /// The ring of a quad around which all is smooth and quads, and no vertex met twice: its corners' valences tell all, and those of `start` are the least.
    /// None of others.
    fn smooth(topology: &Topology, face: u32, start: Start) -> Option<Ring> {
        let corners = topology.face(face);
        let is_simple = |&vertex: &u32| !topology.is_crowded(vertex) && is_smooth(topology, vertex);
        if !corners.iter().all(is_simple) {
            return None;
        }
        let valences = corners.iter().map(|&v| topology.vertex_faces(v).len());
        let valences: usize = valences.sum();
        let ring = Ring::around(topology, start, 4, FACE_REACH);
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
        Ring::least(starts.map(|start| Ring::around(topology, start, arity, FACE_REACH)))
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
            let edges = topology.face_edges(face);
            let ends = topology.edge(edge).vertices.iter();
            let mut corners = ends.map(|&vertex| topology.corner_of(face, vertex));
            let start = corners.find(|&corner| edges[corner as usize] == edge);
            let start = start.expect("a face on the edge has it");
            Ring::unmirrored(topology, face, start, 2)
        });
        Ring::least(rings)
    }

    /// The ring of a vertex: the faces around it. It begins in that face in which the configuration is the least. None of a vertex that no face has.
    pub fn of_vertex(topology: &Topology, vertex: u32) -> Option<Ring> {
        let corners = least_corners(topology, few(topology.vertex_faces(vertex)));
        let corners = corners.into_iter();
        Ring::least(corners.map(|at| Ring::unmirrored(topology, at.face, at.corner, 1)))
    }

    /// The ring of an infinite crease between vertices that divide the faces there, as one of its faces has it. It begins where the edge does, and mirrored if the
    /// face's vertices run the other way. None where there is no such corner.
    pub(crate) fn of_side(topology: &Topology, face: u32, corner: u32) -> Option<Ring> {
        let vertices = topology.face(face);
        let &vertex = vertices.get(corner as usize)?;
        let edge = topology.face_edges(face)[corner as usize];
        let mirrored = topology.edge(edge).vertices[0] != vertex;
        let start = Start {
            face,
            corner: (corner + u32::from(mirrored)) % vertices.len() as u32,
            mirrored,
        };
        Some(Ring::around(topology, start, 2, EDGE_REACH))
    }

    /// The ring of a vertex that divides the faces there, as one of them has it. None where there is no such corner.
    pub(crate) fn of_corner(topology: &Topology, face: u32, corner: u32) -> Option<Ring> {
        let is_corner = (corner as usize) < topology.face(face).len();
        is_corner.then(|| Ring::unmirrored(topology, face, corner, 1))
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
        Ring::around(topology, start, corners, EDGE_REACH)
    }

    /// The faces around so many vertices of a face; of hubs, what they reach of them.
    fn around(topology: &Topology, start: Start, corners: u32, reach: u32) -> Ring {
        let own = start.own_steps(topology, corners, reach);
        let faces = surrounding_faces(topology, start, &own, reach);
        let sides = faces.iter().map(|at| topology.face(at.face).len());
        let most = match topology.hubs().is_empty() {
            true => sides.sum::<usize>() + faces.len(),
            false => 0,
        };
        let mut walk = Walk::new(topology, start, own, most);
        walk.options(topology.options());
        walk.words.push(faces.len() as u32);
        for &start in &faces {
            walk.face(start);
        }
        let corners = walk.own.len();
        walk.words.push(corners as u32);
        for corner in 0..corners {
            let vertex = walk.vertices.found()[corner];
            // Which is a corner is told by all that is sharp there.
            let is_corner = || topology.sharp_edges(vertex).nth(2).is_some();
            let sharpness = match topology.divides(vertex) && is_corner() {
                true => INFINITE_SHARPNESS,
                false => topology.vertex_sharpness(vertex),
            };
            walk.words.push(sharpness.to_bits());
        }
        walk.edges(&faces);
        let mut vertices = walk.vertices.found().to_vec();
        walk.hubs(&faces, &mut vertices);
        Ring {
            vertices,
            configuration: Configuration::of(walk.words),
            faces: faces.iter().map(|start| start.face).collect(),
            start: start.corner,
            mirrored: start.mirrored,
        }
    }
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
            if topology.is_crowded(vertex) {
                return [u32::MAX; 3];
            }
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

/// Those corners at a vertex at which what is seen of the face and its two edges there is the least, see [`least_starts`].
fn least_corners(topology: &Topology, corners: &[FaceCorner]) -> SmallVec<[FaceCorner; 8]> {
    let key = |at: &FaceCorner| {
        let edges = topology.face_edges(at.face);
        let arity = edges.len();
        let before = (at.corner as usize + arity - 1) % arity;
        let [leaving, entering] = [edges[at.corner as usize], edges[before]]
            .map(|edge| topology.edge(edge).sharpness.to_bits());
        // Rings do not tell the arity of hubs.
        let listed = topology.hub_of(at.face).map_or(arity, |_| usize::MAX);
        (listed, leaving, entering)
    };
    let least = corners.iter().map(key).min();
    let corners = corners.iter().filter(|at| Some(key(at)) == least);
    corners.copied().collect()
}

/// Writes down a ring and numbers its vertices on the way.
struct Walk<'a> {
    topology: &'a Topology,
    /// The face that it is about, and its corners that are the ring's own.
    start: Start,
    own: SmallVec<[u32; 8]>,
    vertices: Places,
    words: Vec<u32>,
}

/// Most rings have no more sharp edges, which take five words each.
const SHARP: usize = 12;

impl Walk<'_> {
    /// Nothing yet, with room for faces that take so many words.
    fn new(topology: &Topology, start: Start, own: SmallVec<[u32; 8]>, faces: usize) -> Walk<'_> {
        Walk {
            topology,
            start,
            own,
            vertices: Places::default(),
            words: Vec::with_capacity(6 + faces + 5 * SHARP),
        }
    }

    fn options(&mut self, options: SchemeOptions) {
        let chaikin = u32::from(options.creasing == CreaseMethod::Chaikin);
        let smooth = u32::from(options.triangles == TriangleSubdivision::Smooth);
        self.words.push(chaikin | smooth << 1);
    }

    /// Which corners of a face the ring has.
    fn listed(&self, at: Start) -> Listed {
        let arity = self.topology.face(at.face).len() as u32;
        if self.topology.hub_of(at.face).is_none() {
            return Listed::All(arity);
        }
        // The hub itself.
        if at.face == self.start.face && self.own.len() as u32 > 2 * EDGE_REACH {
            return Listed::Near(self.own.clone());
        }
        let own = self.topology.face(self.start.face);
        let mut near: SmallVec<[u32; 8]> = SmallVec::new();
        for &step in &self.own {
            let vertex = own[self.start.corner(step, own.len() as u32) as usize];
            let around = self.topology.vertex_faces(vertex).iter();
            for corner in around.filter(|corner| corner.face == at.face) {
                let step = at.steps_to(corner.corner, arity);
                near.extend((0..=2 * BESIDE).map(|i| (step + arity + i - BESIDE) % arity));
            }
        }
        near.sort_unstable();
        near.dedup();
        Listed::Near(near)
    }

    fn face(&mut self, start: Start) {
        let listed = self.listed(start);
        let vertices = self.topology.face(start.face);
        let arity = vertices.len() as u32;
        self.words.push(listed.len() as u32);
        for number in 0..listed.len() {
            let vertex = vertices[start.corner(listed.get(number), arity) as usize];
            self.words.push(self.vertices.of(vertex) as u32);
        }
    }

    /// The sharp edges at the own vertices, each once, in the order in which the faces show them. The words tell the numbers of the faces' vertices.
    fn edges(&mut self, faces: &[Start]) {
        let topology = self.topology;
        let corners = self.own.len() as u32;
        let mut seen = Places::default();
        let mut at = 2;
        for &start in faces {
            let (vertices, edges) = (topology.face(start.face), topology.face_edges(start.face));
            let arity = edges.len() as u32;
            let listed = self.listed(start);
            let count = listed.len();
            for place in 0..count {
                let i = listed.get(place);
                let next = if place + 1 == count { 0 } else { place + 1 };
                let [a, b] = [place, next].map(|place| self.words[at + 1 + place]);
                // What a hub leaves out is between them.
                let is_gap = listed.get(next) != if i + 1 == arity { 0 } else { i + 1 };
                if a.min(b) >= corners || is_gap {
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
            at += 1 + count;
        }
    }

    /// The hubs that have a say, and what is given of them: own vertices, and faces. What is given stands behind [`GIVEN`] vertices at least; where there are
    /// fewer, the first stands for those that are missing.
    fn hubs(&mut self, faces: &[Start], vertices: &mut Vec<u32>) {
        let topology = self.topology;
        if topology.hubs().is_empty() {
            return;
        }
        let own = vertices[..self.own.len()].to_vec();
        let own = (0..).zip(own).filter_map(|(number, vertex)| {
            let hub = topology.hub_at(vertex)?;
            Some((number, HUB_VERTEX, hub))
        });
        let faces = (0..).zip(faces).filter_map(|(number, start)| {
            let hub = topology.hub_of(start.face)?;
            Some((number, HUB_FACE, hub))
        });
        for (number, kind, hub) in own.chain(faces) {
            vertices.resize(vertices.len().max(GIVEN), vertices[0]);
            let first = vertices.len() as u32;
            self.words.extend([number, number, kind, first, hub.count]);
            vertices.extend(hub.given());
        }
    }
}
