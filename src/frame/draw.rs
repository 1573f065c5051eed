//! What a device is told to draw.

/// A draw of a batch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Draw {
    /// Patches one after another, the same number in each instance.
    Patches {
        /// The first.
        first: u32,
        /// Patches an instance.
        per_instance: u32,
        /// Instances.
        instances: u32,
    },
    /// Those patches that the device has decided to draw, of one of the batches that it makes of them in each view.
    Decided {
        /// Which, of those of the pass.
        batch: u32,
    },
    /// An instance a patch, all with the same refinement pattern.
    Pattern {
        /// Which of [`DrawList::patterns`](super::DrawList::patterns).
        pattern: u32,
        /// The first instance; [`DrawList::instances`](super::DrawList::instances) tells their patches.
        first_instance: u32,
        /// Instances.
        instances: u32,
        /// The segments of an edge of the pattern's lattice.
        segments: u32,
    },
}
