//! Where a vertex ends up under endless refinement, and the tangents there: left eigenvectors of the subdivision matrix.
//!
//! Smooth vertices: Halstead, Kass, DeRose 1993, appendix A. Creases: Biermann, Levin, Zorin 2000, appendix A. Loop's rules have the same
//! modes around a vertex as Catmull and Clark's, without face points and with eigenvalues 3/8 + cos / 4; so one text serves both. An infinitely sharp
//! crease that ends inside (a dart) changes the matrix of its end, and no closed form is known to us: the eigenvectors are iterated.

mod corner;
mod dart;

use std::f64::consts::PI;

use crate::mesh::Scheme;
use crate::mesh::sharpness::{Rule, is_infinite, is_semi_sharp, rule};
use crate::mesh::topology::{Fan, Topology};
use crate::subdivision::masks::Mask;
use crate::subdivision::schemes::neighbour_weight;

/// Limit position and two tangents of a vertex, as masks over the vertices of a topology.
///
/// The tangents span the limit's tangent plane as seen from the asking face, and their cross product points to the side from which the
/// face's vertices run counter-clockwise. At regular vertices they are dP/du and dP/dv of the face; elsewhere only their plane counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LimitStencil {
    /// Limit position; weights sum to 1.
    pub position: Mask,
    /// First tangent; weights sum to 0.
    pub du: Mask,
    /// Second tangent; weights sum to 0.
    pub dv: Mask,
}

/// What kind of faces surround a vertex, and so which modes there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// Quads under Catmull and Clark's rules.
    Quads,
    /// Triangles under Loop's.
    Triangles,
}

/// The Catmull-Clark limit at `corner` of `face`, or None while a semi-sharp feature at the vertex or a face that is no quad asks for
/// refinement, and where there is no such corner. [`vertex_limit`](crate::subdivision::vertex_limit) does the same for any scheme.
pub fn limit_stencil(topology: &Topology, face: u32, corner: u32) -> Option<LimitStencil> {
    let vertex = topology.face(face).get(corner as usize);
    if let Some(hub) = vertex.and_then(|&vertex| topology.hub_at(vertex)) {
        return Some(LimitStencil {
            position: Mask::from_slice(&[(hub.limit(), 1.0)]),
            du: Mask::new(),
            dv: Mask::new(),
        });
    }
    family_stencil(topology, face, corner, Family::Quads)
}

/// The limit at `corner` of `face` when all faces around belong to a family and nothing is semi-sharp. Of triangles there is none at an interior
/// vertex of valence 2, and in some non-manifold places, see [`Ring::has_mask`].
pub(super) fn family_stencil(
    topology: &Topology,
    face: u32,
    corner: u32,
    family: Family,
) -> Option<LimitStencil> {
    let &vertex = topology.face(face).get(corner as usize)?;
    let mut sharp = 0;
    for edge in topology.sharp_edges(vertex) {
        if is_semi_sharp(topology.edge(edge).sharpness) {
            return None;
        }
        sharp += 1;
    }
    let sharpness = topology.vertex_sharpness(vertex);
    let fan = topology.fan(face, corner);
    let arity = match family {
        Family::Quads => 4,
        Family::Triangles => 3,
    };
    if is_semi_sharp(sharpness)
        || fan
            .faces
            .iter()
            .any(|&face| topology.face(face).len() != arity)
    {
        return None;
    }
    let ring = Ring {
        topology,
        fan,
        family,
    };
    let rule = rule(sharpness, sharp);
    if !ring.has_mask(rule) {
        return None;
    }
    let own = match rule {
        Rule::Smooth if ring.fan.edges.len() == 2 => ring.valence_two(),
        Rule::Smooth => ring.smooth(),
        Rule::Crease => ring.crease(),
        Rule::Corner => ring.corner(),
        Rule::Dart => ring.dart(),
    };
    Some(match family {
        Family::Quads => own.turned(corner),
        Family::Triangles => LimitStencil::of_triangle(own.position, own.du, own.dv, corner),
    })
}

/// Which of the faces around a vertex share a tangent plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TangentPlane {
    /// All of them.
    Vertex,
    /// Those of a sector between two infinite creases, which begins with this face.
    Sector(u32),
    /// At a cusp each face has its own.
    Face(u32),
}

/// Who shares the tangent plane of the limit at `corner` of `face`. A semi-sharp feature has no say: it is gone in the limit.
pub fn tangent_plane(topology: &Topology, face: u32, corner: u32) -> TangentPlane {
    let vertex = topology.face(face)[corner as usize];
    let sharp = topology.sharp_edges(vertex);
    let sharp = sharp.filter(|&edge| is_infinite(topology.edge(edge).sharpness));
    let sharpness = Some(topology.vertex_sharpness(vertex)).filter(|&own| is_infinite(own));
    match rule(sharpness.unwrap_or_default(), sharp.count()) {
        Rule::Smooth | Rule::Dart => TangentPlane::Vertex,
        Rule::Crease => TangentPlane::Sector(topology.fan(face, corner).faces[0]),
        Rule::Corner => TangentPlane::Face(face),
    }
}

/// Two directions for a sector whose own tangents may cancel, or None for other planes: where both ends of its crease are in one place, as at the end
/// of a slit, the crease has no direction there. These are the edges' wave once around, as if its faces closed.
pub fn closing_tangents(topology: &Topology, face: u32, corner: u32) -> Option<[Mask; 2]> {
    let fan = topology.fan(face, corner);
    let k = fan.faces.len();
    let sector = matches!(
        tangent_plane(topology, face, corner),
        TangentPlane::Sector(_)
    );
    if !sector || k < 3 {
        return None;
    }
    let wave = |f: fn(f64) -> f64| -> Mask {
        let end = |i: usize| topology.edge(fan.edges[i]).other(fan.vertex);
        (0..k)
            .map(|i| (end(i), f(2.0 * PI * i as f64 / k as f64)))
            .collect()
    };
    Some([wave(f64::cos), wave(f64::sin)])
}

/// Whether no tangent plane is promised at `corner` of `face` between several faces, as refinement may turn their edges into one direction, on whichever
/// side: of the butterfly at boundaries and creases, of Loop-Stam between triangles and other faces, and where two triangles close. There the limit's
/// tangents count only if the surroundings have a normal like theirs.
pub fn is_unpromised(topology: &Topology, scheme: Scheme, face: u32, corner: u32) -> bool {
    let Fan { faces, closed, .. } = topology.fan(face, corner);
    let is_triangle = |&&face: &&u32| topology.face(face).len() == 3;
    let triangles = faces.iter().filter(is_triangle).count();
    let close = closed && faces.len() == 2;
    match scheme {
        Scheme::CatmullClark | Scheme::Bilinear => false,
        Scheme::Loop => close,
        Scheme::Butterfly => close || !closed,
        Scheme::LoopStam => triangles > 0 && (close || triangles < faces.len()),
    }
}

/// Whether the limit has a cusp at `corner` of `face`: each face of the [`fan_at`](Topology::fan_at) has a tangent plane of its own. A semi-sharp feature
/// has no say: it is gone in the limit. There is none where there is no such corner.
pub fn is_cusp(topology: &Topology, face: u32, corner: u32) -> bool {
    let Some(&vertex) = topology.face(face).get(corner as usize) else {
        return false;
    };
    let infinite = topology.sharp_edges(vertex);
    let infinite = infinite.filter(|&edge| is_infinite(topology.edge(edge).sharpness));
    is_infinite(topology.vertex_sharpness(vertex)) || infinite.count() > 2
}

impl LimitStencil {
    /// From tangents towards the next and the previous vertex of a triangle's corner to its derivatives, (0,0) being vertex 0, (1,0) vertex 1 and
    /// (0,1) vertex 2.
    pub(super) fn of_triangle(position: Mask, next: Mask, previous: Mask, corner: u32) -> Self {
        let (du, dv) = match corner {
            0 => (next, previous),
            1 => {
                let dv = difference(&next, &previous);
                (negated(previous), dv)
            }
            _ => (difference(&previous, &next), negated(next)),
        };
        LimitStencil { position, du, dv }
    }

    /// From the frame of a corner, whose u runs to the next vertex and v to the previous one, to that of the face.
    fn turned(self, corner: u32) -> LimitStencil {
        let LimitStencil { position, du, dv } = self;
        let (du, dv) = match corner {
            0 => (du, dv),
            1 => (negated(dv), du),
            2 => (negated(du), negated(dv)),
            _ => (dv, negated(du)),
        };
        LimitStencil { position, du, dv }
    }
}

fn negated(mask: Mask) -> Mask {
    mask.into_iter()
        .map(|(vertex, weight)| (vertex, -weight))
        .collect()
}

/// a - b.
fn difference(a: &Mask, b: &Mask) -> Mask {
    let minus = b.iter().map(|&(vertex, weight)| (vertex, -weight));
    a.iter().copied().chain(minus).collect()
}

/// A fan of quads or triangles: its middle, the far ends of its edges and, of quads, the far corners of its faces.
struct Ring<'a> {
    topology: &'a Topology,
    fan: Fan,
    family: Family,
}

impl Ring<'_> {
    /// How much more than its faces an edge weighs in a mode of frequency `angle` around the vertex; triangles have edges alone.
    fn edge_weight(&self, angle: f64) -> f64 {
        match self.family {
            Family::Quads => {
                1.0 + angle.cos() + (angle / 2.0).cos() * (2.0 * (9.0 + angle.cos())).sqrt()
            }
            Family::Triangles => 1.0,
        }
    }

    /// What a face weighs in a mode.
    fn face_weight(&self) -> f64 {
        match self.family {
            Family::Quads => 1.0,
            Family::Triangles => 0.0,
        }
    }

    /// By what a mode of frequency `angle` contracts in one refinement (Halstead, Kass, DeRose 1993, appendix A; Loop 1987).
    fn eigenvalue(&self, angle: f64) -> f64 {
        match self.family {
            Family::Quads => {
                let root = (2.0 * (9.0 + angle.cos())).sqrt();
                (5.0 + angle.cos() + (angle / 2.0).cos() * root) / 16.0
            }
            Family::Triangles => 0.375 + 0.25 * angle.cos(),
        }
    }

    /// What a sector's mode takes from the sharp edge 0 in one step: edge 1 takes 1/16 and face 0 1/4; of triangles edge 1 takes 1/8.
    fn fed(&self, angle: f64) -> f64 {
        match self.family {
            Family::Quads => (self.edge_weight(angle) / 16.0 + 0.25) * angle.sin(),
            Family::Triangles => 0.125 * angle.sin(),
        }
    }

    /// Scales a wave's mask so that among regular faces it is a derivative.
    fn wave_scale(&self) -> f64 {
        let n = self.faces() as f64;
        match self.family {
            Family::Quads => 1.0 / (3.0 * n),
            Family::Triangles => 2.0 / n,
        }
    }

    /// Whether a mask is known. Of triangles there is none where they close around an interior vertex of valence 2, and where few of
    /// them begin and end at one and the same sharp edge: too many modes contract alike there.
    fn has_mask(&self, rule: Rule) -> bool {
        let n = self.faces();
        let closed = self.fan.closed;
        match (self.family, rule) {
            (Family::Quads, _) | (_, Rule::Crease) => true,
            (_, Rule::Smooth | Rule::Dart) => n > 2,
            (_, Rule::Corner) => closed || self.fan.edges[0] != self.fan.edges[n] || n > 6,
        }
    }

    fn middle(&self) -> u32 {
        self.fan.vertex
    }

    fn faces(&self) -> usize {
        self.fan.faces.len()
    }

    /// The far end of edge i; a closed fan's edges come round again.
    fn end(&self, i: usize) -> u32 {
        self.topology
            .edge(self.fan.edges[i % self.fan.edges.len()])
            .other(self.middle())
    }

    /// The vertex of face i opposite to the middle, in a quad.
    fn far(&self, i: usize) -> u32 {
        let face = self.topology.face(self.fan.faces[i]);
        let corner = face
            .iter()
            .position(|&vertex| vertex == self.middle())
            .expect("the fan's faces touch its vertex");
        face[(corner + 2) % 4]
    }

    /// Interior, no sharp edge: (n^2, 4, 1) / (n (n + 5)), or (3 / (8 w), 1) / (3 / (8 w) + n) with Loop's weight w of a neighbour; the
    /// tangents belong to the double eigenvalue of frequency 1.
    fn smooth(&self) -> LimitStencil {
        let n = self.faces();
        let count = n as f64;
        let (own, edge, face) = match self.family {
            Family::Quads => (count * count, 4.0, 1.0),
            Family::Triangles => (0.375 / neighbour_weight(n), 1.0, 0.0),
        };
        let whole = own + count * (edge + face);
        let mut position = Mask::from_slice(&[(self.middle(), own / whole)]);
        for i in 0..n {
            position.push((self.end(i), edge / whole));
            if self.family == Family::Quads {
                position.push((self.far(i), face / whole));
            }
        }
        let tangent =
            |towards: usize| self.harmonic(|i| (2.0 * PI * (i - towards as f64) / count).cos());
        LimitStencil {
            position,
            du: tangent(self.fan.at),
            dv: tangent(self.fan.at + 1),
        }
    }

    /// Adds weight A f(i) at edge i and, of quads, f(i) + f(i + 1) at face i.
    fn add_wave(&self, mask: &mut Mask, angle: f64, scale: f64, f: impl Fn(f64) -> f64) {
        let edge = self.edge_weight(angle);
        for i in 0..self.faces() {
            let (here, next) = (f(i as f64), f(i as f64 + 1.0));
            mask.push((self.end(i), edge * here * scale));
            if self.family == Family::Quads {
                mask.push((self.far(i), (here + next) * scale));
            }
        }
    }

    /// The tangent mask with weight A f(i) at edge i and f(i) + f(i + 1) at face i, scaled so that n = 4 (6 triangles) gives the derivative.
    fn harmonic(&self, f: impl Fn(f64) -> f64) -> Mask {
        let n = self.faces();
        let angle = 2.0 * PI / n as f64;
        let mut mask = Mask::new();
        self.add_wave(&mut mask, angle, self.wave_scale(), f);
        mask
    }

    /// Valence 2. The position is that of the general formula. The general tangents vanish: edges and faces decouple, and both
    /// antisymmetric modes e0 - e1 and f0 - f1 have eigenvalue 1/4. A symmetric mode has -1/4, so the tangent plane swings from
    /// level to level about the plane of those two, which is the one given.
    fn valence_two(&self) -> LimitStencil {
        let (first, second) = (self.fan.at, self.fan.at + 1);
        let across = |sign: f64| {
            Mask::from_slice(&[
                (self.end(first), 0.25),
                (self.end(second), -0.25),
                (self.far(first), 0.25 * sign),
                (self.far(second % 2), -0.25 * sign),
            ])
        };
        LimitStencil {
            du: across(1.0),
            dv: negated(across(-1.0)),
            ..self.smooth()
        }
    }

    /// Two infinitely sharp edges: the cubic B-spline of the crease, and the sine mode of the k faces on this side across it.
    fn crease(&self) -> LimitStencil {
        let k = self.faces();
        let (first, last) = (self.end(0), self.end(k));
        let position = Mask::from_slice(&[
            (self.middle(), 4.0 / 6.0),
            (first, 1.0 / 6.0),
            (last, 1.0 / 6.0),
        ]);
        if k == 1 {
            // A single face: the tangent plane is that of its two edges (the sum of the edges, a mode of 1/4, dominates across).
            return LimitStencil {
                position,
                ..self.corner()
            };
        }
        let across = self.across_crease(k);
        let tangent = |angle: f64| {
            let mut mask =
                Mask::from_slice(&[(first, 0.5 * angle.cos()), (last, -0.5 * angle.cos())]);
            mask.extend(
                across
                    .iter()
                    .map(|&(vertex, weight)| (vertex, weight * angle.sin())),
            );
            mask
        };
        let step = PI / k as f64;
        LimitStencil {
            position,
            du: tangent(self.fan.at as f64 * step),
            dv: tangent((self.fan.at + 1) as f64 * step),
        }
    }

    /// The sine mode of k faces beside a crease. Inside it is that of any vertex; the weight b of the crease's two ends follows from their
    /// column of the matrix, (eigenvalue - 1/2) b = middle / 8 + fed, and that of the middle from the sum of zero.
    /// For k = 2 quads these are the weights (-4, -1, -1, 4, 1, 1) / 6 of the B-spline's derivative.
    fn across_crease(&self, k: usize) -> Mask {
        let angle = PI / k as f64;
        let edge = self.edge_weight(angle);
        let inside = (edge + 2.0 * self.face_weight()) / (angle / 2.0).tan();
        let end = (self.fed(angle) - inside / 8.0) / (self.eigenvalue(angle) - 0.25);
        let scale = self.wave_scale();
        let mut mask = Mask::from_slice(&[
            (self.middle(), -(2.0 * end + inside) * scale),
            (self.end(0), end * scale),
            (self.end(k), end * scale),
        ]);
        self.add_wave(&mut mask, angle, scale, |i| (i * angle).sin());
        mask
    }
}
