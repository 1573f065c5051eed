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
