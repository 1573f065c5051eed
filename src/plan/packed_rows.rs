//! Stencils as the shaders read them: what is alike in several is there once.
//!
//! Rows of weights repeat in two ways. Around an extraordinary vertex the same weights stand in other places, since the rings of faces number the same
//! vertices differently; and level by level other weights stand in the same places. So a row is two numbers: of the *set* of its different weights, in
//! ascending order, and of the *pattern* that tells for each vertex of the ring which of these it has. Of Armor Guy's 266,000 rows there are 58,000 sets and
//! 88,000 patterns; whole rows differ in half of all cases, and lists of what is not zero would take twice the memory.
//!
//! Few rows are of vertices, or of tangents, and they are summed for every patch whatever its level: these are *dense*, without a pattern to be fetched first.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::abi;
use crate::error::{Error, Misuse, Result};

/// The bits of a number in a pattern: 4, 8 or 16.
const WIDTHS: [u32; 3] = [4, 8, 16];

/// Rows, sets and patterns, each once.
#[derive(Clone, Debug, Default)]
pub struct PackedRows {
    /// One a stencil, see [`abi::Use::rows`].
    rows: Vec<[u32; 2]>,
    /// The sets, one behind the other.
    sets: Vec<f32>,
    /// The patterns, one behind the other, in units of four bits.
    patterns: Vec<u32>,
    /// How many units there are.
    units: u32,
    known_sets: FxHashMap<Box<[u32]>, u32>,
    known_patterns: FxHashMap<Box<[u16]>, u32>,
    known_dense: FxHashMap<Box<[u32]>, u32>,
}

/// Packed rows, borrowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct RowsView<'a> {
    /// One a stencil.
    pub rows: &'a [[u32; 2]],
    /// The sets, one behind the other.
    pub sets: &'a [f32],
    /// The patterns, one behind the other.
    pub patterns: &'a [u32],
}

/// A row.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// `abi::STENCIL_...`: what its sum is relative to.
    pub corner: u32,
    set: &'a [f32],
    patterns: &'a [u32],
    /// Where its pattern begins, in units of four bits.
    first: u32,
    /// Which of the widths, or [`abi::DENSE`].
    width: u32,
}

/// A key by which floats sort as integers, least first; zero has one key.
fn ascending(weight: f32) -> u32 {
    let bits = (weight + 0.0).to_bits();
    if bits >> 31 != 0 {
        !bits
    } else {
        bits | 1 << 31
    }
}

/// # Errors
/// [`Misuse::PlanTooLarge`] where there are more weights than words can count.
fn check(points: usize) -> Result<()> {
    let greatest = 1 << abi::STENCIL_SHIFT;
    if points < greatest {
        return Ok(());
    }
    Err(Error::Misuse(Misuse::PlanTooLarge { points, greatest }))
}

fn weight_of(key: u32) -> f32 {
    f32::from_bits(if key >> 31 != 0 {
        key & !(1 << 31)
    } else {
        !key
    })
}

impl PackedRows {
    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Appends a row that is relative to `abi::STENCIL_...`.
    ///
    /// # Errors
    /// [`Misuse::PlanTooLarge`] when there are more weights than words can count.
    pub(super) fn push(&mut self, weights: &[f64], corner: u32) -> Result<()> {
        let keys = weights.iter().map(|&weight| ascending(weight as f32));
        let keys: SmallVec<[u32; 32]> = keys.collect();
        let mut set = keys.clone();
        set.sort_unstable();
        set.dedup();
        let number = |key: &u32| set.binary_search(key).unwrap_or_default() as u16;
        let pattern: SmallVec<[u16; 32]> = keys.iter().map(number).collect();
        let width = match set.len() {
            0..=16 => 0,
            17..=256 => 1,
            _ => 2,
        };
        check(self.sets.len() + set.len())?;
        check(
            (self.units as usize + 4 * pattern.len()) >> (abi::WIDTH_SHIFT - abi::STENCIL_SHIFT),
        )?;
        let row = [
            self.set(&set) | corner << abi::STENCIL_SHIFT,
            self.pattern(&pattern, width) | width << abi::WIDTH_SHIFT,
        ];
        self.rows.push(row);
        Ok(())
    }

    /// Appends a row that has a weight for each vertex of the ring, and is relative to its first.
    ///
    /// # Errors
    /// As for [`PackedRows::push`].
    pub(super) fn push_dense(&mut self, weights: &[f64]) -> Result<()> {
        let bits = weights
            .iter()
            .map(|&weight| (weight as f32 + 0.0).to_bits());
        let bits: SmallVec<[u32; 32]> = bits.collect();
        check(self.sets.len() + bits.len())?;
        let first = self.sets.len() as u32;
        let known = self.known_dense.entry(bits[..].into());
        let first = *known.or_insert(first);
        if first as usize == self.sets.len() {
            self.sets.extend(bits.into_iter().map(f32::from_bits));
        }
        let row = [
            first | abi::STENCIL_OWN << abi::STENCIL_SHIFT,
            abi::DENSE << abi::WIDTH_SHIFT,
        ];
        self.rows.push(row);
        Ok(())
    }

    /// Where a set begins.
    fn set(&mut self, keys: &[u32]) -> u32 {
        if let Some(&known) = self.known_sets.get(keys) {
            return known;
        }
        let first = self.sets.len() as u32;
        self.sets.extend(keys.iter().map(|&key| weight_of(key)));
        self.known_sets.insert(keys.into(), first);
        first
    }

    /// Where a pattern begins, in units of four bits.
    fn pattern(&mut self, numbers: &[u16], width: u32) -> u32 {
        if let Some(&known) = self.known_patterns.get(numbers) {
            return known;
        }
        let units = WIDTHS[width as usize] / 4;
        // The wider ones begin with a word: so those of a ring of 32 vertices are in eight words, which shaders keep at hand.
        let first = match width {
            0 => self.units,
            _ => self.units.next_multiple_of(8),
        };
        self.units = first + units * numbers.len() as u32;
        self.patterns.resize(self.units.div_ceil(8) as usize, 0);
        for (at, &number) in (first..).step_by(units as usize).zip(numbers) {
            self.patterns[at as usize / 8] |= u32::from(number) << (4 * (at % 8));
        }
        self.known_patterns.insert(numbers.into(), first);
        first
    }

    /// Makes room enough for shaders to believe in so many products of a weight and a vertex, see [`abi::PRODUCTS_A_WORD`]. Only small tables of long rings
    /// need that.
    pub(crate) fn hold(&mut self, products: u64) {
        // Twice as many, for the rounding of floats.
        let words = 2 * products.div_ceil(u64::from(abi::PRODUCTS_A_WORD)) as usize;
        if self.bytes() < 4 * words {
            self.sets
                .resize(self.sets.len() + words - self.bytes() / 4, 0.0);
        }
    }

    /// The rows as shaders see them.
    pub fn view(&self) -> RowsView<'_> {
        RowsView {
            rows: &self.rows,
            sets: &self.sets,
            patterns: &self.patterns,
        }
    }

    /// Their bytes.
    pub fn bytes(&self) -> usize {
        let RowsView {
            rows,
            sets,
            patterns,
        } = self.view();
        size_of_val(rows) + size_of_val(sets) + size_of_val(patterns)
    }
}

impl<'a> RowsView<'a> {
    /// A row by its number among all; None where there is none.
    pub fn row(self, number: u32) -> Option<Row<'a>> {
        let &[set, pattern] = self.rows.get(number as usize)?;
        let first = set & ((1 << abi::STENCIL_SHIFT) - 1);
        Some(Row {
            corner: set >> abi::STENCIL_SHIFT,
            set: self.sets.get(first as usize..)?,
            patterns: self.patterns,
            first: pattern & ((1 << abi::WIDTH_SHIFT) - 1),
            width: pattern >> abi::WIDTH_SHIFT,
        })
    }
}

impl Row<'_> {
    /// The weight of a vertex of the ring; 0 beyond the tables' ends. Twin of `weight_at` in `glsl/lib/quadtree.glsl`.
    pub fn weight(&self, place: usize) -> f32 {
        if self.width == abi::DENSE {
            return self.set.get(place).copied().unwrap_or_default();
        }
        let at = self.first as usize + (place << self.width);
        let bits = 4u32 << self.width;
        let word = self.patterns.get(at / 8).copied().unwrap_or_default();
        let number = word >> (4 * (at as u32 % 8)) & ((1 << bits) - 1);
        self.set.get(number as usize).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_as_they_were_pushed_and_kept_once() {
        let mut packed = PackedRows::default();
        let narrow = [0.5, -0.25, 0.0, 0.5, -0.0, 0.25];
        let wide: Vec<f64> = (0..300).map(|i| f64::from((i * 7) % 290) - 11.5).collect();
        let rows = [&narrow[..], &wide[..40], &wide, &narrow];
        for (corner, row) in [0, 5, 0, 8].into_iter().zip(rows) {
            packed.push(row, corner).expect("they are few");
        }
        let before = packed.bytes();
        packed.push(&[0.25, 0.5, -0.25, 0.0], 0).expect("few");
        assert_eq!(
            packed.bytes() - before,
            8 + 4,
            "the same weights elsewhere are a row and a pattern"
        );
        for (number, (corner, row)) in (0..).zip([0, 5, 0, 8].into_iter().zip(rows)) {
            let found = packed.view().row(number).expect("it was pushed");
            assert_eq!(found.corner, corner);
            for (place, &weight) in row.iter().enumerate() {
                assert_eq!(
                    found.weight(place).to_bits(),
                    (weight as f32 + 0.0).to_bits()
                );
            }
        }
        assert!(packed.view().row(5).is_none());
    }
}
