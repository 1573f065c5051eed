//! The engine's own set, number 3: light, shadow map, and what each instance looks like. Its shader is `glsl/engine/lit.frag`.

use std::error::Error;

use ash::vk;
use bytemuck::{Pod, Zeroable};
use glam::Mat4;
use gpu_allocator::MemoryLocation;
use hullform::gpu::{Buffer, Layout};

use crate::gpu::{Gpu, Held, failed};
use crate::images::Images;

/// The light of a frame, as the shader has it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct Light {
    pub shadow_from_world: Mat4,
    pub sun: [f32; 3],
    pub softness: f32,
    pub eye: [f32; 3],
    pub haze: f32,
}

/// An instance, as the shader has it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct Instance {
    pub world_from_model: Mat4,
    pub colour: [f32; 3],
    pub gloss: f32,
    /// How much of the highlight is that of brushed metal, whose grooves run along u; 0 to 1.
    pub brushed: f32,
    /// How rough that is along the grooves, and across.
    pub roughness: [f32; 2],
    /// How bright highlights are.
    pub highlight: f32,
}

/// What all materials have in common.
pub struct Materials<'g> {
    gpu: &'g Gpu,
    set: Held<'g, vk::DescriptorSetLayout>,
    /// Sets 0 to 2 are hullform's.
    pub layout: Held<'g, vk::PipelineLayout>,
    sampler: Held<'g, vk::Sampler>,
    pool: Held<'g, vk::DescriptorPool>,
    pub fragment: Held<'g, vk::ShaderModule>,
}

/// The set of a model in a frame, with its buffers, which the host writes.
pub struct Material<'g> {
    light: Held<'g, Buffer>,
    instances: Held<'g, Buffer>,
    pub set: [vk::DescriptorSet; 1],
}

const KINDS: [vk::DescriptorType; 3] = [
    vk::DescriptorType::UNIFORM_BUFFER,
    vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
    vk::DescriptorType::STORAGE_BUFFER,
];

impl<'g> Materials<'g> {
    /// For so many sets.
    pub fn new(gpu: &'g Gpu, hullform: &Layout, sets: u32) -> Result<Self, Box<dyn Error>> {
        let bindings = [0, 1, 2].map(|number| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(number)
                .descriptor_type(KINDS[number as usize])
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::FRAGMENT)
        });
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is live, here and below; what is made is destroyed when it is held no more, see `Gpu::buffer`.
        let set = unsafe { gpu.device.create_descriptor_set_layout(&info, None) };
        let set = set.map_err(failed("vkCreateDescriptorSetLayout"))?;
        let set = gpu.hold(set, |gpu, set| {
            // SAFETY: as above.
            unsafe { gpu.device.destroy_descriptor_set_layout(set, None) };
        });
        let [tables, pose, frame] = hullform.sets();
        let layouts = [tables, pose, frame, *set];
        let ranges = [Layout::push_constant_range()];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&layouts)
            .push_constant_ranges(&ranges);
        // SAFETY: as above.
        let layout = unsafe { gpu.device.create_pipeline_layout(&info, None) };
        let layout = gpu.hold(
            layout.map_err(failed("vkCreatePipelineLayout"))?,
            |gpu, layout| {
                // SAFETY: as above.
                unsafe { gpu.device.destroy_pipeline_layout(layout, None) };
            },
        );
        Ok(Materials {
            gpu,
            set,
            layout,
            sampler: sampler(gpu)?,
            pool: pool(gpu, sets)?,
            fragment: gpu.module("engine.lit.frag")?,
        })
    }

    /// A set for so many instances.
    pub fn material(
        &self,
        images: &Images<'_>,
        instances: u32,
    ) -> Result<Material<'g>, Box<dyn Error>> {
        use vk::BufferUsageFlags as Usage;
        let (gpu, written) = (self.gpu, MemoryLocation::CpuToGpu);
        let light = size_of::<Light>() as u64;
        let light = gpu.buffer("light", light, Usage::UNIFORM_BUFFER, written)?;
        let size = u64::from(instances) * size_of::<Instance>() as u64;
        let instances = gpu.buffer("instances", size, Usage::STORAGE_BUFFER, written)?;
        let layouts = [*self.set];
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(*self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool was made for all sets.
        let set = unsafe { gpu.device.allocate_descriptor_sets(&info) };
        let set = set.map_err(failed("vkAllocateDescriptorSets"))?[0];
        let whole = |buffer: &Buffer| {
            [vk::DescriptorBufferInfo::default()
                .buffer(buffer.raw())
                .range(vk::WHOLE_SIZE)]
        };
        let (of_light, of_instances) = (whole(&light), whole(&instances));
        let map = [vk::DescriptorImageInfo::default()
            .sampler(*self.sampler)
            .image_view(images.shadow.view)
            .image_layout(vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL)];
        let write = |binding: u32| {
            vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(binding)
                .descriptor_type(KINDS[binding as usize])
        };
        let writes = [
            write(0).buffer_info(&of_light),
            write(1).image_info(&map),
            write(2).buffer_info(&of_instances),
        ];
        // SAFETY: the set is new, and all of it of this device.
        unsafe { gpu.device.update_descriptor_sets(&writes, &[]) };
        Ok(Material {
            light,
            instances,
            set: [set],
        })
    }
}

impl Material<'_> {
    /// Writes what the frame that uses it next has.
    pub fn write(&mut self, light: &Light, instances: &[Instance]) -> hullform::Result<()> {
        self.light.write(0, bytemuck::bytes_of(light))?;
        self.instances.write(0, bytemuck::cast_slice(instances))
    }
}

/// Compares with the map's depths, four at a time; outside of it there is no shadow.
fn sampler(gpu: &Gpu) -> Result<Held<'_, vk::Sampler>, Box<dyn Error>> {
    let border = vk::SamplerAddressMode::CLAMP_TO_BORDER;
    let info = vk::SamplerCreateInfo::default()
        .mag_filter(vk::Filter::LINEAR)
        .min_filter(vk::Filter::LINEAR)
        .address_mode_u(border)
        .address_mode_v(border)
        .address_mode_w(border)
        .border_color(vk::BorderColor::FLOAT_OPAQUE_WHITE)
        .compare_enable(true)
        .compare_op(vk::CompareOp::LESS_OR_EQUAL);
    // SAFETY: the device is live.
    let sampler = unsafe { gpu.device.create_sampler(&info, None) };
    let sampler = sampler.map_err(failed("vkCreateSampler"))?;
    Ok(gpu.hold(sampler, |gpu, sampler| {
        // SAFETY: see `Gpu::buffer`.
        unsafe { gpu.device.destroy_sampler(sampler, None) };
    }))
}

fn pool(gpu: &Gpu, sets: u32) -> Result<Held<'_, vk::DescriptorPool>, Box<dyn Error>> {
    let sizes = KINDS.map(|kind| {
        vk::DescriptorPoolSize::default()
            .ty(kind)
            .descriptor_count(sets)
    });
    let info = vk::DescriptorPoolCreateInfo::default()
        .max_sets(sets)
        .pool_sizes(&sizes);
    // SAFETY: the device is live.
    let pool = unsafe { gpu.device.create_descriptor_pool(&info, None) };
    let pool = pool.map_err(failed("vkCreateDescriptorPool"))?;
    Ok(gpu.hold(pool, |gpu, pool| {
        // SAFETY: see `Gpu::buffer`.
        unsafe { gpu.device.destroy_descriptor_pool(pool, None) };
    }))
}
