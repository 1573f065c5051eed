//! What a case drew last, for those who read its failure.

use std::cell::RefCell;
use std::collections::VecDeque;

/// A picture as a case looked at it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// RGBA, 8 bits each, rows from the top.
    pub pixels: Vec<u8>,
}

/// So many are kept: a case that fails often fails at once.
const KEPT: usize = 4;

thread_local! {
    // A process runs one case after the other, on one thread.
    static DRAWN: RefCell<VecDeque<Picture>> = const { RefCell::new(VecDeque::new()) };
}

/// Notes a picture; the oldest makes way.
pub(super) fn drew(picture: impl FnOnce() -> Picture) {
    DRAWN.with_borrow_mut(|drawn| {
        drawn.truncate(KEPT - 1);
        drawn.push_front(picture());
    });
}

/// The last pictures since this was asked, the last first.
pub(super) fn take() -> Vec<Picture> {
    DRAWN.with_borrow_mut(|drawn| drawn.drain(..).collect())
}

/// A picture of numbers: 0 is black, and each other has a bright colour of its own.
pub(super) fn of_numbers(width: u32, numbers: &[u32]) -> Picture {
    let colour = |&number: &u32| {
        let mixed = number.wrapping_mul(0x9e37_79b1).to_le_bytes();
        match number {
            0 => [0, 0, 0, 255],
            _ => [mixed[3] | 0x40, mixed[2] | 0x40, mixed[1] | 0x40, 255],
        }
    };
    Picture {
        width,
        pixels: numbers.iter().flat_map(colour).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_pictures_are_kept() {
        for number in 0..9 {
            drew(|| of_numbers(1, &[number]));
        }
        let kept = take();
        assert_eq!(kept.len(), KEPT);
        assert_eq!(kept[0], of_numbers(1, &[8]));
        assert!(take().is_empty());
    }
}
