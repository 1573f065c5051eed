//! What a draw list makes of decisions of the device.

use crate::abi;
#[cfg(feature = "vulkan")]
use crate::frame::Compaction;
use crate::frame::{Compacted, DrawList};
use crate::method::Prepared;

impl DrawList {
    /// How batches come about, by pass; none where the host decides.
    #[cfg(feature = "vulkan")]
    pub(crate) fn compactions(&self) -> &[Option<Compaction>] {
        &self.compactions
    }

    /// What a view draws of a pass of `prepared`, which the list was made for, where a device has decided about its patches so: what it makes of these decisions with
    /// `cmd_decide`, the first two words and the fourth of batches aside, which commands alone need. None where the host decides, or there is no such pass.
    pub fn compacted(
        &self,
        prepared: &Prepared,
        pass: usize,
        decided: &[abi::PatchDraw],
    ) -> Option<Compacted> {
        let own = self.compactions.get(pass).copied().flatten()?;
        let patches = prepared.passes.get(pass)?;
        let count = decided.len().min(patches.patches.len());
        Some(own.compacted(patches, &decided[..count], self.cut().spacing))
    }
}
