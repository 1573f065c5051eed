//! What has plans of its own beside the insides of patches: edges and vertices, each planned once for all that look alike.

use std::sync::Arc;

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::plan::database::{Entry, Kind};
use crate::plan::{Configuration, Database, PackedPlans, PlanOptions, Ring};

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
pub trait Subject: Copy + Eq + std::hash::Hash + Send + Sync {
    fn ring(self, topology: &Topology) -> Ring;
    fn kind(self) -> Kind;
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
}

/// Plans of a database, by numbers of their own.
pub struct Planned {
    /// Of each configuration that was asked for, the number of its plan.
    pub numbers: Vec<u32>,
    /// The plans, each once.
    pub plans: Vec<Arc<Entry>>,
}

impl Planned {
    pub fn new<'a>(
        wanted: impl Iterator<Item = (Kind, &'a Configuration)>,
        options: PlanOptions,
        database: &Database,
    ) -> Result<Planned> {
        let mut known: FxHashMap<(Kind, &Configuration), u32> = FxHashMap::default();
        let mut firsts: Vec<(Kind, &Configuration)> = Vec::new();
        let number = |wanted| {
            *known.entry(wanted).or_insert_with(|| {
                firsts.push(wanted);
                firsts.len() as u32 - 1
            })
        };
        let numbers = wanted.map(number).collect();
        let mut plans: Vec<Option<Arc<Entry>>> = vec![None; firsts.len()];
        for kind in Kind::ALL {
            let own = (0..firsts.len()).filter(|&i| firsts[i].0 == kind);
            let own: Vec<usize> = own.collect();
            let configurations: Vec<&Configuration> = own.iter().map(|&i| firsts[i].1).collect();
            let found = database.plans(kind, options, &configurations)?;
            for (&i, (_, entry)) in own.iter().zip(found) {
                plans[i] = Some(entry);
            }
        }
        Ok(Planned {
            numbers,
            plans: plans.into_iter().flatten().collect(),
        })
    }
}

/// The rings and plans of subjects of one kind.
pub struct Shared<S: Subject> {
    /// Each subject's ring, and the number of its plan.
    pub known: FxHashMap<S, (Ring, usize)>,
    pub plans: Vec<Arc<Entry>>,
    /// The number of the first among all packed plans.
    pub first: u32,
}

impl<S: Subject> Shared<S> {
    pub fn new(
        topology: &Topology,
        subjects: impl Iterator<Item = S>,
        packed: &mut PackedPlans,
        options: PlanOptions,
        database: &Database,
    ) -> Result<Shared<S>> {
        let mut seen = FxHashSet::default();
        let subjects: Vec<S> = subjects.filter(|&subject| seen.insert(subject)).collect();
        let rings: Vec<Ring> = subjects
            .par_iter()
            .map(|&subject| subject.ring(topology))
            .collect();
        let wanted = subjects.iter().zip(&rings);
        let wanted = wanted.map(|(subject, ring)| (subject.kind(), &ring.configuration));
        let Planned { numbers, plans } = Planned::new(wanted, options, database)?;
        let first = packed.headers.len() as u32;
        for plan in &plans {
            packed.push(plan.plan())?;
        }
        let rings = rings
            .into_iter()
            .zip(numbers.into_iter().map(|number| number as usize));
        Ok(Shared {
            known: subjects.into_iter().zip(rings).collect(),
            plans,
            first,
        })
    }
}
