//! Tangents as a fragment shader of an engine's own gets them: those of the twin, by all methods, back-ends and residences.

use std::collections::BTreeMap;

use ash::vk;
use glam::Vec3;
use hullform::gpu::shaders::spirv;
use hullform::gpu::{
    Backend, DrawList, Fill, Fragment, PipelineOptions, Pipelines, Residence, Shading,
    SurfaceOptions, Target, View,
};
use hullform::mesh::{Model, Scheme, builtin};
use hullform::method::{Displacement, METHODS, Method, MethodOptions};
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};

use crate::canvas::{Canvas, Part};
use crate::common::gpu::{Gpu, Loaded, SIDE, cut};
use crate::shapes;
use crate::targets::{COLOURED, ONE, open};

/// What `glsl/conformance/tangents.frag` tells.
const NUMBERS: u32 = 12;

/// What a pixel was drawn from.
struct Seen {
    patch: usize,
    uv: [f32; 2],
    normal: Vec3,
    tangents: [Vec3; 2],
}

/// The fragment shader.
struct Teller<'a> {
    gpu: &'a Gpu,
    canvas: Canvas<'a>,
    module: vk::ShaderModule,
}

impl<'a> Teller<'a> {
    fn new(gpu: &'a Gpu) -> Teller<'a> {
        let words = spirv("conformance.tangents.frag").expect("it ships");
        let info = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the device is live.
        let module = unsafe { gpu.device.raw().create_shader_module(&info, None) };
        Teller {
            gpu,
            canvas: Canvas::new(gpu, ONE, 1),
            module: module.expect("a module"),
        }
    }

    /// Pipelines that tell one of the numbers.
    fn pipelines(
        &self,
        loaded: &Loaded<'_>,
        spacing: Spacing,
        which: u32,
    ) -> Result<Pipelines, Error> {
        let options = loaded.surface().options();
        let which = which.to_ne_bytes();
        let entries = [vk::SpecializationMapEntry::default().size(4)];
        let constants = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(&which);
        let options = PipelineOptions {
            target: Target::new(COLOURED),
            backend: options.backend,
            residence: options.residence,
            spacing,
            fill: Fill::Solid(Shading::Lit),
            fragment: Some(Fragment {
                module: self.module,
                constants: Some(&constants),
                tangents: true,
            }),
            sub_patches: false,
            layout: None,
        };
        let (device, prepared) = (self.gpu.device.raw(), loaded.prepared());
        let cache = vk::PipelineCache::null();
        // SAFETY: all of one live device.
        unsafe { Pipelines::new(device, self.gpu.layout(), cache, prepared, &options) }
    }

    /// Draws the batches of a pass, and reads one number a pixel.
    fn number(
        &self,
        loaded: &Loaded<'_>,
        list: &DrawList,
        pass: usize,
        view: View,
        which: u32,
    ) -> Vec<f32> {
        let spacing = list.cut().spacing;
        let pipelines = self.pipelines(loaded, spacing, which).expect("it can");
        let device = self.gpu.device.raw();
        // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
        let drawn = self.gpu.device.submit(|cmd| unsafe {
            let surface = loaded.surface();
            surface.cmd_prepare(device, cmd, &[view])?;
            let parts = [Part::Colour, Part::Depth];
            self.canvas
                .begin(cmd, &parts, 1.0, 0, vk::RenderingFlags::empty());
            for batch in list.batches().filter(|batch| batch.pass() == pass) {
                surface.cmd_draw(device, cmd, self.gpu.layout(), &pipelines, 0..1, batch)?;
            }
            self.canvas.end(cmd, Part::Colour);
            Ok(())
        });
        drawn.expect("it is executed");
        // SAFETY: every submission has been waited for.
        unsafe { pipelines.destroy(device) };
        self.canvas.depths()
    }

    /// All that is seen of a pass.
    fn look(&self, loaded: &Loaded<'_>, list: &DrawList, pass: usize, view: View) -> Vec<Seen> {
        let number = |which| self.number(loaded, list, pass, view, which);
        let numbers: Vec<Vec<f32>> = (0..NUMBERS).map(number).collect();
        let pixels = 0..(SIDE * SIDE) as usize;
        let drawn = pixels.filter(|&pixel| numbers[0][pixel] != 0.0);
        let seen = drawn.map(|pixel| {
            let at = |which: usize| numbers[which][pixel];
            let vector = |first| Vec3::new(at(first), at(first + 1), at(first + 2));
            Seen {
                patch: at(0) as usize - 1,
                uv: [at(1), at(2)],
                normal: vector(3),
                tangents: [vector(6), vector(9)],
            }
        });
        seen.collect()
    }
}

impl Drop for Teller<'_> {
    fn drop(&mut self) {
        // SAFETY: every submission has been waited for.
        unsafe {
            self.gpu
                .device
                .raw()
                .destroy_shader_module(self.module, None)
        };
    }
}

/// A model under the first scheme that a method knows.
fn model(method: &Method, name: &str) -> Option<Model> {
    let mesh = builtin(name).expect("it is built in");
    let scheme = *method
        .schemes
        .iter()
        .find(|&&scheme| scheme != Scheme::Bilinear)?;
    let model = shapes::under(&mesh, scheme)?;
    method.check_model(&model).is_ok().then_some(model)
}

/// Every way in which something with these passes is drawn, tangents included.
fn ways(has_ring: bool) -> Vec<SurfaceOptions> {
    let all = Backend::ALL.into_iter().flat_map(|backend| {
        Residence::ALL.map(|residence| SurfaceOptions {
            backend,
            residence,
            ring_bytes: 1 << 22,
            greatest_level: 4.0,
            ..SurfaceOptions::default()
        })
    });
    all.filter(|way| match way.residence {
        Residence::Ring => !has_ring || way.backend.takes_ring(),
        Residence::Cache => has_ring,
    })
    .collect()
}

#[test]
fn tangents_are_the_twins_by_every_method_backend_and_residence() {
    let Some(gpu) = open() else { return };
    let teller = Teller::new(&gpu);
    let mut seen = BTreeMap::<String, usize>::new();
    for method in METHODS {
        let names: &[&str] = match method.name == METHODS[0].name {
            true => &["ngons", "creased-torus", "cube"],
            false => &["ngons"],
        };
        for name in names {
            let Some(model) = model(method, name) else {
                continue;
            };
            let prepared = method.prepare(&model, MethodOptions::default());
            let prepared = prepared.expect("it draws the model");
            if !prepared.passes.iter().all(|pass| pass.has_tangents()) {
                continue;
            }
            let has_ring = prepared.passes.iter().any(|pass| pass.cached.is_some());
            let controls = prepared.controls(model.positions());
            for way in ways(has_ring) {
                let what = format!("{} {} {:?}", method.name, way.backend.name(), way.residence);
                let loaded = gpu.load(&model, prepared.clone(), &[], way);
                let mut loaded = loaded.expect("it can");
                let list = loaded.draw_list(cut(4.0, Spacing::Equal)).expect("a cut");
                for number in 0..prepared.passes.len() {
                    let pass = &prepared.passes[number];
                    for point in teller.look(&loaded, &list, number, loaded.view) {
                        let levels = list.levels(&prepared, number, point.patch as u32);
                        let level = levels.expect("it is drawn").greatest();
                        let twin = pass.tangents(&controls, point.patch, point.uv.into(), level);
                        let twin = twin.expect("it has tangents");
                        let size = twin[0].length() + twin[1].length();
                        for (own, twin) in point.tangents.into_iter().zip(twin) {
                            let off = own.distance(twin);
                            assert!(
                                off <= 1e-4 * size.max(1e-3),
                                "{what}, {name}, {} {} at {:?}: {own}, and the twin has {twin}",
                                pass.shader,
                                point.patch,
                                point.uv
                            );
                        }
                        *seen.entry(format!("{what} {}", pass.shader)).or_default() += 1;
                    }
                }
            }
        }
    }
    for (what, pixels) in &seen {
        println!("{what}: {pixels}");
    }
    assert!(
        seen.len() > 25 && seen.values().sum::<usize>() > 10_000,
        "{seen:?}"
    );
    drop(teller);
    gpu.finish();
}

/// Bumps tilt both with the normal.
#[test]
fn tangents_follow_displacement() {
    let Some(gpu) = open() else { return };
    let teller = Teller::new(&gpu);
    let model = shapes::torus();
    let prepared = METHODS[0].prepare(&model, MethodOptions::default());
    let prepared = prepared.expect("it draws the model");
    let options = ways(false)[0];
    let loaded = gpu.load(&model, prepared, &[], options);
    let mut loaded = loaded.expect("it can");
    let list = loaded.draw_list(cut(4.0, Spacing::Equal)).expect("a cut");
    let mut view = loaded.view;
    let plain = teller.look(&loaded, &list, 0, view);
    view.displacement = Displacement {
        height: 0.05,
        frequency: 4.0,
    };
    let moved = teller.look(&loaded, &list, 0, view);
    let mut tilted = 0;
    for point in &moved {
        for tangent in point.tangents {
            let along = tangent.normalize().dot(point.normal);
            assert!(along.abs() < 1e-3, "{along} at {:?}", point.uv);
        }
        let same = |other: &&Seen| other.patch == point.patch && other.uv == point.uv;
        let before = plain.iter().find(same);
        tilted += usize::from(before.is_some_and(|before| before.normal.dot(point.normal) < 0.99));
    }
    assert!(moved.len() > 400 && tilted > 50, "{} {tilted}", moved.len());
    drop(loaded);
    drop(teller);
    gpu.finish();
}

/// 1024 components are room for so many rows.
#[test]
fn geometry_shaders_have_room_for_tangents_up_to_level_16() {
    let Some(gpu) = open() else { return };
    let teller = Teller::new(&gpu);
    let model = shapes::torus();
    let prepared = METHODS[0].prepare(&model, MethodOptions::default());
    let prepared = prepared.expect("it draws the model");
    let options = SurfaceOptions {
        backend: Backend::Geometry,
        greatest_level: 32.0,
        ..SurfaceOptions::default()
    };
    let mut loaded = gpu.load(&model, prepared, &[], options).expect("it can");
    let fine = loaded.draw_list(cut(32.0, Spacing::Equal)).expect("a cut");
    let pipelines = teller
        .pipelines(&loaded, Spacing::Equal, 0)
        .expect("it can");
    let device = gpu.device.raw();
    let batch = fine.batches().next().expect("it has patches");
    // SAFETY: recording on the device that made everything; what is refused records nothing.
    let refused = gpu.device.submit(|cmd| unsafe {
        let surface = loaded.surface();
        surface.cmd_prepare(device, cmd, &[loaded.view])?;
        surface.cmd_draw(device, cmd, gpu.layout(), &pipelines, 0..1, batch)
    });
    let (backend, greatest) = (Backend::Geometry.name(), 16.0);
    let level = Misuse::BackendLevel { backend, greatest };
    assert!(matches!(refused, Err(Error::Misuse(misuse)) if misuse == level));
    // SAFETY: every submission has been waited for.
    unsafe { pipelines.destroy(device) };
    let coarse = loaded.draw_list(cut(16.0, Spacing::Equal)).expect("a cut");
    assert!(teller.look(&loaded, &coarse, 0, loaded.view).len() > 400);
    drop(loaded);
    drop(teller);
    gpu.finish();
}
