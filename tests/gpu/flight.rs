//! Frames in flight: each has a slot of its own, and nothing waits for the other.

use ash::vk;
use hullform::abi::Captured;
use hullform::gpu::{
    Backend, CachePipelines, DecidePipeline, Decided, Decides, Decision, Drawing, Fill, FrameSlot,
    Metric, Pipelines, Pose, Residence, SurfaceOptions, Tables, View,
};
use hullform::host::Owned;
use hullform::method::DepthTags;
use hullform::method::{Displacement, METHODS};
use hullform::tessellation::Spacing;

use crate::common::gpu::{Gpu, bits, capturing, cut, prepare};
use crate::compact::hold_to_twin;
use crate::decide::{are_alike, seen, views};
use crate::shapes;

/// Frames in flight at once.
const SLOTS: usize = 2;

/// Frames in all.
const FRAMES: usize = 12;

/// A frame slot with commands of its own, and what tells when they are done.
pub struct Flight<'a> {
    gpu: &'a Gpu,
    pub slot: Owned<FrameSlot>,
    pool: vk::CommandPool,
    cmd: vk::CommandBuffer,
    done: vk::Fence,
}

impl<'a> Flight<'a> {
    pub fn new(gpu: &'a Gpu, slot: Owned<FrameSlot>) -> Flight<'a> {
        let device = gpu.device.raw();
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(gpu.device.queue_family())
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        // SAFETY: the device is live, the pool ours.
        unsafe {
            let pool = device.create_command_pool(&pool, None).expect("a pool");
            let info = vk::CommandBufferAllocateInfo::default()
                .command_pool(pool)
                .command_buffer_count(1);
            let cmd = device.allocate_command_buffers(&info).expect("commands")[0];
            let done = device.create_fence(&vk::FenceCreateInfo::default(), None);
            Flight {
                gpu,
                slot,
                pool,
                cmd,
                done: done.expect("a fence"),
            }
        }
    }

    /// Draws the surface with these tags; returns as soon as the queue has it.
    fn depart(
        &mut self,
        (tables, pose): (&Tables, &Pose),
        pipelines: &Pipelines,
        tags: &DepthTags,
    ) {
        let (device, layout) = (self.gpu.device.raw(), self.gpu.layout());
        let deep = cut(8.0, Spacing::Equal);
        let list = self.slot.draw_list(tables, deep, Some(tags));
        let list = list.expect("tags are depths");
        let view = View {
            clip_from_model: [[0.0; 4]; 4],
            eye: [0.0; 3],
            displacement: Displacement::default(),
        };
        // SAFETY: all of one live device; what used the slot before has landed.
        unsafe {
            let allocator = &mut self.gpu.device.allocator();
            let written = self.slot.write_draws(device, allocator, tables, &list);
            written.expect("it is this slot's");
        }
        self.send(|cmd, slot| {
            let drawing = Drawing {
                tables,
                pose,
                slot,
                sets: &[],
            };
            // SAFETY: as above.
            unsafe {
                let prepared = slot.cmd_prepare(device, cmd, &[view]);
                prepared.expect("there is room for a view");
                self.gpu.target().begin(cmd, [0.0; 4]);
                for batch in list.batches() {
                    let drawn = drawing.cmd_draw(device, cmd, layout, pipelines, 0..1, batch);
                    drawn.expect("all belong together");
                }
                self.gpu.target().end(cmd);
            }
        });
    }

    /// Submits what is recorded, and the reading back; returns as soon as the queue has it.
    pub fn send(&self, record: impl FnOnce(vk::CommandBuffer, &FrameSlot)) {
        let device = self.gpu.device.raw();
        // SAFETY: all of one live device; what used the commands before has landed.
        unsafe {
            let once = vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT;
            let begin = vk::CommandBufferBeginInfo::default().flags(once);
            device
                .begin_command_buffer(self.cmd, &begin)
                .expect("begun");
            record(self.cmd, &self.slot);
            self.slot.cmd_read_back(device, self.cmd);
            device.end_command_buffer(self.cmd).expect("ended");
            let commands = [self.cmd];
            let submit = vk::SubmitInfo::default().command_buffers(&commands);
            let queue = self.gpu.device.queue();
            let submitted = device.queue_submit(*queue, &[submit], self.done);
            submitted.expect("the queue takes it");
        }
    }

    /// Waits for the frame, and returns what it captured.
    pub fn land(&mut self) -> Vec<Captured> {
        self.wait();
        let vertices = self.slot.captured().expect("it was read back").to_vec();
        once_each(vertices)
    }

    fn wait(&self) {
        let device = self.gpu.device.raw();
        // SAFETY: the fence was submitted, and nothing else waits for it.
        unsafe {
            let waited = device.wait_for_fences(&[self.done], true, u64::MAX);
            waited.expect("the frame ends");
            device.reset_fences(&[self.done]).expect("reset");
        }
    }
}

impl Drop for Flight<'_> {
    fn drop(&mut self) {
        let device = self.gpu.device.raw();
        // SAFETY: every frame has landed.
        unsafe {
            device.destroy_fence(self.done, None);
            device.destroy_command_pool(self.pool, None);
        }
    }
}

fn once_each(mut vertices: Vec<Captured>) -> Vec<Captured> {
    vertices.sort_unstable_by_key(bits);
    vertices.dedup_by_key(|vertex| bits(vertex));
    vertices
}

fn tags(count: usize, frame: usize) -> DepthTags {
    DepthTags::new((0..count).map(|vertex| ((3 * vertex + frame) % 7) as f32 * 0.5))
}

/// Tags of its own for each frame, and two frames that the queue has at once: what each draws is what it draws alone, with one set of tables.
#[test]
fn tags_change_from_frame_to_frame_without_a_wait_between() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("cubes-2x2x2");
    let prepared = prepare(&model, METHODS[0].name);
    assert_eq!(prepared.passes.len(), 1, "the capture tells of no passes");
    let deep = cut(8.0, Spacing::Equal);
    let count = model.mesh().vertex_count();
    let (device, layout) = (gpu.device.raw(), gpu.layout());
    let workarounds = &gpu.device.info().workarounds;
    for residence in Residence::ALL {
        let options = SurfaceOptions {
            residence,
            ..capturing(&prepared, &[deep])
        };
        let mut alone = gpu
            .load(&model, prepared.clone(), workarounds, options)
            .expect("it fits");
        let mut right = (0..FRAMES).map(|frame| {
            alone.tags = Some(tags(count, frame));
            let frame = alone.capture(deep, Fill::Discard).expect("it is drawn");
            once_each(frame.passes.concat())
        });
        let right: Vec<Vec<Captured>> = right.by_ref().collect();
        drop(alone);
        assert!(right.windows(2).all(|pair| pair[0].len() != pair[1].len()
            || pair[0].iter().map(bits).ne(pair[1].iter().map(bits))));

        // SAFETY: all of one live device, here and below.
        let (mut tables, mut pose) = unsafe {
            let allocator = &mut gpu.device.allocator();
            let tables = Tables::new(device, allocator, layout, prepared.clone(), &options)
                .expect("it fits");
            let positions = model.positions();
            let pose = Pose::new(device, allocator, layout, &tables, &positions, &options);
            let pose = Owned::new(&gpu.device, pose.expect("it fits"));
            (Owned::new(&gpu.device, tables), pose)
        };
        let mut flights: Vec<Flight<'_>> = (0..SLOTS)
            .map(|_| {
                // SAFETY: as above.
                let slot = unsafe {
                    let allocator = &mut gpu.device.allocator();
                    FrameSlot::new(device, allocator, layout, &tables, workarounds, options)
                };
                // SAFETY: as above.
                let slot = unsafe { Owned::new(&gpu.device, slot.expect("it fits")) };
                Flight::new(&gpu, slot)
            })
            .collect();
        let list = flights[0]
            .slot
            .draw_list(&tables, deep, None)
            .expect("a cut");
        // SAFETY: as above.
        let cached = unsafe {
            let cache = vk::PipelineCache::null();
            let made = CachePipelines::new(device, layout, cache, &prepared);
            Owned::new(
                &gpu.device,
                made.expect("the shipped modules make pipelines"),
            )
        };
        // SAFETY: recording on the device that made everything, outside of a render pass.
        let uploaded = gpu.device.submit(|cmd| unsafe {
            tables.cmd_upload(device, cmd);
            pose.cmd_upload(device, cmd);
            match residence {
                Residence::Ring => Ok(0),
                Residence::Cache => pose.cmd_cache(device, cmd, layout, &cached, &tables, &list),
            }
        });
        uploaded.expect("it is executed");
        let makers = (Backend::Tessellator, residence);
        let compare = vk::CompareOp::LESS_OR_EQUAL;
        let pipelines = gpu.build(&prepared, makers, Spacing::Equal, Fill::Discard, compare);
        let mut allocated = 0;
        for frame in 0..FRAMES + SLOTS {
            let flight = &mut flights[frame % SLOTS];
            if frame >= SLOTS {
                let own = flight.land();
                let same = own
                    .iter()
                    .map(bits)
                    .eq(right[frame - SLOTS].iter().map(bits));
                assert!(same, "{residence:?}, frame {}", frame - SLOTS);
            }
            if frame < FRAMES {
                flight.depart((&tables, &pose), &pipelines, &tags(count, frame));
            }
            match frame {
                0..SLOTS => allocated = gpu.device.allocated_bytes(),
                _ => assert_eq!(gpu.device.allocated_bytes(), allocated, "nothing is copied"),
            }
        }
    }
    gpu.finish();
}

/// Thirty instances, all seen from elsewhere in each frame, and two frames that the queue has at once: the device finds their levels by itself, into what each
/// frame has of its own, and what it finds is what the twin does.
#[test]
fn thirty_instances_have_other_levels_in_each_frame_without_a_wait_between() {
    const INSTANCES: u32 = 30;
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let prepared = prepare(&model, METHODS[0].name);
    let (device, layout) = (gpu.device.raw(), gpu.layout());
    let deep = cut(12.0, Spacing::FractionalEven);
    let options = SurfaceOptions {
        residence: Residence::Cache,
        decides: Decides::Device,
        greatest_level: deep.level,
        views: INSTANCES,
        ..SurfaceOptions::default()
    };
    let decision = Decision {
        metric: Metric::Distance(1.0),
        frustum: true,
        ..Decision::default()
    };
    let none = vk::PipelineCache::null();
    // SAFETY: all of one live device, here and below.
    let (mut tables, mut pose, cached, decide) = unsafe {
        let allocator = &mut gpu.device.allocator();
        let tables = Tables::new(device, allocator, layout, prepared.clone(), &options);
        let tables = Owned::new(&gpu.device, tables.expect("it fits"));
        let positions = model.positions();
        let pose = Pose::new(device, allocator, layout, &tables, &positions, &options);
        let cached = CachePipelines::new(device, layout, none, &prepared);
        let decide = DecidePipeline::new(device, layout, none);
        (
            tables,
            Owned::new(&gpu.device, pose.expect("it fits")),
            Owned::new(
                &gpu.device,
                cached.expect("the shipped modules make pipelines"),
            ),
            Owned::new(
                &gpu.device,
                decide.expect("the shipped module makes a pipeline"),
            ),
        )
    };
    let flights: Vec<Flight<'_>> = (0..SLOTS)
        .map(|_| {
            // SAFETY: as above.
            let slot = unsafe {
                let allocator = &mut gpu.device.allocator();
                let slot = FrameSlot::new(device, allocator, layout, &tables, &[], options);
                Owned::new(&gpu.device, slot.expect("it fits"))
            };
            Flight::new(&gpu, slot)
        })
        .collect();
    let list = flights[0]
        .slot
        .draw_list(&tables, deep, None)
        .expect("a cut");
    // SAFETY: recording on the device that made everything, outside of a render pass.
    let uploaded = gpu.device.submit(|cmd| unsafe {
        tables.cmd_upload(device, cmd);
        pose.cmd_upload(device, cmd);
        pose.cmd_cache(device, cmd, layout, &cached, &tables, &list)
    });
    uploaded.expect("it is executed");
    let makers = (Backend::Tessellator, Residence::Cache);
    let compare = vk::CompareOp::LESS_OR_EQUAL;
    let pipelines = gpu.build(&prepared, makers, deep.spacing, Fill::Discard, compare);
    let (tables, pose, positions) = (&*tables, &*pose, model.positions());
    let of_frame = |frame: usize| -> Vec<View> {
        let all = views((FRAMES as u32 + 1) * INSTANCES, 1.0);
        all.skip(frame * INSTANCES as usize)
            .take(INSTANCES as usize)
            .collect()
    };
    for frame in 0..FRAMES + SLOTS {
        let flight = &flights[frame % SLOTS];
        if frame >= SLOTS {
            flight.wait();
            for (number, view) in (0..).zip(of_frame(frame - SLOTS)) {
                hold_to_twin(&flight.slot, &prepared, &list, number);
                for (pass, patches) in prepared.passes.iter().enumerate() {
                    for (patch, record) in flight.slot.decided(pass, number).iter().enumerate() {
                        let outline = &prepared.outline;
                        let twin = decision.levels(
                            outline,
                            patches,
                            patch,
                            &positions,
                            deep,
                            &seen(&view),
                        );
                        let twin = twin.expect("there is such a patch");
                        assert!(
                            are_alike((record.edges, record.inside), &twin, true),
                            "{frame} {number} {patch}"
                        );
                    }
                }
            }
        }
        if frame < FRAMES {
            flight.send(|cmd, slot| {
                let drawing = Drawing {
                    tables,
                    pose,
                    slot,
                    sets: &[],
                };
                let decided = Decided {
                    views: 0..INSTANCES,
                    eyes: 1,
                };
                let on = (tables, pose);
                // SAFETY: all of one live device, in the order that the calls ask for.
                unsafe {
                    slot.cmd_prepare(device, cmd, &of_frame(frame))
                        .expect("there is room");
                    slot.cmd_decide(device, cmd, layout, &decide, on, &list, &decision, &decided)
                        .expect("the device decides");
                    gpu.target().begin(cmd, [0.0; 4]);
                    for batch in list.batches() {
                        let views = 0..INSTANCES;
                        let drawn = drawing.cmd_draw(device, cmd, layout, &pipelines, views, batch);
                        drawn.expect("all belong together");
                    }
                    gpu.target().end(cmd);
                }
            });
        }
    }
    drop((flights, pipelines, cached, decide));
    gpu.finish();
}
