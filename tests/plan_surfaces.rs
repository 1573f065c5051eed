//! Plans lead to the limit: the method's CPU twin, in f32 on the packed bytes, against the truth.

mod common;

use common::meshes::{cases, manifold, scatter, wild};
use common::surfaces::{LEVELS, Surfaces, tess_coordinates};
use glam::DVec3;
use hullform::mesh::{ControlMesh, CreaseMethod, SchemeOptions, builtin, read_obj};
use hullform::plan::PlanOptions;
use proptest::prelude::*;

/// Holds a mesh at all levels, `count` points a level and patch.
fn hold(name: &str, mesh: ControlMesh, options: PlanOptions, count: u32) {
    let surfaces = Surfaces::of(mesh, options);
    if surfaces.prepared.passes.is_empty() {
        return;
    }
    let worst = surfaces.worst(1, |patch| tess_coordinates(&LEVELS, count, patch));
    worst.hold(name);
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn plans_of_manifold_meshes_lead_to_the_limit(recipe in manifold()) {
        hold("manifold", recipe.mesh(), PlanOptions::default(), 2);
    }

    #[test]
    fn plans_of_wild_meshes_lead_to_the_limit(recipe in wild()) {
        hold("wild", recipe.mesh(), PlanOptions::default(), 2);
    }
}

proptest! {
    #![proptest_config(cases(10))]

    #[test]
    fn creases_refined_away_lead_to_the_same_surface_by_more_nodes(recipe in manifold()) {
        let options = PlanOptions { direct_creases: false, ..PlanOptions::default() };
        let refined = Surfaces::of(recipe.mesh(), options);
        let direct = Surfaces::of(recipe.mesh(), PlanOptions::default());
        prop_assert!(nodes(&refined) >= nodes(&direct));
        if !refined.prepared.passes.is_empty() {
            refined.worst(1, |patch| tess_coordinates(&[2, 7, 64], 2, patch)).hold("refined");
        }
    }

    /// Normals count up to Vulkan's tess level of 64; beyond, f32 coordinates are too coarse for them.
    #[test]
    fn every_deepest_level_is_exact_up_to_its_own_tess_level(recipe in wild()) {
        for max_level in 1..=10 {
            let surfaces = Surfaces::of(recipe.mesh(), PlanOptions { max_level, direct_creases: true });
            let deepest = 1u32 << max_level;
            let levels = [deepest / 2 + 1, deepest - 1, deepest];
            let worst = surfaces.worst(3, |patch| tess_coordinates(&levels, 2, patch));
            prop_assert!(worst.distance <= 1e-6, "{max_level}: {worst:?}");
            prop_assert!(max_level > 6 || worst.angle <= 0.1, "{max_level}: {worst:?}");
        }
    }
}

fn nodes(surfaces: &Surfaces) -> usize {
    let plans = surfaces
        .prepared
        .plans
        .as_ref()
        .expect("the method has plans");
    plans.nodes.iter().sum()
}

#[test]
fn plans_of_every_shared_shape_lead_to_the_limit() {
    for path in common::obj_files("shapes") {
        let name = common::stem(&path);
        let (true, Ok(mesh)) = (name.starts_with("catmark"), read_obj(&path)) else {
            continue;
        };
        let surfaces = Surfaces::of(mesh, PlanOptions::default());
        let worst = surfaces.worst(1, |patch| tess_coordinates(&[1, 3, 8, 63], 2, patch));
        worst.hold(&name);
    }
}

#[test]
fn plans_of_every_shared_model_lead_to_the_limit() {
    for path in common::obj_files("models") {
        let mesh = read_obj(&path).expect("the shared models are sound");
        let surfaces = Surfaces::of(mesh, PlanOptions::default());
        let stride = 1 + surfaces.model.topology().face_count() / 60;
        let worst = surfaces.worst(stride, |patch| tess_coordinates(&LEVELS, 1, patch));
        worst.hold(&common::stem(&path));
    }
}

#[test]
fn poles_of_any_valence_lead_to_the_limit() {
    for valence in [3, 5, 64, 200, 360, 1000] {
        let mesh = builtin(&format!("pole-{valence}")).expect("a built-in shape");
        let surfaces = Surfaces::of(mesh, PlanOptions::default());
        let stride = 1 + valence / 5;
        let worst = surfaces.worst(stride, |patch| tess_coordinates(&[1, 3, 64], 1, patch));
        worst.hold(&format!("pole of {valence}"));
    }
}

/// So many faces or corners that there is a hub.
const MANY: u32 = 70;

/// `count` vertices around an axis, in disorder, and what faces make of them and of what stood before.
struct Sketch {
    positions: Vec<[f64; 3]>,
    faces: Vec<Vec<u32>>,
}

impl Sketch {
    fn new() -> Sketch {
        Sketch {
            positions: Vec::new(),
            faces: Vec::new(),
        }
    }

    fn point(&mut self, at: [f64; 3]) -> u32 {
        let by = 0.02 * scatter(self.positions.len() as u64);
        self.positions.push((DVec3::from(at) + by).to_array());
        self.positions.len() as u32 - 1
    }

    fn circle(&mut self, count: u32, radius: f64, height: f64) -> Vec<u32> {
        let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(count);
        let at = |i: u32| [radius * angle(i).cos(), radius * angle(i).sin(), height];
        (0..count).map(|i| self.point(at(i))).collect()
    }

    /// A face for each place of a circle, told of it and the next.
    fn around(&mut self, count: u32, face: impl Fn(usize, usize) -> Vec<u32>) {
        let count = count as usize;
        self.faces
            .extend((0..count).map(|i| face(i, (i + 1) % count)));
    }

    fn mesh(self, creases: &[(u32, u32, f32)]) -> ControlMesh {
        let sizes: Vec<u32> = self.faces.iter().map(|face| face.len() as u32).collect();
        let mut builder = ControlMesh::builder(&self.positions, &sizes, &self.faces.concat());
        for &(a, b, sharpness) in creases {
            builder = builder.crease(a, b, sharpness);
        }
        builder.build().expect("a sound sketch")
    }
}

/// So many quads around a vertex, all or not, with creases: how sharp each spoke is.
fn quads_around(count: u32, sharpness: impl Fn(usize) -> f32) -> ControlMesh {
    let mut sketch = Sketch::new();
    let middle = sketch.point([0.0, 0.0, 0.4]);
    let inner = sketch.circle(2 * MANY, 0.6, 0.2);
    let outer = sketch.circle(2 * MANY, 1.0, -0.1);
    sketch.around(MANY, |i, j| {
        vec![middle, inner[2 * i], inner[2 * i + 1], inner[2 * j]]
    });
    sketch.faces.truncate(count as usize);
    sketch.around(2 * MANY, |i, j| {
        vec![inner[i], outer[i], outer[j], inner[j]]
    });
    let spokes = (0..MANY as usize).map(|i| (middle, inner[2 * i], sharpness(i)));
    let creases: Vec<_> = spokes.filter(|spoke| spoke.2 > 0.0).collect();
    sketch.mesh(&creases)
}

/// An n-gon under a vertex, which is a hub too, or over another one, or over quads and that.
fn lids(sides: bool, apex: bool) -> ControlMesh {
    let mut sketch = Sketch::new();
    let upper = sketch.circle(MANY, 0.8, 0.5);
    let lower = if sides {
        sketch.circle(MANY, 1.0, -0.5)
    } else {
        upper.clone()
    };
    sketch.faces.push(upper.clone());
    if sides {
        sketch.around(MANY, |i, j| vec![upper[j], upper[i], lower[i], lower[j]]);
    }
    if apex {
        let apex = sketch.point([0.1, 0.0, -1.0]);
        sketch.around(MANY, |i, j| vec![lower[j], lower[i], apex]);
    } else {
        sketch.faces.push(lower.into_iter().rev().collect());
    }
    sketch.mesh(&[])
}

/// An n-gon, one of whose corners is a hub as well.
fn hub_at_corner() -> ControlMesh {
    let mut sketch = Sketch::new();
    let lid = sketch.circle(MANY, 1.0, 0.0);
    let last = lid.len() - 1;
    let around = (0..MANY).map(|i| {
        let angle = std::f64::consts::PI * (f64::from(i + 1) / f64::from(MANY + 1) - 0.5);
        [1.0 + 0.8 * angle.cos(), -0.8 * angle.sin(), 0.3]
    });
    let around: Vec<u32> = around
        .collect::<Vec<_>>()
        .into_iter()
        .map(|at| sketch.point(at))
        .collect();
    let path: Vec<u32> = [lid[1]]
        .into_iter()
        .chain(around)
        .chain([lid[last]])
        .collect();
    let fan = path.windows(2).map(|pair| vec![lid[0], pair[1], pair[0]]);
    sketch.faces.extend(fan);
    sketch.faces.push(lid);
    sketch.mesh(&[])
}

/// An n-gon in a sheet of quads, which have few vertices around them beside it.
fn lid_in_sheet() -> ControlMesh {
    let mut sketch = Sketch::new();
    let rings = [0.6, 0.8, 1.0].map(|radius| sketch.circle(MANY, radius, 0.3 - 0.3 * radius));
    sketch.faces.push(rings[0].clone());
    for (near, far) in rings.iter().zip(&rings[1..]) {
        sketch.around(MANY, |i, j| vec![near[j], near[i], far[i], far[j]]);
    }
    sketch.mesh(&[])
}

/// Faces that have an edge, or a vertex, in common and nothing else.
fn pages(edge: bool) -> ControlMesh {
    let mut sketch = Sketch::new();
    let [a, b] = [0.0, 1.0].map(|z| sketch.point([0.0, 0.0, z]));
    let [near, far] = [0.0, 1.0].map(|z| sketch.circle(2 * MANY, 1.0, z));
    sketch.around(MANY, |i, _| match edge {
        true => vec![a, b, far[i], near[i]],
        false => vec![a, near[2 * i], far[2 * i], near[2 * i + 1]],
    });
    sketch.mesh(&[])
}

/// A face that is there many times, perhaps in both directions.
fn copies(both: bool) -> ControlMesh {
    let mut sketch = Sketch::new();
    let face = sketch.circle(4, 1.0, 0.0);
    let back: Vec<u32> = face.iter().rev().copied().collect();
    sketch.around(MANY, |i, _| match both && i % 2 == 1 {
        true => back.clone(),
        false => face.clone(),
    });
    sketch.mesh(&[])
}

fn hubs() -> [(&'static str, bool, ControlMesh); 14] {
    let semi_sharp = |i: usize| {
        if i % 3 == 1 {
            0.3 + 0.07 * i as f32
        } else {
            0.0
        }
    };
    let dart = [0.0, 10.0];
    [
        ("quads around a vertex", true, quads_around(MANY, |_| 0.0)),
        ("creased spokes", true, quads_around(MANY, semi_sharp)),
        (
            "a dart",
            true,
            quads_around(MANY, |i| dart[usize::from(i == 9)]),
        ),
        ("half a pole", true, quads_around(MANY - 1, semi_sharp)),
        ("two n-gons", false, lids(false, false)),
        ("prism", true, lids(true, false)),
        ("sheet", true, lid_in_sheet()),
        ("cone", true, lids(false, true)),
        ("roof", true, lids(true, true)),
        ("corner of an n-gon", true, hub_at_corner()),
        ("pages", false, pages(true)),
        ("fans", false, pages(false)),
        ("copies", false, copies(false)),
        ("copies in both directions", false, copies(true)),
    ]
}

#[test]
fn what_is_beside_hubs_leads_to_the_limit() {
    for (name, has_points, mesh) in hubs() {
        let surfaces = Surfaces::of(mesh, PlanOptions::default());
        assert_eq!(surfaces.prepared.points.count > 0, has_points, "{name}");
        let worst = surfaces.worst(7, |patch| tess_coordinates(&[1, 3, 8, 64], 2, patch));
        worst.hold(name);
    }
}

#[test]
fn faces_beside_hubs_have_the_same_bits_on_both_sides_of_edges() {
    // Two n-gons are two sheets in the same place, of which only the rim is shared.
    let apart = hubs().into_iter().filter(|hub| hub.0 != "two n-gons");
    for (name, _, mesh) in apart {
        let surfaces = Surfaces::of(mesh, PlanOptions::default());
        let controls = surfaces.prepared.controls(surfaces.model.positions());
        let mut points: Vec<[f32; 3]> = Vec::new();
        for pass in &surfaces.prepared.passes {
            for patch in 0..pass.patches.len() {
                // Halves of edges are cut twice as finely.
                for i in (0..32u8).filter(|i| i % 8 != 7) {
                    let t = f32::from(i % 8) / 8.0;
                    let uv =
                        [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]][usize::from(i / 8)];
                    let point = pass.evaluate(&controls, patch, uv.into());
                    points.push(point.position.to_array());
                }
            }
        }
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let near = 1e-6;
        let mut shared = 0;
        for (place, a) in points.iter().enumerate() {
            let beside = points[place + 1..]
                .iter()
                .take_while(|b| b[0] - a[0] < near);
            for b in beside.filter(|b| (b[1] - a[1]).abs() < near && (b[2] - a[2]).abs() < near) {
                assert_eq!(
                    a.map(f32::to_bits),
                    b.map(f32::to_bits),
                    "{name}: {a:?} {b:?}"
                );
                shared += 1;
            }
        }
        assert!(shared > 500, "{name}: {shared}");
    }
}

/// Tori so small that a face's 1-ring meets itself.
#[test]
fn rings_that_touch_themselves_lead_to_the_limit() {
    for (width, height) in [(3, 3), (4, 3), (2, 5), (2, 2), (2, 4), (3, 2)] {
        let mesh = torus(width, height, |p| p).build().expect("sound");
        hold(
            &format!("torus {width}x{height}"),
            mesh,
            PlanOptions::default(),
            4,
        );
    }
}

/// A torus of quads; narrow ones name an edge more than once.
fn torus(
    width: u32,
    height: u32,
    to: impl Fn(DVec3) -> DVec3,
) -> hullform::mesh::ControlMeshBuilder {
    let turn = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let ((a, b), (c, d)) = (turn(x, width).sin_cos(), turn(y, height).sin_cos());
        let r = 1.0 + 0.4 * d;
        positions.push(to(DVec3::new(r * b, r * a, 0.4 * c + 0.1 * b)).to_array());
        let number = |x: u32, y: u32| x % width + width * (y % height);
        faces.extend([(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| number(x + i, y + j)));
    }
    ControlMesh::builder(&positions, &vec![4; faces.len() / 4], &faces)
}

#[test]
fn small_meshes_far_from_the_origin_keep_their_precision() {
    let far = DVec3::new(1000.0, -700.0, 300.0);
    let builder = torus(5, 4, |p| far + 0.04 * p);
    let mesh = builder.crease(0, 1, 2.5).crease(1, 2, 2.5).build();
    hold("far away", mesh.expect("sound"), PlanOptions::default(), 4);
}

#[test]
fn chaikin_creases_of_varying_sharpness_lead_to_the_limit() {
    for sharpness in [
        [0.3, 1.2, 9.5],
        [9.5, 9.5, 0.4],
        [4.0, 3.0, 2.5],
        [9.9, 10.0, 8.0],
    ] {
        let creases = sharpness.iter().enumerate().map(|(i, &s)| (i as u32, s));
        let builder = torus(5, 5, |p| p).options(SchemeOptions {
            creasing: CreaseMethod::Chaikin,
            ..SchemeOptions::default()
        });
        let builder = creases.fold(builder, |builder, (i, s)| {
            builder.crease(i, i + 1, s).crease(5 * i + 7, 5 * i + 12, s)
        });
        let mesh = builder.build().expect("sound");
        hold(&format!("{sharpness:?}"), mesh, PlanOptions::default(), 2);
    }
}

/// Found by `every_deepest_level_is_exact_up_to_its_own_tess_level`: after one level, each cell still touches a corner.
#[test]
fn deepest_level_1_is_exact_at_tess_level_2() {
    let options = PlanOptions {
        max_level: 1,
        direct_creases: true,
    };
    let surfaces = Surfaces::of(builtin("ngons").expect("a built-in shape"), options);
    let worst = surfaces.worst(1, |patch| tess_coordinates(&[2], 4, patch));
    worst.hold("level 1");
}

#[test]
fn direct_creases_save_nodes() {
    let built = |direct_creases| {
        let mesh = builtin("creased-torus").expect("a built-in shape");
        let options = PlanOptions {
            direct_creases,
            ..PlanOptions::default()
        };
        nodes(&Surfaces::of(mesh, options))
    };
    assert!(built(false) > 2 * built(true));
}
