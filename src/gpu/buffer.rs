//! A buffer with memory of its own.

use crate::error::{Error, Misuse, Result};
use crate::gpu::{Memory, MemoryBlock, MemoryRequest, failed};
use ash::vk;
use gpu_allocator::MemoryLocation;

/// A Vulkan buffer and the memory bound to it.
///
/// It borrows nothing, so the owner must call [`Buffer::destroy`]; a buffer that is only dropped leaks until the device goes
/// (and the validation layer says so).
#[derive(Debug)]
pub struct Buffer {
    raw: vk::Buffer,
    size: u64,
    block: MemoryBlock,
}

impl Buffer {
    /// A buffer of `size` bytes; `name` is what the allocator's reports call it.
    ///
    /// A size of 0 is fine here, though not in Vulkan (VUID-VkBufferCreateInfo-size-00912): 4 bytes are allocated then.
    ///
    /// # Safety
    /// `device` is live, `memory` is its own, and `usage` needs no feature that the device was created without.
    pub unsafe fn new(
        device: &ash::Device,
        memory: &mut dyn Memory,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<Buffer> {
        let info = vk::BufferCreateInfo::default()
            .size(size.max(4))
            .usage(usage)
            .sharing_mode(vk::SharingMode::EXCLUSIVE);
        // SAFETY: the device is live by this function's contract; the info's pointers live through the call.
        let raw = unsafe { device.create_buffer(&info, None) }.map_err(failed("vkCreateBuffer"))?;
        // SAFETY: `raw` was just made from `device` and nothing has been bound to it.
        match unsafe { allocate_and_bind(device, memory, name, raw, location) } {
            Ok(block) => Ok(Buffer { raw, size, block }),
            Err(error) => {
                // SAFETY: `raw` is ours and no command has seen it.
                unsafe { device.destroy_buffer(raw, None) };
                Err(error)
            }
        }
    }

    /// The handle.
    pub fn raw(&self) -> vk::Buffer {
        self.raw
    }

    /// The size that was asked for, in bytes.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// The contents; empty where the host cannot see the buffer, as with [`MemoryLocation::GpuOnly`]. Mapped memory is coherent: nothing to flush.
    ///
    /// Meaningful once the GPU's writes are finished and made visible: a barrier to `HOST`/`HOST_READ`, then a fence.
    pub fn bytes(&self) -> &[u8] {
        match self.block.mapped {
            // SAFETY: so much is mapped as long as the buffer lives, by the contract of `Memory`.
            Some(mapped) => unsafe {
                std::slice::from_raw_parts(mapped.as_ptr(), self.size as usize)
            },
            None => &[],
        }
    }

    /// The same, to be written.
    fn bytes_mut(&mut self) -> &mut [u8] {
        match self.block.mapped {
            // SAFETY: as above, and the buffer is borrowed mutably.
            Some(mapped) => unsafe {
                std::slice::from_raw_parts_mut(mapped.as_ptr(), self.size as usize)
            },
            None => &mut [],
        }
    }

    /// Copies `bytes` to `offset`. A submission after this call sees them (Vulkan, "Host Write Ordering Guarantees").
    ///
    /// # Errors
    /// [`Misuse::Outside`] where the host does not see so much of the buffer.
    pub fn write(&mut self, offset: u64, bytes: &[u8]) -> Result<()> {
        let seen = self.bytes_mut();
        let size = seen.len();
        let place = usize::try_from(offset).ok().and_then(|start| {
            let end = start.checked_add(bytes.len())?;
            seen.get_mut(start..end)
        });
        let place = place.ok_or(Error::Misuse(Misuse::Outside {
            bytes: bytes.len(),
            offset,
            size,
        }))?;
        place.copy_from_slice(bytes);
        Ok(())
    }

    /// Gives buffer and memory back.
    ///
    /// # Safety
    /// `device` and `memory` are those that made the buffer, and no submitted command still uses it.
    pub unsafe fn destroy(self, device: &ash::Device, memory: &mut dyn Memory) {
        // SAFETY: not in use, by this function's contract. The buffer goes before the memory it is bound to.
        unsafe { device.destroy_buffer(self.raw, None) };
        memory.free(self.block);
    }
}

/// # Safety
/// `raw` is an unbound buffer of the live `device`, whose memory is `memory`.
unsafe fn allocate_and_bind(
    device: &ash::Device,
    memory: &mut dyn Memory,
    name: &str,
    raw: vk::Buffer,
    location: MemoryLocation,
) -> Result<MemoryBlock> {
    let block = memory.allocate(&MemoryRequest {
        name,
        // SAFETY: `raw` is a buffer of `device`.
        requirements: unsafe { device.get_buffer_memory_requirements(raw) },
        location,
    })?;
    // SAFETY: size, alignment and memory type of the block are the buffer's own requirements, by the contract of `Memory`; `raw` is unbound.
    match unsafe { device.bind_buffer_memory(raw, block.memory, block.offset) } {
        Ok(()) => Ok(block),
        Err(code) => {
            memory.free(block);
            Err(failed("vkBindBufferMemory")(code))
        }
    }
}
