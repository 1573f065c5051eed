//! `quadtree`: adaptive quadtrees (Brainerd et al. 2016). Regular faces are plain B-spline patches (section 7.1); every other face brings
//! its 1-ring and a plan, whose stencils the control shader runs and whose quadtree the evaluation shader walks.

mod agreement;
mod border;
mod bounded;
mod cached;
mod corner;
mod irregular;
mod places;
mod plain;
mod subjects;
mod twin;
mod view;

use std::time::Instant;

use glam::Vec3;
use rayon::prelude::*;

use crate::abi;
use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::mesh::{Model, Scheme};
use crate::method::patches::{self, Part};
use crate::method::{Contract, Method, MethodOptions, Pass, Prepared, Reproduces, Table};
use crate::plan::database::Kind;
use crate::plan::{Database, NodeKind, PackedPlans, Plan, PlanOptions, Ring};
use crate::subdivision::{BsplinePatch, ControlPoint, bspline_patch};
use crate::tessellation::Domain;

use border::{Borders, Given};
#[cfg(feature = "host")]
pub(crate) use twin::node_kind;

use irregular::Irregular;
use plain::is_turned_corner;
use subjects::Planned;

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
    covers: bounded::check,
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

fn prepare(model: &Model, options: MethodOptions, database: &Database) -> Result<Prepared> {
    let options = options.plans.check()?;
    let started = Instant::now();
    let topology = model.topology();
    let found: Vec<Surroundings> = patches::parts(model)
        .into_par_iter()
        .map(|part| surroundings(topology, part))
        .collect();
    let mut regular = pass("quadtree_regular", 16, twin::regular, options);
    let (mut rings, mut long_rings) = (Vec::new(), Vec::new());
    for part in found {
        match part {
            Surroundings::Regular(part, vertices) => {
                let flags = turned_corners(topology, part.face);
                add(&mut regular, model, part, 0, &vertices).flags |= flags;
            }
            Surroundings::Irregular(part, ring) => {
                let fits = ring.vertices.len() <= abi::CONTROL_INVOCATIONS as usize;
                let rings = if fits { &mut rings } else { &mut long_rings };
                rings.push((part, ring));
            }
        }
    }
    let mut plans = PlanStatistics {
        regular: regular.patches.len(),
        vertex_bytes: size_of::<Vec3>() * model.mesh().vertex_count(),
        index_bytes: size_of_val(&regular.controls[..]),
        ..PlanStatistics::default()
    };
    let mut irregular =
        |shader, rings| irregular(model, shader, rings, options, database, &mut plans);
    let short = irregular("quadtree", rings)?;
    let long = irregular("quadtree_long", long_rings)?;
    plans.build_seconds = started.elapsed().as_secs_f64();
    Ok(Prepared {
        plans: Some(plans),
        cached: Some(cached::cached_points),
        ..Prepared::of([regular, short, long])
    })
}

/// The pass of the patches that need plans. Those with long rings have shaders of their own, which need not pay for others.
fn irregular(
    model: &Model,
    shader: &'static str,
    rings: Vec<(Part, Ring)>,
    options: PlanOptions,
    database: &Database,
    statistics: &mut PlanStatistics,
) -> Result<Pass> {
    let topology = model.topology();
    let mut pass = pass(shader, abi::CONTROL_INVOCATIONS, twin::irregular, options);
    pass.cached = Some("quadtree_cached");
    let kinds = rings
        .iter()
        .map(|(_, ring)| (Kind::Inside, &ring.configuration));
    let Planned { numbers, plans } = Planned::new(kinds, options, database)?;
    let irregular = |((part, ring), plan)| Irregular::new(part, ring, plan);
    let patches: Vec<Irregular> = rings.into_iter().zip(numbers).map(irregular).collect();
    let mut packed = PackedPlans::default();
    for plan in &plans {
        packed.push(plan.plan())?;
    }
    statistics.plans += plans.len();
    statistics.stencils += plans
        .iter()
        .map(|plan| plan.plan().stencils.len())
        .sum::<usize>();
    for (count, kind) in statistics.nodes.iter_mut().zip(NODE_KINDS) {
        *count += packed.count(kind);
    }
    let inside_bytes = packed.quadtree_bytes();
    let insides: Vec<&Plan> = plans.iter().map(|plan| plan.plan()).collect();
    let given = Given {
        topology,
        patches: &patches,
        plans: &insides,
    };
    let borders = Borders::new(given, &mut packed, options, database)?;
    for (patch, &border) in patches.iter().zip(&borders.numbers) {
        let turn = patch.turn(topology);
        let vertices = &patch.ring.vertices;
        let record = add(&mut pass, model, patch.part, turn, vertices);
        record.plan = border;
        let ring = (vertices.len() as u32).min(abi::CONTROL_INVOCATIONS);
        record.flags |= ring << abi::PATCH_RING_SHIFT;
        if patch.ring.mirrored {
            record.flags |= abi::PATCH_MIRRORED;
        }
        let order: Vec<u32> = patch.order.iter().map(|&place| place.into()).collect();
        pass.controls.extend(places::pack(order.len(), &order));
    }
    let (records, uses) = with_places(&mut pass, &borders);
    let sums = records
        .iter()
        .map(|border| sums(border, &uses, &borders.ends));
    (pass.scratch_points, pass.scratch_products) = sums.unzip();
    statistics.edge_plans += borders.edge_plans;
    statistics.vertex_plans += borders.vertex_plans;
    statistics.quadtree_bytes += inside_bytes;
    statistics.border_bytes += packed.quadtree_bytes() - inside_bytes
        + size_of_val(&records[..])
        + size_of_val(&uses[..])
        + size_of_val(&borders.ends[..]);
    statistics.stencil_bytes += packed.stencil_bytes();
    statistics.add_points(&pass);
    let products = packed.headers.iter().map(|header| {
        let stencils = header.counts.iter().copied().max().unwrap_or(0);
        u64::from(header.ring_size) * u64::from(stencils)
    });
    packed.rows.hold(products.max().unwrap_or(0));
    let rows = packed.rows.view();
    pass.tables = vec![
        Table::of(&packed.nodes),
        Table::of(bytemuck::cast_slice::<u32, [u32; 2]>(&packed.points)),
        Table::of(rows.rows),
        Table::of(rows.sets),
        Table::of(rows.patterns),
        Table::of(&uses),
        Table::of(&borders.ends),
        Table::of(&records),
    ];
    Ok(pass)
}

/// A number for each level.
type Levels<T> = [T; abi::HIGHEST_LEVEL as usize + 1];

/// The points of a patch's slot at each level, and the products of a weight and a vertex that these take. Of a corner's two points one is a normal, by two
/// tangents.
fn sums(border: &abi::Border, uses: &[abi::Use], ends: &[abi::Ends]) -> (Levels<u32>, Levels<u64>) {
    let mut sums: (Levels<u32>, Levels<u64>) = Default::default();
    for level in 0..sums.0.len() {
        let mut start = abi::USES + border.plain_count;
        let ends = view::ends_of(&ends[border.ends as usize], level);
        for (number, end) in ends.into_iter().enumerate() {
            let stencils = end - std::mem::replace(&mut start, end);
            let tangents = u32::from(number >= 5 && stencils > 0);
            let size = uses[border.uses[number] as usize].size;
            sums.1[level] += u64::from(size) * u64::from(stencils + tangents);
        }
        sums.0[level] = start;
    }
    sums
}

impl PlanStatistics {
    fn add_points(&mut self, pass: &Pass) {
        let points = |level: u32| -> u64 {
            let patches = 0..pass.patches.len();
            patches
                .map(|patch| u64::from(pass.points(patch, level)))
                .sum()
        };
        self.irregular += pass.patches.len();
        self.index_bytes += size_of_val(&pass.controls[..]);
        self.scratch_worst_case_bytes += 16 * points(pass.max_level) as usize;
        for (sum, level) in self.control_points.iter_mut().zip(0..) {
            *sum += points(level);
        }
    }
}

/// Puts the borders' lists behind the lists of control vertices, and the borders right.
fn with_places(pass: &mut Pass, borders: &Borders) -> (Vec<abi::Border>, Vec<abi::Use>) {
    let start = pass.controls.len() as u32;
    pass.controls.extend_from_slice(&borders.places);
    let records = borders.records.iter().map(|border| abi::Border {
        plain: border.plain + start,
        ..*border
    });
    let uses = borders.uses.iter().map(|used| abi::Use {
        ring: used.ring + start,
        ..*used
    });
    (records.collect(), uses.collect())
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
    let plain = bspline_patch(topology, part.face)
        .as_ref()
        .and_then(plain_vertices);
    if let Some(vertices) = plain {
        return Surroundings::Regular(part, vertices);
    }
    let quad = topology.face(part.face).len() == 4;
    let ring = match quad {
        true => Ring::of_quad(topology, part.face),
        false => Ring::of_part(topology, part.face, part.corner),
    };
    Surroundings::Irregular(part, ring.expect("parts are the topology's own"))
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
    // Masks of Catmull-Clark have no negative weights.
    pass.hulls.push(vertices.len() as u32);
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
