//! From a number to a colour: a logarithmic scale and a perceptually uniform map.

/// Viridis as a polynomial of degree 6 in sRGB, least power first.
///
/// The map is by N. Smith and S. van der Walt (matplotlib, CC0): equal steps look equal, in grey and to the colour-blind too. The fit, a
/// hundredth off at the ends, is Matt Zucker's (CC0, shadertoy.com/view/WlfXRN).
const VIRIDIS: [[f64; 3]; 7] = [
    [0.277_727_327, 0.005_407_345, 0.334_099_805],
    [0.105_093_043, 1.404_613_530, 1.384_590_163],
    [-0.330_861_829, 0.214_847_559, 0.095_095_163],
    [-4.634_230_499, -5.799_100_973, -19.332_440_956],
    [6.228_269_936, 14.179_933_367, 56.690_552_601],
    [4.776_384_998, -13.745_145_378, -65.353_032_633],
    [-5.435_455_856, 4.645_852_612, 26.312_435_250],
];

/// The sRGB colour of a share from 0 to 1.
pub fn colour(share: f64) -> [f64; 3] {
    let t = share.clamp(0.0, 1.0);
    let channel = |c: usize| VIRIDIS.iter().rev().fold(0.0, |sum, row| sum * t + row[c]);
    [0, 1, 2].map(|c| channel(c).clamp(0.0, 1.0))
}

/// Whole decades from `10^low` to `10^high`. Errors of different methods lie orders of magnitude apart: a linear scale would show the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    /// The power of ten at the low end; what is less gets the same colour.
    pub low: i32,
    /// The power of ten at the high end; what is more gets the same colour.
    pub high: i32,
}

impl Scale {
    /// The decades from the least of `typical` to the greatest of `maxima`, at least one. None lies below `floor`, where only rounding is left,
    /// and none above `ceiling`.
    pub fn over(typical: &[f64], maxima: &[f64], [floor, ceiling]: [i32; 2]) -> Scale {
        let greatest = maxima.iter().copied().fold(0.0, f64::max);
        let least = typical.iter().copied().fold(f64::INFINITY, f64::min);
        let high = (greatest.log10().ceil() as i32).clamp(floor + 1, ceiling);
        let low = (least.log10().floor() as i32).clamp(floor, high - 1);
        Scale { low, high }
    }

    /// Where a value lies on the scale, from 0 to 1.
    pub fn share(self, value: f64) -> f64 {
        let place = (value.log10() - f64::from(self.low)) / f64::from(self.high - self.low);
        place.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_runs_from_dark_violet_to_yellow_and_gets_lighter_all_the_way() {
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|c| (a[c] - b[c]).abs() < 0.02);
        assert!(near(colour(0.0), [0.267, 0.005, 0.329]));
        assert!(near(colour(0.5), [0.128, 0.567, 0.551]));
        assert!(near(colour(1.0), [0.993, 0.906, 0.144]));
        let lightness = |i: u32| {
            let [r, g, b] = colour(f64::from(i) / 50.0);
            0.3 * r + 0.59 * g + 0.11 * b
        };
        assert!((1..=50).all(|i| lightness(i) > lightness(i - 1)));
    }

    #[test]
    fn a_scale_has_whole_decades_and_clamps() {
        let scale = Scale::over(&[2e-8, 3e-3], &[9e-8, 2e-2], [-9, 3]);
        assert_eq!((scale.low, scale.high), (-8, -1));
        assert_eq!(scale.share(1e-8), 0.0);
        assert_eq!(scale.share(0.0), 0.0);
        assert_eq!(scale.share(1.0), 1.0);
        assert!((scale.share(1e-4) - 4.0 / 7.0).abs() < 1e-12);
    }

    #[test]
    fn without_any_error_there_is_still_a_scale() {
        assert_eq!(
            Scale::over(&[0.0], &[0.0], [-9, 3]),
            Scale { low: -9, high: -8 }
        );
        assert_eq!(Scale::over(&[], &[], [-9, 3]), Scale { low: -9, high: -8 });
    }
}
