//! Where memory comes from: the engine. gpu-allocator is the ready-made implementation.

use std::any::Any;
use std::cell::RefMut;
use std::fmt;
use std::ptr::NonNull;
use std::sync::MutexGuard;

use ash::vk;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme, Allocator};
use gpu_allocator::{AllocationError, MemoryLocation};

use crate::error::{Error, Result};
use crate::gpu::failed;

/// Memory that is asked for, for a buffer.
#[derive(Clone, Copy, Debug)]
pub struct MemoryRequest<'a> {
    /// What the memory is for, in words.
    pub name: &'a str,
    /// What the buffer needs.
    pub requirements: vk::MemoryRequirements,
    /// Who reads and writes it. Only [`MemoryLocation::GpuOnly`] need not be mapped.
    pub location: MemoryLocation,
}

/// A piece of memory, for one buffer.
pub struct MemoryBlock {
    /// The memory.
    pub memory: vk::DeviceMemory,
    /// Where in it the piece begins.
    pub offset: u64,
    /// Where the host sees the piece; None where it does not.
    pub mapped: Option<NonNull<u8>>,
    /// What whoever gave it needs to take it back.
    pub token: Box<dyn Any + Send + Sync>,
}

// SAFETY: the address is only used through the buffer that owns the piece, which lends bytes as it is borrowed itself.
unsafe impl Send for MemoryBlock {}
// SAFETY: as above.
unsafe impl Sync for MemoryBlock {}

impl fmt::Debug for MemoryBlock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MemoryBlock")
            .field("memory", &self.memory)
            .field("offset", &self.offset)
            .field("mapped", &self.mapped)
            .finish_non_exhaustive()
    }
}

/// What gives memory for buffers: gpu-allocator's [`Allocator`], also behind a `MutexGuard` or a `RefMut`, or an engine's own.
///
/// # Safety
/// A block has room for the request's size at an offset of its alignment, in memory of the device, of a type that the requirements allow, and
/// overlaps no other block that was not given back. Unless the location is [`MemoryLocation::GpuOnly`] it is mapped, to memory that is
/// `HOST_VISIBLE` and `HOST_COHERENT`, for that size and until it is given back.
pub unsafe trait Memory {
    /// A piece of memory.
    ///
    /// # Errors
    /// Vulkan's own, when there is none.
    fn allocate(&mut self, request: &MemoryRequest<'_>) -> Result<MemoryBlock>;

    /// Takes back what [`allocate`](Self::allocate) gave. Nothing is bound to it any more.
    fn free(&mut self, block: MemoryBlock);
}

// SAFETY: gpu-allocator goes by the requirements, and maps what is not the device's alone to coherent memory.
unsafe impl Memory for Allocator {
    fn allocate(&mut self, request: &MemoryRequest<'_>) -> Result<MemoryBlock> {
        let allocation = Allocator::allocate(
            self,
            &AllocationCreateDesc {
                name: request.name,
                requirements: request.requirements,
                location: request.location,
                linear: true,
                allocation_scheme: AllocationScheme::GpuAllocatorManaged,
            },
        );
        let allocation = allocation.map_err(out_of_memory)?;
        Ok(MemoryBlock {
            // SAFETY: the handle is used for binding only, and the memory lives until it is given back.
            memory: unsafe { allocation.memory() },
            offset: allocation.offset(),
            mapped: allocation.mapped_ptr().map(NonNull::cast),
            token: Box::new(allocation),
        })
    }

    fn free(&mut self, block: MemoryBlock) {
        let allocation = block.token.downcast::<Allocation>();
        let allocation = allocation.expect("memory goes back to the allocator it came from");
        free(self, *allocation);
    }
}

// SAFETY: as the allocator that is guarded.
unsafe impl Memory for MutexGuard<'_, Allocator> {
    fn allocate(&mut self, request: &MemoryRequest<'_>) -> Result<MemoryBlock> {
        Memory::allocate(&mut **self, request)
    }

    fn free(&mut self, block: MemoryBlock) {
        Memory::free(&mut **self, block);
    }
}

// SAFETY: as the allocator that is borrowed.
unsafe impl Memory for RefMut<'_, Allocator> {
    fn allocate(&mut self, request: &MemoryRequest<'_>) -> Result<MemoryBlock> {
        Memory::allocate(&mut **self, request)
    }

    fn free(&mut self, block: MemoryBlock) {
        Memory::free(&mut **self, block);
    }
}

/// Gives memory back to gpu-allocator.
pub(crate) fn free(allocator: &mut Allocator, allocation: Allocation) {
    allocator
        .free(allocation)
        .expect("memory goes back to the allocator it came from");
}

/// The allocator's failures as this crate's errors.
pub(crate) fn out_of_memory(error: AllocationError) -> Error {
    // Of most codes the allocator keeps the words alone.
    let named = |words: &str| {
        let codes = [
            vk::Result::ERROR_OUT_OF_HOST_MEMORY,
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY,
            vk::Result::ERROR_DEVICE_LOST,
            vk::Result::ERROR_MEMORY_MAP_FAILED,
        ];
        let is_meant =
            |code: &vk::Result| words == code.to_string() || words.ends_with(&format!("{code:?}"));
        codes.into_iter().find(is_meant)
    };
    let (call, code) = match &error {
        AllocationError::OutOfMemory => {
            let code = vk::Result::ERROR_OUT_OF_DEVICE_MEMORY;
            ("vkAllocateMemory", Some(code))
        }
        AllocationError::FailedToMap(words) => ("vkMapMemory", named(words)),
        AllocationError::Internal(words) => ("vkAllocateMemory", named(words)),
        _ => ("vkAllocateMemory", None),
    };
    code.map_or_else(
        || Error::Vulkan {
            call,
            result: error.to_string(),
        },
        failed(call),
    )
}
