//! Cuts and what comes of them: predictions, and options that have room for it.

use hullform::abi::Captured;
use hullform::gpu::{Cut, SurfaceOptions};
use hullform::mesh::Model;
use hullform::method::{Prepared, method};
use hullform::plan::PlanOptions;
use hullform::tessellation::Spacing;

/// A cut.
pub fn cut(level: f32, spacing: Spacing) -> Cut {
    Cut { level, spacing }
}

/// Both spacings.
pub const SPACINGS: [Spacing; 2] = [Spacing::Equal, Spacing::FractionalEven];

/// A model made ready by the method of a name.
pub fn prepare(model: &Model, name: &str) -> Prepared {
    let method = method(name).expect("the method is one of the table");
    method
        .prepare(model, PlanOptions::default())
        .expect("every sound mesh can be prepared")
}

/// The vertices that the tessellator makes of everything.
pub fn vertices(prepared: &Prepared, cut: Cut) -> u32 {
    over_patches(prepared, |pass, patch| {
        cut.vertices(&prepared.passes[pass], patch)
    })
}

/// The sum of something over all patches.
pub fn over_patches(prepared: &Prepared, count: impl Fn(usize, usize) -> u32) -> u32 {
    let passes = prepared.passes.iter().enumerate();
    passes
        .flat_map(|(number, pass)| (0..pass.patches.len()).map(move |patch| (number, patch)))
        .map(|(pass, patch)| count(pass, patch))
        .sum()
}

/// The most vertices to be captured at once: 64 MiB of them, half of what every device can bind.
const MOST_CAPTURED: u32 = (64 << 20) / size_of::<Captured>() as u32;

/// Options for capturing everything at the given cuts, with room for vertices that come several times.
pub fn capturing(prepared: &Prepared, cuts: &[Cut]) -> SurfaceOptions {
    let most = cuts.iter().map(|&cut| vertices(prepared, cut)).max();
    SurfaceOptions {
        capture_vertices: (4 * most.unwrap_or(0)).clamp(1, MOST_CAPTURED),
        greatest_level: cuts.iter().map(|cut| cut.level).fold(1.0, f32::max),
        ..Default::default()
    }
}
