//! The one descriptor set and the push constants that all shaders share.

use ash::vk;

use crate::abi;
use crate::error::Result;
use crate::gpu::failed;
use crate::gpu::features::{BINDINGS, Enabled};

/// Stages that see set 0 and the push constants.
pub(crate) const STAGES: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::VERTEX.as_raw()
        | vk::ShaderStageFlags::TESSELLATION_CONTROL.as_raw()
        | vk::ShaderStageFlags::TESSELLATION_EVALUATION.as_raw()
        | vk::ShaderStageFlags::GEOMETRY.as_raw()
        | vk::ShaderStageFlags::FRAGMENT.as_raw()
        | vk::ShaderStageFlags::COMPUTE.as_raw(),
);

/// The layout of set 0 and of the pipelines. An engine that brings shaders of its own builds its pipelines with it.
#[derive(Debug)]
pub struct Layout {
    set: vk::DescriptorSetLayout,
    pipeline: vk::PipelineLayout,
    enabled: Enabled,
}

impl Layout {
    /// How many storage buffers each stage sees.
    pub const STORAGE_BUFFERS: u32 = BINDINGS;

    /// Makes the layouts: storage buffers at every binding of `abi`, and an [`abi::Frame`] of push constants.
    ///
    /// # Safety
    /// `device` is live, and was created with what `enabled` is the proof of.
    pub unsafe fn new(device: &ash::Device, enabled: Enabled) -> Result<Layout> {
        let bindings: Vec<vk::DescriptorSetLayoutBinding> = (0..BINDINGS)
            .map(|binding| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(binding)
                    .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                    .descriptor_count(1)
                    .stage_flags(STAGES)
            })
            .collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is live; the info's pointers live through the call.
        let set = unsafe { device.create_descriptor_set_layout(&info, None) }
            .map_err(failed("vkCreateDescriptorSetLayout"))?;
        let sets = [set];
        let constants = [Layout::push_constant_range()];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&sets)
            .push_constant_ranges(&constants);
        // SAFETY: as above; `set` was just made from this device.
        match unsafe { device.create_pipeline_layout(&info, None) } {
            Ok(pipeline) => Ok(Layout {
                set,
                pipeline,
                enabled,
            }),
            Err(code) => {
                // SAFETY: `set` is ours and nothing uses it.
                unsafe { device.destroy_descriptor_set_layout(set, None) };
                Err(failed("vkCreatePipelineLayout")(code))
            }
        }
    }

    /// The one range of push constants: an [`abi::Frame`], seen by all stages.
    ///
    /// A pipeline layout of an engine's own has this range and no other: [`cmd_draw`](super::TessellatedSurface::cmd_draw) pushes through
    /// [`Layout::pipeline`], which is compatible only with identical ranges (Vulkan spec, "Pipeline Layout Compatibility"), and a stage may
    /// have a single one (VUID-VkPipelineLayoutCreateInfo-pPushConstantRanges-00292). What else the engine's shaders need goes into sets of
    /// its own, from 1 on.
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
    ///     let (sets, ranges) = ([hullform.set(), own], [Layout::push_constant_range()]);
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

    /// The layout of set 0.
    pub fn set(&self) -> vk::DescriptorSetLayout {
        self.set
    }

    /// The layout of the pipelines.
    pub fn pipeline(&self) -> vk::PipelineLayout {
        self.pipeline
    }

    /// Destroys both.
    ///
    /// # Safety
    /// `device` made them, no command will be recorded with them again, and no submitted one still uses them.
    pub unsafe fn destroy(self, device: &ash::Device) {
        // SAFETY: this function's contract.
        unsafe {
            device.destroy_pipeline_layout(self.pipeline, None);
            device.destroy_descriptor_set_layout(self.set, None);
        }
    }
}
