//! Skinning: the engine's own compute shader, `glsl/engine/bend.comp`, writes a pose's control vertices. hullform's plans do not depend on positions.

use std::error::Error;

use ash::vk;
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use gpu_allocator::MemoryLocation;
use hullform::gpu::{Buffer, Pose};

use crate::gpu::{Gpu, Held, failed};

/// Two bones, as the shader has them.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Bones {
    upper: [[f32; 4]; 4],
    from: f32,
    to: f32,
    count: u32,
}

/// What bends a model.
pub struct Skin<'g> {
    gpu: &'g Gpu,
    rest: Held<'g, Buffer>,
    _set_layout: Held<'g, vk::DescriptorSetLayout>,
    layout: Held<'g, vk::PipelineLayout>,
    _pool: Held<'g, vk::DescriptorPool>,
    set: vk::DescriptorSet,
    pipeline: Held<'g, vk::Pipeline>,
    bones: Bones,
}

impl<'g> Skin<'g> {
    /// Of a pose whose control vertices at rest are these.
    pub fn new(gpu: &'g Gpu, pose: &Pose, rest: &[Vec3]) -> Result<Skin<'g>, Box<dyn Error>> {
        let bytes: &[u8] = bytemuck::cast_slice(rest);
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let size = bytes.len() as u64;
        let mut buffer = gpu.buffer("rest", size, usage, MemoryLocation::CpuToGpu)?;
        buffer.write(0, bytes)?;
        let set_layout = set_layout(gpu)?;
        let layouts = [*set_layout];
        let range = [vk::PushConstantRange::default()
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
            .size(size_of::<Bones>() as u32)];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&layouts)
            .push_constant_ranges(&range);
        // SAFETY: the device is live, here and below; what is made is destroyed when it is held no more, see `Gpu::buffer`.
        let layout = unsafe { gpu.device.create_pipeline_layout(&info, None) };
        let layout = gpu.hold(
            layout.map_err(failed("vkCreatePipelineLayout"))?,
            |gpu, layout| {
                // SAFETY: as above.
                unsafe { gpu.device.destroy_pipeline_layout(layout, None) };
            },
        );
        let pool = pool(gpu)?;
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(*pool)
            .set_layouts(&layouts);
        // SAFETY: the pool was made for it.
        let set = unsafe { gpu.device.allocate_descriptor_sets(&info) };
        let set = set.map_err(failed("vkAllocateDescriptorSets"))?[0];
        for (binding, buffer) in [(0, buffer.raw()), (1, pose.position_buffer())] {
            let whole = [vk::DescriptorBufferInfo::default()
                .buffer(buffer)
                .range(vk::WHOLE_SIZE)];
            let write = vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(binding)
                .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                .buffer_info(&whole);
            // SAFETY: the set is new.
            unsafe { gpu.device.update_descriptor_sets(&[write], &[]) };
        }
        let heights = rest.iter().map(|position| position.y);
        let low = heights.clone().fold(f32::INFINITY, f32::min);
        let high = heights.fold(f32::NEG_INFINITY, f32::max);
        Ok(Skin {
            gpu,
            rest: buffer,
            _set_layout: set_layout,
            pipeline: pipeline(gpu, *layout)?,
            layout,
            _pool: pool,
            set,
            bones: Bones {
                upper: Mat4::IDENTITY.to_cols_array_2d(),
                from: low + 0.15 * (high - low),
                to: high,
                count: rest.len() as u32,
            },
        })
    }

    /// Bends the model by an angle; after what earlier frames still read, and before control points are computed and patches drawn.
    ///
    /// # Safety
    /// `cmd` is recording on the device, outside of rendering.
    pub unsafe fn cmd_bend(&self, cmd: vk::CommandBuffer, pose: &mut Pose, angle: f32) {
        let hip = Mat4::from_translation(Vec3::Y * self.bones.from);
        let bones = Bones {
            upper: (hip * Mat4::from_rotation_z(angle) * hip.inverse()).to_cols_array_2d(),
            ..self.bones
        };
        let read = vk::PipelineStageFlags::VERTEX_SHADER
            | vk::PipelineStageFlags::TESSELLATION_CONTROL_SHADER
            | vk::PipelineStageFlags::TESSELLATION_EVALUATION_SHADER
            | vk::PipelineStageFlags::COMPUTE_SHADER;
        let compute = vk::PipelineStageFlags::COMPUTE_SHADER;
        let bind = vk::PipelineBindPoint::COMPUTE;
        let write = vk::AccessFlags::SHADER_WRITE;
        let device = &self.gpu.device;
        let barrier = |from, to| {
            [vk::MemoryBarrier::default()
                .src_access_mask(from)
                .dst_access_mask(to)]
        };
        let before = barrier(write | vk::AccessFlags::TRANSFER_WRITE, write);
        let after = barrier(write, vk::AccessFlags::SHADER_READ);
        let none = vk::DependencyFlags::empty();
        let earlier = read | vk::PipelineStageFlags::TRANSFER;
        // SAFETY: this function's contract.
        unsafe {
            device.cmd_pipeline_barrier(cmd, earlier, compute, none, &before, &[], &[]);
            device.cmd_bind_pipeline(cmd, bind, *self.pipeline);
            device.cmd_bind_descriptor_sets(cmd, bind, *self.layout, 0, &[self.set], &[]);
            let constants = bytemuck::bytes_of(&bones);
            let stage = vk::ShaderStageFlags::COMPUTE;
            device.cmd_push_constants(cmd, *self.layout, stage, 0, constants);
            device.cmd_dispatch(cmd, bones.count.div_ceil(64), 1, 1);
            device.cmd_pipeline_barrier(cmd, compute, read, none, &after, &[], &[]);
        }
        // What was cached of the old positions is of no use any more.
        pose.positions_changed();
    }

    /// The bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.rest.size()
    }
}

fn set_layout(gpu: &Gpu) -> Result<Held<'_, vk::DescriptorSetLayout>, Box<dyn Error>> {
    let bindings = [0, 1].map(|number| {
        vk::DescriptorSetLayoutBinding::default()
            .binding(number)
            .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
    });
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
    // SAFETY: the device is live.
    let layout = unsafe { gpu.device.create_descriptor_set_layout(&info, None) };
    let layout = layout.map_err(failed("vkCreateDescriptorSetLayout"))?;
    Ok(gpu.hold(layout, |gpu, layout| {
        // SAFETY: see `Gpu::buffer`.
        unsafe { gpu.device.destroy_descriptor_set_layout(layout, None) };
    }))
}

fn pool(gpu: &Gpu) -> Result<Held<'_, vk::DescriptorPool>, Box<dyn Error>> {
    let sizes = [vk::DescriptorPoolSize::default()
        .ty(vk::DescriptorType::STORAGE_BUFFER)
        .descriptor_count(2)];
    let info = vk::DescriptorPoolCreateInfo::default()
        .max_sets(1)
        .pool_sizes(&sizes);
    // SAFETY: the device is live.
    let pool = unsafe { gpu.device.create_descriptor_pool(&info, None) };
    let pool = pool.map_err(failed("vkCreateDescriptorPool"))?;
    Ok(gpu.hold(pool, |gpu, pool| {
        // SAFETY: see `Gpu::buffer`.
        unsafe { gpu.device.destroy_descriptor_pool(pool, None) };
    }))
}

fn pipeline(
    gpu: &Gpu,
    layout: vk::PipelineLayout,
) -> Result<Held<'_, vk::Pipeline>, Box<dyn Error>> {
    let module = gpu.module("engine.bend.comp")?;
    let stage = vk::PipelineShaderStageCreateInfo::default()
        .stage(vk::ShaderStageFlags::COMPUTE)
        .module(*module)
        .name(c"main");
    let info = vk::ComputePipelineCreateInfo::default()
        .stage(stage)
        .layout(layout);
    let (device, cache) = (&gpu.device, vk::PipelineCache::null());
    // SAFETY: layout and module are of this device.
    let made = unsafe { device.create_compute_pipelines(cache, &[info], None) };
    let made = made.map_err(|(_, code)| failed("vkCreateComputePipelines")(code))?[0];
    Ok(gpu.hold(made, |gpu, pipeline| {
        // SAFETY: see `Gpu::buffer`.
        unsafe { gpu.device.destroy_pipeline(pipeline, None) };
    }))
}
