//! A prepared model in buffers of the device.

use ash::vk;
use glam::Vec3;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocator;

use crate::abi;
use crate::error::Result;
use crate::gpu::batches::{Batch, Cut, batches};
use crate::gpu::layout::BINDINGS;
use crate::gpu::options::SurfaceOptions;
use crate::gpu::workaround::Workaround;
use crate::gpu::{Buffer, Layout, failed};
use crate::mesh::Model;
use crate::method::{Controls, Pass, Prepared};
use crate::tessellation::Spacing;

/// A prepared model in buffers of the device. It borrows nothing; the owner calls [`TessellatedSurface::destroy`].
#[derive(Debug)]
pub struct TessellatedSurface {
    pub(super) prepared: Prepared,
    pub(super) options: SurfaceOptions,
    pub(super) workarounds: Vec<&'static Workaround>,
    pub(super) buffers: Buffers,
    pub(super) sets: Vec<vk::DescriptorSet>,
    pool: vk::DescriptorPool,
}

/// Every buffer, and what is to be copied where once.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    all: Vec<Buffer>,
    staged: Vec<u8>,
    copies: Vec<(usize, vk::BufferCopy)>,
    staging: Option<usize>,
    positions: usize,
    points: usize,
    point_rows: usize,
    point_terms: usize,
    ring: usize,
    counters: usize,
    counted: usize,
    capture: usize,
    /// A pass each: patches, controls, texture, slots, the method's tables.
    passes: Vec<Vec<usize>>,
}

/// Where a pass's slots stand in [`Buffers::passes`].
const SLOTS: usize = 3;

impl TessellatedSurface {
    /// Makes the buffers and descriptor sets of a prepared model. Record [`cmd_upload`](Self::cmd_upload) before anything else.
    ///
    /// # Errors
    /// [`Error::Option`](crate::Error::Option) when the ring cannot hold a single patch at `greatest_level`; Vulkan's own.
    ///
    /// # Safety
    /// `device` is live and has the features that [`Support`](super::Support) asks for; `allocator` and `layout` were made for it. All
    /// commands of this surface go to queues of one family: the buffers are `EXCLUSIVE`.
    pub unsafe fn new(
        device: &ash::Device,
        allocator: &mut Allocator,
        layout: &Layout,
        model: &Model,
        prepared: Prepared,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<TessellatedSurface> {
        let counters = counter_count(&prepared, options)?;
        let mut surface = TessellatedSurface {
            prepared,
            options,
            workarounds: workarounds.to_vec(),
            buffers: Buffers::default(),
            sets: Vec::new(),
            pool: vk::DescriptorPool::null(),
        };
        // SAFETY: this function's contract.
        let made = unsafe { surface.make(device, allocator, layout, model, counters) };
        match made {
            Ok(()) => Ok(surface),
            Err(error) => {
                // SAFETY: nothing of it has been recorded.
                unsafe { surface.destroy(device, allocator) };
                Err(error)
            }
        }
    }

    /// # Safety
    /// As [`TessellatedSurface::new`].
    unsafe fn make(
        &mut self,
        device: &ash::Device,
        allocator: &mut Allocator,
        layout: &Layout,
        model: &Model,
        counters: u64,
    ) -> Result<()> {
        let mut maker = Maker {
            device,
            allocator,
            buffers: &mut self.buffers,
        };
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let copied = vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST;
        let local = MemoryLocation::GpuOnly;
        let Controls { vertices, points } = self.prepared.controls(model.positions());
        let positions: Vec<[f32; 3]> = vertices.iter().map(|v| v.to_array()).collect();
        let capture =
            4 + u64::from(self.options.capture_vertices) * size_of::<abi::Captured>() as u64;
        // SAFETY: this function's contract.
        unsafe {
            maker.buffers.positions =
                maker.table("control vertices", bytemuck::cast_slice(&positions))?;
            let rules = &self.prepared.points;
            maker.buffers.points = maker.table("points", bytemuck::cast_slice(&points))?;
            maker.buffers.point_rows =
                maker.table("rows of points", bytemuck::cast_slice(&rules.rows))?;
            maker.buffers.point_terms =
                maker.table("terms of points", bytemuck::cast_slice(&rules.terms))?;
            maker.buffers.ring =
                maker.buffer("scratch ring", self.options.ring_bytes, storage, local)?;
            maker.buffers.counters =
                maker.buffer("ring counters", 4 * counters, storage | copied, local)?;
            maker.buffers.counted = maker.buffer("counted", 8, copied, MemoryLocation::GpuToCpu)?;
            maker.buffers.capture = maker.buffer(
                "capture",
                capture,
                storage | copied,
                MemoryLocation::GpuToCpu,
            )?;
            for pass in &self.prepared.passes {
                let tables = maker.pass(pass)?;
                maker.buffers.passes.push(tables);
            }
            maker.stage()?;
            self.describe(device, layout)
        }
    }

    /// Makes one descriptor set a pass.
    ///
    /// # Safety
    /// `device` and `layout` are those of this surface.
    unsafe fn describe(&mut self, device: &ash::Device, layout: &Layout) -> Result<()> {
        let count = self.prepared.passes.len() as u32;
        let sizes = [vk::DescriptorPoolSize::default()
            .ty(vk::DescriptorType::STORAGE_BUFFER)
            .descriptor_count((count * BINDINGS).max(1))];
        let info = vk::DescriptorPoolCreateInfo::default()
            .max_sets(count.max(1))
            .pool_sizes(&sizes);
        // SAFETY: the device is live.
        self.pool = unsafe { device.create_descriptor_pool(&info, None) }
            .map_err(failed("vkCreateDescriptorPool"))?;
        let layouts = vec![layout.set(); count as usize];
        if layouts.is_empty() {
            return Ok(());
        }
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool was made for as many sets of this layout.
        self.sets = unsafe { device.allocate_descriptor_sets(&info) }
            .map_err(failed("vkAllocateDescriptorSets"))?;
        for (pass, &set) in self.sets.iter().enumerate() {
            let buffers: Vec<[vk::DescriptorBufferInfo; 1]> = (0..BINDINGS)
                .map(|binding| {
                    let buffer = self.buffers.bound(pass, binding).raw();
                    [vk::DescriptorBufferInfo::default()
                        .buffer(buffer)
                        .range(vk::WHOLE_SIZE)]
                })
                .collect();
            let writes: Vec<vk::WriteDescriptorSet> = (0u32..)
                .zip(&buffers)
                .map(|(binding, buffer)| {
                    vk::WriteDescriptorSet::default()
                        .dst_set(set)
                        .dst_binding(binding)
                        .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                        .buffer_info(buffer)
                })
                .collect();
            // SAFETY: sets and buffers are of this device and in no use yet.
            unsafe { device.update_descriptor_sets(&writes, &[]) };
        }
        Ok(())
    }

    /// What was prepared.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// The batches that a cut needs: each within the ring, and within the capture if there is one.
    ///
    /// # Errors
    /// [`Error::Option`](crate::Error::Option) when the ring cannot hold a single patch.
    pub fn batches(&self, cut: Cut) -> Result<Vec<Batch>> {
        batches(&self.prepared, cut, self.options.bounds())
    }

    /// The batch for the next round: drawn in the same frame once more, for lines over a surface or a second view.
    pub fn again(&self, batch: &Batch) -> Batch {
        let counters = self.buffers.counters().size() / 4 - u64::from(abi::COUNTER_BATCHES);
        let round = (counters / u64::from(self.options.rounds)) as u32;
        Batch {
            ring_batch: batch.ring_batch + round,
            ..*batch
        }
    }

    /// Replaces the control vertices, by positions relative to the model's centre, and what is computed from them; they arrive with the next
    /// [`cmd_upload`](Self::cmd_upload).
    ///
    /// The staging memory is written at once: no submitted [`cmd_upload`](Self::cmd_upload) may still read it. An engine that computes
    /// positions on the device writes the [`position_buffer`](Self::position_buffer) instead, and records
    /// [`cmd_points`](Self::cmd_points).
    ///
    /// # Panics
    /// When the number of positions is not that of the model, or after [`finish_upload`](Self::finish_upload).
    pub fn write_positions(&mut self, positions: &[[f32; 3]]) {
        let vertices: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
        let points = self.prepared.points.compute(&vertices);
        self.write_staged(self.buffers.positions, bytemuck::cast_slice(positions));
        self.write_staged(self.buffers.points, bytemuck::cast_slice(&points));
    }

    /// Writes what will be copied to a buffer.
    fn write_staged(&mut self, buffer: usize, bytes: &[u8]) {
        let mut copies = self.buffers.copies.iter();
        let copy = copies.find(|(number, _)| *number == buffer);
        let copy = copy.expect("every table is copied").1;
        assert_eq!(
            bytes.len() as u64,
            copy.size,
            "one position a control vertex"
        );
        let staging = self.buffers.staging;
        let staging = staging.expect("positions are staged before the upload is finished");
        self.buffers.all[staging].write(copy.src_offset, bytes);
    }

    /// The control vertices on the device, three floats each, relative to the model's centre: a storage buffer that is also a copy's target.
    ///
    /// Whoever writes it waits for earlier frames' vertex and control shaders, and makes the writes visible to `SHADER_READ` in the
    /// vertex, control and evaluation stages before the next draw.
    pub fn position_buffer(&self) -> vk::Buffer {
        self.buffers.all[self.buffers.positions].raw()
    }

    /// Writes the slots that the host gives at a cut.
    ///
    /// Needed before drawing with [`Slots::Host`](super::Slots::Host), whenever cut or batches change. No submitted command may still use this surface.
    pub fn write_slots(&mut self, cut: Cut, batches: &[Batch]) {
        for batch in batches {
            let pass = &self.prepared.passes[batch.pass];
            let mut next = 0;
            let slots: Vec<u32> = (batch.first..batch.end)
                .map(|patch| {
                    let slot = next;
                    next += cut.points(pass, patch as usize);
                    slot
                })
                .collect();
            let buffer = self.buffers.passes[batch.pass][SLOTS];
            self.buffers.all[buffer]
                .write(4 * u64::from(batch.first), bytemuck::cast_slice(&slots));
        }
    }

    /// Destroys everything.
    ///
    /// # Safety
    /// `device` and `allocator` are those that made it, no submitted command still uses it, and no recorded one will be submitted.
    pub unsafe fn destroy(self, device: &ash::Device, allocator: &mut Allocator) {
        // SAFETY: this function's contract. The sets go with their pool; a null pool is fine.
        unsafe { device.destroy_descriptor_pool(self.pool, None) };
        for buffer in self.buffers.all {
            // SAFETY: this function's contract.
            unsafe { buffer.destroy(device, allocator) };
        }
    }
}

impl Buffers {
    /// What pass `pass` has at a binding. Bindings that it does not use get its patches: something must be bound.
    fn bound(&self, pass: usize, binding: u32) -> &Buffer {
        let tables = &self.passes[pass];
        let number = match binding {
            abi::BINDING_POSITIONS => self.positions,
            abi::BINDING_PATCHES => tables[0],
            abi::BINDING_CONTROLS => tables[1],
            abi::BINDING_TEXTURE => tables[2],
            abi::BINDING_SCRATCH => self.ring,
            abi::BINDING_COUNTERS => self.counters,
            abi::BINDING_SLOTS => tables[SLOTS],
            abi::BINDING_CAPTURE => self.capture,
            abi::BINDING_POINTS => self.points,
            abi::BINDING_POINT_ROWS => self.point_rows,
            abi::BINDING_POINT_TERMS => self.point_terms,
            table => *tables
                .get((table - abi::BINDING_TABLES) as usize + SLOTS + 1)
                .unwrap_or(&tables[0]),
        };
        &self.all[number]
    }

    pub(super) fn counters(&self) -> &Buffer {
        &self.all[self.counters]
    }

    pub(super) fn counted(&self) -> &Buffer {
        &self.all[self.counted]
    }

    pub(super) fn capture(&self) -> &Buffer {
        &self.all[self.capture]
    }

    /// What is to be copied from the staging buffer, and where to.
    pub(super) fn uploads(
        &self,
    ) -> Option<(
        vk::Buffer,
        impl Iterator<Item = (vk::Buffer, vk::BufferCopy)> + '_,
    )> {
        let copies = self.copies.iter().filter(|(_, copy)| copy.size > 0);
        let copies = copies.map(|&(number, copy)| (self.all[number].raw(), copy));
        self.staging
            .map(|staging| (self.all[staging].raw(), copies))
    }

    /// Takes the staging buffer out. It is the last one made, so no number changes.
    pub(super) fn take_staging(&mut self) -> Option<Buffer> {
        self.staging.take().and_then(|_| self.all.pop())
    }
}

/// Makes buffers and gathers what goes into them.
struct Maker<'a> {
    device: &'a ash::Device,
    allocator: &'a mut Allocator,
    buffers: &'a mut Buffers,
}

impl Maker<'_> {
    /// # Safety
    /// The device is live and the allocator its own.
    unsafe fn buffer(
        &mut self,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<usize> {
        // SAFETY: this function's contract.
        let buffer =
            unsafe { Buffer::new(self.device, self.allocator, name, size, usage, location)? };
        self.buffers.all.push(buffer);
        Ok(self.buffers.all.len() - 1)
    }

    /// A buffer on the device that will hold `bytes`.
    ///
    /// # Safety
    /// As [`Maker::buffer`].
    unsafe fn table(&mut self, name: &str, bytes: &[u8]) -> Result<usize> {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        // SAFETY: this function's contract.
        let number =
            unsafe { self.buffer(name, bytes.len() as u64, usage, MemoryLocation::GpuOnly)? };
        let copy = vk::BufferCopy::default()
            .src_offset(self.buffers.staged.len() as u64)
            .size(bytes.len() as u64);
        self.buffers.copies.push((number, copy));
        self.buffers.staged.extend_from_slice(bytes);
        Ok(number)
    }

    /// # Safety
    /// As [`Maker::buffer`].
    unsafe fn pass(&mut self, pass: &Pass) -> Result<Vec<usize>> {
        let slots = 4 * pass.patches.len() as u64;
        // SAFETY: this function's contract.
        unsafe {
            let mut tables = vec![
                self.table("patches", bytemuck::cast_slice(&pass.patches))?,
                self.table("controls", bytemuck::cast_slice(&pass.controls))?,
                self.table("texture coordinates", bytemuck::cast_slice(&pass.texture))?,
                self.buffer(
                    "slots",
                    slots,
                    vk::BufferUsageFlags::STORAGE_BUFFER,
                    MemoryLocation::CpuToGpu,
                )?,
            ];
            for table in &pass.tables {
                tables.push(self.table("method's table", bytemuck::cast_slice(table))?);
            }
            Ok(tables)
        }
    }

    /// Fills the staging buffer.
    ///
    /// # Safety
    /// As [`Maker::buffer`].
    unsafe fn stage(&mut self) -> Result<()> {
        let bytes = std::mem::take(&mut self.buffers.staged);
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        // SAFETY: this function's contract.
        let staging = unsafe {
            self.buffer(
                "staging",
                bytes.len() as u64,
                usage,
                MemoryLocation::CpuToGpu,
            )?
        };
        self.buffers.all[staging].write(0, &bytes);
        self.buffers.staging = Some(staging);
        Ok(())
    }
}

/// The counters that any level needs: two of the whole, and one a batch.
fn counter_count(prepared: &Prepared, options: SurfaceOptions) -> Result<u64> {
    let mut most = 0;
    for spacing in [Spacing::Equal, Spacing::FractionalEven] {
        let cut = Cut {
            level: options.greatest_level,
            spacing,
        };
        most = most.max(batches(prepared, cut, options.bounds())?.len());
    }
    Ok(u64::from(abi::COUNTER_BATCHES) + most as u64 * u64::from(options.rounds))
}
