//! An image with its memory, and a file for its pixels.

use std::error::Error;

use ash::vk;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use gpu_allocator::{AllocationError, MemoryLocation};

use crate::gpu::{Gpu, Held, failed};

/// An image with its memory and view.
pub struct Image {
    pub raw: vk::Image,
    pub view: vk::ImageView,
    memory: Option<Allocation>,
}

/// An extent of one layer.
pub fn extent([width, height]: [u32; 2]) -> vk::Extent3D {
    vk::Extent3D {
        width,
        height,
        depth: 1,
    }
}

/// All of an image of depths, or of colours.
pub fn range(depths: bool) -> vk::ImageSubresourceRange {
    let aspect = match depths {
        true => vk::ImageAspectFlags::DEPTH,
        false => vk::ImageAspectFlags::COLOR,
    };
    vk::ImageSubresourceRange::default()
        .aspect_mask(aspect)
        .level_count(1)
        .layer_count(1)
}

/// An image on the device.
pub fn image(
    gpu: &Gpu,
    format: vk::Format,
    size: [u32; 2],
    samples: vk::SampleCountFlags,
    usage: vk::ImageUsageFlags,
) -> Result<Held<'_, Image>, Box<dyn Error>> {
    let info = vk::ImageCreateInfo::default()
        .image_type(vk::ImageType::TYPE_2D)
        .format(format)
        .extent(extent(size))
        .mip_levels(1)
        .array_layers(1)
        .samples(samples)
        .usage(usage);
    let device = &gpu.device;
    // SAFETY: the device is live, here and below, and knows the format.
    let raw = unsafe { device.create_image(&info, None) }.map_err(failed("vkCreateImage"))?;
    let made = Image {
        raw,
        view: vk::ImageView::null(),
        memory: None,
    };
    // Held from here on: if a step fails, what was made before it goes all the same.
    let mut image = gpu.hold(made, |gpu, image| {
        // SAFETY: see `Gpu::buffer`; null handles are fine.
        unsafe {
            gpu.device.destroy_image_view(image.view, None);
            gpu.device.destroy_image(image.raw, None);
        }
        if let Some(memory) = image.memory {
            let freed = gpu.allocator().free(memory);
            freed.expect("memory goes back to the allocator it came from");
        }
    });
    let memory = gpu.allocator().allocate(&AllocationCreateDesc {
        name: "image",
        // SAFETY: the image is the device's.
        requirements: unsafe { device.get_image_memory_requirements(raw) },
        location: MemoryLocation::GpuOnly,
        linear: false,
        allocation_scheme: AllocationScheme::GpuAllocatorManaged,
    });
    let memory = memory.map_err(|error| match error {
        AllocationError::FailedToMap(_) => format!("vkMapMemory failed: {error}"),
        _ => format!("vkAllocateMemory failed: {error}"),
    })?;
    let memory = image.memory.insert(memory);
    // SAFETY: the memory meets the image's requirements and is bound to nothing else.
    unsafe { device.bind_image_memory(raw, memory.memory(), memory.offset()) }
        .map_err(failed("vkBindImageMemory"))?;
    let depths = usage.contains(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT);
    let info = vk::ImageViewCreateInfo::default()
        .image(raw)
        .view_type(vk::ImageViewType::TYPE_2D)
        .format(format)
        .subresource_range(range(depths));
    // SAFETY: the image is bound; format and aspect are its own.
    let view = unsafe { device.create_image_view(&info, None) };
    image.view = view.map_err(failed("vkCreateImageView"))?;
    Ok(image)
}

/// Writes a picture of four bytes a pixel, whose last does not count.
pub fn write_png(path: &str, width: u32, rgba: &[u8]) -> Result<(), Box<dyn Error>> {
    let rgb = rgba.chunks(4).flat_map(|pixel| &pixel[..3]).copied();
    let rgb: Vec<u8> = rgb.collect();
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    let mut encoder = png::Encoder::new(file, width, rgb.len() as u32 / width / 3);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    Ok(writer.finish()?)
}
