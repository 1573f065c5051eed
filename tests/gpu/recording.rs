//! However draws are recorded, in secondary command buffers or from commands in a buffer: the same picture.

use ash::vk;
use hullform::gpu::{Backend, Fill, Indirect, IndirectCommands, Layout, Shading, Target};

use crate::canvas::{COLOUR, Canvas, DEPTH, Part};
use crate::common::gpu::{Gpu, SIDE};
use crate::targets::{COLOURED, ONE, Scene, covered, open, single_draws};

/// Draws recorded in a secondary command buffer, inside a classic render pass and inside dynamic rendering.
#[test]
fn secondary_command_buffers_hold_draws() {
    let Some(gpu) = open() else { return };
    let scene = Scene::new(&gpu, Backend::Tessellator);
    let right = scene.classic(Shading::Patch);
    let device = gpu.device.raw();
    for dynamic in [false, true] {
        let mut canvas = Canvas::new(&gpu, ONE, 1);
        let target = match dynamic {
            true => Target::new(COLOURED),
            false => Target::render_pass(gpu.target().render_pass()),
        };
        let options = scene.options(target, Fill::Solid(Shading::Patch));
        let pipelines = scene.build(gpu.layout(), &options).expect("it can");
        let family = gpu.device.queue_family();
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(family);
        // SAFETY: the device is live.
        let pool = unsafe { device.create_command_pool(&info, None) }.expect("a pool");
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(pool)
            .level(vk::CommandBufferLevel::SECONDARY)
            .command_buffer_count(1);
        // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
        let drawn = gpu.device.submit(|cmd| unsafe {
            let secondary = device.allocate_command_buffers(&info).expect("one");
            let formats = [COLOUR];
            let mut rendering = vk::CommandBufferInheritanceRenderingInfo::default()
                .color_attachment_formats(&formats)
                .depth_attachment_format(DEPTH)
                .rasterization_samples(ONE);
            scene
                .loaded
                .surface()
                .cmd_prepare(device, cmd, &scene.views)?;
            let mut inheritance = vk::CommandBufferInheritanceInfo::default();
            if dynamic {
                let parts = [Part::Colour, Part::Depth];
                let flags = vk::RenderingFlags::CONTENTS_SECONDARY_COMMAND_BUFFERS;
                canvas.begin(cmd, &parts, 1.0, 0, flags);
                inheritance = inheritance.push_next(&mut rendering);
            } else {
                let framebuffer = canvas.begin_pass(cmd);
                inheritance = inheritance
                    .render_pass(gpu.target().render_pass())
                    .framebuffer(framebuffer);
            }
            let begin = vk::CommandBufferBeginInfo::default()
                .flags(vk::CommandBufferUsageFlags::RENDER_PASS_CONTINUE)
                .inheritance_info(&inheritance);
            let begun = device.begin_command_buffer(secondary[0], &begin);
            begun.expect("it is new");
            canvas.cmd_look(secondary[0]);
            for batch in scene.batches() {
                let (drawing, layout) = (scene.drawing(), gpu.layout());
                drawing.cmd_draw(device, secondary[0], layout, &pipelines, 0..9, batch)?;
            }
            device.end_command_buffer(secondary[0]).expect("recorded");
            device.cmd_execute_commands(cmd, &secondary);
            match dynamic {
                true => canvas.end(cmd, Part::Colour),
                false => canvas.end_pass(cmd),
            }
            Ok(())
        });
        drawn.expect("it is executed");
        assert!(canvas.pixels() == right, "dynamic: {dynamic}");
        // SAFETY: every submission has been waited for.
        unsafe {
            pipelines.destroy(device);
            device.destroy_command_pool(pool, None);
        }
    }
    drop(scene);
    gpu.finish();
}

/// Commands in a buffer draw what calls do; those whose instance count is 0 draw nothing, and the others what they did.
#[test]
fn indirect_draws_are_the_direct_ones_and_can_be_culled() {
    let Some(gpu) = Gpu::open() else { return };
    let single = single_draws(&gpu);
    for backend in [Backend::Tessellator, Backend::Pattern] {
        let scene = Scene::new(&gpu, backend);
        let right = scene.classic(Shading::Lit);
        for layout in [gpu.layout(), &single] {
            for culled in [&[][..], &[0, 4, 8]] {
                let picture = indirect(&scene, layout, culled);
                for (number, (own, all)) in picture.chunks(4).zip(right.chunks(4)).enumerate() {
                    // Views are cells of a grid.
                    let cell = |at: u32| at * 3 / SIDE;
                    let place = number as u32;
                    let view = cell(place / SIDE) * 3 + cell(place % SIDE);
                    let inside = [place / SIDE, place % SIDE].map(|at| (at * 3) % SIDE > 6);
                    if culled.contains(&view) {
                        assert!(own[3] == 0 || inside != [true; 2], "{backend:?} {view}");
                    } else if inside == [true; 2] {
                        assert_eq!(own, all, "{backend:?} {view}");
                    }
                }
                assert!(covered(&picture) > 200);
            }
        }
    }
    // SAFETY: every submission has been waited for.
    unsafe { single.destroy(gpu.device.raw()) };
    gpu.finish();
}

/// The picture of draws from a buffer, without some views.
fn indirect(scene: &Scene<'_>, layout: &Layout, culled: &[u32]) -> Vec<u8> {
    let gpu = scene.gpu;
    let device = gpu.device.raw();
    let target = Target::render_pass(gpu.target().render_pass());
    let options = scene.options(target, Fill::Solid(Shading::Lit));
    let pipelines = scene.build(layout, &options).expect("it can");
    let mut words = Vec::new();
    let mut places = Vec::new();
    for batch in scene.batches() {
        places.push(4 * words.len() as u64);
        let drawing = scene.drawing();
        let commands = drawing.indirect_commands(layout, &pipelines, 0..9, batch);
        let mut commands = commands.expect("it may be drawn");
        let is_culled = |number: usize| culled.contains(&(number as u32 % 9));
        match &mut commands {
            IndirectCommands::Patches(commands) => {
                let commands = commands.iter_mut().enumerate();
                commands
                    .filter(|(number, _)| is_culled(*number))
                    .for_each(|(_, command)| command.instance_count = 0);
            }
            IndirectCommands::Patterns(commands) => {
                let commands = commands.iter_mut().enumerate();
                commands
                    .filter(|(number, _)| is_culled(*number))
                    .for_each(|(_, command)| command.instance_count = 0);
            }
        }
        assert_eq!(commands.len(), 9 * batch.draws().len());
        words.extend(commands.words());
    }
    let allocator = &mut gpu.device.allocator();
    let usage = vk::BufferUsageFlags::INDIRECT_BUFFER;
    let location = gpu_allocator::MemoryLocation::CpuToGpu;
    let size = 4 * words.len() as u64;
    // SAFETY: device and allocator belong together.
    let buffer =
        unsafe { hullform::gpu::Buffer::new(device, allocator, "commands", size, usage, location) };
    let mut buffer = buffer.expect("it is small");
    let written = buffer.write(0, bytemuck::cast_slice(&words));
    written.expect("the host sees it");
    // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
    let drawn = gpu.device.submit(|cmd| unsafe {
        let surface = scene.loaded.surface();
        surface.cmd_prepare(device, cmd, &scene.views)?;
        gpu.target().begin(cmd, [0.0; 4]);
        for (batch, &offset) in scene.batches().zip(&places) {
            let buffer = buffer.raw();
            let indirect = Indirect {
                batch,
                buffer,
                offset,
            };
            let drawing = scene.drawing();
            drawing.cmd_draw_indirect(device, cmd, layout, &pipelines, 0..9, indirect)?;
        }
        gpu.target().end(cmd);
        gpu.target().cmd_copy_to_host(cmd);
        Ok(())
    });
    drawn.expect("it is executed");
    // SAFETY: every submission has been waited for.
    unsafe {
        buffer.destroy(device, allocator);
        pipelines.destroy(device);
    }
    scene.loaded.pixels()
}
