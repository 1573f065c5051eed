//! What a display can, and which of that we take.

use ash::vk;

use crate::error::{Error, Result};

/// How pictures follow one another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pacing {
    /// With the display: no picture is torn, none is made that is not shown. Every device has it.
    #[default]
    Display,
    /// The latest picture at each refresh, where the device can; else with the display.
    Latest,
    /// At once, and perhaps torn, where the device can; else with the display.
    Immediate,
}

impl Pacing {
    pub(super) fn mode(self, able: &[vk::PresentModeKHR]) -> vk::PresentModeKHR {
        let wanted = match self {
            Pacing::Display => vk::PresentModeKHR::FIFO,
            Pacing::Latest => vk::PresentModeKHR::MAILBOX,
            Pacing::Immediate => vk::PresentModeKHR::IMMEDIATE,
        };
        if able.contains(&wanted) {
            wanted
        } else {
            vk::PresentModeKHR::FIFO
        }
    }
}

/// The best of a window's formats: one whose bytes are written as they are, since what is composed in a window (text above all) is made for blending
/// of encoded colours.
pub(super) fn choose(formats: &[vk::SurfaceFormatKHR]) -> Result<vk::SurfaceFormatKHR> {
    let wanted = [
        vk::Format::B8G8R8A8_UNORM,
        vk::Format::R8G8B8A8_UNORM,
        vk::Format::A8B8G8R8_UNORM_PACK32,
        vk::Format::B8G8R8A8_SRGB,
        vk::Format::R8G8B8A8_SRGB,
        vk::Format::A8B8G8R8_SRGB_PACK32,
    ];
    let srgb = vk::ColorSpaceKHR::SRGB_NONLINEAR;
    let has = |format: &vk::Format| {
        let is = |able: &&vk::SurfaceFormatKHR| able.format == *format && able.color_space == srgb;
        formats.iter().find(is).copied()
    };
    wanted.iter().find_map(has).ok_or_else(|| {
        let names = formats.iter().map(|able| format!("{:?}", able.format));
        let names: Vec<String> = names.collect();
        Error::NoDisplay(format!(
            "the display has no format with 8 bits a channel in sRGB, only {}",
            names.join(", ")
        ))
    })
}

/// What images are used for: drawn to, copied to, and where the display allows it copied from.
pub(super) fn usage(able: vk::ImageUsageFlags) -> Result<vk::ImageUsageFlags> {
    let needed = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST;
    if !able.contains(needed) {
        return Err(Error::NoDisplay(format!(
            "the display's images can be used for {able:?} alone, not for {needed:?}"
        )));
    }
    Ok(needed | able & vk::ImageUsageFlags::TRANSFER_SRC)
}

/// The size that images must have, or the window's own where the window system leaves it to us.
pub(super) fn extent(able: &vk::SurfaceCapabilitiesKHR, [width, height]: [u32; 2]) -> vk::Extent2D {
    // "0xFFFFFFFF: the surface size will be determined by the extent of a swapchain" (Vulkan spec, VkSurfaceCapabilitiesKHR).
    if able.current_extent.width != u32::MAX {
        return able.current_extent;
    }
    if width == 0 || height == 0 {
        return vk::Extent2D::default();
    }
    let (least, most) = (able.min_image_extent, able.max_image_extent);
    vk::Extent2D {
        width: width.clamp(least.width, most.width.max(least.width)),
        height: height.clamp(least.height, most.height.max(least.height)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn format(format: vk::Format) -> vk::SurfaceFormatKHR {
        vk::SurfaceFormatKHR {
            format,
            color_space: vk::ColorSpaceKHR::SRGB_NONLINEAR,
        }
    }

    #[test]
    fn formats_that_store_bytes_as_they_are_come_first_and_none_is_an_error() {
        let both = [vk::Format::B8G8R8A8_SRGB, vk::Format::R8G8B8A8_UNORM].map(format);
        let chosen = choose(&both).map(|chosen| chosen.format);
        assert_eq!(chosen.ok(), Some(vk::Format::R8G8B8A8_UNORM));
        let deep = [format(vk::Format::A2B10G10R10_UNORM_PACK32)];
        let words = choose(&deep).expect_err("no format will do").to_string();
        assert!(words.contains("A2B10G10R10_UNORM_PACK32"), "{words}");
    }

    #[test]
    fn the_window_system_knows_the_size_or_leaves_it_within_bounds() {
        let mut able = vk::SurfaceCapabilitiesKHR {
            current_extent: vk::Extent2D {
                width: 7,
                height: 5,
            },
            min_image_extent: vk::Extent2D {
                width: 1,
                height: 1,
            },
            max_image_extent: vk::Extent2D {
                width: 100,
                height: 100,
            },
            ..Default::default()
        };
        assert_eq!(extent(&able, [50, 60]), able.current_extent);
        able.current_extent.width = u32::MAX;
        assert_eq!(extent(&able, [50, 600]).height, 100);
        assert_eq!(extent(&able, [0, 600]), vk::Extent2D::default());
    }

    #[test]
    fn every_display_can_pace_pictures() {
        let fifo = vk::PresentModeKHR::FIFO;
        assert_eq!(Pacing::Latest.mode(&[fifo]), fifo);
        let mailbox = vk::PresentModeKHR::MAILBOX;
        assert_eq!(Pacing::Latest.mode(&[fifo, mailbox]), mailbox);
    }
}
