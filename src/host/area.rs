//! Parts of pictures.

use ash::vk;

/// A part of a picture, in pixels from its left upper corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    /// Its left side.
    pub x: u32,
    /// Its upper side.
    pub y: u32,
    /// Its width.
    pub width: u32,
    /// Its height.
    pub height: u32,
}

impl Area {
    /// All of a picture.
    pub fn whole([width, height]: [u32; 2]) -> Area {
        Area {
            x: 0,
            y: 0,
            width,
            height,
        }
    }

    /// What of it lies in another one; one pixel where nothing does.
    pub(super) fn within(self, other: Area) -> Area {
        let inside = |side: u32, first: u32, length: u32| side.clamp(first, first + length - 1);
        let x = inside(self.x, other.x, other.width);
        let y = inside(self.y, other.y, other.height);
        let end = |first: u32, length: u32| first.saturating_add(length);
        let (right, below) = (end(self.x, self.width), end(self.y, self.height));
        Area {
            x,
            y,
            width: right.clamp(x + 1, other.x + other.width) - x,
            height: below.clamp(y + 1, other.y + other.height) - y,
        }
    }

    /// Where it lies in images of a part.
    pub(super) fn rect(self, part: Area) -> vk::Rect2D {
        vk::Rect2D {
            offset: vk::Offset2D {
                x: (self.x - part.x) as i32,
                y: (self.y - part.y) as i32,
            },
            extent: self.extent(),
        }
    }

    pub(super) fn extent(self) -> vk::Extent2D {
        vk::Extent2D {
            width: self.width,
            height: self.height,
        }
    }
}
