//! What a worker says of the device that it opened. The runner opens none itself: a driver that crashes meanwhile shall not take the report
//! with it.

use ash::vk;

use crate::gpu::{Driver, Version};
use crate::host::DeviceInfo;

/// A device that a worker opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Opened {
    /// Its name.
    pub name: String,
    /// Its driver.
    pub driver: Driver,
}

impl Opened {
    pub(super) fn of(info: &DeviceInfo) -> Opened {
        Opened {
            name: info.name.clone(),
            driver: info.driver.clone(),
        }
    }

    /// All of it in a line, with tabs between. What drivers call themselves has no control characters then.
    pub(super) fn line(&self) -> String {
        let Driver {
            id,
            name,
            info,
            version: Version(major, minor, patch),
        } = &self.driver;
        let plain = |text: &str| text.replace(char::is_control, " ");
        let [device, name, info] = [&self.name, name, info].map(|text| plain(text));
        let id = id.as_raw();
        format!("{id}\t{major}\t{minor}\t{patch}\t{device}\t{name}\t{info}")
    }

    pub(super) fn parse(line: &str) -> Option<Opened> {
        let [id, major, minor, patch, device, name, info] =
            line.split('\t').collect::<Vec<_>>()[..]
        else {
            return None;
        };
        let number = |text: &str| text.parse().ok();
        Some(Opened {
            name: device.into(),
            driver: Driver {
                id: vk::DriverId::from_raw(id.parse().ok()?),
                name: name.into(),
                info: info.into(),
                version: Version(number(major)?, number(minor)?, number(patch)?),
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_read_back() {
        let opened = Opened {
            name: "llvmpipe (LLVM 15.0.6, 256 bits)".into(),
            driver: Driver {
                id: vk::DriverId::MESA_LLVMPIPE,
                name: "llvmpipe".into(),
                info: "Mesa 22.3.6 (LLVM 15.0.6)".into(),
                version: Version(22, 3, 6),
            },
        };
        assert_eq!(Opened::parse(&opened.line()), Some(opened.clone()));
        let odd = Opened {
            name: "a\tb\x1b[2J\nc".into(),
            ..opened
        };
        let read = Opened::parse(&odd.line()).map(|read| read.name);
        assert_eq!(read.as_deref(), Some("a b [2J c"));
        assert_eq!(Opened::parse("fine"), None);
    }
}
