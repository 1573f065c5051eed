//! A mesh of any size, wherever it lies, is the same mesh: truth and twins have the same bits up to its scale. What no face uses has no say, and what
//! cannot be calculated with is refused.

mod common;

use common::meshes::{cases, tagged_as, wild};
use glam::{DVec3, Vec2, Vec3};
use hullform::mesh::{
    ControlMesh, FaceVarying, Model, Scheme, Triangulation, read_obj_bytes, triangulated,
};
use hullform::method::{METHODS, MethodOptions};
use hullform::subdivision::LimitSurface;
use proptest::prelude::*;

/// The mesh with its positions elsewhere, and behind them a vertex that no face uses.
fn placed(mesh: &ControlMesh, to: impl Fn(DVec3) -> DVec3, stray: DVec3) -> ControlMesh {
    let positions = mesh.positions().iter().map(|&p| to(p)).chain([stray]);
    let positions: Vec<[f64; 3]> = positions.map(|p| p.to_array()).collect();
    let sizes: Vec<u32> = mesh.faces().map(|face| face.len() as u32).collect();
    let vertices: Vec<u32> = mesh.faces().flatten().copied().collect();
    tagged_as(mesh, ControlMesh::builder(&positions, &sizes, &vertices))
}

/// The mesh under a scheme, if that takes its tags, with positions that need few digits: so they can be moved without rounding.
fn on_grid(mesh: ControlMesh, scheme: Scheme) -> Option<ControlMesh> {
    let mesh = if scheme.is_triangular() {
        triangulated(&mesh, Triangulation::default()).expect("it is sound")
    } else {
        mesh
    };
    let mesh = mesh.with_scheme(scheme).ok()?;
    let grid = f64::from(1 << 18);
    Some(placed(&mesh, |p| (p * grid).round() / grid, DVec3::ZERO))
}

const PLACES: [[f64; 2]; 5] = [[0.0, 0.0], [1.0, 0.0], [0.25, 0.5], [0.01, 0.3], [0.6, 0.4]];

fn vector_bits(v: DVec3) -> [u64; 3] {
    // A zero may have any sign.
    (v + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// The truth of both meshes is the same up to the scale.
fn same_truth(one: &ControlMesh, other: &ControlMesh, scale: f64) -> Result<(), TestCaseError> {
    let [one, other] = [one, other].map(LimitSurface::new);
    for ptex in 0..one.ptex_count() {
        for [u, v] in PLACES {
            let samples = [&one, &other].map(|surface| surface.evaluate(ptex, u, v));
            let [Some(a), Some(b)] = samples else {
                prop_assert_eq!(samples, [None, None]);
                continue;
            };
            for (a, b) in [(a.position, b.position), (a.du, b.du), (a.dv, b.dv)] {
                prop_assert!(b.is_finite());
                prop_assert_eq!(vector_bits(scale * a), vector_bits(b));
            }
            prop_assert_eq!(vector_bits(a.normal()), vector_bits(b.normal()));
        }
    }
    Ok(())
}

/// So are the vertices that the GPU gets, and what all methods make of them.
fn same_twins(one: ControlMesh, other: ControlMesh) -> Result<(), TestCaseError> {
    let bits = |v: Vec3| v.to_array().map(f32::to_bits);
    let models = [one, other].map(Model::new);
    let vertices = models.each_ref().map(Model::positions);
    prop_assert!(vertices[0].iter().all(|p| p.abs().max_element() <= 2.0));
    let [a, b] = vertices
        .each_ref()
        .map(|all| all.iter().map(|&p| bits(p)).collect::<Vec<_>>());
    // The last vertex of the other is one that no face uses.
    prop_assert_eq!(&a[..], &b[..a.len()]);
    for method in METHODS.iter().filter(|m| m.check_model(&models[0]).is_ok()) {
        let prepared = models.each_ref().map(|model| {
            let prepared = method.prepare(model, MethodOptions::default());
            let prepared = prepared.expect("it can draw the model");
            let controls = prepared.controls(model.positions());
            (prepared, controls)
        });
        let passes = prepared[0].0.passes.len();
        for pass in 0..passes {
            for patch in (0..prepared[0].0.passes[pass].patches.len()).step_by(5) {
                for uv in [[0.0, 0.0], [0.5, 0.25]] {
                    let point = |(prepared, controls): &(hullform::method::Prepared, _)| {
                        prepared.passes[pass].evaluate(controls, patch, Vec2::from(uv))
                    };
                    let [a, b] = prepared.each_ref().map(point);
                    prop_assert!(a.position.is_finite() && a.normal.is_finite());
                    let name = method.name;
                    prop_assert_eq!(bits(a.position), bits(b.position), "{}", name);
                    prop_assert_eq!(bits(a.normal), bits(b.normal), "{}", name);
                }
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn a_mesh_of_any_size_and_anywhere_is_the_same(
        recipe in wild(), scheme in 0..Scheme::ALL.len(), exponent in -900..=900i32,
        offset in prop::array::uniform3(-(1i32 << 30)..=1 << 30), stray in -300..=300i32,
    ) {
        let Some(mesh) = on_grid(recipe.mesh(), Scheme::ALL[scheme]) else { return Ok(()) };
        let scale = 2f64.powi(exponent);
        let stray = DVec3::new(1.0, -1.0, 0.5) * 10f64.powi(stray);
        let large = placed(&mesh, |p| scale * p, stray);
        same_truth(&mesh, &large, scale)?;
        let offset = DVec3::from(offset.map(f64::from));
        let far = placed(&mesh, |p| scale * (p + offset), stray);
        let at = (LimitSurface::new(&far), LimitSurface::new(&mesh));
        for ptex in 0..at.1.ptex_count() {
            if let Some((far, near)) = at.0.evaluate(ptex, 0.4, 0.3).zip(at.1.evaluate(ptex, 0.4, 0.3)) {
                // Positions there have no more digits.
                prop_assert!((far.position / scale - offset).distance(near.position) < 1e-5);
                prop_assert!(far.normal().is_finite());
            }
        }
        same_twins(mesh.clone(), far)?;
        same_twins(mesh, large)?;
    }
}

/// A cube whose coordinates are 1 and -1.
fn cube() -> ControlMesh {
    hullform::mesh::builtin("cube").expect("it is built in")
}

#[test]
fn the_smallest_and_largest_cubes_are_cubes() {
    let one = Model::new(cube());
    for scale in [5e-324, 2f64.powi(-1022), 2f64.powi(996)] {
        let other = placed(
            &cube(),
            |p| scale * (p / one.placement().scale).round(),
            DVec3::ZERO,
        );
        let model = Model::new(other);
        let same = placed(
            &cube(),
            |p| (p / one.placement().scale).round(),
            DVec3::ZERO,
        );
        assert_eq!(model.positions(), Model::new(same).positions(), "{scale}");
        let surface = LimitSurface::new(model.mesh());
        let sample = surface.evaluate(0, 0.5, 0.5).expect("no hole");
        assert!(sample.position.is_finite());
        assert!((sample.normal().length() - 1.0).abs() < 1e-12, "{scale}");
    }
}

#[test]
fn a_mesh_without_extent_has_a_place() {
    let at = DVec3::new(3.0, -1e200, 0.0);
    let model = Model::new(placed(&cube(), |_| at, DVec3::ONE));
    assert_eq!(
        (model.placement().centre, model.placement().scale),
        (at, 1.0)
    );
    assert_eq!(model.diagonal(), 0.0);
    assert!(model.positions().iter().all(|&p| p == Vec3::ZERO));
    let sample = LimitSurface::new(model.mesh()).evaluate(0, 0.3, 0.7);
    let sample = sample.expect("no hole");
    // A sum of dozens of equal positions rounds in its last digits.
    assert!((sample.position - at).abs().max_element() <= 64.0 * f64::EPSILON * 1e200);
    // There is no plane anywhere, neither of derivatives nor nearby, and no area of any face.
    assert_eq!(sample.normal(), DVec3::ZERO);
}

/// What an engine writes as positions is not in local units, and may be of any size.
#[test]
fn vertices_of_any_size_have_the_same_normals() {
    let meshes = ["cube", "ngons", "creased-torus"].map(|name| {
        let mesh = hullform::mesh::builtin(name).expect("it is built in");
        Scheme::ALL.map(|scheme| on_grid(mesh.clone(), scheme))
    });
    let mut compared = 0;
    for model in meshes.into_iter().flatten().flatten().map(Model::new) {
        for method in METHODS.iter().filter(|m| m.check_model(&model).is_ok()) {
            let prepared = method.prepare(&model, MethodOptions::default());
            let prepared = prepared.expect("it can draw the model");
            let points = |exponent: i32| {
                let vertices = model.positions().into_iter();
                let vertices = vertices.map(|p| p * 2f32.powi(exponent)).collect();
                prepared.controls(vertices).points
            };
            let one = points(0);
            for exponent in [-90, -70, 70, 124] {
                for (own, right) in points(exponent).iter().zip(&one) {
                    let grown = right.position.map(|x| x * 2f32.powi(exponent));
                    assert_eq!(own.position, grown, "{} 2^{exponent}", method.name);
                    let bits = |normal: [f32; 3]| normal.map(f32::to_bits);
                    let name = method.name;
                    assert_eq!(bits(own.normal), bits(right.normal), "{name} 2^{exponent}");
                    compared += usize::from(right.normal != [0.0; 3]);
                }
            }
        }
    }
    assert!(compared > 5_000, "{compared} normals");
}

#[test]
fn what_cannot_be_calculated_with_is_refused_where_it_stands() {
    let refused = |text: &str, start: &str| {
        let error = read_obj_bytes("large.obj", text.as_bytes()).expect_err(text);
        assert_eq!(error.exit_code(), 2);
        let message = error.to_string();
        assert!(message.starts_with(start), "{message}");
    };
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1e301 0\nv -1.7e308 1.7e308 0\nf 1 2 3\n";
    refused(triangle, "large.obj:3: ");
    refused(&triangle.replace("1e301", "-1.7e308"), "large.obj:3: ");
    // What no face uses has no say.
    let sound = triangle.replace("1e301", "-1e300");
    let mesh = read_obj_bytes("large.obj", sound.as_bytes()).expect("it is within range");
    assert!(Model::new(mesh).positions().iter().all(|p| p.is_finite()));
    let textured =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 -1e31\nvt 0 0.5\nvt 1e300 0\nf 1/1 2/2 3/3\n";
    refused(textured, "large.obj:5: ");
    let mesh = read_obj_bytes("large.obj", textured.replace("1e31", "1e30").as_bytes());
    assert!(mesh.expect("it is within range").texture().is_some());
    // Callers of the library hear of the mesh.
    let values = vec![glam::DVec2::new(1e39, 0.0); 3];
    let texture = FaceVarying {
        values,
        indices: vec![0, 1, 2],
    };
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = ControlMesh::builder(&corners, &[3], &[0, 1, 2])
        .texture(texture)
        .build();
    let message = mesh.expect_err("1e39 is no float").to_string();
    assert!(message.contains("1e30"), "{message}");
    let corners = corners.map(|p| p.map(|x| x * 1e305));
    let mesh = ControlMesh::builder(&corners, &[3], &[0, 1, 2]).build();
    let message = mesh.expect_err("1e305 is too large").to_string();
    assert!(message.starts_with("vertex 1: "), "{message}");
}

#[cfg(feature = "cli")]
mod program {
    use super::*;
    use common::cli::{has_device, run, stderr};
    use std::path::Path;

    fn obj(mesh: &ControlMesh) -> String {
        let vertices = mesh
            .positions()
            .iter()
            .map(|p| format!("v {:e} {:e} {:e}\n", p.x, p.y, p.z));
        let corners = |face: &[u32]| {
            face.iter()
                .map(|v| format!(" {}", v + 1))
                .collect::<String>()
        };
        let faces = mesh.faces().map(|face| format!("f{}\n", corners(face)));
        vertices.chain(faces).collect()
    }

    fn sound(arguments: &[&str]) {
        let output = run(arguments);
        assert!(
            output.status.success(),
            "{arguments:?}: {}",
            stderr(&output)
        );
    }

    /// The lines of a CSV of points as numbers.
    fn points(path: &Path) -> Vec<Vec<f64>> {
        let text = std::fs::read_to_string(path).expect("it was written");
        let number = |word: &str| word.parse().expect("a number");
        text.lines()
            .skip(1)
            .map(|line| line.split(',').map(number).collect())
            .collect()
    }

    #[test]
    fn pictures_and_points_know_no_size() {
        if !has_device() {
            return;
        }
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let mesh = on_grid(
            hullform::mesh::builtin("ngons").expect("built in"),
            Scheme::CatmullClark,
        );
        let mesh = mesh.expect("its own scheme");
        let offset = DVec3::new(3e6, -7e8, 12.0);
        let far = |p: DVec3| p + offset;
        let meshes = [
            ("one", 1.0, DVec3::ZERO, placed(&mesh, |p| p, DVec3::ZERO)),
            (
                "tiny",
                2f64.powi(-900),
                DVec3::ZERO,
                placed(&mesh, |p| 2f64.powi(-900) * p, DVec3::ONE),
            ),
            (
                "huge",
                2f64.powi(900),
                DVec3::ZERO,
                placed(&mesh, |p| 2f64.powi(900) * p, DVec3::ONE),
            ),
            ("far", 1.0, offset, placed(&mesh, far, DVec3::ZERO)),
        ];
        let mut right: Option<(Vec<Vec<f64>>, Vec<u8>)> = None;
        for (name, scale, offset, mesh) in meshes {
            let (model, csv, png) = (
                at(&format!("{name}.obj")),
                at("points.csv"),
                at("picture.png"),
            );
            std::fs::write(&model, obj(&mesh)).expect("there is room");
            let [model, csv_name, png_name] =
                [&model, &csv, &png].map(|p| p.to_str().expect("text"));
            sound(&["tessellate", model, "--level", "3", "-o", csv_name]);
            sound(&[
                "render",
                model,
                "--level",
                "3",
                "--size",
                "96x64",
                "--displace",
                "0.01",
                "-o",
                png_name,
            ]);
            let (points, picture) = (points(&csv), std::fs::read(&png).expect("it was written"));
            let (right_points, right_picture) =
                right.get_or_insert((points.clone(), picture.clone()));
            assert_eq!(points.len(), right_points.len());
            for (point, right) in points.iter().zip(right_points) {
                for (i, (&own, &right)) in point.iter().zip(right.iter()).enumerate() {
                    let expected = match i {
                        3..6 => scale * right + offset[i - 3],
                        _ => right,
                    };
                    // Far away positions have no more digits.
                    let digits = 4.0 * f64::EPSILON * offset.length();
                    assert!((own - expected).abs() <= digits, "{name}: {point:?}");
                }
            }
            assert!(picture == *right_picture, "{name}");
        }
    }
}
