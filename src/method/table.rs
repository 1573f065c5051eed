//! The tables of a pass, as they stand one behind the other in one buffer: shaders see few buffers, and devices need not have more.

use std::ops::{Deref, DerefMut};

use bytemuck::NoUninit;

/// A table of a method's own: its elements' words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    words: Vec<u32>,
    /// Words an element.
    pub(super) stride: usize,
}

impl Table {
    /// Elements of whole words.
    pub(super) fn of<T: NoUninit>(elements: &[T]) -> Table {
        Table {
            words: bytemuck::cast_slice(elements).to_vec(),
            stride: size_of::<T>() / 4,
        }
    }

    /// Elements of so many words, which are taken over: large tables are not there twice.
    pub(super) fn of_words(words: Vec<u32>, stride: usize) -> Table {
        Table { words, stride }
    }
}

impl Table {
    /// The words of elements, and how many each has, for [`Table::grow`].
    pub(super) fn grown<T: NoUninit>(elements: &[T]) -> (&[u32], usize) {
        (bytemuck::cast_slice(elements), size_of::<T>() / 4)
    }

    /// Takes what stands behind its end in a list that only grows, of which the last word may have been half empty. Tells which words are new.
    pub(super) fn grow(&mut self, words: &[u32], stride: usize) -> std::ops::Range<usize> {
        self.stride = stride;
        let known = self.words.len();
        let same = match known.checked_sub(1) {
            Some(last) if self.words[last] != words[last] => last,
            _ => known,
        };
        self.words.truncate(same);
        self.words.extend_from_slice(&words[same..]);
        same..words.len()
    }
}

impl Table {
    /// Writes words from a place on, behind its end too.
    #[cfg(feature = "vulkan")]
    pub(super) fn write(&mut self, place: usize, words: &[u32]) {
        let end = place + words.len();
        if self.words.len() < end {
            self.words.resize(end, 0);
        }
        self.words[place..end].copy_from_slice(words);
    }
}

impl Table {
    /// Takes over some words of another one, which has as many or more.
    #[cfg(feature = "vulkan")]
    pub(super) fn adopt(&mut self, other: &Table, range: std::ops::Range<usize>) {
        self.stride = other.stride;
        self.words.resize(other.words.len(), 0);
        self.words[range.clone()].copy_from_slice(&other.words[range]);
    }
}

impl Deref for Table {
    type Target = [u32];

    fn deref(&self) -> &[u32] {
        &self.words
    }
}

impl DerefMut for Table {
    fn deref_mut(&mut self) -> &mut [u32] {
        &mut self.words
    }
}
