//! Refinement patterns on the device: which patch is drawn with which, and the indices of all that have been needed so far.

use std::ops::Range;

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocator;
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::Result;
use crate::gpu::{Batch, Buffer};
use crate::tessellation::{Domain, Levels, lattice_segments, pattern};

/// Instances that are drawn with one pattern.
#[derive(Clone, Debug)]
pub(super) struct PatternDraw {
    /// Its indices.
    pub indices: Range<u32>,
    /// The instances, in the pass's list.
    pub instances: Range<u32>,
    /// The segments of an edge of its lattice.
    pub segments: u32,
}

/// What a pattern depends on: the shape, and the levels of the edges.
type Key = (Domain, [u32; 4]);

/// The patterns of a surface.
#[derive(Debug, Default)]
pub(super) struct Patterns {
    known: FxHashMap<Key, Range<u32>>,
    indices: Vec<u16>,
    buffer: Option<Buffer>,
    /// By pass and first patch of a batch.
    draws: FxHashMap<(usize, u32), Vec<PatternDraw>>,
}

impl Patterns {
    /// Forgets who is drawn with which pattern; the patterns stay.
    pub fn clear(&mut self) {
        self.draws.clear();
    }

    /// Sorts the patches of a batch by the patterns that their levels ask for, and returns them in the order of instances.
    pub fn arrange(&mut self, batch: &Batch, levels: impl Fn(u32) -> Levels) -> Vec<u32> {
        let mut patches: Vec<(Key, Levels, u32)> = (batch.first..batch.end)
            .map(|patch| {
                let levels = levels(patch);
                (key(&levels), levels, patch)
            })
            .collect();
        patches.sort_by_key(|&((_, edges), _, patch)| (edges, patch));
        let mut draws = Vec::new();
        let mut first = batch.first;
        for run in patches.chunk_by(|a, b| a.0 == b.0) {
            let end = first + run.len() as u32;
            draws.push(PatternDraw {
                indices: self.provide(&run[0].1),
                instances: first..end,
                segments: lattice_segments(&run[0].1),
            });
            first = end;
        }
        self.draws.insert((batch.pass, batch.first), draws);
        patches.into_iter().map(|(_, _, patch)| patch).collect()
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

    /// Brings all indices to the device, into a larger buffer if need be.
    ///
    /// # Safety
    /// `device` and `allocator` are those of the surface, and no submitted command still uses the patterns.
    pub unsafe fn write(&mut self, device: &ash::Device, allocator: &mut Allocator) -> Result<()> {
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
            buffer.write(0, bytes);
        }
        Ok(())
    }

    /// The buffer of indices, and what a batch draws of it; nothing when it has not been arranged.
    pub fn draws(&self, batch: &Batch) -> Option<(vk::Buffer, &[PatternDraw])> {
        let draws = self.draws.get(&(batch.pass, batch.first))?;
        Some((self.buffer.as_ref()?.raw(), draws))
    }

    /// Destroys the buffer.
    ///
    /// # Safety
    /// As [`Patterns::write`].
    pub unsafe fn destroy(self, device: &ash::Device, allocator: &mut Allocator) {
        if let Some(buffer) = self.buffer {
            // SAFETY: this function's contract.
            unsafe { buffer.destroy(device, allocator) };
        }
    }
}

fn key(levels: &Levels) -> Key {
    (levels.domain, levels.edges.map(|level| level as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(edges: [f32; 3]) -> Levels {
        let [a, b, c] = edges;
        Levels {
            domain: Domain::Triangles,
            edges: [a, b, c, c],
            inside: a.max(b).max(c),
        }
    }

    #[test]
    fn patches_with_the_same_tags_are_instances_of_one_pattern_which_is_made_once() {
        let edges = [
            [4.0, 4.0, 4.0],
            [4.0, 2.0, 4.0],
            [4.0, 4.0, 4.0],
            [4.0, 2.0, 4.0],
        ];
        let mut patterns = Patterns::default();
        let batch = Batch {
            pass: 0,
            first: 0,
            end: 4,
            points: 0,
            vertices: 0,
            ring_batch: 0,
        };
        let instances = patterns.arrange(&batch, |patch| triangle(edges[patch as usize]));
        assert_eq!(instances, [1, 3, 0, 2]);
        let draws = patterns.draws[&(0, 0)].clone();
        let ranges: Vec<_> = draws.iter().map(|draw| draw.instances.clone()).collect();
        assert_eq!(ranges, [0..2, 2..4]);
        assert_eq!(draws[1].indices.len(), 3 * 16);
        let made = patterns.indices.len();
        patterns.clear();
        patterns.arrange(&batch, |patch| triangle(edges[patch as usize]));
        assert_eq!(patterns.indices.len(), made);
    }
}
