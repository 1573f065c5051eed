//! What was measured lately, for graphs and tables.

use std::collections::VecDeque;

use super::stage::Cost;
use hullform::gpu::Outcome;

/// How many frames graphs go back.
const FRAMES: usize = 90;

/// Times of the last frames, in seconds.
#[derive(Clone, Debug, Default)]
pub struct Series(VecDeque<f64>);

impl Series {
    /// Adds the latest.
    pub fn add(&mut self, seconds: f64) {
        if self.0.len() == FRAMES {
            self.0.pop_front();
        }
        self.0.push_back(seconds);
    }

    /// From the earliest to the latest.
    pub fn all(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.0.iter().copied()
    }

    /// The latest.
    pub fn last(&self) -> Option<f64> {
        self.0.back().copied()
    }
}

/// A row of a table: a name, and what belongs to it.
pub type Fact = (String, String);

/// All that was measured.
#[derive(Clone, Debug, Default)]
pub struct Readings {
    /// The device's time for the scene.
    pub device: Series,
    /// The host's time for a frame, panels included.
    pub host: Series,
    /// Seconds from an edit to the picture that shows it.
    pub edits: Series,
    /// How many were seen so far.
    pub edited: u64,
    /// Scenes of which a part was drawn, and the rest had stayed.
    pub parts: u64,
    /// What the last scene cost.
    pub cost: Cost,
    /// What the device decided for that, where it does.
    pub outcome: Option<Outcome>,
    /// Frames that were shown, and scenes that were drawn.
    pub frames: [u64; 2],
    /// Of the models: faces, patches, plans, bytes.
    pub models: Vec<(String, Vec<Fact>)>,
    /// Bytes on the device by what they are for, the greatest first.
    pub memory: Vec<(String, u64)>,
    /// Device, driver, workarounds, display.
    pub device_facts: Vec<Fact>,
    /// What the validation layer said; None without it.
    pub validation: Option<usize>,
}

/// A number of bytes in words.
pub fn bytes(count: u64) -> String {
    let units = [(1u64 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
    let unit = units.into_iter().find(|&(unit, _)| count >= unit);
    match unit {
        Some((unit, name)) => format!("{:.1} {name}", count as f64 / unit as f64),
        None => format!("{count} B"),
    }
}

/// A count with spaces between thousands.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut words = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            words.push(' ');
        }
        words.push(digit);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_easy_to_read() {
        assert_eq!(
            [0, 999, 1000, 1234567].map(grouped),
            ["0", "999", "1 000", "1 234 567"]
        );
        assert_eq!([5, 2048, 3 << 20].map(bytes), ["5 B", "2.0 KiB", "3.0 MiB"]);
    }

    #[test]
    fn graphs_go_back_so_far_and_no_farther() {
        let mut series = Series::default();
        (0..200).for_each(|i| series.add(f64::from(i)));
        assert_eq!((series.all().len(), series.last()), (FRAMES, Some(199.0)));
    }
}
