//! What has plans of its own beside the insides of patches: edges and vertices, each planned once for all that look alike.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::method::quadtree::store::Store;
use crate::plan::database::Kind;
use crate::plan::{Database, PlanOptions, Ring, SmoothQuads};

/// An edge of a patch that has a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Line {
    /// An edge of the mesh.
    Edge(u32),
    /// From the middle of an n-gon's edge to its centre.
    Spoke { face: u32, corner: u32 },
}

/// A corner of a patch that has a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Point {
    Vertex(u32),
    Centre(u32),
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
            Line::Spoke { face, corner } => Ring::from_corner(topology, face, corner),
        }
        .expect("lines are the topology's own")
    }

    fn kind(self) -> Kind {
        match self {
            Line::Edge(_) => Kind::Edge,
            Line::Spoke { .. } => Kind::Spoke,
        }
    }

    fn number(self, topology: &Topology) -> usize {
        match self {
            Line::Edge(edge) => edge as usize,
            Line::Spoke { face, corner } => {
                topology.edge_count() + topology.side(face, corner) as usize
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
        }
        .expect("points are the topology's own")
    }

    fn kind(self) -> Kind {
        match self {
            Point::Vertex(_) => Kind::Vertex,
            Point::Centre(_) => Kind::Centre,
        }
    }

    fn number(self, topology: &Topology) -> usize {
        match self {
            Point::Vertex(vertex) => vertex as usize,
            Point::Centre(face) => topology.vertex_count() + face as usize,
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
    /// Its ring, which is not kept of what looks alike at first sight.
    pub ring: Option<Box<Ring>>,
}

/// The rings and plans of subjects of one kind.
pub struct Shared {
    known: Vec<Known>,
    /// Of each subject, by its number, where it stands there.
    places: Vec<u32>,
}

impl Shared {
    pub fn new<S: Subject>(
        topology: &Topology,
        smooth: &SmoothQuads<'_>,
        subjects: impl Iterator<Item = S>,
        store: &mut Store,
        options: PlanOptions,
        database: &Database,
    ) -> Result<Shared> {
        let mut places: Vec<u32> = Vec::new();
        let mut all: Vec<S> = Vec::new();
        for subject in subjects {
            let number = subject.number(topology);
            if number >= places.len() {
                let size = (number + 1).next_power_of_two();
                places.resize(size, NONE);
            }
            if places[number] == NONE {
                places[number] = all.len() as u32;
                all.push(subject);
            }
        }
        let looks: Vec<Option<u32>> = all
            .par_iter()
            .map(|subject| subject.looks(smooth))
            .collect();
        let mut first_looks = FxHashMap::default();
        let mut rings: Vec<Option<Box<Ring>>> = all
            .par_iter()
            .zip(&looks)
            .map(|(subject, looks)| looks.is_none().then(|| Box::new(subject.ring(topology))))
            .collect();
        for ((looks, subject), ring) in looks.iter().zip(&all).zip(&mut rings) {
            if let Some(looks) = looks {
                first_looks.entry(*looks).or_insert_with(|| {
                    *ring = Some(Box::new(subject.ring(topology)));
                });
            }
        }
        let wanted = all.iter().zip(&rings).filter_map(|(subject, ring)| {
            let ring = ring.as_ref()?;
            Some((subject.kind(), &ring.configuration))
        });
        let mut numbers = store.plans(wanted, options, database)?.into_iter();
        let mut plan_of_looks = FxHashMap::default();
        let known = looks.into_iter().zip(rings).map(|(looks, ring)| {
            let mut next = || numbers.next().expect("each ring has a plan");
            match (looks, ring) {
                (None, ring) => Known { plan: next(), ring },
                (Some(looks), Some(_)) => {
                    let plan = next();
                    plan_of_looks.insert(looks, plan);
                    Known { plan, ring: None }
                }
                (Some(looks), None) => Known {
                    plan: plan_of_looks[&looks],
                    ring: None,
                },
            }
        });
        Ok(Shared {
            known: known.collect(),
            places,
        })
    }

    /// What is known of a subject that has a plan.
    pub fn get(&self, topology: &Topology, subject: impl Subject) -> Option<&Known> {
        let &place = self.places.get(subject.number(topology))?;
        (place != NONE).then(|| &self.known[place as usize])
    }
}

/// Instead of a place: there is none.
const NONE: u32 = u32::MAX;
