//! What an engine brings along: a fragment shader, a pipeline layout, and sets.

use ash::vk;
use hullform::gpu::shaders::spirv;
use hullform::gpu::{
    Backend, Drawing, Fill, Fragment, Layout, OwnLayout, PipelineOptions, Pipelines, Shading,
    Target,
};
use hullform::method::METHODS;
use hullform::{Error, Misuse};

use crate::canvas::{Canvas, Part};
use crate::common::gpu::Gpu;
use crate::targets::{COLOURED, ONE, Scene, open};

/// A set of the engine's, and layouts that have it behind ours, and in front of them as well.
struct Own<'a> {
    gpu: &'a Gpu,
    set_layout: [vk::DescriptorSetLayout; 1],
    pool: vk::DescriptorPool,
    sets: Vec<vk::DescriptorSet>,
    behind: vk::PipelineLayout,
    around: vk::PipelineLayout,
}

impl<'a> Own<'a> {
    fn new(gpu: &'a Gpu) -> Own<'a> {
        let device = gpu.device.raw();
        let kind = vk::DescriptorType::UNIFORM_BUFFER;
        let binding = [vk::DescriptorSetLayoutBinding::default()
            .descriptor_type(kind)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::FRAGMENT)];
        let sizes = [vk::DescriptorPoolSize::default()
            .ty(kind)
            .descriptor_count(1)];
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&binding);
        // SAFETY: the device is live, here and below.
        let set_layout = unsafe { device.create_descriptor_set_layout(&info, None) };
        let set_layout = [set_layout.expect("it is small")];
        let info = vk::DescriptorPoolCreateInfo::default()
            .max_sets(1)
            .pool_sizes(&sizes);
        // SAFETY: as above.
        let pool = unsafe { device.create_descriptor_pool(&info, None) }.expect("it is small");
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(pool)
            .set_layouts(&set_layout);
        // SAFETY: as above.
        let sets = unsafe { device.allocate_descriptor_sets(&info) }.expect("the pool has one");
        let ours = gpu.layout().sets();
        let layout = |sets: &[vk::DescriptorSetLayout]| {
            let ranges = [Layout::push_constant_range()];
            let info = vk::PipelineLayoutCreateInfo::default()
                .set_layouts(sets)
                .push_constant_ranges(&ranges);
            // SAFETY: as above.
            unsafe { device.create_pipeline_layout(&info, None) }.expect("it is small")
        };
        Own {
            gpu,
            behind: layout(&[&ours[..], &set_layout].concat()),
            around: layout(&[&set_layout, &ours[..], &set_layout].concat()),
            set_layout,
            pool,
            sets,
        }
    }
}

impl Drop for Own<'_> {
    fn drop(&mut self) {
        let device = self.gpu.device.raw();
        // SAFETY: every submission has been waited for.
        unsafe {
            device.destroy_pipeline_layout(self.behind, None);
            device.destroy_pipeline_layout(self.around, None);
            device.destroy_descriptor_pool(self.pool, None);
            device.destroy_descriptor_set_layout(self.set_layout[0], None);
        }
    }
}

/// Draws a scene with the engine's set bound behind ours, and in front of them if so.
fn draw(scene: &Scene<'_>, own: &Own<'_>, canvas: &Canvas<'_>, pipelines: &Pipelines, front: bool) {
    let gpu = scene.gpu;
    let device = gpu.device.raw();
    let drawing = Drawing {
        sets: &own.sets,
        ..scene.drawing()
    };
    // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
    let drawn = gpu.device.submit(|cmd| unsafe {
        let surface = scene.loaded.surface();
        surface.cmd_prepare(device, cmd, &scene.views)?;
        let none = vk::RenderingFlags::empty();
        canvas.begin(cmd, &[Part::Colour, Part::Depth], 1.0, 0, none);
        if front {
            let graphics = vk::PipelineBindPoint::GRAPHICS;
            device.cmd_bind_descriptor_sets(cmd, graphics, own.around, 0, &own.sets, &[]);
        }
        for batch in scene.batches() {
            drawing.cmd_draw(device, cmd, gpu.layout(), pipelines, 0..9, batch)?;
        }
        canvas.end(cmd, Part::Colour);
        Ok(())
    });
    drawn.expect("it is executed");
}

/// A module of the engine's, here ours with constants of its own, and a layout with a set more, which `Drawing` binds.
#[test]
fn an_engine_brings_its_own_fragment_shader_and_sets() {
    let Some(gpu) = open() else { return };
    let canvas = Canvas::new(&gpu, ONE, 1);
    let scene = Scene::new(&gpu, Backend::Tessellator);
    let right = scene.classic(Shading::Normal);
    let device = gpu.device.raw();
    let last = METHODS.last().expect("there are methods").name;
    let words = spirv(&format!("{last}.frag")).expect("it ships");
    let info = vk::ShaderModuleCreateInfo::default().code(words);
    // SAFETY: the device is live.
    let module = unsafe { device.create_shader_module(&info, None) }.expect("a module");
    let shading = hullform::abi::SHADING_NORMAL.to_ne_bytes();
    let entries = [vk::SpecializationMapEntry::default().size(4)];
    let constants = vk::SpecializationInfo::default()
        .map_entries(&entries)
        .data(&shading);
    let own = Own::new(&gpu);
    let lit = scene.options(Target::new(COLOURED), Fill::Solid(Shading::Lit));
    let options = PipelineOptions {
        fragment: Some(Fragment {
            module,
            constants: Some(&constants),
            tangents: false,
        }),
        sub_patches: false,
        layout: Some(OwnLayout {
            raw: own.behind,
            first_set: 0,
        }),
        ..lit
    };
    let pipelines = scene.build(gpu.layout(), &options).expect("it can");
    draw(&scene, &own, &canvas, &pipelines, false);
    assert!(canvas.pixels() == right);

    // Pipelines without such a layout have no place for the set.
    let ours = scene.build(gpu.layout(), &lit).expect("it can");
    let drawing = Drawing {
        sets: &own.sets,
        ..scene.drawing()
    };
    let batch = scene.batches().next().expect("it has patches");
    // SAFETY: recording on the device that made everything; what is refused records nothing.
    let refused = gpu.device.submit(|cmd| unsafe {
        let surface = scene.loaded.surface();
        surface.cmd_prepare(device, cmd, &scene.views)?;
        drawing.cmd_draw(device, cmd, gpu.layout(), &ours, 0..9, batch)
    });
    assert!(matches!(refused, Err(Error::Misuse(Misuse::OwnSets))));
    // SAFETY: every submission has been waited for.
    unsafe {
        pipelines.destroy(device);
        ours.destroy(device);
        device.destroy_shader_module(module, None);
    }
    drop((own, scene, canvas));
    gpu.finish();
}

/// An engine that keeps set 0 for itself has ours behind it, and more of its own behind these.
#[test]
fn our_sets_move_behind_the_engines() {
    let Some(gpu) = open() else { return };
    let canvas = Canvas::new(&gpu, ONE, 1);
    let own = Own::new(&gpu);
    for backend in [Backend::Tessellator, Backend::Pattern] {
        let scene = Scene::new(&gpu, backend);
        let right = scene.classic(Shading::Patch);
        let options = PipelineOptions {
            sub_patches: false,
            layout: Some(OwnLayout {
                raw: own.around,
                first_set: 1,
            }),
            ..scene.options(Target::new(COLOURED), Fill::Solid(Shading::Patch))
        };
        let pipelines = scene.build(gpu.layout(), &options).expect("it can");
        draw(&scene, &own, &canvas, &pipelines, true);
        assert!(canvas.pixels() == right, "{backend:?}");
        // SAFETY: every submission has been waited for.
        unsafe { pipelines.destroy(gpu.device.raw()) };
    }
    drop((own, canvas));
    gpu.finish();
}
