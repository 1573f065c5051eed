//! `quadtree`: adaptive quadtrees (Brainerd et al. 2016). Regular faces are plain B-spline patches (section 7.1); every other face brings
//! its 1-ring and a plan, whose stencils the control shader runs and whose quadtree the evaluation shader walks.

mod border;
mod corner;
mod plain;
mod twin;

use std::time::Instant;

use glam::Vec3;
use rayon::prelude::*;

use crate::abi;
use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::mesh::{Model, Scheme};
use crate::method::patches::{self, Part};
use crate::method::{self, Contract, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::plan::{Catalogue, NodeKind, PackedPlans, PlanOptions, Ring};
use crate::subdivision::{BsplinePatch, ControlPoint, bspline_patch};
use crate::tessellation::Domain;

use border::{Borders, Irregular};
use plain::is_turned_corner;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "quadtree",
    summary: "the exact Catmull-Clark limit, by adaptive quadtrees",
    paper: "Brainerd, Foley, Kraemer, Moreton, Nießner 2016",
    schemes: &[Scheme::CatmullClark],
    domains: &[Domain::Quads],
    contract: Contract {
        reproduces: Reproduces::Limit(1e-6),
        normals: Some(0.1),
        interpolates: false,
        watertight: true,
    },
    uses_tables: false,
    covers: method::every_mesh,
    prepare,
};

/// What `hullform plan` tells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanStatistics {
    /// Regular patches.
    pub regular: usize,
    /// All others.
    pub irregular: usize,
    /// Different plans of the irregular patches' insides.
    pub plans: usize,
    /// Different plans of their edges.
    pub edge_plans: usize,
    /// Different plans of their corners.
    pub vertex_plans: usize,
    /// Nodes of each kind, in the order internal, regular, boundary, crease, terminal, extraordinary.
    pub nodes: [usize; 6],
    /// Stencils over all plans of insides.
    pub stencils: usize,
    /// Bytes of control vertices.
    pub vertex_bytes: usize,
    /// Bytes of the lists of control vertices.
    pub index_bytes: usize,
    /// Bytes of the quadtrees.
    pub quadtree_bytes: usize,
    /// Bytes of the trees of edges, and of what tells patches by which plans their edges and corners are evaluated.
    pub border_bytes: usize,
    /// Bytes of the stencils, those of edges and vertices included.
    pub stencil_bytes: usize,
    /// Bytes of scratch if every irregular patch kept a slot for its deepest level.
    pub scratch_worst_case_bytes: usize,
    /// Points over all irregular patches at each level, those of edges and corners included.
    pub control_points: [u64; abi::HIGHEST_LEVEL as usize + 1],
    /// Seconds for configurations, plans and packing.
    pub build_seconds: f64,
}

/// A part on its way to a patch.
enum Surroundings {
    Regular(Part, [u32; 16]),
    Irregular(Part, Ring),
}

fn prepare(model: &Model, options: MethodOptions) -> Result<Prepared> {
    let options = options.plans.check()?;
    let started = Instant::now();
    let topology = model.topology();
    let found: Vec<Surroundings> = patches::parts(model)
        .into_par_iter()
        .map(|part| surroundings(topology, part))
        .collect();
    let mut regular = pass("quadtree_regular", 16, twin::regular, options);
    let mut irregular = pass(
        "quadtree",
        abi::CONTROL_INVOCATIONS,
        twin::irregular,
        options,
    );
    let mut catalogue = Catalogue::default();
    let mut rings = Vec::new();
    for part in found {
        match part {
            Surroundings::Regular(part, vertices) => {
                let flags = turned_corners(topology, part.face);
                add(&mut regular, model, part, 0, &vertices).flags |= flags;
            }
            Surroundings::Irregular(part, ring) => {
                let plan = catalogue.number(ring.configuration.clone());
                rings.push(Irregular { part, ring, plan });
            }
        }
    }
    let mut packed = PackedPlans::default();
    let plans = catalogue.build(options);
    plans.iter().for_each(|plan| packed.push(plan));
    let nodes = NODE_KINDS.map(|kind| packed.count(kind));
    let quadtree_bytes = packed.quadtree_bytes();
    let borders = Borders::new(topology, &rings, &mut packed, options);
    for (patch, &border) in rings.iter().zip(&borders.numbers) {
        let turn = patch.turn(topology);
        add(
            &mut irregular,
            model,
            patch.part,
            turn,
            &patch.ring.vertices,
        )
        .plan = border;
    }
    let records = with_places(&mut irregular, &borders);
    irregular.scratch_points = records.iter().map(|border| border.counts).collect();
    irregular.tables = vec![
        bytemuck::cast_slice(&packed.headers).to_vec(),
        bytemuck::cast_slice(&packed.nodes).to_vec(),
        packed.points.clone(),
        bytemuck::cast_slice(&packed.weights).to_vec(),
        bytemuck::cast_slice(&records).to_vec(),
    ];
    let statistics = PlanStatistics {
        plans: plans.len(),
        edge_plans: borders.edge_plans,
        vertex_plans: borders.vertex_plans,
        nodes,
        stencils: plans.iter().map(|plan| plan.stencils.len()).sum(),
        quadtree_bytes,
        border_bytes: packed.quadtree_bytes() - quadtree_bytes + size_of_val(&records[..]),
        stencil_bytes: packed.stencil_bytes(),
        ..statistics(model, &regular, &irregular)
    };
    let plans = PlanStatistics {
        build_seconds: started.elapsed().as_secs_f64(),
        ..statistics
    };
    Ok(Prepared {
        plans: Some(plans),
        ..Prepared::of([regular, irregular])
    })
}

/// Puts the borders' lists behind the lists of control vertices, and the borders right.
fn with_places(pass: &mut Pass, borders: &Borders) -> Vec<abi::Border> {
    let start = pass.controls.len() as u32;
    pass.controls.extend_from_slice(&borders.places);
    let moved = |border: &abi::Border| abi::Border {
        rings: border.rings.map(|ring| ring + start),
        plain: border.plain + start,
        ..*border
    };
    borders.records.iter().map(moved).collect()
}

/// The flags of a regular patch's corners at which sums go along v first.
fn turned_corners(topology: &Topology, face: u32) -> u32 {
    let turned = |&corner: &u32| is_turned_corner(topology, face, corner) != (corner % 2 == 1);
    let corners = (0..4).filter(turned);
    corners
        .map(|corner| abi::PATCH_TURNED_CORNER << corner)
        .sum()
}

fn pass(
    shader: &'static str,
    control_points: u32,
    twin: super::Twin,
    options: PlanOptions,
) -> Pass {
    Pass {
        max_level: options.max_level,
        ..Pass::new(shader, Domain::Quads, control_points, twin)
    }
}

fn surroundings(topology: &Topology, part: Part) -> Surroundings {
    match bspline_patch(topology, part.face)
        .as_ref()
        .and_then(plain_vertices)
    {
        Some(vertices) => Surroundings::Regular(part, vertices),
        None if topology.face(part.face).len() == 4 => {
            Surroundings::Irregular(part, Ring::of_quad(topology, part.face))
        }
        None => Surroundings::Irregular(part, Ring::from_corner(topology, part.face, part.corner)),
    }
}

/// The vertices of a B-spline patch that has neither crease nor mirrored points.
fn plain_vertices(patch: &BsplinePatch) -> Option<[u32; 16]> {
    let vertex = |point: ControlPoint| {
        if let ControlPoint::Vertex(vertex) = point {
            vertex
        } else {
            u32::MAX
        }
    };
    (patch.crease.is_none() && !patch.mirrored).then(|| patch.points.map(vertex))
}

fn add<'a>(
    pass: &'a mut Pass,
    model: &Model,
    part: Part,
    turn: u32,
    vertices: &[u32],
) -> &'a mut abi::Patch {
    let mut patch = patches::patch(model, part, turn);
    patch.controls = pass.controls.len() as u32;
    pass.controls.extend_from_slice(vertices);
    pass.texture.push(patches::texture(model, part, turn));
    pass.patches.push(patch);
    pass.patches.last_mut().expect("it was just pushed")
}

const NODE_KINDS: [NodeKind; 6] = [
    NodeKind::Internal,
    NodeKind::Regular,
    NodeKind::Boundary,
    NodeKind::Crease,
    NodeKind::Terminal,
    NodeKind::Extraordinary,
];

/// What the passes tell.
fn statistics(model: &Model, regular: &Pass, irregular: &Pass) -> PlanStatistics {
    let points = |level: usize| -> u64 {
        (0..irregular.patches.len())
            .map(|patch| u64::from(irregular.points(patch, level as u32)))
            .sum()
    };
    PlanStatistics {
        regular: regular.patches.len(),
        irregular: irregular.patches.len(),
        vertex_bytes: size_of::<Vec3>() * model.mesh().vertex_count(),
        index_bytes: size_of_val(&regular.controls[..]) + size_of_val(&irregular.controls[..]),
        scratch_worst_case_bytes: 16 * points(irregular.max_level as usize) as usize,
        control_points: std::array::from_fn(points),
        ..PlanStatistics::default()
    }
}
