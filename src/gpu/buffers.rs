//! The buffers of a surface: which there are, what shaders see of them, and how they are made and filled.

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocator;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::gpu::Buffer;
use crate::gpu::staging::Staging;
use crate::method::Pass;

/// Every buffer, and what is to be copied where once.
#[derive(Debug, Default)]
pub struct Buffers {
    pub all: Vec<Buffer>,
    /// What topology decides, which is copied once.
    pub tables: Staging,
    /// Positions and what is computed from them, which may be replaced.
    pub pose: Staging,
    pub positions: usize,
    pub points: usize,
    pub point_rows: usize,
    pub point_terms: usize,
    pub ring: usize,
    pub counters: usize,
    pub counted: usize,
    pub capture: usize,
    /// A pass each, in the place of the capture; empty where nothing is counted.
    pub counts: Vec<usize>,
    /// A pass each: patches, controls, texture, draws, instances, the method's tables.
    pub passes: Vec<Vec<usize>>,
}

/// What stands in place of counts that no device has written: more overflows than there are patches.
pub const NOT_READ_BACK: [u32; 2] = [u32::MAX; 2];

/// Where a pass's draws stand in [`Buffers::passes`].
pub const DRAWS: usize = 3;
/// Where a pass's instances stand.
pub const INSTANCES: usize = 4;

impl Buffers {
    /// What pass `pass` has at a binding. Bindings that it does not use get its patches: something must be bound.
    pub fn bound(&self, pass: usize, binding: u32) -> &Buffer {
        let tables = &self.passes[pass];
        let number = match binding {
            abi::BINDING_POSITIONS => self.positions,
            abi::BINDING_PATCHES => tables[0],
            abi::BINDING_CONTROLS => tables[1],
            abi::BINDING_TEXTURE => tables[2],
            abi::BINDING_SCRATCH => self.ring,
            abi::BINDING_COUNTERS => self.counters,
            abi::BINDING_DRAWS => tables[DRAWS],
            abi::BINDING_INSTANCES => tables[INSTANCES],
            abi::BINDING_CAPTURE => *self.counts.get(pass).unwrap_or(&self.capture),
            abi::BINDING_POINTS => self.points,
            abi::BINDING_POINT_ROWS => self.point_rows,
            abi::BINDING_POINT_TERMS => self.point_terms,
            table => *tables
                .get((table - abi::BINDING_TABLES) as usize + INSTANCES + 1)
                .unwrap_or(&tables[0]),
        };
        &self.all[number]
    }

    pub fn counters(&self) -> &Buffer {
        &self.all[self.counters]
    }

    pub fn counted(&self) -> &Buffer {
        &self.all[self.counted]
    }

    pub fn capture(&self) -> &Buffer {
        &self.all[self.capture]
    }

    /// What counts the vertices of each pass; none where they are not counted.
    pub fn counts(&self) -> impl Iterator<Item = &Buffer> {
        self.counts.iter().map(|&number| &self.all[number])
    }

    /// What has to be copied since this was asked last: from where to where.
    pub fn take_uploads(&mut self) -> Vec<(vk::Buffer, vk::Buffer, vk::BufferCopy)> {
        let mut uploads = Vec::new();
        for staging in [&mut self.tables, &mut self.pose] {
            if let Some((from, copies)) = staging.take_copies() {
                let to = copies.iter().filter(|(_, copy)| copy.size > 0);
                uploads.extend(to.map(|&(number, copy)| (from, self.all[number].raw(), copy)));
            }
        }
        uploads
    }

    /// Takes the memory out that tables were staged in.
    pub fn take_staged_tables(&mut self) -> Option<Buffer> {
        std::mem::take(&mut self.tables).into_buffer()
    }
}

/// Makes buffers and gathers what goes into them.
pub struct Maker<'a> {
    pub device: &'a ash::Device,
    pub allocator: &'a mut Allocator,
    pub buffers: &'a mut Buffers,
    /// Bytes that shaders see of a buffer.
    pub limit: u64,
}

impl Maker<'_> {
    /// # Errors
    /// [`Misuse::BufferTooLarge`] (VUID-VkWriteDescriptorSet-descriptorType-00333); Vulkan's own.
    ///
    /// # Safety
    /// The device is live and the allocator its own.
    pub unsafe fn buffer(
        &mut self,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<usize> {
        if usage.contains(vk::BufferUsageFlags::STORAGE_BUFFER) && size > self.limit {
            let (what, bytes, limit) = (name.into(), size, self.limit);
            return Err(Error::Misuse(Misuse::BufferTooLarge { what, bytes, limit }));
        }
        // SAFETY: this function's contract.
        let buffer =
            unsafe { Buffer::new(self.device, self.allocator, name, size, usage, location)? };
        self.buffers.all.push(buffer);
        Ok(self.buffers.all.len() - 1)
    }

    /// A buffer on the device that will hold `bytes` once and for all.
    ///
    /// # Safety
    /// As [`Maker::buffer`].
    pub unsafe fn table(&mut self, name: &str, bytes: &[u8]) -> Result<usize> {
        // SAFETY: this function's contract.
        let number = unsafe { self.target(name, bytes)? };
        self.buffers.tables.add(number, bytes);
        Ok(number)
    }

    /// A buffer on the device whose contents follow from positions.
    ///
    /// # Safety
    /// As [`Maker::buffer`].
    pub unsafe fn pose(&mut self, name: &str, bytes: &[u8]) -> Result<usize> {
        // SAFETY: this function's contract.
        let number = unsafe { self.target(name, bytes)? };
        self.buffers.pose.add(number, bytes);
        Ok(number)
    }

    /// # Safety
    /// As [`Maker::buffer`].
    pub unsafe fn target(&mut self, name: &str, bytes: &[u8]) -> Result<usize> {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        let (size, local) = (bytes.len() as u64, MemoryLocation::GpuOnly);
        // SAFETY: this function's contract.
        unsafe { self.buffer(name, size, usage, local) }
    }

    /// # Safety
    /// As [`Maker::buffer`].
    pub unsafe fn pass(&mut self, pass: &Pass) -> Result<Vec<usize>> {
        let patches = pass.patches.len();
        let (storage, written) = (
            vk::BufferUsageFlags::STORAGE_BUFFER,
            MemoryLocation::CpuToGpu,
        );
        let draws = (size_of::<abi::PatchDraw>() * patches) as u64;
        let instances = (size_of::<u32>() * patches) as u64;
        // SAFETY: this function's contract.
        unsafe {
            let mut tables = vec![
                self.table("patches", bytemuck::cast_slice(&pass.patches))?,
                self.table("controls", bytemuck::cast_slice(&pass.controls))?,
                self.table("texture coordinates", bytemuck::cast_slice(&pass.texture))?,
                self.buffer("draws", draws, storage, written)?,
                self.buffer("instances", instances, storage, written)?,
            ];
            for table in &pass.tables {
                tables.push(self.table("method's table", bytemuck::cast_slice(table))?);
            }
            Ok(tables)
        }
    }

    /// Makes and fills the staging memory.
    ///
    /// # Safety
    /// As [`Maker::buffer`].
    pub unsafe fn stage(&mut self) -> Result<()> {
        let Buffers { tables, pose, .. } = &mut *self.buffers;
        for staging in [tables, pose] {
            // SAFETY: this function's contract.
            unsafe { staging.fill(self.device, self.allocator)? };
        }
        Ok(())
    }
}
