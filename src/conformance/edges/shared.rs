//! What faces make of the edges and vertices that they share, compared bit by bit.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use crate::abi::Captured;
use crate::mesh::topology::Topology;
use crate::mesh::{INFINITE_SHARPNESS, Model};
use crate::method::{Pass, to_ptex};
use crate::subdivision::{LimitSurface, TangentPlane, tangent_plane};
use crate::tessellation::Domain;

/// A line between two patches: of the control mesh, from its lower vertex on, or between two corners of an n-gon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Line {
    Edge(u32, u32),
    Spoke { face: u32, corner: u32 },
}

/// What all patches around it share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Vertex {
    Control(u32),
    Centre(u32),
}

/// What a line lies between.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineKind {
    /// Inside of an n-gon.
    Spoke,
    /// Something and nothing: a boundary, or a hole beyond.
    Boundary,
    /// More than two faces, or two that run along it in the same direction.
    NonManifold,
    /// Two faces that an infinite crease separates.
    InfiniteCrease,
    /// The two sides of a semi-sharp crease.
    SemiSharpCrease,
    /// A quad and an n-gon.
    QuadAndPolygon,
    /// Two n-gons.
    Polygons,
    /// A quad that is a plain B-spline, and one that has a plan.
    RegularAndIrregular,
    /// Any other two faces that the scheme takes whole.
    Whole,
}

/// A side of a line: its face, and which of the two patches on a spoke.
type Side = (u32, bool);

/// The bits of a position and a normal.
type Bits = ([u32; 3], [u32; 3]);

/// What a side has along a line, by the bits of where on it.
#[derive(Clone, Debug, Default)]
struct Along {
    shader: &'static str,
    vertices: BTreeMap<u32, Bits>,
}

/// What a face has at one of its corners.
struct AtCorner {
    face: u32,
    corner: u32,
    bits: Bits,
}

/// Everything that came on lines and at vertices.
pub struct Shared<'a> {
    model: &'a Model,
    numbers: LimitSurface,
    lines: BTreeMap<Line, BTreeMap<Side, Along>>,
    vertices: BTreeMap<Vertex, Vec<AtCorner>>,
    compared: Compared,
}

/// How much was compared, and how much of it differs.
#[derive(Clone, Debug, Default)]
pub struct Compared {
    /// Positions.
    pub positions: u64,
    /// Normals.
    pub normals: u64,
    /// Sides of lines that have other vertices than the first side.
    pub junctions: u64,
    /// Positions with other bits.
    pub different_positions: u64,
    /// Normals with other bits.
    pub different_normals: u64,
    /// The first of all these, in words.
    pub first: Option<String>,
}

impl Compared {
    /// Whether everything is the same.
    pub fn is_same(&self) -> bool {
        self.first.is_none()
    }

    /// Adds what was compared elsewhere.
    pub fn add(&mut self, other: Compared) {
        self.positions += other.positions;
        self.normals += other.normals;
        self.junctions += other.junctions;
        self.different_positions += other.different_positions;
        self.different_normals += other.different_normals;
        self.first = self.first.take().or(other.first);
    }

    fn positions(&mut self, a: &Bits, b: &Bits, what: impl FnOnce() -> String) {
        self.positions += 1;
        if a.0 != b.0 {
            self.different_positions += 1;
            let words = || format!("{}: positions {} and {}", what(), floats(a.0), floats(b.0));
            self.first.get_or_insert_with(words);
        }
    }

    fn normals(&mut self, a: &Bits, b: &Bits, what: impl FnOnce() -> String) {
        self.normals += 1;
        if a.1 != b.1 {
            self.different_normals += 1;
            let words = || format!("{}: normals {} and {}", what(), floats(a.1), floats(b.1));
            self.first.get_or_insert_with(words);
        }
    }
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} positions and {} normals compared, {} and {} differ",
            self.positions, self.normals, self.different_positions, self.different_normals
        )?;
        match self.junctions {
            0 => Ok(()),
            count => write!(f, ", {count} T-junctions"),
        }
    }
}

fn floats(bits: [u32; 3]) -> String {
    format!("{:?}", bits.map(f32::from_bits))
}

impl<'a> Shared<'a> {
    /// Nothing of a model yet.
    pub fn new(model: &'a Model) -> Shared<'a> {
        Shared {
            model,
            numbers: LimitSurface::new(model.mesh()),
            lines: BTreeMap::new(),
            vertices: BTreeMap::new(),
            compared: Compared::default(),
        }
    }

    /// Takes a vertex of a pass in, if it lies on an edge or at a corner.
    pub fn add(&mut self, pass: &Pass, vertex: &Captured) {
        let patch = &pass.patches[vertex.patch_number as usize];
        let uv = to_ptex(patch, vertex.uv);
        let place = self.numbers.face_corner(patch.ptex as usize);
        let (face, corner) = place.expect("patches are of ptex faces");
        let bits = (
            vertex.position.map(f32::to_bits),
            vertex.normal.map(f32::to_bits),
        );
        let domain = pass.domain;
        if let Some((vertex, corner)) = self.vertex(domain, face, corner, uv) {
            let corners = self.vertices.entry(vertex).or_default();
            corners.push(AtCorner { face, corner, bits });
            return;
        }
        let places: Vec<_> = (0..domain.corners())
            .filter_map(|edge| self.place(domain, face, corner, edge, uv))
            .collect();
        for (line, t, side) in places {
            let sides = self.lines.entry(line).or_default();
            let along = sides.entry(side).or_default();
            along.shader = pass.shader;
            // What stands twice at one place: the middle of an n-gon's edge belongs to two patches.
            if let Some(known) = along.vertices.insert(t.to_bits(), bits) {
                let what = || format!("face {face}, the middle of {line:?}");
                self.compared.positions(&known, &bits, what);
                self.compared.normals(&known, &bits, what);
            }
        }
    }

    /// The vertex at a corner of a part, and at which corner of the face; None elsewhere, and in the middle of an n-gon's edge.
    fn vertex(&self, domain: Domain, face: u32, part: u32, uv: [f32; 2]) -> Option<(Vertex, u32)> {
        let corners: &[[f32; 2]] = match domain {
            Domain::Quads => &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            Domain::Triangles => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
        };
        let corner = corners.iter().position(|&corner| corner == uv)? as u32;
        let vertices = self.model.topology().face(face);
        let control = |corner: u32| Some((Vertex::Control(vertices[corner as usize]), corner));
        match (self.is_whole(face), corner) {
            (true, _) => control(corner),
            (_, 0) => control(part),
            (_, 2) => Some((Vertex::Centre(face), part)),
            _ => None,
        }
    }

    fn is_whole(&self, face: u32) -> bool {
        let scheme = self.model.mesh().options().scheme;
        scheme.is_whole(self.model.topology().face(face).len())
    }

    /// The line that (u, v) lies on, if it lies on the part's edge `edge`, where between the line's ends, and the side.
    fn place(
        &self,
        domain: Domain,
        face: u32,
        corner: u32,
        edge: usize,
        [u, v]: [f32; 2],
    ) -> Option<(Line, f32, Side)> {
        let (off, along) = match domain {
            Domain::Quads => [(v, u), (1.0 - u, v), (1.0 - v, 1.0 - u), (u, 1.0 - v)][edge],
            Domain::Triangles => [(v, u), ((1.0 - u) - v, v), (u, 1.0 - v)][edge],
        };
        if off != 0.0 {
            return None;
        }
        let vertices = self.model.topology().face(face);
        let n = vertices.len() as u32;
        let whole = |corner: u32, along: f32| {
            let [a, b] = [corner, corner + 1].map(|i| vertices[(i % n) as usize]);
            let (line, along) = if a < b {
                (Line::Edge(a, b), along)
            } else {
                (Line::Edge(b, a), 1.0 - along)
            };
            (line, along, (face, false))
        };
        if self.is_whole(face) {
            return Some(whole(edge as u32, along));
        }
        let previous = (corner + n - 1) % n;
        let spoke = |corner: u32, along: f32, own: bool| {
            let line = Line::Spoke { face, corner };
            (line, along, (face, own))
        };
        Some(match edge {
            0 => whole(corner, 0.5 * along),
            3 => whole(previous, 0.5 + 0.5 * along),
            // From the middle of the edge that leaves the corner to the face's centre.
            1 => spoke(corner, along, true),
            _ => spoke(previous, 1.0 - along, false),
        })
    }

    /// The lines of a kind with their kinds, and the vertices at their ends; or all of both.
    fn chosen(&self, only: Option<LineKind>) -> (Vec<(Line, LineKind)>, BTreeSet<Vertex>) {
        let lines = self.lines.iter();
        let lines: Vec<_> = lines
            .map(|(line, sides)| (*line, self.kind(*line, sides)))
            .filter(|(_, kind)| only.is_none_or(|only| only == *kind))
            .collect();
        let ends = lines.iter().flat_map(|(line, _)| match *line {
            Line::Edge(a, b) => [a, b].map(Vertex::Control),
            // It begins in the middle of an edge.
            Line::Spoke { face, .. } => [Vertex::Centre(face); 2],
        });
        let vertices = match only {
            None => self.vertices.keys().copied().collect(),
            Some(_) => ends.collect(),
        };
        (lines, vertices)
    }

    /// Flips the last bit of one position that will be compared with another: a fault to be found.
    pub fn spoil(&mut self, only: Option<LineKind>) {
        let (lines, vertices) = self.chosen(only);
        let shared = lines.iter().find(|(line, _)| self.lines[line].len() > 1);
        if let Some((line, _)) = shared {
            let sides = self.lines.get_mut(line).expect("it was just there");
            let last = sides.values_mut().last();
            let bits = last.and_then(|side| side.vertices.values_mut().next());
            bits.expect("a side has vertices").0[0] ^= 1;
            return;
        }
        let mut corners = vertices
            .iter()
            .filter_map(|v| Some((v, self.vertices.get(v)?)));
        let shared = corners.find(|(_, corners)| corners.len() > 1);
        if let Some(vertex) = shared.map(|(vertex, _)| *vertex) {
            let corners = self.vertices.get_mut(&vertex).expect("it was just there");
            corners[0].bits.0[0] ^= 1;
        }
    }

    /// Compares all sides of each line, or of those of a kind, and all faces around each vertex, or around those at the ends of such lines.
    ///
    /// Normals are compared where the limit has only one: across all edges but infinite creases, and around vertices among the faces of a
    /// sector, except at cusps.
    pub fn compare(mut self, only: Option<LineKind>) -> Compared {
        let mut compared = std::mem::take(&mut self.compared);
        let (lines, vertices) = self.chosen(only);
        for (line, kind) in lines {
            self.compare_line(line, kind, &self.lines[&line], &mut compared);
        }
        for vertex in vertices {
            let corners = self.vertices.get(&vertex).map_or(&[][..], Vec::as_slice);
            self.compare_vertex(vertex, corners, &mut compared);
        }
        compared
    }

    fn kind(&self, line: Line, sides: &BTreeMap<Side, Along>) -> LineKind {
        let topology = self.model.topology();
        let Line::Edge(a, b) = line else {
            return LineKind::Spoke;
        };
        let edge = edge_between(topology, a, b);
        let polygons = sides.keys().filter(|side| !self.is_whole(side.0));
        let shaders = sides.values().map(|side| side.shader);
        let forward = sides.keys().filter(|side| {
            let face = topology.face(side.0);
            (0..face.len()).any(|i| face[i] == a && face[(i + 1) % face.len()] == b)
        });
        match (sides.len(), topology.edge(edge).sharpness) {
            (1, _) => LineKind::Boundary,
            (2, _) if forward.count() != 1 => LineKind::NonManifold,
            (2, s) if s >= INFINITE_SHARPNESS => LineKind::InfiniteCrease,
            (2, s) if s > 0.0 => LineKind::SemiSharpCrease,
            (2, _) => match polygons.count() {
                1 => LineKind::QuadAndPolygon,
                2 => LineKind::Polygons,
                _ if !all_same(shaders) => LineKind::RegularAndIrregular,
                _ => LineKind::Whole,
            },
            _ => LineKind::NonManifold,
        }
    }

    fn compare_line(
        &self,
        line: Line,
        kind: LineKind,
        sides: &BTreeMap<Side, Along>,
        compared: &mut Compared,
    ) {
        let topology = self.model.topology();
        let smooth = match line {
            Line::Spoke { .. } => true,
            Line::Edge(a, b) => {
                topology.edge(edge_between(topology, a, b)).sharpness < INFINITE_SHARPNESS
            }
        };
        let mut sides = sides.iter();
        let (_, first) = sides.next().expect("a line has a side");
        for (side, along) in sides {
            if !along.vertices.keys().eq(first.vertices.keys()) {
                compared.junctions += 1;
                let [here, there] = [along, first].map(|along| along.vertices.len());
                let words = || {
                    format!(
                        "{kind:?} {line:?}, {side:?}: {here} vertices at other places than the {there} of the first side"
                    )
                };
                compared.first.get_or_insert_with(words);
            }
            for (t, bits) in &along.vertices {
                let Some(others) = first.vertices.get(t) else {
                    continue;
                };
                let what = || format!("{kind:?} {line:?}, {side:?} at {}", f32::from_bits(*t));
                compared.positions(bits, others, what);
                if smooth {
                    compared.normals(bits, others, what);
                }
            }
        }
    }

    fn compare_vertex(&self, vertex: Vertex, corners: &[AtCorner], compared: &mut Compared) {
        let mut planes: Vec<(TangentPlane, &Bits)> = Vec::new();
        for (number, corner) in corners.iter().enumerate() {
            let what = || format!("{vertex:?}, face {}", corner.face);
            if number > 0 {
                compared.positions(&corner.bits, &corners[0].bits, what);
            }
            let plane = match vertex {
                Vertex::Centre(_) => Some(TangentPlane::Vertex),
                Vertex::Control(_) => plane(self.model.topology(), corner.face, corner.corner),
            };
            let Some(plane) = plane else { continue };
            match planes.iter().find(|known| known.0 == plane) {
                None => planes.push((plane, &corner.bits)),
                Some((_, known)) => compared.normals(&corner.bits, known, what),
            }
        }
    }
}

/// The tangent plane at a corner; None where an infinite crease meets something semi-sharp, and so hides which faces share one.
fn plane(topology: &Topology, face: u32, corner: u32) -> Option<TangentPlane> {
    let vertex = topology.face(face)[corner as usize];
    let own = topology.vertex_sharpness(vertex);
    let edges = topology.sharp_edges(vertex);
    let all: Vec<f32> = edges
        .map(|edge| topology.edge(edge).sharpness)
        .chain([own])
        .collect();
    let infinite = all.iter().any(|&s| s >= INFINITE_SHARPNESS);
    let semi_sharp = all.iter().any(|&s| s > 0.0 && s < INFINITE_SHARPNESS);
    match (infinite, semi_sharp) {
        (true, true) => None,
        // What is semi-sharp is smooth in the limit.
        (false, true) => Some(TangentPlane::Vertex),
        _ => Some(tangent_plane(topology, face, corner)),
    }
}

fn edge_between(topology: &Topology, a: u32, b: u32) -> u32 {
    let mut edges = topology.vertex_edges(a).iter().copied();
    let between = edges.find(|&edge| topology.edge(edge).other(a) == b);
    between.expect("a line is an edge")
}

fn all_same<T: PartialEq>(mut items: impl Iterator<Item = T>) -> bool {
    let first = items.next();
    items.all(|item| Some(item) == first)
}
