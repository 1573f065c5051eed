//! Whether all that was drawn has arrived: what the host predicts of each patch against what the evaluating shader did.

use rustc_hash::FxHashSet;

use crate::error::{Error, Result};
use crate::gpu::{Batch, Drawing};
use crate::method::Pass;

/// How much of what was predicted has arrived.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Arrival {
    /// Patches that were drawn.
    pub patches: u32,
    /// Those of which something is missing.
    pub incomplete: u32,
    /// Vertices that were predicted of all patches.
    pub vertices: u64,
    /// Those that are missing.
    pub missing: u64,
}

impl Arrival {
    /// Refuses what is not whole.
    ///
    /// # Errors
    /// [`Error::Lost`] when anything is missing.
    pub fn check(self) -> Result<()> {
        if self.missing == 0 {
            return Ok(());
        }
        Err(Error::Lost {
            what: format!(
                "{} of {} vertices, in {} of {} patches",
                self.missing, self.vertices, self.incomplete, self.patches
            ),
        })
    }

    /// Adds a patch of which so many vertices were predicted, and so many came.
    fn add(&mut self, predicted: u32, came: u32) {
        self.patches += 1;
        self.vertices += u64::from(predicted);
        self.missing += u64::from(predicted.saturating_sub(came));
        self.incomplete += u32::from(came < predicted);
    }
}

impl std::ops::AddAssign for Arrival {
    fn add_assign(&mut self, other: Arrival) {
        self.patches += other.patches;
        self.incomplete += other.incomplete;
        self.vertices += other.vertices;
        self.missing += other.missing;
    }
}

impl Drawing<'_> {
    /// Whether all vertices have come of the batches that were drawn since [`cmd_prepare`](super::FrameSlot::cmd_prepare), given once for each time. By the
    /// count of each patch, so that vertices which a device evaluates twice do not stand in for others that are missing.
    ///
    /// Needs [`count_vertices`](super::SurfaceOptions::count_vertices), or [`capture_vertices`](super::SurfaceOptions::capture_vertices) and
    /// batches of a single pass, each given once; where patches are cut into pieces, a single batch. Meaningful when [`cmd_read_back`](super::FrameSlot::cmd_read_back) has been executed, where no patch
    /// overflowed.
    ///
    /// # Errors
    /// [`Misuse::NotReadBack`](crate::Misuse::NotReadBack); [`Misuse::OtherSurface`](crate::Misuse::OtherSurface) for batches of another.
    pub fn arrival<'l>(&self, batches: impl IntoIterator<Item = Batch<'l>>) -> Result<Arrival> {
        let came = self.came()?;
        let mut predicted: Vec<Vec<u32>> = came.iter().map(|came| vec![0; came.len()]).collect();
        for batch in batches {
            self.slot.check_owner(self.tables, batch.list())?;
            for patch in batch.patches() {
                predicted[batch.pass()][patch as usize] += self.evaluations(batch, patch);
            }
        }
        let mut arrival = Arrival::default();
        let patches = predicted.iter().flatten().zip(came.iter().flatten());
        // Every patch that was drawn has vertices.
        for (&predicted, &came) in patches.filter(|&(&predicted, _)| predicted > 0) {
            arrival.add(predicted, came);
        }
        Ok(arrival)
    }

    /// How often a patch of a batch is evaluated at least, each time that it is drawn.
    fn evaluations(&self, batch: Batch<'_>, patch: u32) -> u32 {
        let prepared = self.tables.prepared();
        match self.slot.options().count_vertices {
            true => batch.evaluations(prepared, patch),
            false => batch.different_vertices(prepared, patch),
        }
    }

    /// By pass and patch: vertices counted, or different ones captured. What is captured does not tell its pass, and counts for each.
    fn came(&self) -> Result<Vec<Vec<u32>>> {
        let slot = self.slot;
        slot.counters()?;
        if slot.options().count_vertices {
            return Ok(slot.counts());
        }
        let captured = slot.captured()?.iter();
        let places: FxHashSet<(u32, [u32; 2])> = captured
            .map(|vertex| (vertex.patch_number, vertex.uv.map(f32::to_bits)))
            .collect();
        let of_pass = |pass: &Pass| {
            let mut came = vec![0; pass.patches.len()];
            for (patch, _) in &places {
                if let Some(came) = came.get_mut(*patch as usize) {
                    *came += 1;
                }
            }
            came
        };
        Ok(self.tables.prepared().passes.iter().map(of_pass).collect())
    }
}
