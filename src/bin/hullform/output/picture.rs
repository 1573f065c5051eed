//! From what the device drew to a picture: supersampling, and a background behind it.

use hullform::host::Area;

/// The background's colour at the top and at the bottom, in linear light.
pub const BACKGROUND: [[f32; 3]; 2] = [[0.62, 0.66, 0.70], [0.30, 0.32, 0.35]];

/// Averages squares of `factor` x `factor` pixels in linear light and puts them before the background, which is all that there is outside of
/// `area`.
///
/// `drawn` is the area's pixels: sRGB with alpha, of a picture of `width` x `height` x factor^2, the colours already weighted with alpha, as a
/// transparent clear colour and resolved samples leave them. The area consists of whole squares. Returns RGBA.
pub fn compose(drawn: &[u8], area: Area, width: u32, height: u32, factor: u32) -> Vec<u8> {
    let tables = Tables::new(factor);
    let (width, height, factor) = (width as usize, height as usize, factor as usize);
    let [left, top, columns] = [area.x, area.y, area.width].map(|side| side as usize / factor);
    let mut picture = vec![255; 4 * width * height];
    let mut rows = drawn.chunks_exact(4 * columns * factor * factor);
    for (y, row) in picture.chunks_exact_mut(4 * width).enumerate() {
        let depth = (y as f32 + 0.5) / height as f32;
        let behind: [f32; 3] = std::array::from_fn(|channel| {
            BACKGROUND[0][channel] + depth * (BACKGROUND[1][channel] - BACKGROUND[0][channel])
        });
        let alone = behind.map(|light| tables.byte(light));
        for pixel in row.chunks_exact_mut(4) {
            pixel[..3].copy_from_slice(&alone);
        }
        let Some(squares) = (y >= top).then(|| rows.next()).flatten() else {
            continue;
        };
        let pixels = row[4 * left..].chunks_exact_mut(4).take(columns);
        for (column, pixel) in pixels.enumerate() {
            let parts = squares
                .chunks_exact(4 * columns * factor)
                .map(|line| &line[4 * factor * column..][..4 * factor]);
            if let Some(colour) = tables.average(parts, behind) {
                pixel[..3].copy_from_slice(&colour);
            }
        }
    }
    picture
}

/// What would be computed again and again: powers take most of the time otherwise.
struct Tables {
    /// A byte in linear light, over the pixels of a square.
    light: [f32; 256],
    /// A byte as a share, over the same.
    share: [f32; 256],
    /// The least light that has each byte or a greater one.
    least: [f32; 256],
    /// The byte that each of the steps from 0 to 1 begins with.
    first: Vec<u8>,
}

/// Steps so small that few of them meet two bytes.
const STEPS: usize = 4096;

impl Tables {
    fn new(factor: u32) -> Tables {
        let part = 1.0 / (factor * factor) as f32;
        let bytes: [u8; 256] = std::array::from_fn(|byte| byte as u8);
        let first = (0..=STEPS).map(|step| to_srgb(step as f32 / STEPS as f32));
        Tables {
            light: bytes.map(|byte| byte_to_linear(byte) * part),
            share: bytes.map(|byte| f32::from(byte) / 255.0 * part),
            least: bytes.map(least),
            first: first.collect(),
        }
    }

    /// As `to_srgb`.
    fn byte(&self, light: f32) -> u8 {
        let light = light.clamp(0.0, 1.0);
        let mut byte = self.first[(light * STEPS as f32) as usize];
        while byte < 255 && light >= self.least[usize::from(byte) + 1] {
            byte += 1;
        }
        byte
    }

    /// The mean of a square, line by line, before what is behind it; None where nothing is before it.
    fn average<'a>(
        &self,
        lines: impl Iterator<Item = &'a [u8]>,
        behind: [f32; 3],
    ) -> Option<[u8; 3]> {
        let mut sum = [0.0f32; 3];
        let mut alpha = 0.0;
        let mut any = 0;
        for pixel in lines.flat_map(|line| line.chunks_exact(4)) {
            for channel in 0..3 {
                sum[channel] += self.light[usize::from(pixel[channel])];
                any |= pixel[channel];
            }
            alpha += self.share[usize::from(pixel[3])];
            any |= pixel[3];
        }
        let before = |channel| self.byte(sum[channel] + (1.0 - alpha) * behind[channel]);
        (any > 0).then(|| std::array::from_fn(before))
    }
}

/// The least light that has this byte or a greater one. Floats from 0 on are in the order of their bits.
fn least(byte: u8) -> f32 {
    let (mut low, mut high) = (0, 1.0f32.to_bits());
    while low < high {
        let middle = low + (high - low) / 2;
        if to_srgb(f32::from_bits(middle)) >= byte {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    f32::from_bits(low)
}

/// A byte in linear light.
fn byte_to_linear(byte: u8) -> f32 {
    to_linear(f32::from(byte) / 255.0)
}

/// The sRGB transfer function (IEC 61966-2-1).
pub fn to_linear(x: f32) -> f32 {
    if x <= 0.04045 {
        x / 12.92
    } else {
        ((x + 0.055) / 1.055).powf(2.4)
    }
}

/// A share of linear light as sRGB has it.
pub fn to_srgb(x: f32) -> u8 {
    let x = x.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_way_to_linear_and_back() {
        assert!((0..=255).all(|byte| to_srgb(byte_to_linear(byte)) == byte));
    }

    #[test]
    fn the_table_has_the_bytes_of_the_function() {
        let tables = Tables::new(1);
        for bits in (0..=1.0f32.to_bits()).step_by(997) {
            let light = f32::from_bits(bits);
            assert_eq!(tables.byte(light), to_srgb(light), "{light}");
        }
        assert_eq!([-1.0, 1.0, 2.0].map(|x| tables.byte(x)), [0, 255, 255]);
    }

    fn whole(width: u32, height: u32) -> Area {
        Area {
            x: 0,
            y: 0,
            width,
            height,
        }
    }

    #[test]
    fn opaque_pixels_average_in_linear_light_and_clear_ones_show_the_background() {
        let drawn = [
            [255, 255, 255, 255],
            [0, 0, 0, 255],
            [255, 255, 255, 255],
            [0, 0, 0, 255],
        ]
        .concat();
        assert_eq!(compose(&drawn, whole(2, 2), 1, 1, 2), [188, 188, 188, 255]);
        let background = compose(&[0; 16], whole(2, 2), 1, 1, 2);
        let middle =
            |channel: usize| to_srgb(0.5 * (BACKGROUND[0][channel] + BACKGROUND[1][channel]));
        assert_eq!(background, [middle(0), middle(1), middle(2), 255]);
    }

    #[test]
    fn a_part_stands_where_it_was_drawn() {
        let area = Area {
            x: 2,
            y: 4,
            width: 2,
            height: 2,
        };
        let picture = compose(&[255; 16], area, 3, 4, 2);
        let white = picture.chunks(4).map(|pixel| pixel == [255; 4]);
        let place: Vec<usize> = (0..).zip(white).filter(|at| at.1).map(|at| at.0).collect();
        assert_eq!(place, [7]);
    }
}
