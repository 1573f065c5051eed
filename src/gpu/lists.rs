//! Where what the device draws of its decisions stands on the device, behind these.

use ash::vk;

use crate::abi;
use crate::error::Result;
use crate::frame::{Compaction, Decides, SurfaceOptions, most_batches};
use crate::method::{Pass, Prepared};

/// Batches that edits may make more than there are at first, of each pass.
const SPARE_BATCHES: u32 = 32;

// The words that shaders find by numbers.
const _: () = {
    assert!(size_of::<abi::DrawnBatch>() == 4 * abi::BATCH_WORDS as usize);
    assert!(std::mem::offset_of!(abi::DrawnBatch, first) == 4 * abi::BATCH_FIRST as usize);
    assert!(std::mem::offset_of!(abi::DrawnBatch, patches) == 4 * abi::BATCH_PATCHES as usize);
    let per_instance = std::mem::offset_of!(abi::DrawnBatch, per_instance);
    assert!(per_instance == 4 * abi::BATCH_PER_INSTANCE as usize);
};

/// Where what is drawn of a pass stands behind the decisions about its patches, in words: for each view its batches, the list of its patches, and what workgroups
/// of these need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lists {
    /// Batches that there is room for.
    batches: u32,
    patches: u32,
    /// Where they begin.
    first: u32,
}

impl Lists {
    /// Of each pass; none where the host decides.
    ///
    /// # Errors
    /// [`Misuse::RingTooSmall`](crate::Misuse::RingTooSmall).
    pub fn of_passes(
        prepared: &Prepared,
        options: &SurfaceOptions,
        instance_vertices: Option<u32>,
    ) -> Result<Vec<Lists>> {
        if options.decides == Decides::Host {
            return Ok(Vec::new());
        }
        let bounds = options.bounds(instance_vertices);
        let most = most_batches(prepared, options.greatest_cuts(), bounds)?;
        let of_pass = |(pass, batches): (&Pass, u32)| {
            let patches = pass.patches.len() as u32;
            let words = size_of::<abi::PatchDraw>() as u32 / 4;
            Lists {
                batches: batches + SPARE_BATCHES,
                patches,
                first: words * patches * options.views,
            }
        };
        Ok(prepared.passes.iter().zip(most).map(of_pass).collect())
    }

    /// Their bytes for so many views, and what a buffer is used for that has them.
    pub fn room(&self, views: u64) -> (u64, vk::BufferUsageFlags) {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::INDIRECT_BUFFER;
        (4 * views * u64::from(self.view_words()), usage)
    }

    /// Whether there is room for as many batches.
    pub fn has_room(&self, own: &Compaction) -> bool {
        own.batches <= self.batches
    }

    /// Workgroups of all patches.
    pub fn workgroups(&self) -> u32 {
        self.patches.div_ceil(abi::DECIDE_INVOCATIONS)
    }

    /// From one view to the next.
    pub fn view_words(&self) -> u32 {
        let needs = abi::NEEDS_WORDS * (self.workgroups() + 1);
        abi::BATCH_WORDS * self.batches + self.patches + needs
    }

    /// How many patches there are.
    pub fn patches(&self) -> u32 {
        self.patches
    }

    /// The place of a batch of a view.
    pub fn batch(&self, view: u32, batch: u32) -> u32 {
        self.first + view * self.view_words() + abi::BATCH_WORDS * batch
    }

    /// The place of a view's list.
    pub fn list(&self, view: u32) -> u32 {
        self.batch(view, self.batches)
    }
}
