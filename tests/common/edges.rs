//! What faces make of the edges and vertices that they share, compared bit by bit.

use std::collections::BTreeMap;

use glam::Vec3;
use hullform::mesh::topology::Topology;
use hullform::mesh::{INFINITE_SHARPNESS, Model};
use hullform::method::{Pass, to_ptex};
use hullform::subdivision::{LimitSurface, TangentPlane, tangent_plane};

/// A line between two patches: of the control mesh, from its lower vertex on, or between two corners of an n-gon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Line {
    Edge(u32, u32),
    Inner { face: u32, corner: u32 },
}

/// What all patches around it share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Vertex {
    Control(u32),
    Centre(u32),
}

/// A vertex of a patch's tessellation.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub patch: u32,
    pub uv: [f32; 2],
    pub position: Vec3,
    pub normal: Vec3,
}

/// A side of a line: its face, and which of the two patches on an inner line.
type Side = (u32, bool);

/// Positions and normals along a line by the bits of where they are on it.
type Along = BTreeMap<u32, (Vec3, Vec3)>;

/// Position and normal that a face has at a corner.
type AtCorner = ((u32, u32), Vec3, Vec3);

/// Everything on lines and at vertices.
pub struct Shared<'a> {
    model: &'a Model,
    numbers: LimitSurface,
    lines: BTreeMap<Line, BTreeMap<Side, Along>>,
    vertices: BTreeMap<Vertex, Vec<AtCorner>>,
}

/// How much was compared.
#[derive(Clone, Copy, Debug, Default)]
pub struct Compared {
    pub positions: usize,
    pub normals: usize,
}

fn bits(v: Vec3) -> [u32; 3] {
    v.to_array().map(f32::to_bits)
}

impl<'a> Shared<'a> {
    pub fn new(model: &'a Model) -> Shared<'a> {
        Shared {
            model,
            numbers: LimitSurface::new(model.mesh()),
            lines: BTreeMap::new(),
            vertices: BTreeMap::new(),
        }
    }

    /// Takes a vertex in, if it lies on an edge or at a corner.
    pub fn add(&mut self, pass: &Pass, sample: Sample) {
        let patch = &pass.patches[sample.patch as usize];
        let uv = to_ptex(patch, sample.uv);
        let (face, corner) = self.numbers.face_corner(patch.ptex as usize);
        let arity = self.model.topology().face(face).len() as u32;
        let both = (sample.position, sample.normal);
        let at = |t: f32| t == 0.0 || t == 1.0;
        if at(uv[0]) && at(uv[1]) {
            let number = if uv[1] == 0.0 {
                u32::from(uv[0] == 1.0)
            } else {
                2 + u32::from(uv[0] == 0.0)
            };
            let vertex = match (arity, number) {
                (4, _) => Some((
                    Vertex::Control(self.model.topology().face(face)[number as usize]),
                    number,
                )),
                (_, 0) => Some((
                    Vertex::Control(self.model.topology().face(face)[corner as usize]),
                    corner,
                )),
                (_, 2) => Some((Vertex::Centre(face), corner)),
                _ => None,
            };
            if let Some((vertex, corner)) = vertex {
                self.vertices
                    .entry(vertex)
                    .or_default()
                    .push(((face, corner), both.0, both.1));
                return;
            }
        }
        let places = (0..4).filter_map(|edge| self.place(face, corner, edge, uv));
        for (line, along, side) in places.collect::<Vec<_>>() {
            let along = self
                .lines
                .entry(line)
                .or_default()
                .entry(side)
                .or_default()
                .insert(along.to_bits(), both);
            // What stands twice at one place: the middle of an n-gon's edge belongs to two patches.
            let same = along
                .is_none_or(|known| bits(known.0) == bits(both.0) && bits(known.1) == bits(both.1));
            assert!(
                same,
                "{line:?} at {uv:?}: {along:?} and {both:?} in the middle of an edge"
            );
        }
    }

    /// The line that (u, v) lies on, if it lies on the part's edge `edge`, where between the line's ends, and the side.
    fn place(
        &self,
        face: u32,
        corner: u32,
        edge: u32,
        [u, v]: [f32; 2],
    ) -> Option<(Line, f32, Side)> {
        let (off, along) = [(v, u), (1.0 - u, v), (1.0 - v, 1.0 - u), (u, 1.0 - v)][edge as usize];
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
        if n == 4 {
            return Some(whole(edge, along));
        }
        let previous = (corner + n - 1) % n;
        Some(match edge {
            0 => whole(corner, 0.5 * along),
            3 => whole(previous, 0.5 + 0.5 * along),
            // From the middle of the edge that leaves the corner to the face's centre.
            1 => (Line::Inner { face, corner }, along, (face, true)),
            _ => (
                Line::Inner {
                    face,
                    corner: previous,
                },
                1.0 - along,
                (face, false),
            ),
        })
    }

    /// Asserts that every side has the same vertices with the same bits. Normals are compared where the limit has only one: across all
    /// edges but infinite creases, and around vertices among the faces of a sector, except at cusps.
    pub fn hold(&self, what: &str) -> Compared {
        let mut compared = Compared::default();
        for (line, sides) in &self.lines {
            self.hold_line(&format!("{what}, {line:?}"), *line, sides, &mut compared);
        }
        for (vertex, corners) in &self.vertices {
            self.hold_vertex(
                &format!("{what}, {vertex:?}"),
                *vertex,
                corners,
                &mut compared,
            );
        }
        compared
    }

    fn hold_line(
        &self,
        what: &str,
        line: Line,
        sides: &BTreeMap<Side, Along>,
        compared: &mut Compared,
    ) {
        let topology = self.model.topology();
        let smooth = match line {
            Line::Inner { .. } => true,
            Line::Edge(a, b) => edge_sharpness(topology, a, b) < INFINITE_SHARPNESS,
        };
        let mut sides = sides.values();
        let first = sides.next().expect("a line has a side");
        for side in sides {
            let places = |side: &Along| side.keys().map(|&t| f32::from_bits(t)).collect::<Vec<_>>();
            assert_eq!(places(side), places(first), "{what}: a T-junction");
            for ((t, a), b) in side.iter().zip(first.values()) {
                let t = f32::from_bits(*t);
                assert_eq!(bits(a.0), bits(b.0), "{what} at {t}: {} and {}", a.0, b.0);
                compared.positions += 1;
                if smooth {
                    assert_eq!(
                        bits(a.1),
                        bits(b.1),
                        "{what} at {t}: normals {} and {}",
                        a.1,
                        b.1
                    );
                    compared.normals += 1;
                }
            }
        }
    }

    fn hold_vertex(
        &self,
        what: &str,
        vertex: Vertex,
        corners: &[AtCorner],
        compared: &mut Compared,
    ) {
        let mut planes: Vec<(TangentPlane, Vec3)> = Vec::new();
        for &((face, corner), position, normal) in corners {
            let first = corners[0].1;
            assert_eq!(
                bits(position),
                bits(first),
                "{what}, face {face}: {position} and {first}"
            );
            compared.positions += 1;
            let plane = match vertex {
                Vertex::Centre(_) => TangentPlane::Vertex,
                Vertex::Control(_) => match self.plane(face, corner) {
                    Some(plane) => plane,
                    None => continue,
                },
            };
            match planes.iter().find(|known| known.0 == plane) {
                None => planes.push((plane, normal)),
                Some((_, known)) => {
                    assert_eq!(
                        bits(normal),
                        bits(*known),
                        "{what}, face {face}: normals {normal} and {known}"
                    );
                    compared.normals += 1;
                }
            }
        }
    }

    /// The tangent plane at a corner, where nothing semi-sharp hides it.
    fn plane(&self, face: u32, corner: u32) -> Option<TangentPlane> {
        let topology = self.model.topology();
        let vertex = topology.face(face)[corner as usize];
        let semi_sharp = |s: f32| s > 0.0 && s < INFINITE_SHARPNESS;
        let hidden = semi_sharp(topology.vertex_sharpness(vertex))
            || topology
                .sharp_edges(vertex)
                .any(|edge| semi_sharp(topology.edge(edge).sharpness));
        (!hidden).then(|| tangent_plane(topology, face, corner))
    }
}

fn edge_sharpness(topology: &Topology, a: u32, b: u32) -> f32 {
    let edges = topology.vertex_edges(a).iter();
    let between = edges
        .map(|&edge| topology.edge(edge))
        .find(|edge| edge.other(a) == b);
    between.expect("a line is an edge").sharpness
}
