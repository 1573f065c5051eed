//! Features that none of our own shaders use.

use std::ffi::CStr;

use ash::{ext, khr, vk};

use crate::error::Result;
use crate::gpu::failed;
use crate::gpu::features::extension::has_extension;

/// Features that are there on request: our own shaders use none of them, the conformance suite does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExtraFeatures {
    /// Reads and writes beyond a buffer's end do no harm (`robustBufferAccess`). Every device has it; some are slower with it.
    pub robust_buffer_access: bool,
    /// Shaders may speak the Vulkan memory model (`vulkanMemoryModel`), for atomic operations as well (`vulkanMemoryModelDeviceScope`).
    ///
    /// With the first of the two alone our shaders are not valid: their atomic operations have device scope
    /// (VUID-RuntimeSpirv-vulkanMemoryModel-06265).
    pub vulkan_memory_model: bool,
    /// Shaders may clip primitives and leave them out (`shaderClipDistance`, `shaderCullDistance`).
    pub clip_and_cull_distances: bool,
    /// Points of any size, which evaluation shaders say (`largePoints`, `shaderTessellationAndGeometryPointSize`).
    pub point_sizes: bool,
    /// Occlusion queries that count samples (`occlusionQueryPrecise`).
    pub precise_occlusion: bool,
    /// Vertices are captured before the rasteriser (`VK_EXT_transform_feedback`).
    pub transform_feedback: bool,
    /// Draws say of how many control points their patches are (`VK_EXT_extended_dynamic_state2`).
    pub dynamic_patch_size: bool,
    /// Pipelines are linked from parts (`VK_EXT_graphics_pipeline_library`).
    pub pipeline_libraries: bool,
    /// Shaders are bound one by one, without pipelines (`VK_EXT_shader_object`). It draws in dynamic rendering alone.
    pub shader_objects: bool,
    /// One call draws several ranges of vertices (`VK_EXT_multi_draw`).
    pub multi_draw: bool,
    /// Indirect draws whose number is in a buffer (`drawIndirectCount`).
    pub draw_indirect_count: bool,
    /// Barriers and events of Vulkan 1.3 (`synchronization2`).
    pub synchronization2: bool,
}

impl ExtraFeatures {
    /// The device extensions to enable for these.
    pub fn extensions(&self) -> Vec<&'static CStr> {
        let mut named = Vec::new();
        if self.transform_feedback {
            named.push(ext::transform_feedback::NAME);
        }
        if self.dynamic_patch_size {
            named.push(ext::extended_dynamic_state2::NAME);
        }
        if self.pipeline_libraries {
            named.push(khr::pipeline_library::NAME);
            named.push(ext::graphics_pipeline_library::NAME);
        }
        if self.shader_objects {
            named.push(ext::shader_object::NAME);
        }
        if self.multi_draw {
            named.push(ext::multi_draw::NAME);
        }
        named
    }

    /// Which of them a device of this version has.
    ///
    /// # Errors
    /// What `vkEnumerateDeviceExtensionProperties` returns.
    ///
    /// # Safety
    /// `physical` belongs to the live `instance`, which was created for Vulkan 1.2 or later.
    pub unsafe fn query(
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        api_version: u32,
    ) -> Result<ExtraFeatures> {
        let has = |name| {
            // SAFETY: the caller's.
            let found = unsafe { has_extension(instance, physical, name) };
            found.map_err(failed("vkEnumerateDeviceExtensionProperties"))
        };
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default();
        let libraries =
            has(khr::pipeline_library::NAME)? && has(ext::graphics_pipeline_library::NAME)?;
        let mut chain = ExtraChain {
            feedback: has(ext::transform_feedback::NAME)?.then(Default::default),
            dynamic_state: has(ext::extended_dynamic_state2::NAME)?.then(Default::default),
            libraries: libraries.then(Default::default),
            objects: has(ext::shader_object::NAME)?.then(Default::default),
            multi_draw: has(ext::multi_draw::NAME)?.then(Default::default),
            synchronization: (api_version >= vk::API_VERSION_1_3).then(Default::default),
        };
        let mut features = vk::PhysicalDeviceFeatures2::default();
        if api_version >= vk::API_VERSION_1_2 {
            features = features.push_next(&mut vulkan12);
        }
        features = chain.query(features);
        // SAFETY: the caller's; each struct in the chain is one that the device knows and outlives the call.
        unsafe { instance.get_physical_device_features2(physical, &mut features) };
        let core = features.features;
        Ok(ExtraFeatures {
            robust_buffer_access: core.robust_buffer_access != 0,
            vulkan_memory_model: vulkan12.vulkan_memory_model != 0
                && vulkan12.vulkan_memory_model_device_scope != 0,
            clip_and_cull_distances: core.shader_clip_distance != 0
                && core.shader_cull_distance != 0,
            point_sizes: core.large_points != 0
                && core.shader_tessellation_and_geometry_point_size != 0,
            precise_occlusion: core.occlusion_query_precise != 0,
            transform_feedback: chain
                .feedback
                .is_some_and(|own| own.transform_feedback != 0),
            dynamic_patch_size: chain
                .dynamic_state
                .is_some_and(|own| own.extended_dynamic_state2_patch_control_points != 0),
            pipeline_libraries: chain
                .libraries
                .is_some_and(|own| own.graphics_pipeline_library != 0),
            shader_objects: chain.objects.is_some_and(|own| own.shader_object != 0),
            multi_draw: chain.multi_draw.is_some_and(|own| own.multi_draw != 0),
            draw_indirect_count: vulkan12.draw_indirect_count != 0,
            synchronization2: chain
                .synchronization
                .is_some_and(|own| own.synchronization2 != 0),
        })
    }

    /// Sets those that have members in these structs; clears nothing.
    pub(super) fn switch_on(
        &self,
        core: &mut vk::PhysicalDeviceFeatures,
        vulkan12: &mut vk::PhysicalDeviceVulkan12Features<'_>,
    ) {
        let set = |field: &mut vk::Bool32, wanted: bool| *field |= vk::Bool32::from(wanted);
        set(&mut core.robust_buffer_access, self.robust_buffer_access);
        set(&mut vulkan12.vulkan_memory_model, self.vulkan_memory_model);
        let scope = &mut vulkan12.vulkan_memory_model_device_scope;
        set(scope, self.vulkan_memory_model);
        set(&mut vulkan12.draw_indirect_count, self.draw_indirect_count);
        set(&mut core.shader_clip_distance, self.clip_and_cull_distances);
        set(&mut core.shader_cull_distance, self.clip_and_cull_distances);
        set(&mut core.large_points, self.point_sizes);
        let size = &mut core.shader_tessellation_and_geometry_point_size;
        set(size, self.point_sizes);
        set(&mut core.occlusion_query_precise, self.precise_occlusion);
    }
}

/// The structs of those that have one.
#[derive(Default)]
pub(super) struct ExtraChain {
    feedback: Option<vk::PhysicalDeviceTransformFeedbackFeaturesEXT<'static>>,
    dynamic_state: Option<vk::PhysicalDeviceExtendedDynamicState2FeaturesEXT<'static>>,
    libraries: Option<vk::PhysicalDeviceGraphicsPipelineLibraryFeaturesEXT<'static>>,
    objects: Option<vk::PhysicalDeviceShaderObjectFeaturesEXT<'static>>,
    multi_draw: Option<vk::PhysicalDeviceMultiDrawFeaturesEXT<'static>>,
    synchronization: Option<vk::PhysicalDeviceSynchronization2Features<'static>>,
}

/// Chains every struct that is there to an info.
macro_rules! chain_all {
    ($chain:expr, $info:expr) => {{
        let (chain, mut info) = ($chain, $info);
        if let Some(feedback) = &mut chain.feedback {
            info = info.push_next(feedback);
        }
        if let Some(dynamic) = &mut chain.dynamic_state {
            info = info.push_next(dynamic);
        }
        if let Some(libraries) = &mut chain.libraries {
            info = info.push_next(libraries);
        }
        if let Some(objects) = &mut chain.objects {
            info = info.push_next(objects);
        }
        if let Some(multi_draw) = &mut chain.multi_draw {
            info = info.push_next(multi_draw);
        }
        if let Some(synchronization) = &mut chain.synchronization {
            info = info.push_next(synchronization);
        }
        info
    }};
}

impl ExtraChain {
    pub(super) fn new(extra: ExtraFeatures) -> ExtraChain {
        let feedback =
            vk::PhysicalDeviceTransformFeedbackFeaturesEXT::default().transform_feedback(true);
        let dynamic = vk::PhysicalDeviceExtendedDynamicState2FeaturesEXT::default()
            .extended_dynamic_state2_patch_control_points(true);
        let libraries = vk::PhysicalDeviceGraphicsPipelineLibraryFeaturesEXT::default()
            .graphics_pipeline_library(true);
        let objects = vk::PhysicalDeviceShaderObjectFeaturesEXT::default().shader_object(true);
        let multi_draw = vk::PhysicalDeviceMultiDrawFeaturesEXT::default().multi_draw(true);
        let synchronization =
            vk::PhysicalDeviceSynchronization2Features::default().synchronization2(true);
        ExtraChain {
            feedback: extra.transform_feedback.then_some(feedback),
            dynamic_state: extra.dynamic_patch_size.then_some(dynamic),
            libraries: extra.pipeline_libraries.then_some(libraries),
            objects: extra.shader_objects.then_some(objects),
            multi_draw: extra.multi_draw.then_some(multi_draw),
            synchronization: extra.synchronization2.then_some(synchronization),
        }
    }

    fn query<'a>(
        &'a mut self,
        features: vk::PhysicalDeviceFeatures2<'a>,
    ) -> vk::PhysicalDeviceFeatures2<'a> {
        chain_all!(self, features)
    }

    pub(super) fn chain<'a>(
        &'a mut self,
        info: vk::DeviceCreateInfo<'a>,
    ) -> vk::DeviceCreateInfo<'a> {
        chain_all!(self, info)
    }
}
