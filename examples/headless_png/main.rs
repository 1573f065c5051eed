//! How an engine brings hullform into its renderer: a picture, drawn with a device of the example's own, to `headless.png`.
//!
//! ```sh
//! cargo run --release --example headless_png -- [MODEL.obj]
//! VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation cargo run --release --example headless_png
//! ```
//!
//! Read it from top to bottom. Instance, device, queue, allocator, render pass and command buffer are the engine's, most of it in `engine.rs` beside this
//! file; the library never submits and never waits. Two places ask something of the engine: the features that the device is created with (step 2) and
//! one dependency in the render pass (step 4). Everything else is `cmd_*` calls into a command buffer that is recording anyway.
//!
//! Everything that is made is held by an `Own`, which destroys it at the end of its scope: in the opposite order, and after an error as well. An
//! engine has classes of its own for that.

mod engine;

use std::cell::RefCell;
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use ash::vk;
use engine::{Commands, HEIGHT, Own, Picture, WIDTH, failed, write_png};
use glam::{Mat4, Vec3};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use hullform::gpu::{
    Cut, Driver, FeatureChain, Fill, Layout, PipelineOptions, Pipelines, Shading, Support,
    SurfaceOptions, Target, TessellatedSurface, View, ring, workarounds,
};
use hullform::mesh::{DEFAULT_BUILTIN, Model, builtin, read_obj};
use hullform::method::{Displacement, MethodOptions, method};
use hullform::tessellation::Spacing;

fn main() -> ExitCode {
    let Err(error) = run() else {
        return ExitCode::SUCCESS;
    };
    eprintln!("headless_png: {error}");
    ExitCode::FAILURE
}

fn run() -> Result<(), Box<dyn Error>> {
    // 1. The CPU's part: a control mesh, and what the quadtree method makes of it. Nothing of this needs a device, so it may run on a loader
    //    thread, or once in a tool. `Prepared` holds plain tables; the plans in it depend on the connectivity and the sharpness alone.
    let mesh = match std::env::args().nth(1) {
        Some(path) => read_obj(Path::new(&path))?,
        None => builtin(DEFAULT_BUILTIN)?,
    };
    let model = Model::new(mesh);
    let prepared = method("quadtree")?.prepare(&model, MethodOptions::default())?;

    // 2. The device. `Support` tells whether a physical device will do and why not; `FeatureChain` switches on what is needed. An engine with
    //    feature structs of its own calls `Support::require` on them instead. Workarounds for driver faults are a list that is handed over
    //    below: look at it, log it, or hand over an empty one.
    // SAFETY: the loader outlives everything that it loads.
    let entry = unsafe { ash::Entry::load()? };
    let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
    let info = vk::InstanceCreateInfo::default().application_info(&application);
    // SAFETY: the infos live through the call. Handles are destroyed when nothing of them is in use any more, and children before what made
    // them: see steps 8 and 9. This holds for all below.
    let instance = unsafe { entry.create_instance(&info, None) };
    let instance = Own::new(instance.map_err(failed("vkCreateInstance"))?, |instance| {
        // SAFETY: as above, here and in all such functions below.
        unsafe { instance.destroy_instance(None) };
    });
    let (physical, support) = choose(&instance)?;
    // SAFETY: `physical` belongs to the live instance, which was made for Vulkan 1.2 or later.
    let driver = unsafe { Driver::query(&instance, physical) };
    let workarounds = workarounds(&driver);
    let family = support.graphics_family.ok_or("no graphics queue")?;
    let queues = [vk::DeviceQueueCreateInfo::default()
        .queue_family_index(family)
        .queue_priorities(&[1.0])];
    let extensions: Vec<_> = support.extensions().iter().map(|e| e.as_ptr()).collect();
    let mut features = FeatureChain::new(&support);
    let info = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_extension_names(&extensions);
    // SAFETY: `choose` saw that nothing is missing; the extensions are named; no other feature struct is chained.
    let info = unsafe { features.chain(info) };
    // SAFETY: the instance is live and the info complete.
    let device = unsafe { instance.create_device(physical, &info, None) };
    let device = Own::new(device.map_err(failed("vkCreateDevice"))?, |device| {
        // SAFETY: see step 2.
        unsafe { device.destroy_device(None) };
    });
    let allocator = RefCell::new(Allocator::new(&AllocatorCreateDesc {
        instance: (*instance).clone(),
        device: (*device).clone(),
        physical_device: physical,
        debug_settings: Default::default(),
        buffer_device_address: false,
        allocation_sizes: Default::default(),
    })?);

    // 3. The model on the device: buffers and descriptor sets, no commands yet. One `Layout` serves all surfaces of a device. The ring is the
    //    scratch memory that control shaders pass on; it bounds the memory, not the model: what does not fit is drawn in more batches.
    // SAFETY: the device has what `Support` asks for; allocator and layout are its own.
    let layout = Own::new(
        unsafe { Layout::new(&device, features.enabled()?)? },
        |layout| {
            // SAFETY: see step 2.
            unsafe { layout.destroy(&device) };
        },
    );
    // Vertices are counted, so that step 8 can tell whether all have come. That is for a picture that must be right; a game would not.
    let options = SurfaceOptions {
        count_vertices: true,
        ..SurfaceOptions::default()
    };
    // SAFETY: as above.
    let surface = unsafe {
        TessellatedSurface::new(
            &device,
            &mut allocator.borrow_mut(),
            &layout,
            &model,
            prepared,
            &workarounds,
            options,
        )?
    };
    let mut surface = Own::new(surface, |surface| {
        // SAFETY: see step 2.
        unsafe { surface.destroy(&device, &mut allocator.borrow_mut()) };
    });

    // 4. What is drawn into: any render target will do. Its render pass must let batches wait for one another: they share the scratch ring, a batch
    //    waits for the one before, and a barrier inside of a subpass is allowed only where the subpass depends on itself. With dynamic rendering there is
    //    no such thing: see `SurfaceOptions::barriers`.
    let picture = Picture::new(&device, &allocator, ring::ring_dependency(0))?;

    // 5. Pipelines: one a pass of the prepared model, from the modules that the crate brings. An engine with shaders of its own builds them
    //    from `gpu::shaders::source` and hands them in by `Pipelines::from_raw`. Hand over a pipeline cache where you have one.
    let cut = Cut {
        level: 8.0,
        spacing: Spacing::FractionalEven,
    };
    let options = PipelineOptions {
        target: Target::render_pass(picture.render_pass),
        backend: surface.options().backend,
        residence: surface.options().residence,
        spacing: cut.spacing,
        fill: Fill::Solid(Shading::Lit),
        fragment: None,
    };
    // SAFETY: all of one live device.
    let pipelines = unsafe {
        Pipelines::new(
            &device,
            &layout,
            vk::PipelineCache::null(),
            surface.prepared(),
            &options,
        )?
    };
    let pipelines = Own::new(pipelines, |pipelines| {
        // SAFETY: see step 2.
        unsafe { pipelines.destroy(&device) };
    });

    // 6. What is drawn at this cut, in batches that the ring holds: a plain value. Keep it while the level stays. With `Slots::Host`, depth tags
    //    or another backend `write_draws` would bring what it decided to the device.
    let list = surface.draw_list(cut, None)?;

    // 7. Recording. The order is: upload (once), prepare (a frame, outside of the render pass), draws (inside), read-back (optional).
    let commands = Commands::new(&device, family)?;
    let cmd = commands.cmd;
    // SAFETY: recording, outside of a render pass, on the device that made everything; all of it lives until the queue is idle. The copies are made
    // visible to the draws by the function itself.
    unsafe {
        surface.cmd_upload(&device, cmd);
        surface.cmd_prepare(&device, cmd, &[view(&model)])?;
    }
    picture.begin(cmd);
    for batch in list.batches() {
        // SAFETY: in subpass 0 of the pipelines' render pass, which depends on itself as it must; the batches come in their order.
        unsafe { surface.cmd_draw(&device, cmd, &layout, &pipelines, 0..1, batch)? };
    }
    // Your other objects can be drawn here: bind their pipelines and descriptor sets again, `cmd_draw` has bound its own.
    picture.end(cmd);
    // SAFETY: outside of the render pass again.
    unsafe { surface.cmd_read_back(&device, cmd) };
    picture.copy(cmd);

    // 8. Submitting and waiting are the engine's business. The memory that tables were staged in can go once they have been copied.
    commands.submit()?;
    // SAFETY: the queue is idle.
    unsafe { surface.finish_upload(&device, &mut allocator.borrow_mut()) };
    // A control shader may run more than once for a patch. Then the slots of a batch can run out: patches that got none were left out and
    // counted. An engine draws such a frame again with `Slots::Host`, which does not depend on that, or simply always uses it.
    let counters = surface.counters()?;
    if counters.overflows > 0 {
        return Err(format!("{} patches found no room in the ring", counters.overflows).into());
    }
    // A driver that loses draws says nothing. Whether all vertices came that were predicted is known because they were counted.
    surface.arrival(list.batches())?.check()?;
    write_png(picture.pixels())?;
    println!(
        "headless.png: {} batches, {} points through the ring, on {}",
        list.batches().len(),
        counters.points,
        driver.info
    );

    // 9. Everything goes in the opposite order. The library's objects borrow nothing, so each is destroyed explicitly, by the `Own` that
    //     holds it.
    Ok(())
}

/// The first device that lacks nothing.
fn choose(instance: &ash::Instance) -> Result<(vk::PhysicalDevice, Support), Box<dyn Error>> {
    let mut lacking = Vec::new();
    // SAFETY: the instance is live.
    let all = unsafe { instance.enumerate_physical_devices() };
    for physical in all.map_err(failed("vkEnumeratePhysicalDevices"))? {
        // SAFETY: `physical` belongs to the live instance, which was made for Vulkan 1.2 or later.
        let support = unsafe { Support::query(instance, physical) };
        if support.missing().is_empty() {
            return Ok((physical, support));
        }
        lacking.push(support.missing().join(", "));
    }
    Err(format!("no suitable device; missing: {}", lacking.join("; ")).into())
}

/// From the front, a little from the right and from above. Positions on the GPU are in local units, so that f32 is enough whatever the mesh's
/// size and far from the origin too: an engine puts `model.placement().matrix()` into its object matrix, in f64.
fn view(model: &Model) -> View {
    let radius = 0.5 * model.diagonal() as f32;
    let distance = 2.0 * radius;
    let eye_from_model = Mat4::from_translation(Vec3::new(0.0, 0.0, -distance))
        * Mat4::from_rotation_x(0.35)
        * Mat4::from_rotation_y(-0.6);
    let (aspect, near) = (WIDTH as f32 / HEIGHT as f32, distance - radius);
    let clip_from_eye =
        glam::camera::rh::proj::vulkan::perspective(0.7, aspect, near, distance + radius);
    View {
        clip_from_model: (clip_from_eye * eye_from_model).to_cols_array_2d(),
        eye: eye_from_model
            .inverse()
            .transform_point3(Vec3::ZERO)
            .to_array(),
        displacement: Displacement::default(),
    }
}
