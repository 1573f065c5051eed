//! `quadtree`: adaptive quadtrees (Brainerd et al. 2016). Regular faces are plain B-spline patches (section 7.1); every other face brings
//! its 1-ring and a plan, whose stencils the control shader runs and whose quadtree the evaluation shader walks.

use std::time::Instant;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::abi;
use crate::error::Result;
use crate::mesh::Model;
use crate::mesh::topology::Topology;
use crate::method::patches::{self, Part};
use crate::method::{Contract, Domain, Method, Pass, Prepared, Surface};
use crate::patch::bspline::{Basis, basis};
use crate::patch::crease::crease_basis;
use crate::plan::{Catalogue, Leaf, NodeKind, PackedPlans, PlanOptions, Plans, Ring, walk};
use crate::subdivision::{BsplinePatch, ControlPoint, bspline_patch};

/// The row of the table.
pub const METHOD: Method = Method {
    name: "quadtree",
    summary: "the exact Catmull-Clark limit, by adaptive quadtrees",
    paper: "Brainerd, Foley, Kraemer, Moreton, Nießner 2016",
    domain: Domain::Quads,
    contract: Contract {
        limit: Some(1e-6),
        normals: Some(0.1),
        interpolates: false,
        watertight: false,
    },
    prepare,
};

/// What `hullform plan` tells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanStatistics {
    /// Regular patches.
    pub regular: usize,
    /// All others.
    pub irregular: usize,
    /// Different plans of the irregular patches.
    pub plans: usize,
    /// Nodes of each kind, in the order internal, regular, boundary, crease, terminal, extraordinary.
    pub nodes: [usize; 6],
    /// Stencils over all plans.
    pub stencils: usize,
    /// Bytes of control vertices.
    pub vertex_bytes: usize,
    /// Bytes of the lists of control vertices.
    pub index_bytes: usize,
    /// Bytes of the quadtrees.
    pub quadtree_bytes: usize,
    /// Bytes of the stencils.
    pub stencil_bytes: usize,
    /// Bytes of scratch if every irregular patch kept a slot for its deepest level.
    pub scratch_worst_case_bytes: usize,
    /// Points over all irregular patches at each level.
    pub control_points: [u64; abi::HIGHEST_LEVEL as usize + 1],
    /// Seconds for configurations, plans and packing.
    pub build_seconds: f64,
}

/// A part on its way to a patch.
enum Surroundings {
    Regular(Part, [u32; 16]),
    Irregular(Part, Ring),
}

fn prepare(model: &Model, options: PlanOptions) -> Result<Prepared> {
    let options = options.check()?;
    let started = Instant::now();
    let topology = model.topology();
    let found: Vec<Surroundings> = patches::parts(model)
        .into_par_iter()
        .map(|part| surroundings(topology, part))
        .collect();
    let mut regular = pass("quadtree_regular", 16, regular_twin, options);
    let mut irregular = pass(
        "quadtree",
        abi::CONTROL_INVOCATIONS,
        irregular_twin,
        options,
    );
    let mut catalogue = Catalogue::default();
    for part in found {
        match part {
            Surroundings::Regular(part, vertices) => {
                add(&mut regular, model, part, 0, &vertices, 0)
            }
            Surroundings::Irregular(part, ring) => {
                let plan = catalogue.number(ring.configuration);
                let turn = if topology.face(part.face).len() == 4 {
                    ring.start
                } else {
                    0
                };
                add(&mut irregular, model, part, turn, &ring.vertices, plan);
            }
        }
    }
    let mut packed = PackedPlans::default();
    catalogue
        .build(options)
        .iter()
        .for_each(|plan| packed.push(plan));
    irregular.scratch_points = packed.headers.iter().map(|header| header.counts).collect();
    irregular.tables = vec![
        bytemuck::cast_slice(&packed.headers).to_vec(),
        bytemuck::cast_slice(&packed.nodes).to_vec(),
        packed.points.clone(),
        bytemuck::cast_slice(&packed.weights).to_vec(),
    ];
    let mut plans = statistics(model, &regular, &irregular, &packed);
    plans.build_seconds = started.elapsed().as_secs_f64();
    let passes = [regular, irregular]
        .into_iter()
        .filter(|pass| !pass.patches.is_empty())
        .collect();
    Ok(Prepared {
        passes,
        plans: Some(plans),
    })
}

fn pass(
    shader: &'static str,
    control_points: u32,
    twin: super::Twin,
    options: PlanOptions,
) -> Pass {
    Pass {
        shader,
        control_points,
        patches: Vec::new(),
        controls: Vec::new(),
        texture: Vec::new(),
        tables: Vec::new(),
        scratch_points: Vec::new(),
        max_level: options.max_level,
        twin,
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

fn add(pass: &mut Pass, model: &Model, part: Part, turn: u32, vertices: &[u32], plan: u32) {
    let mut patch = patches::patch(model.topology(), part, turn);
    patch.controls = pass.controls.len() as u32;
    patch.plan = plan;
    pass.controls.extend_from_slice(vertices);
    pass.texture.push(patches::texture(model, part, turn));
    pass.patches.push(patch);
}

fn statistics(
    model: &Model,
    regular: &Pass,
    irregular: &Pass,
    packed: &PackedPlans,
) -> PlanStatistics {
    let kinds = [
        NodeKind::Internal,
        NodeKind::Regular,
        NodeKind::Boundary,
        NodeKind::Crease,
        NodeKind::Terminal,
        NodeKind::Extraordinary,
    ];
    let points = |level: usize| -> u64 {
        (0..irregular.patches.len())
            .map(|patch| u64::from(irregular.points(patch, level as u32)))
            .sum()
    };
    PlanStatistics {
        regular: regular.patches.len(),
        irregular: irregular.patches.len(),
        plans: packed.headers.len(),
        nodes: kinds.map(|kind| packed.count(kind)),
        stencils: packed
            .headers
            .iter()
            .map(|header| header.counts[header.max_level as usize] as usize)
            .sum(),
        vertex_bytes: size_of::<Vec3>() * model.mesh().vertex_count(),
        index_bytes: size_of_val(&regular.controls[..]) + size_of_val(&irregular.controls[..]),
        quadtree_bytes: packed.quadtree_bytes(),
        stencil_bytes: packed.stencil_bytes(),
        scratch_worst_case_bytes: 16 * points(irregular.max_level as usize) as usize,
        control_points: std::array::from_fn(points),
        build_seconds: 0.0,
    }
}

/// The sixteen products of two bases, with control points from `point`. Twin of `glsl/lib/bspline.glsl`.
fn bspline(
    u: Basis<f32>,
    v: Basis<f32>,
    scale: f32,
    point: impl Fn(usize, usize) -> Vec3,
) -> Surface {
    let mut surface = Surface::default();
    for y in 0..4 {
        let (mut row, mut row_du) = (Vec3::ZERO, Vec3::ZERO);
        for x in 0..4 {
            let point = point(x, y);
            row += u.value[x] * point;
            row_du += u.derivative[x] * point;
        }
        surface.position += v.value[y] * row;
        surface.du += v.value[y] * row_du;
        surface.dv += v.derivative[y] * row;
    }
    Surface {
        du: scale * surface.du,
        dv: scale * surface.dv,
        ..surface
    }
}

fn regular_twin(pass: &Pass, positions: &[Vec3], patch: usize, uv: Vec2) -> Surface {
    let controls = &pass.controls[pass.patches[patch].controls as usize..];
    bspline(basis(uv.x), basis(uv.y), 1.0, |x, y| {
        positions[controls[x + 4 * y] as usize]
    })
}

/// Runs the stencils that the point needs, and evaluates it; from the same bytes as the shaders. Like them it takes the ring relative to
/// its first vertex: tangents deep in the tree are differences of small numbers then, instead of small differences of large ones.
fn irregular_twin(pass: &Pass, positions: &[Vec3], patch: usize, uv: Vec2) -> Surface {
    let plans = plans(pass);
    let abi::Patch { controls, plan, .. } = pass.patches[patch];
    let header = plans.headers[plan as usize];
    let ring = &pass.controls[controls as usize..][..header.ring_size as usize];
    let origin = positions[ring[0] as usize];
    let local: Vec<Vec3> = ring
        .iter()
        .map(|&vertex| positions[vertex as usize] - origin)
        .collect();
    let stencil = |number: u32| {
        let weights = &plans.weights[(header.weights + number * header.ring_size) as usize..];
        weighted_sum(&local, weights)
    };
    match walk(plans, plan, uv) {
        Leaf::Corner(corner) => {
            let [position, du, dv] = [0, 1, 2].map(|i| stencil(3 * corner + i));
            Surface {
                position: position + origin,
                du,
                dv,
            }
        }
        Leaf::Bspline {
            points,
            stride,
            uv,
            scale,
            edge,
            sharpness,
            ..
        } => {
            let (u, v) = creased(uv, edge, sharpness);
            let local = bspline(u, v, scale, |x, y| {
                stencil(plans.point(points + x as u32 + stride * y as u32))
            });
            Surface {
                position: local.position + origin,
                ..local
            }
        }
    }
}

/// The sum of weighted points, in the order and the manner of the control shader: rings of more than 32 vertices are summed with
/// compensation (Kahan 1965), since where hundreds of faces meet, the tangents of neighbours differ by less than a plain sum would lose.
fn weighted_sum(points: &[Vec3], weights: &[f32]) -> Vec3 {
    let terms = points
        .iter()
        .zip(weights)
        .map(|(&point, &weight)| weight * point);
    if points.len() <= abi::CONTROL_INVOCATIONS as usize {
        return terms.fold(Vec3::ZERO, |sum, term| sum + term);
    }
    let (mut sum, mut lost) = (Vec3::ZERO, Vec3::ZERO);
    for term in terms {
        let rest = term - lost;
        let next = sum + rest;
        lost = (next - sum) - rest;
        sum = next;
    }
    sum
}

/// The bases in both directions; across a crease on one of the edges the crease's own. Twin of `glsl/lib/crease.glsl`.
fn creased(uv: Vec2, edge: u32, sharpness: f32) -> (Basis<f32>, Basis<f32>) {
    let (mut u, mut v) = (basis(uv.x), basis(uv.y));
    if sharpness > 0.0 {
        match edge {
            0 => v = crease_basis(uv.y, sharpness),
            1 => u = reversed(crease_basis(1.0 - uv.x, sharpness)),
            2 => v = reversed(crease_basis(1.0 - uv.y, sharpness)),
            _ => u = crease_basis(uv.x, sharpness),
        }
    }
    (u, v)
}

/// The basis of the curve run backwards.
fn reversed(basis: Basis<f32>) -> Basis<f32> {
    let Basis {
        mut value,
        mut derivative,
    } = basis;
    value.reverse();
    derivative.reverse();
    Basis {
        value,
        derivative: derivative.map(|weight| -weight),
    }
}

fn plans(pass: &Pass) -> Plans<'_> {
    Plans {
        headers: bytemuck::cast_slice(&pass.tables[0]),
        nodes: bytemuck::cast_slice(&pass.tables[1]),
        points: &pass.tables[2],
        weights: bytemuck::cast_slice(&pass.tables[3]),
    }
}
