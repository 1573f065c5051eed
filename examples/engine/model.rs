//! A model: what is shared by its instances, what each frame in flight has of its own, and how it is drawn in each pass.

use std::error::Error;
use std::ops::Range;

use ash::vk;
use hullform::gpu::{
    Attachments, CachePipelines, Cut, DepthBias, DrawList, Drawing, Fill, Fragment, FrameSlot,
    Layout, OwnLayout, PipelineOptions, Pipelines, Pose, Residence, Shading, SurfaceOptions,
    Tables, Target,
};
use hullform::mesh::Model as Mesh;
use hullform::method::{MethodOptions, method};
use hullform::subdivision::LimitSurface;
use hullform::tessellation::Spacing;

use crate::gpu::{Gpu, Held};
use crate::images::{COLOUR, DEPTH, Images, SAMPLES, SHADOW};
use crate::material::{Light, Material, Materials};
use crate::scene::{INSTANCES, LEVELS, Placed, Shape};
use crate::skin::Skin;

/// Frames that are recorded while earlier ones are still drawn.
pub const FRAMES: usize = 2;

/// The passes of a frame.
#[derive(Clone, Copy)]
pub enum Pass {
    Shadows,
    Depths,
    Picture,
}

/// What hullform draws a model with.
pub struct Model<'g> {
    gpu: &'g Gpu,
    layout: &'g Layout,
    tables: Held<'g, Tables>,
    pose: Held<'g, Pose>,
    caching: Held<'g, CachePipelines>,
    /// By pass.
    pipelines: [Held<'g, Pipelines>; 3],
    /// Of the levels from the deepest on; plain values that stay as long as the levels do.
    lists: Vec<DrawList>,
    frames: Vec<InFlight<'g>>,
    skin: Option<Skin<'g>>,
    pub shape: Shape,
}

/// What a frame in flight has of its own.
struct InFlight<'g> {
    slot: Held<'g, FrameSlot>,
    material: Material<'g>,
    levels: [Range<u32>; 4],
}

impl<'g> Model<'g> {
    pub fn new(
        gpu: &'g Gpu,
        layout: &'g Layout,
        materials: &Materials<'g>,
        images: &Images<'g>,
        mesh: &Mesh,
        name: &str,
    ) -> Result<Model<'g>, Box<dyn Error>> {
        let prepared = method(name)?.prepare(mesh, MethodOptions::default())?;
        let shape = shape(mesh);
        let levels = &LEVELS[shape.deepest()..];
        let options = SurfaceOptions {
            residence: Residence::Cache,
            greatest_level: levels[0],
            views: 2 * INSTANCES,
            ..SurfaceOptions::default()
        };
        let (device, cache) = (&gpu.device, vk::PipelineCache::null());
        let allocator = || gpu.allocator();
        // SAFETY: layout and allocator are of this device, here and below; see `Gpu::buffer` for the end.
        let tables = unsafe { Tables::new(device, &mut allocator(), layout, prepared, &options)? };
        let tables = gpu.hold(tables, |gpu, tables| {
            // SAFETY: as above, here and in all such functions.
            unsafe { tables.destroy(&gpu.device, &mut gpu.allocator()) };
        });
        let rest = mesh.positions();
        // SAFETY: as above.
        let pose =
            unsafe { Pose::new(device, &mut allocator(), layout, &tables, &rest, &options)? };
        let pose = gpu.hold(pose, |gpu, pose| {
            // SAFETY: as above.
            unsafe { pose.destroy(&gpu.device, &mut gpu.allocator()) };
        });
        // SAFETY: as above.
        let caching = unsafe { CachePipelines::new(device, layout, cache, tables.prepared())? };
        let caching = gpu.hold(caching, |gpu, caching| {
            // SAFETY: as above.
            unsafe { caching.destroy(&gpu.device) };
        });
        let mut frames = Vec::new();
        for _ in 0..FRAMES {
            let known = &gpu.workarounds;
            // SAFETY: as above.
            let slot = unsafe {
                FrameSlot::new(device, &mut allocator(), layout, &tables, known, options)?
            };
            frames.push(InFlight {
                slot: gpu.hold(slot, |gpu, slot| {
                    // SAFETY: as above.
                    unsafe { slot.destroy(&gpu.device, &mut gpu.allocator()) };
                }),
                material: materials.material(images, INSTANCES)?,
                levels: [(); 4].map(|()| 0..0),
            });
        }
        let list = |level| {
            let cut = Cut {
                level,
                spacing: Spacing::FractionalEven,
            };
            frames[0].slot.draw_list(&tables, cut, None)
        };
        let lists = levels.iter().copied().map(list);
        let lists = lists.collect::<Result<_, _>>()?;
        let build = |pass| pipelines(gpu, layout, materials, &tables, pass);
        Ok(Model {
            gpu,
            layout,
            pipelines: [
                build(Pass::Shadows)?,
                build(Pass::Depths)?,
                build(Pass::Picture)?,
            ],
            tables,
            pose,
            caching,
            lists,
            frames,
            skin: None,
            shape,
        })
    }

    /// The same with a skin.
    pub fn skinned(mut self, mesh: &Mesh) -> Result<Model<'g>, Box<dyn Error>> {
        self.skin = Some(Skin::new(self.gpu, &self.pose, &mesh.positions())?);
        Ok(self)
    }

    /// Records what comes before all rendering; how many control points are computed.
    ///
    /// # Safety
    /// `cmd` is recording on the device, outside of rendering; the frame that used this slot last is over.
    pub unsafe fn cmd_prepare(
        &mut self,
        cmd: vk::CommandBuffer,
        frame: usize,
        light: &Light,
        placed: &Placed,
        angle: Option<f32>,
    ) -> Result<u32, Box<dyn Error>> {
        let device = &self.gpu.device;
        let own = &mut self.frames[frame];
        own.material.write(light, &placed.instances)?;
        own.levels.clone_from(&placed.levels);
        // The points of the deepest level that is drawn serve all.
        let levels = &placed.levels[self.shape.deepest()..];
        let deepest = levels.iter().position(|range| !range.is_empty());
        let list = &self.lists[deepest.unwrap_or(0)];
        // SAFETY: this function's contract. The first time everything is uploaded, afterwards nothing.
        unsafe {
            self.tables.cmd_upload(device, cmd);
            self.pose.cmd_upload(device, cmd);
            if let Some((skin, angle)) = self.skin.as_ref().zip(angle) {
                skin.cmd_bend(cmd, &mut self.pose, angle);
            }
            let (layout, caching, tables) = (self.layout, &self.caching, &self.tables);
            let points = self
                .pose
                .cmd_cache(device, cmd, layout, caching, tables, list)?;
            own.slot.cmd_prepare(device, cmd, &placed.views)?;
            Ok(points)
        }
    }

    /// Records the draws of a pass: how many there are depends on levels and batches, not on instances.
    ///
    /// # Safety
    /// `cmd` is recording on the device, inside the pass's rendering, after [`cmd_prepare`](Self::cmd_prepare) for the same frame.
    pub unsafe fn cmd_draw(
        &self,
        cmd: vk::CommandBuffer,
        frame: usize,
        pass: Pass,
    ) -> hullform::Result<usize> {
        let own = &self.frames[frame];
        let drawing = Drawing {
            tables: &self.tables,
            pose: &self.pose,
            slot: &own.slot,
            sets: match pass {
                Pass::Picture => &own.material.set,
                Pass::Shadows | Pass::Depths => &[],
            },
        };
        // The sun's views come behind the camera's.
        let instances = own.levels.iter().map(|range| range.end).max().unwrap_or(0);
        let first = match pass {
            Pass::Shadows => instances,
            Pass::Depths | Pass::Picture => 0,
        };
        let (device, pipelines) = (&self.gpu.device, &self.pipelines[pass as usize]);
        let mut draws = 0;
        for (list, range) in self.lists.iter().zip(&own.levels[self.shape.deepest()..]) {
            if range.is_empty() {
                continue;
            }
            for batch in list.batches() {
                let views = first + range.start..first + range.end;
                // SAFETY: this function's contract; a cache needs no barriers between batches.
                unsafe { drawing.cmd_draw(device, cmd, self.layout, pipelines, views, batch)? };
                draws += batch.draws().len();
            }
        }
        Ok(draws)
    }

    /// Gives back what tables were staged in.
    ///
    /// # Safety
    /// The first frame is over.
    pub unsafe fn finish_upload(&mut self) {
        let allocator = &mut self.gpu.allocator();
        // SAFETY: this function's contract.
        unsafe { self.tables.finish_upload(&self.gpu.device, allocator) };
    }

    /// Bytes on the device: tables, pose, slots, and the skin's.
    pub fn bytes(&self) -> [u64; 4] {
        let slots = self.frames.iter().map(|frame| frame.slot.bytes()).sum();
        let skin = self.skin.as_ref().map_or(0, Skin::bytes);
        [self.tables.bytes(), self.pose.bytes(), slots, skin]
    }
}

fn pipelines<'g>(
    gpu: &'g Gpu,
    layout: &Layout,
    materials: &Materials<'_>,
    tables: &Tables,
    pass: Pass,
) -> Result<Held<'g, Pipelines>, Box<dyn Error>> {
    let attachments = |colours, depth| Attachments::Dynamic {
        colours,
        depth,
        stencil: vk::Format::UNDEFINED,
    };
    let (depths, colours) = (attachments(&[], DEPTH), attachments(&[COLOUR], DEPTH));
    let (target, fill) = match pass {
        Pass::Shadows => {
            let bias = DepthBias {
                constant: 4.0,
                slope: 3.0,
            };
            let target = Target::new(attachments(&[], SHADOW));
            (Target { bias, ..target }, Fill::Depth)
        }
        Pass::Depths => {
            let target = Target {
                samples: SAMPLES,
                compare: vk::CompareOp::GREATER_OR_EQUAL,
                ..Target::new(depths)
            };
            (target, Fill::Depth)
        }
        Pass::Picture => {
            let target = Target {
                samples: SAMPLES,
                compare: vk::CompareOp::EQUAL,
                ..Target::new(colours)
            };
            (target, Fill::Solid(Shading::Lit))
        }
    };
    let own = matches!(pass, Pass::Picture).then(|| Fragment {
        module: *materials.fragment,
        constants: None,
        tangents: true,
    });
    let layout_of = own.map(|_| OwnLayout {
        raw: *materials.layout,
        first_set: 0,
    });
    let options = PipelineOptions {
        target,
        backend: SurfaceOptions::default().backend,
        residence: Residence::Cache,
        spacing: Spacing::FractionalEven,
        fill,
        fragment: own,
        sub_patches: false,
        layout: layout_of,
    };
    let (device, cache) = (&gpu.device, vk::PipelineCache::null());
    // SAFETY: all of one live device.
    let made = unsafe { Pipelines::new(device, layout, cache, tables.prepared(), &options)? };
    Ok(gpu.hold(made, |gpu, pipelines| {
        // SAFETY: see `Gpu::buffer`.
        unsafe { pipelines.destroy(&gpu.device) };
    }))
}

/// The bounding box of the limits of all vertices.
fn shape(mesh: &Mesh) -> Shape {
    let surface = LimitSurface::new(mesh.mesh());
    let placement = mesh.placement();
    let limits = (0..surface.ptex_count()).filter_map(|ptex| surface.evaluate(ptex, 0.0, 0.0));
    let limits = limits.map(|sample| placement.local(sample.position).as_vec3());
    let mut shape = Shape {
        low: glam::Vec3::INFINITY,
        high: glam::Vec3::NEG_INFINITY,
        faces: surface.ptex_count(),
    };
    for limit in limits {
        (shape.low, shape.high) = (shape.low.min(limit), shape.high.max(limit));
    }
    shape
}
