//! What the host and the device write anew each frame: draw records, views, the scratch ring, counters, captured vertices. One a frame in flight.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

use ash::vk;
use gpu_allocator::MemoryLocation;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Batch, Cut, Decides, DrawList, Residence, SurfaceOptions};
use crate::gpu::barrier::{MOST_UPDATED, cmd_make_visible};
use crate::gpu::bound::{Binding, Bound, Maker};
use crate::gpu::lists::Lists;
use crate::gpu::patterns::Patterns;
use crate::gpu::pipeline::control_points;
use crate::gpu::ring::RING_ACCESS;
use crate::gpu::view::View;
use crate::gpu::workaround::{Workaround, instance_vertices};
use crate::gpu::{Buffer, Enabled, Layout, Memory, Tables};
use crate::method::{DepthTags, Pass, Prepared};

/// What stands in place of counts that no device has written: more overflows than there are patches.
const NOT_READ_BACK: [u32; 2] = [u32::MAX; 2];

/// What the control shaders counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Patches that found no room in the ring and were left out: the picture is not whole, draw again with [`Slots::Host`](super::Slots::Host).
    pub overflows: u32,
    /// Points computed.
    pub points: u32,
}

/// Batches that edits may make more than there are at first.
const SPARE_BATCHES: u32 = 32;

/// The numbers of a slot's buffers.
#[derive(Debug, Default)]
struct Numbers {
    ring: usize,
    counters: usize,
    counted: usize,
    capture: usize,
    views: usize,
    /// A pass each, in the place of the capture; empty where nothing is counted.
    counts: Vec<usize>,
    /// A pass each: draws, instances.
    decisions: Vec<[usize; 2]>,
    /// A pass each, where the device decides.
    lists: Vec<Lists>,
}

/// What one frame writes about one surface, by the host before and by the device while it is drawn. It borrows nothing; the owner calls
/// [`FrameSlot::destroy`].
///
/// Where frames overlap on the device each has a slot of its own: what is written to one never waits for another.
#[derive(Debug)]
pub struct FrameSlot {
    /// The number of what was prepared.
    prepared: u64,
    options: SurfaceOptions,
    /// Tessellated vertices an instance, where the driver bounds them.
    instance_vertices: Option<u32>,
    /// Batches that use the ring, in all rounds, that there are counters for.
    counters: u64,
    bound: Bound,
    numbers: Numbers,
    patterns: Patterns,
    /// The number of the draw list whose decisions are on the device.
    written: Option<u64>,
    /// The views that `cmd_prepare` was given last.
    pub(super) views: AtomicU32,
    /// At which cut the device has decided since then, and the view behind the last.
    pub(super) decided: Mutex<Option<(Cut, u32)>>,
}

impl FrameSlot {
    /// Makes buffers and descriptor sets.
    ///
    /// # Errors
    /// [`Misuse`] when the ring cannot hold a single patch at `greatest_level`, the options do not go together, the backend cannot draw what was
    /// prepared, or a buffer is larger than shaders can see; Vulkan's own.
    ///
    /// # Safety
    /// `device` is live and made `tables`; `allocator` and `layout` were made for it. All commands go to queues of one family: the buffers are
    /// `EXCLUSIVE`.
    pub unsafe fn new(
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        tables: &Tables,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<FrameSlot> {
        let geometry = options.backend.on_device().geometry_shader;
        Enabled::require(geometry, layout.enabled().geometry_shader, "geometryShader")?;
        let prepared = tables.prepared();
        let instance_vertices = instance_vertices(workarounds);
        // Edits may make some more.
        let spare = u64::from(SPARE_BATCHES * options.rounds);
        let counters = spare + DrawList::ring_counters(prepared, &options, instance_vertices)?;
        let mut slot = FrameSlot {
            prepared: prepared.number(),
            options,
            instance_vertices,
            counters,
            bound: Bound::default(),
            numbers: Numbers::default(),
            patterns: Patterns::default(),
            written: None,
            views: AtomicU32::new(0),
            decided: Mutex::new(None),
        };
        let mut maker = Maker {
            device,
            allocator,
            layout,
        };
        // SAFETY: this function's contract.
        match unsafe { slot.make(&mut maker, prepared, counters) } {
            Ok(()) => Ok(slot),
            Err(error) => {
                // SAFETY: nothing of it has been recorded.
                unsafe { slot.destroy(device, allocator) };
                Err(error)
            }
        }
    }

    /// # Safety
    /// As [`FrameSlot::new`].
    unsafe fn make(
        &mut self,
        maker: &mut Maker<'_>,
        prepared: &Prepared,
        counters: u64,
    ) -> Result<()> {
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let target = vk::BufferUsageFlags::TRANSFER_DST;
        let copied = vk::BufferUsageFlags::TRANSFER_SRC | target;
        let (local, host) = (MemoryLocation::GpuOnly, MemoryLocation::GpuToCpu);
        let captured =
            4 + u64::from(self.options.capture_vertices) * size_of::<abi::Captured>() as u64;
        let counters = 4 * (u64::from(abi::COUNTER_BATCHES) + counters);
        let views = u64::from(self.options.views) * size_of::<abi::View>() as u64;
        self.numbers.lists = Lists::of_passes(prepared, &self.options, self.instance_vertices)?;
        let (bound, numbers) = (&mut self.bound, &mut self.numbers);
        let ring_bytes = match self.options.residence {
            Residence::Ring => self.options.ring_bytes,
            Residence::Cache => 0,
        };
        // SAFETY: this function's contract, here and below.
        unsafe {
            numbers.ring = bound.add(maker, "scratch ring", ring_bytes, storage, local)?;
            numbers.counters =
                bound.add(maker, "ring counters", counters, storage | copied, local)?;
            numbers.counted = bound.add(maker, "counted", 8, copied, host)?;
            numbers.capture = bound.add(maker, "capture", captured, storage | copied, host)?;
            numbers.views = bound.add(maker, "views", views, storage | target, local)?;
        }
        let mut sets = Vec::new();
        for pass in &prepared.passes {
            let patches = pass.patches.len() as u64;
            let views = match self.options.decides {
                Decides::Host => 1,
                Decides::Device => u64::from(self.options.views),
            };
            let draws = size_of::<abi::PatchDraw>() as u64 * patches * views;
            let draws = draws.max(self.options.sub_patch_bytes(pass));
            let lists = numbers.lists.get(sets.len());
            let (lists, seen) = lists.map_or((0, storage), |own| own.room(views));
            let draws = draws + lists;
            let instances = 4 * patches;
            let written = MemoryLocation::CpuToGpu;
            let mut capture = numbers.capture;
            // SAFETY: as above.
            let [draws, instances] = unsafe {
                if self.options.count_vertices {
                    let size = 4 + size_of::<abi::Captured>() as u64 * patches;
                    capture = bound.add(maker, "counts", size, storage | target, host)?;
                    numbers.counts.push(capture);
                }
                [
                    bound.add(maker, "draws", draws, seen, written)?,
                    bound.add(maker, "instances", instances, storage, written)?,
                ]
            };
            numbers.decisions.push([draws, instances]);
            sets.push(vec![
                Binding::storage(abi::BINDING_SCRATCH, numbers.ring),
                Binding::storage(abi::BINDING_COUNTERS, numbers.counters),
                Binding::storage(abi::BINDING_DRAWS, draws),
                Binding::storage(abi::BINDING_CAPTURE, capture),
                Binding::storage(abi::BINDING_INSTANCES, instances),
                Binding::storage(abi::BINDING_VIEWS, numbers.views),
            ]);
        }
        // Until something is read back there are no counts, and nothing is captured.
        let counted = bound.buffer_mut(numbers.counted);
        counted.write(0, bytemuck::bytes_of(&NOT_READ_BACK))?;
        bound.buffer_mut(numbers.capture).write(0, &[0; 4])?;
        // SAFETY: as above.
        unsafe { bound.describe(maker.device, maker.layout.frame_set(), &sets) }
    }

    /// How it uses the device.
    pub fn options(&self) -> SurfaceOptions {
        self.options
    }

    /// The bytes on the device, those of refinement patterns aside.
    pub fn bytes(&self) -> u64 {
        self.bound.bytes()
    }

    /// Decides what is drawn at a cut, with a depth for each control vertex if there are tags; see [`DrawList::new`].
    ///
    /// # Errors
    /// As there: a level that is none or above the greatest, tags that are none. [`Misuse::OtherSurface`] for other tables.
    pub fn draw_list(
        &self,
        tables: &Tables,
        cut: Cut,
        tags: Option<&DepthTags>,
    ) -> Result<DrawList> {
        self.check(tables)?;
        let (prepared, vertices) = (tables.prepared(), self.instance_vertices);
        DrawList::new(prepared, &self.options, vertices, cut, tags)
    }

    /// Brings to the device what the host decided about patches: slots in the ring, levels by depth tags, refinement patterns, pieces.
    ///
    /// Needed before a list is drawn that [has decisions](DrawList::has_decisions), whenever it is another than the last; harmless else.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`]; Vulkan's own, when there is no memory for more patterns.
    ///
    /// # Safety
    /// `device` and `allocator` made this slot, and no submitted command still uses it.
    pub unsafe fn write_draws(
        &mut self,
        device: &ash::Device,
        allocator: &mut dyn Memory,
        tables: &Tables,
        list: &DrawList,
    ) -> Result<()> {
        self.check_owner(tables, list)?;
        if !list.has_decisions() {
            return Ok(());
        }
        self.written = None;
        for (pass, &[draws, instances]) in self.numbers.decisions.iter().enumerate() {
            let numbers = list.instances(pass);
            let records = match list.has_sub_patches() {
                true => bytemuck::cast_slice(list.sub_patches(pass)),
                false => bytemuck::cast_slice(list.records(pass)),
            };
            let bound = &mut self.bound;
            bound.buffer_mut(draws).write(0, records)?;
            let instances = bound.buffer_mut(instances);
            instances.write(0, bytemuck::cast_slice(numbers))?;
        }
        if self.options.backend.has_patterns() {
            // SAFETY: this function's contract.
            unsafe { self.patterns.write(device, allocator, list.patterns())? };
        }
        self.written = Some(list.number());
        Ok(())
    }

    /// Whether a list may be drawn now.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`] and [`Misuse::NotWritten`].
    pub(super) fn check_list(&self, tables: &Tables, list: &DrawList) -> Result<()> {
        self.check_owner(tables, list)?;
        if list.has_decisions() && self.written != Some(list.number()) {
            return Err(Error::Misuse(Misuse::NotWritten));
        }
        Ok(())
    }

    /// # Errors
    /// [`Misuse::OtherSurface`] for the list of another surface, and for other tables.
    pub(super) fn check_owner(&self, tables: &Tables, list: &DrawList) -> Result<()> {
        self.check(tables)?;
        if !list.is_for(tables.prepared(), &self.options, self.instance_vertices) {
            return Err(Error::Misuse(Misuse::OtherSurface));
        }
        let (needed, given) = (list.counters(), self.counters);
        if needed > given || !self.has_lists(list) {
            return Err(Error::Misuse(Misuse::ManyBatches { needed, given }));
        }
        Ok(())
    }

    /// # Errors
    /// [`Misuse::OtherSurface`] for tables that it was not made for.
    fn check(&self, tables: &Tables) -> Result<()> {
        if self.prepared == tables.prepared().number() {
            return Ok(());
        }
        Err(Error::Misuse(Misuse::OtherSurface))
    }

    /// # Errors
    /// [`Misuse::View`] for some that `cmd_prepare` was not given; [`Misuse::ViewsInRing`] and [`Misuse::ManyViews`] for a batch that cannot be
    /// drawn with so many at once.
    pub(super) fn check_views(&self, views: &Range<u32>, batch: Batch<'_>) -> Result<()> {
        let given = self.views.load(Ordering::Relaxed);
        if views.end > given {
            let (view, views) = (views.end - 1, given);
            return Err(Error::Misuse(Misuse::View { view, views }));
        }
        if views.len() > 1 && batch.points() > 0 {
            return Err(Error::Misuse(Misuse::ViewsInRing));
        }
        let patches = batch.drawn().end;
        if u64::from(views.end) * u64::from(patches) > 1 << 32 {
            let views = views.end;
            return Err(Error::Misuse(Misuse::ManyViews { views, patches }));
        }
        Ok(())
    }

    /// Records what a frame needs before its render passes: its views, counters at zero, and the ring free of earlier frames' use.
    ///
    /// It waits for the control and evaluation shaders (or whatever evaluates patches) of all earlier commands on the queue.
    ///
    /// # Errors
    /// [`Misuse::View`] for more views than the options' [`views`](SurfaceOptions::views); nothing has been recorded then.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this slot, outside of a render pass, and is submitted to the queue of the slot's earlier
    /// frames. The slot lives until the commands have been executed.
    pub unsafe fn cmd_prepare(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        views: &[View],
    ) -> Result<()> {
        let count = views.len() as u32;
        if count > self.options.views {
            let (view, views) = (count - 1, self.options.views);
            return Err(Error::Misuse(Misuse::View { view, views }));
        }
        let views: Vec<abi::View> = views.iter().map(View::record).collect();
        let transfer = vk::PipelineStageFlags::TRANSFER;
        let stages = self.options.backend.on_device().readers;
        // Clip coordinates are made where patches are evaluated, and lit in the fragment shader.
        let mut seeing = stages | vk::PipelineStageFlags::FRAGMENT_SHADER;
        if self.options.decides == Decides::Device {
            seeing |= vk::PipelineStageFlags::COMPUTE_SHADER;
        }
        let write = vk::AccessFlags::TRANSFER_WRITE;
        // SAFETY: this function's contract; neither command is allowed inside a render pass, hence this function.
        unsafe {
            cmd_make_visible(device, cmd, seeing | transfer, transfer, write);
            let buffer = self.bound.buffer(self.numbers.views).raw();
            let parts = bytemuck::cast_slice(&views).chunks(MOST_UPDATED);
            for (place, part) in (0u64..).zip(parts) {
                device.cmd_update_buffer(cmd, buffer, place * MOST_UPDATED as u64, part);
            }
            device.cmd_fill_buffer(cmd, self.counters_buffer().raw(), 0, vk::WHOLE_SIZE, 0);
            device.cmd_fill_buffer(cmd, self.capture_buffer().raw(), 0, 4, 0);
            for &counts in &self.numbers.counts {
                let counts = self.bound.buffer(counts).raw();
                device.cmd_fill_buffer(cmd, counts, 0, vk::WHOLE_SIZE, 0);
            }
            cmd_make_visible(device, cmd, transfer | stages, seeing, RING_ACCESS);
        }
        self.views.store(count, Ordering::Relaxed);
        *self.decided.lock().unwrap_or_else(PoisonError::into_inner) = None;
        Ok(())
    }

    /// Records the copy of what was counted and captured to where the host can read it.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this slot, outside of a render pass, after the draws. The slot lives until the
    /// commands have been executed.
    pub unsafe fn cmd_read_back(&self, device: &ash::Device, cmd: vk::CommandBuffer) {
        let copy = vk::BufferCopy::default().size(8);
        let (transfer, host) = (
            vk::PipelineStageFlags::TRANSFER,
            vk::PipelineStageFlags::HOST,
        );
        let stages = self.options.backend.on_device().readers;
        let (read, host_read) = (vk::AccessFlags::TRANSFER_READ, vk::AccessFlags::HOST_READ);
        let counted = self.bound.buffer(self.numbers.counted).raw();
        // SAFETY: this function's contract.
        unsafe {
            cmd_make_visible(device, cmd, stages, transfer, read);
            device.cmd_copy_buffer(cmd, self.counters_buffer().raw(), counted, &[copy]);
            cmd_make_visible(device, cmd, transfer | stages, host, host_read);
        }
    }

    /// What was counted. Meaningful when [`cmd_read_back`](Self::cmd_read_back) has been executed.
    ///
    /// # Errors
    /// [`Misuse::NotReadBack`] as long as none has been.
    pub fn counters(&self) -> Result<Counters> {
        let counted = self.bound.buffer(self.numbers.counted).bytes();
        let counted: [u32; 2] = bytemuck::pod_read_unaligned(counted);
        if counted == NOT_READ_BACK {
            return Err(Error::Misuse(Misuse::NotReadBack));
        }
        Ok(Counters {
            overflows: counted[abi::COUNTER_OVERFLOWS as usize],
            points: counted[abi::COUNTER_POINTS as usize],
        })
    }

    /// What was captured since [`cmd_prepare`](Self::cmd_prepare), in no order, and possibly some vertices more than once. Meaningful
    /// when [`cmd_read_back`](Self::cmd_read_back) has been executed.
    ///
    /// # Errors
    /// [`Misuse::NotReadBack`] as long as none has been.
    pub fn captured(&self) -> Result<&[abi::Captured]> {
        self.counters()?;
        let (count, captured) = self.capture_buffer().bytes().split_at(4);
        let count = bytemuck::pod_read_unaligned::<u32>(count).min(self.options.capture_vertices);
        Ok(&bytemuck::cast_slice(captured)[..count as usize])
    }

    /// By pass and patch: the vertices that were counted; none where they are not counted.
    pub(super) fn counts(&self) -> Vec<Vec<u32>> {
        let counts = self.numbers.counts.iter().map(|&counts| {
            let records: &[abi::Captured] =
                bytemuck::cast_slice(&self.bound.buffer(counts).bytes()[4..]);
            records.iter().map(|record| record.patch_number).collect()
        });
        counts.collect()
    }

    /// The flags that its options make.
    pub(super) fn flags(&self) -> u32 {
        let flag = |on: bool, flag: u32| if on { flag } else { 0 };
        let options = &self.options;
        flag(
            options.slots == crate::frame::Slots::Host || options.decides == Decides::Device,
            abi::FRAME_GIVEN_SLOTS,
        ) | flag(options.capture_vertices > 0, abi::FRAME_CAPTURE)
            | flag(options.amplify_cracks, abi::FRAME_PARITY)
            | flag(options.count_vertices, abi::FRAME_COUNT)
    }

    /// How many vertices an instance of a draw has, of so many patches.
    pub(super) fn vertices_of(&self, pass: &Pass, patches: u32) -> u32 {
        match self.options.backend.on_device().one_vertex {
            true => patches,
            false => patches * control_points(pass, self.options.residence),
        }
    }

    pub(super) fn patterns(&self) -> &Patterns {
        &self.patterns
    }

    /// The descriptor set of a pass, [`abi::SET_FRAME`].
    pub(super) fn set(&self, pass: usize) -> vk::DescriptorSet {
        self.bound.set(pass)
    }

    /// What is decided about the patches of a pass: of passes that there are.
    pub(super) fn draws_buffer(&self, pass: usize) -> &Buffer {
        self.bound.buffer(self.numbers.decisions[pass][0])
    }

    /// Where the lists of what is drawn of each pass stand, where the device decides.
    pub(super) fn lists(&self) -> &[Lists] {
        &self.numbers.lists
    }

    fn counters_buffer(&self) -> &Buffer {
        self.bound.buffer(self.numbers.counters)
    }

    fn capture_buffer(&self) -> &Buffer {
        self.bound.buffer(self.numbers.capture)
    }

    /// Destroys everything.
    ///
    /// # Safety
    /// `device` and `allocator` are those that made it, no submitted command still uses it, and no recorded one will be submitted.
    pub unsafe fn destroy(self, device: &ash::Device, allocator: &mut dyn Memory) {
        // SAFETY: this function's contract.
        unsafe {
            self.patterns.destroy(device, allocator);
            self.bound.destroy(device, allocator);
        }
    }
}
