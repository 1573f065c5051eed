//! The device that a subcommand works with, and the validation layer's verdict at the end.

use crate::options::Global;
use hullform::gpu::Workaround;
use hullform::host::{Device, Instance};
use hullform::{Error, Result};

/// An open device and the driver workarounds to apply on it.
#[derive(Clone)]
pub struct Gpu {
    /// The device.
    pub device: Device,
    /// What to work around; nothing with `--no-workarounds`.
    pub workarounds: Vec<&'static Workaround>,
    instance: Instance,
}

impl Gpu {
    /// Opens the device that the options ask for.
    pub fn open(global: &Global) -> Result<Gpu> {
        let instance = Instance::new(global.validation)?;
        let device = Device::open(&instance, global.device.as_deref())?;
        Ok(Gpu::of(instance, device, global))
    }

    /// A device that has been opened.
    pub fn of(instance: Instance, device: Device, global: &Global) -> Gpu {
        let workarounds = if global.no_workarounds {
            Vec::new()
        } else {
            device.info().workarounds.clone()
        };
        Gpu {
            device,
            workarounds,
            instance,
        }
    }

    /// Its instance.
    #[cfg(feature = "view")]
    pub fn instance(&self) -> &Instance {
        &self.instance
    }

    /// Closes the device and refuses the results if the validation layer had anything to say, up to the device's end.
    pub fn finish(self) -> Result<()> {
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
