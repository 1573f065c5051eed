//! Which driver, in which version.

use crate::error::visible;
use ash::vk;
use std::ffi::{CStr, c_char};
use std::fmt;

/// A driver's version as its makers write it, comparable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Version(pub u32, pub u32, pub u32);

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.0, self.1, self.2)
    }
}

/// What a physical device says about its driver.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Driver {
    /// Vulkan's number for the driver.
    pub id: vk::DriverId,
    /// Its name (`llvmpipe`, `radv`, `NVIDIA`).
    pub name: String,
    /// Its own words, usually with the version (`Mesa 22.3.6 (LLVM 15.0.6)`).
    pub info: String,
    /// The version that workarounds are keyed on; 0.0.0 when unknown.
    pub version: Version,
}

impl Driver {
    /// Asks `physical` about its driver. A device below Vulkan 1.2 cannot say and gets an id of 0.
    ///
    /// # Safety
    /// `physical` belongs to the live `instance`, which was created for Vulkan 1.2 or later.
    pub unsafe fn query(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Driver {
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
        // SAFETY: the caller's instance and device; a device that does not know the driver struct ignores it.
        unsafe { instance.get_physical_device_properties2(physical, &mut properties) };
        let packed = properties.properties.driver_version;
        Driver::new(
            driver.driver_id,
            text(&driver.driver_name),
            text(&driver.driver_info),
            packed,
        )
    }

    /// A driver from what `VkPhysicalDeviceDriverProperties` says and the packed `driverVersion`.
    pub fn new(id: vk::DriverId, name: String, info: String, packed: u32) -> Driver {
        // lavapipe packs 0.0.1 into driverVersion whatever its release is, so Mesa's drivers are asked for their words.
        let version = mesa_version(&info).unwrap_or_else(|| unpack(id, packed));
        Driver {
            id,
            name,
            info,
            version,
        }
    }
}

/// The release in `Mesa 25.0.7-2 (LLVM 19.1.7)`; `None` for anything that does not begin so.
fn mesa_version(info: &str) -> Option<Version> {
    let release = info.strip_prefix("Mesa ")?;
    let digits_and_dots = |c: char| c.is_ascii_digit() || c == '.';
    let end = release
        .find(|c| !digits_and_dots(c))
        .unwrap_or(release.len());
    let mut parts = release[..end].split('.').map(|part| part.parse().ok());
    let major = parts.next()??;
    let mut or_zero = || parts.next().flatten().unwrap_or(0);
    Some(Version(major, or_zero(), or_zero()))
}

/// `driverVersion` in the packing its vendor uses: NVIDIA 10.8.8.6 bits, the others Vulkan's 10.10.12.
fn unpack(id: vk::DriverId, packed: u32) -> Version {
    if id == vk::DriverId::NVIDIA_PROPRIETARY {
        Version(packed >> 22, packed >> 14 & 0xff, packed >> 6 & 0xff)
    } else {
        Version(packed >> 22, packed >> 12 & 0x3ff, packed & 0xfff)
    }
}

/// A fixed array that Vulkan filled with a C string, with its control characters escaped; empty if it forgot the terminator.
pub(crate) fn text(chars: &[c_char]) -> String {
    CStr::from_bytes_until_nul(bytemuck::cast_slice(chars))
        .map(|name| visible(&name.to_string_lossy()).into_owned())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn version_of(id: vk::DriverId, info: &str, packed: u32) -> Version {
        Driver::new(id, String::new(), info.into(), packed).version
    }

    #[test]
    fn mesa_says_its_release_in_words() {
        let lavapipe = |info| version_of(vk::DriverId::MESA_LLVMPIPE, info, 1);
        assert_eq!(lavapipe("Mesa 22.3.6 (LLVM 15.0.6)"), Version(22, 3, 6));
        assert_eq!(lavapipe("Mesa 25.0.7-2 (LLVM 19.1.7)"), Version(25, 0, 7));
        assert_eq!(lavapipe("Mesa 24.1.0-devel (git-1)"), Version(24, 1, 0));
        assert_eq!(lavapipe("Mesa 26.1"), Version(26, 1, 0));
        assert_eq!(lavapipe("Mesa"), Version(0, 0, 1));
        assert_eq!(lavapipe("Mesa x"), Version(0, 0, 1));
    }

    #[test]
    fn other_drivers_pack_theirs() {
        let nvidia = 550 << 22 | 54 << 14 | 15 << 6;
        let nvidia = version_of(vk::DriverId::NVIDIA_PROPRIETARY, "550.54.15", nvidia);
        assert_eq!(nvidia, Version(550, 54, 15));
        let amd = vk::make_api_version(0, 2, 0, 279);
        let amd = version_of(vk::DriverId::AMD_PROPRIETARY, "23.20", amd);
        assert_eq!(amd, Version(2, 0, 279));
    }

    #[test]
    fn text_without_terminator_is_empty() {
        assert_eq!(text(&[b'a' as c_char; 4]), "");
        assert_eq!(text(&[b'a' as c_char, 0]), "a");
    }
}
