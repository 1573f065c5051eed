//! Limit stencils are what endless refinement leads to: left eigenvectors of the subdivision matrix around a vertex, in every kind of
//! surroundings and at every valence up to 40.

mod common;

use common::fan_at;
use common::meshes::scatter;
use hullform::mesh::topology::Topology;
use hullform::mesh::{ControlMesh, INFINITE_SHARPNESS};
use hullform::subdivision::{limit_stencil, refine};

/// The surroundings of vertex 0: quads around it, and what is sharp. Faces 0..`faces` are the ones to look at.
struct Case {
    name: String,
    topology: Topology,
    faces: u32,
}

/// Where quads around vertex 0 begin and end: at an edge of their own, or at one that sheets share, by number.
#[derive(Clone, Copy)]
enum Sheet {
    Closed(u32),
    From(u32, u32, u32),
}

fn case(name: String, sheets: &[Sheet], creases: &[u32], sharp_vertex: bool) -> Case {
    // Vertices: 0, then the ends of shared edges 1 and 2, then those of each sheet.
    let (mut faces, mut next) = (Vec::new(), 3);
    let mut fresh = || {
        next += 1;
        next - 1
    };
    for &sheet in sheets {
        let (count, closed, first, last) = match sheet {
            Sheet::Closed(count) => (count, true, fresh(), 0),
            Sheet::From(first, last, count) => (count, false, first, last),
        };
        let mut from = first;
        for i in 0..count {
            let to = match i + 1 == count {
                true if closed => first,
                true => last,
                false => fresh(),
            };
            faces.extend([0, from, fresh(), to]);
            from = to;
        }
    }
    let positions: Vec<[f64; 3]> = (0..u64::from(next))
        .map(|i| scatter(i).to_array())
        .collect();
    let mut builder = ControlMesh::builder(&positions, &vec![4; faces.len() / 4], &faces);
    for &face in creases {
        builder = builder.crease(0, faces[4 * face as usize + 1], INFINITE_SHARPNESS);
    }
    if sharp_vertex {
        builder = builder.corner(0, INFINITE_SHARPNESS);
    }
    let (Sheet::Closed(count) | Sheet::From(_, _, count)) = sheets[0];
    Case {
        name,
        topology: Topology::new(&builder.build().expect("a sound fan")),
        faces: count,
    }
}

/// Every kind of vertex with `n` faces in the sector that is looked at.
fn cases(n: u32) -> Vec<Case> {
    let sector = [Sheet::From(1, 2, n)];
    let crease = [1, 1].map(|k| Sheet::From(1, 2, k));
    let mut cases = vec![
        case(format!("crease of {n} faces"), &sector, &[], false),
        case(format!("corner of {n} faces"), &sector, &[], true),
    ];
    if n > 1 {
        let closed = [Sheet::Closed(n)];
        let sheet = [sector[0], crease[0], Sheet::From(1, 2, 3)];
        let cone = [closed[0], crease[0], crease[1], crease[1]];
        let page = [Sheet::From(1, 1, n), crease[0], Sheet::From(2, 2, 3)];
        cases.extend([
            case(format!("smooth {n}"), &closed, &[], false),
            case(format!("dart {n}"), &closed, &[0], false),
            case(format!("sharp vertex of {n} faces"), &closed, &[], true),
            case(format!("sharp dart {n}"), &closed, &[0], true),
            case(format!("crease through {n}"), &closed, &[0, n / 2], false),
            case(
                format!("crease of {n} faces and two more sheets"),
                &sheet,
                &[],
                false,
            ),
            case(
                format!("cone of {n} on a non-manifold crease"),
                &cone,
                &[],
                false,
            ),
            case(
                format!("page of {n} on a non-manifold crease"),
                &page,
                &[],
                false,
            ),
        ]);
    }
    cases
}

/// The vertices that shape a corner: the vertex, the far ends of its sharp edges, and of the edges and faces of its fan.
fn ring(topology: &Topology, face: u32, corner: u32) -> Vec<u32> {
    let fan = fan_at(topology, face, corner);
    let other = |edge: u32| topology.edges()[edge as usize].other(fan.vertex);
    let opposite = |&face: &u32| {
        let vertices = topology.face(face);
        let at = vertices.iter().position(|&v| v == fan.vertex);
        vertices[(at.expect("the fan's faces touch its vertex") + 2) % 4]
    };
    let mut ring = vec![fan.vertex];
    ring.extend(topology.sharp_edges(fan.vertex).map(other));
    ring.extend(fan.edges.iter().map(|&edge| other(edge)));
    ring.extend(fan.faces.iter().map(opposite));
    let mut seen = std::collections::HashSet::new();
    ring.retain(|&vertex| seen.insert(vertex));
    ring
}

/// One refinement around a corner, as rows of weights over its ring; and the corner's two edges and limit stencils as such rows.
struct Local {
    matrix: Vec<Vec<f64>>,
    edges: [Vec<f64>; 2],
    position: Vec<f64>,
    plane: [Vec<f64>; 2],
}

impl Local {
    fn of(case: &Case, face: u32) -> Local {
        let topology = &case.topology;
        let before = ring(topology, face, 0);
        let refined = refine(topology, &[(face, 0)]);
        let mut after = ring(&refined.topology, 0, 0);
        let row = |mask: &[(u32, f64)]| {
            let mut row = vec![0.0; before.len()];
            for &(vertex, weight) in mask {
                match before.iter().position(|&v| v == vertex) {
                    Some(place) => row[place] += weight,
                    None => assert_eq!(weight, 0.0, "{}: outside of the ring", case.name),
                }
            }
            row
        };
        // The far ends of sharp edges may come in another order: each belongs to the end that it is the middle towards.
        let sharp = 1 + topology.sharp_edges(before[0]).count();
        let mask = |vertex: u32| row(&refined.masks[vertex as usize]);
        for place in 1..sharp.min(before.len()) {
            let found = (place..sharp).find(|&i| mask(after[i])[place] == 0.5);
            after.swap(place, found.expect("a sharp edge stays one"));
        }
        let stencil = limit_stencil(topology, face, 0).expect("nothing here is semi-sharp");
        let [own, next, _, previous] = topology.face(face) else {
            panic!("the fan is made of quads")
        };
        Local {
            matrix: after.into_iter().map(mask).collect(),
            edges: [next, previous].map(|&end| row(&[(end, 1.0), (*own, -1.0)])),
            position: row(&stencil.position),
            plane: [row(&stencil.du), row(&stencil.dv)],
        }
    }

    fn refined(&self, row: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; row.len()];
        for (weight, line) in row.iter().zip(&self.matrix) {
            for (sum, value) in product.iter_mut().zip(line) {
                *sum += weight * value;
            }
        }
        product
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// An orthonormal pair that spans the same plane in the same orientation.
fn orthonormal([mut a, mut b]: [Vec<f64>; 2]) -> [Vec<f64>; 2] {
    let scale = |row: &mut Vec<f64>| {
        let length = dot(row, row).sqrt();
        row.iter_mut().for_each(|w| *w /= length);
    };
    scale(&mut a);
    scale(&mut b);
    let along = dot(&a, &b);
    b.iter_mut().zip(&a).for_each(|(b, a)| *b -= along * a);
    scale(&mut b);
    [a, b]
}

/// The row without the share of the limit position that rounding brings in: that share does not contract as everything else does.
fn balanced(mut row: Vec<f64>, position: &[f64]) -> Vec<f64> {
    let sum: f64 = row.iter().sum();
    row.iter_mut()
        .zip(position)
        .for_each(|(w, p)| *w -= sum * p);
    row
}

/// How far two planes are apart, about the sine of the angle between them; 2 or more when they face away from each other.
fn apart(a: &[Vec<f64>; 2], b: &[Vec<f64>; 2]) -> f64 {
    let products = [0, 1].map(|i| [0, 1].map(|j| dot(&a[i], &b[j])));
    let determinant = products[0][0] * products[1][1] - products[0][1] * products[1][0];
    if determinant <= 0.0 {
        return 2.0 - determinant;
    }
    let outside = (0..2).map(|i| {
        let (a, [x, y]) = (&a[i], products[i]);
        let rest = (0..a.len()).map(|v| a[v] - x * b[0][v] - y * b[1][v]);
        rest.map(|r| r * r).sum::<f64>()
    });
    outside.sum::<f64>().sqrt()
}

/// The first faces, the middle ones and the last.
fn some_faces(count: u32) -> impl Iterator<Item = u32> {
    (0..count).filter(move |&i| i < 3 || i + 2 >= count || i == count / 2)
}

#[test]
fn refinement_keeps_limit_positions_and_tangent_planes() {
    for case in (1..=12).chain([19, 40]).flat_map(cases) {
        for face in some_faces(case.faces) {
            let local = Local::of(&case, face);
            let name = format!("{}, face {face}", case.name);
            let moved = local.refined(&local.position);
            let distance = moved
                .iter()
                .zip(&local.position)
                .map(|(a, b)| (a - b).abs());
            let distance = distance.fold(0.0, f64::max);
            assert!(distance < 1e-12, "{name}: position {distance:.1e}");
            assert!(
                (dot(&local.position, &vec![1.0; moved.len()]) - 1.0).abs() < 1e-12,
                "{name}"
            );
            let before = orthonormal(local.plane.clone());
            let after = orthonormal([0, 1].map(|i| local.refined(&local.plane[i])));
            assert!(
                before[1].iter().all(|w| w.is_finite()),
                "{name}: tangents are parallel"
            );
            let angle = apart(&after, &before);
            assert!(angle < 1e-9, "{name}: plane {angle:.1e}");
        }
    }
}

/// Where two modes contract alike, the plane of a face's edges approaches its limit like 1 / level only; elsewhere like a power.
#[test]
fn the_plane_of_a_faces_edges_tends_to_the_tangent_plane() {
    for case in (1..=20).flat_map(cases) {
        // Of valence 2, the plane swings about its mean for ever.
        if ["smooth 2", "dart 2"].contains(&&case.name[..]) {
            continue;
        }
        // From five faces on, a second mode of theirs is slower than the crease itself, which only the outer faces touch. All faces get the
        // plane of crease and first mode nevertheless (Biermann, Levin, Zorin 2000), lest a smooth sector has several normals.
        let creased = case.name.starts_with("crease");
        for face in some_faces(case.faces) {
            let sector = fan_at(&case.topology, face, 0);
            let inner = sector.at > 0 && sector.at + 1 < sector.faces.len();
            if creased && inner && sector.faces.len() > 4 {
                continue;
            }
            let local = Local::of(&case, face);
            let plane = orthonormal(local.plane.clone());
            // Beside a sharp edge, that edge's own direction comes first: it stays exactly what it is.
            let [next, previous] = local.edges.clone();
            let last = sector.at + 1 == sector.faces.len();
            let mut edges = if last {
                [previous, next.iter().map(|w| -w).collect()]
            } else {
                [next, previous]
            };
            let mut angles = Vec::new();
            // Between three faces of a page the even mode contracts faster than the sharp edge, which rounding lets in some day.
            let page = ["sharp dart 3", "page of 3 on a non-manifold crease"];
            let steps = if page.contains(&&case.name[..]) {
                40
            } else {
                400
            };
            for step in 1..=steps {
                edges =
                    orthonormal(edges.map(|row| local.refined(&balanced(row, &local.position))));
                if 2 * step == steps || step == steps {
                    angles.push(apart(&edges, &plane));
                }
            }
            assert!(
                angles[1] < 0.05 && angles[1] < 0.6 * angles[0] + 1e-6,
                "{}, face {face}: {angles:?}",
                case.name
            );
        }
    }
}
