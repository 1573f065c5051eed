//! From what the device drew to a picture: supersampling, and a background behind it.

/// The background's colour at the top and at the bottom, in linear light.
const BACKGROUND: [[f32; 3]; 2] = [[0.62, 0.66, 0.70], [0.30, 0.32, 0.35]];

/// Averages squares of `factor` x `factor` pixels in linear light and puts them before the background.
///
/// `drawn` is sRGB with alpha, `width` x `height` x factor^2 pixels, its colours already weighted with alpha, as a transparent clear colour
/// and resolved samples leave them. Returns RGBA.
pub fn compose(drawn: &[u8], width: u32, height: u32, factor: u32) -> Vec<u8> {
    let linear: Vec<f32> = (0..=255u8).map(byte_to_linear).collect();
    let (width, height, factor) = (width as usize, height as usize, factor as usize);
    let share = 1.0 / (factor * factor) as f32;
    let mut picture = Vec::with_capacity(4 * width * height);
    for y in 0..height {
        let depth = (y as f32 + 0.5) / height as f32;
        for x in 0..width {
            let mut sum = [0.0f32; 4];
            for (row, column) in
                (0..factor * factor).map(|i| (y * factor + i / factor, x * factor + i % factor))
            {
                let pixel = &drawn[4 * (row * width * factor + column)..][..4];
                for channel in 0..3 {
                    sum[channel] += linear[pixel[channel] as usize] * share;
                }
                sum[3] += f32::from(pixel[3]) / 255.0 * share;
            }
            for channel in 0..3 {
                let behind = BACKGROUND[0][channel]
                    + depth * (BACKGROUND[1][channel] - BACKGROUND[0][channel]);
                picture.push(to_srgb(sum[channel] + (1.0 - sum[3]) * behind));
            }
            picture.push(255);
        }
    }
    picture
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

fn to_srgb(x: f32) -> u8 {
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
    fn opaque_pixels_average_in_linear_light_and_clear_ones_show_the_background() {
        let drawn = [
            [255, 255, 255, 255],
            [0, 0, 0, 255],
            [255, 255, 255, 255],
            [0, 0, 0, 255],
        ]
        .concat();
        assert_eq!(compose(&drawn, 1, 1, 2), [188, 188, 188, 255]);
        let background = compose(&[0; 16], 1, 1, 2);
        let middle =
            |channel: usize| to_srgb(0.5 * (BACKGROUND[0][channel] + BACKGROUND[1][channel]));
        assert_eq!(background, [middle(0), middle(1), middle(2), 255]);
    }
}
