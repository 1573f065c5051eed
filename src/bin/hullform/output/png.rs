//! Pictures as PNG.

use std::io::{self, Write};

/// An sRGB picture from RGBA bytes, rows from the top. The alpha channel is dropped: pictures have a background.
pub fn write(out: &mut dyn Write, width: u32, height: u32, rgba: &[u8]) -> io::Result<()> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // A quarter of the time of the usual level, for a file that is a little larger.
    encoder.set_compression(png::Compression::Fast);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let rgb: Vec<u8> = rgba
        .chunks_exact(4)
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    #[test]
    fn pixels_come_back() {
        let rgba = [255, 0, 0, 255, 1, 2, 3, 0];
        let mut bytes = Vec::new();
        super::write(&mut bytes, 2, 1, &rgba).expect("memory does not fail");
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes))
            .read_info()
            .expect("a picture");
        assert!(reader.info().srgb.is_some());
        let mut pixels = [0; 6];
        reader.next_frame(&mut pixels).expect("pixels");
        assert_eq!(pixels, [255, 0, 0, 1, 2, 3]);
    }
}
