//! Positions, and what is computed from them: what an instance that deforms has of its own, and rigid instances share.

use std::collections::BTreeMap;

use ash::vk;
use glam::Vec3;
use gpu_allocator::MemoryLocation;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Decides, Residence, SurfaceOptions};
use crate::gpu::barrier::{MOST_UPDATED, cmd_make_visible};
use crate::gpu::bound::{Binding, Bound, Maker};
use crate::gpu::cached::Cache;
use crate::gpu::staging::{Handover, Staging, cmd_acquire, cmd_copy, cmd_copy_and_release};
use crate::gpu::{Layout, Memory, Retired, Tables};
use crate::mesh::{ChangeSet, Model};
use crate::method::{Controls, Prepared};

/// A control vertex: three floats.
const VERTEX_BYTES: usize = size_of::<[f32; 3]>();

/// So many vertices more than an eighth may be added before a pose is made anew.
const SPARE: usize = 64;

/// Vertices that follow one another, by the first.
fn runs(moved: BTreeMap<u32, [f32; 3]>) -> Vec<(u32, Vec<[f32; 3]>)> {
    let mut runs: Vec<(u32, Vec<[f32; 3]>)> = Vec::new();
    for (vertex, position) in moved {
        match runs.last_mut() {
            Some((first, run)) if *first + run.len() as u32 == vertex => run.push(position),
            _ => runs.push((vertex, vec![position])),
        }
    }
    runs
}

/// Control vertices and the points that are computed from them, on the device. It borrows nothing; the owner calls [`Pose::destroy`].
#[derive(Debug)]
pub struct Pose {
    /// The number of what was prepared.
    prepared: u64,
    bound: Bound,
    staging: Staging,
    positions: usize,
    points: usize,
    limits: usize,
    /// How many control vertices its buffer holds.
    room: usize,
    residence: Residence,
    decides: Decides,
    readers: vk::PipelineStageFlags,
    /// Vertices that were moved since the last upload.
    moved: BTreeMap<u32, [f32; 3]>,
    pub(super) cache: Option<Cache>,
}

impl Pose {
    /// Makes buffers and a descriptor set for control vertices in local units; of the options count where control points live and who decides.
    /// Record [`cmd_upload`](Self::cmd_upload) before anything is drawn.
    ///
    /// # Errors
    /// [`Misuse::Count`] when the number of positions is not that of the model; [`Misuse::NotCached`] for a cache where the tables were made without;
    /// [`Misuse::BufferTooLarge`]; Vulkan's own.
    ///
    /// # Safety
    /// `device` is live and made `tables`; `allocator` and `layout` were made for it. All commands go to queues of one family: the buffers are
    /// `EXCLUSIVE`.
    pub unsafe fn new(
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        tables: &Tables,
        positions: &[Vec3],
        options: &SurfaceOptions,
    ) -> Result<Pose> {
        let prepared = tables.prepared();
        prepared.check_count("positions", positions.len())?;
        let cached = options.residence == Residence::Cache;
        if cached && tables.cached().is_none() {
            return Err(Error::Misuse(Misuse::NotCached));
        }
        let mut pose = Pose {
            prepared: prepared.number(),
            bound: Bound::default(),
            staging: Staging::default(),
            positions: 0,
            points: 0,
            limits: 0,
            room: match tables.is_editable() {
                true => positions.len() + positions.len() / 8 + SPARE,
                false => positions.len(),
            },
            residence: options.residence,
            decides: options.decides,
            readers: layout.readers(),
            moved: BTreeMap::new(),
            cache: cached.then(|| Cache::new(tables)).flatten(),
        };
        let mut maker = Maker {
            device,
            allocator,
            layout,
        };
        // SAFETY: this function's contract.
        match unsafe { pose.make(&mut maker, prepared, positions) } {
            Ok(()) => Ok(pose),
            Err(error) => {
                // SAFETY: nothing of it has been recorded.
                unsafe { pose.destroy(device, allocator) };
                Err(error)
            }
        }
    }

    /// # Safety
    /// As [`Pose::new`].
    unsafe fn make(
        &mut self,
        maker: &mut Maker<'_>,
        prepared: &Prepared,
        positions: &[Vec3],
    ) -> Result<()> {
        let Controls { vertices, points } = prepared.controls(positions.to_vec());
        let mut vertices: Vec<[f32; 3]> = vertices.iter().map(|v| v.to_array()).collect();
        vertices.resize(self.room, [0.0; 3]);
        let vertices: &[u8] = bytemuck::cast_slice(&vertices);
        let points: &[u8] = bytemuck::cast_slice(&points);
        let bound = &mut self.bound;
        // SAFETY: this function's contract.
        unsafe {
            self.positions = bound.add_target(maker, "control vertices", vertices.len() as u64)?;
            let cached = self.cache.as_ref().map_or(0, Cache::bytes);
            let size = cached.max(points.len() as u64);
            self.points = bound.add_target(maker, "points", size)?;
            self.staging.add(self.positions, vertices);
            self.staging.add(self.points, points);
            // Sets have a buffer at each binding; one that nobody reads may be any.
            let limits = match self.decides {
                Decides::Host => self.positions,
                Decides::Device => {
                    let usage =
                        vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_SRC;
                    // And the boxes around them.
                    let boxes = 1 + self.room.div_ceil(abi::DECIDE_INVOCATIONS as usize);
                    let size = ((self.room + boxes) * size_of::<abi::Point>()) as u64;
                    bound.add(maker, "limits", size, usage, MemoryLocation::GpuOnly)?
                }
            };
            self.limits = limits;
            let set = vec![
                Binding::storage(abi::BINDING_POSITIONS, self.positions),
                Binding::storage(abi::BINDING_POINTS, self.points),
                Binding::storage(abi::BINDING_LIMITS, limits),
            ];
            bound.describe(maker.device, maker.layout.pose_set(), &[set])?;
            self.staging.fill(maker.device, maker.allocator)
        }
    }

    /// Records the copy of what has changed to the device, after what earlier commands of the queue still draw, and before whatever draws next.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this pose, outside of a render pass, and will be executed. The pose lives until then, and
    /// [`write_positions`](Self::write_positions) is not called before.
    pub unsafe fn cmd_upload(&mut self, device: &ash::Device, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe { cmd_copy(device, cmd, &mut self.staging, &self.bound, self.readers) };
        let moved = std::mem::take(&mut self.moved);
        if moved.is_empty() {
            return;
        }
        let transfer = vk::PipelineStageFlags::TRANSFER;
        let write = vk::AccessFlags::TRANSFER_WRITE;
        let buffer = self.position_buffer();
        // SAFETY: as above; vertices are the buffer's own.
        unsafe {
            cmd_make_visible(device, cmd, self.readers | transfer, transfer, write);
            for (first, positions) in runs(moved) {
                let parts = positions.chunks(MOST_UPDATED / VERTEX_BYTES);
                for (part, positions) in (0..).zip(parts) {
                    let vertex = first as usize + part * (MOST_UPDATED / VERTEX_BYTES);
                    let (offset, bytes) = (vertex * VERTEX_BYTES, bytemuck::cast_slice(positions));
                    device.cmd_update_buffer(cmd, buffer, offset as u64, bytes);
                }
            }
            let read = vk::AccessFlags::SHADER_READ;
            cmd_make_visible(device, cmd, transfer, self.readers, read);
        }
    }

    /// The same on a queue that copies while others draw. Where it returns true, [`cmd_acquire`](Self::cmd_acquire) is recorded with the same
    /// families for a queue that draws, and executed after this by a semaphore, before anything is drawn there; otherwise nothing has changed.
    ///
    /// # Safety
    /// As [`cmd_upload`](Self::cmd_upload), but `cmd` is for a queue of the family `handover.from`, and no submitted command still uses this pose.
    pub unsafe fn cmd_upload_and_release(
        &mut self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        handover: Handover,
    ) -> bool {
        // SAFETY: this function's contract.
        unsafe { cmd_copy_and_release(device, cmd, &mut self.staging, &self.bound, handover) }
    }

    /// Records that the queues that draw take over what has been uploaded.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this pose, outside of a render pass, for a queue of the family `handover.to`, and is executed after
    /// [`cmd_upload_and_release`](Self::cmd_upload_and_release).
    pub unsafe fn cmd_acquire(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        handover: Handover,
    ) {
        // SAFETY: this function's contract.
        unsafe { cmd_acquire(device, cmd, &self.bound, handover, self.readers) };
    }

    /// Replaces the control vertices, by positions in local units, and what is computed from them; they arrive with the next
    /// [`cmd_upload`](Self::cmd_upload).
    ///
    /// The staging memory is written at once: no submitted [`cmd_upload`](Self::cmd_upload) may still read it. An engine that computes
    /// positions on the device writes the [`position_buffer`](Self::position_buffer) instead, and records
    /// [`cmd_points`](Self::cmd_points).
    ///
    /// # Errors
    /// [`Misuse::Count`] when the number of positions is not that of the model; [`Misuse::OtherSurface`] for other tables.
    pub fn write_positions(&mut self, tables: &Tables, positions: &[[f32; 3]]) -> Result<()> {
        self.check(tables)?;
        let prepared = tables.prepared();
        prepared.check_count("positions", positions.len())?;
        self.positions_changed();
        self.moved.clear();
        let vertices: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
        let points = prepared.points.compute(&vertices);
        self.staging
            .replace(self.positions, bytemuck::cast_slice(positions))?;
        self.staging
            .replace(self.points, bytemuck::cast_slice(&points))
    }

    /// Moves single control vertices, to positions in local units ([`Model::position`](crate::mesh::Model::position)); they arrive with the next
    /// [`cmd_upload`](Self::cmd_upload), in the order of the queue: frames that were recorded before draw them where they were, and nobody waits for these.
    ///
    /// # Errors
    /// [`Misuse::Count`] for a vertex that there is not; [`Misuse::OtherSurface`] for other tables, and for those of methods that compute points
    /// beforehand: [`write_positions`](Self::write_positions) replaces all. Nothing has changed then.
    pub fn move_vertices(&mut self, tables: &Tables, moved: &[(u32, [f32; 3])]) -> Result<()> {
        self.check(tables)?;
        let prepared = tables.prepared();
        if prepared.points.count > 0 {
            return Err(Error::Misuse(Misuse::OtherSurface));
        }
        let greatest = moved.iter().map(|&(vertex, _)| vertex).max();
        if greatest.is_some_and(|vertex| vertex as usize >= prepared.vertex_count()) {
            let given = greatest.unwrap_or(0) as usize + 1;
            prepared.check_count("positions", given)?;
        }
        self.positions_changed();
        self.moved.extend(moved.iter().copied());
        Ok(())
    }

    /// Brings the control vertices up to an edit that the tables have been brought up to ([`Tables::edit`]): those that were moved or added, or all where the
    /// bounding box is another one. They arrive with the next [`cmd_upload`](Self::cmd_upload), in the order of the queue, as those of [`move_vertices`](Self::move_vertices).
    ///
    /// A pose of tables that are edited has room for an eighth more vertices and some; where there are more, or more cached points than there is room for, larger buffers are
    /// made, and the ones before are [`Retired`]. An engine that writes the [`position_buffer`](Self::position_buffer) itself writes another one then.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`] for other tables, those of methods that compute points beforehand, and those that are not of this model; as [`Pose::new`]. Nothing has changed
    /// then.
    ///
    /// # Safety
    /// As [`Pose::new`].
    pub unsafe fn edit(
        &mut self,
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        tables: &Tables,
        model: &Model,
        changes: &ChangeSet,
    ) -> Result<Retired> {
        let prepared = tables.prepared();
        let is_other = self.prepared != prepared.number() || !prepared.is_of(model);
        if is_other || prepared.points.count > 0 {
            return Err(Error::Misuse(Misuse::OtherSurface));
        }
        let cache_fits = self
            .cache
            .as_ref()
            .is_none_or(|cache| cache.has_room(tables));
        if prepared.vertex_count() > self.room || !cache_fits {
            let options = SurfaceOptions {
                residence: self.residence,
                decides: self.decides,
                ..SurfaceOptions::default()
            };
            let positions = model.positions();
            // SAFETY: this function's contract.
            let larger =
                unsafe { Pose::new(device, allocator, layout, tables, &positions, &options)? };
            let Pose { bound, staging, .. } = std::mem::replace(self, larger);
            return Ok(Retired::of(bound, staging));
        }
        if changes.is_placed_anew() || !changes.moved().is_empty() {
            self.positions_changed();
        }
        let place = |vertex: u32| (vertex, model.position(vertex).to_array());
        match changes.is_placed_anew() {
            true => self
                .moved
                .extend((0..prepared.vertex_count() as u32).map(place)),
            false => self
                .moved
                .extend(changes.moved().iter().copied().map(place)),
        }
        Ok(Retired::default())
    }

    /// The control vertices on the device, three floats each, in local units: a storage buffer that is also a copy's target.
    ///
    /// Whoever writes it waits for earlier frames' vertex and control shaders, and makes the writes visible to `SHADER_READ` in the
    /// vertex, control and evaluation stages before the next draw, or in the compute stage where control points are cached; and says so by
    /// [`positions_changed`](Self::positions_changed).
    pub fn position_buffer(&self) -> vk::Buffer {
        self.bound.buffer(self.positions).raw()
    }

    /// What levels went by where the device decided: an [`abi::Point`] a control vertex, its limit ([`Outline::limits`](crate::method::Outline::limits)), and its normal where levels went by
    /// curvature. For what an engine decides by itself, and for copies; None where the host decides.
    pub fn limit_buffer(&self) -> Option<vk::Buffer> {
        (self.decides == Decides::Device).then(|| self.bound.buffer(self.limits).raw())
    }

    /// # Errors
    /// [`Misuse::OtherSurface`] for tables that it was not made for; [`Misuse::Count`] where an edit has added more vertices than it has room for, and
    /// [`edit`](Self::edit) was left out.
    pub(super) fn check(&self, tables: &Tables) -> Result<()> {
        if self.prepared != tables.prepared().number() {
            return Err(Error::Misuse(Misuse::OtherSurface));
        }
        let (given, expected) = (self.room, tables.prepared().vertex_count());
        if given < expected {
            return Err(Error::Misuse(Misuse::Count {
                what: "control vertices of a pose",
                given,
                expected,
            }));
        }
        Ok(())
    }

    /// The bytes on the device, those aside that an upload is staged in.
    pub fn bytes(&self) -> u64 {
        self.bound.bytes()
    }

    /// The stages that read it.
    pub(super) fn readers(&self) -> vk::PipelineStageFlags {
        self.readers
    }

    /// Its descriptor set, [`abi::SET_POSE`].
    pub(super) fn set(&self) -> vk::DescriptorSet {
        self.bound.set(0)
    }

    /// Destroys everything.
    ///
    /// # Safety
    /// `device` and `allocator` are those that made it, no submitted command still uses it, and no recorded one will be submitted.
    pub unsafe fn destroy(self, device: &ash::Device, allocator: &mut dyn Memory) {
        // SAFETY: this function's contract.
        unsafe { Retired::of(self.bound, self.staging).destroy(device, allocator) };
    }
}
