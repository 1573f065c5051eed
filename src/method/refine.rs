//! `refine`: uniform refinement on the device, as it was done before there were tessellators and is done again (Shiue, Jones, Peters 2005, "A realtime GPU subdivision
//! kernel"; Dupuy, Vanhoey 2021, "A halfedge refinement rule for parallel Catmull-Clark subdivision"): a compute pass a level writes all vertices of the next
//! level, and the faces of the last are drawn as they are. The memory-bound alternative: each vertex of each level is written and read again, and nothing is
//! evaluated. What a vertex is summed from is found by walking half-edges in each frame (2021); here a table has it, made once a topology, which is more to read and less
//! to compute. Vertices of the last level are moved to the limit, and have the normal of the faces around them.
//!
//! Patches are faces of the last level, so by default tess levels say nothing: what is drawn is as fine as [`IsolationOptions::level`]. With the back-end `pattern`
//! they are instances of two triangles, without tessellation.

use glam::{Vec2, Vec3};
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::{Error, Result};
use crate::mesh::sharpness::is_infinite;
use crate::mesh::topology::Topology;
use crate::mesh::{Model, Scheme};
use crate::method::patches;
use crate::method::pieces::Cell;
use crate::method::points::{Points, Row};
use crate::method::quads::{quad_weight_changes, quad_weights, sum_of_four};
use crate::method::surface::{Controls, SurfacePoint};
use crate::method::unit::unit;
use crate::method::vertices::control_points;
use crate::method::{self, Contract, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::plan::Database;
use crate::subdivision::{Mask, deep_limit, refine};
use crate::tessellation::Domain;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "refine",
    summary: "uniform refinement by compute passes, its last vertices on the limit and its faces flat",
    paper: "Shiue, Jones, Peters 2005; Dupuy, Vanhoey 2021",
    schemes: &[Scheme::CatmullClark],
    domains: &[Domain::Quads],
    contract: Contract {
        reproduces: Reproduces::Itself,
        normals: None,
        interpolates: false,
        watertight: true,
    },
    uses_tables: false,
    isolates: true,
    aggregates: false,
    dynamic: false,
    covers: method::every_mesh,
    prepare,
    edits: None,
};

/// The bytes of a buffer that every device can bind (Vulkan spec, "Required Limits", `maxStorageBufferRange`).
const MOST_BYTES: u64 = 1 << 27;

fn prepare(model: &Model, options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let level = options.isolation.check()?.level;
    let has_parts = model.topology().quads().is_none();
    let level = level.max(u32::from(has_parts));
    check_size(model, level)?;
    let pass = Pass::new("refine", Domain::Quads, 1, quad).with_tangents(tangents);
    // Halved as often as faces are, a level is then 1.
    let mut pass = Pass {
        max_level: level.min(1),
        ..pass
    };
    let mut points = control_vertices(model);
    let mut cells: Vec<Cell> = patches::parts(model).into_iter().map(Cell::of).collect();
    let (mut topology, mut first) = (model.topology().clone(), 0);
    for _ in 0..level {
        let (refined, children) = step(&topology, &cells);
        points.begin(abi::POINTS_REFINE, points.count);
        let next = points.count;
        for mask in &refined.masks {
            points.push(Row::Blend(&shifted(mask, first)));
        }
        (topology, first, cells) = (refined.topology, next, children);
    }
    finish(model, (&topology, first), &cells, &mut points, &mut pass);
    Ok(Prepared {
        points,
        ..Prepared::of([pass])
    })
}

/// Refuses what devices may not be able to bind: a sum has about nine terms.
fn check_size(model: &Model, level: u32) -> Result<()> {
    // Those of the levels before are a third of the last, where each has three sums: of the vertex, of its limit, and of its normal.
    let term = size_of::<abi::PointTerm>() as u64;
    let vertices = (model.topology().face_count() as u64) << (2 * level);
    let bytes = term * (3 * 9 * vertices + 9 * (vertices / 3));
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    Err(Error::Option {
        option: "--isolation",
        problem: format!(
            "{level} refinements of all faces take about {bytes} bytes of weights, and devices may bind {MOST_BYTES} at most"
        ),
        remedy: "give fewer, a lower level, or choose a method that refines less (fas)".into(),
    })
}

/// The points of the control vertices themselves.
fn control_vertices(model: &Model) -> Points {
    let mut points = Points::default();
    points.begin(abi::POINTS_BLEND, 0);
    for vertex in 0..model.topology().vertex_count() as u32 {
        points.push(Row::Blend(&Mask::from_slice(&[(vertex, 1.0)])));
    }
    points
}

/// All faces refined once, and their children in order.
fn step(topology: &Topology, cells: &[Cell]) -> (crate::subdivision::Refinement, Vec<Cell>) {
    let children = cells.iter().flat_map(|cell| {
        let is_quad = topology.face(cell.face).len() == 4;
        let corners = if is_quad {
            0..4
        } else {
            cell.part.corner..cell.part.corner + 1
        };
        corners.map(move |corner| {
            let child = if is_quad { cell.child(corner) } else { *cell };
            ((cell.face, corner), child)
        })
    });
    let (corners, children): (Vec<(u32, u32)>, Vec<Cell>) = children.unzip();
    let refined = refine(topology, &corners);
    let numbered = (0..)
        .zip(children)
        .map(|(face, cell)| Cell { face, ..cell });
    (refined, numbered.collect())
}

/// A mask of vertices as one of points.
fn shifted(mask: &Mask, first: u32) -> Mask {
    let mut terms: Vec<(u32, f64)> = mask.iter().map(|&(v, w)| (first + v, w)).collect();
    terms.sort_by_key(|&(point, _)| point);
    terms.dedup_by(|next, sum| {
        let alike = next.0 == sum.0;
        if alike {
            sum.1 += next.1;
        }
        alike
    });
    terms.into_iter().collect()
}

/// Moves the vertices of the last level to the limit, each once a sector between infinite creases, with the normals of the faces there; and adds the patches.
fn finish(
    model: &Model,
    (topology, first): (&Topology, u32),
    cells: &[Cell],
    points: &mut Points,
    pass: &mut Pass,
) {
    let begin = points.count;
    let mut sectors: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    // What is around each, by one of its corners.
    let mut asked = Vec::new();
    // Any of a vertex: sectors have one place.
    let mut places: FxHashMap<u32, u32> = FxHashMap::default();
    points.begin(abi::POINTS_REFINE, begin);
    for cell in cells {
        for (corner, &vertex) in (0..).zip(topology.face(cell.face)) {
            let known = sectors.entry((vertex, sector(topology, cell.face, corner)));
            let face = known.key().1;
            known.or_insert_with(|| {
                let corner = topology.corner_of(face, vertex);
                let limit = deep_limit(topology, Scheme::CatmullClark, face, corner);
                let limit = limit.expect("the face has this corner").position;
                let number = points.count;
                points.push(Row::Blend(&shifted(&limit, first)));
                places.entry(vertex).or_insert(number);
                asked.push((face, corner));
                number
            });
        }
    }
    points.begin(abi::POINTS_RING, begin);
    for (middle, &(face, corner)) in (begin..).zip(&asked) {
        let fan = topology.fan(face, corner);
        // Vertices of holes beside have no limit of their own here: their triangles are left out by standing at the middle.
        let place = |vertex: u32| places.get(&vertex).copied().unwrap_or(middle);
        let mut ends = Vec::new();
        for &face in &fan.faces {
            let vertices = topology.face(face);
            let at = topology.corner_of(face, fan.vertex) as usize;
            ends.extend(
                (1..vertices.len() - 1).map(|i| place(vertices[(at + i) % vertices.len()])),
            );
        }
        if !fan.closed {
            let last = *fan.edges.last().expect("a fan has edges");
            ends.push(place(topology.edge(last).other(fan.vertex)));
        }
        let open = !fan.closed;
        points.push(Row::Ring {
            middle,
            ends: &ends,
            open,
        });
    }
    for cell in cells {
        let vertices = topology.face(cell.face);
        let number = |corner: u32| {
            let face = sector(topology, cell.face, corner);
            sectors[&(vertices[corner as usize], face)]
        };
        let mut record = cell.record(model, topology);
        record.flags |= creased(topology, cell.face);
        cell.add(pass, model, &[0, 1, 2, 3].map(number), record);
    }
}

/// By which face the sector around a corner is known: the same for all of its faces, where one that closes begins with the face that asks.
fn sector(topology: &Topology, face: u32, corner: u32) -> u32 {
    let fan = topology.fan(face, corner);
    match fan.closed {
        true => fan.faces.iter().copied().min().unwrap_or(face),
        false => fan.faces[0],
    }
}

/// Where a face has not the normals of those beside it.
fn creased(topology: &Topology, face: u32) -> u32 {
    let mut flags = 0;
    for (side, &edge) in topology.face_edges(face).iter().enumerate() {
        if topology.edge_faces(edge).len() > 1 && is_infinite(topology.edge(edge).sharpness) {
            flags |= abi::PATCH_CREASED << side;
        }
    }
    for (corner, &vertex) in (0..).zip(topology.face(face)) {
        if topology.fan(face, corner).faces.len() < topology.vertex_faces(vertex).len() {
            flags |= abi::PATCH_CREASED << (4 + corner);
        }
    }
    flags
}

fn quad(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let (corners, normals) = control_points::<4>(pass, given, patch);
    let weights = quad_weights(uv);
    SurfacePoint {
        position: sum_of_four(weights, corners),
        normal: unit(sum_of_four(weights, normals)),
    }
}

fn tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let (corners, _) = control_points::<4>(pass, given, patch);
    quad_weight_changes(uv).map(|weights| sum_of_four(weights, corners))
}

#[cfg(test)]
mod tests {
    //! Vertices are on the limit, and as many as there should be.

    use super::*;
    use crate::mesh::builtin;
    use crate::method::{IsolationOptions, to_ptex};
    use crate::subdivision::LimitSurface;

    #[test]
    fn corners_are_the_limit_and_quads_as_many_as_refinement_makes() {
        for (name, level) in [
            ("cube", 0),
            ("cube", 3),
            ("ngons", 2),
            ("hull", 1),
            ("creased-torus", 2),
        ] {
            let model = Model::new(builtin(name).expect("it is built in"));
            let options = IsolationOptions {
                level,
                ..IsolationOptions::default()
            };
            let prepared = METHOD.prepare(&model, options).expect("it takes the model");
            let controls = prepared.controls(model.positions());
            let truth = LimitSurface::new(model.mesh());
            let pass = &prepared.passes[0];
            let parts = patches::parts(&model);
            let quads = |part: &patches::Part| match model.topology().face(part.face).len() {
                4 => 1usize << (2 * level),
                _ => 1 << (2 * (level - 1)),
            };
            assert_eq!(pass.patches.len(), parts.iter().map(quads).sum::<usize>());
            let (mut away, mut turned) = (0.0f64, 0.0f64);
            for (patch, record) in pass.patches.iter().enumerate() {
                for uv in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
                    let [u, v] = to_ptex(record, uv).map(f64::from);
                    let right = truth.evaluate(record.ptex as usize, u, v);
                    let right = right.expect("it has a surface");
                    let own = pass.evaluate(&controls, patch, uv.into());
                    let distance = model.placement().local(right.position);
                    away = away.max(distance.distance(own.position.as_dvec3()) / model.diagonal());
                    let normal = own.normal.as_dvec3();
                    let degrees = normal
                        .cross(right.normal())
                        .length()
                        .atan2(normal.dot(right.normal()));
                    turned = turned.max(degrees.to_degrees());
                }
            }
            // Each vertex of the last level once, and a vertex of a cube has one normal.
            if name == "cube" {
                let last = prepared.points.steps.last().expect("normals").count;
                assert_eq!(
                    last,
                    6 * (1 << (2 * level)) + 2,
                    "vertices at level {level}"
                );
            }
            println!("{name} {level}: {away:.1e}, {turned:.1} degrees");
            assert!(away < 1e-6, "{name} {level}: {away}");
        }
    }
}
