//! What a hub becomes in refinement, as sums over all that is around it: once for all patches there, whose plans take it as given
//! ([`Hubs`](crate::mesh::topology::Hubs)).

use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::plan::configuration::Configuration;
use crate::plan::level::{Level, Steps};
use crate::plan::options::PlanOptions;
use crate::plan::ring::Ring;
use crate::plan::vertex::{VertexKind, VertexPlan, refined};

/// A vertex or face.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Middle {
    Vertex(u32),
    Face(u32),
}

/// Sums over the vertices of a hub's ring.
pub(crate) struct HubPlan {
    /// The vertices, by their numbers in the mesh.
    pub vertices: Vec<u32>,
    /// The weights of what it becomes, level by level, then of its limit.
    pub given: Vec<Vec<f64>>,
    /// Those of the limit's tangents, and of those for where they cancel.
    tangents: [Option<[Vec<f64>; 2]>; 2],
}

impl HubPlan {
    /// Of a hub with one tangent plane; its next `levels` levels. The topology has no hubs.
    ///
    /// # Errors
    /// As [`VertexPlan::build`].
    pub fn build(
        topology: &Topology,
        middle: Middle,
        levels: u32,
        options: PlanOptions,
    ) -> Result<HubPlan> {
        let (ring, kind) = match middle {
            Middle::Vertex(vertex) => (Ring::of_vertex(topology, vertex), VertexKind::Control),
            Middle::Face(face) => (Ring::from_corner(topology, face, 0), VertexKind::Centre),
        };
        let ring = ring.expect("hubs are the topology's own");
        // Each vertex of a large face has the whole of it in its mask.
        let (configuration, means) = ring.configuration.with_means(LARGE);
        let steps = Steps::default();
        let below = below(&configuration, kind, levels, &steps);
        let limit = VertexPlan::build_by(&configuration, kind, options, &steps)?;
        let row = |number| limit.plan.stencils.weights(number);
        let plain = |row: Vec<f64>| without_means(row, &means);
        Ok(HubPlan {
            vertices: ring.vertices,
            given: below.into_iter().chain([row(0)]).map(plain).collect(),
            tangents: [1, 3].map(|first| {
                let own = [first, first + 1];
                (own[1] < limit.plan.stencils.len()).then(|| own.map(|n| plain(row(n))))
            }),
        })
    }

    /// The weights of the limit's tangents; or, if there are others, of those for where they cancel.
    pub fn tangents(&self, spare: bool) -> &[Vec<f64>; 2] {
        let [own, other] = &self.tangents;
        let own = own.as_ref().expect("a hub has a tangent plane");
        other.as_ref().filter(|_| spare).unwrap_or(own)
    }
}

/// Faces of more corners are large.
const LARGE: usize = 16;

/// The weights of the vertices alone, of those and behind them of means of some.
fn without_means(mut row: Vec<f64>, means: &[Vec<u32>]) -> Vec<f64> {
    let of_means = row.split_off(row.len() - means.len());
    for (weight, face) in of_means.into_iter().zip(means) {
        for &vertex in face {
            row[vertex as usize] += weight / face.len() as f64;
        }
    }
    row
}

/// The weights of the next levels' vertices in the middle.
fn below(
    configuration: &Configuration,
    kind: VertexKind,
    levels: u32,
    steps: &Steps,
) -> Vec<Vec<f64>> {
    let whole = Level::whole(configuration, steps);
    let (mut level, mut corners) = VertexPlan::beginning(&whole, kind);
    let own = |level: &Level<'_>, corners: &[(u32, u32)]| {
        let (face, corner) = corners[0];
        let vertex = level.topology().face(face)[corner as usize];
        level.rows.row(vertex as usize).into_owned()
    };
    let mut rows = Vec::new();
    if kind == VertexKind::Centre {
        rows.push(own(&level, &corners));
    }
    while rows.len() < levels as usize {
        (level, corners) = refined(&level, kind, &corners);
        rows.push(own(&level, &corners));
    }
    rows
}
