//! Batches: runs of patches that fit into the scratch ring together, and into whatever else bounds a draw.

use crate::abi;
use crate::error::{Error, Result};
use crate::gpu::backend::Backend;
use crate::method::{Pass, Prepared};
use crate::tessellation::{Levels, Spacing, levels, required_level};

/// How finely a surface is cut, the same for all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// The tess level of quads, 1..=64.
    pub level: f32,
    /// Spacing.
    pub spacing: Spacing,
}

impl Cut {
    /// The tess levels of a patch.
    pub fn levels(&self, pass: &Pass, patch: usize) -> Levels {
        levels(
            pass.domain,
            &pass.patches[patch],
            self.level,
            self.spacing,
            pass.max_level,
        )
    }

    /// The points that a patch needs in the ring.
    pub fn points(&self, pass: &Pass, patch: usize) -> u32 {
        // As the control shader has it: beside an n-gon the level may be more than what a plan of one level serves.
        let level = required_level(&self.levels(pass, patch), abi::HIGHEST_LEVEL);
        pass.points(patch, level)
    }

    /// The vertices that the tessellator makes of a patch.
    pub fn vertices(&self, pass: &Pass, patch: usize) -> u32 {
        self.levels(pass, patch).vertices(self.spacing)
    }
}

/// Patches of a pass that are drawn at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Batch {
    /// The pass.
    pub pass: usize,
    /// The first patch.
    pub first: u32,
    /// The one behind the last.
    pub end: u32,
    /// Points that its patches need in the ring.
    pub points: u32,
    /// Vertices that are captured of its patches; fewer where depth tags lower their levels.
    pub vertices: u32,
    /// Which of the batches that use the ring this is.
    pub ring_batch: u32,
}

impl Batch {
    /// Whether it must wait until an earlier batch is done with the ring.
    pub fn waits(&self) -> bool {
        self.points > 0 && self.ring_batch > 0
    }
}

/// What bounds a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bounds {
    /// Points in the ring.
    pub points: u32,
    /// Vertices.
    pub vertices: u32,
    /// Who makes them.
    pub backend: Backend,
}

/// Cuts all passes into batches within the bounds.
///
/// # Errors
/// [`Error::Option`] when one patch alone needs more points than the ring has.
pub(crate) fn batches(prepared: &Prepared, cut: Cut, bounds: Bounds) -> Result<Vec<Batch>> {
    let cut = bounds.backend.cut(cut);
    let mut batches: Vec<Batch> = Vec::new();
    let mut ring_batch = 0;
    for (number, pass) in prepared.passes.iter().enumerate() {
        let mut open: Option<Batch> = None;
        for patch in 0..pass.patches.len() {
            let points = cut.points(pass, patch);
            let levels = cut.levels(pass, patch);
            let vertices = bounds.backend.vertices(&levels, cut.spacing);
            if points > bounds.points {
                return Err(too_small(points));
            }
            let fits = |batch: &Batch| {
                batch.points + points <= bounds.points
                    && batch.vertices + vertices <= bounds.vertices.max(vertices)
            };
            match open.as_mut().filter(|batch| fits(batch)) {
                Some(batch) => {
                    batch.end += 1;
                    batch.points += points;
                    batch.vertices += vertices;
                }
                None => {
                    batches.extend(open.take());
                    let first = patch as u32;
                    open = Some(Batch {
                        pass: number,
                        first,
                        end: first + 1,
                        points,
                        vertices,
                        ring_batch,
                    });
                    ring_batch += u32::from(!pass.scratch_points.is_empty());
                }
            }
        }
        batches.extend(open);
    }
    Ok(batches)
}

fn too_small(points: u32) -> Error {
    Error::Option {
        option: "--ring-bytes",
        problem: format!(
            "the scratch ring is too small: a single patch needs {} bytes",
            16 * u64::from(points)
        ),
        remedy: "give a larger ring, or draw at a lower level".into(),
    }
}
