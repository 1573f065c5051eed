//! What a method made of a topology, on the device: shared by all instances, passes, views and frames.

use ash::vk;
use gpu_allocator::MemoryLocation;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Decides, Residence, SurfaceOptions};
use crate::gpu::bound::{Binding, Bound, Maker};
use crate::gpu::changes::{self, Edited};
use crate::gpu::kept_cache::KeptCache;
use crate::gpu::staging::{Handover, Staging, cmd_acquire, cmd_copy, cmd_copy_and_release};
use crate::gpu::{Layout, Memory, Retired};
use crate::method::{CachedPoints, Editable, Prepared, Table, Update, deciding_tables};

/// Where the bases of the next pass stand in their buffer: what uniform buffers have to be aligned to at most (Vulkan spec, "Required Limits",
/// `minUniformBufferOffsetAlignment`).
const BASES_STRIDE: u64 = 256;

/// What a method made of a topology, on the device. It borrows nothing; the owner calls [`Tables::destroy`].
///
/// Poses and frame slots are made for it; any number of them is drawn with the same tables.
#[derive(Debug)]
pub struct Tables {
    prepared: Prepared,
    /// What poses have in their caches, and up to which plan level; None where control points are not cached.
    cached: Option<(u32, CachedPoints)>,
    bound: Bound,
    staging: Staging,
    readers: vk::PipelineStageFlags,
    options: SurfaceOptions,
    /// None where nothing is edited.
    edited: Option<Edited>,
    /// None where no cache is edited.
    kept_cache: Option<KeptCache>,
}

impl Tables {
    /// Makes buffers and descriptor sets; of the options count where control points live, who decides, the backend and the greatest level. Record [`cmd_upload`](Self::cmd_upload) before anything is drawn.
    ///
    /// # Errors
    /// [`Misuse::BufferTooLarge`](crate::Misuse::BufferTooLarge) where shaders would not see all; Vulkan's own.
    ///
    /// # Safety
    /// `device` is live; `allocator` and `layout` were made for it. All commands go to queues of one family, but for [`cmd_upload_and_release`](Self::cmd_upload_and_release): the buffers are `EXCLUSIVE`.
    pub unsafe fn new(
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        prepared: Prepared,
        options: &SurfaceOptions,
    ) -> Result<Tables> {
        // SAFETY: this function's contract.
        unsafe { Tables::build(device, allocator, layout, prepared, options, None) }
    }

    /// The same of what can be edited, with room for what edits append: a quarter more.
    ///
    /// # Errors
    /// As [`Tables::new`].
    ///
    /// # Safety
    /// As [`Tables::new`].
    pub unsafe fn editable(
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        editable: &Editable,
        options: &SurfaceOptions,
    ) -> Result<Tables> {
        let (prepared, edited) = (editable.prepared().clone(), Some(Edited::default()));
        // SAFETY: this function's contract.
        unsafe { Tables::build(device, allocator, layout, prepared, options, edited) }
    }

    /// Brings the tables up to an edit; the next [`cmd_upload`](Self::cmd_upload) records the words that are other ones. Nothing waits: frames that were
    /// recorded before draw what was there, and those that are recorded behind it draw the edited surface. Poses and frame slots stay; draw lists are made
    /// anew, and so are commands that were recorded once to be submitted again and again.
    ///
    /// Where a table has outgrown its room everything is uploaded to larger buffers, and the ones before are [`Retired`].
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`] where tables, poses and slots have to be made anew ([`Update::is_whole`]), for tables that were not made by
    /// [`Tables::editable`], and for another update than the one that comes next; as [`Tables::new`] where there is no room. Nothing has changed then.
    ///
    /// # Safety
    /// As [`Tables::new`].
    pub unsafe fn edit(
        &mut self,
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        editable: &Editable,
        update: &Update,
    ) -> Result<Retired> {
        let prepared = editable.prepared();
        changes::check(&self.prepared, prepared, update)?;
        let edited = self.edited.as_mut();
        let edited = edited.ok_or(Error::Misuse(Misuse::OtherSurface))?;
        let points = self.cached.as_mut().map(|(_, points)| points);
        let cache = match self.kept_cache.as_mut().zip(points) {
            None => Some(Vec::new()),
            Some((kept, points)) => kept.edit(points, prepared, update),
        };
        let has_room =
            cache.is_some_and(|cache| edited.take(prepared, update, cache, self.options.decides));
        if has_room {
            self.prepared.adopt(prepared, update);
            return Ok(Retired::default());
        }
        // SAFETY: this function's contract.
        let larger =
            unsafe { Tables::editable(device, allocator, layout, editable, &self.options)? };
        let Tables { bound, staging, .. } = std::mem::replace(self, larger);
        Ok(Retired::of(bound, staging))
    }

    /// # Safety
    /// As [`Tables::new`].
    unsafe fn build(
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        prepared: Prepared,
        options: &SurfaceOptions,
        edited: Option<Edited>,
    ) -> Result<Tables> {
        let deepest = (options.residence == Residence::Cache).then(|| {
            let cuts = options.greatest_cuts().into_iter();
            let levels = cuts.map(|cut| options.backend.cut(cut).cached_level(&prepared));
            levels.max().unwrap_or(0)
        });
        let kept = deepest.filter(|_| edited.is_some());
        let kept = kept.and_then(|deepest| KeptCache::new(&prepared, deepest));
        let (points, kept_cache) = kept.unzip();
        let points_of = |deepest| match points {
            Some(points) => (deepest, points),
            None => (deepest, prepared.cached_points(deepest)),
        };
        let cached = deepest.map(points_of);
        let mut tables = Tables {
            prepared,
            cached,
            bound: Bound::default(),
            staging: Staging::default(),
            readers: layout.readers(),
            options: *options,
            edited,
            kept_cache,
        };
        let mut maker = Maker {
            device,
            allocator,
            layout,
        };
        // SAFETY: this function's contract.
        match unsafe { tables.make(&mut maker, options.decides) } {
            Ok(()) => Ok(tables),
            Err(error) => {
                // SAFETY: nothing of it has been recorded.
                unsafe { tables.destroy(device, allocator) };
                Err(error)
            }
        }
    }

    /// # Safety
    /// As [`Tables::new`].
    unsafe fn make(&mut self, maker: &mut Maker<'_>, decides: Decides) -> Result<()> {
        let Tables {
            prepared,
            cached,
            bound,
            staging,
            edited,
            ..
        } = self;
        let mut cached = cached.as_mut().map(|(_, cached)| cached.passes.iter_mut());
        let mut sets = Vec::new();
        let bases_bytes = BASES_STRIDE * prepared.passes.len() as u64;
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        // SAFETY: this function's contract, here and below.
        let [all_bases, rows, terms] = unsafe {
            let rows = bytemuck::cast_slice(&prepared.points.rows);
            let terms = bytemuck::cast_slice(&prepared.points.terms);
            let size = |bytes: &[u8]| bytes.len() as u64;
            let numbers = [
                bound.add(maker, "bases", bases_bytes, usage, MemoryLocation::GpuOnly)?,
                bound.add_target(maker, "rows of points", size(rows))?,
                bound.add_target(maker, "terms of points", size(terms))?,
            ];
            staging.add(numbers[1], rows);
            staging.add(numbers[2], terms);
            numbers
        };
        let mut bytes = vec![0; bases_bytes as usize];
        for (number, pass) in prepared.passes.iter().enumerate() {
            let offset = BASES_STRIDE * number as u64;
            // On the host nobody reads them again, but for those that are edited.
            let cached = cached.as_mut().and_then(Iterator::next);
            let others = cached.map(|cached| match edited {
                None => std::mem::take(&mut cached.tables),
                Some(_) => cached.tables.clone(),
            });
            let mut others = others.unwrap_or_default();
            if decides == Decides::Device {
                // Behind those of control points that are cached, be there any or not.
                others.resize(abi::CACHED_TABLES as usize, Table::default());
                let deciding = deciding_tables(prepared, number);
                if let Some(edited) = edited.as_mut() {
                    edited.deciding.push(deciding.clone());
                }
                others.extend(deciding);
            }
            let (words, bases) = match edited.as_mut() {
                None => pass.packed(&others),
                Some(edited) => {
                    let packed = pass.packed_with_room(&others);
                    edited.rooms.push(packed.rooms);
                    (packed.words, packed.bases)
                }
            };
            let words: &[u8] = bytemuck::cast_slice(&words);
            let bases = bytemuck::bytes_of(&bases);
            bytes[offset as usize..][..bases.len()].copy_from_slice(bases);
            // SAFETY: as above.
            let tables = unsafe { bound.add_target(maker, "tables", words.len() as u64)? };
            staging.add(tables, words);
            if let Some(edited) = edited.as_mut() {
                edited.buffers.push(tables);
            }
            sets.push(vec![
                Binding::storage(abi::BINDING_TABLES, tables),
                Binding::uniform(
                    abi::BINDING_BASES,
                    all_bases,
                    offset,
                    size_of::<abi::Bases>() as u64,
                ),
                Binding::storage(abi::BINDING_POINT_ROWS, rows),
                Binding::storage(abi::BINDING_POINT_TERMS, terms),
            ]);
        }
        staging.add(all_bases, &bytes);
        // SAFETY: as above.
        unsafe {
            bound.describe(maker.device, maker.layout.tables_set(), &sets)?;
            staging.fill(maker.device, maker.allocator)
        }
    }

    /// Records the copy to the device, before whatever draws next: the first time everything, after an [`edit`](Self::edit) what it changed, else nothing.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made these tables, outside of a render pass, and will be executed. They live until then, and
    /// [`finish_upload`](Self::finish_upload) is not called before.
    pub unsafe fn cmd_upload(&mut self, device: &ash::Device, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe { cmd_copy(device, cmd, &mut self.staging, &self.bound, self.readers) };
        if let Some(edited) = &mut self.edited {
            // SAFETY: as above.
            unsafe {
                let points = self.cached.as_ref().map(|(_, points)| points);
                let from = (&self.prepared, points);
                edited.cmd_write(device, cmd, &self.bound, from, self.readers);
            }
        }
    }

    /// The same on a queue that copies while others draw, but for edits, which [`cmd_upload`](Self::cmd_upload) brings on a queue that draws. Where it returns true, [`cmd_acquire`](Self::cmd_acquire) is recorded with the same
    /// families for a queue that draws, and executed after this by a semaphore, before anything is drawn there; otherwise nothing has changed.
    ///
    /// # Safety
    /// As [`cmd_upload`](Self::cmd_upload), but `cmd` is for a queue of the family `handover.from`, and no submitted command still uses these tables.
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
    /// `cmd` is recording on `device`, which made these tables, outside of a render pass, for a queue of the family `handover.to`, and is executed after
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

    /// Gives the memory back that the tables were staged in.
    ///
    /// # Safety
    /// `device` and `allocator` made these tables, and the upload has been executed.
    pub unsafe fn finish_upload(&mut self, device: &ash::Device, allocator: &mut dyn Memory) {
        if let Some(staging) = std::mem::take(&mut self.staging).into_buffer() {
            // SAFETY: this function's contract.
            unsafe { staging.destroy(device, allocator) };
        }
    }

    /// Whether they are edited.
    pub(super) fn is_editable(&self) -> bool {
        self.edited.is_some()
    }

    /// What was prepared.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// What poses have in their caches, and up to which plan level; None where control points are not cached.
    pub(super) fn cached(&self) -> Option<&(u32, CachedPoints)> {
        self.cached.as_ref()
    }

    /// What becomes of caches when the tables are edited; None where they are not, or where there is no cache.
    pub(super) fn kept_cache(&self) -> Option<&KeptCache> {
        self.kept_cache.as_ref()
    }

    /// What poses have in their caches, but for the tables that are on the device; None where control points are not cached.
    pub fn cached_points(&self) -> Option<&CachedPoints> {
        self.cached.as_ref().map(|(_, points)| points)
    }

    /// The bytes on the device, those aside that an upload is staged in.
    pub fn bytes(&self) -> u64 {
        self.bound.bytes()
    }

    /// The descriptor set of a pass, [`abi::SET_TABLES`].
    pub(super) fn set(&self, pass: usize) -> vk::DescriptorSet {
        self.bound.set(pass)
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
