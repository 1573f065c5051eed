//! What a worker says of the device that it opened. The runner opens none itself: a driver that crashes meanwhile shall not take the report
//! with it.

use ash::vk;

use crate::gpu::{Driver, Version};
use crate::host::DeviceInfo;

/// A device that a worker opened, or could not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Opened {
    /// Its name.
    pub name: String,
    /// Its driver.
    pub driver: Driver,
    /// What it lacks for every case, in words; empty if it was opened.
    pub missing: String,
}

impl Opened {
    pub(super) fn of(info: &DeviceInfo) -> Opened {
        Opened {
            name: info.name.clone(),
            driver: info.driver.clone(),
            missing: info.missing.join(", "),
        }
    }

    /// Why no case can run on it; None where they can.
    pub fn lacks(&self) -> Option<String> {
        (!self.missing.is_empty()).then(|| format!("{} lacks {}", self.name, self.missing))
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
        let [device, name, info, missing] =
            [&self.name, name, info, &self.missing].map(|text| plain(text));
        let id = id.as_raw();
        format!("{id}\t{major}\t{minor}\t{patch}\t{device}\t{name}\t{info}\t{missing}")
    }

    pub(super) fn parse(line: &str) -> Option<Opened> {
        let [id, major, minor, patch, device, name, info, missing] =
            line.split('\t').collect::<Vec<_>>()[..]
        else {
            return None;
        };
        let number = |text: &str| text.parse().ok();
        Some(Opened {
            name: device.into(),
            missing: missing.into(),
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
            missing: String::new(),
        };
        assert_eq!(Opened::parse(&opened.line()), Some(opened.clone()));
        let odd = Opened {
            name: "a\tb\x1b[2J\nc".into(),
            missing: "x, y".into(),
            ..opened
        };
        let read = Opened::parse(&odd.line()).expect("it reads back");
        assert_eq!(read.name, "a b [2J c");
        assert_eq!(read.lacks().as_deref(), Some("a b [2J c lacks x, y"));
        assert_eq!(Opened::parse("fine"), None);
    }
}
