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
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::mesh::{Model, Scheme};
use crate::method::patches::{self, Part};
use crate::method::{Contract, Method, MethodOptions, Pass, Prepared, Reproduces, Table};
use crate::plan::database::Kind;
use crate::plan::{
    Database, NodeKind, PackedPlans, Plan, PlanOptions, Ring, SmoothQuads, SmoothRing, SmoothStart,
};
use crate::tessellation::Domain;

use border::{Borders, Given};
#[cfg(feature = "host")]
pub(crate) use twin::node_kind;

use irregular::{Irregulars, Record, order, push_ring};
use plain::is_turned_corner;
use subjects::Wanted;

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
struct Found {
    patch: abi::Patch,
    texture: [[f32; 2]; 4],
    surroundings: Surroundings,
}

/// What a part's limit depends on.
enum Surroundings {
    Regular([u32; 16]),
    Smooth(SmoothStart, SmoothRing),
    Irregular(Box<Ring>),
}

/// So many parts are on their way at a time.
const AT_A_TIME: usize = 1 << 13;
/// Most short rings and their orders take less.
const RING: usize = 36;

/// Makes room for patches of so many control vertices.
fn reserve(pass: &mut Pass, patches: usize, controls: usize) {
    pass.patches.reserve_exact(patches);
    pass.texture.reserve_exact(patches);
    pass.controls.reserve_exact(patches * controls);
}

fn prepare(model: &Model, options: MethodOptions, database: &Database) -> Result<Prepared> {
    let options = options.plans.check()?;
    let started = Instant::now();
    let smooth = SmoothQuads::new(model.topology());
    let mut regular = pass("quadtree_regular", 16, twin::regular, options);
    // Masks of Catmull-Clark have no negative weights: a limit is within the hull of what it is a sum of.
    regular.hull = Some(|_, _| 16);
    regular.is_spline = true;
    let [mut short, mut long] =
        ["quadtree", "quadtree_long"].map(|shader| Planning::new(shader, options));
    let parts = patches::parts(model);
    let is_regular = |part: &&Part| smooth.is_regular(part.face);
    let regular_count = parts.iter().filter(is_regular).count();
    reserve(&mut regular, regular_count, 16);
    reserve(&mut short.pass, parts.len() - regular_count, RING);
    let mut all = Vec::with_capacity(AT_A_TIME.min(parts.len()));
    let crowded = bounded::is_crowded(model.topology());
    let mut rest = &parts[..];
    while !rest.is_empty() {
        let parts;
        (parts, rest) = rest.split_at(match crowded {
            true => bounded::some(model.topology(), rest, AT_A_TIME),
            false => AT_A_TIME.min(rest.len()),
        });
        let found = parts.par_iter().map(|&part| found(model, &smooth, part));
        found.collect_into_vec(&mut all);
        for (&part, found) in parts.iter().zip(all.drain(..)) {
            let Found {
                mut patch,
                texture,
                surroundings,
            } = found;
            let planning = match &surroundings {
                Surroundings::Regular(vertices) => {
                    patch.controls = regular.controls.len() as u32;
                    regular.controls.extend_from_slice(vertices);
                    regular.patches.push(patch);
                    regular.texture.push(texture);
                    continue;
                }
                Surroundings::Irregular(ring)
                    if ring.vertices.len() > abi::CONTROL_INVOCATIONS as usize =>
                {
                    &mut long
                }
                _ => &mut short,
            };
            planning.add(model.topology(), part, patch, texture, surroundings);
        }
    }
    drop((parts, all));
    let mut plans = PlanStatistics {
        regular: regular.patches.len(),
        vertex_bytes: size_of::<Vec3>() * model.mesh().vertex_count(),
        index_bytes: size_of_val(&regular.controls[..]),
        ..PlanStatistics::default()
    };
    let topology = model.topology();
    let mut irregular =
        |planning| irregular(topology, &smooth, planning, options, database, &mut plans);
    let short = irregular(short)?;
    let long = irregular(long)?;
    plans.build_seconds = started.elapsed().as_secs_f64();
    Ok(Prepared {
        plans: Some(plans),
        cached: Some(cached::cached_points),
        ..Prepared::of([regular, short, long])
    })
}

fn found(model: &Model, smooth: &SmoothQuads<'_>, part: Part) -> Found {
    let topology = model.topology();
    let surroundings = surroundings(topology, smooth, part);
    let quad = topology.face(part.face).len() == 4;
    let turn = match &surroundings {
        Surroundings::Smooth(start, _) => start.corner,
        Surroundings::Irregular(ring) if quad => ring.start,
        _ => 0,
    };
    let mut patch = patches::patch(model, part, turn);
    patch.flags |= match &surroundings {
        Surroundings::Regular(_) => turned_corners(topology, smooth, part.face),
        Surroundings::Smooth(start, ring) => ring_flags(ring.vertices(), start.mirrored),
        Surroundings::Irregular(ring) => ring_flags(&ring.vertices, ring.mirrored),
    };
    Found {
        patch,
        texture: patches::texture(model, part, turn),
        surroundings,
    }
}

fn ring_flags(vertices: &[u32], mirrored: bool) -> u32 {
    let size = (vertices.len() as u32).min(abi::CONTROL_INVOCATIONS);
    let mirrored = if mirrored { abi::PATCH_MIRRORED } else { 0 };
    size << abi::PATCH_RING_SHIFT | mirrored
}

fn surroundings(topology: &Topology, smooth: &SmoothQuads<'_>, part: Part) -> Surroundings {
    let face = part.face;
    if let Some(vertices) = smooth.regular(face) {
        return Surroundings::Regular(vertices);
    }
    let found = smooth.start(face);
    if let Some((start, ring)) = found.and_then(|start| Some((start, smooth.ring(face, start)?))) {
        return Surroundings::Smooth(start, ring);
    }
    let ring = match topology.face(face).len() {
        4 => Ring::of_quad(topology, face),
        _ => Ring::of_part(topology, face, part.corner),
    };
    Surroundings::Irregular(ring.expect("parts are the topology's own").into())
}

/// Irregular patches on their way to a pass, and the different configurations that they have.
struct Planning {
    pass: Pass,
    records: Vec<Record>,
    wanted: Wanted,
    /// Those of smooth rings, by their keys.
    smooth: FxHashMap<u32, u32>,
}

impl Planning {
    fn new(shader: &'static str, options: PlanOptions) -> Planning {
        Planning {
            pass: pass(shader, abi::CONTROL_INVOCATIONS, twin::irregular, options),
            records: Vec::new(),
            wanted: Wanted::default(),
            smooth: FxHashMap::default(),
        }
    }

    fn add(
        &mut self,
        topology: &Topology,
        part: Part,
        mut patch: abi::Patch,
        texture: [[f32; 2]; 4],
        surroundings: Surroundings,
    ) {
        let pass = &mut self.pass;
        patch.controls = pass.controls.len() as u32;
        pass.patches.push(patch);
        pass.texture.push(texture);
        let mut number = |configuration| self.wanted.number(Kind::Inside, configuration);
        let record = match surroundings {
            Surroundings::Regular(_) => unreachable!("it needs no plan"),
            Surroundings::Smooth(start, ring) => {
                let order = ring.order().iter().copied().map(u16::from);
                push_ring(&mut pass.controls, ring.vertices(), order);
                let plan = self.smooth.entry(start.key).or_insert_with(|| {
                    let ring = Ring::of_quad(topology, part.face);
                    number(ring.expect("a smooth face is a quad").configuration)
                });
                Record {
                    part,
                    plan: *plan,
                    ring_size: ring.vertices().len() as u32,
                    start: start.corner as u8,
                    mirrored: start.mirrored,
                    is_smooth: true,
                }
            }
            Surroundings::Irregular(ring) => {
                push_ring(
                    &mut pass.controls,
                    &ring.vertices,
                    order(&ring.vertices).into_iter(),
                );
                Record {
                    part,
                    plan: number(ring.configuration),
                    ring_size: ring.vertices.len() as u32,
                    start: ring.start as u8,
                    mirrored: ring.mirrored,
                    is_smooth: false,
                }
            }
        };
        self.records.push(record);
    }
}

/// The pass of the patches that need plans. Those with long rings have shaders of their own, which need not pay for others.
fn irregular(
    topology: &Topology,
    smooth: &SmoothQuads<'_>,
    planning: Planning,
    options: PlanOptions,
    database: &Database,
    statistics: &mut PlanStatistics,
) -> Result<Pass> {
    let Planning {
        mut pass,
        records,
        wanted,
        ..
    } = planning;
    pass.cached = Some("quadtree_cached");
    pass.cell = Some(twin::cell);
    pass.hull = Some(twin::ring_size);
    pass.patches.shrink_to_fit();
    pass.texture.shrink_to_fit();
    pass.controls.shrink_to_fit();
    let plans = wanted.plans(options, database)?;
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
    let patches = Irregulars {
        records: &records,
        pass: &pass,
    };
    let given = Given {
        topology,
        smooth,
        patches: &patches,
        plans: &insides,
    };
    let borders = Borders::new(given, &mut packed, options, database)?;
    drop(records);
    for (patch, &border) in pass.patches.iter_mut().zip(&borders.numbers) {
        patch.plan = border;
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
    let [rows, sets, patterns] = packed.rows.into_words();
    pass.tables = vec![
        Table::of(&packed.nodes),
        Table::of_words(packed.points, 2),
        Table::of_words(rows, 2),
        Table::of_words(sets, 1),
        Table::of_words(patterns, 1),
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
        // How many patches have each border.
        let mut counts = vec![0u64; pass.scratch_points.len()];
        for patch in &pass.patches {
            counts[patch.plan as usize] += 1;
        }
        let points = |level: u32| -> u64 {
            let all = counts.iter().zip(&pass.scratch_points);
            all.map(|(count, points)| count * u64::from(points[level as usize]))
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
fn turned_corners(topology: &Topology, smooth: &SmoothQuads<'_>, face: u32) -> u32 {
    let turned =
        |&corner: &u32| is_turned_corner(topology, smooth, face, corner) != (corner % 2 == 1);
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

/// By their numbers.
const NODE_KINDS: [NodeKind; 6] = [
    NodeKind::Internal,
    NodeKind::Regular,
    NodeKind::Boundary,
    NodeKind::Crease,
    NodeKind::Terminal,
    NodeKind::Extraordinary,
];
