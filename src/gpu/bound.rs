//! Buffers, and the descriptor sets through which shaders see them.

use ash::vk;
use gpu_allocator::MemoryLocation;

use crate::error::{Error, Misuse, Result};
use crate::gpu::{Buffer, Layout, Memory, failed};

/// What makes buffers.
pub(super) struct Maker<'a> {
    pub device: &'a ash::Device,
    pub allocator: &'a mut dyn Memory,
    pub layout: &'a Layout,
}

/// What a set has at a binding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binding {
    /// The number of the binding.
    pub number: u32,
    /// The number of the buffer.
    pub buffer: usize,
    /// Which part of a uniform buffer; storage buffers are seen as a whole.
    pub uniform: Option<(u64, u64)>,
}

impl Binding {
    pub fn storage(number: u32, buffer: usize) -> Binding {
        Binding {
            number,
            buffer,
            uniform: None,
        }
    }

    pub fn uniform(number: u32, buffer: usize, offset: u64, range: u64) -> Binding {
        Binding {
            number,
            buffer,
            uniform: Some((offset, range)),
        }
    }

    fn kind(&self) -> vk::DescriptorType {
        match self.uniform {
            None => vk::DescriptorType::STORAGE_BUFFER,
            Some(_) => vk::DescriptorType::UNIFORM_BUFFER,
        }
    }
}

/// Buffers with the sets that show them: whatever has one lifetime.
#[derive(Debug, Default)]
pub(super) struct Bound {
    buffers: Vec<Buffer>,
    sets: Vec<vk::DescriptorSet>,
    pool: vk::DescriptorPool,
}

impl Bound {
    /// Makes a buffer, and gives its number.
    ///
    /// # Errors
    /// [`Misuse::BufferTooLarge`] (VUID-VkWriteDescriptorSet-descriptorType-00333); Vulkan's own.
    ///
    /// # Safety
    /// The device is live and the allocator its own.
    pub unsafe fn add(
        &mut self,
        maker: &mut Maker<'_>,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<usize> {
        let limit = u64::from(maker.layout.enabled().max_storage_buffer_range);
        if usage.contains(vk::BufferUsageFlags::STORAGE_BUFFER) && size > limit {
            let (what, bytes) = (name.into(), size);
            return Err(Error::Misuse(Misuse::BufferTooLarge { what, bytes, limit }));
        }
        let (device, allocator) = (maker.device, &mut *maker.allocator);
        // SAFETY: this function's contract.
        let buffer = unsafe { Buffer::new(device, allocator, name, size, usage, location)? };
        self.buffers.push(buffer);
        Ok(self.buffers.len() - 1)
    }

    /// A storage buffer on the device that is filled by copies.
    ///
    /// # Errors
    /// As [`Bound::add`].
    ///
    /// # Safety
    /// As [`Bound::add`].
    pub unsafe fn add_target(
        &mut self,
        maker: &mut Maker<'_>,
        name: &str,
        size: u64,
    ) -> Result<usize> {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        // SAFETY: this function's contract.
        unsafe { self.add(maker, name, size, usage, MemoryLocation::GpuOnly) }
    }

    /// Makes a descriptor set of each list of bindings.
    ///
    /// # Safety
    /// All buffers.
    pub fn buffers(&self) -> &[Buffer] {
        &self.buffers
    }

    /// `device` is live and made `layout`; no sets have been made before.
    pub unsafe fn describe(
        &mut self,
        device: &ash::Device,
        layout: vk::DescriptorSetLayout,
        sets: &[Vec<Binding>],
    ) -> Result<()> {
        let count = |kind: vk::DescriptorType| {
            let all = sets.iter().flatten().filter(|b| b.kind() == kind).count();
            vk::DescriptorPoolSize::default()
                .ty(kind)
                .descriptor_count(all.max(1) as u32)
        };
        let kinds = [
            vk::DescriptorType::STORAGE_BUFFER,
            vk::DescriptorType::UNIFORM_BUFFER,
        ];
        let sizes = kinds.map(count);
        let info = vk::DescriptorPoolCreateInfo::default()
            .max_sets(sets.len().max(1) as u32)
            .pool_sizes(&sizes);
        // SAFETY: the device is live.
        self.pool = unsafe { device.create_descriptor_pool(&info, None) }
            .map_err(failed("vkCreateDescriptorPool"))?;
        if sets.is_empty() {
            return Ok(());
        }
        let layouts = vec![layout; sets.len()];
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool was made for as many sets of this layout.
        self.sets = unsafe { device.allocate_descriptor_sets(&info) }
            .map_err(failed("vkAllocateDescriptorSets"))?;
        for (&set, bindings) in self.sets.iter().zip(sets) {
            for binding in bindings {
                let (offset, range) = binding.uniform.unwrap_or((0, vk::WHOLE_SIZE));
                let info = [vk::DescriptorBufferInfo::default()
                    .buffer(self.buffers[binding.buffer].raw())
                    .offset(offset)
                    .range(range)];
                let write = vk::WriteDescriptorSet::default()
                    .dst_set(set)
                    .dst_binding(binding.number)
                    .descriptor_type(binding.kind())
                    .buffer_info(&info);
                // SAFETY: sets and buffers are of this device and in no use yet.
                unsafe { device.update_descriptor_sets(&[write], &[]) };
            }
        }
        Ok(())
    }

    pub fn buffer(&self, number: usize) -> &Buffer {
        &self.buffers[number]
    }

    pub fn buffer_mut(&mut self, number: usize) -> &mut Buffer {
        &mut self.buffers[number]
    }

    pub fn set(&self, number: usize) -> vk::DescriptorSet {
        self.sets[number]
    }

    /// The bytes of all buffers.
    pub fn bytes(&self) -> u64 {
        self.buffers.iter().map(Buffer::size).sum()
    }

    /// Destroys everything.
    ///
    /// # Safety
    /// `device` and `allocator` are those that made it, no submitted command still uses it, and no recorded one will be submitted.
    pub unsafe fn destroy(self, device: &ash::Device, allocator: &mut dyn Memory) {
        // SAFETY: this function's contract. The sets go with their pool; a null pool is fine.
        unsafe { device.destroy_descriptor_pool(self.pool, None) };
        for buffer in self.buffers {
            // SAFETY: this function's contract.
            unsafe { buffer.destroy(device, allocator) };
        }
    }
}
