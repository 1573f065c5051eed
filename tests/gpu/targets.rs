//! Whatever is drawn into, and however it is recorded: the same picture.

use std::ops::Range;

use ash::vk;
use hullform::gpu::{
    Attachments, Backend, Batch, DepthBias, DrawList, Drawing, Fill, Layout, PipelineOptions,
    Pipelines, Residence, Shading, Support, SurfaceOptions, Target, View,
};
use hullform::method::METHODS;
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};

use crate::canvas::{COLOUR, Canvas, DEPTH, Part};
use crate::common::gpu::{Gpu, Loaded, SIDE, cut, prepare};
use crate::instances::grid;
use crate::shapes;

const NONE: vk::RenderingFlags = vk::RenderingFlags::empty();
pub const ONE: vk::SampleCountFlags = vk::SampleCountFlags::TYPE_1;
pub const COLOURED: Attachments<'static> = Attachments::Dynamic {
    colours: &[COLOUR],
    depth: DEPTH,
    stencil: vk::Format::UNDEFINED,
};
const DEPTHS: Attachments<'static> = Attachments::Dynamic {
    colours: &[],
    depth: DEPTH,
    stencil: vk::Format::UNDEFINED,
};

/// A device that renders dynamically, or None with a line that says so.
pub fn open() -> Option<Gpu> {
    let gpu = Gpu::open()?;
    if gpu.device.info().support.optional.dynamic_rendering {
        return Some(gpu);
    }
    println!("skipped: no dynamic rendering");
    None
}

/// A model in nine views, with a list of all of it.
pub struct Scene<'a> {
    pub gpu: &'a Gpu,
    pub loaded: Loaded<'a>,
    list: DrawList,
    pub views: Vec<View>,
}

impl<'a> Scene<'a> {
    pub fn new(gpu: &'a Gpu, backend: Backend) -> Scene<'a> {
        let options = SurfaceOptions {
            backend,
            residence: Residence::Cache,
            greatest_level: 4.0,
            views: 18,
            ..SurfaceOptions::default()
        };
        let model = shapes::built_in("hull");
        let prepared = prepare(&model, METHODS[0].name);
        let workarounds = &gpu.device.info().workarounds;
        let loaded = gpu.load(&model, prepared, workarounds, options);
        let mut loaded = loaded.unwrap_or_else(|error| panic!("{error}"));
        let list = loaded.draw_list(cut(4.0, Spacing::Equal)).expect("a cut");
        Scene {
            gpu,
            loaded,
            list,
            views: grid(3),
        }
    }

    pub fn drawing(&self) -> Drawing<'_> {
        self.loaded.surface().drawing()
    }

    pub fn batches(&self) -> impl Iterator<Item = Batch<'_>> {
        self.list.batches()
    }

    pub fn build(
        &self,
        layout: &Layout,
        options: &PipelineOptions<'_>,
    ) -> Result<Pipelines, Error> {
        let device = self.gpu.device.raw();
        let (cache, prepared) = (vk::PipelineCache::null(), self.loaded.prepared());
        // SAFETY: all of one live device.
        unsafe { Pipelines::new(device, layout, cache, prepared, options) }
    }

    /// Pipelines of ours that fill.
    pub fn options<'t>(&self, target: Target<'t>, fill: Fill) -> PipelineOptions<'t> {
        let options = self.loaded.surface().options();
        PipelineOptions {
            target,
            backend: options.backend,
            residence: options.residence,
            spacing: self.list.cut().spacing,
            fill,
            fragment: None,
            sub_patches: false,
            layout: None,
        }
    }

    /// Draws views with dynamic rendering and copies a part.
    fn draw(
        &self,
        canvas: &Canvas<'_>,
        options: &PipelineOptions<'_>,
        (clear, part): (f32, Part),
        views: Range<u32>,
    ) {
        let gpu = self.gpu;
        let pipelines = self.build(gpu.layout(), options).expect("it can");
        let device = gpu.device.raw();
        let colours = options.target.attachments;
        let parts: &[Part] = match colours {
            Attachments::Dynamic { colours: [], .. } => &[Part::Depth],
            _ => &[Part::Colour, Part::Depth],
        };
        // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
        let drawn = gpu.device.submit(|cmd| unsafe {
            let slot = self.loaded.surface();
            slot.cmd_prepare(device, cmd, &self.views)?;
            canvas.begin(cmd, parts, clear, options.target.view_mask, NONE);
            for batch in self.batches() {
                let (drawing, views) = (self.drawing(), views.clone());
                drawing.cmd_draw(device, cmd, gpu.layout(), &pipelines, views, batch)?;
            }
            canvas.end(cmd, part);
            Ok(())
        });
        drawn.expect("it is executed");
        // SAFETY: every submission has been waited for.
        unsafe { pipelines.destroy(device) };
    }

    /// The picture that a classic render pass makes.
    pub fn classic(&self, shading: Shading) -> Vec<u8> {
        let gpu = self.gpu;
        let makers = (self.list.options().backend, Residence::Cache);
        let (compare, fill) = (vk::CompareOp::LESS_OR_EQUAL, Fill::Solid(shading));
        let prepared = self.loaded.prepared();
        let pipelines = gpu.build(prepared, makers, Spacing::Equal, fill, compare);
        let device = gpu.device.raw();
        // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
        let drawn = gpu.device.submit(|cmd| unsafe {
            self.loaded
                .surface()
                .cmd_prepare(device, cmd, &self.views)?;
            gpu.target().begin(cmd, [0.0; 4]);
            for batch in self.batches() {
                let drawing = self.drawing();
                drawing.cmd_draw(device, cmd, gpu.layout(), &pipelines, 0..9, batch)?;
            }
            gpu.target().end(cmd);
            gpu.target().cmd_copy_to_host(cmd);
            Ok(())
        });
        drawn.expect("it is executed");
        self.loaded.pixels()
    }
}

pub fn covered(picture: &[u8]) -> usize {
    picture.chunks(4).filter(|pixel| pixel[3] != 0).count()
}

#[test]
fn dynamic_rendering_makes_the_picture_of_a_render_pass() {
    let Some(gpu) = open() else { return };
    let canvas = Canvas::new(&gpu, ONE, 1);
    for backend in [Backend::Tessellator, Backend::Pattern] {
        let scene = Scene::new(&gpu, backend);
        let right = scene.classic(Shading::Lit);
        assert!(covered(&right) > 400, "{}", covered(&right));
        let fill = Fill::Solid(Shading::Lit);
        let options = scene.options(Target::new(COLOURED), fill);
        scene.draw(&canvas, &options, (1.0, Part::Colour), 0..9);
        assert!(canvas.pixels() == right, "{backend:?}");
        // Greater depths nearer, and the views' depths turned over.
        let mut scene = scene;
        for view in &mut scene.views {
            for column in &mut view.clip_from_model {
                column[2] = column[3] - column[2];
            }
        }
        let reversed = Target {
            compare: vk::CompareOp::GREATER_OR_EQUAL,
            ..Target::new(COLOURED)
        };
        let options = scene.options(reversed, fill);
        scene.draw(&canvas, &options, (0.0, Part::Colour), 0..9);
        let pixels = canvas.pixels();
        let differ = pixels.chunks(4).zip(right.chunks(4));
        let differ = differ.filter(|(a, b)| a != b).count();
        assert!(differ < 20, "{backend:?}: {differ} pixels");
    }
    drop(canvas);
    gpu.finish();
}

/// Four samples: the inside of what one sample shows is as it was, and edges are between.
#[test]
fn several_samples_are_resolved() {
    let Some(gpu) = open() else { return };
    let scene = Scene::new(&gpu, Backend::Tessellator);
    let samples = vk::SampleCountFlags::TYPE_4;
    let [one, four] = [ONE, samples].map(|samples| {
        let canvas = Canvas::new(&gpu, samples, 1);
        let target = Target {
            samples,
            ..Target::new(COLOURED)
        };
        let options = scene.options(target, Fill::Solid(Shading::Normal));
        scene.draw(&canvas, &options, (1.0, Part::Colour), 0..9);
        canvas.pixels()
    });
    let between = |picture: &[u8]| {
        let alphas = picture.chunks(4).map(|pixel| pixel[3]);
        alphas.filter(|&alpha| alpha != 0 && alpha != 255).count()
    };
    assert_eq!(between(&one), 0);
    assert!(between(&four) > 50, "{}", between(&four));
    let inside = |picture: &[u8]| picture.chunks(4).filter(|pixel| pixel[3] == 255).count();
    assert!(inside(&four) > 100, "{}", inside(&four));
    drop(scene);
    gpu.finish();
}

/// A shadow map: no colour attachment, no fragment shader, depths moved away by a bias, and the sides that face the eye left out.
#[test]
fn depths_alone_are_those_of_the_picture_and_can_be_moved() {
    let Some(gpu) = open() else { return };
    let canvas = Canvas::new(&gpu, ONE, 1);
    let scene = Scene::new(&gpu, Backend::Tessellator);
    let depths = |target: Target<'static>, fill| {
        let options = scene.options(target, fill);
        scene.draw(&canvas, &options, (1.0, Part::Depth), 0..9);
        canvas.depths()
    };
    let seen = depths(Target::new(COLOURED), Fill::Solid(Shading::Lit));
    let alone = depths(Target::new(DEPTHS), Fill::Depth);
    assert!(seen == alone, "depths differ");
    let (drawn, total) = (
        seen.iter().filter(|&&depth| depth < 1.0).count(),
        (SIDE * SIDE) as usize,
    );
    assert!(drawn > 400 && drawn < total, "{drawn}");
    let biased = Target {
        bias: DepthBias {
            constant: 1000.0,
            slope: 1.0,
        },
        ..Target::new(DEPTHS)
    };
    let moved = depths(biased, Fill::Depth);
    let farther = moved.iter().zip(&seen).filter(|(a, b)| a > b).count();
    assert!(farther > drawn * 9 / 10, "{farther} of {drawn}");
    // The model is closed but for its funnel: what is behind is behind.
    let back = Target {
        cull: vk::CullModeFlags::FRONT,
        ..Target::new(DEPTHS)
    };
    let behind = depths(back, Fill::Depth);
    let nearer = behind.iter().zip(&seen).filter(|(a, b)| a < b).count();
    assert_eq!(nearer, 0);
    drop(scene);
    drop(canvas);
    gpu.finish();
}

/// A layout for a device that shows no multi-draw: each command is then a call.
pub fn single_draws(gpu: &Gpu) -> Layout {
    let support: &Support = &gpu.device.info().support;
    let mut core = vk::PhysicalDeviceFeatures::default();
    let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default();
    support.require(&mut core, &mut vulkan12);
    core.multi_draw_indirect = vk::FALSE;
    let enabled = support.enabled(&core, &vulkan12).expect("all is on");
    // SAFETY: the device is live, and has more.
    unsafe { Layout::new(gpu.device.raw(), enabled) }.expect("every device has such layouts")
}

/// Two eyes an instance, a layer each: what a view mask draws at once is what either eye sees alone.
#[test]
fn with_multiview_every_eye_sees_its_own_views() {
    let Some(gpu) = open() else { return };
    if !gpu.device.info().support.optional.multiview {
        println!("skipped: no multiview");
        return gpu.finish();
    }
    let mut scene = Scene::new(&gpu, Backend::Tessellator);
    let half = |view: &View| View {
        eye: [-5.0, 3.0, 1.0],
        clip_from_model: view.clip_from_model.map(|[x, y, z, w]| [0.5 * x, y, z, w]),
        ..*view
    };
    let left = scene.views.clone();
    let right: Vec<View> = left.iter().map(half).collect();
    let fill = Fill::Solid(Shading::Lit);
    let mut alone = Vec::new();
    for views in [&left, &right] {
        scene.views.clone_from(views);
        let canvas = Canvas::new(&gpu, ONE, 1);
        let options = scene.options(Target::new(COLOURED), fill);
        scene.draw(&canvas, &options, (1.0, Part::Colour), 0..9);
        alone.extend(canvas.pixels());
    }
    scene.views = left
        .into_iter()
        .zip(right)
        .flat_map(<[View; 2]>::from)
        .collect();
    let canvas = Canvas::new(&gpu, ONE, 2);
    let both = Target {
        view_mask: 0b11,
        ..Target::new(COLOURED)
    };
    let options = scene.options(both, fill);
    scene.draw(&canvas, &options, (1.0, Part::Colour), 0..18);
    assert!(covered(&alone) > 500);
    assert!(canvas.pixels() == alone, "an eye sees something else");
    drop(canvas);

    let pipelines = scene.build(gpu.layout(), &options).expect("it can");
    let batch = scene.batches().next().expect("it has patches");
    let device = gpu.device.raw();
    // SAFETY: recording on the device that made everything; what is refused records nothing.
    let refused = gpu.device.submit(|cmd| unsafe {
        let surface = scene.loaded.surface();
        surface.cmd_prepare(device, cmd, &scene.views)?;
        let drawing = scene.drawing();
        drawing.cmd_draw(device, cmd, gpu.layout(), &pipelines, 0..17, batch)
    });
    let (views, eyes) = (17, 2);
    let eyes = Misuse::Eyes { views, eyes };
    assert!(matches!(refused, Err(Error::Misuse(misuse)) if misuse == eyes));
    let pattern = PipelineOptions {
        backend: Backend::Pattern,
        ..options
    };
    let refused = scene.build(gpu.layout(), &pattern);
    let backend = Backend::Pattern.name();
    let no_eyes = Misuse::MultiviewBackend { backend };
    assert!(matches!(refused, Err(Error::Misuse(misuse)) if misuse == no_eyes));
    // SAFETY: every submission has been waited for.
    unsafe { pipelines.destroy(device) };
    drop(scene);
    gpu.finish();
}

/// A ring that does not hold everything needs barriers, and dynamic rendering allows none; and a device that does not show the feature has none.
#[test]
fn dynamic_rendering_takes_no_barriers_and_needs_its_feature() {
    let Some(gpu) = open() else { return };
    let model = shapes::built_in("hull");
    let options = SurfaceOptions {
        ring_bytes: 1 << 15,
        greatest_level: 8.0,
        ..SurfaceOptions::default()
    };
    let prepared = prepare(&model, METHODS[0].name);
    let loaded = gpu.load(&model, prepared, &[], options);
    let mut loaded = loaded.expect("the ring holds a patch");
    let list = loaded.draw_list(cut(8.0, Spacing::Equal)).expect("a cut");
    let options = PipelineOptions {
        target: Target::new(COLOURED),
        backend: Backend::Tessellator,
        residence: Residence::Ring,
        spacing: Spacing::Equal,
        fill: Fill::Solid(Shading::Lit),
        fragment: None,
        sub_patches: false,
        layout: None,
    };
    let (device, cache) = (gpu.device.raw(), vk::PipelineCache::null());
    let prepared = loaded.prepared();
    let single = single_draws(&gpu);
    // SAFETY: all of one live device.
    let (refused, pipelines) = unsafe {
        let refused = Pipelines::new(device, &single, cache, prepared, &options);
        let built = Pipelines::new(device, gpu.layout(), cache, prepared, &options);
        single.destroy(device);
        (refused, built.expect("it can"))
    };
    let lacking = vec!["dynamicRendering".to_owned()];
    let features = Misuse::Features { lacking };
    assert!(matches!(refused, Err(Error::Misuse(misuse)) if misuse == features));
    let waiting = list.batches().find(Batch::waits);
    let waiting = waiting.expect("the ring is small");
    // SAFETY: recording on the device that made everything; what is refused records nothing.
    let refused = gpu.device.submit(|cmd| unsafe {
        let surface = loaded.surface();
        surface.cmd_prepare(device, cmd, &grid(1))?;
        surface.cmd_draw(device, cmd, gpu.layout(), &pipelines, 0..1, waiting)
    });
    assert!(matches!(
        refused,
        Err(Error::Misuse(Misuse::BarrierInRendering))
    ));
    // SAFETY: every submission has been waited for.
    unsafe { pipelines.destroy(device) };
    drop(loaded);
    gpu.finish();
}
