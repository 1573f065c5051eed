//! The pipelines of a bench, built once for whatever is drawn with them.

use ash::vk;

use super::Bench;
use crate::error::Result;
use crate::gpu::{Backend, Fill, PipelineOptions, Pipelines, Residence, Target};
use crate::method::Prepared;
use crate::tessellation::Spacing;

/// What pipelines depend on: the shaders of the passes, who cuts, spacing, and what becomes of the triangles.
pub(super) type PipelineKey = (Vec<&'static str>, Makers, Spacing, bool, vk::CullModeFlags);

/// Who cuts patches, and where their control points live.
pub(super) type Makers = (Backend, Residence);

impl Bench {
    /// Lets `use_them` use the pipelines for a prepared model, which are built once.
    pub(super) fn with_pipelines<T>(
        &self,
        prepared: &Prepared,
        makers: Makers,
        spacing: Spacing,
        fill: Fill,
        cull: vk::CullModeFlags,
        use_them: impl FnOnce(&Pipelines) -> Result<T>,
    ) -> Result<T> {
        let shaders = prepared.passes.iter().map(|pass| pass.shader).collect();
        let key = (shaders, makers, spacing, fill == Fill::Discard, cull);
        let mut all = self.pipelines.borrow_mut();
        if !all.contains_key(&key) {
            let cache = vk::PipelineCache::null();
            let built = self.build(prepared, makers, spacing, fill, cull, cache)?;
            all.insert(key.clone(), built);
        }
        use_them(&all[&key])
    }

    /// Builds pipelines with a cache.
    fn build(
        &self,
        prepared: &Prepared,
        makers: Makers,
        spacing: Spacing,
        fill: Fill,
        cull: vk::CullModeFlags,
        cache: vk::PipelineCache,
    ) -> Result<Pipelines> {
        let (backend, residence) = makers;
        let options = PipelineOptions {
            target: Target {
                samples: self.target.samples(),
                cull,
                ..Target::render_pass(self.target.render_pass())
            },
            backend,
            residence,
            spacing,
            fill,
            fragment: None,
            layout: None,
        };
        let (device, layout) = (self.device.raw(), self.layout());
        // SAFETY: all of one live device.
        unsafe { Pipelines::new(device, layout, cache, prepared, &options) }
    }

    /// Forgets all pipelines, builds new ones for a prepared model with a cache that holds `data`, and returns what the cache holds then.
    pub fn rebuild(
        &self,
        prepared: &Prepared,
        spacing: Spacing,
        fill: Fill,
        data: &[u8],
    ) -> Result<Vec<u8>> {
        self.forget();
        let device = self.device.raw();
        let info = vk::PipelineCacheCreateInfo::default().initial_data(data);
        // SAFETY: the device is live; the data are empty or what this device gave.
        let cache = unsafe { device.create_pipeline_cache(&info, None) }
            .map_err(crate::gpu::failed("vkCreatePipelineCache"))?;
        let makers = (Backend::Tessellator, Residence::Ring);
        let cull = vk::CullModeFlags::NONE;
        let built = self.build(prepared, makers, spacing, fill, cull, cache);
        // SAFETY: the cache is ours, and the pipelines do not need it any more.
        let held = unsafe {
            let held = device.get_pipeline_cache_data(cache);
            device.destroy_pipeline_cache(cache, None);
            held.map_err(crate::gpu::failed("vkGetPipelineCacheData"))
        };
        let shaders = prepared.passes.iter().map(|pass| pass.shader).collect();
        let key = (shaders, makers, spacing, fill == Fill::Discard, cull);
        self.pipelines.borrow_mut().insert(key, built?);
        held
    }
}
