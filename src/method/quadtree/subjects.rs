//! What has plans of its own beside the insides of patches: edges and vertices, each planned once for all that look alike.

use std::collections::VecDeque;
use std::rc::Rc;

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::method::quadtree::configurations::Configurations;
use crate::method::quadtree::store::Store;
use crate::plan::database::Kind;
use crate::plan::{Database, PlanOptions, Ring, SmoothQuads};

/// An edge of a patch that has a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Line {
    /// An edge of the mesh.
    Edge(u32),
    /// An edge as a face has it for itself, from a corner on, see `hubs.rs`.
    Side { face: u32, corner: u32 },
    /// From the middle of an n-gon's edge to its centre.
    Spoke { face: u32, corner: u32 },
}

/// A corner of a patch that has a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Point {
    Vertex(u32),
    Centre(u32),
    /// A vertex as a face has it for itself, see `hubs.rs`.
    Corner {
        face: u32,
        corner: u32,
    },
}

/// Something that has a plan of its own, and shares it with what looks alike.
pub trait Subject: Copy + Send + Sync {
    fn ring(self, topology: &Topology) -> Ring;
    fn kind(self) -> Kind;
    /// A number of its own.
    fn number(self, topology: &Topology) -> usize;
    /// A number that those share which look alike at first sight; None where that takes a closer look.
    fn looks(self, smooth: &SmoothQuads<'_>) -> Option<u32>;
}

impl Subject for Line {
    fn ring(self, topology: &Topology) -> Ring {
        match self {
            Line::Edge(edge) => Ring::of_edge(topology, edge),
            Line::Side { face, corner } => Ring::of_side(topology, face, corner),
            Line::Spoke { face, corner } => Ring::from_corner(topology, face, corner),
        }
        .expect("lines are the topology's own")
    }

    fn kind(self) -> Kind {
        match self {
            Line::Edge(_) | Line::Side { .. } => Kind::Edge,
            Line::Spoke { .. } => Kind::Spoke,
        }
    }

    fn number(self, topology: &Topology) -> usize {
        match self {
            Line::Edge(edge) => edge as usize,
            Line::Spoke { face, corner } => {
                topology.edge_count() + topology.side(face, corner) as usize
            }
            Line::Side { face, corner } => {
                let spokes = topology.shared_faces().vertices().len();
                topology.edge_count() + spokes + topology.side(face, corner) as usize
            }
        }
    }

    fn looks(self, _: &SmoothQuads<'_>) -> Option<u32> {
        None
    }
}

impl Subject for Point {
    fn ring(self, topology: &Topology) -> Ring {
        match self {
            Point::Vertex(vertex) => Ring::of_vertex(topology, vertex),
            Point::Centre(face) => Ring::from_corner(topology, face, 0),
            Point::Corner { face, corner } => Ring::of_corner(topology, face, corner),
        }
        .expect("points are the topology's own")
    }

    fn kind(self) -> Kind {
        match self {
            Point::Vertex(_) | Point::Corner { .. } => Kind::Vertex,
            Point::Centre(_) => Kind::Centre,
        }
    }

    fn number(self, topology: &Topology) -> usize {
        match self {
            Point::Vertex(vertex) => vertex as usize,
            Point::Centre(face) => topology.vertex_count() + face as usize,
            Point::Corner { face, corner } => {
                let others = topology.vertex_count() + topology.face_count();
                others + topology.side(face, corner) as usize
            }
        }
    }

    fn looks(self, smooth: &SmoothQuads<'_>) -> Option<u32> {
        match self {
            Point::Vertex(vertex) if smooth.is_simple_star(vertex) => {
                smooth.valence(vertex).map(|valence| valence as u32)
            }
            _ => None,
        }
    }
}

/// A subject's plan and ring.
pub struct Known {
    /// The number of its plan in the store.
    pub plan: u32,
    /// Its ring, which is not kept of what looks alike at first sight, and where it is long: around poles and n-gons rings take the square of these.
    pub ring: Option<Box<Ring>>,
}

/// Longer rings are found anew where they are needed.
pub const LONG: usize = 1 << 8;

/// Subjects of one kind, each once.
pub struct Subjects<S> {
    all: Vec<S>,
    /// Of each subject, by its number, where it stands there.
    places: Vec<u32>,
}

impl<S: Subject> Subjects<S> {
    /// None.
    pub fn new() -> Subjects<S> {
        Subjects {
            all: Vec::new(),
            places: Vec::new(),
        }
    }

    /// Adds one, unless it is there.
    pub fn add(&mut self, topology: &Topology, subject: S) {
        let number = subject.number(topology);
        if number >= self.places.len() {
            let size = (number + 1).next_power_of_two();
            self.places.resize(size, NONE);
        }
        if self.places[number] == NONE {
            self.places[number] = self.all.len() as u32;
            self.all.push(subject);
        }
    }
}

/// The rings and plans of subjects of one kind.
pub struct Shared {
    known: Vec<Known>,
    /// As in [`Subjects`].
    places: Vec<u32>,
}

impl Shared {
    pub fn new<S: Subject>(
        smooth: &SmoothQuads<'_>,
        subjects: Subjects<S>,
        store: &mut Store,
        options: PlanOptions,
        database: &Database,
    ) -> Result<Shared> {
        let topology = smooth.topology();
        let Subjects { all, places } = subjects;
        let looks: Vec<Option<u32>> = all
            .par_iter()
            .map(|subject| subject.looks(smooth))
            .collect();
        let mut wanted = Configurations::default();
        let mut plan_of_looks = FxHashMap::default();
        let mut known = Vec::with_capacity(all.len());
        // What rings tell is there as long as they are not known to be alike: around poles and in n-gons it is much.
        for (subjects, looks) in all.chunks(AT_A_TIME).zip(looks.chunks(AT_A_TIME)) {
            let rings = subjects.par_iter().zip(looks);
            let rings = rings
                .map(|(subject, looks)| looks.is_none().then(|| Box::new(subject.ring(topology))));
            let rings: Vec<Option<Box<Ring>>> = rings.collect();
            for ((subject, looks), mut ring) in subjects.iter().zip(looks).zip(rings) {
                let mut plan_of = |ring: &mut Ring| {
                    let configuration = std::mem::take(&mut ring.configuration);
                    wanted.number(subject.kind(), configuration)
                };
                let plan = match (&mut ring, looks) {
                    (Some(ring), _) => plan_of(ring),
                    (None, looks) => *plan_of_looks
                        .entry(*looks)
                        .or_insert_with(|| plan_of(&mut subject.ring(topology))),
                };
                let ring = ring.filter(|ring| ring.vertices.len() <= LONG);
                known.push(Known { plan, ring });
            }
        }
        let numbers = store.plans(wanted, options, database)?;
        for known in &mut known {
            known.plan = numbers[known.plan as usize];
        }
        Ok(Shared { known, places })
    }

    /// What is known of a subject that has a plan.
    pub fn get(&self, topology: &Topology, subject: impl Subject) -> Option<&Known> {
        let &place = self.places.get(subject.number(topology))?;
        (place != NONE).then(|| &self.known[place as usize])
    }
}

/// Long rings, of which the last are kept: one patch after another in an n-gon needs the same.
#[derive(Default)]
pub struct LongRings(VecDeque<(Kind, usize, Rc<Ring>)>);

impl LongRings {
    /// The ring of a subject.
    pub fn get(&mut self, topology: &Topology, subject: impl Subject) -> Rc<Ring> {
        let (kind, number) = (subject.kind(), subject.number(topology));
        let is_it = |known: &&(Kind, usize, Rc<Ring>)| (known.0, known.1) == (kind, number);
        if let Some((.., ring)) = self.0.iter().find(is_it) {
            return ring.clone();
        }
        let ring = Rc::new(subject.ring(topology));
        self.0.truncate(FEW - 1);
        self.0.push_front((kind, number, ring.clone()));
        ring
    }
}

/// So many long rings are kept: a patch has four edges and four corners.
const FEW: usize = 16;

/// So many rings are on their way at a time.
const AT_A_TIME: usize = 1 << 8;

/// Instead of a place: there is none.
const NONE: u32 = u32::MAX;
