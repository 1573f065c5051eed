//! The page that `compare` makes: rows of tiles under headings, words, and colour bars.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::scale::{self, Scale};

/// Paper, sRGB.
const PAPER: [u8; 3] = [250, 250, 248];
/// Words that matter.
pub const INK: [u8; 3] = [28, 30, 34];
/// Words that may be overlooked.
pub const GREY: [u8; 3] = [98, 102, 110];

/// How words look.
#[derive(Clone, Copy)]
pub enum Face {
    /// Names.
    Heading,
    /// Numbers and explanations.
    Small,
}

impl Face {
    fn weight_and_size(self) -> (FontWeight, RasterHeight) {
        match self {
            Face::Heading => (FontWeight::Bold, RasterHeight::Size20),
            Face::Small => (FontWeight::Regular, RasterHeight::Size16),
        }
    }

    /// The width of some words in pixels.
    pub fn width(self, words: &str) -> u32 {
        let (weight, size) = self.weight_and_size();
        (words.chars().count() * get_raster_width(weight, size)) as u32
    }
}

/// A picture that things are put on; what lies outside of it is cut off.
pub struct Page {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// RGBA, rows from the top.
    pub pixels: Vec<u8>,
}

impl Page {
    /// A blank page.
    pub fn new(width: u32, height: u32) -> Page {
        let [r, g, b] = PAPER;
        Page {
            width,
            height,
            pixels: [r, g, b, 255].repeat(width as usize * height as usize),
        }
    }

    /// Puts `colour` over a pixel, as strongly as `cover` of 255 says.
    fn blend(&mut self, x: u32, y: u32, colour: [u8; 3], cover: u8) {
        if x >= self.width || y >= self.height {
            return;
        }
        let at = 4 * (y as usize * self.width as usize + x as usize);
        for (under, over) in self.pixels[at..at + 3].iter_mut().zip(colour) {
            let (a, b, share) = (u32::from(*under), u32::from(over), u32::from(cover));
            *under = ((a * (255 - share) + b * share + 127) / 255) as u8;
        }
    }

    /// Puts a picture with its upper left corner at (x, y).
    pub fn tile(&mut self, x: u32, y: u32, width: u32, rgba: &[u8]) {
        for (i, pixel) in rgba.chunks_exact(4).enumerate() {
            let (column, row) = (i as u32 % width, i as u32 / width);
            self.blend(x + column, y + row, [pixel[0], pixel[1], pixel[2]], 255);
        }
    }

    /// Writes words that begin at x with their line's top at y. Characters that the font lacks become question marks. Returns where they end.
    pub fn words(&mut self, x: u32, y: u32, face: Face, ink: [u8; 3], words: &str) -> u32 {
        let (weight, size) = face.weight_and_size();
        let mut pen = x;
        for letter in words.chars() {
            let glyph = get_raster(letter, weight, size).or_else(|| get_raster('?', weight, size));
            if let Some(glyph) = glyph {
                for (row, line) in glyph.rows().enumerate() {
                    for (column, &cover) in line.iter().enumerate() {
                        self.blend(pen + column as u32, y + row as u32, ink, cover);
                    }
                }
            }
            pen += get_raster_width(weight, size) as u32;
        }
        pen
    }

    /// Words around the middle x, but within `left..right`.
    fn centred(&mut self, x: u32, y: u32, [left, right]: [u32; 2], words: &str) {
        let width = Face::Small.width(words);
        let start = x.saturating_sub(width / 2);
        let start = start.min(right.saturating_sub(width)).max(left);
        self.words(start, y, Face::Small, GREY, words);
    }

    /// A colour bar with a tick a decade and the powers of ten below it, both ends always.
    pub fn bar(&mut self, x: u32, y: u32, width: u32, scale: Scale) {
        const HEIGHT: u32 = 14;
        for column in 0..width {
            let share = f64::from(column) / f64::from((width - 1).max(1));
            let colour = scale::colour(share).map(|c| (c * 255.0 + 0.5) as u8);
            for row in 0..HEIGHT {
                self.blend(x + column, y + row, colour, 255);
            }
        }
        let decades = scale.high - scale.low;
        let label = |power: i32| match power {
            0..=3 => format!("{}", 10u32.pow(power as u32)),
            -2..=-1 => format!("{}", 10f64.powi(power)),
            _ => format!("1e{power}"),
        };
        let room = Face::Small.width("1e-00  ");
        // So that neighbours do not touch; counted from the high end, which all maps have in common.
        let step = (1..=decades)
            .find(|step| width * *step as u32 / decades as u32 >= room)
            .unwrap_or(decades);
        for power in scale.low..=scale.high {
            let column = (width - 1) * (power - scale.low) as u32 / decades as u32;
            for row in HEIGHT..HEIGHT + 4 {
                self.blend(x + column, y + row, GREY, 255);
            }
            let end = power == scale.low || power == scale.high;
            let room_to_low = power - scale.low >= step;
            if end || ((scale.high - power) % step == 0 && room_to_low) {
                self.centred(x + column, y + HEIGHT + 5, [x, x + width], &label(power));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_leave_ink_where_they_stand_and_nowhere_else() {
        let mut page = Page::new(60, 20);
        let end = page.words(4, 2, Face::Small, INK, "Ag\u{4e00}");
        assert_eq!(end, 4 + Face::Small.width("Ag?"));
        let marked = |x: u32| (0..20).any(|y| page.pixels[4 * (y * 60 + x as usize)] < 200);
        assert!((4..end).any(marked));
        assert!(!(0..4).any(marked) && !(end..60).any(marked));
    }

    #[test]
    fn what_lies_outside_is_cut_off() {
        let mut page = Page::new(4, 4);
        page.words(2, 2, Face::Heading, INK, "wide");
        page.tile(3, 3, 2, &[0; 16]);
        page.bar(0, 0, 9, Scale { low: -3, high: 0 });
        assert_eq!(page.pixels.len(), 4 * 4 * 4);
    }
}
