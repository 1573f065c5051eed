//! What has plans of its own beside the insides of patches: edges and vertices, each planned once for all that look alike.

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::plan::{
    Configuration, EdgeKind, EdgePlan, PackedPlans, Plan, PlanOptions, Ring, VertexKind, VertexPlan,
};

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
    type Plan: Send + Sync;
    fn ring(self, topology: &Topology) -> Ring;
    fn build(self, configuration: &Configuration, options: PlanOptions) -> Result<Self::Plan>;
    fn stencils(plan: &Self::Plan) -> &Plan;
    /// Whether it lies inside an n-gon: the configuration is the n-gon's then.
    fn is_inside(self) -> bool;
}

impl Subject for Line {
    type Plan = EdgePlan;

    fn ring(self, topology: &Topology) -> Ring {
        match self {
            Line::Edge(edge) => Ring::of_edge(topology, edge),
            Line::Spoke { face, corner } => Ring::from_corner(topology, face, corner),
        }
        .expect("lines are the topology's own")
    }

    fn build(self, configuration: &Configuration, options: PlanOptions) -> Result<EdgePlan> {
        let kind = if self.is_inside() {
            EdgeKind::Spoke
        } else {
            EdgeKind::Whole
        };
        EdgePlan::build(configuration, kind, options)
    }

    fn stencils(plan: &EdgePlan) -> &Plan {
        &plan.plan
    }

    fn is_inside(self) -> bool {
        matches!(self, Line::Spoke { .. })
    }
}

impl Subject for Point {
    type Plan = VertexPlan;

    fn ring(self, topology: &Topology) -> Ring {
        match self {
            Point::Vertex(vertex) => Ring::of_vertex(topology, vertex),
            Point::Centre(face) => Ring::from_corner(topology, face, 0),
        }
        .expect("points are the topology's own")
    }

    fn build(self, configuration: &Configuration, options: PlanOptions) -> Result<VertexPlan> {
        let kind = if self.is_inside() {
            VertexKind::Centre
        } else {
            VertexKind::Control
        };
        VertexPlan::build(configuration, kind, options)
    }

    fn stencils(plan: &VertexPlan) -> &Plan {
        &plan.plan
    }

    fn is_inside(self) -> bool {
        matches!(self, Point::Centre(_))
    }
}

/// The rings and plans of subjects of one kind.
pub struct Shared<S: Subject> {
    /// Each subject's ring, and the number of its plan.
    pub known: FxHashMap<S, (Ring, usize)>,
    pub plans: Vec<S::Plan>,
    /// The number of the first among all packed plans.
    pub first: u32,
}

impl<S: Subject> Shared<S> {
    pub fn new(
        topology: &Topology,
        subjects: impl Iterator<Item = S>,
        packed: &mut PackedPlans,
        options: PlanOptions,
    ) -> Result<Shared<S>> {
        let mut seen = FxHashSet::default();
        let subjects: Vec<S> = subjects.filter(|&subject| seen.insert(subject)).collect();
        let rings: Vec<Ring> = subjects
            .par_iter()
            .map(|&subject| subject.ring(topology))
            .collect();
        let mut numbers: FxHashMap<(bool, &Configuration), usize> = FxHashMap::default();
        let mut firsts: Vec<usize> = Vec::new();
        let plans: Vec<usize> = subjects
            .iter()
            .enumerate()
            .map(|(i, subject)| {
                let key = (subject.is_inside(), &rings[i].configuration);
                *numbers.entry(key).or_insert_with(|| {
                    firsts.push(i);
                    firsts.len() - 1
                })
            })
            .collect();
        let built: Result<Vec<S::Plan>> = firsts
            .par_iter()
            .map(|&i| subjects[i].build(&rings[i].configuration, options))
            .collect();
        let built = built?;
        let first = packed.headers.len() as u32;
        for plan in &built {
            packed.push(S::stencils(plan))?;
        }
        let rings = rings.into_iter().zip(plans);
        Ok(Shared {
            known: subjects.into_iter().zip(rings).collect(),
            plans: built,
            first,
        })
    }
}
