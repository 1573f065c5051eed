//! What a frame is drawn into, and what becomes of it.

use ash::vk;

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// It is on its way to the display.
    Yes,
    /// Nothing was recorded: an earlier frame is still drawn, or the display has no image to spare. Try again a little later.
    NotYet,
    /// Nothing was recorded, or it may not be seen: the window has changed. Call [`Swapchain::resize`](super::Swapchain::resize) and draw again.
    WindowChanged,
    /// Nothing was recorded: the window has no area, for it is minimised.
    Hidden,
}

/// What a frame is drawn into.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// The image of the display. Its contents are undefined when recording begins, and it is to be in the layout `PRESENT_SRC_KHR` when it ends.
    pub raw: vk::Image,
    /// A view of it.
    pub view: vk::ImageView,
    /// Which of the swapchain's images it is.
    pub number: usize,
    /// Its size in pixels.
    pub extent: vk::Extent2D,
}
