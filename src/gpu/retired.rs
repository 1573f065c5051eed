//! What edits leave behind on the device.

use crate::gpu::bound::Bound;
use crate::gpu::staging::Staging;
use crate::gpu::{Buffer, Memory};

/// What edits have replaced on the device. The frames that were recorded before may still read it: the owner calls [`Retired::destroy`] when they have ended.
#[derive(Debug, Default)]
#[must_use = "it is destroyed when the frames that were recorded before have ended"]
pub struct Retired {
    bound: Vec<Bound>,
    staged: Vec<Buffer>,
}

impl Retired {
    /// Of buffers, and what they were staged in.
    pub(super) fn of(bound: Bound, staging: Staging) -> Retired {
        Retired {
            bound: vec![bound],
            staged: staging.into_buffer().into_iter().collect(),
        }
    }

    /// Whether there is nothing to be destroyed, as after most edits.
    pub fn is_empty(&self) -> bool {
        self.bound.is_empty()
    }

    /// Takes over what another edit has replaced.
    pub fn extend(&mut self, other: Retired) {
        self.bound.extend(other.bound);
        self.staged.extend(other.staged);
    }

    /// Destroys it.
    ///
    /// # Safety
    /// `device` and `allocator` are those that made it, no submitted command still uses tables and poses as they were before the edits, and no recorded one will be
    /// submitted.
    pub unsafe fn destroy(self, device: &ash::Device, allocator: &mut dyn Memory) {
        for staged in self.staged {
            // SAFETY: this function's contract.
            unsafe { staged.destroy(device, allocator) };
        }
        for bound in self.bound {
            // SAFETY: as above.
            unsafe { bound.destroy(device, allocator) };
        }
    }
}
