//! Cracks as one sees them: pictures that a surface must fill, with vertices moved by what their bits say.
//!
//! A sheet whose border lies outside of the picture covers every pixel of it, wherever its inner vertices are: the border winds once around
//! each pixel, so the triangles there, counted by their orientation, come to one. It takes a crack to see the background. The same holds for
//! the near half of a closed surface whose outline lies outside; the far half is cut off, for it would hide what one sees through a crack.
//!
//! The crack amplifier of VK-GL-CTS moves each vertex whose position has an odd number of bits by a fiftieth of the picture: where faces
//! differ by a single bit, a hole of several pixels opens.

use glam::{DQuat, DVec3};

use crate::conformance::capture::{Loaded, SIDE, SPACINGS, capturing, cut, prepare, spacing_name};
use crate::conformance::edges::bumps;
use crate::conformance::meshes::{creased_polygons, framed_polygon, sheet, star, with_positions};
use crate::conformance::{Case, Check, Context, Finding};
use crate::error::Result;
use crate::gpu::{Cut, SurfaceOptions};
use crate::mesh::{ControlMesh, Model, builtin};
use crate::method::Prepared;

const RULE: &str = "a surface whose border lies outside of the picture leaves no pixel of it empty, wherever bits of positions move its vertices";
const SOURCE: &str = "VK-GL-CTS, tessellation, common edges; manual, Edges and corners";

/// A surface, and the part of it that the picture shows.
struct Scene {
    name: &'static str,
    make: fn() -> Result<ControlMesh>,
    /// Half the side of the picture, in units of the farthest coordinate.
    window: f32,
    /// Whether it is closed: then the half behind its middle is cut off.
    closed: bool,
    level: f32,
}

const SCENES: [Scene; 9] = [
    Scene {
        name: "regular_sheet",
        make: || sheet(6).build(),
        window: 0.5,
        closed: false,
        level: 9.0,
    },
    Scene {
        name: "creased_sheet",
        make: creased_polygons,
        window: 0.5,
        closed: false,
        level: 9.0,
    },
    Scene {
        name: "sharp_sheet",
        make: || sheet(6).tagged(|b| (0..6).fold(b, |b, x| b.crease(21 + x, 22 + x, 10.0))),
        window: 0.5,
        closed: false,
        level: 7.0,
    },
    Scene {
        name: "star_of_5",
        make: || star(5).build(),
        window: 0.4,
        closed: false,
        level: 16.0,
    },
    Scene {
        name: "star_of_31",
        make: || star(31).build(),
        window: 0.4,
        closed: false,
        level: 8.0,
    },
    Scene {
        name: "polygon_of_7",
        make: || framed_polygon(7).build(),
        window: 0.4,
        closed: false,
        level: 13.0,
    },
    Scene {
        name: "star_of_3",
        make: || star(3).build(),
        window: 0.4,
        closed: false,
        level: 11.0,
    },
    Scene {
        name: "ball",
        make: || builtin("ngons"),
        window: 0.45,
        closed: true,
        level: 5.0,
    },
    Scene {
        name: "cube",
        make: cube_on_a_corner,
        window: 0.15,
        closed: true,
        level: 31.0,
    },
];

/// The cube with a corner towards the eye.
fn cube_on_a_corner() -> Result<ControlMesh> {
    let cube = builtin("cube")?;
    let corner = DVec3::new(1.0, 1.0, -1.0).normalize();
    let turn = DQuat::from_rotation_arc(corner, DVec3::Z);
    let turned = cube.positions().iter().map(|&p| (turn * p).to_array());
    with_positions(&cube, &turned.collect::<Vec<_>>())
}

/// What moves vertices.
#[derive(Clone, Copy)]
struct Moved {
    name: &'static str,
    amplified: bool,
    /// As a share of the diagonal.
    displacement: f64,
    /// How far a seeded fault moves control vertices, as a share of the diagonal: what is not amplified must be seen as it is.
    fault: f64,
}

const MOVED: [Moved; 3] = [
    Moved {
        name: "amplified",
        amplified: true,
        displacement: 0.0,
        fault: 1e-6,
    },
    Moved {
        name: "displaced",
        amplified: false,
        displacement: 0.02,
        fault: 0.02,
    },
    Moved {
        name: "displaced_amplified",
        amplified: true,
        displacement: 0.02,
        fault: 1e-6,
    },
];

pub(super) fn cases() -> impl Iterator<Item = Case> {
    let all = SCENES
        .iter()
        .flat_map(|scene| MOVED.iter().map(move |moved| (scene, moved)));
    all.flat_map(|(scene, moved)| {
        SPACINGS.map(|spacing| {
            let name = format!(
                "edges.picture-{}.{}-{}",
                moved.name,
                scene.name,
                spacing_name(spacing)
            );
            let cut = cut(scene.level, spacing);
            Case::new(name, RULE, SOURCE, move |context| {
                look(context, scene, moved, cut)
            })
        })
    })
}

fn look(context: &Context, scene: &Scene, moved: &Moved, cut: Cut) -> Result<Finding> {
    let mesh = (scene.make)()?;
    let mut check = Check::default();
    // The border must lie outside by more than anything moves: what shows more of the surface is full as well.
    let still = Moved {
        amplified: false,
        displacement: 0.0,
        ..*moved
    };
    let empty = empty_pixels(
        &picture(context, scene, &mesh, &still, 1.25, cut, false)?,
        0,
    );
    check.hold(empty == 0, || {
        format!("the picture shows the border: {empty} pixels are empty with nothing moved")
    });
    let seen = picture(context, scene, &mesh, moved, 1.0, cut, context.is_wrong())?;
    let empty = empty_pixels(&seen, MARGIN);
    check.hold(empty == 0, || format!("{empty} pixels are empty"));
    Ok(check.finish(format!("{SIDE} x {SIDE} pixels, {empty} empty")))
}

/// Where triangles are cut by the sides of the picture, the driver makes vertices of its own: what they do is not our matter.
const MARGIN: usize = SIDE as usize / 16;

fn empty_pixels(alpha: &[u8], margin: usize) -> usize {
    let inside = margin..SIDE as usize - margin;
    let rows = alpha.chunks(SIDE as usize).skip(margin).take(inside.len());
    rows.flat_map(|row| &row[inside.clone()])
        .filter(|&&alpha| alpha == 0)
        .count()
}

/// Draws a scene, `wider` than it asks for; with a fault every other patch has control vertices of its own.
fn picture(
    context: &Context,
    scene: &Scene,
    mesh: &ControlMesh,
    moved: &Moved,
    wider: f32,
    cut: Cut,
    fault: bool,
) -> Result<Vec<u8>> {
    let model = if fault {
        Model::new(doubled(mesh, moved.fault)?)
    } else {
        Model::new(mesh.clone())
    };
    let mut prepared = prepare(&model, "quadtree")?;
    if fault {
        tear(&mut prepared, mesh.positions().len() as u32);
    }
    let options = SurfaceOptions {
        capture_vertices: 0,
        amplify_cracks: moved.amplified,
        ..capturing(context, &prepared, cut)
    };
    let workarounds = context.workarounds()?;
    let mut loaded = context
        .bench()?
        .load(&model, prepared, &workarounds, options)?;
    aim(&mut loaded, &model, wider * scene.window, scene.closed);
    loaded.view.displacement = bumps(&model, moved.displacement);
    loaded.picture(cut)
}

/// Looks from above at what lies within `window` of the middle; nothing but the near half of what is closed.
fn aim(loaded: &mut Loaded<'_>, model: &Model, window: f32, closed: bool) {
    let reach = model.positions().into_iter().map(|p| p.abs().max_element());
    let reach = reach.fold(0.0, f32::max);
    let (across, deep) = (1.0 / (window * reach), 0.45 / reach);
    // The middle has depth 1, what is nearer less; of a sheet everything is within 0.1 to 0.9.
    let middle = if closed { 1.0 } else { 0.5 };
    loaded.view.clip_from_model = [
        [across, 0.0, 0.0, 0.0],
        [0.0, -across, 0.0, 0.0],
        [0.0, 0.0, -deep, 0.0],
        [0.0, 0.0, middle, 1.0],
    ];
}

/// The mesh with every vertex a second time, moved by a share of the diagonal; the faces have the first ones.
fn doubled(mesh: &ControlMesh, by: f64) -> Result<ControlMesh> {
    let (low, high) = mesh.bounds();
    let by = by * low.distance(high);
    let once = mesh.positions().iter().map(|p| p.to_array());
    let again = once.clone().map(|[x, y, z]| [x + by, y, z]);
    with_positions(mesh, &once.chain(again).collect::<Vec<_>>())
}

/// Gives every other patch the second set of vertices.
fn tear(prepared: &mut Prepared, vertices: u32) {
    for pass in &mut prepared.passes {
        let starts: Vec<usize> = pass
            .patches
            .iter()
            .map(|patch| patch.controls as usize)
            .collect();
        for pair in starts.chunks(2) {
            // Behind the last patch's vertices there is something else.
            let next = starts
                .iter()
                .copied()
                .filter(|&start| start > pair[0])
                .min();
            let Some(end) = next else { continue };
            for control in &mut pass.controls[pair[0]..end] {
                *control += vertices;
            }
        }
    }
}
