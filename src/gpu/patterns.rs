//! Refinement patterns on the device: the indices of all that have been needed so far.

use std::ops::Range;

use ash::vk;
use gpu_allocator::MemoryLocation;
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::Result;
use crate::frame::{Key, key};
use crate::gpu::{Buffer, Memory};
use crate::tessellation::{Levels, pattern};

/// The patterns of a surface.
#[derive(Debug, Default)]
pub(super) struct Patterns {
    known: FxHashMap<Key, Range<u32>>,
    indices: Vec<u16>,
    buffer: Option<Buffer>,
    /// Where the patterns of the draw list are that was written last.
    places: Vec<Range<u32>>,
}

impl Patterns {
    /// Brings the patterns of a draw list to the device, into a larger buffer if need be.
    ///
    /// # Safety
    /// `device` and `allocator` are those of the surface, and no submitted command still uses the patterns.
    pub unsafe fn write(
        &mut self,
        device: &ash::Device,
        allocator: &mut dyn Memory,
        patterns: &[Levels],
    ) -> Result<()> {
        self.places = patterns.iter().map(|levels| self.provide(levels)).collect();
        let bytes: &[u8] = bytemuck::cast_slice(&self.indices);
        let needed = bytes.len() as u64;
        if self
            .buffer
            .as_ref()
            .is_none_or(|buffer| buffer.size() < needed)
        {
            let size = needed.next_power_of_two().max(1 << 12);
            let usage = vk::BufferUsageFlags::INDEX_BUFFER;
            let location = MemoryLocation::CpuToGpu;
            // SAFETY: this function's contract.
            let larger =
                unsafe { Buffer::new(device, allocator, "patterns", size, usage, location)? };
            if let Some(smaller) = self.buffer.replace(larger) {
                // SAFETY: this function's contract.
                unsafe { smaller.destroy(device, allocator) };
            }
        }
        if let Some(buffer) = &mut self.buffer {
            buffer.write(0, bytes)?;
        }
        Ok(())
    }

    /// Where the indices of a pattern are; they are made when it is new.
    fn provide(&mut self, levels: &Levels) -> Range<u32> {
        let indices = &mut self.indices;
        let made = self.known.entry(key(levels)).or_insert_with(|| {
            let start = indices.len() as u32;
            let places = pattern(levels).into_iter().flatten();
            indices.extend(places.map(|[i, j]| (i | j << abi::PATTERN_SHIFT) as u16));
            start..indices.len() as u32
        });
        made.clone()
    }

    /// The buffer of indices, if anything has been written.
    pub fn buffer(&self) -> Option<vk::Buffer> {
        self.buffer.as_ref().map(Buffer::raw)
    }

    /// Where the indices of a pattern of the draw list are that was written last.
    pub fn place(&self, pattern: u32) -> Range<u32> {
        self.places[pattern as usize].clone()
    }

    /// Destroys the buffer.
    ///
    /// # Safety
    /// As [`Patterns::write`].
    pub unsafe fn destroy(self, device: &ash::Device, allocator: &mut dyn Memory) {
        if let Some(buffer) = self.buffer {
            // SAFETY: this function's contract.
            unsafe { buffer.destroy(device, allocator) };
        }
    }
}
