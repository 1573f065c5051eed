//! How an engine brings hullform into its renderer: a picture, drawn with a device of the example's own, to `headless.png`.
//!
//! ```sh
//! cargo run --release --example headless_png -- [MODEL.obj]
//! VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation cargo run --release --example headless_png
//! ```
//!
//! Read it from top to bottom. Instance, device, queue, allocator, render pass and command buffer are the engine's; the library never
//! submits and never waits. Two places ask something of the engine: the features that the device is created with (step 2) and one
//! dependency in the render pass (step 5). Everything else is `cmd_*` calls into a command buffer that is recording anyway.
//!
//! Everything that is made is held by an `Own`, which destroys it at the end of its scope: in the opposite order, and after an error as well. An
//! engine has classes of its own for that.

use std::cell::RefCell;
use std::error::Error;
use std::ops::{Deref, DerefMut};
use std::path::Path;
use std::process::ExitCode;

use ash::vk;
use glam::{Mat4, Vec3};
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{
    Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc,
};
use hullform::gpu::{
    Buffer, Cut, Driver, FeatureChain, Fill, Layout, Pipelines, Shading, Support, SurfaceOptions,
    Target, TessellatedSurface, View, ring, workarounds,
};
use hullform::mesh::{DEFAULT_BUILTIN, Model, builtin, read_obj};
use hullform::method::{Displacement, MethodOptions, method};
use hullform::tessellation::Spacing;

const WIDTH: u32 = 960;
const HEIGHT: u32 = 600;
const COLOUR: vk::Format = vk::Format::R8G8B8A8_SRGB;
const DEPTH: vk::Format = vk::Format::D16_UNORM; // the one depth format that every device has

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
    // them: see steps 9 and 10. This holds for all below.
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
    // SAFETY: the device was created with one queue of this family.
    let queue = unsafe { device.get_device_queue(family, 0) };
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
    // Vertices are counted, so that step 9 can tell whether all have come. That is for a picture that must be right; a game would not.
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

    // 4. What is drawn into. Any render target will do; here two images and a buffer for the pixels.
    let colour_usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC;
    let depth_usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    let colour = Image::new(&device, &allocator, COLOUR, colour_usage)?;
    let depth = Image::new(&device, &allocator, DEPTH, depth_usage)?;
    // SAFETY: device and allocator belong together.
    let pixels = unsafe {
        Buffer::new(
            &device,
            &mut allocator.borrow_mut(),
            "pixels",
            u64::from(WIDTH * HEIGHT * 4),
            vk::BufferUsageFlags::TRANSFER_DST,
            MemoryLocation::GpuToCpu,
        )?
    };
    let pixels = Own::new(pixels, |pixels| {
        // SAFETY: see step 2.
        unsafe { pixels.destroy(&device, &mut allocator.borrow_mut()) };
    });

    // 5. The render pass must let batches wait for one another: see `render_pass`.
    let render_pass = render_pass(&device).map_err(failed("vkCreateRenderPass"))?;
    let render_pass = Own::new(render_pass, |pass| {
        // SAFETY: see step 2.
        unsafe { device.destroy_render_pass(pass, None) };
    });
    let views = [colour.view, depth.view];
    let info = vk::FramebufferCreateInfo::default()
        .render_pass(*render_pass)
        .attachments(&views)
        .width(WIDTH)
        .height(HEIGHT)
        .layers(1);
    // SAFETY: the views are of the formats that the pass declares.
    let framebuffer = unsafe { device.create_framebuffer(&info, None) };
    let framebuffer = Own::new(
        framebuffer.map_err(failed("vkCreateFramebuffer"))?,
        |framebuffer| {
            // SAFETY: see step 2.
            unsafe { device.destroy_framebuffer(framebuffer, None) };
        },
    );

    // 6. Pipelines: one a pass of the prepared model, from the modules that the crate brings. An engine with shaders of its own builds them
    //    from `gpu::shaders::source` and hands them in by `Pipelines::from_raw`. Hand over a pipeline cache where you have one.
    let cut = Cut {
        level: 8.0,
        spacing: Spacing::FractionalEven,
    };
    let target = Target {
        render_pass: *render_pass,
        samples: vk::SampleCountFlags::TYPE_1,
        // The tugboat's funnel is open: its inside is seen.
        cull: vk::CullModeFlags::NONE,
        compare: vk::CompareOp::LESS_OR_EQUAL,
    };
    // SAFETY: all of one live device.
    let pipelines = unsafe {
        Pipelines::new(
            &device,
            &layout,
            vk::PipelineCache::null(),
            surface.prepared(),
            target,
            surface.options().backend,
            cut.spacing,
            Fill::Solid(Shading::Lit),
        )?
    };
    let pipelines = Own::new(pipelines, |pipelines| {
        // SAFETY: see step 2.
        unsafe { pipelines.destroy(&device) };
    });

    // 7. What is drawn at this cut, in batches that the ring holds: a plain value. Keep it while the level stays. With `Slots::Host`, depth tags
    //    or another backend `write_draws` would bring what it decided to the device.
    let list = surface.draw_list(cut, None)?;

    // 8. Recording. The order is: upload (once), prepare (a frame, outside of the render pass), draws (inside), read-back (optional).
    let info = vk::CommandPoolCreateInfo::default().queue_family_index(family);
    // SAFETY: the family is the queue's, here and in all that is recorded below: the device made everything and everything lives until the
    // queue is idle. What each `cmd_` function needs beyond that is said where it is called.
    let pool = unsafe { device.create_command_pool(&info, None) };
    let pool = Own::new(pool.map_err(failed("vkCreateCommandPool"))?, |pool| {
        // SAFETY: see step 2.
        unsafe { device.destroy_command_pool(pool, None) };
    });
    let info = vk::CommandBufferAllocateInfo::default()
        .command_pool(*pool)
        .command_buffer_count(1);
    // SAFETY: the pool is ours.
    let cmd = unsafe { device.allocate_command_buffers(&info) };
    let cmd = cmd.map_err(failed("vkAllocateCommandBuffers"))?[0];
    let begin =
        vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
    // SAFETY: the command buffer is new.
    unsafe { device.begin_command_buffer(cmd, &begin) }.map_err(failed("vkBeginCommandBuffer"))?;
    // SAFETY: recording, outside of a render pass. The copies are made visible to the draws by the function itself.
    unsafe {
        surface.cmd_upload(&device, cmd);
        surface.cmd_prepare(&device, cmd);
    }
    let area = vk::Rect2D::default().extent(vk::Extent2D {
        width: WIDTH,
        height: HEIGHT,
    });
    let clears = clear_values();
    let begin = vk::RenderPassBeginInfo::default()
        .render_pass(*render_pass)
        .framebuffer(*framebuffer)
        .render_area(area)
        .clear_values(&clears);
    let viewport = vk::Viewport {
        width: WIDTH as f32,
        height: HEIGHT as f32,
        max_depth: 1.0,
        ..Default::default()
    };
    // SAFETY: viewport and scissor are dynamic states of the pipelines and set before the first draw.
    unsafe {
        device.cmd_begin_render_pass(cmd, &begin, vk::SubpassContents::INLINE);
        device.cmd_set_viewport(cmd, 0, &[viewport]);
        device.cmd_set_scissor(cmd, 0, &[area]);
    }
    let view = view(&model);
    for batch in list.batches() {
        // SAFETY: in subpass 0 of the pipelines' render pass, which depends on itself as it must; the batches come in their order.
        unsafe { surface.cmd_draw(&device, cmd, &layout, &pipelines, &view, batch)? };
    }
    // Your other objects can be drawn here: bind their pipelines and descriptor sets again, `cmd_draw` has bound its own.
    let copy = vk::BufferImageCopy::default()
        .image_subresource(
            vk::ImageSubresourceLayers::default()
                .aspect_mask(vk::ImageAspectFlags::COLOR)
                .layer_count(1),
        )
        .image_extent(extent());
    let source = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
    let visible = [vk::MemoryBarrier::default()
        .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
        .dst_access_mask(vk::AccessFlags::HOST_READ)];
    // SAFETY: outside of the render pass again, which left the picture in this layout and made it visible to the copy.
    unsafe {
        device.cmd_end_render_pass(cmd);
        surface.cmd_read_back(&device, cmd);
        device.cmd_copy_image_to_buffer(cmd, colour.raw, source, pixels.raw(), &[copy]);
        device.cmd_pipeline_barrier(
            cmd,
            vk::PipelineStageFlags::TRANSFER,
            vk::PipelineStageFlags::HOST,
            vk::DependencyFlags::empty(),
            &visible,
            &[],
            &[],
        );
        device
            .end_command_buffer(cmd)
            .map_err(failed("vkEndCommandBuffer"))?;
    }

    // 9. Submitting and waiting are the engine's business. From here on nothing may be destroyed that the queue may still use, and a wait that
    //    fails says nothing about the queue: so if one does, the first thing that goes waits once more. A lost device counts as idle
    //    (Vulkan spec, "Lost Device"). Where even this wait fails nothing is known, and the program leaves without destroying anything.
    let busy = Own::new((), |()| {
        // SAFETY: nobody else uses the device.
        match unsafe { device.device_wait_idle() } {
            Ok(()) | Err(vk::Result::ERROR_DEVICE_LOST) => {}
            Err(code) => {
                eprintln!("headless_png: {}", failed("vkDeviceWaitIdle")(code));
                std::process::exit(1)
            }
        }
    });
    let commands = [cmd];
    let submit = [vk::SubmitInfo::default().command_buffers(&commands)];
    // SAFETY: the command buffer has been ended; nobody else uses the queue. The memory that tables were staged in can go once they
    // have been copied.
    unsafe {
        device
            .queue_submit(queue, &submit, vk::Fence::null())
            .map_err(failed("vkQueueSubmit"))?;
        device
            .queue_wait_idle(queue)
            .map_err(failed("vkQueueWaitIdle"))?;
        std::mem::forget(busy);
        surface.finish_upload(&device, &mut allocator.borrow_mut());
    }
    // A control shader may run more than once for a patch. Then the slots of a batch can run out: patches that got none were left out and
    // counted. An engine draws such a frame again with `Slots::Host`, which does not depend on that, or simply always uses it.
    let counters = surface.counters()?;
    if counters.overflows > 0 {
        return Err(format!("{} patches found no room in the ring", counters.overflows).into());
    }
    // A driver that loses draws says nothing. Whether all vertices came that were predicted is known because they were counted.
    surface.arrival(list.batches())?.check()?;
    write_png(pixels.bytes())?;
    println!(
        "headless.png: {} batches, {} points through the ring, on {}",
        list.batches().len(),
        counters.points,
        driver.info
    );

    // 10. Everything goes in the opposite order. The library's objects borrow nothing, so each is destroyed explicitly, by the `Own` that
    //     holds it.
    Ok(())
}

/// Holds something, and destroys it at the end of its scope.
struct Own<T, F: FnOnce(T)>(Option<(T, F)>);

impl<T, F: FnOnce(T)> Own<T, F> {
    fn new(made: T, destroy: F) -> Own<T, F> {
        Own(Some((made, destroy)))
    }
}

impl<T, F: FnOnce(T)> Deref for Own<T, F> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0.as_ref().expect("there until it is dropped").0
    }
}

impl<T, F: FnOnce(T)> DerefMut for Own<T, F> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.0.as_mut().expect("there until it is dropped").0
    }
}

impl<T, F: FnOnce(T)> Drop for Own<T, F> {
    fn drop(&mut self) {
        if let Some((made, destroy)) = self.0.take() {
            destroy(made);
        }
    }
}

/// For `map_err`: which call failed, and how.
fn failed(call: &'static str) -> impl Fn(vk::Result) -> String {
    move |code| format!("{call} failed: {code:?}")
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

/// One subpass with colour and depth. Of its three dependencies only `ring_dependency` is the library's wish: batches share the scratch
/// ring, a batch waits for the one before, and a barrier inside of a subpass is allowed only where the subpass depends on itself.
/// With dynamic rendering there is no such thing: see `SurfaceOptions::barriers`.
fn render_pass(device: &ash::Device) -> Result<vk::RenderPass, vk::Result> {
    let attachment = |format, store, layout| {
        vk::AttachmentDescription::default()
            .format(format)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(store)
            .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
            .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
            .final_layout(layout)
    };
    let (colour, depth) = (
        vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
    );
    let copied = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
    let attachments = [
        attachment(COLOUR, vk::AttachmentStoreOp::STORE, copied),
        attachment(DEPTH, vk::AttachmentStoreOp::DONT_CARE, depth),
    ];
    let reference = |attachment, layout| vk::AttachmentReference { attachment, layout };
    let (colours, depth) = ([reference(0, colour)], reference(1, depth));
    let subpasses = [vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .color_attachments(&colours)
        .depth_stencil_attachment(&depth)];
    // Before: the transition from `UNDEFINED` waits with the attachments' own stages. After: the picture is there for the copy.
    let drawn = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT
        | vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS
        | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS;
    let written =
        vk::AccessFlags::COLOR_ATTACHMENT_WRITE | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE;
    let before = vk::SubpassDependency::default()
        .src_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(drawn)
        .dst_stage_mask(drawn)
        .dst_access_mask(written | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ);
    let after = vk::SubpassDependency::default()
        .dst_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(drawn)
        .src_access_mask(written)
        .dst_stage_mask(vk::PipelineStageFlags::TRANSFER)
        .dst_access_mask(vk::AccessFlags::TRANSFER_READ);
    let dependencies = [before, ring::ring_dependency(0), after];
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
    // SAFETY: the device is live and can draw into both formats (Vulkan spec, "Required Format Support").
    unsafe { device.create_render_pass(&info, None) }
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

fn clear_values() -> [vk::ClearValue; 2] {
    let color = vk::ClearColorValue {
        float32: [0.02, 0.02, 0.025, 1.0],
    };
    let depth_stencil = vk::ClearDepthStencilValue {
        depth: 1.0,
        stencil: 0,
    };
    [vk::ClearValue { color }, vk::ClearValue { depth_stencil }]
}

fn extent() -> vk::Extent3D {
    vk::Extent3D {
        width: WIDTH,
        height: HEIGHT,
        depth: 1,
    }
}

/// An image with its memory and view. Null until made: if a step fails, what was made before it goes all the same.
struct Image<'a> {
    device: &'a ash::Device,
    allocator: &'a RefCell<Allocator>,
    raw: vk::Image,
    view: vk::ImageView,
    memory: Option<Allocation>,
}

impl<'a> Image<'a> {
    fn new(
        device: &'a ash::Device,
        allocator: &'a RefCell<Allocator>,
        format: vk::Format,
        usage: vk::ImageUsageFlags,
    ) -> Result<Image<'a>, Box<dyn Error>> {
        let mut image = Image {
            device,
            allocator,
            raw: vk::Image::null(),
            view: vk::ImageView::null(),
            memory: None,
        };
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(extent())
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        // SAFETY: the device is live and knows the format.
        let raw = unsafe { device.create_image(&info, None) };
        image.raw = raw.map_err(failed("vkCreateImage"))?;
        let memory = allocator.borrow_mut().allocate(&AllocationCreateDesc {
            name: "attachment",
            // SAFETY: the image is the device's.
            requirements: unsafe { device.get_image_memory_requirements(image.raw) },
            location: MemoryLocation::GpuOnly,
            linear: false,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        });
        let memory = memory.map_err(|error| format!("vkAllocateMemory failed: {error}"))?;
        let memory = image.memory.insert(memory);
        // SAFETY: the memory meets the image's requirements and is bound to nothing else.
        unsafe { device.bind_image_memory(image.raw, memory.memory(), memory.offset()) }
            .map_err(failed("vkBindImageMemory"))?;
        let aspect = match format {
            DEPTH => vk::ImageAspectFlags::DEPTH,
            _ => vk::ImageAspectFlags::COLOR,
        };
        let range = vk::ImageSubresourceRange::default()
            .aspect_mask(aspect)
            .level_count(1)
            .layer_count(1);
        let info = vk::ImageViewCreateInfo::default()
            .image(image.raw)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format)
            .subresource_range(range);
        // SAFETY: the image is bound; format and aspect are its own.
        let view = unsafe { device.create_image_view(&info, None) };
        image.view = view.map_err(failed("vkCreateImageView"))?;
        Ok(image)
    }
}

impl Drop for Image<'_> {
    fn drop(&mut self) {
        // SAFETY: see steps 2 and 9; null handles are allowed.
        unsafe {
            self.device.destroy_image_view(self.view, None);
            self.device.destroy_image(self.raw, None);
        }
        if let Some(memory) = self.memory.take() {
            let freed = self.allocator.borrow_mut().free(memory);
            freed.expect("memory goes back to the allocator it came from");
        }
    }
}

fn write_png(rgba: &[u8]) -> Result<(), Box<dyn Error>> {
    let file = std::io::BufWriter::new(std::fs::File::create("headless.png")?);
    let mut encoder = png::Encoder::new(file, WIDTH, HEIGHT);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgba)?;
    Ok(writer.finish()?)
}
