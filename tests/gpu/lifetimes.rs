//! Tables, poses and frame slots by themselves: instances share what topology decides, and frames in flight write nothing of each other's.

use ash::vk;
use glam::Vec3;
use hullform::abi::Captured;
use hullform::gpu::{
    Backend, CachePipelines, Cut, DrawList, Drawing, Fill, FrameSlot, Handover, Pose, Residence,
    SurfaceOptions, Tables, View,
};
use hullform::mesh::Model;
use hullform::method::{DepthTags, Displacement, Prepared};
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};

use crate::common::gpu::{Gpu, bits, capturing, cut, prepare};
use crate::shapes;

const NOWHERE: View = View {
    clip_from_model: [[0.0; 4]; 4],
    eye: [0.0; 3],
    displacement: Displacement {
        height: 0.0,
        frequency: 0.0,
    },
};

/// Two instances of one model, each in a pose and with a slot of its own.
struct Scene<'a> {
    gpu: &'a Gpu,
    options: SurfaceOptions,
    tables: Option<Tables>,
    instances: Vec<(Pose, FrameSlot)>,
}

impl<'a> Scene<'a> {
    fn new(
        gpu: &'a Gpu,
        prepared: Prepared,
        poses: &[Vec<Vec3>],
        options: SurfaceOptions,
    ) -> Scene<'a> {
        let (device, layout) = (gpu.device.raw(), gpu.layout());
        let allocator = &mut gpu.device.allocator();
        let workarounds = &gpu.device.info().workarounds;
        // SAFETY: all of one live device.
        let made = unsafe {
            let mut tables =
                Tables::new(device, allocator, layout, prepared, &options).expect("it fits");
            let instances = poses.iter().map(|positions| {
                let pose = Pose::new(device, allocator, layout, &tables, positions, &options);
                let slot = FrameSlot::new(device, allocator, layout, &tables, workarounds, options);
                (pose.expect("it fits"), slot.expect("it fits"))
            });
            let mut instances: Vec<_> = instances.collect();
            // As from a queue of another family: with one alone, what is handed over stays where it is.
            let family = gpu.device.queue_family();
            let handover = Handover {
                from: family,
                to: family,
            };
            let uploaded = gpu.device.submit(|cmd| {
                assert!(tables.cmd_upload_and_release(device, cmd, handover));
                assert!(!tables.cmd_upload_and_release(device, cmd, handover));
                for (pose, _) in &mut instances {
                    assert!(pose.cmd_upload_and_release(device, cmd, handover));
                }
                Ok(())
            });
            uploaded.expect("it is executed");
            let acquired = gpu.device.submit(|cmd| {
                tables.cmd_acquire(device, cmd, handover);
                for (pose, _) in &instances {
                    pose.cmd_acquire(device, cmd, handover);
                }
                Ok(())
            });
            acquired.expect("it is executed");
            tables.finish_upload(device, allocator);
            (tables, instances)
        };
        Scene {
            gpu,
            options,
            tables: Some(made.0),
            instances: made.1,
        }
    }

    fn tables(&self) -> &Tables {
        self.tables.as_ref().expect("there from new to drop")
    }

    fn drawing(&self, pose: usize, slot: usize) -> Drawing<'_> {
        Drawing {
            tables: self.tables(),
            pose: &self.instances[pose].0,
            slot: &self.instances[slot].1,
            sets: &[],
        }
    }

    /// A draw list a slot, brought to the device, with control points in their caches.
    fn decide(&mut self, cuts: &[(Cut, Option<DepthTags>)]) -> Vec<DrawList> {
        let device = self.gpu.device.raw();
        let layout = self.gpu.layout();
        let tables = self.tables.as_ref().expect("there from new to drop");
        let cache = vk::PipelineCache::null();
        let lists = self
            .instances
            .iter_mut()
            .zip(cuts)
            .map(|((pose, slot), (cut, tags))| {
                let list = slot.draw_list(tables, *cut, tags.as_ref()).expect("a cut");
                // SAFETY: all of one live device; every submission is waited for.
                unsafe {
                    let allocator = &mut self.gpu.device.allocator();
                    let written = slot.write_draws(device, allocator, tables, &list);
                    written.expect("it is this slot's");
                    if self.options.residence == Residence::Cache {
                        let prepared = tables.prepared();
                        let pipelines = CachePipelines::new(device, layout, cache, prepared);
                        let pipelines = pipelines.expect("the shipped modules make pipelines");
                        let filled = self.gpu.device.submit(|cmd| {
                            pose.cmd_cache(device, cmd, layout, &pipelines, tables, &list)
                        });
                        filled.expect("there is room");
                        pipelines.destroy(device);
                    }
                }
                list
            });
        lists.collect()
    }

    /// Draws all instances in one submission, pass by pass; what each of them captured.
    fn draw(&self, lists: &[DrawList], spacing: Spacing) -> Vec<Vec<Vec<Captured>>> {
        let (gpu, prepared) = (self.gpu, self.tables().prepared());
        let device = gpu.device.raw();
        let makers = (Backend::Tessellator, self.options.residence);
        let compare = vk::CompareOp::LESS_OR_EQUAL;
        let pipelines = gpu.build(prepared, makers, spacing, Fill::Discard, compare);
        let mut captured = vec![Vec::new(); lists.len()];
        for pass in 0..prepared.passes.len() {
            // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
            let drawn = gpu.device.submit(|cmd| unsafe {
                for (_, slot) in &self.instances {
                    slot.cmd_prepare(device, cmd, &[NOWHERE])?;
                }
                gpu.target().begin(cmd, [0.0; 4]);
                for (number, list) in lists.iter().enumerate() {
                    let drawing = self.drawing(number, number);
                    for batch in list.batches().filter(|batch| batch.pass() == pass) {
                        drawing.cmd_draw(device, cmd, gpu.layout(), &pipelines, 0..1, batch)?;
                    }
                }
                gpu.target().end(cmd);
                for (_, slot) in &self.instances {
                    slot.cmd_read_back(device, cmd);
                }
                Ok(())
            });
            drawn.expect("it is executed");
            for (captured, (_, slot)) in captured.iter_mut().zip(&self.instances) {
                let mut vertices = slot.captured().expect("it was read back").to_vec();
                vertices.sort_unstable_by_key(bits);
                vertices.dedup_by_key(|vertex| bits(vertex));
                captured.push(vertices);
            }
        }
        captured
    }
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        let device = self.gpu.device.raw();
        let allocator = &mut self.gpu.device.allocator();
        // SAFETY: every submission has been waited for.
        unsafe {
            for (pose, slot) in self.instances.drain(..) {
                pose.destroy(device, allocator);
                slot.destroy(device, allocator);
            }
            if let Some(tables) = self.tables.take() {
                tables.destroy(device, allocator);
            }
        }
    }
}

fn bent(model: &Model) -> Vec<Vec3> {
    let bend = |p: &Vec3| *p + Vec3::new(0.0, 0.3 * p.x * p.x, 0.1 * p.y);
    model.positions().iter().map(bend).collect()
}

/// Two poses at two cuts, one with depth tags, in one submission: each as if it were alone.
#[test]
fn instances_share_tables_and_nothing_else() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let prepared = prepare(&model, "quadtree");
    let deep = cut(6.0, Spacing::Equal);
    let mut tags = DepthTags::default();
    let count = model.positions().len();
    tags.depths = (0..count)
        .map(|vertex| 3.0 * vertex as f32 / count as f32)
        .collect();
    let cuts = [(deep, None), (cut(4.0, Spacing::Equal), Some(tags))];
    let poses = [model.positions(), bent(&model)];
    for residence in Residence::ALL {
        let options = SurfaceOptions {
            residence,
            ..capturing(&prepared, &[deep])
        };
        let mut scene = Scene::new(&gpu, prepared.clone(), &poses, options);
        let lists = scene.decide(&cuts);
        let together = scene.draw(&lists, Spacing::Equal);
        for (number, together) in together.iter().enumerate() {
            let pose = std::slice::from_ref(&poses[number]);
            let mut alone = Scene::new(&gpu, prepared.clone(), pose, options);
            let lists = alone.decide(&cuts[number..=number]);
            let alone = alone.draw(&lists, Spacing::Equal).remove(0);
            assert!(alone.iter().map(Vec::len).sum::<usize>() > 3000);
            for (own, right) in together.iter().zip(&alone) {
                let same = own.iter().map(bits).eq(right.iter().map(bits));
                assert!(same, "{residence:?}, instance {number}");
            }
        }
    }
    gpu.finish();
}

#[test]
fn what_does_not_belong_together_is_not_drawn() {
    let Some(gpu) = Gpu::open() else { return };
    let at = cut(2.0, Spacing::Equal);
    let scenes = ["hull", "ngons"].map(|name| {
        let model = shapes::built_in(name);
        let prepared = prepare(&model, "quadtree");
        let options = capturing(&prepared, &[at]);
        Scene::new(&gpu, prepared, &[model.positions()], options)
    });
    let [one, other] = &scenes;
    let (pose, slot) = (&one.instances[0].0, &one.instances[0].1);
    let list = slot.draw_list(one.tables(), at, None).expect("a cut");
    assert!(slot.draw_list(other.tables(), at, None).is_err());
    let device = gpu.device.raw();
    let compare = vk::CompareOp::LESS_OR_EQUAL;
    let makers = (Backend::Tessellator, Residence::Ring);
    let prepared = one.tables().prepared();
    let pipelines = gpu.build(prepared, makers, at.spacing, Fill::Discard, compare);
    let batch = list.batches().next().expect("it has patches");
    // SAFETY: recording on the device that made everything; what is refused records nothing.
    let refused = |drawing: Drawing<'_>, views: &[View], view: u32| unsafe {
        let drawn = gpu.device.submit(|cmd| {
            drawing.slot.cmd_prepare(device, cmd, views)?;
            gpu.target().begin(cmd, [0.0; 4]);
            let drawn =
                drawing.cmd_draw(device, cmd, gpu.layout(), &pipelines, view..view + 1, batch);
            gpu.target().end(cmd);
            drawn
        });
        match drawn {
            Err(Error::Misuse(misuse)) => Some(misuse),
            Err(other) => panic!("{other}"),
            Ok(()) => None,
        }
    };
    let right = one.drawing(0, 0);
    let strange = Drawing {
        pose: &other.instances[0].0,
        ..right
    };
    assert_eq!(refused(strange, &[NOWHERE], 0), Some(Misuse::OtherSurface));
    let strange = Drawing {
        slot: &other.instances[0].1,
        ..right
    };
    assert_eq!(refused(strange, &[NOWHERE], 0), Some(Misuse::OtherSurface));
    let strange = Drawing {
        tables: other.tables(),
        pose,
        slot,
        sets: &[],
    };
    assert_eq!(refused(strange, &[NOWHERE], 0), Some(Misuse::OtherSurface));
    let view = |view, views| Some(Misuse::View { view, views });
    assert_eq!(refused(right, &[NOWHERE], 1), view(1, 1));
    assert_eq!(refused(right, &[], 0), view(0, 0));
    assert_eq!(refused(right, &[NOWHERE; 65], 0), view(64, 64));
    assert_eq!(refused(right, &[NOWHERE; 64], 63), None);
    drop(pipelines);
    drop(scenes);
    gpu.finish();
}
