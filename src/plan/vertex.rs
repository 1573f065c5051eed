//! Plans of vertices: limit position and tangents, for all faces around a vertex the same where the limit has one tangent plane.

use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::plan::builder::Plan;
use crate::plan::configuration::Configuration;
use crate::plan::level::{Level, Steps};
use crate::plan::options::PlanOptions;
use crate::plan::rows::Rows;
use crate::plan::stencils::Stencils;
use crate::plan::sums::Sums;
use crate::subdivision::{
    LimitStencil, TangentPlane, closing_tangents, limit_stencil, orthonormal, tangent_plane,
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
        VertexPlan::build_by(configuration, kind, options, &Steps::default())
    }

    pub(super) fn build_by(
        configuration: &Configuration,
        kind: VertexKind,
        options: PlanOptions,
        steps: &Steps,
    ) -> Result<VertexPlan> {
        let options = options.check()?;
        configuration.check_corners(match kind {
            VertexKind::Control => 1,
            VertexKind::Centre => configuration.arity(),
        })?;
        let whole = Level::whole(configuration, steps);
        let (mut level, mut corners) = VertexPlan::beginning(&whole, kind);
        let own = corners.clone();
        loop {
            let sectors = sectors(level.topology(), &corners);
            let limit = |sector: &Vec<usize>| {
                let (face, corner) = corners[sector[0]];
                limit_stencil(level.topology(), face, corner)
            };
            let Some(limits) = sectors.iter().map(limit).collect::<Option<Vec<_>>>() else {
                (level, corners) = refined(&level, kind, &corners);
                continue;
            };
            let mut rows = Rows::zero(level.rows.width(), 0);
            rows.push(|row| level.rows.add_to(row, &limits[0].position));
            let mut sides = vec![Side::default(); corners.len()];
            let mut planes: Vec<(TangentPlane, Side)> = Vec::new();
            let mut cusps = 0;
            for (sector, limit) in sectors.iter().zip(&limits) {
                let (face, corner) = corners[sector[0]];
                let plane = tangent_plane(level.topology(), face, corner);
                // At a cusp each face has a plane of its own, and no tangents.
                if matches!(plane, TangentPlane::Face(_)) && sector.len() > 1 {
                    cusps += sector.len();
                    continue;
                }
                let known = planes.iter().find(|(known, _)| *known == plane);
                let side = known.map(|&(_, side)| side).unwrap_or_else(|| {
                    let (face, corner) = own[sector[0]];
                    let spare = match kind {
                        VertexKind::Control => closing_tangents(whole.topology(), face, corner),
                        VertexKind::Centre => None,
                    };
                    let pair = Some((rows.len() as u32 - 1) / 2);
                    push_tangents(&mut rows, limit, &level.rows);
                    for mask in spare.iter().flatten() {
                        rows.push(|row| whole.rows.add_to(row, mask));
                    }
                    let spare = spare.is_some();
                    planes.push((plane, Side { pair, spare }));
                    Side { pair, spare }
                });
                sector.iter().for_each(|&place| sides[place] = side);
            }
            return Ok(VertexPlan {
                plan: plan(&rows, options, steps),
                sides,
                planes: planes.len() + cusps,
            });
        }
    }
}

impl VertexPlan {
    /// The first level that has the vertex, and the corners there that stand for all around it.
    pub(super) fn beginning<'a>(
        whole: &Level<'a>,
        kind: VertexKind,
    ) -> (Level<'a>, Vec<(u32, u32)>) {
        match kind {
            VertexKind::Control => {
                let around = whole.topology().vertex_faces(0).iter();
                let mut corners: Vec<(u32, u32)> = around.map(|at| (at.face, at.corner)).collect();
                corners.sort_unstable();
                (whole.clone(), corners)
            }
            // Corner 2 of the n-gon's first part; all its parts agree.
            VertexKind::Centre => (whole.refined(&[(0, 0)]), vec![(0, 2)]),
        }
    }
}

/// The corners that share a sector between infinite creases, by their places: all that is known of the limit is the same for them.
fn sectors(topology: &Topology, corners: &[(u32, u32)]) -> Vec<Vec<usize>> {
    let places = corners.iter().zip(0..);
    let places: FxHashMap<u32, usize> = places.map(|(&(face, _), place)| (face, place)).collect();
    let mut is_met = vec![false; corners.len()];
    let mut sectors = Vec::new();
    for (place, &(face, corner)) in corners.iter().enumerate() {
        if is_met[place] {
            continue;
        }
        let faces = topology.fan(face, corner).faces;
        let around = faces.iter().filter_map(|face| places.get(face).copied());
        let mut sector: Vec<usize> = around.collect();
        sector.sort_unstable();
        sector.iter().for_each(|&place| is_met[place] = true);
        sectors.push(sector);
    }
    sectors
}

/// Appends the limit's tangents, of which only the plane counts.
fn push_tangents(rows: &mut Rows, limit: &LimitStencil, level: &Sums) {
    let first = rows.len();
    rows.push(|row| level.add_to(row, &limit.du));
    rows.push(|row| level.add_to(row, &limit.dv));
    let tangents = orthonormal(rows.row(first), rows.row(first + 1));
    for (row, weights) in (first..).zip(&tangents) {
        rows.row_mut(row).copy_from_slice(weights);
    }
}

/// The next level around the vertex: the children at it, in the order of their parents, and their corners there.
pub(super) fn refined<'a>(
    level: &Level<'a>,
    kind: VertexKind,
    corners: &[(u32, u32)],
) -> (Level<'a>, Vec<(u32, u32)>) {
    let arity = |face: u32| level.topology().face(face).len();
    let next = corners.iter().enumerate().map(|(child, &(face, corner))| {
        // A quad's child keeps its corners; an n-gon's begins at the vertex.
        (child as u32, if arity(face) == 4 { corner } else { 0 })
    });
    let next = next.collect();
    let level = match kind {
        VertexKind::Control => level.refined_vertex(corners),
        // One face's corner stands for all around.
        VertexKind::Centre => level.refined(corners),
    };
    (level, next)
}

/// The stencils.
fn plan(rows: &Rows, options: PlanOptions, steps: &Steps) -> Plan {
    let mut stencils = Stencils::new(rows.width(), !steps.rounded);
    let mut known = steps.known_rows();
    for number in 0..rows.len() {
        let weights = rows.row(number).iter().copied();
        stencils.push(0, None, weights, true, &mut known);
    }
    Plan {
        ring_size: rows.width(),
        max_level: options.max_level,
        nodes: Vec::new(),
        stencils,
        nearby: Default::default(),
        strips: Default::default(),
    }
}
