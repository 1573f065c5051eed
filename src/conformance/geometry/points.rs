//! The sizes of points.

use std::collections::BTreeSet;

use crate::conformance::coordinates::TessLevels;
use crate::conformance::modes::{Domain, Modes, Spacing, module};
use crate::conformance::raw::{Program, Raw};
use crate::conformance::{Case, Check, Context, Finding};
use crate::error::Result;

/// The picture's side in pixels.
const SIDE: u32 = 64;

/// Push constants. Twin of `Draw` in `glsl/conformance/points.tese`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Constants {
    size: f32,
    side: f32,
    first: f32,
    spread: f32,
}

// As `tests/layout.rs` holds the shaders to.
const _: () = assert!(size_of::<Constants>() == 4 * 4);

/// No side of a square of whole pixels goes through a pixel's centre.
const FIRST: f32 = 16.25;
const SPREAD: f32 = 32.0;

/// Where the vertices of a patch are whose levels are all 2, with equal spacing (Vulkan, Quad, Triangle and Isoline Tessellation).
fn vertices(domain: Domain) -> Vec<[f32; 2]> {
    let halves = [0.0, 0.5, 1.0];
    let grid = |rows: &[f32]| {
        let row = |&v: &f32| halves.map(|u| [u, v]);
        rows.iter().flat_map(row).collect()
    };
    match domain {
        Domain::Quads => grid(&halves),
        // No line at v = 1.
        Domain::Isolines => grid(&halves[..2]),
        Domain::Triangles => {
            let third = 1.0 / 3.0;
            let border = [
                [0.0, 0.0],
                [0.5, 0.0],
                [1.0, 0.0],
                [0.5, 0.5],
                [0.0, 1.0],
                [0.0, 0.5],
            ];
            border.into_iter().chain([[third, third]]).collect()
        }
    }
}

/// The pixels whose centres lie in the square of a size about a place.
fn square(place: [f32; 2], size: f32) -> impl Iterator<Item = u32> {
    let within = move |axis: usize| {
        let middle = FIRST + SPREAD * place[axis];
        (0..SIDE).filter(move |&pixel| (pixel as f32 + 0.5 - middle).abs() < 0.5 * size)
    };
    within(1).flat_map(move |y| within(0).map(move |x| y * SIDE + x))
}

/// A seeded fault expects points that are larger.
fn sizes(context: &Context, domain: Domain, size: f32) -> Result<Finding> {
    let device = context.full_device()?;
    if !device.extra().point_sizes {
        let lacking = "the device has no largePoints, or no shaderTessellationAndGeometryPointSize";
        return Ok(Finding::skip(lacking));
    }
    let [least, greatest] = device.limits().point_size_range;
    if !(least..=greatest).contains(&size) {
        return Ok(Finding::skip(format!(
            "points have sizes from {least} to {greatest}"
        )));
    }
    let table = [TessLevels::uniform(2.0)];
    let mut raw = Raw::new(device, &[size_of_val(&table) as u64], SIDE)?;
    raw.write(0, &table)?;
    let modes = Modes {
        points: true,
        ..Modes::new(domain, Spacing::Equal)
    };
    let evaluation = modes.rewrite(module("points.tese")?);
    let pipeline = raw.pipeline(&Program::new(module("coordinates.tesc")?, evaluation)?)?;
    raw.submit(None, |cmd| {
        let constants = Constants {
            size,
            side: SIDE as f32,
            first: FIRST,
            spread: SPREAD,
        };
        cmd.bind(pipeline, &constants);
        cmd.draw(1, 1, 0, 0);
    })?;
    let expected = if context.is_wrong() { size + 2.0 } else { size };
    let right: BTreeSet<u32> = vertices(domain)
        .into_iter()
        .flat_map(|place| square(place, expected))
        .collect();
    let pixels = raw.pixels();
    let mut check = Check::default();
    for (i, &pixel) in (0..).zip(&pixels) {
        check.hold((pixel != 0) == right.contains(&i), || {
            format!("pixel ({}, {}) is {pixel}", i % SIDE, i / SIDE)
        });
    }
    let drawn = pixels.iter().filter(|&&pixel| pixel != 0).count();
    context.saw(drawn as u64);
    Ok(check.finish(format!("{drawn} pixels")))
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for domain in Domain::ALL {
        for size in [1u32, 2, 3, 4, 5, 8, 11] {
            let name = format!("geometry.point_size.{}-{size}", domain.name());
            let rule = "a point covers the pixels whose centres lie in the square of its size";
            let source = "Vulkan, Points; Basic Point Rasterization";
            cases.push(Case::new(name, rule, source, move |context| {
                sizes(context, domain, size as f32)
            }));
        }
    }
    cases
}
