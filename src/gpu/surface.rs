//! A prepared model on the device, in one pose and with one frame slot: what a program needs that draws a model and waits for it.

mod cached;

use std::ops::Range;

use ash::vk;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Batch, Cut, Decision, DrawList, Outcome, SurfaceOptions};
use crate::gpu::workaround::Workaround;
use crate::gpu::{
    Arrival, Counters, DecidePipeline, Decided, Drawing, FrameSlot, Handover, Layout, Memory,
    Pipelines, PointPipeline, Pose, Retired, Tables, View,
};
use crate::mesh::{ChangeSet, Model};
use crate::method::{DepthTags, Editable, Prepared, Update};

/// A prepared model on the device: [`Tables`], a [`Pose`] and a [`FrameSlot`] in one. It borrows nothing; the owner calls
/// [`TessellatedSurface::destroy`].
///
/// An engine with several instances or frames in flight keeps the three by themselves and draws a [`Drawing`] of them.
#[derive(Debug)]
pub struct TessellatedSurface {
    tables: Tables,
    pose: Pose,
    slot: FrameSlot,
    /// Whether tables and pose were released by the last upload that is handed over.
    released: [bool; 2],
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
        allocator: &mut dyn Memory,
        layout: &Layout,
        model: &Model,
        prepared: Prepared,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<TessellatedSurface> {
        if !prepared.is_of(model) {
            return Err(Error::Misuse(Misuse::OtherMesh));
        }
        // SAFETY: this function's contract.
        let tables = unsafe { Tables::new(device, allocator, layout, prepared, &options)? };
        // SAFETY: as above; the tables were just made.
        unsafe {
            TessellatedSurface::of(
                device,
                allocator,
                layout,
                model,
                tables,
                workarounds,
                options,
            )
        }
    }

    /// The same of what can be edited, see [`Tables::editable`].
    ///
    /// # Errors
    /// As [`new`](Self::new) and [`Tables::editable`].
    ///
    /// # Safety
    /// As [`new`](Self::new).
    pub unsafe fn editable(
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        model: &Model,
        editable: &Editable,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<TessellatedSurface> {
        if !editable.prepared().is_of(model) {
            return Err(Error::Misuse(Misuse::OtherMesh));
        }
        // SAFETY: this function's contract.
        let tables = unsafe { Tables::editable(device, allocator, layout, editable, &options)? };
        // SAFETY: as above; the tables were just made.
        unsafe {
            TessellatedSurface::of(
                device,
                allocator,
                layout,
                model,
                tables,
                workarounds,
                options,
            )
        }
    }

    /// # Safety
    /// As [`new`](Self::new), by which the tables were just made.
    unsafe fn of(
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        model: &Model,
        tables: Tables,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<TessellatedSurface> {
        // SAFETY: this function's contract.
        let slot =
            unsafe { FrameSlot::new(device, allocator, layout, &tables, workarounds, options) };
        let slot = match slot {
            Ok(slot) => slot,
            Err(error) => {
                // SAFETY: nothing of them has been recorded.
                unsafe { tables.destroy(device, allocator) };
                return Err(error);
            }
        };
        let positions = model.positions();
        // SAFETY: as above.
        match unsafe { Pose::new(device, allocator, layout, &tables, &positions, &options) } {
            Ok(pose) => Ok(TessellatedSurface {
                tables,
                pose,
                slot,
                released: [false; 2],
            }),
            Err(error) => {
                // SAFETY: nothing of them has been recorded.
                unsafe {
                    slot.destroy(device, allocator);
                    tables.destroy(device, allocator);
                }
                Err(error)
            }
        }
    }

    /// What it is drawn by.
    pub fn drawing(&self) -> Drawing<'_> {
        Drawing {
            tables: &self.tables,
            pose: &self.pose,
            slot: &self.slot,
            sets: &[],
        }
    }

    /// What was prepared.
    pub fn prepared(&self) -> &Prepared {
        self.tables.prepared()
    }

    /// How it uses the device.
    pub fn options(&self) -> SurfaceOptions {
        self.slot.options()
    }

    /// The bytes on the device, those aside that an upload is staged in.
    pub fn bytes(&self) -> u64 {
        self.tables.bytes() + self.pose.bytes() + self.slot.bytes()
    }

    /// As [`FrameSlot::draw_list`].
    ///
    /// # Errors
    /// As there.
    pub fn draw_list(&self, cut: Cut, tags: Option<&DepthTags>) -> Result<DrawList> {
        self.slot.draw_list(&self.tables, cut, tags)
    }

    /// Records the copy of what has changed to the device, after what earlier commands of the queue still draw, and before whatever draws next:
    /// the first time everything, after [`edit`](Self::edit) what it changed, after [`write_positions`](Self::write_positions) the control vertices and their points, else nothing.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, which made this surface, outside of a render pass, and will be executed. The surface lives until then,
    /// and neither [`finish_upload`](Self::finish_upload) nor [`write_positions`](Self::write_positions) is called before.
    pub unsafe fn cmd_upload(&mut self, device: &ash::Device, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe {
            self.tables.cmd_upload(device, cmd);
            self.pose.cmd_upload(device, cmd);
        }
    }

    /// As [`Tables::cmd_upload_and_release`] and [`Pose::cmd_upload_and_release`]: what has changed, on a queue that copies while others draw. Where it
    /// returns true, [`cmd_acquire`](Self::cmd_acquire) is recorded with the same families for a queue that draws, before the next of this; otherwise nothing has
    /// changed.
    ///
    /// # Safety
    /// As there.
    pub unsafe fn cmd_upload_and_release(
        &mut self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        handover: Handover,
    ) -> bool {
        // SAFETY: this function's contract.
        self.released = unsafe {
            [
                self.tables.cmd_upload_and_release(device, cmd, handover),
                self.pose.cmd_upload_and_release(device, cmd, handover),
            ]
        };
        self.released.contains(&true)
    }

    /// As [`Tables::cmd_acquire`] and [`Pose::cmd_acquire`], of what the last [`cmd_upload_and_release`](Self::cmd_upload_and_release) has released.
    ///
    /// # Safety
    /// As there.
    pub unsafe fn cmd_acquire(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        handover: Handover,
    ) {
        let [tables, pose] = self.released;
        if tables {
            // SAFETY: this function's contract.
            unsafe { self.tables.cmd_acquire(device, cmd, handover) };
        }
        if pose {
            // SAFETY: as above.
            unsafe { self.pose.cmd_acquire(device, cmd, handover) };
        }
    }

    /// Gives the memory back that the tables were staged in. Positions can still be replaced.
    ///
    /// # Safety
    /// `device` and `allocator` made this surface, and the upload has been executed.
    pub unsafe fn finish_upload(&mut self, device: &ash::Device, allocator: &mut dyn Memory) {
        // SAFETY: this function's contract.
        unsafe { self.tables.finish_upload(device, allocator) };
    }

    /// As [`Tables::edit`]: the next [`cmd_upload`](Self::cmd_upload) brings the edit to the device. Where vertices were added or moved, or points are cached,
    /// [`edit_pose`](Self::edit_pose) comes behind it.
    ///
    /// # Errors
    /// As there.
    ///
    /// # Safety
    /// As there.
    pub unsafe fn edit(
        &mut self,
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        editable: &Editable,
        update: &Update,
    ) -> Result<Retired> {
        let tables = &mut self.tables;
        // SAFETY: this function's contract.
        unsafe { tables.edit(device, allocator, layout, editable, update) }
    }

    /// As [`Pose::edit`], after [`edit`](Self::edit): vertices that an edit has moved or added.
    ///
    /// # Errors
    /// As there.
    ///
    /// # Safety
    /// As there.
    pub unsafe fn edit_pose(
        &mut self,
        device: &ash::Device,
        allocator: &mut dyn Memory,
        layout: &Layout,
        model: &Model,
        changes: &ChangeSet,
    ) -> Result<Retired> {
        let (tables, pose) = (&self.tables, &mut self.pose);
        // SAFETY: this function's contract.
        unsafe { pose.edit(device, allocator, layout, tables, model, changes) }
    }

    /// As [`Pose::move_vertices`].
    ///
    /// # Errors
    /// As there.
    pub fn move_vertices(&mut self, moved: &[(u32, [f32; 3])]) -> Result<()> {
        self.pose.move_vertices(&self.tables, moved)
    }

    /// As [`Pose::write_positions`].
    ///
    /// # Errors
    /// [`Misuse::Count`] when the number of positions is not that of the model.
    pub fn write_positions(&mut self, positions: &[[f32; 3]]) -> Result<()> {
        self.pose.write_positions(&self.tables, positions)
    }

    /// As [`Pose::position_buffer`].
    pub fn position_buffer(&self) -> vk::Buffer {
        self.pose.position_buffer()
    }

    /// As [`Pose::limit_buffer`].
    pub fn limit_buffer(&self) -> Option<vk::Buffer> {
        self.pose.limit_buffer()
    }

    /// As [`Pose::cmd_points`].
    ///
    /// # Safety
    /// As there.
    pub unsafe fn cmd_points(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipeline: &PointPipeline,
    ) {
        // SAFETY: this function's contract; the pose was made for these tables.
        unsafe {
            self.pose
                .cmd_points(device, cmd, layout, pipeline, &self.tables)
        }
    }

    /// As [`Pose::cmd_points_of`].
    ///
    /// # Safety
    /// As there.
    pub unsafe fn cmd_points_of(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipeline: &PointPipeline,
        list: &DrawList,
    ) {
        let given = (&self.tables, list);
        // SAFETY: this function's contract; the pose was made for these tables.
        unsafe {
            self.pose
                .cmd_points_of(device, cmd, layout, pipeline, given)
        }
    }

    /// As [`FrameSlot::write_draws`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Safety
    /// `device` and `allocator` made this surface, and no submitted command still uses it.
    pub unsafe fn write_draws(
        &mut self,
        device: &ash::Device,
        allocator: &mut dyn Memory,
        list: &DrawList,
    ) -> Result<()> {
        // SAFETY: this function's contract.
        unsafe { self.slot.write_draws(device, allocator, &self.tables, list) }
    }

    /// As [`FrameSlot::cmd_prepare`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Safety
    /// As there.
    pub unsafe fn cmd_prepare(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        views: &[View],
    ) -> Result<()> {
        // SAFETY: this function's contract.
        unsafe { self.slot.cmd_prepare(device, cmd, views) }
    }

    /// As [`FrameSlot::cmd_decide`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Safety
    /// As there.
    #[allow(clippy::too_many_arguments)] // As there.
    pub unsafe fn cmd_decide(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipeline: &DecidePipeline,
        list: &DrawList,
        decision: &Decision,
        decided: &Decided,
    ) -> Result<()> {
        let on = (&self.tables, &self.pose);
        // SAFETY: this function's contract.
        unsafe {
            self.slot
                .cmd_decide(device, cmd, layout, pipeline, on, list, decision, decided)
        }
    }

    /// As [`FrameSlot::decided`].
    pub fn decided(&self, pass: usize, view: u32) -> &[abi::PatchDraw] {
        self.slot.decided(pass, view)
    }

    /// As [`FrameSlot::outcome`].
    ///
    /// # Errors
    /// As there.
    pub fn outcome(&self, list: &DrawList, views: Range<u32>) -> Result<Outcome> {
        self.slot.outcome(&self.tables, list, views)
    }

    /// As [`Drawing::cmd_draw`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Safety
    /// As there.
    pub unsafe fn cmd_draw(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &Pipelines,
        views: Range<u32>,
        batch: Batch<'_>,
    ) -> Result<()> {
        let drawing = self.drawing();
        // SAFETY: this function's contract.
        unsafe { drawing.cmd_draw(device, cmd, layout, pipelines, views, batch) }
    }

    /// As [`FrameSlot::cmd_read_back`].
    ///
    /// # Safety
    /// As there.
    pub unsafe fn cmd_read_back(&self, device: &ash::Device, cmd: vk::CommandBuffer) {
        // SAFETY: this function's contract.
        unsafe { self.slot.cmd_read_back(device, cmd) };
    }

    /// As [`FrameSlot::counters`].
    ///
    /// # Errors
    /// As there.
    pub fn counters(&self) -> Result<Counters> {
        self.slot.counters()
    }

    /// As [`FrameSlot::captured`].
    ///
    /// # Errors
    /// As there.
    pub fn captured(&self) -> Result<&[abi::Captured]> {
        self.slot.captured()
    }

    /// As [`Drawing::arrival`].
    ///
    /// # Errors
    /// As there.
    pub fn arrival<'l>(&self, batches: impl IntoIterator<Item = Batch<'l>>) -> Result<Arrival> {
        self.drawing().arrival(batches)
    }

    /// Destroys everything.
    ///
    /// # Safety
    /// `device` and `allocator` are those that made it, no submitted command still uses it, and no recorded one will be submitted.
    pub unsafe fn destroy(self, device: &ash::Device, allocator: &mut dyn Memory) {
        // SAFETY: this function's contract.
        unsafe {
            self.slot.destroy(device, allocator);
            self.pose.destroy(device, allocator);
            self.tables.destroy(device, allocator);
        }
    }
}
