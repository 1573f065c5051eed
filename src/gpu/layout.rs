//! The layouts of the descriptor sets and of the push constants that all shaders share.

use ash::vk;

use crate::abi;
use crate::error::Result;
use crate::gpu::failed;
use crate::gpu::features::Enabled;
use crate::gpu::ring::RING_STAGES;
use crate::gpu::sets::{FRAME, POSE, STAGES, STORAGE_BUFFERS, TABLES};

/// The layouts of the three sets and of the pipelines. An engine that brings shaders of its own builds its pipelines with them.
///
/// Sets follow lifetimes: [`abi::SET_TABLES`], [`abi::SET_POSE`], [`abi::SET_FRAME`].
#[derive(Debug)]
pub struct Layout {
    sets: [vk::DescriptorSetLayout; 3],
    pipeline: vk::PipelineLayout,
    enabled: Enabled,
}

impl Layout {
    /// How many storage buffers each stage sees: no more than 8.
    pub const STORAGE_BUFFERS: u32 = STORAGE_BUFFERS;

    /// Makes the layouts: buffers at every binding of `abi`, and an [`abi::Frame`] of push constants.
    ///
    /// # Safety
    /// `device` is live, and was created with what `enabled` is the proof of.
    pub unsafe fn new(device: &ash::Device, enabled: Enabled) -> Result<Layout> {
        let mut layout = Layout {
            sets: [vk::DescriptorSetLayout::null(); 3],
            pipeline: vk::PipelineLayout::null(),
            enabled,
        };
        // SAFETY: this function's contract.
        match unsafe { layout.make(device) } {
            Ok(()) => Ok(layout),
            Err(error) => {
                // SAFETY: they are ours and nothing uses them; null handles are fine.
                unsafe { layout.destroy(device) };
                Err(error)
            }
        }
    }

    /// # Safety
    /// As [`Layout::new`].
    unsafe fn make(&mut self, device: &ash::Device) -> Result<()> {
        for (set, slots) in self.sets.iter_mut().zip([TABLES, POSE, FRAME]) {
            let bindings = slots.iter().map(|&(number, kind, stages)| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(number)
                    .descriptor_type(kind)
                    .descriptor_count(1)
                    .stage_flags(stages)
            });
            let bindings: Vec<vk::DescriptorSetLayoutBinding> = bindings.collect();
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            // SAFETY: the device is live; the info's pointers live through the call.
            *set = unsafe { device.create_descriptor_set_layout(&info, None) }
                .map_err(failed("vkCreateDescriptorSetLayout"))?;
        }
        let constants = [Layout::push_constant_range()];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&self.sets)
            .push_constant_ranges(&constants);
        // SAFETY: as above; the sets were just made from this device.
        self.pipeline = unsafe { device.create_pipeline_layout(&info, None) }
            .map_err(failed("vkCreatePipelineLayout"))?;
        Ok(())
    }

    /// The one range of push constants: an [`abi::Frame`], seen by all stages.
    ///
    /// A pipeline layout of an engine's own has this range and no other: [`cmd_draw`](super::TessellatedSurface::cmd_draw) pushes through
    /// [`Layout::pipeline`], which is compatible only with identical ranges (Vulkan spec, "Pipeline Layout Compatibility"), and a stage may
    /// have a single one (VUID-VkPipelineLayoutCreateInfo-pPushConstantRanges-00292). What else the engine's shaders need goes into sets of
    /// its own, from 3 on.
    ///
    /// ```no_run
    /// use hullform::ash::{self, prelude::VkResult, vk};
    /// use hullform::gpu::Layout;
    ///
    /// /// The layout for pipelines that `Pipelines::from_raw` takes, with a set of the engine's own.
    /// fn engine_layout(
    ///     device: &ash::Device,
    ///     hullform: &Layout,
    ///     own: vk::DescriptorSetLayout,
    /// ) -> VkResult<vk::PipelineLayout> {
    ///     let [tables, pose, frame] = hullform.sets();
    ///     let (sets, ranges) = ([tables, pose, frame, own], [Layout::push_constant_range()]);
    ///     let info = vk::PipelineLayoutCreateInfo::default()
    ///         .set_layouts(&sets)
    ///         .push_constant_ranges(&ranges);
    ///     // SAFETY: device and layouts are live and belong together.
    ///     unsafe { device.create_pipeline_layout(&info, None) }
    /// }
    /// ```
    pub fn push_constant_range() -> vk::PushConstantRange {
        vk::PushConstantRange::default()
            .stage_flags(STAGES)
            .size(size_of::<abi::Frame>() as u32)
    }

    /// What the device can do.
    pub(super) fn enabled(&self) -> Enabled {
        self.enabled
    }

    /// The layouts of the sets, from 0 on.
    pub fn sets(&self) -> [vk::DescriptorSetLayout; 3] {
        self.sets
    }

    pub(super) fn tables_set(&self) -> vk::DescriptorSetLayout {
        self.sets[abi::SET_TABLES as usize]
    }

    pub(super) fn pose_set(&self) -> vk::DescriptorSetLayout {
        self.sets[abi::SET_POSE as usize]
    }

    pub(super) fn frame_set(&self) -> vk::DescriptorSetLayout {
        self.sets[abi::SET_FRAME as usize]
    }

    /// The pipeline stages in which shaders may read tables and poses, on this device.
    pub(super) fn readers(&self) -> vk::PipelineStageFlags {
        let mut readers = vk::PipelineStageFlags::VERTEX_SHADER
            | RING_STAGES
            | vk::PipelineStageFlags::FRAGMENT_SHADER
            | vk::PipelineStageFlags::COMPUTE_SHADER;
        if self.enabled.geometry_shader {
            readers |= vk::PipelineStageFlags::GEOMETRY_SHADER;
        }
        readers
    }

    /// The layout of the pipelines.
    pub fn pipeline(&self) -> vk::PipelineLayout {
        self.pipeline
    }

    /// Destroys them.
    ///
    /// # Safety
    /// `device` made them, no command will be recorded with them again, and no submitted one still uses them.
    pub unsafe fn destroy(self, device: &ash::Device) {
        // SAFETY: this function's contract.
        unsafe {
            device.destroy_pipeline_layout(self.pipeline, None);
            for set in self.sets {
                device.destroy_descriptor_set_layout(set, None);
            }
        }
    }
}
