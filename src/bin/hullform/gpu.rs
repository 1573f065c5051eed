//! The device that a subcommand works with, and the validation layer's verdict at the end.

use crate::options::Global;
use crate::pipelines::{self, Kept};
#[cfg(feature = "view")]
use hullform::ash::vk;
use hullform::gpu::Workaround;
use hullform::host::{Bench, Device, Instance, OffscreenTarget};
use hullform::{Error, Result};

/// An open device and the driver workarounds to apply on it.
#[derive(Clone)]
pub struct Gpu {
    /// The device.
    pub device: Device,
    /// What to work around; nothing with `--no-workarounds`.
    pub workarounds: Vec<&'static Workaround>,
    pipelines: Option<Kept>,
    instance: Instance,
}

impl Gpu {
    /// Opens the device that the options ask for.
    pub fn open(global: &Global) -> Result<Gpu> {
        let instance = Instance::new(global.validation)?;
        let device = Device::open(&instance, global.device.as_deref())?;
        Gpu::of(instance, device, global)
    }

    /// A device that has been opened.
    pub fn of(instance: Instance, device: Device, global: &Global) -> Result<Gpu> {
        let workarounds = if global.no_workarounds {
            Vec::new()
        } else {
            device.info().workarounds.clone()
        };
        let folder = pipelines::folder(global.pipeline_cache.as_deref());
        let kept = folder.map(|folder| Kept::open(&device, &folder));
        Ok(Gpu {
            pipelines: kept.transpose()?,
            device,
            workarounds,
            instance,
        })
    }

    /// Its instance.
    #[cfg(feature = "view")]
    pub fn instance(&self) -> &Instance {
        &self.instance
    }

    /// A bench that draws into `target`, whose pipelines are kept from run to run.
    pub fn bench(&self, target: OffscreenTarget) -> Result<Bench> {
        let kept = self.pipelines.as_ref().map(Kept::cache);
        Ok(Bench::new(target)?.with_cache(kept))
    }

    /// The cache of the pipelines that are kept from run to run, or none.
    #[cfg(feature = "view")]
    pub fn pipeline_cache(&self) -> vk::PipelineCache {
        let kept = self.pipelines.as_ref().map(Kept::cache);
        kept.map_or(vk::PipelineCache::null(), |cache| cache.raw())
    }

    /// Keeps the pipelines that have been built.
    pub fn keep_pipelines(&self) -> Result<()> {
        self.pipelines.as_ref().map_or(Ok(()), Kept::keep)
    }

    /// Keeps the pipelines, closes the device and refuses the results if the validation layer had anything to say, up to the device's end.
    pub fn finish(self) -> Result<()> {
        self.keep_pipelines()?;
        drop(self.device);
        check(&self.instance)
    }
}

/// Refuses results about which the validation layer complained.
pub fn check(instance: &Instance) -> Result<()> {
    let messages = instance.validation_messages();
    match messages.as_slice() {
        [] => Ok(()),
        [only] => Err(Error::Refused(format!("a validation message: {only}"))),
        [first, ..] => Err(Error::Refused(format!(
            "{} validation messages, the first: {first}",
            messages.len()
        ))),
    }
}
