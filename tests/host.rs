//! Instance, device and offscreen picture on whatever Vulkan device there is, watched by the validation layer.
#![cfg(feature = "host")]

use ash::vk;
use hullform::gpu::{Buffer, ring};
use hullform::host::{Device, Encoding, Instance, OffscreenTarget, devices};
use hullform::{Error, Result};
use std::time::Duration;

/// A validated device, or `None` (with a line that says so) where there is no Vulkan to test.
fn validated() -> Option<Device> {
    let opened = Instance::new(true).and_then(|instance| Device::open(&instance, None));
    match opened {
        Ok(device) => Some(device),
        Err(error @ (Error::NoDevice(_) | Error::Option { .. })) => {
            println!("skipped: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn assert_silent(instance: &Instance) {
    let messages = instance.validation_messages();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
}

/// Clears `target` to `colour`, with a barrier between batches as a renderer would have, and reads it back.
fn clear(device: &Device, target: &OffscreenTarget, colour: [f32; 4]) -> Result<Vec<u8>> {
    device.submit(|cmd| {
        // SAFETY: each call is made where its contract wants it: a pass, a barrier within it, a copy after it.
        unsafe {
            target.begin(cmd, colour);
            ring::cmd_ring_barrier(device.raw(), cmd);
            target.end(cmd);
            target.cmd_copy_to_host(cmd);
        }
        Ok(())
    })?;
    Ok(target.read_pixels().to_vec())
}

#[test]
fn a_cleared_picture_comes_back_and_validation_is_silent() {
    let Some(device) = validated() else { return };
    let instance = device.instance().clone();
    for (encoding, expected) in [
        (Encoding::Unorm, [255, 128, 0, 255]),
        // 0.5 of the light is 188 in sRGB.
        (Encoding::Srgb, [255, 188, 0, 255]),
    ] {
        for samples in [1, 4] {
            let target = OffscreenTarget::with_encoding(&device, 33, 17, samples, encoding);
            let target = target.expect("a small picture fits every device");
            let pixels = clear(&device, &target, [1.0, 0.502, 0.0, 1.0]).expect("it is cleared");
            assert_eq!(pixels.len(), 33 * 17 * 4);
            assert!(pixels.chunks(4).all(|pixel| pixel == expected));
        }
    }
    drop(device);
    assert_silent(&instance);
}

#[test]
fn a_target_is_drawn_again_in_one_command_buffer_without_hazard() {
    let Some(device) = validated() else { return };
    let instance = device.instance().clone();
    let target = OffscreenTarget::new(&device, 64, 64, 4).expect("it fits");
    let draw_twice = device.submit(|cmd| {
        for shade in [0.0, 1.0] {
            // SAFETY: a pass, then a copy of its picture, twice.
            unsafe {
                target.begin(cmd, [shade; 4]);
                target.end(cmd);
                target.cmd_copy_to_host(cmd);
            }
        }
        Ok(())
    });
    draw_twice.expect("it is drawn");
    assert!(target.read_pixels().iter().all(|&byte| byte == 255));
    drop((target, device));
    assert_silent(&instance);
}

/// Without this the silence above would prove nothing.
#[test]
fn a_missing_barrier_is_caught() {
    let Some(device) = validated() else { return };
    let usage = vk::BufferUsageFlags::TRANSFER_DST;
    let location = gpu_allocator::MemoryLocation::GpuOnly;
    let mut allocator = device.allocator();
    // SAFETY: device and allocator belong together.
    let buffer = unsafe { Buffer::new(device.raw(), &mut allocator, "b", 64, usage, location) };
    let buffer = buffer.expect("64 bytes are there");
    let filled = device.submit(|cmd| {
        // SAFETY: not safe: the second fill may overtake the first. That is the fault to be caught.
        unsafe {
            device.raw().cmd_fill_buffer(cmd, buffer.raw(), 0, 64, 1);
            device.raw().cmd_fill_buffer(cmd, buffer.raw(), 0, 64, 2);
        }
        Ok(())
    });
    filled.expect("it is submitted");
    // SAFETY: the submission has been waited for.
    unsafe { buffer.destroy(device.raw(), &mut allocator) };
    let messages = device.instance().validation_messages();
    let caught = |message: &String| message.contains("SYNC-HAZARD-WRITE-AFTER-WRITE");
    assert!(messages.iter().any(caught), "{messages:?}");
}

/// The ring barrier is legal because of the pass's dependency on itself: one that it does not cover is caught.
#[test]
fn a_barrier_that_the_pass_does_not_allow_is_caught() {
    let Some(device) = validated() else { return };
    let target = OffscreenTarget::new(&device, 8, 8, 1).expect("it fits");
    let recorded: Result<()> = device.submit(|cmd| {
        let stage = vk::PipelineStageFlags::VERTEX_SHADER;
        let barrier = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::SHADER_WRITE)
            .dst_access_mask(vk::AccessFlags::SHADER_READ);
        let flags = vk::DependencyFlags::empty();
        // SAFETY: not safe: the pass has no dependency for this barrier. It is recorded only, never submitted.
        unsafe {
            target.begin(cmd, [0.0; 4]);
            let raw = device.raw();
            raw.cmd_pipeline_barrier(cmd, stage, stage, flags, &[barrier], &[], &[]);
            target.end(cmd);
        }
        Err(Error::Refused("recorded only".into()))
    });
    assert!(matches!(recorded, Err(Error::Refused(_))));
    let messages = device.instance().validation_messages();
    let caught =
        |message: &String| message.contains("VUID-vkCmdPipelineBarrier-pDependencies-02285");
    assert!(messages.iter().any(caught), "{messages:?}");
}

#[test]
fn a_picture_that_does_not_fit_is_refused_in_words() {
    let Some(device) = validated() else { return };
    let refused = |width, height, samples| {
        let target = OffscreenTarget::new(&device, width, height, samples);
        let error = target.err().expect("it must not fit");
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    };
    assert!(refused(0, 8, 1).starts_with("size: this device cannot hold a picture of 0x8;"));
    let widest = device.limits().max_image_dimension2_d;
    assert!(refused(widest + 1, 8, 1).contains(&format!("1x1 to {widest}x")));
    assert!(refused(8, 8, 3).contains("choose one of 1, "));
    assert!(refused(8, 8, 0).contains("samples"));
    assert_silent(device.instance());
}

#[test]
fn a_submission_that_never_ends_is_an_error_not_a_hang() {
    // Without validation, which warns of what we do here.
    let opened = Instance::new(false).and_then(|instance| Device::open(&instance, None));
    let Ok(device) = opened else {
        println!("skipped: no Vulkan device");
        return;
    };
    let raw = device.raw();
    // SAFETY: the device is live.
    let event = unsafe { raw.create_event(&vk::EventCreateInfo::default(), None) };
    let event = event.expect("events are cheap");
    let host = vk::PipelineStageFlags::HOST;
    let end = vk::PipelineStageFlags::TRANSFER;
    let waited = device.submit_within(Duration::from_millis(50), |cmd| {
        // SAFETY: the event is this device's, and set by the host alone.
        unsafe { raw.cmd_wait_events(cmd, &[event], host, end, &[], &[], &[]) };
        Ok(())
    });
    let words = waited.expect_err("the event is not set").to_string();
    let start = "vkWaitForFences failed: TIMEOUT after 0.05 s; ";
    assert!(words.starts_with(start), "{words}");
    assert!(device.is_hung());
    // SAFETY: lets the queue go, so that nothing spins while the other tests run.
    unsafe { raw.set_event(event) }.expect("events can be set");
}

#[test]
fn devices_are_numbered_as_listed() {
    let Some(device) = validated() else { return };
    let all = devices(device.instance()).expect("there is one");
    for (number, listed) in all.iter().enumerate() {
        assert_eq!(listed.index, number);
        assert!(!listed.name.is_empty());
    }
    let name = device.info().name.to_uppercase();
    let again = Device::open(device.instance(), Some(&name)).expect("it is found by name");
    assert_eq!(again.info().index, device.info().index);
    assert_silent(device.instance());
}
