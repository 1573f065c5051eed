//! Hubs of a mesh: what they become in refinement is computed once a pose, and given to the plans of all patches there.
//!
//! Where n faces meet in a vertex, the limit of each depends on all n, and so do the n parts of an n-gon: rings and sums of the square of what the file has
//! (Brainerd et al. 2016, section 4.3). But it does so only by what the vertex in the middle becomes, level by level. With these as points of their own
//! ([`Points`]), the ring of a patch beside a hub is what is near, and the same limit takes some fifty terms a point instead of thousands.

use rayon::prelude::*;

use crate::abi;
use crate::error::Result;
use crate::mesh::CreaseMethod;
use crate::mesh::sharpness::is_infinite;
use crate::mesh::topology::{Hub, Hubs, Topology};
use crate::method::Points;
use crate::method::points::Row;
use crate::method::quadtree::subjects::Point;
use crate::plan::{HubPlan, Middle, PlanOptions};
use crate::subdivision::Mask;

/// More faces around a vertex, or corners of a face, make a hub. Fewer have hardly more around them than what is near.
const MANY: usize = 64;

/// The hubs of a mesh. What is given of them is named by `HUB_POINT` and the numbers of points, all of one hub behind those of the one before.
pub fn hubs(topology: &Topology, options: PlanOptions) -> Hubs {
    // The tree ends at the last level; halves of edges, and centres of n-gons, are a level farther each.
    let count = options.max_level.max(2) + 3 + 1;
    let mut next = abi::HUB_POINT;
    let mut hub = |at: u32| {
        let first = next;
        next += count;
        Hub { at, first, count }
    };
    let vertices = 0..topology.vertex_count() as u32;
    let crowded = vertices.filter(|&vertex| topology.vertex_faces(vertex).len() > MANY);
    let crowded: Vec<u32> = crowded.collect();
    let vertices = crowded.iter().copied();
    let vertices = vertices.filter(|&vertex| is_hub(topology, vertex));
    let vertices = vertices.map(&mut hub).collect();
    let faces = 0..topology.face_count() as u32;
    let faces = match topology.quads() {
        Some(_) => Vec::new(),
        None => faces
            .filter(|&face| is_large(topology, face) && !is_doubled(topology, face))
            .map(&mut hub)
            .collect(),
    };
    Hubs::new(vertices, faces).with_dividing(dividing(topology, crowded))
}

/// The vertices, of those with very many faces, at which each face has the limit for itself: corners for ever, and where all faces have the same two infinite
/// creases. Where such a crease has several faces, each has it for itself: for the same bits its other end must be such a vertex as well, so that it depends on
/// creases alone.
fn dividing(topology: &Topology, mut among: Vec<u32>) -> Vec<u32> {
    among.retain(|&vertex| is_corner(topology, vertex) || is_between_creases(topology, vertex));
    loop {
        let is_sound = |&vertex: &u32| {
            infinite_edges(topology, vertex).all(|edge| {
                let to = topology.edge(edge).other(vertex);
                topology.edge_faces(edge).len() < 2 || among.binary_search(&to).is_ok()
            })
        };
        let sound: Vec<u32> = among.iter().copied().filter(is_sound).collect();
        if sound.len() == among.len() {
            return sound;
        }
        among = sound;
    }
}

fn infinite_edges(topology: &Topology, vertex: u32) -> impl Iterator<Item = u32> + '_ {
    let sharp = topology.sharp_edges(vertex);
    sharp.filter(|&edge| is_infinite(topology.edge(edge).sharpness))
}

/// Whether a vertex stays where it is, whatever becomes of semi-sharp edges.
fn is_corner(topology: &Topology, vertex: u32) -> bool {
    let infinite = infinite_edges(topology, vertex).count();
    let all = topology.sharp_edges(vertex).count();
    let chaikin = topology.options().creasing == CreaseMethod::Chaikin;
    (infinite > 2 || is_infinite(topology.vertex_sharpness(vertex))) && !(chaikin && all > infinite)
}

/// Whether all faces at a vertex are between its two infinite creases, and nothing else is sharp there. Sums over more than a few vertices are taken in another way.
fn is_between_creases(topology: &Topology, vertex: u32) -> bool {
    let edges = topology.vertex_edges(vertex);
    edges.len() == 2
        && infinite_edges(topology, vertex).count() == 2
        && topology.vertex_sharpness(vertex) == 0.0
        && topology
            .vertex_faces(vertex)
            .iter()
            .all(|at| topology.face(at.face).len() <= 4)
}

/// Whether faces on an edge have it each for itself.
pub fn is_divided(topology: &Topology, edge: u32) -> bool {
    let own = topology.edge(edge);
    topology.divides(own.vertices[0])
        && is_infinite(own.sharpness)
        && topology.edge_faces(edge).len() > 1
}

/// Whether very many faces go all the way around a vertex, one infinite crease at most between them, or from boundary to boundary, and have one tangent plane
/// there. Under Chaikin's rule the sharpness of an edge there depends on all others.
fn is_hub(topology: &Topology, vertex: u32) -> bool {
    let (around, edges) = (topology.vertex_faces(vertex), topology.vertex_edges(vertex));
    if is_infinite(topology.vertex_sharpness(vertex)) {
        return false;
    }
    let boundary = edges
        .iter()
        .filter(|&&edge| topology.edge_faces(edge).len() == 1);
    let boundary = boundary.count();
    let infinite = infinite_edges(topology, vertex).count();
    let chaikin = topology.options().creasing == CreaseMethod::Chaikin;
    let is_sharp = topology.sharp_edges(vertex).count() > infinite;
    matches!((boundary, infinite), (0, 0 | 1) | (2, 2))
        && edges.len() == around.len() + boundary / 2
        && !(chaikin && is_sharp)
        && topology.fan(around[0].face, around[0].corner).faces.len() == around.len()
}

fn is_large(topology: &Topology, face: u32) -> bool {
    topology.face(face).len() > MANY
}

/// Whether a face lies back to back with another large one, along two edges in a row at least. Where two sheets fold into one, derivatives across their rim are sums
/// that cancel, which they do to the last bit only if they are over the same vertices.
fn is_doubled(topology: &Topology, face: u32) -> bool {
    let beyond = |&edge: &u32| match *topology.edge_faces(edge) {
        [a, b] => Some(if a == face { b } else { a }),
        _ => None,
    };
    let edges = topology.face_edges(face);
    let next = edges.iter().cycle().skip(1);
    edges.iter().zip(next).any(|(edge, next)| {
        let other = beyond(edge);
        other == beyond(next) && other.is_some_and(|other| is_large(topology, other))
    })
}

/// The hub that a corner of a patch is.
pub fn hub_of(topology: &Topology, point: Point) -> Option<Hub> {
    match point {
        Point::Vertex(vertex) => topology.hub_at(vertex),
        Point::Centre(face) => topology.hub_of(face),
        Point::Corner { .. } => None,
    }
}

/// The number of the point that has the normal of a hub: behind all that are given.
pub fn normal_of(hubs: &Hubs, hub: Hub) -> u32 {
    hubs.given() as u32 + number_of(hub.first) / hub.count
}

/// The number of a point that is named among control vertices.
pub fn number_of(named: u32) -> u32 {
    named & !abi::HUB_POINT
}

/// Whether a number among control vertices names a point.
pub fn is_point(named: u32) -> bool {
    named & abi::HUB_POINT != 0
}

/// How the points of hubs are computed: what is given of all, then their normals, and those that stand in for them. The topology is the mesh's own, without hubs.
///
/// # Errors
/// As [`HubPlan::build`].
pub fn points(topology: &Topology, hubs: &Hubs, options: PlanOptions) -> Result<Points> {
    let mut points = Points::default();
    if hubs.is_empty() {
        return Ok(points);
    }
    let vertices = hubs.vertices().iter();
    let vertices = vertices.map(|hub| (Middle::Vertex(hub.at), hub.count));
    let faces = hubs.faces().iter();
    let faces = faces.map(|hub| (Middle::Face(hub.at), hub.count));
    let all: Vec<(Middle, u32)> = vertices.chain(faces).collect();
    let plans: Vec<HubPlan> = all
        .par_iter()
        .map(|&(middle, count)| HubPlan::build(topology, middle, count - 1, options))
        .collect::<Result<_>>()?;
    points.begin(abi::POINTS_HUB, 0);
    for plan in &plans {
        for weights in &plan.given {
            points.push(Row::Hub {
                anchor: plan.vertices[0],
                mask: &mask(plan, weights),
            });
        }
    }
    for spare in [false, true] {
        let kinds = [abi::POINTS_LIMIT, abi::POINTS_SPARE];
        points.begin(kinds[usize::from(spare)], hubs.given() as u32);
        for plan in &plans {
            let limit = plan.given.last().map(|weights| mask(plan, weights));
            let [du, dv] = plan.tangents(spare).each_ref();
            let [du, dv] = [du, dv].map(|weights| mask(plan, weights));
            points.push(Row::Limit([&limit.unwrap_or_default(), &du, &dv]));
        }
    }
    Ok(points)
}

fn mask(plan: &HubPlan, weights: &[f64]) -> Mask {
    let terms = plan.vertices.iter().zip(weights);
    let terms = terms.filter(|term| *term.1 != 0.0);
    terms.map(|(&vertex, &weight)| (vertex, weight)).collect()
}
