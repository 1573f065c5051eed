//! What decisions about patches rest on.

mod common;

use std::collections::BTreeMap;

use glam::camera::rh::proj::vulkan::perspective;
use glam::camera::rh::view::look_at_mat4;
use glam::{DVec3, Vec2, Vec3};
use hullform::frame::{Cut, Decision, Metric, Seen};
use hullform::mesh::{ControlMesh, Model, Scheme};
use hullform::method::{
    DepthTags, METHODS, MacroFaces, MethodOptions, Prepared, method, method_for,
};
use hullform::subdivision::LimitSurface;
use hullform::tessellation::Spacing;

/// Of each limit of a patch, the greatest share that vertices have which are not its own.
fn greatest_foreign_share(prepared: &Prepared, vertices: usize) -> f32 {
    let mut greatest = 0.0f32;
    for pass in &prepared.passes {
        for patch in 0..pass.patches.len() {
            if pass.hull(patch).is_empty() {
                continue;
            }
            // Everything else is one unit away.
            let mut places = vec![Vec3::X; vertices];
            for vertex in pass.own_vertices(&prepared.outline, patch) {
                places[vertex as usize] = Vec3::ZERO;
            }
            let controls = prepared.controls(places);
            for at in 0..81 {
                let uv = Vec2::new((at % 9) as f32, (at / 9) as f32) / 8.0;
                greatest = greatest.max(pass.evaluate(&controls, patch, uv).position.x);
            }
        }
    }
    greatest
}

/// The bound by which `Decision::frustum` leaves out what is beyond the picture: 11/36 where all is regular, 1/6 to 1/3 on creases and
/// boundaries.
#[test]
fn vertices_of_other_faces_have_a_share_of_a_third_at_most() {
    let mut looked = 0;
    let mut all = 0.0f32;
    let folders = ["shapes", "models"].into_iter();
    for file in folders.flat_map(common::obj_files) {
        let Ok(mesh) = hullform::mesh::read_obj(&file) else {
            continue;
        };
        let model = Model::new(mesh);
        if model.mesh().options().scheme != Scheme::CatmullClark {
            continue;
        }
        let Ok(prepared) = method_for(&model).prepare(&model, MethodOptions::default()) else {
            continue;
        };
        let vertices = model.mesh().vertex_count();
        let share = greatest_foreign_share(&prepared, vertices);
        let together = METHODS[0].prepare(&model, MacroFaces::Rectangles { span: 4 });
        let together = together.map(|prepared| greatest_foreign_share(&prepared, vertices));
        println!("{}: {share}, {together:?}", common::stem(&file));
        all = all.max(share).max(together.unwrap_or_default());
        looked += 1;
    }
    assert!(looked == 0 || looked > 30, "{looked}");
    // The bound is 0.35.
    assert!(all <= 0.334, "{all}");
}

/// A grid of four times four quads whose middle vertex stands out: its limit has four ninths of that.
fn spike() -> ControlMesh {
    let at = |i: u32| {
        [
            f64::from(i % 5),
            f64::from(i / 5),
            if i == 12 { 6.0 } else { 0.0 },
        ]
    };
    let positions: Vec<[f64; 3]> = (0..25).map(at).collect();
    let faces = (0..16).map(|i| i % 4 + 5 * (i / 4));
    let faces: Vec<u32> = faces.flat_map(|i| [i, i + 1, i + 6, i + 5]).collect();
    let mesh = ControlMesh::builder(&positions, &[4; 16], &faces).build();
    mesh.expect("a grid is sound")
}

/// The limit of each vertex by the truth, in local units.
fn true_limits(model: &Model) -> BTreeMap<u32, DVec3> {
    let truth = LimitSurface::new(model.mesh());
    let mut limits = BTreeMap::new();
    for (ptex, face) in model.mesh().faces().enumerate() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        for (&vertex, (u, v)) in face.iter().zip(corners) {
            let limit = truth.evaluate(ptex, u, v).expect("there is a limit");
            limits.insert(vertex, model.placement().local(limit.position));
        }
    }
    limits
}

#[test]
fn levels_go_by_limits_which_may_lie_far_from_the_control_vertices() {
    let model = Model::new(spike());
    let (vertices, limits) = (model.positions(), true_limits(&model));
    let prepared = METHODS[0].prepare(&model, MethodOptions::default());
    let prepared = prepared.expect("the first method draws it");
    let outline = &prepared.outline;
    let eye = Vec3::new(0.3, -2.5, 1.1);
    let clip = perspective(0.9, 1.5, 0.01, 10.0) * look_at_mat4(eye, Vec3::ZERO, Vec3::Z);
    let (size, pixels) = ([900.0, 600.0], 5.0);
    let seen = Seen {
        clip_from_model: clip.to_cols_array_2d(),
        eye: eye.to_array(),
        height: 0.0,
    };
    let decision = Decision {
        metric: Metric::Screen { pixels, size },
        ..Decision::default()
    };
    let cut = Cut {
        level: 64.0,
        spacing: Spacing::FractionalEven,
    };
    // Of an edge between two places, seen from either.
    let (matrix, row) = (clip.as_dmat4(), |i: usize| clip.row(i).as_dvec4());
    let scale = |i: usize| 0.5 * f64::from(size[i]) * row(i).truncate().length();
    let depth = |place: DVec3| (matrix * place.extend(1.0)).w;
    let from =
        |a: DVec3, b: DVec3| a.distance(b) * scale(0).max(scale(1)) / depth(a) / f64::from(pixels);
    let level = |ends: [DVec3; 2]| from(ends[0], ends[1]).max(from(ends[1], ends[0])).max(2.0);
    let (mut compared, mut elsewhere) = (0, 0);
    for pass in &prepared.passes {
        for (patch, sides) in pass.sides.iter().enumerate() {
            let levels = decision.levels(outline, pass, patch, &vertices, cut, &seen);
            let levels = levels.expect("there is such a patch");
            for (&side, &given) in sides.iter().zip(&levels.edges) {
                let ends: [u32; 2] = outline.side(side).try_into().expect("quads alone");
                let right = level(ends.map(|end| limits[&end]));
                let by_vertices = level(ends.map(|end| vertices[end as usize].as_dvec3()));
                let given = f64::from(given);
                assert!((given - right).abs() < 1e-4 * right, "{given} {right}");
                elsewhere += usize::from((given - by_vertices).abs() > 0.5 * given);
                compared += 1;
            }
        }
    }
    assert!(compared == 64 && elsewhere >= 8, "{compared} {elsewhere}");
    // And so do tags, by the farthest that an edge at a vertex asks for.
    let tags = DepthTags::by_screen(outline, &vertices, seen.clip_from_model, size, pixels);
    let given = f64::from(tags.expect("a position a vertex").depths[12]);
    let beside = [7, 11, 13, 17].map(|end| from(limits[&12], limits[&end]));
    let right = beside.into_iter().fold(0.0, f64::max).log2();
    assert!((given - right).abs() < 1e-4, "{given} {right}");
    let near = limits[&12].distance(eye.as_dvec3()) / 4.0;
    let tags = DepthTags::by_distance(outline, &vertices, eye, near as f32, 5.0);
    let given = tags.expect("a position a vertex").depths[12];
    assert!((given - 3.0).abs() < 1e-4, "{given}");
}

/// Where a surface goes through its control vertices, levels go by these.
#[test]
fn methods_that_draw_through_the_control_vertices_have_their_limits_there() {
    let model = Model::new(spike());
    let vertices = model.positions();
    for own in METHODS.iter().filter(|own| own.check_model(&model).is_ok()) {
        let prepared =
            method(own.name).and_then(|own| own.prepare(&model, MethodOptions::default()));
        let outline = prepared.expect("it draws the model").outline;
        let limits = outline.limits(&vertices).expect("a position a vertex");
        assert_eq!(
            limits == vertices,
            own.contract.interpolates,
            "{}",
            own.name
        );
    }
}
