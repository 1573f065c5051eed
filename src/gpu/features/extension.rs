//! Which extensions a device has.

use ash::vk;

/// Whether `physical` has the device extension `name`.
///
/// # Errors
/// What `vkEnumerateDeviceExtensionProperties` returns.
///
/// # Safety
/// `physical` belongs to the live `instance`.
pub(crate) unsafe fn has_extension(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    name: &std::ffi::CStr,
) -> std::result::Result<bool, vk::Result> {
    // SAFETY: the caller's instance and physical device.
    let all = unsafe { instance.enumerate_device_extension_properties(physical) }?;
    let named =
        |extension: &vk::ExtensionProperties| extension.extension_name_as_c_str() == Ok(name);
    Ok(all.iter().any(named))
}
