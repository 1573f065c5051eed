//! Memory is the engine's: whoever gives it, what is drawn is the same, and all of it is given back.

use std::ptr::NonNull;

use ash::vk;
use gpu_allocator::MemoryLocation;
use hullform::gpu::{
    Backend, Fill, Memory, MemoryBlock, MemoryRequest, Residence, TessellatedSurface,
};
use hullform::method::METHODS;
use hullform::tessellation::Spacing;

use crate::common::gpu::{Gpu, bits, capturing, cut, prepare};
use crate::instances::grid;
use crate::shapes;

/// An allocation a buffer: the simplest that there is.
struct Own<'a> {
    gpu: &'a Gpu,
    given: usize,
    live: usize,
}

impl Own<'_> {
    fn kind(&self, request: &MemoryRequest<'_>) -> u32 {
        use vk::MemoryPropertyFlags as Flags;
        let wanted = match request.location {
            MemoryLocation::GpuOnly => Flags::empty(),
            _ => Flags::HOST_VISIBLE | Flags::HOST_COHERENT,
        };
        let physical = self.gpu.device.info().physical;
        let instance = self.gpu.device.instance().raw();
        // SAFETY: the physical device is this live instance's.
        let all = unsafe { instance.get_physical_device_memory_properties(physical) };
        let fits = |&kind: &u32| {
            let flags = all.memory_types[kind as usize].property_flags;
            request.requirements.memory_type_bits & 1 << kind != 0 && flags.contains(wanted)
        };
        let kind = (0..all.memory_type_count).find(fits);
        kind.expect("every device has memory for buffers")
    }
}

// SAFETY: each block is an allocation of its own, of the size and a type that are asked for, mapped as a whole where the host is to see it.
unsafe impl Memory for Own<'_> {
    fn allocate(&mut self, request: &MemoryRequest<'_>) -> hullform::Result<MemoryBlock> {
        let device = self.gpu.device.raw();
        let info = vk::MemoryAllocateInfo::default()
            .allocation_size(request.requirements.size)
            .memory_type_index(self.kind(request));
        // SAFETY: the device is live; what is mapped is as large as the allocation.
        let (memory, mapped) = unsafe {
            let memory = device.allocate_memory(&info, None).expect("it is small");
            let mapped = (request.location != MemoryLocation::GpuOnly).then(|| {
                let flags = vk::MemoryMapFlags::empty();
                let mapped = device.map_memory(memory, 0, vk::WHOLE_SIZE, flags);
                NonNull::new(mapped.expect("it is visible").cast()).expect("it is mapped")
            });
            (memory, mapped)
        };
        (self.given, self.live) = (self.given + 1, self.live + 1);
        Ok(MemoryBlock {
            memory,
            offset: 0,
            mapped,
            token: Box::new(()),
        })
    }

    fn free(&mut self, block: MemoryBlock) {
        self.live -= 1;
        // SAFETY: nothing is bound to it any more.
        unsafe { self.gpu.device.raw().free_memory(block.memory, None) };
    }
}

#[test]
fn an_engines_own_memory_will_do() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("ngons");
    let prepared = prepare(&model, METHODS[0].name);
    let at = cut(4.0, Spacing::Equal);
    let options = capturing(&prepared, &[at]);
    let workarounds = &gpu.device.info().workarounds;
    let (device, layout) = (gpu.device.raw(), gpu.layout());
    let mut own = Own {
        gpu: &gpu,
        given: 0,
        live: 0,
    };
    let (makers, compare) = (
        (Backend::Tessellator, Residence::Ring),
        vk::CompareOp::LESS_OR_EQUAL,
    );
    let pipelines = gpu.build(&prepared, makers, at.spacing, Fill::Discard, compare);
    // SAFETY: all of one live device, and every submission is waited for; recorded in the order that `cmd_draw` asks for.
    let captured = unsafe {
        let again = prepared.clone();
        let made = TessellatedSurface::new(
            device,
            &mut own,
            layout,
            &model,
            again,
            workarounds,
            options,
        );
        let mut surface = made.expect("the ring holds a patch");
        let list = surface.draw_list(at, None).expect("a cut");
        let drawn = gpu.device.submit(|cmd| {
            surface.cmd_upload(device, cmd);
            surface.cmd_prepare(device, cmd, &grid(1))?;
            gpu.target().begin(cmd, [0.0; 4]);
            for batch in list.batches() {
                surface.cmd_draw(device, cmd, layout, &pipelines, 0..1, batch)?;
            }
            gpu.target().end(cmd);
            surface.cmd_read_back(device, cmd);
            Ok(())
        });
        drawn.expect("it is executed");
        surface.finish_upload(device, &mut own);
        let captured = surface.captured().expect("it was read back");
        let captured: Vec<_> = captured.iter().map(bits).collect();
        surface.destroy(device, &mut own);
        captured
    };
    assert!(
        own.given > 10 && own.live == 0,
        "{} {}",
        own.given,
        own.live
    );
    let loaded = gpu.load(&model, prepared, workarounds, options);
    let mut loaded = loaded.expect("the ring holds a patch");
    let frame = loaded.capture(at, Fill::Discard).expect("it is drawn");
    let sorted = |mut vertices: Vec<[u32; 9]>| {
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    };
    let right = sorted(frame.passes.concat().iter().map(bits).collect());
    assert!(right.len() > 500);
    assert!(sorted(captured) == right);
    drop(loaded);
    gpu.finish();
}
