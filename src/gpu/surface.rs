//! A prepared model in buffers of the device.

use ash::vk;
use glam::Vec3;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocator;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Backend, Cut, DrawList, SurfaceOptions};
use crate::gpu::buffers::{Buffers, DRAWS, INSTANCES, Maker, NOT_READ_BACK};
use crate::gpu::features::BINDINGS;
use crate::gpu::patterns::Patterns;
use crate::gpu::staging::Staging;
use crate::gpu::workaround::{Workaround, instance_vertices};
use crate::gpu::{Enabled, Layout, failed};
use crate::mesh::Model;
use crate::method::{Controls, DepthTags, Prepared};

/// A prepared model in buffers of the device. It borrows nothing; the owner calls [`TessellatedSurface::destroy`].
#[derive(Debug)]
pub struct TessellatedSurface {
    pub(super) prepared: Prepared,
    pub(super) options: SurfaceOptions,
    /// Tessellated vertices an instance, where the driver bounds them.
    instance_vertices: Option<u32>,
    pub(super) buffers: Buffers,
    pub(super) patterns: Patterns,
    /// The number of the draw list whose decisions are on the device.
    written: Option<u64>,
    pub(super) sets: Vec<vk::DescriptorSet>,
    pool: vk::DescriptorPool,
}

impl TessellatedSurface {
    /// Makes the buffers and descriptor sets of a prepared model. Record [`cmd_upload`](Self::cmd_upload) before anything else.
    ///
    /// `model` has the mesh that `prepared` was made of, perhaps deformed.
    ///
    /// # Errors
    /// [`Misuse`] when the ring cannot hold a single patch at `greatest_level`, the options do not go together or the backend cannot draw what was
    /// prepared, that is of another mesh, or a buffer is larger than shaders can see; Vulkan's own.
    ///
    /// # Safety
    /// `device` is live; `allocator` and `layout` were made for it. All commands of this surface go to queues of one family: the buffers are `EXCLUSIVE`.
    pub unsafe fn new(
        device: &ash::Device,
        allocator: &mut Allocator,
        layout: &Layout,
        model: &Model,
        prepared: Prepared,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<TessellatedSurface> {
        let geometry = options.backend == Backend::Geometry;
        Enabled::require(geometry, layout.enabled().geometry_shader, "geometryShader")?;
        if !prepared.is_of(model) {
            return Err(Error::Misuse(Misuse::OtherMesh));
        }
        let instance_vertices = instance_vertices(workarounds);
        let counters = DrawList::ring_counters(&prepared, &options, instance_vertices)?;
        let mut surface = TessellatedSurface {
            prepared,
            options,
            instance_vertices,
            buffers: Buffers::default(),
            patterns: Patterns::default(),
            written: None,
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
            limit: u64::from(layout.enabled().max_storage_buffer_range),
        };
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let copied = vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST;
        let local = MemoryLocation::GpuOnly;
        let Controls { vertices, points } = self.prepared.controls(model.positions());
        let positions: Vec<[f32; 3]> = vertices.iter().map(|v| v.to_array()).collect();
        let capture =
            4 + u64::from(self.options.capture_vertices) * size_of::<abi::Captured>() as u64;
        let counters = 4 * (u64::from(abi::COUNTER_BATCHES) + counters);
        // SAFETY: this function's contract.
        unsafe {
            maker.buffers.positions =
                maker.pose("control vertices", bytemuck::cast_slice(&positions))?;
            let rules = &self.prepared.points;
            maker.buffers.points = maker.pose("points", bytemuck::cast_slice(&points))?;
            maker.buffers.point_rows =
                maker.table("rows of points", bytemuck::cast_slice(&rules.rows))?;
            maker.buffers.point_terms =
                maker.table("terms of points", bytemuck::cast_slice(&rules.terms))?;
            maker.buffers.ring =
                maker.buffer("scratch ring", self.options.ring_bytes, storage, local)?;
            maker.buffers.counters =
                maker.buffer("ring counters", counters, storage | copied, local)?;
            maker.buffers.counted = maker.buffer("counted", 8, copied, MemoryLocation::GpuToCpu)?;
            maker.buffers.capture = maker.buffer(
                "capture",
                capture,
                storage | copied,
                MemoryLocation::GpuToCpu,
            )?;
            for pass in &self.prepared.passes {
                if self.options.count_vertices {
                    let size = 4 + (size_of::<abi::Captured>() * pass.patches.len()) as u64;
                    let counted = storage | vk::BufferUsageFlags::TRANSFER_DST;
                    let host = MemoryLocation::GpuToCpu;
                    let counts = maker.buffer("counts", size, counted, host)?;
                    maker.buffers.counts.push(counts);
                }
                let tables = maker.pass(pass)?;
                maker.buffers.passes.push(tables);
            }
            maker.stage()?;
            // Until something is read back there are no counts, and nothing is captured.
            let Buffers {
                counted, capture, ..
            } = *maker.buffers;
            maker.buffers.all[counted].write(0, bytemuck::bytes_of(&NOT_READ_BACK))?;
            maker.buffers.all[capture].write(0, &[0; 4])?;
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

    /// How it uses the device.
    pub fn options(&self) -> SurfaceOptions {
        self.options
    }

    /// Decides what is drawn at a cut, with a depth for each control vertex if there are tags; see [`DrawList::new`].
    ///
    /// # Errors
    /// As there: a level that is none or above the greatest, tags that are none.
    pub fn draw_list(&self, cut: Cut, tags: Option<&DepthTags>) -> Result<DrawList> {
        let (prepared, vertices) = (&self.prepared, self.instance_vertices);
        DrawList::new(prepared, &self.options, vertices, cut, tags)
    }

    /// Whether a list may be drawn now.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`] and [`Misuse::NotWritten`].
    pub(super) fn check(&self, list: &DrawList) -> Result<()> {
        self.check_owner(list)?;
        if list.has_decisions() && self.written != Some(list.number()) {
            return Err(Error::Misuse(Misuse::NotWritten));
        }
        Ok(())
    }

    /// # Errors
    /// [`Misuse::OtherSurface`] for the list of another surface.
    pub(super) fn check_owner(&self, list: &DrawList) -> Result<()> {
        if list.is_for(&self.prepared, &self.options, self.instance_vertices) {
            return Ok(());
        }
        Err(Error::Misuse(Misuse::OtherSurface))
    }

    /// Replaces the control vertices, by positions in local units, and what is computed from them; they arrive with the next
    /// [`cmd_upload`](Self::cmd_upload), which then copies nothing else.
    ///
    /// The staging memory is written at once: no submitted [`cmd_upload`](Self::cmd_upload) may still read it. An engine that computes
    /// positions on the device writes the [`position_buffer`](Self::position_buffer) instead, and records
    /// [`cmd_points`](Self::cmd_points).
    ///
    /// # Errors
    /// [`Misuse::Count`] when the number of positions is not that of the model.
    pub fn write_positions(&mut self, positions: &[[f32; 3]]) -> Result<()> {
        self.prepared.check_count("positions", positions.len())?;
        let vertices: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
        let points = self.prepared.points.compute(&vertices);
        let Buffers {
            positions: first,
            points: second,
            ..
        } = self.buffers;
        let pose = &mut self.buffers.pose;
        pose.replace(first, bytemuck::cast_slice(positions))?;
        pose.replace(second, bytemuck::cast_slice(&points))
    }

    /// The control vertices on the device, three floats each, in local units: a storage buffer that is also a copy's target.
    ///
    /// Whoever writes it waits for earlier frames' vertex and control shaders, and makes the writes visible to `SHADER_READ` in the
    /// vertex, control and evaluation stages before the next draw.
    pub fn position_buffer(&self) -> vk::Buffer {
        self.buffers.all[self.buffers.positions].raw()
    }

    /// Brings to the device what the host decided about patches: slots in the ring, levels by depth tags, refinement patterns.
    ///
    /// Needed before a list is drawn that [has decisions](DrawList::has_decisions), whenever it is another than the last; harmless else.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`]; Vulkan's own, when there is no memory for more patterns.
    ///
    /// # Safety
    /// `device` and `allocator` made this surface, and no submitted command still uses it.
    pub unsafe fn write_draws(
        &mut self,
        device: &ash::Device,
        allocator: &mut Allocator,
        list: &DrawList,
    ) -> Result<()> {
        self.check_owner(list)?;
        if !list.has_decisions() {
            return Ok(());
        }
        self.written = None;
        for pass in 0..self.prepared.passes.len() {
            let tables = &self.buffers.passes[pass];
            let (draws, instances) = (tables[DRAWS], tables[INSTANCES]);
            self.buffers.all[draws].write(0, bytemuck::cast_slice(list.records(pass)))?;
            self.buffers.all[instances].write(0, bytemuck::cast_slice(list.instances(pass)))?;
        }
        if self.options.backend == Backend::Pattern {
            // SAFETY: this function's contract.
            unsafe { self.patterns.write(device, allocator, list.patterns())? };
        }
        self.written = Some(list.number());
        Ok(())
    }

    /// Destroys everything.
    ///
    /// # Safety
    /// `device` and `allocator` are those that made it, no submitted command still uses it, and no recorded one will be submitted.
    pub unsafe fn destroy(self, device: &ash::Device, allocator: &mut Allocator) {
        // SAFETY: this function's contract. The sets go with their pool; a null pool is fine.
        unsafe {
            device.destroy_descriptor_pool(self.pool, None);
            self.patterns.destroy(device, allocator);
        }
        let Buffers {
            all, tables, pose, ..
        } = self.buffers;
        let staging = [tables, pose].into_iter().filter_map(Staging::into_buffer);
        for buffer in all.into_iter().chain(staging) {
            // SAFETY: this function's contract.
            unsafe { buffer.destroy(device, allocator) };
        }
    }
}
