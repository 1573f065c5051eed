//! Which faces are drawn together, and that they look as if they were not (Brainerd et al. 2016, section 7.3).

#[path = "../common/mod.rs"]
mod common;

mod drawn;

use std::collections::{BTreeMap, BTreeSet};

use common::meshes::{cases, manifold, wild};
use hullform::mesh::topology::{FaceCorner, Topology};
use hullform::mesh::{ControlMesh, INFINITE_SHARPNESS, Model};
use hullform::method::{MacroFace, MacroFaces};
use proptest::prelude::*;

/// The vertex of a macro face at a place of its grid.
fn vertex(topology: &Topology, one: &MacroFace, i: u32, j: u32) -> u32 {
    let [column, row] = [i.min(one.columns - 1), j.min(one.rows - 1)];
    let FaceCorner { face, corner } = one.cells[(column + one.columns * row) as usize];
    let behind = [[0, 3], [1, 2]][(i - column) as usize][(j - row) as usize];
    topology.face(face)[((corner + behind) % 4) as usize]
}

/// The vertices of cells side by side are the same, and what is between two cells is an edge of exactly these, and no infinite crease.
fn check_grid(topology: &Topology, one: &MacroFace) {
    assert_eq!(one.cells.len() as u32, one.columns * one.rows);
    let edge = |at: FaceCorner, side: u32| {
        let corner = (at.corner + side) % 4;
        topology.face_edges(at.face)[corner as usize]
    };
    for j in 0..one.rows {
        for i in 0..one.columns {
            let at = |i: u32, j: u32| one.cells[(i + one.columns * j) as usize];
            let beside = (i + 1 < one.columns).then(|| (edge(at(i, j), 1), edge(at(i + 1, j), 3)));
            let above = (j + 1 < one.rows).then(|| (edge(at(i, j), 2), edge(at(i, j + 1), 0)));
            for (own, other) in beside.into_iter().chain(above) {
                assert_eq!(own, other, "cells side by side share an edge");
                assert_eq!(topology.edge_faces(own).len(), 2);
                assert!(topology.edges()[own as usize].sharpness < INFINITE_SHARPNESS);
            }
        }
    }
    for (j, i) in (1..one.rows).flat_map(|j| (1..one.columns).map(move |i| (j, i))) {
        let inside = vertex(topology, one, i, j);
        assert_eq!(topology.vertex_faces(inside).len(), 4, "regular inside");
        assert_eq!(topology.vertex_edges(inside).len(), 4, "regular inside");
    }
}

/// The vertices of a macro face's rim: corners, and what is between them.
fn rim(topology: &Topology, one: &MacroFace) -> [BTreeSet<u32>; 2] {
    let [w, h] = [one.columns, one.rows];
    let corners = [[0, 0], [w, 0], [w, h], [0, h]];
    let low_and_high = (1..w).flat_map(|i| [[i, 0], [i, h]]);
    let left_and_right = (1..h).flat_map(|j| [[0, j], [w, j]]);
    let at = |[i, j]: [u32; 2]| vertex(topology, one, i, j);
    [
        corners.into_iter().map(at).collect(),
        low_and_high.chain(left_and_right).map(at).collect(),
    ]
}

fn check_rectangles(mesh: ControlMesh, span: u32) {
    let model = Model::new(mesh);
    let topology = model.topology();
    let found = MacroFaces::Rectangles { span }.find(&model);
    let mut times = vec![0; topology.face_count()];
    let mut corners = BTreeSet::new();
    for one in &found {
        check_grid(topology, one);
        assert!(one.columns.max(one.rows) <= span);
        for cell in &one.cells {
            times[cell.face as usize] += 1;
        }
        corners.extend(rim(topology, one)[0].iter().copied());
    }
    for (face, times) in (0u32..).zip(times) {
        let is_drawn = topology.face(face).len() == 4 && !topology.is_hole(face);
        assert_eq!(times, i32::from(is_drawn), "face {face}");
    }
    for one in &found {
        let [_, between] = rim(topology, one);
        for vertex in between {
            assert!(
                !corners.contains(&vertex),
                "a corner meets a side at vertex {vertex}"
            );
        }
    }
}

fn check_quartets(mesh: ControlMesh) {
    let model = Model::new(mesh);
    let topology = model.topology();
    let found = MacroFaces::Quartets.find(&model);
    let mut taken = BTreeSet::new();
    for one in &found {
        check_grid(topology, one);
        assert_eq!([one.columns, one.rows], [2, 2]);
        for cell in &one.cells {
            assert!(taken.insert(cell.face), "face {} is taken twice", cell.face);
            for &vertex in topology.face(cell.face) {
                assert_eq!(topology.vertex_faces(vertex).len(), 4);
                assert_eq!(topology.vertex_sharpness(vertex), 0.0);
                assert_eq!(topology.sharp_edges(vertex).count(), 0);
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn every_quad_is_in_one_rectangle_and_corners_meet_corners(recipe in wild(), span in 2..6u32) {
        check_rectangles(recipe.mesh(), span);
    }

    #[test]
    fn quartets_are_regular(recipe in manifold()) {
        check_quartets(recipe.mesh());
    }
}

/// The sizes of the rectangles, the longer side first, and how many there are of each.
fn sizes(mesh: ControlMesh, span: u32) -> BTreeMap<[u32; 2], usize> {
    let mut sizes = BTreeMap::new();
    for one in (MacroFaces::Rectangles { span }).find(&Model::new(mesh)) {
        let size = [one.columns.max(one.rows), one.columns.min(one.rows)];
        *sizes.entry(size).or_default() += 1;
    }
    sizes
}

/// Quads around a ring that is closed in both directions, with or without an end.
fn grid([columns, rows]: [u32; 2], closed: [bool; 2]) -> ControlMesh {
    let wide = columns + u32::from(!closed[0]);
    let high = rows + u32::from(!closed[1]);
    let number = |x: u32, y: u32| x % wide + wide * (y % high);
    let faces = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let faces = faces.flat_map(|(x, y)| [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]);
    let faces: Vec<u32> = faces.map(|(x, y)| number(x, y)).collect();
    let places = (0..high).flat_map(|y| (0..wide).map(move |x| (f64::from(x), f64::from(y))));
    let places: Vec<[f64; 3]> = places.map(|(x, y)| [x, y, 0.1 * x * y]).collect();
    let counts = vec![4; (columns * rows) as usize];
    let mesh = ControlMesh::builder(&places, &counts, &faces);
    mesh.build().expect("a sound mesh")
}

#[test]
fn what_has_no_extraordinary_vertex_is_one_rectangle_until_it_is_too_long() {
    for closed in [[false; 2], [true, false], [false, true], [true; 2]] {
        let whole = BTreeMap::from([([12, 7], 1)]);
        assert_eq!(sizes(grid([12, 7], closed), 16), whole, "{closed:?}");
        let halves = BTreeMap::from([([7, 6], 2)]);
        assert_eq!(sizes(grid([12, 7], closed), 8), halves, "{closed:?}");
        let cut = BTreeMap::from([([4, 3], 4), ([4, 4], 4)]);
        assert_eq!(sizes(grid([16, 7], closed), 4), cut, "{closed:?}");
    }
}

/// The faces of a box of so many cubes in each direction.
fn cube(n: i32) -> ControlMesh {
    let mut numbers = BTreeMap::new();
    let mut faces = Vec::new();
    for (side, high) in (0..3).flat_map(|side| [(side, false), (side, true)]) {
        for (x, y) in (0..n).flat_map(|y| (0..n).map(move |x| (x, y))) {
            let mut corners = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
            if !high {
                corners.reverse();
            }
            for [x, y] in corners {
                let mut place = [x, y, if high { n } else { 0 }];
                place.rotate_right(side);
                let next = numbers.len() as u32;
                faces.push(*numbers.entry(place).or_insert(next));
            }
        }
    }
    let mut places = vec![[0.0; 3]; numbers.len()];
    for (place, number) in numbers {
        places[number as usize] = place.map(f64::from);
    }
    let mesh = ControlMesh::builder(&places, &vec![4; faces.len() / 4], &faces);
    mesh.build().expect("a sound mesh")
}

/// Eight corners of valence 3.
#[test]
fn lines_lead_from_corner_to_corner() {
    for side in [1, 2, 5] {
        let expected = BTreeMap::from([([side as u32; 2], 6)]);
        assert_eq!(sizes(cube(side), 16), expected);
    }
}

#[test]
fn regular_regions_are_filled_with_quartets() {
    for closed in [[false; 2], [true; 2]] {
        let model = Model::new(grid([12, 10], closed));
        let counts = MacroFaces::Quartets.count(&model);
        // Open, the outermost ring of faces is at the boundary.
        let [macro_faces, irregular] = match closed {
            [true, _] => [30, 0],
            _ => [20, 120 - 80],
        };
        assert_eq!(
            [counts.macro_faces, counts.irregular],
            [macro_faces, irregular]
        );
        assert_eq!(counts.faces, 4 * macro_faces);
        assert_eq!(counts.regular, 0);
    }
}

#[test]
fn spans_out_of_range_are_refused() {
    for span in [0, 1, 33, u32::MAX] {
        let refused = MacroFaces::Rectangles { span }
            .check()
            .expect_err("refused");
        assert!(refused.to_string().contains("2 to 32"), "{refused}");
    }
}
