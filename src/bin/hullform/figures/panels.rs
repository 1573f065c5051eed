//! Pictures side by side, as one.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use crate::compare::page::{Face, INK, Page};
use crate::output::png;

/// Around the pictures, and between them.
const MARGIN: u32 = 16;
/// The line above each.
const LINE: u32 = 28;

/// A picture with its size.
struct Picture {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

/// PNG files as one, each under its name; the bytes of a PNG file, or what is wrong.
pub fn side_by_side(panels: &[(&str, PathBuf)]) -> Result<Vec<u8>, String> {
    let pictures: Vec<Picture> = panels
        .iter()
        .map(|(_, path)| read(path).map_err(|error| format!("{}: {error}", path.display())))
        .collect::<Result<_, _>>()?;
    let widths = pictures.iter().map(|picture| picture.width + MARGIN);
    let tallest = pictures.iter().map(|picture| picture.height).max();
    let height = MARGIN + LINE + tallest.unwrap_or(0) + MARGIN;
    let mut page = Page::new(MARGIN + widths.sum::<u32>(), height);
    let mut x = MARGIN;
    for ((name, _), picture) in panels.iter().zip(&pictures) {
        page.words(x, MARGIN, Face::Heading, INK, &name.replace('-', " "));
        page.tile(x, MARGIN + LINE, picture.width, &picture.rgba);
        x += picture.width + MARGIN;
    }
    let mut bytes = Vec::new();
    let written = png::write(&mut bytes, page.width, page.height, &page.pixels);
    written.map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// A picture as this program writes them: RGB, eight bits each.
fn read(path: &Path) -> Result<Picture, Box<dyn std::error::Error>> {
    let mut reader = ::png::Decoder::new(BufReader::new(File::open(path)?)).read_info()?;
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    let mut rgb = vec![0; size];
    let info = reader.next_frame(&mut rgb)?;
    if (info.color_type, info.bit_depth) != (::png::ColorType::Rgb, ::png::BitDepth::Eight) {
        return Err("it is no RGB picture".into());
    }
    let pixels = rgb.chunks_exact(3);
    Ok(Picture {
        width: info.width,
        height: info.height,
        rgba: pixels.flat_map(|c| [c[0], c[1], c[2], 255]).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_stand_side_by_side_under_their_names() {
        let folder = tempfile::tempdir().expect("a folder");
        let panel = |name: &str, width: u32, colour: [u8; 4]| {
            let path = folder.path().join(name);
            let pixels = colour.repeat(width as usize * 20);
            let mut bytes = Vec::new();
            png::write(&mut bytes, width, 20, &pixels).expect("memory does not fail");
            std::fs::write(&path, bytes).expect("a file");
            path
        };
        let panels = [
            ("red", panel("a", 10, [255, 0, 0, 255])),
            ("blue", panel("b", 30, [0, 0, 255, 255])),
        ];
        let joined = side_by_side(&panels).expect("a picture");
        let path = folder.path().join("joined");
        std::fs::write(&path, joined).expect("a file");
        let Picture { width, rgba, .. } = read(&path).expect("a picture");
        assert_eq!(width, 3 * MARGIN + 40);
        let count = |colour: [u8; 4]| rgba.chunks_exact(4).filter(|c| *c == colour).count();
        assert_eq!(count([255, 0, 0, 255]), 200);
        assert_eq!(count([0, 0, 255, 255]), 600);
        let missing = [("none", folder.path().join("none"))];
        assert!(side_by_side(&missing).is_err_and(|words| words.contains("none")));
    }
}
