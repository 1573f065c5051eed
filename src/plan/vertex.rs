//! Plans of vertices: limit position and tangents, for all faces around a vertex the same where the limit has one tangent plane.

use crate::error::Result;
use crate::plan::builder::{Plan, PlanOptions, Stencil};
use crate::plan::configuration::Configuration;
use crate::plan::level::Level;
use crate::plan::rows::Rows;
use crate::subdivision::{
    LimitStencil, Mask, TangentPlane, closing_tangents, limit_stencil, orthonormal, tangent_plane,
};

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
    /// For each face of the configuration that has the vertex, which come first there, how it finds its normal.
    pub sides: Vec<Side>,
    /// How many tangent planes there are.
    pub planes: usize,
}

/// How a face finds its normal at a vertex. Where the inside's plan has tangents near the corner, these have a say as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// The number of its pair of tangents; none at a cusp.
    pub pair: Option<u32>,
    /// Whether the next pair is to be taken where this one cancels.
    pub spare: bool,
}

impl VertexPlan {
    /// Builds the plan of a vertex.
    ///
    /// # Errors
    /// As [`PlanOptions::check`]; [`Misuse::Ring`](crate::Misuse::Ring) for the centre of a face where the configuration is that of an edge or vertex.
    pub fn build(
        configuration: &Configuration,
        kind: VertexKind,
        options: PlanOptions,
    ) -> Result<VertexPlan> {
        let options = options.check()?;
        configuration.check_corners(match kind {
            VertexKind::Control => 1,
            VertexKind::Centre => configuration.arity(),
        })?;
        let whole = Level::whole(configuration);
        let (mut level, mut corners) = match kind {
            VertexKind::Control => {
                let around = whole.topology.vertex_faces(0);
                let corners: Vec<(u32, u32)> =
                    around.iter().map(|at| (at.face, at.corner)).collect();
                (whole.clone(), corners)
            }
            // Corner 2 of the n-gon's first part; all its parts agree.
            VertexKind::Centre => (whole.refined(&[(0, 0)]), vec![(0, 2)]),
        };
        corners.sort_unstable();
        let spares: Vec<Option<[Mask; 2]>> = match kind {
            VertexKind::Control => corners
                .iter()
                .map(|&(face, corner)| closing_tangents(&whole.topology, face, corner))
                .collect(),
            VertexKind::Centre => vec![None],
        };
        loop {
            let limits = corners
                .iter()
                .map(|&(face, corner)| limit_stencil(&level.topology, face, corner));
            if let Some(limits) = limits.collect::<Option<Vec<_>>>() {
                let mut rows = Rows::zero(level.rows.width(), 0);
                rows.push(&limits[0].position, &level.rows);
                let mut planes: Vec<(TangentPlane, Side)> = Vec::new();
                let mut sides = Vec::with_capacity(corners.len());
                for ((limit, spare), &(face, corner)) in limits.iter().zip(&spares).zip(&corners) {
                    let plane = tangent_plane(&level.topology, face, corner);
                    if let Some(&(_, side)) = planes.iter().find(|(known, _)| *known == plane) {
                        sides.push(side);
                        continue;
                    }
                    let alone = level.topology.fan(face, corner).faces.len() == 1;
                    let cusp = matches!(plane, TangentPlane::Face(_)) && !alone;
                    let side = Side {
                        pair: (!cusp).then_some((rows.len() as u32 - 1) / 2),
                        spare: spare.is_some(),
                    };
                    if !cusp {
                        push_tangents(&mut rows, limit, &level.rows);
                    }
                    for mask in spare.iter().flatten() {
                        rows.push(mask, &whole.rows);
                    }
                    planes.push((plane, side));
                    sides.push(side);
                }
                return Ok(VertexPlan {
                    plan: plan(&rows, options),
                    sides,
                    planes: planes.len(),
                });
            }
            let (next, corner) = refined(&level, &corners);
            (level, corners) = (next, corner);
        }
    }
}

/// Appends the limit's tangents, of which only the plane counts.
fn push_tangents(rows: &mut Rows, limit: &LimitStencil, level: &Rows) {
    let first = rows.len();
    rows.push(&limit.du, level);
    rows.push(&limit.dv, level);
    let tangents = orthonormal(rows.row(first), rows.row(first + 1));
    for (row, weights) in (first..).zip(&tangents) {
        rows.row_mut(row).copy_from_slice(weights);
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

/// The stencils.
fn plan(rows: &Rows, options: PlanOptions) -> Plan {
    let stencil = |number: usize| Stencil {
        weights: rows.row(number).to_vec(),
        level: 0,
        corner: None,
    };
    Plan {
        ring_size: rows.width(),
        max_level: options.max_level,
        nodes: Vec::new(),
        stencils: (0..rows.len()).map(stencil).collect(),
        nearby: Default::default(),
        strips: Default::default(),
    }
}
