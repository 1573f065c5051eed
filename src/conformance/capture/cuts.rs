//! Cuts and what comes of them: the words of cases, and predictions.

use crate::error::Result;
use crate::gpu::Cut;
use crate::mesh::Model;
use crate::method::{Prepared, method};
use crate::plan::PlanOptions;
use crate::tessellation::Spacing;

/// A cut.
pub fn cut(level: f32, spacing: Spacing) -> Cut {
    Cut { level, spacing }
}

/// Both spacings that our surfaces have.
pub const SPACINGS: [Spacing; 2] = [Spacing::Equal, Spacing::FractionalEven];

/// A spacing's name as case names have it.
pub fn spacing_name(spacing: Spacing) -> &'static str {
    match spacing {
        Spacing::Equal => "equal",
        Spacing::FractionalEven => "fractional_even",
    }
}

/// A model made ready by the method of a name.
pub fn prepare(model: &Model, name: &str) -> Result<Prepared> {
    method(name)?.prepare(model, PlanOptions::default())
}

/// A sum over all patches of all passes.
pub fn over_patches(prepared: &Prepared, value: impl Fn(usize, usize) -> u32) -> u32 {
    let passes = prepared.passes.iter().enumerate();
    passes
        .flat_map(|(number, pass)| (0..pass.patches.len()).map(move |patch| (number, patch)))
        .map(|(pass, patch)| value(pass, patch))
        .sum()
}

/// The vertices that the tessellator makes of everything.
pub fn vertices(prepared: &Prepared, cut: Cut) -> u32 {
    over_patches(prepared, |pass, patch| {
        cut.vertices(&prepared.passes[pass], patch)
    })
}
