//! Where in the window the scene is, and where one side of a comparison ends.

use hullform::host;

/// A part of the window, in pixels from its left upper corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Area {
    /// Its left side.
    pub x: u32,
    /// Its upper side.
    pub y: u32,
    /// Its width; 0 where nothing of the scene is to be seen.
    pub width: u32,
    /// Its height.
    pub height: u32,
}

impl Area {
    /// The pixels of a rectangle in points, within a window of `size` pixels.
    pub fn of(rect: egui::Rect, scale: f32, size: [u32; 2]) -> Area {
        let pixel = |at: f32, most: u32| ((at * scale).round().max(0.0) as u32).min(most);
        let [x, right] = [rect.left(), rect.right()].map(|at| pixel(at, size[0]));
        let [y, bottom] = [rect.top(), rect.bottom()].map(|at| pixel(at, size[1]));
        Area {
            x,
            y,
            width: right.saturating_sub(x),
            height: bottom.saturating_sub(y),
        }
    }

    /// What of it lies in a picture of `size` pixels.
    pub fn within(self, [width, height]: [u32; 2]) -> Area {
        let (x, y) = (self.x.min(width), self.y.min(height));
        Area {
            x,
            y,
            width: self.width.min(width - x),
            height: self.height.min(height - y),
        }
    }

    /// What of it lies in another one.
    pub fn and(self, other: Area) -> Area {
        let both = |a: u32, b: u32, c: u32, d: u32| {
            let first = a.max(c);
            let end = a.saturating_add(b).min(c.saturating_add(d));
            (first, end.saturating_sub(first))
        };
        let (x, width) = both(self.x, self.width, other.x, other.width);
        let (y, height) = both(self.y, self.height, other.y, other.height);
        Area {
            x,
            y,
            width,
            height,
        }
    }

    /// Width over height.
    pub fn aspect(self) -> f64 {
        f64::from(self.width.max(1)) / f64::from(self.height.max(1))
    }

    /// Whether it has no pixel.
    pub fn is_empty(self) -> bool {
        self.width == 0 || self.height == 0
    }

    /// What of it lies in columns from a share of its width to another.
    pub fn columns(self, from: f64, to: f64) -> Area {
        let at = |share: f64| (share.clamp(0.0, 1.0) * f64::from(self.width)).round() as u32;
        Area {
            x: self.x + at(from),
            width: at(to).saturating_sub(at(from)),
            ..self
        }
    }

    /// As offscreen pictures have it.
    pub fn in_picture(self) -> host::Area {
        host::Area {
            x: self.x,
            y: self.y,
            width: self.width,
            height: self.height,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_become_pixels_within_the_window() {
        let rect = egui::Rect::from_min_max(egui::pos2(10.0, -5.0), egui::pos2(60.2, 500.0));
        let area = Area::of(rect, 2.0, [110, 90]);
        let expected = Area {
            x: 20,
            y: 0,
            width: 90,
            height: 90,
        };
        assert_eq!(area, expected);
        let cut = expected.within([100, 40]);
        assert_eq!([cut.x, cut.y, cut.width, cut.height], [20, 0, 80, 40]);
        assert!(expected.within([0, 0]).is_empty());
        let inverted = egui::Rect::from_min_max(egui::pos2(9.0, 9.0), egui::pos2(3.0, 3.0));
        assert!(Area::of(inverted, 1.0, [100, 100]).is_empty());
    }

    #[test]
    fn columns_share_no_pixel_and_leave_none_out() {
        let area = Area {
            x: 7,
            y: 0,
            width: 101,
            height: 3,
        };
        for at in [0.0, 0.2, 0.5, 0.999, 1.0] {
            let (left, right) = (area.columns(0.0, at), area.columns(at, 1.0));
            assert_eq!(left.width + right.width, area.width);
            assert_eq!(left.x + left.width, right.x);
        }
    }
}
