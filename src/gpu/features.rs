//! What we need of a physical device, and how to switch it on.
//!
//! An engine asks [`Support::query`] whether a device will do and lets [`FeatureChain`] set the features when it creates the
//! device, or sets them in structs of its own with [`Support::require`].

pub(crate) mod extension;
mod extra;

use ash::{khr, vk};

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::gpu::features::extension::has_extension;
use crate::gpu::sets::STORAGE_BUFFERS;

use extra::ExtraChain;
pub use extra::ExtraFeatures;

/// Features that we use where they exist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OptionalFeatures {
    /// Wireframes (`fillModeNonSolid`).
    pub fill_mode_non_solid: bool,
    /// Lines that are wider than a pixel (`wideLines`).
    pub wide_lines: bool,
    /// The backend that cuts patches in geometry shaders (`geometryShader`).
    pub geometry_shader: bool,
    /// Shader invocation counts (`pipelineStatisticsQuery`).
    pub pipeline_statistics_query: bool,
    /// Shading at each sample (`sampleRateShading`).
    pub sample_rate_shading: bool,
    /// Indirect draws with several commands, which begin with any instance (`multiDrawIndirect`, `drawIndirectFirstInstance`).
    pub multi_draw_indirect: bool,
    /// Several views at once, of what is tessellated (`multiview`, `multiviewTessellationShader`).
    pub multiview: bool,
    /// Rendering without render passes (`dynamicRendering`), where Vulkan 1.3 has it.
    pub dynamic_rendering: bool,
    /// `maintenance4`, from Vulkan 1.3 or `VK_KHR_maintenance4`: shader interfaces of unequal width may be linked.
    pub maintenance4: bool,
}

/// The proof that a device was created with the features that our shaders need, and which of the optional ones it has.
///
/// Vulkan does not tell what a device was created with, so whoever creates it shows the structs: [`FeatureChain::enabled`], or
/// [`Support::enabled`] for an engine's own. A [`Layout`](super::Layout) wants it, and so does all that is made with one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Enabled {
    pub(super) fill_mode_non_solid: bool,
    pub(super) wide_lines: bool,
    pub(super) geometry_shader: bool,
    pub(super) multi_draw_indirect: bool,
    pub(super) multiview: bool,
    pub(super) dynamic_rendering: bool,
    pub(super) max_storage_buffer_range: u32,
    pub(super) subgroup_size: u32,
}

impl Enabled {
    /// That dynamic rendering is on as well, as this struct of the device's creation shows; of `VkPhysicalDeviceVulkan13Features` take over the one member.
    pub fn with_dynamic_rendering(
        mut self,
        features: &vk::PhysicalDeviceDynamicRenderingFeatures<'_>,
    ) -> Enabled {
        self.dynamic_rendering = features.dynamic_rendering != 0;
        self
    }

    /// That multiview is on as well, for tessellation too, as this struct shows; of `VkPhysicalDeviceVulkan11Features` take over the members.
    pub fn with_multiview(mut self, features: &vk::PhysicalDeviceMultiviewFeatures<'_>) -> Enabled {
        self.multiview = features.multiview != 0 && features.multiview_tessellation_shader != 0;
        self
    }

    /// How many invocations control shaders have that share their work: as many as run abreast, from 8 to [`abi::CONTROL_INVOCATIONS`]. With more of them a device
    /// would go again through what is done once a patch; lanes beyond what it runs abreast gain nothing.
    pub(super) fn control_invocations(&self) -> u32 {
        self.subgroup_size.clamp(8, abi::CONTROL_INVOCATIONS)
    }

    /// As if the device ran so many invocations abreast (`subgroupSize`): for measurements. What is drawn is the same, bit by bit.
    pub fn with_subgroup_size(mut self, size: u32) -> Enabled {
        self.subgroup_size = size;
        self
    }

    /// # Errors
    /// [`Misuse::Features`] when the optional feature `name` is wanted and was not switched on.
    pub(super) fn require(wanted: bool, enabled: bool, name: &str) -> Result<()> {
        if enabled || !wanted {
            return Ok(());
        }
        Err(Error::Misuse(Misuse::Features {
            lacking: vec![name.into()],
        }))
    }
}

/// How a physical device meets what we need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Support {
    /// The device's Vulkan version.
    pub api_version: u32,
    /// The first queue family that draws and computes: where any draws there is one (Vulkan spec, `VkQueueFlagBits`).
    pub graphics_family: Option<u32>,
    /// Control and evaluation shaders.
    pub tessellation_shader: bool,
    /// Buffer writes and atomics before the fragment shader: control shaders hand stencils over through a buffer.
    pub vertex_pipeline_stores_and_atomics: bool,
    /// Buffers laid out like Rust's `#[repr(C)]`.
    pub scalar_block_layout: bool,
    /// Storage buffers that a stage may see (`maxPerStageDescriptorStorageBuffers`): ours see 8 at most, and devices need not have more than 4.
    pub storage_buffers: u32,
    /// Bytes that a shader sees of a storage buffer (`maxStorageBufferRange`): no table, and no ring, is larger.
    pub max_storage_buffer_range: u32,
    /// How many invocations the device runs abreast (`subgroupSize`).
    pub subgroup_size: u32,
    /// What we use where it exists.
    pub optional: OptionalFeatures,
    /// `maintenance4` comes from an extension that has to be named, as the device is below Vulkan 1.3.
    pub maintenance4_by_extension: bool,
}

impl Support {
    /// Asks `physical`.
    ///
    /// # Safety
    /// `physical` belongs to the live `instance`, which was created for Vulkan 1.2 or later.
    pub unsafe fn query(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Support {
        let mut subgroups = vk::PhysicalDeviceSubgroupProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut subgroups);
        // SAFETY: the caller's instance and physical device, here and below. A device of Vulkan 1.0 leaves the struct as it is, and will not do anyway.
        unsafe { instance.get_physical_device_properties2(physical, &mut properties) };
        let properties = properties.properties;
        let api_version = properties.api_version;
        // SAFETY: as above.
        let queues = unsafe { instance.get_physical_device_queue_family_properties(physical) };
        let mut support = Support {
            api_version,
            storage_buffers: properties.limits.max_per_stage_descriptor_storage_buffers,
            max_storage_buffer_range: properties.limits.max_storage_buffer_range,
            subgroup_size: subgroups.subgroup_size,
            graphics_family: queues
                .iter()
                .position(|family| {
                    family
                        .queue_flags
                        .contains(vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE)
                })
                .map(|family| family as u32),
            ..Support::default()
        };
        // SAFETY: as above.
        unsafe { support.query_features(instance, physical) };
        support
    }

    /// What is lacking, each in words; empty if the device will do.
    pub fn missing(&self) -> Vec<String> {
        let version = self.api_version;
        let (major, minor) = (
            vk::api_version_major(version),
            vk::api_version_minor(version),
        );
        let needs = [
            (
                version >= vk::API_VERSION_1_2,
                format!("Vulkan 1.2 (it has {major}.{minor})"),
            ),
            (self.graphics_family.is_some(), "a graphics queue".into()),
            (
                self.tessellation_shader,
                "tessellation shaders (tessellationShader)".into(),
            ),
            (
                self.vertex_pipeline_stores_and_atomics,
                "buffer writes from control shaders (vertexPipelineStoresAndAtomics)".into(),
            ),
            (
                self.scalar_block_layout,
                "scalar buffer layout (scalarBlockLayout)".into(),
            ),
            (
                self.storage_buffers >= STORAGE_BUFFERS,
                format!(
                    "{STORAGE_BUFFERS} storage buffers a stage (maxPerStageDescriptorStorageBuffers)"
                ),
            ),
        ];
        let lacking = needs.into_iter().filter(|(met, _)| !met);
        lacking.map(|(_, words)| words).collect()
    }

    /// That a device of this kind was created with what our shaders need, as these structs of its creation show. A feature that was switched on
    /// in another struct (`VkPhysicalDeviceScalarBlockLayoutFeatures`) is shown in `vulkan12` all the same.
    ///
    /// # Errors
    /// [`Misuse::Features`] names what is lacking.
    pub fn enabled(
        &self,
        core: &vk::PhysicalDeviceFeatures,
        vulkan12: &vk::PhysicalDeviceVulkan12Features<'_>,
    ) -> Result<Enabled> {
        let on = |feature: vk::Bool32| feature != 0;
        let shown = Support {
            tessellation_shader: on(core.tessellation_shader),
            vertex_pipeline_stores_and_atomics: on(core.vertex_pipeline_stores_and_atomics),
            scalar_block_layout: on(vulkan12.scalar_block_layout),
            ..*self
        };
        let lacking = shown.missing();
        if !lacking.is_empty() {
            return Err(Error::Misuse(Misuse::Features { lacking }));
        }
        Ok(Enabled {
            fill_mode_non_solid: on(core.fill_mode_non_solid),
            wide_lines: on(core.wide_lines),
            geometry_shader: on(core.geometry_shader),
            multi_draw_indirect: on(core.multi_draw_indirect)
                && on(core.draw_indirect_first_instance),
            multiview: false,
            dynamic_rendering: false,
            max_storage_buffer_range: self.max_storage_buffer_range,
            subgroup_size: self.subgroup_size,
        })
    }

    /// The device extensions to enable for the features of this struct.
    pub fn extensions(&self) -> Vec<&'static std::ffi::CStr> {
        if self.maintenance4_by_extension {
            vec![khr::maintenance4::NAME]
        } else {
            Vec::new()
        }
    }

    /// Sets the required features, and the optional ones that exist, in an engine's own structs; clears nothing.
    ///
    /// `maintenance4`, multiview and dynamic rendering have structs of their own and are left to the caller.
    pub fn require(
        &self,
        core: &mut vk::PhysicalDeviceFeatures,
        vulkan12: &mut vk::PhysicalDeviceVulkan12Features<'_>,
    ) {
        let set = |field: &mut vk::Bool32, wanted: bool| *field |= vk::Bool32::from(wanted);
        set(&mut core.tessellation_shader, true);
        set(&mut core.vertex_pipeline_stores_and_atomics, true);
        set(&mut vulkan12.scalar_block_layout, true);
        let optional = self.optional;
        set(&mut core.fill_mode_non_solid, optional.fill_mode_non_solid);
        set(&mut core.wide_lines, optional.wide_lines);
        set(&mut core.geometry_shader, optional.geometry_shader);
        set(
            &mut core.pipeline_statistics_query,
            optional.pipeline_statistics_query,
        );
        set(&mut core.sample_rate_shading, optional.sample_rate_shading);
        let multi_draw = optional.multi_draw_indirect;
        set(&mut core.multi_draw_indirect, multi_draw);
        set(&mut core.draw_indirect_first_instance, multi_draw);
    }

    /// # Safety
    /// As [`Support::query`].
    unsafe fn query_features(&mut self, instance: &ash::Instance, physical: vk::PhysicalDevice) {
        let mut scalar = vk::PhysicalDeviceScalarBlockLayoutFeatures::default();
        let mut maintenance4 = vk::PhysicalDeviceMaintenance4Features::default();
        let mut multiview = vk::PhysicalDeviceMultiviewFeatures::default();
        let mut rendering = vk::PhysicalDeviceDynamicRenderingFeatures::default();
        let mut features = vk::PhysicalDeviceFeatures2::default();
        // Structs from beyond the device's version stay out of the chain: nobody would fill them in.
        if self.api_version >= vk::API_VERSION_1_2 {
            features = features.push_next(&mut scalar).push_next(&mut multiview);
        }
        let core13 = self.api_version >= vk::API_VERSION_1_3;
        // SAFETY: the caller's instance and physical device. One that fails to answer goes without: we can do without.
        let by_extension = !core13
            && unsafe { has_extension(instance, physical, khr::maintenance4::NAME) } == Ok(true);
        if core13 || by_extension {
            features = features.push_next(&mut maintenance4);
        }
        if core13 {
            features = features.push_next(&mut rendering);
        }
        // SAFETY: the caller's; each struct in the chain is one that the device knows and outlives the call.
        unsafe { instance.get_physical_device_features2(physical, &mut features) };
        let core = features.features;
        self.tessellation_shader = core.tessellation_shader != 0;
        self.vertex_pipeline_stores_and_atomics = core.vertex_pipeline_stores_and_atomics != 0;
        self.scalar_block_layout = scalar.scalar_block_layout != 0;
        self.optional = OptionalFeatures {
            fill_mode_non_solid: core.fill_mode_non_solid != 0,
            wide_lines: core.wide_lines != 0,
            geometry_shader: core.geometry_shader != 0,
            pipeline_statistics_query: core.pipeline_statistics_query != 0,
            sample_rate_shading: core.sample_rate_shading != 0,
            multi_draw_indirect: core.multi_draw_indirect != 0
                && core.draw_indirect_first_instance != 0,
            multiview: multiview.multiview != 0 && multiview.multiview_tessellation_shader != 0,
            dynamic_rendering: rendering.dynamic_rendering != 0,
            maintenance4: maintenance4.maintenance4 != 0,
        };
        self.maintenance4_by_extension = by_extension && self.optional.maintenance4;
    }
}

/// The feature structs to chain when a device is created, for those who have none of their own.
pub struct FeatureChain {
    support: Support,
    core: vk::PhysicalDeviceFeatures2<'static>,
    vulkan12: vk::PhysicalDeviceVulkan12Features<'static>,
    multiview: vk::PhysicalDeviceMultiviewFeatures<'static>,
    maintenance4: Option<vk::PhysicalDeviceMaintenance4Features<'static>>,
    rendering: Option<vk::PhysicalDeviceDynamicRenderingFeatures<'static>>,
    extra: ExtraChain,
}

impl FeatureChain {
    /// The required features, and the optional ones that `support` found.
    pub fn new(support: &Support) -> FeatureChain {
        let mut core = vk::PhysicalDeviceFeatures2::default();
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default();
        support.require(&mut core.features, &mut vulkan12);
        let maintenance4 = vk::PhysicalDeviceMaintenance4Features::default().maintenance4(true);
        let views = support.optional.multiview;
        let multiview = vk::PhysicalDeviceMultiviewFeatures::default()
            .multiview(views)
            .multiview_tessellation_shader(views);
        let rendering =
            vk::PhysicalDeviceDynamicRenderingFeatures::default().dynamic_rendering(true);
        FeatureChain {
            support: *support,
            core,
            vulkan12,
            multiview,
            maintenance4: support.optional.maintenance4.then_some(maintenance4),
            rendering: support.optional.dynamic_rendering.then_some(rendering),
            extra: ExtraChain::default(),
        }
    }

    /// Switches on what is asked for beyond that; the device must have it.
    pub fn with(mut self, extra: ExtraFeatures) -> FeatureChain {
        extra.switch_on(&mut self.core.features, &mut self.vulkan12);
        self.extra = ExtraChain::new(extra);
        self
    }

    /// That a device which is created with this chain has what our shaders need.
    ///
    /// # Errors
    /// As [`Support::enabled`].
    pub fn enabled(&self) -> Result<Enabled> {
        let enabled = self.support.enabled(&self.core.features, &self.vulkan12)?;
        let enabled = enabled.with_multiview(&self.multiview);
        Ok(match &self.rendering {
            Some(rendering) => enabled.with_dynamic_rendering(rendering),
            None => enabled,
        })
    }

    /// Chains the structs to `info`.
    ///
    /// # Safety
    /// The device's [`Support::missing`] is empty; [`Support::extensions`], and [`ExtraFeatures::extensions`] of what was asked for, are enabled in `info`. `info` has no
    /// `pEnabledFeatures` (VUID-VkDeviceCreateInfo-pNext-00373), and none of `VkPhysicalDeviceFeatures2`,
    /// `VkPhysicalDeviceVulkan12Features` (nor a struct that it contains, VUID-VkDeviceCreateInfo-pNext-02830),
    /// `VkPhysicalDeviceMultiviewFeatures`, `VkPhysicalDeviceVulkan11Features`, `VkPhysicalDeviceMaintenance4Features`,
    /// `VkPhysicalDeviceDynamicRenderingFeatures` or `VkPhysicalDeviceVulkan13Features` is chained to it already: if the engine
    /// has these, [`Support::require`] sets the features in them.
    pub unsafe fn chain<'a>(
        &'a mut self,
        mut info: vk::DeviceCreateInfo<'a>,
    ) -> vk::DeviceCreateInfo<'a> {
        if let Some(maintenance4) = &mut self.maintenance4 {
            info = info.push_next(maintenance4);
        }
        if let Some(rendering) = &mut self.rendering {
            info = info.push_next(rendering);
        }
        info = self.extra.chain(info).push_next(&mut self.multiview);
        info.push_next(&mut self.vulkan12).push_next(&mut self.core)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Support {
        Support {
            api_version: vk::API_VERSION_1_3,
            graphics_family: Some(0),
            tessellation_shader: true,
            vertex_pipeline_stores_and_atomics: true,
            scalar_block_layout: true,
            storage_buffers: STORAGE_BUFFERS,
            ..Support::default()
        }
    }

    #[test]
    fn a_good_device_lacks_nothing() {
        assert!(good().missing().is_empty());
    }

    #[test]
    fn what_is_lacking_is_named() {
        let lacking = Support {
            api_version: vk::API_VERSION_1_1,
            graphics_family: None,
            scalar_block_layout: false,
            ..good()
        };
        let words = lacking.missing();
        assert_eq!(words.len(), 3);
        assert_eq!(words[0], "Vulkan 1.2 (it has 1.1)");
        assert!(words[2].contains("scalarBlockLayout"));
        assert_eq!(Support::default().missing().len(), 6);
    }

    #[test]
    fn require_keeps_what_the_engine_set() {
        let mut core = vk::PhysicalDeviceFeatures::default()
            .sampler_anisotropy(true)
            .sample_rate_shading(true);
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default().timeline_semaphore(true);
        good().require(&mut core, &mut vulkan12);
        assert_eq!(core.sampler_anisotropy, 1);
        assert_eq!(core.sample_rate_shading, 1);
        assert_eq!(core.tessellation_shader, 1);
        assert_eq!(core.fill_mode_non_solid, 0);
        assert_eq!(vulkan12.timeline_semaphore, 1);
        assert_eq!(vulkan12.scalar_block_layout, 1);
    }

    #[test]
    fn a_device_without_the_features_is_no_device_of_ours() {
        let support = good();
        let enabled = FeatureChain::new(&support).enabled();
        assert!(!enabled.expect("all is switched on").geometry_shader);
        let core = vk::PhysicalDeviceFeatures::default().tessellation_shader(true);
        let vulkan12 = vk::PhysicalDeviceVulkan12Features::default().scalar_block_layout(true);
        let Err(Error::Misuse(Misuse::Features { lacking })) = support.enabled(&core, &vulkan12)
        else {
            panic!("stores and atomics are off");
        };
        assert_eq!(lacking.len(), 1);
        assert!(lacking[0].contains("vertexPipelineStoresAndAtomics"));
    }

    #[test]
    fn an_extension_is_named_only_where_it_is_needed() {
        assert!(good().extensions().is_empty());
        let older = Support {
            api_version: vk::API_VERSION_1_2,
            maintenance4_by_extension: true,
            ..good()
        };
        assert_eq!(older.extensions(), [khr::maintenance4::NAME]);
    }
}
