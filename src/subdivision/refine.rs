//! One step of refinement around chosen faces.
//!
//! A child face needs nothing but its parent's 1-ring: every vertex around it, and the sharpness of every edge at its corners, comes
//! from faces that touch the parent. So a step keeps the children of some cells and the faces that touch them, and the same holds
//! for the next step. What lies on the rim of such a topology has the wrong rules; no cell ever asks for it.

use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use crate::mesh::CreaseMethod;
use crate::mesh::places::Places;
use crate::mesh::sharpness::{decayed, decayed_around_vertex, is_sharp};
use crate::mesh::topology::{FaceCorner, Hub, Hubs, Topology};
use crate::subdivision::masks::{Mask, edge_point, face_point, vertex_point};

/// A refined topology, and how its vertices come from the parent's.
#[derive(Clone, Debug, Default)]
pub struct Refinement {
    /// The children of the chosen cells first, in the order of the cells and their corners, then the faces that touch them.
    pub topology: Topology,
    /// The mask of each vertex over the parent's vertices.
    pub masks: Vec<Mask>,
    /// The number of faces that are children of chosen cells.
    pub cells: u32,
}

/// A vertex of the next level: a face, edge or vertex of this one.
#[derive(Clone, Copy)]
pub(super) enum Origin {
    Face(u32),
    Edge(u32),
    Vertex(u32),
}

/// The child of `face` at `corner`. A quad's child turns so that corner i is its vertex i and (u, v) run as the parent's;
/// an n-gon's child begins at the corner, as its ptex face does.
fn child(topology: &Topology, face: u32, corner: u32) -> [Origin; 4] {
    let (vertices, edges) = (topology.face(face), topology.face_edges(face));
    let (corner, arity) = (corner as usize, vertices.len());
    let mut child = [
        Origin::Vertex(vertices[corner]),
        Origin::Edge(edges[corner]),
        Origin::Face(face),
        Origin::Edge(edges[(corner + arity - 1) % arity]),
    ];
    if arity == 4 {
        child.rotate_right(corner);
    }
    child
}

/// The faces that share a vertex with any of the `faces`, which come first; each once.
pub(crate) fn with_neighbours(topology: &Topology, faces: &[u32]) -> Vec<u32> {
    if topology.face_count() + topology.vertex_count() > SMALL {
        let (mut all, mut vertices) = (Places::default(), Places::default());
        let new_face = |face| all.add(face);
        return neighbours(topology, faces, new_face, |vertex| vertices.add(vertex));
    }
    let mut is_met = [false; SMALL];
    let (all, vertices) = is_met.split_at_mut(topology.face_count());
    let meet = |met: &mut bool| !std::mem::replace(met, true);
    let new_face = |face: u32| meet(&mut all[face as usize]);
    neighbours(topology, faces, new_face, |vertex: u32| {
        meet(&mut vertices[vertex as usize])
    })
}

/// So many faces and vertices together are marked one by one.
const SMALL: usize = 1 << 10;

fn neighbours(
    topology: &Topology,
    faces: &[u32],
    mut new_face: impl FnMut(u32) -> bool,
    // A vertex that many faces share is asked once.
    mut new_vertex: impl FnMut(u32) -> bool,
) -> Vec<u32> {
    let mut all = Vec::with_capacity(4 * faces.len() + 12);
    all.extend(faces.iter().copied().filter(|&face| new_face(face)));
    for &vertex in faces.iter().flat_map(|&face| topology.face(face)) {
        if new_vertex(vertex) {
            let around = topology.vertex_faces(vertex).iter();
            all.extend(around.map(|at| at.face).filter(|&face| new_face(face)));
        }
    }
    all
}

/// Cells to look up: a few one by one, many by a set.
struct Chosen<'a> {
    cells: &'a [(u32, u32)],
    set: FxHashSet<(u32, u32)>,
}

/// So many cells are looked at one by one.
const FEW: usize = 16;

impl Chosen<'_> {
    fn new(cells: &[(u32, u32)]) -> Chosen<'_> {
        let many = cells.iter().filter(|_| cells.len() > FEW);
        Chosen {
            cells,
            set: many.copied().collect(),
        }
    }

    fn has(&self, cell: (u32, u32)) -> bool {
        match self.cells.len() > FEW {
            true => self.set.contains(&cell),
            false => self.cells.contains(&cell),
        }
    }
}

/// Refines the given children, each a face and a corner of it, with everything that touches them. Those of corners that the topology has not are left
/// out.
pub fn refine(parent: &Topology, cells: &[(u32, u32)]) -> Refinement {
    let is_corner = |&(face, corner): &(u32, u32)| (corner as usize) < parent.face(face).len();
    let cells: SmallVec<[(u32, u32); 8]> = cells.iter().copied().filter(is_corner).collect();
    let mut step = Step::new(parent);
    let chosen = Chosen::new(&cells);
    let mut faces: Vec<[u32; 4]> = Vec::with_capacity(4 * cells.len() + 12);
    for &(face, corner) in &cells {
        faces.push(child(parent, face, corner).map(|origin| step.number(origin)));
    }
    let mut parents: Vec<u32> = cells.iter().map(|&(face, _)| face).collect();
    parents.dedup();
    // The chosen children have numbered their own vertices: whoever has one of these touches them.
    let touched = step.origins.len() as u32;
    for face in with_neighbours(parent, &parents) {
        for corner in 0..parent.face(face).len() as u32 {
            let child = child(parent, face, corner);
            if child.iter().any(|&origin| step.known(origin) < touched)
                && !chosen.has((face, corner))
            {
                faces.push(child.map(|origin| step.number(origin)));
            }
        }
    }
    step.finish(&faces, cells.len())
}

/// Refines the surroundings of edge `edge` and of its two ends, which are all that the limit along the edge depends on. The first
/// vertices are the child of `from`, which is one of the ends, the edge's middle, and the child of the other end. The first faces are the
/// children of the `sides`, two each: at `from`, and at the other end.
pub fn refine_edge(parent: &Topology, edge: u32, from: u32, sides: &[u32]) -> Refinement {
    let mut step = Step::new(parent);
    let to = parent.edge(edge).other(from);
    let kept = [Origin::Vertex(from), Origin::Edge(edge), Origin::Vertex(to)];
    kept.iter().for_each(|&origin| {
        step.number(origin);
    });
    let corner = |face: u32, vertex: u32| {
        let corner = parent.face(face).iter().position(|&v| v == vertex);
        (face, corner.expect("sides have the edge's ends") as u32)
    };
    let mut cells: Vec<(u32, u32)> = sides
        .iter()
        .flat_map(|&face| [corner(face, from), corner(face, to)])
        .collect();
    let count = cells.len();
    for vertex in [from, to] {
        for &FaceCorner { face, corner } in parent.vertex_faces(vertex) {
            if !cells[..count].contains(&(face, corner)) {
                cells.push((face, corner));
            }
        }
    }
    let faces: Vec<[u32; 4]> = cells
        .iter()
        .map(|&(face, corner)| child(parent, face, corner).map(|origin| step.number(origin)))
        .collect();
    step.finish(&faces, count)
}

/// Refines the faces around a vertex, which are all that the limit there depends on, given by their corners at it. What lies beyond, the children of an n-gon
/// above all, is left out.
pub fn refine_vertex(parent: &Topology, corners: &[(u32, u32)]) -> Refinement {
    let mut step = Step::new(parent);
    let faces: Vec<[u32; 4]> = corners
        .iter()
        .map(|&(face, corner)| child(parent, face, corner).map(|origin| step.number(origin)))
        .collect();
    step.finish(&faces, corners.len())
}

/// Numbers the vertices of the next level as they are met.
struct Step<'a> {
    parent: &'a Topology,
    /// The numbers by origin: of the parent's faces, then its edges, then its vertices.
    numbers: Vec<u32>,
    origins: Vec<Origin>,
}

/// The number of an origin that has none yet.
const UNKNOWN: u32 = u32::MAX;

impl Step<'_> {
    fn new(parent: &Topology) -> Step<'_> {
        let origins = parent.face_count() + parent.edge_count() + parent.vertex_count();
        Step {
            parent,
            numbers: vec![UNKNOWN; origins],
            origins: Vec::new(),
        }
    }

    /// Where `numbers` holds an origin's number.
    fn place(&self, origin: Origin) -> usize {
        let (faces, edges) = (self.parent.face_count(), self.parent.edge_count());
        match origin {
            Origin::Face(face) => face as usize,
            Origin::Edge(edge) => faces + edge as usize,
            Origin::Vertex(vertex) => faces + edges + vertex as usize,
        }
    }

    fn known(&self, origin: Origin) -> u32 {
        self.numbers[self.place(origin)]
    }

    fn number(&mut self, origin: Origin) -> u32 {
        let place = self.place(origin);
        if self.numbers[place] == UNKNOWN {
            self.numbers[place] = self.origins.len() as u32;
            self.origins.push(origin);
        }
        self.numbers[place]
    }

    /// What is given of the hubs that are still there. It is numbered behind all else.
    fn hubs(&mut self) -> Hubs {
        let parent = self.parent;
        let mut below = |origin: Origin, hub: &Hub| {
            let at = self.known(origin);
            if at == UNKNOWN {
                return None;
            }
            let first = self.origins.len() as u32;
            for given in hub.below() {
                self.number(Origin::Vertex(given));
            }
            let count = hub.below().len() as u32;
            Some(Hub { at, first, count })
        };
        let hubs = parent.hubs();
        let vertices = hubs.vertices().iter();
        let mut found: Vec<Hub> = vertices
            .filter_map(|hub| below(Origin::Vertex(hub.at), hub))
            .collect();
        let faces = hubs.faces().iter();
        found.extend(faces.filter_map(|hub| below(Origin::Face(hub.at), hub)));
        Hubs::new(found, Vec::new())
    }

    /// Connects the faces that were numbered.
    fn finish(mut self, faces: &[[u32; 4]], cells: usize) -> Refinement {
        let hubs = self.hubs();
        let origins = self.origins.iter();
        let topology = Topology::connect(
            faces.iter().map(|f| &f[..]),
            origins
                .clone()
                .map(|&origin| self.sharpness(origin))
                .collect(),
            self.parent.options(),
            |a, b| self.edge(a, b),
        );
        Refinement {
            topology: topology.with_hubs(hubs),
            masks: origins.map(|&origin| self.mask(origin)).collect(),
            cells: cells as u32,
        }
    }

    fn sharpness(&self, origin: Origin) -> f32 {
        match origin {
            Origin::Vertex(vertex) => decayed(self.parent.vertex_sharpness(vertex)),
            _ => 0.0,
        }
    }

    fn mask(&self, origin: Origin) -> Mask {
        match origin {
            Origin::Face(face) => face_point(self.parent, face),
            Origin::Edge(edge) => edge_point(self.parent, edge),
            Origin::Vertex(vertex) => vertex_point(self.parent, vertex),
        }
    }

    /// The sharpness of the child edge `a`-`b`, and what it will be at its ends: half a parent edge, or smooth.
    fn edge(&self, a: u32, b: u32) -> (f32, [f32; 2]) {
        match (self.origins[a as usize], self.origins[b as usize]) {
            (Origin::Vertex(vertex), Origin::Edge(edge)) => half(self.parent, edge, vertex),
            (Origin::Edge(edge), Origin::Vertex(vertex)) => {
                let (sharpness, [near, far]) = half(self.parent, edge, vertex);
                (sharpness, [far, near])
            }
            _ => (0.0, [0.0; 2]),
        }
    }
}

/// The half of `edge` that ends in `vertex`: its sharpness, and next that at the vertex and at the edge's middle.
pub(super) fn half(parent: &Topology, edge: u32, vertex: u32) -> (f32, [f32; 2]) {
    let method = parent.options().creasing;
    let whole = parent.edge(edge);
    let sharpness = parent.next_at(edge, vertex);
    if !is_sharp(sharpness) {
        return (sharpness, [0.0; 2]);
    }
    if method == CreaseMethod::Uniform {
        return (sharpness, [decayed(sharpness); 2]);
    }
    let around = parent.vertex_edges(vertex);
    let halves: SmallVec<[f32; 8]> = around.iter().map(|&e| parent.next_at(e, vertex)).collect();
    let at = around
        .iter()
        .position(|&e| e == edge)
        .expect("the edge ends in this vertex");
    let near = decayed_around_vertex(method, &halves)[at];
    let far = decayed_around_vertex(
        method,
        &[sharpness, parent.next_at(edge, whole.other(vertex))],
    )[0];
    (sharpness, [near, far])
}
