//! An edited model is that of the edited mesh, and what does not go changes nothing.

use super::*;
use crate::mesh::topology::Topology;
use crate::mesh::{
    BoundaryInterpolation, CreaseMethod, FaceVarying, Model, Scheme, SchemeOptions, builtin,
};

/// Adds a step that does not go.
type Wrong = fn(&mut Edit) -> &mut Edit;

/// Numbers without a pattern (splitmix64).
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut x = *state;
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

fn step(edit: &mut Edit, model: &Model, state: &mut u64) {
    let mut below = |count: usize| (random(state) % count as u64) as u32;
    let sharpness = [0.0, 0.3, 1.0, 2.5, 10.0][below(5) as usize];
    let topology = model.topology();
    let vertex = below(topology.vertex_count());
    match below(5) {
        0 => edit.corner(vertex, sharpness),
        1 => edit.hole(below(topology.face_count()), below(2) == 0),
        2 => edit.position(vertex, [0.1 * f64::from(sharpness), 0.0, 1.0]),
        _ => {
            let [a, b] = topology.edges()[below(topology.edge_count()) as usize].vertices;
            edit.crease(b, a, sharpness)
        }
    };
}

/// A step that adds, removes or reconnects, near what is there or right across the mesh: whatever is no edge's third face may become one.
fn reshape(edit: &mut Edit, model: &Model, state: &mut u64) {
    let mut below = |count: usize| (random(state) % count as u64) as u32;
    let topology = model.topology();
    let face = below(topology.face_count());
    let vertices = topology.face(face);
    let other = below(topology.vertex_count());
    if vertices.is_empty() {
        let edge = topology.edges()[below(topology.edge_count()) as usize];
        let [a, b] = edge.vertices;
        if ![a, b].contains(&other) {
            edit.add_face(&[b, a, other]);
        }
        return;
    }
    let corner = below(vertices.len()) as usize;
    match below(4) {
        0 => _ = edit.remove_face(face),
        1 => {
            let next = vertices[(corner + 1) % vertices.len()];
            let first = topology.vertex_count() as u32;
            let at = [f64::from(face), 0.5, f64::from(other)];
            edit.add_vertex(at).add_vertex([0.0, 1.0, 0.5]);
            edit.add_face(&[next, vertices[corner], first, first + 1]);
            edit.crease(first, vertices[corner], 2.5);
        }
        2 if !vertices.contains(&other) => {
            let mut vertices = vertices.to_vec();
            vertices[corner] = other;
            edit.reconnect_face(face, &vertices);
        }
        _ => {
            let mut vertices = vertices.to_vec();
            vertices.rotate_left(corner);
            edit.remove_face(face).add_face(&vertices);
        }
    }
}

/// Three quads on an edge, and a fourth that touches one of them in a vertex.
fn fins() -> ControlMesh {
    let positions: Vec<[f64; 3]> = (0..11).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let faces = [0, 1, 2, 3, 1, 0, 4, 5, 0, 1, 6, 7, 3, 8, 9, 10];
    let mesh = ControlMesh::builder(&positions, &[4; 4], &faces).build();
    mesh.expect("a sound mesh")
}

fn under(name: &str, boundary: BoundaryInterpolation, creasing: CreaseMethod) -> ControlMesh {
    let mesh = match name {
        "fins" => fins(),
        name => builtin(name).expect("it is built in"),
    };
    let sizes: Vec<u32> = mesh.faces().map(|face| face.len() as u32).collect();
    let faces: Vec<u32> = mesh.faces().flatten().copied().collect();
    let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
    let builder = ControlMesh::builder(&positions, &sizes, &faces);
    let options = SchemeOptions {
        boundary,
        creasing,
        ..SchemeOptions::default()
    };
    let builder = mesh.creases().iter().fold(builder, |builder, crease| {
        let [a, b] = crease.vertices;
        builder.crease(a, b, crease.sharpness)
    });
    builder.options(options).build().expect("a sound mesh")
}

/// Everything that is asked of a topology, whatever the rules of boundaries and creases, on open, closed and non-manifold meshes.
#[test]
fn an_edited_model_is_that_of_the_edited_mesh() {
    use BoundaryInterpolation::{EdgeAndCorner, EdgeOnly, None};
    let mut state = 7;
    for name in ["hull", "cubes-2x2x2", "sheet", "ngons", "fins"] {
        for boundary in [None, EdgeOnly, EdgeAndCorner] {
            for creasing in [CreaseMethod::Uniform, CreaseMethod::Chaikin] {
                let mut model = Model::new(under(name, boundary, creasing));
                for number in 0..120 {
                    let mut edit = model.mesh().edit();
                    match number % 2 {
                        0 => (0..1 + number % 3).for_each(|_| step(&mut edit, &model, &mut state)),
                        _ => reshape(&mut edit, &model, &mut state),
                    }
                    let before = model.clone();
                    // Removed faces are no holes, and one face stays.
                    let Ok(changes) = model.apply(&edit) else {
                        continue;
                    };
                    let fresh = Model::new(model.mesh().clone());
                    let what = format!("{name} {boundary:?} {creasing:?} {number} {edit:?}");
                    assert!(model.topology().is_same(fresh.topology()), "{what}");
                    assert_eq!(model.placement(), fresh.placement(), "{what}");
                    let changed = model.topology().differing(before.topology());
                    let told = |face: &u32| changes.faces().contains(face);
                    assert!(changed.iter().all(told), "{what} {changed:?}");
                    let vertices = 0..model.mesh().vertex_count() as u32;
                    let moved = |&vertex: &u32| model.position(vertex) != before.position(vertex);
                    let told =
                        |vertex: u32| changes.is_placed_anew() || changes.moved().contains(&vertex);
                    assert!(vertices.filter(moved).all(told), "{what}");
                    for edge in 0..before.topology().edge_count() as u32 {
                        let ends = before.topology().edge(edge).vertices;
                        let now = model.topology().edge_between(ends);
                        assert_eq!(changes.edge(edge), now, "{what}");
                    }
                }
                let rebuilt = rebuilt(model.mesh());
                assert_eq!(model.mesh().clone().compacted(), rebuilt, "{name}");
            }
        }
    }
}

/// The same mesh from what can be said of it.
fn rebuilt(mesh: &ControlMesh) -> ControlMesh {
    let there = || mesh.faces().filter(|face| !face.is_empty());
    let sizes: Vec<u32> = there().map(|face| face.len() as u32).collect();
    let faces: Vec<u32> = there().flatten().copied().collect();
    let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
    let mut builder = ControlMesh::builder(&positions, &sizes, &faces).options(mesh.options());
    for crease in mesh.creases() {
        let [a, b] = crease.vertices;
        builder = builder.crease(a, b, crease.sharpness);
    }
    for corner in mesh.corners() {
        builder = builder.corner(corner.vertex, corner.sharpness);
    }
    for &hole in mesh.holes() {
        let removed = (0..hole as usize).filter(|&face| mesh.is_removed(face));
        builder = builder.hole(hole - removed.count() as u32);
    }
    builder.build().expect("an edited mesh is sound")
}

#[test]
fn a_face_takes_the_number_of_a_removed_one_of_as_many_corners_and_ptex_numbers_stay() {
    let mut model = Model::new(builtin("ngons").expect("it is built in"));
    let offsets = model.mesh().ptex_offsets();
    let count = model.mesh().face_count() as u32;
    let of = |corners: usize| {
        let mut faces = model.mesh().faces();
        let found = faces.position(|face| face.len() == corners);
        found.expect("it has faces of all kinds") as u32
    };
    let (pentagon, quad) = (of(5), of(4));
    let [five, four] = [pentagon, quad].map(|face| model.mesh().face(face as usize).to_vec());
    let mut edit = model.mesh().edit();
    edit.hole(quad, true);
    model.apply(&edit).expect("it is there");
    let mut edit = model.mesh().edit();
    edit.remove_face(pentagon).remove_face(quad);
    let removed = model.apply(&edit).expect("they are there");
    assert!(removed.faces().contains(&pentagon) && removed.faces().contains(&quad));
    assert!(model.mesh().is_removed(quad as usize) && model.topology().is_hole(quad));
    assert_eq!(model.mesh().ptex_offsets(), offsets);
    let mut edit = model.mesh().edit();
    edit.add_face(&four[..3]).add_face(&four).add_face(&five);
    let added = model.apply(&edit).expect("there is room");
    assert_eq!(added.added(), [count, quad, pentagon]);
    assert_eq!(model.mesh().ptex_offsets()[..offsets.len()], offsets);
    assert!(!model.topology().is_hole(quad), "a hole goes with its face");
}

#[test]
fn corners_that_come_take_the_texture_coordinates_of_their_vertices() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let texture = FaceVarying {
        values: [[0.1, 0.2], [0.9, 0.2], [0.9, 0.8], [0.1, 0.8], [0.5, 0.5]]
            .map(Into::into)
            .into(),
        indices: vec![0, 1, 2, 4, 2, 3],
    };
    let mesh = ControlMesh::builder(&positions, &[3, 3], &[0, 1, 2, 0, 2, 3]).texture(texture);
    let mut model = Model::new(mesh.build().expect("a sound mesh"));
    let mut edit = model.mesh().edit();
    edit.add_vertex([2.0; 3])
        .add_face(&[1, 4, 2])
        .remove_face(0)
        .reconnect_face(1, &[0, 1, 3]);
    model.apply(&edit).expect("all of it goes");
    let texture = model.mesh().texture().expect("it has some");
    let of = |face: usize| &texture.indices[model.mesh().corner_range(face)];
    assert_eq!(
        (of(0), of(1), of(2)),
        (&[][..], &[4, 1, 3][..], &[1, 5, 2][..])
    );
    assert_eq!(texture.values[5], glam::DVec2::ZERO);
}

#[test]
fn what_is_refused_changes_nothing_and_says_where() {
    let mesh = builtin("cube").expect("it is built in");
    let mut model = Model::new(mesh.clone());
    let revision = model.revision;
    let edits: [(&str, Wrong); 19] = [
        ("edge 0-6: ", |edit| edit.crease(0, 6, 1.0)),
        ("edge 3-3: ", |edit| edit.crease(3, 3, 1.0)),
        ("edge 0-99: ", |edit| edit.crease(0, 99, 1.0)),
        ("edge 0-1: ", |edit| edit.crease(0, 1, -1.0)),
        ("edge 0-1: ", |edit| edit.crease(0, 1, f32::NAN)),
        ("vertex 8: ", |edit| edit.corner(8, 1.0)),
        ("vertex 7: ", |edit| edit.corner(7, -0.1)),
        ("face 6: ", |edit| edit.hole(6, true)),
        ("vertex 8: ", |edit| edit.position(8, [0.0; 3])),
        ("vertex 1: ", |edit| edit.position(1, [0.0, f64::NAN, 0.0])),
        ("vertex 8: ", |edit| edit.add_vertex([f64::INFINITY; 3])),
        ("vertex 8: ", |edit| {
            edit.add_vertex([1e305; 3]).add_face(&[0, 1, 8])
        }),
        ("face 6: ", |edit| edit.add_face(&[0, 1])),
        ("face 6: ", |edit| edit.add_face(&[0, 1, 8])),
        ("face 6: ", |edit| edit.add_face(&[0, 1, 2, 0])),
        ("face 9: ", |edit| edit.remove_face(9)),
        ("face 1: ", |edit| edit.remove_face(1).remove_face(1)),
        ("face 1: ", |edit| edit.reconnect_face(1, &[0, 1, 2])),
        ("edge 0-8: ", |edit| {
            edit.add_vertex([0.0; 3])
                .add_face(&[0, 1, 8])
                .remove_face(6)
                .crease(0, 8, 1.0)
        }),
    ];
    for (place, wrong) in edits {
        let mut edit = model.mesh().edit();
        edit.corner(0, 5.0).hole(2, true).position(4, [9.0; 3]);
        wrong(&mut edit);
        let refused = model.apply(&edit).expect_err("it does not go").to_string();
        assert!(refused.starts_with(place), "{refused}");
        assert!(refused.contains("; "), "a remedy: {refused}");
        assert_eq!((model.mesh(), model.revision), (&mesh, revision));
        let fresh = Topology::new(&mesh);
        assert_eq!(model.topology().differing(&fresh), [0; 0]);
    }
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let triangle = ControlMesh::builder(&positions, &[3], &[0, 1, 2]);
    let triangle = triangle.scheme(Scheme::Butterfly).build();
    let mut model = Model::new(triangle.expect("a sound mesh"));
    let edits: [(&str, Wrong); 3] = [
        ("edge 0-1: ", |edit| edit.crease(0, 1, 1.5)),
        ("face 1: ", |edit| {
            edit.add_vertex([9.0; 3]).add_face(&[2, 1, 0, 3])
        }),
        ("mesh: ", |edit| edit.remove_face(0)),
    ];
    for (place, wrong) in edits {
        let mut edit = model.mesh().edit();
        wrong(&mut edit);
        let refused = model.apply(&edit).expect_err("it does not go").to_string();
        assert!(refused.starts_with(place), "{refused}");
    }
}
