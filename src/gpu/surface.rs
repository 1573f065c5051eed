//! A prepared model in buffers of the device.

use ash::vk;
use glam::Vec3;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocator;
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::{Error, Result};
use crate::gpu::backend::Backend;
use crate::gpu::batches::{Batch, Cut, batches};
use crate::gpu::layout::BINDINGS;
use crate::gpu::options::SurfaceOptions;
use crate::gpu::patterns::Patterns;
use crate::gpu::workaround::Workaround;
use crate::gpu::{Buffer, Layout, failed};
use crate::mesh::Model;
use crate::method::{Controls, DepthTags, Pass, Prepared};
use crate::tessellation::{
    Levels, Spacing, lattice_segments, lattice_vertices, levels_of_edges, pattern, triangulate,
};

/// A prepared model in buffers of the device. It borrows nothing; the owner calls [`TessellatedSurface::destroy`].
#[derive(Debug)]
pub struct TessellatedSurface {
    pub(super) prepared: Prepared,
    pub(super) options: SurfaceOptions,
    pub(super) workarounds: Vec<&'static Workaround>,
    pub(super) buffers: Buffers,
    pub(super) patterns: Patterns,
    /// By pass and patch, where depth tags are given; else empty.
    pub(super) tagged: Vec<Vec<Levels>>,
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
    /// A pass each, in the place of the capture; empty where nothing is counted.
    counts: Vec<usize>,
    /// A pass each: patches, controls, texture, draws, instances, the method's tables.
    passes: Vec<Vec<usize>>,
}

/// Where a pass's draws stand in [`Buffers::passes`].
const DRAWS: usize = 3;
/// Where a pass's instances stand.
const INSTANCES: usize = 4;

impl TessellatedSurface {
    /// Makes the buffers and descriptor sets of a prepared model. Record [`cmd_upload`](Self::cmd_upload) before anything else.
    ///
    /// # Errors
    /// [`Error::Option`](crate::Error::Option) when the ring cannot hold a single patch at `greatest_level`, or the backend cannot draw it;
    /// Vulkan's own.
    ///
    /// # Safety
    /// `device` is live and has the features that [`Support`](super::Support) asks for, with [`Backend::Geometry`] also `geometryShader`; `allocator` and `layout` were made for it. All
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
        options.backend.check(&prepared, options.greatest_level)?;
        if options.count_vertices && options.capture_vertices > 0 {
            return Err(Error::Option {
                option: "count_vertices",
                problem: "vertices are captured already".into(),
                remedy: "count them or capture them".into(),
            });
        }
        let counters = counter_count(&prepared, options)?;
        let mut surface = TessellatedSurface {
            prepared,
            options,
            workarounds: workarounds.to_vec(),
            buffers: Buffers::default(),
            patterns: Patterns::default(),
            tagged: Vec::new(),
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

    /// The batches that a cut needs: each within the ring, and within the capture if there is one.
    ///
    /// # Errors
    /// [`Error::Option`](crate::Error::Option) when the ring cannot hold a single patch, or the level is beyond the backend.
    pub fn batches(&self, cut: Cut) -> Result<Vec<Batch>> {
        self.options.backend.check(&self.prepared, cut.level)?;
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

    /// Writes what the host decides about each patch at a cut: its slot in the ring, with depth tags (a depth for each control vertex) its
    /// levels, and which refinement pattern it is drawn with. Tags lower levels; none is above that of the cut.
    ///
    /// Needed before drawing with [`Slots::Host`](super::Slots::Host), with [`Backend::Pattern`] or with tags, whenever cut, batches or tags
    /// change. Without tags all patches have the level of the cut again.
    ///
    /// # Errors
    /// Vulkan's own, when there is no memory for more patterns.
    ///
    /// # Panics
    /// When the number of tags is not that of control vertices.
    ///
    /// # Safety
    /// `device` and `allocator` made this surface, and no submitted command still uses it. `batches` are of this cut.
    pub unsafe fn write_draws(
        &mut self,
        device: &ash::Device,
        allocator: &mut Allocator,
        cut: Cut,
        tags: Option<&DepthTags>,
        batches: &[Batch],
    ) -> Result<()> {
        self.tagged = tags.map_or(Vec::new(), |tags| self.tagged_levels(cut, tags));
        self.patterns.clear();
        for batch in batches {
            let cut = self.options.backend.cut(cut);
            let pass = &self.prepared.passes[batch.pass];
            let mut next = 0;
            let draws: Vec<abi::PatchDraw> = (batch.first..batch.end)
                .map(|patch| {
                    let Levels { edges, inside, .. } = self.levels(cut, batch.pass, patch);
                    let slot = next;
                    next += cut.points(pass, patch as usize);
                    abi::PatchDraw {
                        slot,
                        edges,
                        inside,
                    }
                })
                .collect();
            self.write_records(batch, DRAWS, &draws);
            if self.options.backend == Backend::Pattern {
                let mut patterns = std::mem::take(&mut self.patterns);
                let instances =
                    patterns.arrange(batch, |patch| self.levels(cut, batch.pass, patch));
                self.patterns = patterns;
                self.write_records(batch, INSTANCES, &instances);
            }
        }
        if self.options.backend != Backend::Pattern {
            return Ok(());
        }
        // SAFETY: this function's contract.
        unsafe { self.patterns.write(device, allocator) }
    }

    /// Writes a record a patch of a batch.
    fn write_records<T: bytemuck::Pod>(&mut self, batch: &Batch, table: usize, records: &[T]) {
        let buffer = self.buffers.passes[batch.pass][table];
        let offset = u64::from(batch.first) * size_of::<T>() as u64;
        self.buffers.all[buffer].write(offset, bytemuck::cast_slice(records));
    }

    /// The levels of a patch as it was last [written](Self::write_draws), or else at a cut.
    pub fn levels(&self, cut: Cut, pass: usize, patch: u32) -> Levels {
        match self.tagged.get(pass) {
            Some(levels) => levels[patch as usize],
            None => {
                let cut = self.options.backend.cut(cut);
                cut.levels(&self.prepared.passes[pass], patch as usize)
            }
        }
    }

    /// The vertices of a patch as it was last [written](Self::write_draws), or else at a cut.
    pub fn vertices(&self, cut: Cut, pass: usize, patch: u32) -> u32 {
        let levels = self.levels(cut, pass, patch);
        match self.options.backend {
            Backend::Tessellator => levels.vertices(cut.spacing),
            Backend::Pattern | Backend::Geometry => lattice_vertices(&levels),
        }
    }

    /// The triangles of a patch as it was last [written](Self::write_draws), or else at a cut: counter-clockwise in (u, v), as numbers of its
    /// vertices `uv`, which may come in any order. Vertices that are not among them have no triangles.
    pub fn triangles(&self, cut: Cut, pass: usize, patch: u32, uv: &[[f32; 2]]) -> Vec<[u32; 3]> {
        let levels = self.levels(cut, pass, patch);
        if self.options.backend == Backend::Tessellator {
            return triangulate(levels.domain, uv);
        }
        let segments = lattice_segments(&levels) as f32;
        let place = |at: &[f32; 2]| at.map(|x| (x * segments) as u32);
        let numbers: FxHashMap<[u32; 2], u32> = uv.iter().map(place).zip(0..).collect();
        let numbered = |places: [[u32; 2]; 3]| {
            let [a, b, c] = places.map(|place| numbers.get(&place).copied());
            Some([a?, b?, c?])
        };
        pattern(&levels).into_iter().filter_map(numbered).collect()
    }

    /// The levels that depth tags give to all patches.
    fn tagged_levels(&self, cut: Cut, tags: &DepthTags) -> Vec<Vec<Levels>> {
        let backend = self.options.backend;
        let cut = backend.cut(cut);
        let sides: Vec<f32> = self.prepared.outline.depths(tags);
        let level = |side: u32| backend.level_of(sides[side as usize]).min(cut.level);
        let of_pass = |pass: &Pass| {
            let patches = pass.patches.iter().zip(&pass.sides);
            patches
                .map(|(patch, sides)| {
                    let edges = sides.map(level);
                    levels_of_edges(pass.domain, patch, edges, cut.spacing, pass.max_level)
                })
                .collect()
        };
        self.prepared.passes.iter().map(of_pass).collect()
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

    pub(super) fn counters(&self) -> &Buffer {
        &self.all[self.counters]
    }

    pub(super) fn counted(&self) -> &Buffer {
        &self.all[self.counted]
    }

    pub(super) fn capture(&self) -> &Buffer {
        &self.all[self.capture]
    }

    /// What counts the vertices of each pass; none where they are not counted.
    pub(super) fn counts(&self) -> impl Iterator<Item = &Buffer> {
        self.counts.iter().map(|&number| &self.all[number])
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
