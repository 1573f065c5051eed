//! Vertices with the edges around them as spokes: the limit there, a tangent along each edge, and what both faces of an edge have across it. `gregory` and
//! `acc` are made of these.
//!
//! **Tangents.** Around a smooth vertex t(i - 1) + t(i + 1) = 2 c t(i), where c is the cosine of 2 pi / n inside, and of pi / k where k faces lie at a boundary.
//! Along an edge from a to b both surfaces have the tangent u, a quadratic from t at a to minus t at b. The derivative across it is v on one side and v' on the
//! other, cubics, and both planes are one (G1) if v + v' is u times a linear function (Loop, Schaefer 2008). So v = m u + x and v' = m' u - x, where x
//! belongs to the edge: its *field*. At the ends it follows from the tangents, and the normal on the edge is u x x for both faces, to the last bit.

pub mod edge;
pub mod ring;

use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::{Error, Place, Result};
use crate::mesh::Model;
use crate::mesh::sharpness::{is_infinite, is_sharp};
use crate::mesh::topology::Topology;
use crate::method::points::{Points, Row};
use crate::method::vertices;
use crate::method::{Pass, Prepared, Table, patches};
use crate::subdivision::Mask;
use edge::Edge;
use ring::Ring;

/// Which patches are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Gregory patches (Loop, Schaefer, Ni, Castano 2009).
    Gregory,
    /// Bicubic patches with tangent patches (Loop, Schaefer 2008).
    Bicubic,
}

/// The faces at a vertex that tangents are summed over: each of n edges has a sum over all n.
const MOST_FACES: usize = 512;

/// Refuses what has no tangents as these methods need them.
///
/// # Errors
/// [`Error::Input`] with a face, an edge or a vertex: faces that the scheme takes in parts, creases, sharp vertices, vertices where several surfaces touch, of two
/// edges inside, or of too many.
pub fn check(model: &Model) -> Result<()> {
    vertices::whole_faces(model)?;
    let (topology, scheme) = (model.topology(), model.mesh().options().scheme);
    let mut seen = vec![false; topology.vertex_count()];
    for face in (0..topology.face_count() as u32).filter(|&face| !topology.is_hole(face)) {
        for (corner, &vertex) in (0..).zip(topology.face(face)) {
            if std::mem::replace(&mut seen[vertex as usize], true) {
                continue;
            }
            let around = topology.vertex_faces(vertex);
            let parted = around
                .iter()
                .find(|at| !scheme.is_whole(topology.face(at.face).len()));
            if let Some(at) = parted {
                return Err(Error::input(
                    Place::Face(at.face as usize),
                    "a hole that its scheme takes in parts touches faces that are drawn",
                    "cut it into faces that the scheme takes whole, or choose another method",
                ));
            }
            check_edges(topology, vertex)?;
            check_vertex(topology, face, corner, vertex)?;
        }
    }
    Ok(())
}

fn check_edges(topology: &Topology, vertex: u32) -> Result<()> {
    let edges = topology.vertex_edges(vertex).iter();
    let creased = |&&edge: &&u32| {
        topology.edge_faces(edge).len() > 1 && is_sharp(topology.edge(edge).sharpness)
    };
    let Some(&edge) = edges.clone().find(creased) else {
        return Ok(());
    };
    let [a, b] = topology.edge(edge).vertices;
    Err(Error::input(
        Place::Edge(a as usize, b as usize),
        "it is a crease, or faces meet there that do not fit together; these patches are smooth across every edge",
        "choose a method that does creases (quadtree, qas), or remove the tag",
    ))
}

fn check_vertex(topology: &Topology, face: u32, corner: u32, vertex: u32) -> Result<()> {
    let faces = topology.vertex_faces(vertex).len();
    let refuse = |problem: String, remedy: &str| {
        Err(Error::input(
            Place::Vertex(vertex as usize),
            problem,
            remedy,
        ))
    };
    if faces > MOST_FACES {
        let problem = format!(
            "{faces} faces meet there, and each of its edges has a tangent that is a sum over all of them: no more than {MOST_FACES} will be summed"
        );
        return refuse(problem, "divide the fan, or choose another method");
    }
    let fan = topology.fan(face, corner);
    if fan.faces.len() != faces {
        return refuse(
            "several surfaces touch there".into(),
            "give each a vertex of its own, or choose another method",
        );
    }
    if fan.closed && faces < 3 {
        return refuse(
            format!("{faces} faces close around it, and tangents of so few edges span no plane"),
            "remove the vertex, or choose another method",
        );
    }
    let sharpness = topology.vertex_sharpness(vertex);
    if is_sharp(sharpness) && !(faces == 1 && is_infinite(sharpness)) {
        return refuse(
            "it is a sharp corner, and these patches are smooth there".into(),
            "choose a method that does corners (quadtree, qas), or remove the tag",
        );
    }
    Ok(())
}

/// Vertices, edges and their points.
pub struct Spokes<'a> {
    topology: &'a Topology,
    family: Family,
    /// By vertex; None where no face is drawn.
    rings: Vec<Option<Ring>>,
    /// How they are computed: points of vertices first, then those of edges.
    pub points: Points,
    /// The first point of each edge, and the vertex that the edge begins with.
    edges: FxHashMap<u32, (u32, u32)>,
}

impl<'a> Spokes<'a> {
    /// Of a model that [`check`] lets through.
    pub fn new(model: &'a Model, family: Family) -> Spokes<'a> {
        let (topology, scheme) = (model.topology(), model.mesh().options().scheme);
        let mut spokes = Spokes {
            topology,
            family,
            rings: vec![None; topology.vertex_count()],
            points: Points::default(),
            edges: FxHashMap::default(),
        };
        let drawn = || (0..topology.face_count() as u32).filter(|&face| !topology.is_hole(face));
        for face in drawn() {
            for (corner, &vertex) in (0..).zip(topology.face(face)) {
                let ring = &mut spokes.rings[vertex as usize];
                ring.get_or_insert_with(|| Ring::new(topology, scheme, face, corner));
            }
        }
        spokes.push_vertices();
        spokes.points.begin(abi::POINTS_BLEND, spokes.points.count);
        for face in drawn() {
            for (side, &edge) in topology.face_edges(face).iter().enumerate() {
                if !spokes.edges.contains_key(&edge) {
                    spokes.push_edge(edge, topology.face(face)[side]);
                }
            }
        }
        spokes
    }

    fn push_vertices(&mut self) {
        let points = &mut self.points;
        points.begin(abi::POINTS_LIMIT, 0);
        for (vertex, ring) in (0..).zip(&self.rings) {
            let Some(ring) = ring else {
                let (itself, nothing) = (Mask::from_slice(&[(vertex, 1.0)]), Mask::new());
                points.push(Row::Limit([&itself, &nothing, &nothing]));
                continue;
            };
            let [du, dv] = ring.plane();
            points.push(Row::Limit([&ring.limit, &du, &dv]));
        }
    }

    fn push_edge(&mut self, edge: u32, from: u32) {
        let to = self.topology.edge(edge).other(from);
        let first = self.points.count;
        let ring = |vertex: u32| self.rings[vertex as usize].as_ref();
        let ends = [from, to].map(|vertex| ring(vertex).expect("faces are drawn there"));
        let masks = Edge::new(self.topology, self.family, edge, ends).masks();
        for mask in &masks {
            self.points.push(Row::Blend(mask));
        }
        self.edges.insert(edge, (first, from));
    }

    fn ring(&self, vertex: u32) -> &Ring {
        let ring = self.rings[vertex as usize].as_ref();
        ring.expect("faces that are drawn have rings at their corners")
    }

    /// The control points of a face: its corners; then for each edge, as the face runs, the point next to its beginning, the field from there on, and the point
    /// next to its end. Where the numbers fall along an edge the face runs against it, and its fields are the negative ones. And the cosine of each corner.
    pub fn of(&self, face: u32) -> (Vec<u32>, [f32; 4]) {
        let vertices = self.topology.face(face);
        let mut numbers = vertices.to_vec();
        let count = self.family.points_an_edge();
        for (&edge, &vertex) in self.topology.face_edges(face).iter().zip(vertices) {
            let (first, from) = self.edges[&edge];
            let block = first..first + count;
            if from == vertex {
                numbers.extend(block);
            } else {
                numbers.extend(block.rev());
            }
        }
        let mut cosines = [0.0; 4];
        for (cosine, &vertex) in cosines.iter_mut().zip(vertices) {
            *cosine = self.ring(vertex).cosine as f32;
        }
        (numbers, cosines)
    }

    /// The point of a bicubic patch inside of a quad, next to its corner (Loop, Schaefer 2008).
    pub fn inner(&self, face: u32, corner: u32) -> Mask {
        let ring = self.ring(self.topology.face(face)[corner as usize]);
        ring.inner(ring.place_of_edge(self.topology.face_edges(face)[corner as usize]))
    }

    /// Fills the passes, a patch a face, each in that of its domain. `more` adds control points of a face.
    pub fn fill<const N: usize>(
        mut self,
        model: &Model,
        mut passes: [Pass; N],
        more: impl Fn(&mut Spokes<'a>, u32) -> Vec<u32>,
    ) -> Prepared {
        let mut cosines = vec![Vec::new(); N];
        for part in patches::parts(model) {
            let place = passes.iter().position(|pass| pass.domain == part.domain);
            let place = place.expect("every domain has its pass");
            let (mut numbers, own) = self.of(part.face);
            numbers.extend(more(&mut self, part.face));
            vertices::add(&mut passes[place], model, part, &numbers, 0);
            let patch = passes[place].patches.last_mut();
            patch.expect("it was just added").plan = cosines[place].len() as u32;
            cosines[place].push(own);
        }
        for (pass, cosines) in passes.iter_mut().zip(&cosines) {
            pass.tables = vec![Table::of(cosines)];
        }
        Prepared {
            points: self.points,
            ..Prepared::of(passes)
        }
    }
}

impl Family {
    /// The points of an edge: next to its ends, and its field; of bicubic patches the tangents at its ends stand around that.
    pub fn points_an_edge(self) -> u32 {
        match self {
            Family::Gregory => 6,
            Family::Bicubic => 8,
        }
    }
}

/// A weighted sum of masks, each vertex once.
pub fn sum(parts: &[(f64, &Mask)]) -> Mask {
    let scaled = |&(scale, mask): &(f64, &Mask)| {
        let scaled = mask
            .iter()
            .map(move |&(vertex, weight)| (vertex, scale * weight));
        scaled.collect::<Vec<_>>()
    };
    let mut terms: Vec<(u32, f64)> = parts.iter().flat_map(scaled).collect();
    terms.sort_by_key(|&(vertex, _)| vertex);
    terms.dedup_by(|next, sum| {
        let alike = next.0 == sum.0;
        if alike {
            sum.1 += next.1;
        }
        alike
    });
    // Sines of whole turns are not quite zero.
    terms.retain(|(_, weight)| weight.abs() > 1e-14);
    terms.into_iter().collect()
}

#[cfg(test)]
pub mod tests;
