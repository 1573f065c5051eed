//! `quadtree`: adaptive quadtrees (Brainerd et al. 2016). Regular faces are plain B-spline patches (section 7.1); every other face brings
//! its 1-ring and a plan, whose stencils the control shader runs and whose quadtree the evaluation shader walks.

mod agreement;
mod border;
mod bounded;
mod cached;
mod configurations;
mod corner;
mod hubs;
mod in_ring;
mod irregular;
mod log;
mod macro_faces;
mod places;
mod plain;
mod planned;
mod planner;
#[cfg(feature = "vulkan")]
mod recached;
mod run;
mod sides;
mod store;
mod subjects;
mod surroundings;
mod twin;
mod view;

use std::time::Instant;

use glam::Vec3;

use crate::abi;
use crate::error::Result;
use crate::mesh::topology::Hubs;
use crate::mesh::{ChangeSet, Model, Scheme};
use crate::method::editable::Edits;
use crate::method::patches;
use crate::method::{
    Contract, MacroFaces, Method, MethodOptions, Pass, PassChange, Prepared, Reproduces,
};
use crate::plan::database::Entry;
use crate::plan::{Database, NodeKind, PlanOptions, SmoothQuads};
use crate::tessellation::Domain;

use planned::Planned;
use planner::{Planner, Wanted};
#[cfg(feature = "host")]
pub(crate) use twin::node_kind;

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
    isolates: false,
    aggregates: true,
    dynamic: false,
    covers: bounded::check,
    prepare,
    edits: Some(editable),
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

/// Most short rings and their orders take less.
const RING: usize = 36;

/// Makes room for patches of so many control vertices.
fn reserve(pass: &mut Pass, patches: usize, controls: usize) {
    pass.patches.reserve_exact(patches);
    pass.texture.reserve_exact(patches);
    pass.controls.reserve_exact(patches * controls);
}

fn prepare(model: &Model, options: MethodOptions, database: &Database) -> Result<Prepared> {
    let faces = options.macro_faces.check()?;
    let (mut prepared, planner) = planned(model, options, database, false)?;
    planner.give(&mut prepared.passes);
    if faces != MacroFaces::None {
        let single = std::mem::take(&mut prepared.passes);
        prepared.passes = macro_faces::aggregated(single, model, faces);
    }
    // Passes without patches are left out.
    let Prepared {
        passes,
        points,
        plans,
        cached,
        ..
    } = prepared;
    Ok(Prepared {
        points,
        plans,
        cached,
        macro_faces: faces,
        ..Prepared::of(passes)
    })
}

fn editable(
    model: &Model,
    options: MethodOptions,
    database: &Database,
) -> Result<(Prepared, Box<dyn Edits>)> {
    bounded::check_without_hubs(model)?;
    let (prepared, planner) = planned(model, options, database, true)?;
    Ok((prepared, Box::new(planner)))
}

impl Edits for Planner {
    fn spare(&mut self, prepared: &mut Prepared) {
        Planner::spare(self, &mut prepared.passes);
    }

    fn edit(
        &mut self,
        prepared: &mut Prepared,
        model: &Model,
        changes: &ChangeSet,
        database: &Database,
    ) -> Result<Vec<PassChange>> {
        let faces = changes.faces();
        let (parts, gone) = patches::parts_of(model, faces);
        self.renumber(changes, model.topology());
        let wanted = Wanted {
            faces: Some(faces),
            parts: parts.into_iter(),
            gone: &gone,
        };
        let smooth = SmoothQuads::new(model.topology());
        self.plan(&mut prepared.passes, model, &smooth, wanted, database)
    }
}

/// All three passes, and what planned them: with their tables where it keeps what edits need.
fn planned(
    model: &Model,
    options: MethodOptions,
    database: &Database,
    keeps: bool,
) -> Result<(Prepared, Planner)> {
    let options = options.plans.check()?;
    let started = Instant::now();
    // What is edited has rings that tell all.
    let hubs = match keeps {
        true => Hubs::default(),
        false => hubs::hubs(model.topology(), options),
    };
    let points = hubs::points(model.topology(), &hubs, options)?;
    let hubbed = (!hubs.is_empty()).then(|| model.topology().clone().with_hubs(hubs));
    let smooth = SmoothQuads::new(hubbed.as_ref().unwrap_or(model.topology()));
    let parts = || patches::each_part(model);
    let [mut regular, mut all] = [0; 2];
    for part in parts() {
        regular += usize::from(smooth.is_regular(part.face));
        all += 1;
    }
    let mut passes = passes(options);
    reserve(&mut passes[0], regular, 16);
    reserve(&mut passes[1], all - regular, RING);
    let mut planner = Planner::new(options, keeps);
    let wanted = Wanted {
        faces: None,
        parts: parts(),
        gone: &[],
    };
    planner.plan(&mut passes, model, &smooth, wanted, database)?;
    drop(smooth);
    for pass in &mut passes {
        pass.patches.shrink_to_fit();
        pass.texture.shrink_to_fit();
        pass.controls.shrink_to_fit();
    }
    let mut plans = PlanStatistics {
        vertex_bytes: size_of::<Vec3>() * model.mesh().vertex_count(),
        ..PlanStatistics::of(&passes, planner.planned())
    };
    plans.build_seconds = started.elapsed().as_secs_f64();
    let prepared = Prepared {
        passes,
        points,
        plans: Some(plans),
        cached: Some(cached::cached_points),
        #[cfg(feature = "vulkan")]
        recached: Some(recached::edited_points),
        ..Prepared::default()
    };
    Ok((prepared, planner))
}

/// The passes without patches, in the order of [`log::PASSES`]. Patches with long rings have shaders of their own, which need not pay for others.
fn passes(options: PlanOptions) -> Vec<Pass> {
    let mut regular = pass("quadtree_regular", 16, twin::regular, options);
    // Masks of Catmull-Clark have no negative weights: a limit is within the hull of what it is a sum of.
    regular.hull = Some(|_, _| 16);
    regular.is_spline = true;
    regular.tangents = Some(twin::regular_tangents);
    let irregular = ["quadtree", "quadtree_long"].map(|shader| Pass {
        cached: Some("quadtree_cached"),
        cell: Some(twin::cell),
        tangents: Some(twin::irregular_tangents),
        hull: Some(twin::hull_size),
        ..pass(shader, abi::CONTROL_INVOCATIONS, twin::irregular, options)
    });
    std::iter::once(regular).chain(irregular).collect()
}

impl PlanStatistics {
    /// Of passes that were planned at once.
    fn of(passes: &[Pass], planned: &[Planned; 2]) -> PlanStatistics {
        let mut statistics = PlanStatistics {
            regular: passes[0].patches.len(),
            index_bytes: size_of_val(&passes[0].controls[..]),
            ..PlanStatistics::default()
        };
        for (pass, planned) in passes[1..].iter().zip(planned) {
            statistics.add(pass, planned);
        }
        statistics
    }

    fn add(&mut self, pass: &Pass, planned: &Planned) {
        let [insides, edges, vertices] = planned.counts();
        self.plans += insides;
        self.edge_plans += edges;
        self.vertex_plans += vertices;
        let packed = &planned.store.packed;
        for entry in planned.store.entries() {
            let Entry::Inside(plan) = entry else { continue };
            self.stencils += plan.stencils.len();
            for node in &plan.nodes {
                let kind = NODE_KINDS.iter().position(|&kind| kind == node.kind());
                if let Some(kind) = kind {
                    self.nodes[kind] += 1;
                }
            }
        }
        let (inside_bytes, borders) = (planned.inside_bytes, &planned.borders);
        self.quadtree_bytes += inside_bytes;
        self.border_bytes += packed.quadtree_bytes() - inside_bytes
            + size_of_val(&borders.records[..])
            + size_of_val(&borders.uses[..])
            + size_of_val(&borders.ends[..]);
        self.stencil_bytes += packed.stencil_bytes();
        self.add_points(pass);
    }

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
