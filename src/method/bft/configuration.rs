//! The surroundings of a face of the refined mesh, in an order that depends on nothing but how they hang together: equal configurations have
//! one table (section II-A, "configuration meshes").

use rustc_hash::FxHashMap;

use crate::mesh::sharpness::is_sharp;
use crate::mesh::topology::Topology;

/// A descendant of a face: its number, and where its corners lie on the face's lattice.
pub type Cell = (u32, Vec<[u32; 2]>);

/// A face, or its children, with the rings of faces around, begun at one of the face's corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Configuration {
    /// Equal for equal configurations: faces in local numbers, and what kind of vertex each is whose faces are all here.
    pub key: Vec<u32>,
    /// The faces, in the order of the walk; the face itself or its children first.
    pub faces: Vec<u32>,
    /// The vertices, in the order of the walk; the face's own first, from the corner on.
    pub vertices: Vec<u32>,
    /// The corner.
    pub turn: u32,
    /// The face, or its children, on a lattice of 2^level segments.
    pub cells: Vec<Cell>,
    /// 0 for the face, 1 for its children.
    pub level: u32,
}

/// The configuration of a face, turned so that its extraordinary vertex, which it has one of at most, is corner 0. Among
/// several turns the one with the least key.
pub fn configuration(topology: &Topology, face: u32, rings: usize) -> Configuration {
    let arity = topology.face(face).len() as u32;
    let mut turns: Vec<u32> = (0..arity)
        .filter(|&corner| is_extraordinary(topology, face, corner))
        .collect();
    if turns.is_empty() {
        turns.extend(0..arity);
    }
    let walks = turns
        .into_iter()
        .map(|turn| walk(topology, &[(face, turn)], rings));
    let least = walks.min_by(|a, b| a.key.cmp(&b.key));
    let mut found = least.expect("a face has corners");
    let mut corners: Vec<[u32; 2]> = match arity {
        3 => vec![[0, 0], [1, 0], [0, 1]],
        _ => vec![[0, 0], [1, 0], [1, 1], [0, 1]],
    };
    corners.rotate_right(found.turn as usize);
    found.cells = vec![(face, corners)];
    found
}

impl Configuration {
    /// The configuration of a face's children in the mesh refined once more, from the same corner on. It is the same wherever the face's own is:
    /// the rings of faces around the children are children of those around the face.
    pub fn refined(&self, refined: &Topology, rings: usize) -> Configuration {
        let (face, corners) = &self.cells[0];
        let (n, turn) = (corners.len(), self.turn as usize);
        let mut cells = children(*face, corners);
        cells[..n].rotate_left(turn);
        // The child at a corner has that corner itself, the one in the middle the corner opposite to it.
        let starts = cells.iter().enumerate();
        let starts: Vec<(u32, u32)> = starts
            .map(|(i, &(child, _))| (child, ((i + turn) % n) as u32))
            .collect();
        Configuration {
            cells,
            level: self.level + 1,
            ..walk(refined, &starts, rings)
        }
    }
}

/// The four children of a triangle or quad in the order of [`refine_all`](crate::subdivision::refine_all), with their corners on a lattice of
/// twice the segments: each lies between two corners of the parent, and the middle of a quad between two opposite ones.
pub fn children(face: u32, corners: &[[u32; 2]]) -> Vec<Cell> {
    let n = corners.len();
    let between = |a: usize, b: usize| {
        let [a, b] = [corners[a % n], corners[b % n]];
        [a[0] + b[0], a[1] + b[1]]
    };
    let mut children: Vec<Cell> = (0..n)
        .map(|corner| {
            let child = (0..n).map(|other| between(corner, other));
            (4 * face + corner as u32, child.collect())
        })
        .collect();
    if n == 3 {
        let middle = (0..3).map(|corner| between(corner + 1, corner + 2));
        children.push((4 * face + 3, middle.collect()));
    }
    children
}

/// Whether a corner has other than six triangles or four quads around it, or half of these at a boundary.
fn is_extraordinary(topology: &Topology, face: u32, corner: u32) -> bool {
    let vertex = topology.face(face)[corner as usize];
    let (faces, edges) = (
        topology.vertex_faces(vertex).len(),
        topology.vertex_edges(vertex).len(),
    );
    let whole = if topology.face(face).len() == 3 { 6 } else { 4 };
    let regular = if faces == edges { whole } else { whole / 2 };
    faces != regular || is_sharp(topology.vertex_sharpness(vertex))
}

/// A configuration as it is walked.
struct Walk<'a> {
    topology: &'a Topology,
    found: Configuration,
    numbers: FxHashMap<u32, u32>,
    /// The face by which each vertex was reached, and its corner there.
    reached: Vec<(u32, u32)>,
}

/// Takes some faces, each from a corner on, then the faces around each vertex in turn, counter-clockwise from the face by which the vertex was
/// reached or from the boundary, ring by ring.
fn walk(topology: &Topology, starts: &[(u32, u32)], rings: usize) -> Configuration {
    let mut walk = Walk {
        topology,
        found: Configuration {
            turn: starts[0].1,
            ..Default::default()
        },
        numbers: FxHashMap::default(),
        reached: Vec::new(),
    };
    for &(face, corner) in starts {
        walk.take(face, corner);
    }
    let mut first = 0;
    for _ in 0..rings {
        let end = walk.reached.len();
        (first..end).for_each(|vertex| walk.around(vertex));
        first = end;
    }
    walk.found
}

impl Walk<'_> {
    /// Takes a face, whose vertices are numbered from a corner on.
    fn take(&mut self, face: u32, corner: u32) {
        self.found.faces.push(face);
        let vertices = self.topology.face(face);
        let n = vertices.len() as u32;
        self.found.key.push(n);
        for corner in (corner..corner + n).map(|corner| corner % n) {
            let vertex = vertices[corner as usize];
            let next = self.reached.len() as u32;
            let number = *self.numbers.entry(vertex).or_insert(next);
            if number == next {
                self.found.vertices.push(vertex);
                self.reached.push((face, corner));
            }
            self.found.key.push(number);
        }
    }

    fn around(&mut self, number: usize) {
        let vertex = self.found.vertices[number];
        let (face, corner) = self.reached[number];
        let fan = self.topology.fan(face, corner);
        let sharp = is_sharp(self.topology.vertex_sharpness(vertex));
        let kind = u32::from(fan.closed) | u32::from(sharp) << 1;
        self.found.key.push(kind);
        let n = fan.faces.len();
        let first = if fan.closed { fan.at } else { 0 };
        for face in (first..first + n).map(|i| fan.faces[i % n]) {
            if !self.found.faces.contains(&face) {
                let corner = self.topology.face(face).iter().position(|&v| v == vertex);
                self.take(face, corner.expect("a fan's faces have its vertex") as u32);
            }
        }
    }
}
