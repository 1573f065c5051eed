//! A descriptor set of storage buffers.

use ash::vk;

use crate::error::Result;
use crate::gpu::{Buffer, failed};
use crate::host::Device;

/// A descriptor set of storage buffers at bindings 0, 1, ..., with its layout and the pool that it is from.
pub(crate) struct StorageSet {
    device: Device,
    layout: vk::DescriptorSetLayout,
    pool: vk::DescriptorPool,
    set: vk::DescriptorSet,
}

impl StorageSet {
    /// A set of the buffers, which the stages see. They stay the caller's, and live as long as commands with the set may run.
    pub fn new<'b>(
        device: &Device,
        stages: vk::ShaderStageFlags,
        buffers: impl ExactSizeIterator<Item = &'b Buffer>,
    ) -> Result<StorageSet> {
        // Null handles until made: if a step fails, what was made before it goes with the set.
        let mut made = StorageSet {
            device: device.clone(),
            layout: vk::DescriptorSetLayout::null(),
            pool: vk::DescriptorPool::null(),
            set: vk::DescriptorSet::null(),
        };
        made.make_layout(stages, buffers.len() as u32)?;
        made.make_set(buffers.len() as u32)?;
        made.write(buffers);
        Ok(made)
    }

    fn make_layout(&mut self, stages: vk::ShaderStageFlags, count: u32) -> Result<()> {
        let binding = |number| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(number)
                .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                .descriptor_count(1)
                .stage_flags(stages)
        };
        let bindings: Vec<vk::DescriptorSetLayoutBinding> = (0..count).map(binding).collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is live, here and below; the infos' pointers live through the calls.
        self.layout = unsafe { self.device.raw().create_descriptor_set_layout(&info, None) }
            .map_err(failed("vkCreateDescriptorSetLayout"))?;
        Ok(())
    }

    fn make_set(&mut self, count: u32) -> Result<()> {
        let device = self.device.raw();
        let sizes = [vk::DescriptorPoolSize::default()
            .ty(vk::DescriptorType::STORAGE_BUFFER)
            .descriptor_count(count)];
        let info = vk::DescriptorPoolCreateInfo::default()
            .max_sets(1)
            .pool_sizes(&sizes);
        // SAFETY: as above.
        self.pool = unsafe { device.create_descriptor_pool(&info, None) }
            .map_err(failed("vkCreateDescriptorPool"))?;
        let layouts = [self.layout];
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool was made for one set of this layout.
        self.set = unsafe { device.allocate_descriptor_sets(&info) }
            .map_err(failed("vkAllocateDescriptorSets"))?[0];
        Ok(())
    }

    fn write<'b>(&self, buffers: impl Iterator<Item = &'b Buffer>) {
        for (binding, buffer) in (0..).zip(buffers) {
            let info = [vk::DescriptorBufferInfo::default()
                .buffer(buffer.raw())
                .range(vk::WHOLE_SIZE)];
            let write = vk::WriteDescriptorSet::default()
                .dst_set(self.set)
                .dst_binding(binding)
                .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                .buffer_info(&info);
            // SAFETY: set and buffer are of this device and in no use yet.
            unsafe { self.device.raw().update_descriptor_sets(&[write], &[]) };
        }
    }

    /// The handle of its layout.
    pub fn layout(&self) -> vk::DescriptorSetLayout {
        self.layout
    }

    /// The handle of the set.
    pub fn raw(&self) -> vk::DescriptorSet {
        self.set
    }
}

impl Drop for StorageSet {
    fn drop(&mut self) {
        // A queue that hangs may still use everything.
        if self.device.is_hung() {
            return;
        }
        let device = self.device.raw();
        // SAFETY: the owner has waited for what used it; null handles are allowed.
        unsafe {
            device.destroy_descriptor_pool(self.pool, None);
            device.destroy_descriptor_set_layout(self.layout, None);
        }
    }
}
