//! Every vertex that comes of our surfaces.

mod cuts;

use crate::conformance::Context;
use crate::error::Result;
use crate::gpu::{Cut, Fill, SurfaceOptions};
use crate::mesh::Model;
use crate::method::Prepared;

pub use crate::conformance::bench::{Loaded, SIDE};
pub use crate::host::{Frame, vertex_bits as bits};
pub use cuts::{SPACINGS, cut, over_patches, prepare, spacing_name, vertices};

/// The most vertices that are captured in one submission: 36 MB.
const MOST_CAPTURED: u32 = 1_000_000;

/// Options for capturing everything at a cut, with room for vertices that come several times.
pub fn capturing(context: &Context, prepared: &Prepared, cut: Cut) -> SurfaceOptions {
    SurfaceOptions {
        ring_bytes: context.settings.ring_bytes,
        slots: context.settings.slots,
        capture_vertices: vertices(prepared, cut)
            .saturating_mul(4)
            .clamp(1 << 14, MOST_CAPTURED),
        greatest_level: cut.level.max(1.0),
        ..Default::default()
    }
}

/// Prepares a model by a method, draws it at a cut with the context's settings, and captures everything.
pub fn captured(
    context: &Context,
    model: &Model,
    prepared: Prepared,
    cut: Cut,
    fill: Fill,
) -> Result<Frame> {
    let options = capturing(context, &prepared, cut);
    let workarounds = context.workarounds()?;
    let mut loaded = context
        .bench()?
        .load(model, prepared, &workarounds, options)?;
    loaded.capture(cut, fill)
}
