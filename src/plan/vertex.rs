//! Plans of vertices: limit position and tangents, for all faces around a vertex the same where the limit has one tangent plane.

use crate::plan::builder::{Plan, PlanOptions, Stencil};
use crate::plan::configuration::Configuration;
use crate::plan::level::Level;
use crate::plan::rows::Rows;
use crate::subdivision::{TangentPlane, limit_stencil, tangent_plane};

/// Which vertex of a configuration is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VertexKind {
    /// Vertex 0.
    Control,
    /// The centre of the n-gon whose ring it is.
    Centre,
}

/// The plan of a vertex. It has no nodes; its stencils are the limit position, then pairs of tangents.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexPlan {
    /// The stencils, all of level 0.
    pub plan: Plan,
    /// For each face of the configuration that has the vertex: the number of its pair of tangents. The faces come first in the configuration.
    pub pairs: Vec<u32>,
}

impl VertexPlan {
    /// Builds the plan of a vertex.
    pub fn build(
        configuration: &Configuration,
        kind: VertexKind,
        options: PlanOptions,
    ) -> VertexPlan {
        let whole = Level::whole(configuration);
        let (mut level, mut corners) = match kind {
            VertexKind::Control => {
                let around = whole.topology.vertex_faces(0);
                let corners: Vec<(u32, u32)> =
                    around.iter().map(|at| (at.face, at.corner)).collect();
                (whole, corners)
            }
            // Corner 2 of the n-gon's first part; all its parts agree.
            VertexKind::Centre => (whole.refined(&[(0, 0)]), vec![(0, 2)]),
        };
        corners.sort_unstable();
        let mut scale = 1.0;
        loop {
            let limits = corners
                .iter()
                .map(|&(face, corner)| limit_stencil(&level.topology, face, corner));
            if let Some(limits) = limits.collect::<Option<Vec<_>>>() {
                let mut rows = Rows::zero(level.rows.width(), 0);
                rows.push(&limits[0].position, &level.rows);
                let mut planes: Vec<TangentPlane> = Vec::new();
                let mut pairs = Vec::with_capacity(corners.len());
                for (limit, &(face, corner)) in limits.iter().zip(&corners) {
                    let plane = tangent_plane(&level.topology, face, corner);
                    let known = planes.iter().position(|&known| known == plane);
                    pairs.push(known.unwrap_or(planes.len()) as u32);
                    if known.is_none() {
                        planes.push(plane);
                        rows.push(&limit.du, &level.rows);
                        rows.push(&limit.dv, &level.rows);
                    }
                }
                return VertexPlan {
                    plan: plan(&rows, scale, options),
                    pairs,
                };
            }
            let (next, corner) = refined(&level, &corners);
            (level, corners) = (next, corner);
            scale *= 2.0;
        }
    }
}

/// The next level around the vertex: the children at it, in the order of their parents, and their corners there.
fn refined(level: &Level, corners: &[(u32, u32)]) -> (Level, Vec<(u32, u32)>) {
    let arity = |face: u32| level.topology.face(face).len();
    let next = corners.iter().enumerate().map(|(child, &(face, corner))| {
        // A quad's child keeps its corners; an n-gon's begins at the vertex.
        (child as u32, if arity(face) == 4 { corner } else { 0 })
    });
    let next = next.collect();
    (level.refined(corners), next)
}

/// The stencils; a child's parameters run twice as fast as its parent's.
fn plan(rows: &Rows, scale: f64, options: PlanOptions) -> Plan {
    let stencil = |number: usize| {
        let scale = if number == 0 { 1.0 } else { scale };
        Stencil {
            weights: rows
                .row(number)
                .iter()
                .map(|weight| scale * weight)
                .collect(),
            level: 0,
        }
    };
    Plan {
        ring_size: rows.width(),
        max_level: options.max_level,
        nodes: Vec::new(),
        stencils: (0..rows.len()).map(stencil).collect(),
    }
}
