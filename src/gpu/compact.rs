//! From what the device decided to what it draws, see `glsl/compact.comp`: lists of patches and the commands of batches, which nothing on the host waits for.

use std::ops::Range;

use ash::vk;

use crate::abi;
use crate::frame::{Batch, Compaction, Draw, DrawList};
use crate::gpu::barrier::cmd_make_visible;
use crate::gpu::draw::Constants;
use crate::gpu::indirect::MOST_COMMANDS;
use crate::gpu::lists::Lists;
use crate::gpu::pipeline::control_points;
use crate::gpu::sets::STAGES;
use crate::gpu::{DecidePipeline, Decided, Drawing, FrameSlot, Layout, Pose, Tables};
use crate::method::Pass;
use crate::tessellation::Spacing;

/// The steps of `compact.comp`, in their order.
const STEPS: [u32; 4] = [
    abi::COMPACT_COUNT,
    abi::COMPACT_SUM,
    abi::COMPACT_LIST,
    abi::COMPACT_COMMANDS,
];

impl FrameSlot {
    /// Whether there is room for the batches of a list.
    pub(super) fn has_lists(&self, list: &DrawList) -> bool {
        let mut room = self.lists().iter().zip(list.compactions());
        room.all(|(lists, own)| own.is_none_or(|own| lists.has_room(&own)))
    }

    /// Records what is drawn of what was decided, and what later draws wait for.
    ///
    /// # Safety
    /// As [`cmd_decide`](Self::cmd_decide), behind what decides; all of it was checked.
    #[allow(clippy::too_many_arguments)] // As `cmd_decide`.
    pub(super) unsafe fn cmd_compact(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipeline: &DecidePipeline,
        (tables, pose): (&Tables, &Pose),
        list: &DrawList,
        decided: &Decided,
    ) {
        let bind = vk::PipelineBindPoint::COMPUTE;
        let compute = vk::PipelineStageFlags::COMPUTE_SHADER;
        let both = vk::AccessFlags::SHADER_READ | vk::AccessFlags::SHADER_WRITE;
        let groups = decided.views.len() as u32 / decided.eyes;
        // SAFETY: this function's contract, here and below.
        unsafe { device.cmd_bind_pipeline(cmd, bind, pipeline.compact()) };
        for step in STEPS {
            // SAFETY: as above.
            unsafe { cmd_make_visible(device, cmd, compute, compute, both) };
            for (number, own) in list.compactions().iter().enumerate() {
                let (lists, Some(own)) = (self.lists()[number], own) else {
                    continue;
                };
                let pass = &tables.prepared().passes[number];
                let record = self.compaction(layout, (pass, list), (lists, own), decided, step);
                let constants = bytemuck::bytes_of(&record);
                let sets = [tables.set(number), pose.set(), self.set(number)];
                let workgroups = match step {
                    abi::COMPACT_SUM => 1,
                    abi::COMPACT_COMMANDS => own.batches.div_ceil(abi::DECIDE_INVOCATIONS),
                    _ => lists.workgroups(),
                };
                // SAFETY: as above.
                unsafe {
                    device.cmd_bind_descriptor_sets(cmd, bind, layout.pipeline(), 0, &sets, &[]);
                    device.cmd_push_constants(cmd, layout.pipeline(), STAGES, 0, constants);
                    device.cmd_dispatch(cmd, workgroups, groups, 1);
                }
            }
        }
        let readers = pose.readers() | vk::PipelineStageFlags::DRAW_INDIRECT;
        let read = vk::AccessFlags::SHADER_READ | vk::AccessFlags::INDIRECT_COMMAND_READ;
        // SAFETY: as above.
        unsafe { cmd_make_visible(device, cmd, compute, readers, read) };
    }

    /// As shaders have it.
    fn compaction(
        &self,
        layout: &Layout,
        (pass, list): (&Pass, &DrawList),
        (lists, own): (Lists, &Compaction),
        decided: &Decided,
        step: u32,
    ) -> abi::Compaction {
        let flag = |on: bool, flag: u32| if on { flag } else { 0 };
        let fractional_even = list.cut().spacing == Spacing::FractionalEven;
        let controls = control_points(pass, list.options().residence);
        abi::Compaction {
            flags: flag(fractional_even, abi::FRAME_FRACTIONAL_EVEN)
                | flag(own.slot.is_none(), abi::COMPACT_POINTS)
                | flag(
                    layout.enabled().multi_draw_indirect,
                    abi::COMPACT_FIRST_INSTANCE,
                )
                | step << abi::COMPACT_STEP_SHIFT
                | controls << abi::COMPACT_CONTROLS_SHIFT
                | decided.eyes << abi::FRAME_EYES_SHIFT,
            view: decided.views.start,
            batches: lists.batch(0, 0),
            list: lists.list(0),
            count: own.batches,
            window: own.window,
            points: own.slot.unwrap_or(0),
            instance_vertices: own.instance_vertices.unwrap_or(0),
        }
    }

    /// What the device decided about the patches of a pass in a view; empty where the host decides, or there is no such pass or view. Meaningful when
    /// [`cmd_read_back`](Self::cmd_read_back) has been executed.
    pub fn decided(&self, pass: usize, view: u32) -> &[abi::PatchDraw] {
        let Some(lists) = self.lists().get(pass) else {
            return &[];
        };
        let count = lists.patches() as usize;
        let bytes = &self.draws_buffer(pass).bytes()[..4 * lists.batch(0, 0) as usize];
        let records: &[abi::PatchDraw] = bytemuck::cast_slice(bytes);
        records
            .chunks(count.max(1))
            .nth(view as usize)
            .unwrap_or(&[])
    }

    /// The patches that a batch drew in a view, of a list that the device has decided for. Empty and meaningful as [`decided`](Self::decided) is.
    pub fn drawn(&self, batch: Batch<'_>, view: u32) -> &[u32] {
        let &[Draw::Decided { batch: number }] = batch.draws() else {
            return &[];
        };
        let (batches, drawn) = self.compacted(batch.list(), batch.pass(), view);
        let own = batches.get(number as usize);
        let own = own.map(|own| own.first as usize..(own.first + own.patches) as usize);
        own.and_then(|own| drawn.get(own)).unwrap_or(&[])
    }

    /// What the batches of a pass drew in a view, and the list of the patches that they drew, of which they tell: of a list that the device has decided for. With
    /// several eyes an instance, in the view of its first. Empty and meaningful as [`decided`](Self::decided) is.
    pub fn compacted(
        &self,
        list: &DrawList,
        pass: usize,
        view: u32,
    ) -> (&[abi::DrawnBatch], &[u32]) {
        let own = list.compactions().get(pass).copied().flatten();
        let (Some(lists), Some(own)) = (self.lists().get(pass), own) else {
            return (&[], &[]);
        };
        if view >= self.options().views || !lists.has_room(&own) {
            return (&[], &[]);
        }
        let words: &[u32] = bytemuck::cast_slice(self.draws_buffer(pass).bytes());
        let words = |first: u32, count: u32| &words[first as usize..][..count as usize];
        let batches = words(lists.batch(view, 0), abi::BATCH_WORDS * own.batches);
        let batches: &[abi::DrawnBatch] = bytemuck::cast_slice(batches);
        let drawn = batches.iter().map(|batch| batch.patches).sum::<u32>();
        let drawn = words(lists.list(view), drawn.min(lists.patches()));
        (batches, drawn)
    }
}

/// The commands of a batch that the device has made, one a view.
pub(super) struct DecidedCommands {
    buffer: vk::Buffer,
    /// Of the first view, and from a view to the next instance's.
    offset: u64,
    stride: u32,
    views: Range<u32>,
    /// How many are drawn at once.
    together: u32,
}

impl Drawing<'_> {
    pub(super) fn decided_commands(
        &self,
        layout: &Layout,
        batch: Batch<'_>,
        number: u32,
        views: &Range<u32>,
    ) -> DecidedCommands {
        let lists = self.slot.lists()[batch.pass()];
        DecidedCommands {
            buffer: self.slot.draws_buffer(batch.pass()).raw(),
            offset: 4 * u64::from(lists.batch(views.start, number)),
            stride: 4 * lists.view_words(),
            views: views.clone(),
            together: match layout.enabled().multi_draw_indirect {
                true => MOST_COMMANDS,
                false => 1,
            },
        }
    }
}

impl DecidedCommands {
    /// # Safety
    /// As [`Drawing::cmd_draw`], with everything bound but the constants; the device has decided about these views.
    pub unsafe fn cmd_draw(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        constants: Constants,
        frame: abi::Frame,
    ) {
        let count = self.views.len() as u32 / constants.eyes;
        let stride = self.stride * constants.eyes;
        let mut first = 0;
        while first < count {
            let together = self.together.min(count - first);
            // With the feature the commands themselves tell their views.
            let view = match self.together {
                1 => self.views.start + first * constants.eyes,
                _ => 0,
            };
            let offset = self.offset + u64::from(stride) * u64::from(first);
            // SAFETY: this function's contract.
            unsafe {
                constants.cmd_push(device, cmd, &abi::Frame { view, ..frame });
                device.cmd_draw_indirect(cmd, self.buffer, offset, together, stride);
            }
            first += together;
        }
    }
}
