//! Which devices there are, and which of them to take.

use crate::error::{Error, Result};
use crate::gpu::driver::text;
use crate::gpu::{Driver, Support, Workaround, workarounds};
use crate::host::Instance;
use crate::host::instance::unavailable;
use ash::vk;
use std::fmt::Write;

/// A physical device and how it suits us.
#[derive(Clone, Debug)]
pub struct DeviceInfo {
    /// Its number, which selects it.
    pub index: usize,
    /// Its name; a part of it selects it as well.
    pub name: String,
    /// Discrete, integrated, virtual, or a CPU.
    pub kind: vk::PhysicalDeviceType,
    /// Its driver.
    pub driver: Driver,
    /// Its features.
    pub support: Support,
    /// What it lacks for us, each in words; empty if it will do.
    pub missing: Vec<String>,
    /// The driver workarounds that apply to it.
    pub workarounds: Vec<&'static Workaround>,
    /// Its limits.
    pub limits: vk::PhysicalDeviceLimits,
    /// Its handle.
    pub physical: vk::PhysicalDevice,
}

impl DeviceInfo {
    /// Its kind in words.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            vk::PhysicalDeviceType::DISCRETE_GPU => "discrete GPU",
            vk::PhysicalDeviceType::INTEGRATED_GPU => "integrated GPU",
            vk::PhysicalDeviceType::VIRTUAL_GPU => "virtual GPU",
            vk::PhysicalDeviceType::CPU => "CPU",
            _ => "other",
        }
    }

    /// Whether it is a driver that computes everything itself.
    pub fn is_software(&self) -> bool {
        self.kind == vk::PhysicalDeviceType::CPU
    }

    /// Whether it will do.
    pub fn is_suitable(&self) -> bool {
        self.missing.is_empty()
    }
}

/// Every physical device, in Vulkan's order.
///
/// # Errors
/// [`Error::NoDevice`] if no driver answers.
pub fn devices(instance: &Instance) -> Result<Vec<DeviceInfo>> {
    // SAFETY: the instance is live.
    let all = unsafe { instance.raw().enumerate_physical_devices() };
    let all = all.map_err(|code| match code {
        vk::Result::ERROR_INITIALIZATION_FAILED => Error::NoDevice(
            "no Vulkan driver works here; install one (Debian: mesa-vulkan-drivers)".into(),
        ),
        code => unavailable("vkEnumeratePhysicalDevices")(code),
    })?;
    let describe = |(index, physical)| describe(instance, index, physical);
    Ok(all.into_iter().enumerate().map(describe).collect())
}

fn describe(instance: &Instance, index: usize, physical: vk::PhysicalDevice) -> DeviceInfo {
    let raw = instance.raw();
    // SAFETY: `physical` was just listed by this live instance, here and below.
    let properties = unsafe { raw.get_physical_device_properties(physical) };
    // SAFETY: as above, and the instance was made for Vulkan 1.3.
    let driver = unsafe { Driver::query(raw, physical) };
    // SAFETY: as above.
    let support = unsafe { Support::query(raw, physical) };
    DeviceInfo {
        index,
        name: text(&properties.device_name),
        kind: properties.device_type,
        workarounds: workarounds(&driver),
        driver,
        support,
        missing: support.missing(),
        limits: properties.limits,
        physical,
    }
}

/// The device that `selector` means (an index, else a part of a name in any case), or without one the first suitable discrete
/// GPU, else integrated, else any.
pub(crate) fn choose(devices: &[DeviceInfo], selector: Option<&str>) -> Result<DeviceInfo> {
    let asked: Vec<&DeviceInfo> = match selector {
        None => devices.iter().collect(),
        Some(selector) => select(devices, selector),
    };
    let suitable = asked.iter().filter(|device| device.is_suitable());
    let best = suitable.min_by_key(|device| rank(device.kind));
    best.map(|&device| device.clone())
        .ok_or_else(|| none_suitable(devices, &asked, selector))
}

/// The device that would be taken if it lacked nothing: the best of those that `selector` asks for, as for [`Device::open`](crate::host::Device::open), where
/// none of them will do. None where one will, or where there is none.
pub fn unsuitable(devices: &[DeviceInfo], selector: Option<&str>) -> Option<DeviceInfo> {
    let asked: Vec<&DeviceInfo> = match selector {
        None => devices.iter().collect(),
        Some(selector) => select(devices, selector),
    };
    if asked.iter().any(|device| device.is_suitable()) {
        return None;
    }
    let best = asked.iter().min_by_key(|device| rank(device.kind));
    best.map(|&device| device.clone())
}

fn select<'a>(devices: &'a [DeviceInfo], selector: &str) -> Vec<&'a DeviceInfo> {
    // A number is never a part of a name: the 1 of a device that is not there would be that of "LLVM 15.0.6".
    if !selector.is_empty() && selector.bytes().all(|byte| byte.is_ascii_digit()) {
        let index = selector.parse().ok();
        let device = index.and_then(|index: usize| devices.get(index));
        return device.into_iter().collect();
    }
    // Nothing, which every name contains, names none.
    if selector.trim().is_empty() {
        return Vec::new();
    }
    let part = selector.to_lowercase();
    let named = |device: &&DeviceInfo| device.name.to_lowercase().contains(&part);
    devices.iter().filter(named).collect()
}

fn rank(kind: vk::PhysicalDeviceType) -> u8 {
    match kind {
        vk::PhysicalDeviceType::DISCRETE_GPU => 0,
        vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
        _ => 2,
    }
}

fn none_suitable(all: &[DeviceInfo], asked: &[&DeviceInfo], selector: Option<&str>) -> Error {
    if all.is_empty() {
        let remedy = "install a Vulkan driver (Debian: mesa-vulkan-drivers)";
        return Error::NoDevice(format!("there is none; {remedy}"));
    }
    match selector {
        Some(selector) if asked.is_empty() => {
            let names = all
                .iter()
                .map(|device| format!("{} ({})", device.index, device.name));
            let names: Vec<String> = names.collect();
            let names = names.join(", ");
            Error::NoDevice(format!(
                "'{selector}' is neither the index nor a part of the name of one; there are: {names}"
            ))
        }
        _ => Error::NoDevice(lacking(asked)),
    }
}

fn lacking(devices: &[&DeviceInfo]) -> String {
    let mut text = String::new();
    for (number, device) in devices.iter().enumerate() {
        let separator = if number == 0 { "" } else { "; " };
        let missing = device.missing.join(", ");
        // Writing to a string does not fail.
        let _ = write!(text, "{separator}{} lacks {missing}", device.name);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn device(index: usize, name: &str, kind: vk::PhysicalDeviceType, lacks: &str) -> DeviceInfo {
        DeviceInfo {
            index,
            name: name.into(),
            kind,
            driver: Driver::new(vk::DriverId::default(), String::new(), String::new(), 0),
            support: Support::default(),
            missing: lacks.split_terminator('|').map(String::from).collect(),
            workarounds: Vec::new(),
            limits: vk::PhysicalDeviceLimits::default(),
            physical: vk::PhysicalDevice::null(),
        }
    }

    fn zoo() -> Vec<DeviceInfo> {
        vec![
            device(0, "llvmpipe", vk::PhysicalDeviceType::CPU, ""),
            device(1, "Old 3060", vk::PhysicalDeviceType::DISCRETE_GPU, "x|y"),
            device(2, "Iris", vk::PhysicalDeviceType::INTEGRATED_GPU, ""),
        ]
    }

    fn chosen(selector: Option<&str>) -> std::result::Result<usize, String> {
        let chosen = choose(&zoo(), selector).map(|device| device.index);
        chosen.map_err(|error| error.to_string())
    }

    #[test]
    fn the_fastest_kind_that_suits_is_the_default() {
        assert_eq!(chosen(None), Ok(2));
    }

    #[test]
    fn index_and_part_of_the_name_select() {
        assert_eq!(chosen(Some("0")), Ok(0));
        assert_eq!(chosen(Some("LLVM")), Ok(0));
        assert_eq!(chosen(Some("iris")), Ok(2));
    }

    #[test]
    fn a_number_is_an_index_and_nothing_names_none() {
        // 3060 is a part of a name.
        for wrong in ["3", "3060", "18446744073709551616", "", " "] {
            let words = chosen(Some(wrong)).expect_err(wrong);
            assert!(words.contains("there are: 0 (llvmpipe)"), "{words}");
        }
        assert_eq!(chosen(Some("00")), Ok(0));
    }

    #[test]
    fn a_device_that_lacks_something_says_what() {
        let words = chosen(Some("old")).expect_err("it lacks x and y");
        assert!(words.ends_with("Old 3060 lacks x, y"), "{words}");
        let words = chosen(Some("1")).expect_err("it lacks x and y");
        assert!(words.ends_with("Old 3060 lacks x, y"), "{words}");
    }

    #[test]
    fn what_is_there_and_lacks_something_is_found_where_nothing_else_was_asked_for() {
        let found = |selector| unsuitable(&zoo(), selector).map(|device| device.index);
        assert_eq!(found(Some("old")), Some(1));
        for none in [None, Some("llvm"), Some("voodoo")] {
            assert_eq!(found(none), None, "{none:?}");
        }
        assert_eq!(
            unsuitable(&zoo()[1..2], None).map(|device| device.index),
            Some(1)
        );
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let words = chosen(Some("voodoo")).expect_err("there is no such device");
        assert!(words.contains("'voodoo'"), "{words}");
        assert!(
            words.contains("0 (llvmpipe), 1 (Old 3060), 2 (Iris)"),
            "{words}"
        );
        let none = choose(&[], None).expect_err("there is no device");
        assert_eq!(none.exit_code(), 3);
    }
}
