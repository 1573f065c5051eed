//! What a driver keeps of pipelines that it has built, so that it builds them faster again.

use ash::vk;

use crate::error::Result;
use crate::gpu::failed;
use crate::host::Device;

/// A pipeline cache of Vulkan's with its device, which destroys it when it is dropped.
pub struct PipelineCache {
    device: Device,
    raw: vk::PipelineCache,
}

impl PipelineCache {
    /// A cache that holds `data`, if this device and driver gave them ([`data`](Self::data)); what others gave is ignored, as the driver does.
    /// None at all make an empty cache.
    ///
    /// # Errors
    /// Vulkan's own.
    ///
    /// # Safety
    /// `data` are empty, or, byte for byte, what some device gave: drivers check the header that they begin with, and need check nothing else
    /// (Vulkan spec, `VkPipelineCacheCreateInfo`).
    pub unsafe fn new(device: &Device, data: &[u8]) -> Result<PipelineCache> {
        let data = if data.starts_with(&header(device)) {
            data
        } else {
            &[]
        };
        let info = vk::PipelineCacheCreateInfo::default().initial_data(data);
        // SAFETY: the device is live; this function's contract for the data.
        let raw = unsafe { device.raw().create_pipeline_cache(&info, None) };
        Ok(PipelineCache {
            raw: raw.map_err(failed("vkCreatePipelineCache"))?,
            device: device.clone(),
        })
    }

    /// The cache, to build pipelines with.
    pub fn raw(&self) -> vk::PipelineCache {
        self.raw
    }

    /// Which device and driver it is of, in hexadecimal digits: a name for a place where its data are kept.
    pub fn origin(&self) -> String {
        let bytes = header(&self.device);
        bytes[8..]
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    }

    /// All that it holds.
    ///
    /// # Errors
    /// Vulkan's own.
    pub fn data(&self) -> Result<Vec<u8>> {
        // SAFETY: the cache is of this live device.
        unsafe { self.device.raw().get_pipeline_cache_data(self.raw) }
            .map_err(failed("vkGetPipelineCacheData"))
    }
}

impl Drop for PipelineCache {
    fn drop(&mut self) {
        if self.device.is_hung() {
            return;
        }
        // SAFETY: it was made from this device; caches are used by nothing but calls that have returned.
        unsafe { self.device.raw().destroy_pipeline_cache(self.raw, None) };
    }
}

/// What the data begin with that this device and driver give (Vulkan spec, `VkPipelineCacheHeaderVersionOne`): length, version, vendor, device, and the
/// UUID of driver and data format.
fn header(device: &Device) -> [u8; 32] {
    let physical = device.info().physical;
    // SAFETY: the physical device is of this live instance.
    let properties = unsafe {
        device
            .instance()
            .raw()
            .get_physical_device_properties(physical)
    };
    let version = vk::PipelineCacheHeaderVersion::ONE.as_raw() as u32;
    let words = [32, version, properties.vendor_id, properties.device_id];
    let mut header = [0; 32];
    for (place, word) in header.chunks_exact_mut(4).zip(words) {
        place.copy_from_slice(&word.to_le_bytes());
    }
    header[16..].copy_from_slice(&properties.pipeline_cache_uuid);
    header
}
