//! Random meshes: a sheet, a tube or a torus of quads, changed by random strokes and tagged at random. A recipe shrinks by losing strokes.

use std::f64::consts::TAU;

use glam::DVec3;
use hullform::mesh::{
    BoundaryInterpolation, ControlMesh, ControlMeshBuilder, CreaseMethod, SchemeOptions,
    TriangleSubdivision,
};
use proptest::prelude::*;

/// A change of the faces. Numbers are taken modulo what there is; a stroke that does not fit does nothing.
#[derive(Clone, Debug)]
pub enum Stroke {
    /// Cuts a face in two, from a corner to the next but one.
    Split(u16, u8),
    /// Joins a face with those beyond some of its edges; what gets more than six corners becomes a pole of triangles.
    Merge(u16, u8, u8),
    /// A vertex in the middle of a face, joined to all corners.
    Poke(u16),
    /// A vertex of valence 2 inside a face, between two corners.
    Lens(u16, u8),
    /// More edges at a corner of a face.
    Rays(u16, u8, u8),
    /// Removes a face.
    Delete(u16),
    /// Lets a face begin at another corner.
    Turn(u16, u8),
    /// Reverses a face: its edges are non-manifold.
    Flip(u16),
    /// A further face on an edge.
    Fin(u16, u8),
    /// A closed fan of further faces on a vertex.
    Cone(u16, u8),
}

/// A tag. Numbers are taken modulo what there is.
#[derive(Clone, Debug)]
pub enum Tag {
    /// A crease along so many edges, from an edge of a face on; the second sharpness takes over half-way.
    Crease(u16, u8, u8, f32, f32),
    /// A corner.
    Corner(u16, u8, f32),
    /// A hole.
    Hole(u16),
}

/// How to make a mesh.
#[derive(Clone, Debug)]
pub struct Recipe {
    size: [u32; 2],
    closed: [bool; 2],
    strokes: Vec<Stroke>,
    tags: Vec<Tag>,
    options: SchemeOptions,
}

/// Meshes whose edges have two faces at most, that agree in orientation.
pub fn manifold() -> impl Strategy<Value = Recipe> {
    recipe(manifold_stroke().boxed(), 2..=5)
}

/// Meshes of any kind; grids as narrow as one or two faces may touch themselves.
pub fn wild() -> impl Strategy<Value = Recipe> {
    let stroke = prop_oneof![
        4 => manifold_stroke(),
        1 => any::<u16>().prop_map(Stroke::Flip),
        1 => any::<(u16, u8)>().prop_map(|(f, i)| Stroke::Fin(f, i)),
        1 => any::<(u16, u8)>().prop_map(|(f, i)| Stroke::Cone(f, i)),
    ];
    recipe(stroke.boxed(), 1..=5)
}

fn recipe(
    stroke: BoxedStrategy<Stroke>,
    size: std::ops::RangeInclusive<u32>,
) -> impl Strategy<Value = Recipe> {
    let closed = prop_oneof![Just([false; 2]), Just([true, false]), Just([true; 2])];
    (
        [size.clone(), size],
        closed,
        prop::collection::vec(stroke, 0..7),
        prop::collection::vec(tag(), 0..5),
        options(),
    )
        .prop_map(|(size, closed, strokes, tags, options)| Recipe {
            // A single column cannot close: its faces would name a vertex twice.
            size: [0, 1].map(|i| size[i].max(1 + u32::from(closed[i]))),
            closed,
            strokes,
            tags,
            options,
        })
}

fn manifold_stroke() -> impl Strategy<Value = Stroke> {
    let corner = any::<(u16, u8)>();
    let counted = any::<(u16, u8, u8)>();
    prop_oneof![
        corner.prop_map(|(f, i)| Stroke::Split(f, i)),
        counted.prop_map(|(f, i, n)| Stroke::Merge(f, i, n)),
        any::<u16>().prop_map(Stroke::Poke),
        corner.prop_map(|(f, i)| Stroke::Lens(f, i)),
        counted.prop_map(|(f, i, n)| Stroke::Rays(f, i, n)),
        any::<u16>().prop_map(Stroke::Delete),
        corner.prop_map(|(f, i)| Stroke::Turn(f, i)),
    ]
}

fn tag() -> impl Strategy<Value = Tag> {
    prop_oneof![
        6 => (any::<(u16, u8)>(), 1u8..8, sharpness(), sharpness(), any::<bool>()).prop_map(
            |((f, i), n, s, t, same)| Tag::Crease(f, i, n, s, if same { s } else { t })
        ),
        2 => (any::<(u16, u8)>(), sharpness()).prop_map(|((f, i), s)| Tag::Corner(f, i, s)),
        1 => any::<u16>().prop_map(Tag::Hole),
    ]
}

fn sharpness() -> impl Strategy<Value = f32> {
    prop_oneof![
        1 => Just(0.0),
        1 => Just(2.0),
        4 => 0.1f32..6.0,
        1 => 6.0f32..9.9,
        3 => Just(10.0),
    ]
}

fn options() -> impl Strategy<Value = SchemeOptions> {
    let boundary = prop_oneof![
        1 => Just(BoundaryInterpolation::None),
        3 => Just(BoundaryInterpolation::EdgeOnly),
        3 => Just(BoundaryInterpolation::EdgeAndCorner),
    ];
    (boundary, any::<bool>(), any::<bool>()).prop_map(|(boundary, chaikin, smooth)| SchemeOptions {
        boundary,
        creasing: if chaikin {
            CreaseMethod::Chaikin
        } else {
            CreaseMethod::Uniform
        },
        triangles: if smooth {
            TriangleSubdivision::Smooth
        } else {
            TriangleSubdivision::CatmullClark
        },
        ..SchemeOptions::default()
    })
}

impl Recipe {
    /// The mesh.
    pub fn mesh(&self) -> ControlMesh {
        let mut draft = Draft::grid(self.size, self.closed);
        for stroke in &self.strokes {
            draft.stroke(stroke);
        }
        draft.tagged(&self.tags, self.options)
    }
}

/// Faces and positions while they change.
struct Draft {
    positions: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
}

impl Draft {
    fn grid(size: [u32; 2], closed: [bool; 2]) -> Draft {
        let points = [0, 1].map(|i| size[i] + u32::from(!closed[i]));
        let number = |x: u32, y: u32| x % points[0] + points[0] * (y % points[1]);
        let mut draft = Draft {
            positions: Vec::new(),
            faces: Vec::new(),
        };
        for (y, x) in (0..points[1]).flat_map(|y| (0..points[0]).map(move |x| (y, x))) {
            let turn = |at: u32, i: usize| TAU * f64::from(at) / f64::from(points[i]);
            let (x, y) = match closed {
                [false, _] => (DVec3::X * f64::from(x), DVec3::Y * f64::from(y)),
                [true, false] => (round(turn(x, 0)), DVec3::Z * 0.5 * f64::from(y)),
                _ => {
                    let (sin, cos) = turn(y, 1).sin_cos();
                    (round(turn(x, 0)) * (1.0 + 0.5 * cos), DVec3::Z * 0.5 * sin)
                }
            };
            draft.vertex(x + y);
        }
        for (y, x) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (y, x))) {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
            let face = corners.map(|(i, j)| number(x + i, y + j));
            draft.faces.push(face.to_vec());
        }
        draft
    }

    /// A vertex near `at`: nothing is where symmetry would hide a mistake.
    fn vertex(&mut self, at: DVec3) -> u32 {
        let number = self.positions.len() as u64;
        self.positions.push(at + 0.2 * scatter(number));
        number as u32
    }

    fn middle(&self, face: usize) -> DVec3 {
        let positions = self.faces[face].iter().map(|&v| self.positions[v as usize]);
        positions.sum::<DVec3>() / self.faces[face].len() as f64
    }

    /// A face with its vertices from a corner on.
    fn face(&self, face: u16, corner: u8) -> (usize, Vec<u32>) {
        let face = usize::from(face) % self.faces.len();
        let mut vertices = self.faces[face].clone();
        let arity = vertices.len();
        vertices.rotate_left(usize::from(corner) % arity);
        (face, vertices)
    }

    fn stroke(&mut self, stroke: &Stroke) {
        match *stroke {
            Stroke::Split(face, corner) => self.split(face, corner),
            Stroke::Merge(face, corner, count) => self.merge(face, corner, count),
            Stroke::Poke(face) => {
                let face = self.face(face, 0).0;
                self.poke(face);
            }
            Stroke::Lens(face, corner) => self.lens(face, corner),
            Stroke::Rays(face, corner, count) => self.rays(face, corner, count),
            Stroke::Delete(face) if self.faces.len() > 1 => {
                let face = self.face(face, 0).0;
                self.faces.remove(face);
            }
            Stroke::Delete(_) => {}
            Stroke::Turn(face, corner) => {
                let (face, turned) = self.face(face, corner);
                self.faces[face] = turned;
            }
            Stroke::Flip(face) => {
                let face = self.face(face, 0).0;
                self.faces[face].reverse();
            }
            Stroke::Fin(face, corner) => self.fin(face, corner),
            Stroke::Cone(face, corner) => self.cone(face, corner),
        }
    }

    fn split(&mut self, face: u16, corner: u8) {
        let (face, vertices) = self.face(face, corner);
        if vertices.len() > 3 {
            self.faces[face] = vertices[..3].to_vec();
            self.faces.push([&vertices[2..], &vertices[..1]].concat());
        }
    }

    fn merge(&mut self, face: u16, corner: u8, count: u8) {
        let (mut face, _) = self.face(face, 0);
        for step in 0..1 + count % 4 {
            let [b, a] = {
                let own = &self.faces[face];
                let i = usize::from(corner) + 3 * usize::from(step);
                [own[(i + 1) % own.len()], own[i % own.len()]]
            };
            let follows = |face: &Vec<u32>| {
                (0..face.len()).position(|i| face[i] == b && face[(i + 1) % face.len()] == a)
            };
            let beyond = (0..self.faces.len()).find_map(|f| Some((f, follows(&self.faces[f])?)));
            let Some((other, at)) = beyond else { continue };
            let (mut own, mut joined) = (self.faces[face].clone(), self.faces[other].clone());
            let start = own.iter().position(|&v| v == b).expect("the face has it");
            own.rotate_left(start);
            joined.rotate_left(at + 1);
            own.extend(&joined[1..joined.len() - 1]);
            let mut sorted = own.clone();
            sorted.sort_unstable();
            sorted.dedup();
            if sorted.len() == own.len() && own.len() <= 12 {
                self.faces[face] = own;
                self.faces.remove(other);
                face -= usize::from(other < face);
            }
        }
        if self.faces[face].len() > 6 {
            self.poke(face);
        }
    }

    fn poke(&mut self, face: usize) {
        let middle = self.vertex(self.middle(face));
        let ring = std::mem::take(&mut self.faces[face]);
        let triangle = |i: usize| vec![ring[i], ring[(i + 1) % ring.len()], middle];
        let mut triangles = (0..ring.len()).map(triangle);
        self.faces[face] = triangles.next().expect("a face has corners");
        self.faces.extend(triangles);
    }

    fn lens(&mut self, face: u16, corner: u8) {
        let (face, vertices) = self.face(face, corner);
        if vertices.len() > 3 {
            let middle = self.vertex(self.middle(face));
            let [far, from] = [vertices[2], vertices[0]];
            self.faces[face] = [&vertices[..3], &[middle]].concat();
            self.faces
                .push([&[from, middle, far], &vertices[3..]].concat());
        }
    }

    fn rays(&mut self, face: u16, corner: u8, count: u8) {
        let (face, vertices) = self.face(face, corner);
        let centre = self.middle(face);
        let inner: Vec<u32> = (0..1 + count % 3).map(|_| self.vertex(centre)).collect();
        let [first, .., last] = vertices[1..] else {
            return;
        };
        let rim: Vec<u32> = [&[first], &inner[..], &[last]].concat();
        let outer = vertices[1..].iter().chain(inner.iter().rev()).copied();
        self.faces[face] = outer.collect();
        self.faces.extend(
            rim.windows(2)
                .map(|pair| vec![vertices[0], pair[0], pair[1]]),
        );
    }

    fn fin(&mut self, face: u16, corner: u8) {
        let (_, vertices) = self.face(face, corner);
        let [a, b] = [vertices[0], vertices[1]];
        let out = |draft: &Draft, v: u32| draft.positions[v as usize] + DVec3::new(0.2, 0.3, 1.0);
        let c = self.vertex(out(self, b));
        let d = self.vertex(out(self, a));
        self.faces.push(vec![a, b, c, d]);
    }

    fn cone(&mut self, face: u16, corner: u8) {
        let (_, vertices) = self.face(face, corner);
        let tip = self.positions[vertices[0] as usize];
        let rim: Vec<u32> = (0..6)
            .map(|i| self.vertex(tip + DVec3::Z + 0.5 * round(TAU * f64::from(i) / 6.0)))
            .collect();
        self.faces
            .extend([0, 2, 4].map(|i| vec![vertices[0], rim[i], rim[i + 1], rim[(i + 2) % 6]]));
    }

    fn tagged(&self, tags: &[Tag], options: SchemeOptions) -> ControlMesh {
        let positions: Vec<[f64; 3]> = self.positions.iter().map(DVec3::to_array).collect();
        let sizes: Vec<u32> = self.faces.iter().map(|face| face.len() as u32).collect();
        let mut builder =
            ControlMesh::builder(&positions, &sizes, &self.faces.concat()).options(options);
        for tag in tags {
            builder = match *tag {
                Tag::Crease(face, corner, count, first, second) => {
                    let edges = self.chain(face, corner, count);
                    let half = edges.len().div_ceil(2);
                    (edges.iter().enumerate()).fold(builder, |builder, (i, &[a, b])| {
                        builder.crease(a, b, if i < half { first } else { second })
                    })
                }
                Tag::Corner(face, corner, sharpness) => {
                    builder.corner(self.face(face, corner).1[0], sharpness)
                }
                Tag::Hole(face) => builder.hole(self.face(face, 0).0 as u32),
            };
        }
        builder.build().expect("strokes leave a sound mesh")
    }

    /// Edges one after another, straight on where four quads meet.
    fn chain(&self, face: u16, corner: u8, count: u8) -> Vec<[u32; 2]> {
        let (_, vertices) = self.face(face, corner);
        let mut chain = vec![[vertices[0], vertices[1]]];
        while chain.len() < usize::from(count) {
            let [from, at] = chain[chain.len() - 1];
            let known = |v: u32| v == from || chain.iter().any(|edge| edge.contains(&v));
            // The faces on either side of the way here lead to neighbours that are not straight on.
            let beside = |face: &&Vec<u32>| face.contains(&at) && !face.contains(&from);
            let next = self.faces.iter().filter(beside).find_map(|face| {
                let i = face.iter().position(|&v| v == at).expect("beside has it");
                let next = face[(i + 1) % face.len()];
                (!known(next)).then_some(next)
            });
            let Some(next) = next else { break };
            chain.push([at, next]);
        }
        chain
    }
}

fn round(angle: f64) -> DVec3 {
    DVec3::new(angle.cos(), angle.sin(), 0.0)
}

/// A point of the cube -1..1 that depends on nothing but `number` (splitmix64).
pub fn scatter(number: u64) -> DVec3 {
    let value = |i: u64| {
        let mut x = (3 * number + i + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ x >> 31) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    DVec3::new(value(0), value(1), value(2))
}

/// So many cases, the same in every run unless `PROPTEST_RNG_SEED` is set. What they find becomes a test with a name.
pub fn cases(cases: u32) -> ProptestConfig {
    let mut config = ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = cases;
    }
    if std::env::var_os("PROPTEST_RNG_SEED").is_none() {
        config.rng_seed = proptest::test_runner::RngSeed::Fixed(2016);
    }
    config
}

/// A mesh in the making with the options and tags of another, whose vertices and faces have the same numbers.
pub fn tagged_as(mesh: &ControlMesh, builder: ControlMeshBuilder) -> ControlMesh {
    let mut builder = builder.options(mesh.options());
    for crease in mesh.creases() {
        let [a, b] = crease.vertices;
        builder = builder.crease(a, b, crease.sharpness);
    }
    for corner in mesh.corners() {
        builder = builder.corner(corner.vertex, corner.sharpness);
    }
    for &hole in mesh.holes() {
        builder = builder.hole(hole);
    }
    builder.build().expect("it was sound before")
}
