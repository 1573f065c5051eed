//! At sharp corners and cusps of curved surfaces normals are those of what is seen around them: within 5 degrees of the same face's normals at
//! (1/64, 1/64) from the corner.

mod common;

use common::meshes::scatter;
use glam::{DVec3, Vec2};
use hullform::mesh::topology::FaceCorner;
use hullform::mesh::{
    BoundaryInterpolation, ControlMesh, INFINITE_SHARPNESS, Model, Scheme, SchemeOptions,
};
use hullform::method::{MethodOptions, method};
use hullform::subdivision::{LimitSurface, is_cusp};
use hullform::tessellation::Domain;

/// A curved sheet of 4 x 4 cells, of which some are cut into triangles or joined to hexagons. In the vertex in its middle up to four creases end, and in
/// most sheets it is sharp itself; in every other one the sheet's own corners are.
fn sheet(seed: u64, scheme: Scheme) -> ControlMesh {
    let random = |i: u64| scatter(seed << 8 | i);
    let place = |i: u32| {
        let by = random(u64::from(i));
        let [x, y] = [i % 5, i / 5].map(f64::from);
        [x + 0.2 * by.x, y + 0.2 * by.y, 0.7 * by.z]
    };
    let positions: Vec<[f64; 3]> = (0..25).map(place).collect();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for i in [0u32, 2, 5, 7, 10, 12, 15, 17] {
        let cells = [i, i + 1].map(|a| [a, a + 1, a + 6, a + 5]);
        let choice = random(100 + u64::from(i)).x;
        if !scheme.is_triangular() && choice < -0.7 {
            faces.push(vec![i, i + 1, i + 2, i + 7, i + 6, i + 5]);
        } else if scheme.is_triangular() || choice < -0.2 {
            for [a, b, c, d] in cells {
                faces.extend([vec![a, b, c], vec![a, c, d]]);
            }
        } else {
            faces.extend(cells.map(Vec::from));
        }
    }
    let sizes: Vec<u32> = faces.iter().map(|face| face.len() as u32).collect();
    let boundary = match seed % 2 {
        0 => BoundaryInterpolation::EdgeOnly,
        _ => BoundaryInterpolation::EdgeAndCorner,
    };
    let options = SchemeOptions {
        boundary,
        scheme,
        ..SchemeOptions::default()
    };
    let builder = ControlMesh::builder(&positions, &sizes, &faces.concat()).options(options);
    let ends = [11, 7, 13, 17].into_iter().take(seed as usize / 2 % 5);
    let builder = ends.fold(builder, |b, end| b.crease(12, end, INFINITE_SHARPNESS));
    let builder = match seed % 3 {
        0 => builder,
        _ => builder.corner(12, INFINITE_SHARPNESS),
    };
    builder.build().expect("a sound sheet")
}

/// A corner of a ptex face, and the point beside it that counts.
struct Corner {
    ptex: usize,
    at: [f64; 2],
    beside: [f64; 2],
}

/// The corners of ptex faces at which a face is alone between sharp edges, or has a tangent plane of its own.
fn corners(surface: &LimitSurface) -> Vec<Corner> {
    const STEP: f64 = 1.0 / 64.0;
    let topology = surface.topology();
    let mut found = Vec::new();
    for ptex in 0..surface.ptex_count() {
        let (face, part) = surface.face_corner(ptex).expect("there is such a face");
        let n = topology.face(face).len();
        let triangle = n == 3 && surface.scheme().is_whole(3);
        let places: Vec<(u32, [f64; 2])> = match n {
            3 if triangle => vec![(0, [0.0, 0.0]), (1, [1.0, 0.0]), (2, [0.0, 1.0])],
            4 => vec![
                (0, [0.0, 0.0]),
                (1, [1.0, 0.0]),
                (2, [1.0, 1.0]),
                (3, [0.0, 1.0]),
            ],
            _ => vec![(part, [0.0, 0.0])],
        };
        for (corner, at) in places {
            let fan = topology.fan_at(FaceCorner { face, corner });
            let alone = fan.expect("there is such a corner").faces.len() == 1;
            let cusp = is_cusp(topology, face, corner);
            let inwards = |x: f64| match x {
                1.0 if triangle => 1.0 - 2.0 * STEP,
                1.0 => 1.0 - STEP,
                _ => STEP,
            };
            if alone || cusp {
                let beside = at.map(inwards);
                found.push(Corner { ptex, at, beside });
            }
        }
    }
    found
}

/// The angle in degrees; 999 where either is no unit vector.
fn degrees(a: DVec3, b: DVec3) -> f64 {
    let is_unit = |v: DVec3| (v.length() - 1.0).abs() < 1e-5;
    if !is_unit(a) || !is_unit(b) {
        return 999.0;
    }
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

const SHEETS: u64 = 60;

#[test]
fn the_limits_normals_at_corners_are_those_of_their_surroundings() {
    for scheme in [
        Scheme::CatmullClark,
        Scheme::Loop,
        Scheme::LoopStam,
        Scheme::Butterfly,
    ] {
        let (mut worst, mut count) = (0.0f64, 0);
        for seed in 0..SHEETS {
            let surface = LimitSurface::new(&sheet(seed, scheme));
            for Corner { ptex, at, beside } in corners(&surface) {
                let [own, near] = [at, beside].map(|[u, v]| {
                    let sample = surface.evaluate(ptex, u, v);
                    sample.expect("there are no holes").normal()
                });
                let turn = degrees(own, near);
                assert!(
                    turn <= 5.0,
                    "{scheme}, sheet {seed}, {at:?} of ptex face {ptex}: {turn:.1} degrees"
                );
                (worst, count) = (worst.max(turn), count + 1);
            }
        }
        println!("{scheme}: {count} corners, {worst:.2} degrees at most");
        assert!(count as u64 > 4 * SHEETS);
    }
}

/// As f32 computes them, which may take the limit's normal where the truth takes that nearby, or the other way round, where both are 5 degrees apart.
#[test]
fn patches_normals_at_corners_are_those_of_their_surroundings() {
    let method = method("quadtree").expect("it is in the table");
    let (mut worst, mut off, mut count) = (0.0f64, 0.0f64, 0);
    for seed in 0..SHEETS {
        let mesh = sheet(seed, Scheme::CatmullClark);
        let model = Model::new(mesh);
        let surface = LimitSurface::new(model.mesh());
        let prepared = method
            .prepare(&model, MethodOptions::default())
            .expect("sound options");
        let controls = prepared.controls(model.positions());
        let corners = corners(&surface);
        for pass in &prepared.passes {
            assert_eq!(pass.domain, Domain::Quads);
            for (number, patch) in pass.patches.iter().enumerate() {
                let own = corners.iter().filter(|c| c.ptex == patch.ptex as usize);
                for Corner { ptex, at, beside } in own {
                    let evaluated = |place: [f64; 2]| {
                        let uv = in_patch(patch, place);
                        let point = pass.evaluate(&controls, number, uv);
                        point.normal.as_dvec3()
                    };
                    let [own, near] = [*at, *beside].map(evaluated);
                    let turn = degrees(own, near);
                    assert!(
                        turn <= 5.01,
                        "sheet {seed}, {at:?} of ptex face {ptex}: {turn:.1} degrees"
                    );
                    let truth = surface.evaluate(*ptex, at[0], at[1]);
                    off = off.max(degrees(own, truth.expect("no hole").normal()));
                    (worst, count) = (worst.max(turn), count + 1);
                }
            }
        }
    }
    println!("{count} corners, {worst:.2} degrees at most, {off:.1e} off the truth");
    assert!(count as u64 > 4 * SHEETS && off < 0.003);
}

/// The patch's own coordinates of a place in its ptex face, by those of its corners.
fn in_patch(patch: &hullform::abi::Patch, [u, v]: [f64; 2]) -> Vec2 {
    let corner = |uv: [f32; 2]| hullform::method::to_ptex(patch, uv).map(f64::from);
    let (origin, along, across) = (corner([0.0; 2]), corner([1.0, 0.0]), corner([0.0, 1.0]));
    let from = [u - origin[0], v - origin[1]];
    let share = |end: [f64; 2]| {
        let axis = [end[0] - origin[0], end[1] - origin[1]];
        let square = axis[0] * axis[0] + axis[1] * axis[1];
        ((from[0] * axis[0] + from[1] * axis[1]) / square) as f32
    };
    Vec2::new(share(along), share(across))
}
