//! Which non-manifold vertices are sharp, and which faces at a boundary are holes.

use super::*;
use crate::mesh::ControlMeshBuilder;

/// Quads around vertex 0, sheet by sheet: each leads over fresh edges from one of the shared edges 1 and 2 to one of them, or all the way round (0, 0).
fn around(sheets: &[(u32, u32, u32)]) -> Vec<Vec<u32>> {
    let (mut faces, mut next) = (Vec::new(), 3);
    let mut fresh = || {
        next += 1;
        next - 1
    };
    for &(first, last, count) in sheets {
        let first = if first == 0 { fresh() } else { first };
        let mut from = first;
        for i in 0..count {
            let to = match last {
                _ if i + 1 < count => fresh(),
                0 => first,
                last => last,
            };
            faces.push(vec![0, from, fresh(), to]);
            from = to;
        }
    }
    faces
}

fn topology(faces: &[Vec<u32>]) -> Topology {
    let vertices: Vec<u32> = faces.concat();
    let count = 1 + vertices.iter().max().expect("a face");
    let sizes: Vec<u32> = faces.iter().map(|face| face.len() as u32).collect();
    let positions = vec![[0.0; 3]; count as usize];
    let mesh = ControlMesh::builder(&positions, &sizes, &vertices).build();
    Topology::new(&mesh.expect("a sound mesh"))
}

fn is_corner(faces: &[Vec<u32>]) -> bool {
    is_infinite(topology(faces).vertex_sharpness(0))
}

#[test]
fn a_vertex_is_on_a_non_manifold_crease_when_every_fan_leads_along_it() {
    let sheets = [(1, 2, 1), (1, 2, 2), (1, 2, 3)];
    assert!(!is_corner(&around(&sheets)));
    // It does not matter which way a sheet runs.
    assert!(!is_corner(&around(&[
        (1, 2, 1),
        (2, 1, 2),
        (1, 2, 3),
        (2, 1, 1)
    ])));
    // The crease is refined as one: a cubic B-spline.
    let topology = topology(&around(&sheets));
    assert_eq!(topology.sharp_edges(0).count(), 2);
}

/// All of these have two non-manifold edges, no boundary and more faces than edges, which is all that OpenSubdiv 3.5 looked at.
#[test]
fn fans_that_return_to_their_edge_or_stand_apart_make_a_corner() {
    // A fan from edge 1 to edge 1, another at edge 2, and one between.
    assert!(is_corner(&around(&[(1, 1, 3), (2, 2, 3), (1, 2, 2)])));
    assert!(is_corner(&around(&[
        (1, 1, 3),
        (1, 1, 3),
        (1, 2, 1),
        (2, 2, 2),
        (2, 2, 4)
    ])));
    // Both edges have as many faces, yet none leads from one to the other.
    assert!(is_corner(&around(&[
        (1, 1, 2),
        (1, 1, 2),
        (2, 2, 2),
        (2, 2, 2)
    ])));
    // A cone stands on the crease.
    assert!(is_corner(&around(&[
        (1, 2, 1),
        (1, 2, 1),
        (1, 2, 1),
        (1, 2, 1),
        (0, 0, 4)
    ])));
}

#[test]
fn other_non_manifold_vertices_are_corners() {
    // Two cones, or two fans, which share nothing but the vertex.
    assert!(is_corner(&around(&[(0, 0, 4), (0, 0, 3)])));
    assert!(is_corner(&[vec![0, 1, 2, 3], vec![0, 4, 5, 6]]));
    // The crease ends here: one non-manifold edge and boundaries.
    assert!(is_corner(&[
        vec![0, 1, 2, 3],
        vec![0, 1, 4, 5],
        vec![0, 1, 6, 7]
    ]));
    // A boundary beside the crease.
    let mut faces = around(&[(1, 2, 1), (1, 2, 2), (1, 2, 3), (1, 2, 1)]);
    faces.push(vec![0, 90, 91, 92]);
    assert!(is_corner(&faces));
    // A sheet of which a face is turned over has a third such edge.
    let mut faces = around(&[(1, 2, 1), (1, 2, 1), (1, 2, 3)]);
    faces[3].reverse();
    assert!(is_corner(&faces));
    // A face turned over in a plain fan: two edges, but no more faces than edges.
    let mut faces = around(&[(0, 0, 5)]);
    faces[2].reverse();
    assert!(is_corner(&faces));
    assert!(!is_corner(&around(&[(0, 0, 5)])));
}

/// A grid of quads between `side` by `side` vertices, each quad as two triangles if asked for.
fn grid(side: u32, triangles: bool) -> Vec<Vec<u32>> {
    let corners = (0..side * (side - 1)).filter(|i| i % side < side - 1);
    corners
        .flat_map(|i| {
            let quad = [i, i + 1, i + side + 1, i + side];
            match triangles {
                false => vec![quad.to_vec()],
                true => vec![
                    vec![quad[0], quad[1], quad[2]],
                    vec![quad[2], quad[3], quad[0]],
                ],
            }
        })
        .collect()
}

/// The faces that are no holes without boundary interpolation.
fn drawn(
    faces: &[Vec<u32>],
    scheme: Scheme,
    tag: impl Fn(ControlMeshBuilder) -> ControlMeshBuilder,
) -> Vec<u32> {
    let sizes: Vec<u32> = faces.iter().map(|face| face.len() as u32).collect();
    let builder = ControlMesh::builder(&[[0.0; 3]; 25], &sizes, &faces.concat());
    let builder = builder.options(SchemeOptions {
        scheme,
        boundary: BoundaryInterpolation::None,
        ..SchemeOptions::default()
    });
    let topology = Topology::new(&tag(builder).build().expect("a sound mesh"));
    (0..faces.len() as u32)
        .filter(|&face| !topology.is_hole(face))
        .collect()
}

#[test]
fn without_boundary_interpolation_faces_that_touch_a_boundary_are_holes_unless_the_scheme_is_bilinear()
 {
    let quads = grid(4, false);
    let plain = |builder| builder;
    assert_eq!(drawn(&quads, Scheme::CatmullClark, plain), [4]);
    assert_eq!(drawn(&quads, Scheme::LoopStam, plain), [4]);
    assert_eq!(drawn(&quads, Scheme::Bilinear, plain).len(), 9);
    let triangles = grid(4, true);
    for scheme in [Scheme::Loop, Scheme::Butterfly] {
        assert_eq!(drawn(&triangles, scheme, plain), [8, 9]);
    }
    assert_eq!(drawn(&triangles, Scheme::Bilinear, plain).len(), 18);
    // Holes are holes under every scheme, and what they leave is no boundary.
    let holed = |builder: ControlMeshBuilder| builder.hole(4);
    assert_eq!(drawn(&quads, Scheme::CatmullClark, holed), [] as [u32; 0]);
    assert_eq!(
        drawn(&quads, Scheme::Bilinear, holed),
        [0, 1, 2, 3, 5, 6, 7, 8]
    );
}

#[test]
fn a_boundary_that_tags_make_sharp_keeps_its_faces() {
    let quads = grid(4, false);
    let tagged = |sharpness: f32| {
        move |mut builder: ControlMeshBuilder| {
            // All round but for one edge at the corner 15.
            for [a, b] in [
                [0, 1],
                [1, 2],
                [2, 3],
                [3, 7],
                [7, 11],
                [11, 15],
                [15, 14],
                [14, 13],
                [13, 12],
                [12, 8],
                [8, 4],
            ] {
                builder = builder.crease(a, b, sharpness);
            }
            builder
        }
    };
    // The edge 4-0 is not sharp: the faces at 0 and 4 have no limit.
    assert_eq!(
        drawn(&quads, Scheme::CatmullClark, tagged(INFINITE_SHARPNESS)),
        [1, 2, 4, 5, 6, 7, 8]
    );
    assert_eq!(drawn(&quads, Scheme::CatmullClark, tagged(9.5)), [4]);
}
