//! What a database has: plans of all kinds, and what each is for.

use crate::error::Result;
use crate::plan::builder::Plan;
use crate::plan::configuration::Configuration;
use crate::plan::edge::{EdgeKind, EdgePlan};
use crate::plan::level::Steps;
use crate::plan::options::PlanOptions;
use crate::plan::vertex::{Side, VertexKind, VertexPlan};

/// What a plan is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u32)]
pub enum Kind {
    /// The inside of a face, or of an n-gon's part at a corner.
    Inside = 0,
    /// An edge.
    Edge = 1,
    /// An edge inside an n-gon, see [`EdgeKind::Spoke`].
    Spoke = 2,
    /// A vertex.
    Vertex = 3,
    /// The centre of an n-gon.
    Centre = 4,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 5] = [
        Kind::Inside,
        Kind::Edge,
        Kind::Spoke,
        Kind::Vertex,
        Kind::Centre,
    ];

    /// Its name, in small letters.
    pub fn name(self) -> &'static str {
        ["inside", "edge", "spoke", "vertex", "centre"][self as usize]
    }

    /// Builds the plan of a configuration.
    ///
    /// # Errors
    /// As [`Plan::build`], [`EdgePlan::build`], [`VertexPlan::build`].
    pub(super) fn build(
        self,
        configuration: &Configuration,
        options: PlanOptions,
        steps: &Steps,
    ) -> Result<Entry> {
        let edge = |kind| EdgePlan::build_by(configuration, kind, options, steps);
        let vertex = |kind| VertexPlan::build_by(configuration, kind, options, steps);
        Ok(match self {
            Kind::Inside => Entry::Inside(Plan::build_by(configuration, options, steps)?),
            Kind::Edge => Entry::Edge(edge(EdgeKind::Whole)?),
            Kind::Spoke => Entry::Edge(edge(EdgeKind::Spoke)?),
            Kind::Vertex => Entry::Vertex(vertex(VertexKind::Control)?),
            Kind::Centre => Entry::Vertex(vertex(VertexKind::Centre)?),
        })
    }
}

/// A plan of some kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// Of [`Kind::Inside`].
    Inside(Plan),
    /// Of [`Kind::Edge`] and [`Kind::Spoke`].
    Edge(EdgePlan),
    /// Of [`Kind::Vertex`] and [`Kind::Centre`].
    Vertex(VertexPlan),
}

impl Entry {
    /// Faces on each side of an infinite crease, see [`EdgePlan::sides`]; none of other plans than edges'.
    pub(crate) fn edge_sides(&self) -> &[u32] {
        match self {
            Entry::Edge(edge) => &edge.sides,
            Entry::Inside(_) | Entry::Vertex(_) => &[],
        }
    }

    /// How faces find their normals at a vertex, see [`VertexPlan::sides`], and how many tangent planes there are; none of other plans than vertices'.
    pub(crate) fn vertex_sides(&self) -> (&[Side], usize) {
        match self {
            Entry::Vertex(vertex) => (&vertex.sides, vertex.planes),
            Entry::Inside(_) | Entry::Edge(_) => (&[], 0),
        }
    }

    /// Its nodes and stencils, to be changed.
    pub(super) fn plan_mut(&mut self) -> &mut Plan {
        match self {
            Entry::Inside(plan) => plan,
            Entry::Edge(edge) => &mut edge.plan,
            Entry::Vertex(vertex) => &mut vertex.plan,
        }
    }

    /// Its nodes and stencils.
    pub fn plan(&self) -> &Plan {
        match self {
            Entry::Inside(plan) => plan,
            Entry::Edge(edge) => &edge.plan,
            Entry::Vertex(vertex) => &vertex.plan,
        }
    }
}

/// What tells an entry from all others.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Key {
    /// What it is for.
    pub kind: Kind,
    /// How it was built.
    pub options: PlanOptions,
    /// The surroundings.
    pub configuration: Configuration,
}
