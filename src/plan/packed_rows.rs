//! Stencils as the shaders read them: what is alike in several is there once.
//!
//! Rows of weights repeat in two ways. Around an extraordinary vertex the same weights stand in other places, since the rings of faces number the same
//! vertices differently; and level by level other weights stand in the same places. So a row is two numbers: of the *set* of its different weights, in
//! ascending order, and of the *pattern* that tells for each vertex of the ring which of these it has. Of Armor Guy's 266,000 rows there are 58,000 sets and
//! 88,000 patterns; whole rows differ in half of all cases, and lists of what is not zero would take twice the memory.
//!
//! Few rows are of vertices, or of tangents, and they are summed for every patch whatever its level: these are *dense*, without a pattern to be fetched first.

use smallvec::SmallVec;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::plan::lists::{KnownLists, Lists};
use crate::plan::row_pool::{PooledRows, SharedPool};
use crate::plan::stencil_rows::{StencilRows, WIDTHS};

/// Rows, sets and patterns, each once.
#[derive(Clone, Debug, Default)]
pub struct PackedRows {
    /// One a stencil, see [`abi::Use::rows`].
    rows: Vec<[u32; 2]>,
    /// The sets, one behind the other, as bits of floats.
    sets: Lists,
    known_sets: KnownLists,
    /// The patterns, one behind the other, in units of four bits.
    patterns: Vec<u32>,
    /// How many units there are.
    units: u32,
    /// What was packed into the patterns, and where each begins.
    pattern_lists: Lists,
    pattern_starts: Vec<u32>,
    known_patterns: KnownLists,
    /// The databases' pools that plans are of: one, or two where one database is over another.
    pools: Vec<Known>,
}

/// Where the sets and patterns of a pool are here, as far as they are.
#[derive(Clone, Debug)]
struct Known {
    pool: SharedPool,
    sets: Vec<u32>,
    patterns: Vec<u32>,
}

/// Instead of a place: there is none yet.
const NONE: u32 = u32::MAX;

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

/// # Errors
/// [`Misuse::PlanTooLarge`] where there are more weights than words can count.
fn check(points: usize) -> Result<()> {
    let greatest = 1 << abi::STENCIL_SHIFT;
    if points < greatest {
        return Ok(());
    }
    Err(Error::Misuse(Misuse::PlanTooLarge { points, greatest }))
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

    /// Appends the rows of a plan.
    ///
    /// # Errors
    /// [`Misuse::PlanTooLarge`] when there are more weights than words can count.
    pub(super) fn append(&mut self, own: &StencilRows) -> Result<()> {
        let sets = own.sets.iter().map(|set| {
            let number = self.known_sets.number(&mut self.sets, set);
            self.sets.start(number)
        });
        let sets: Vec<u32> = sets.collect();
        let patterns: Vec<u32> = own.patterns.iter().map(|list| self.pattern(list)).collect();
        for row in &own.rows {
            let (set, pattern) = StencilRows::parts(row);
            let pattern = pattern.map(|pattern| patterns[pattern as usize]);
            self.push(row, sets[set as usize], pattern);
        }
        self.check()
    }

    /// Appends the rows of a plan of a database: what it shares with others is found without being looked at.
    ///
    /// # Errors
    /// As for [`PackedRows::append`].
    pub(super) fn append_pooled(&mut self, own: &PooledRows) -> Result<()> {
        let is_its = |known: &Known| known.pool.is(&own.pool);
        let place = self.pools.iter().position(is_its);
        let place = place.unwrap_or_else(|| {
            self.pools.push(Known {
                pool: own.pool.clone(),
                sets: Vec::new(),
                patterns: Vec::new(),
            });
            self.pools.len() - 1
        });
        // Taken out as long as other lists grow.
        let mut known = self.pools.swap_remove(place);
        let pool = own.pool.read();
        known.sets.resize(pool.sets.len(), NONE);
        known.patterns.resize(pool.patterns.len(), NONE);
        for row in &own.rows {
            let (set, pattern) = StencilRows::parts(row);
            let mut place = known.sets[set as usize];
            if place == NONE {
                let number = self.sets.push(pool.sets.get(set));
                place = self.sets.start(number);
                known.sets[set as usize] = place;
            }
            let pattern = pattern.map(|pattern| {
                let place = &mut known.patterns[pattern as usize];
                if *place == NONE {
                    *place = self.push_pattern(pool.patterns.get(pattern));
                }
                *place
            });
            self.push(row, place, pattern);
        }
        drop(pool);
        self.pools.push(known);
        self.check()
    }

    /// Appends a row whose set and pattern are there.
    fn push(&mut self, row: &[u32; 2], set: u32, pattern: Option<u32>) {
        let corner = StencilRows::corner(row);
        let origin = corner.map_or(abi::STENCIL_OWN, |corner| abi::STENCIL_CORNER + corner);
        self.rows.push([
            set | origin << abi::STENCIL_SHIFT,
            pattern.unwrap_or(abi::DENSE << abi::WIDTH_SHIFT),
        ]);
    }

    /// The words of rows, sets and patterns, see [`RowsView`].
    pub(crate) fn into_words(self) -> [Vec<u32>; 3] {
        [self.rows.into_flattened(), self.sets.words, self.patterns]
    }

    /// Whether places still fit into words.
    fn check(&self) -> Result<()> {
        check(self.sets.words.len())?;
        check((self.units as usize) >> (abi::WIDTH_SHIFT - abi::STENCIL_SHIFT))
    }

    /// Appends a row that has a weight for each vertex of the ring, and is relative to its first.
    ///
    /// # Errors
    /// As for [`PackedRows::append`].
    pub(super) fn push_dense(&mut self, weights: &[f64]) -> Result<()> {
        let bits = weights
            .iter()
            .map(|&weight| (weight as f32 + 0.0).to_bits());
        let bits: SmallVec<[u32; 32]> = bits.collect();
        let number = self.known_sets.number(&mut self.sets, &bits);
        let row = [
            self.sets.start(number) | abi::STENCIL_OWN << abi::STENCIL_SHIFT,
            abi::DENSE << abi::WIDTH_SHIFT,
        ];
        self.rows.push(row);
        self.check()
    }

    /// Where a pattern begins, in units of four bits, and its width above that.
    fn pattern(&mut self, list: &[u32]) -> u32 {
        let number = self.known_patterns.number(&mut self.pattern_lists, list);
        if let Some(&known) = self.pattern_starts.get(number as usize) {
            return known;
        }
        let start = self.push_pattern(list);
        self.pattern_starts.push(start);
        start
    }

    fn push_pattern(&mut self, list: &[u32]) -> u32 {
        let (width, count, words) = StencilRows::pattern(list);
        // The wider ones begin with a word: so those of a ring of 32 vertices are in eight words, which shaders keep at hand.
        let first = match width {
            0 => self.units,
            _ => self.units.next_multiple_of(8),
        };
        self.units = first + count * (WIDTHS[width as usize] / 4);
        self.patterns.resize(self.units.div_ceil(8) as usize, 0);
        let (word, shift) = (first as usize / 8, 4 * (first % 8));
        for (at, &own) in (word..).zip(words) {
            self.patterns[at] |= own << shift;
            let above = u64::from(own) << shift >> 32;
            if let Some(next) = self.patterns.get_mut(at + 1) {
                *next |= above as u32;
            }
        }
        first | width << abi::WIDTH_SHIFT
    }

    /// Makes room enough for shaders to believe in so many products of a weight and a vertex, see [`abi::PRODUCTS_A_WORD`]. Only small tables of long rings
    /// need that.
    pub(crate) fn hold(&mut self, products: u64) {
        // Twice as many, for the rounding of floats.
        let words = 2 * products.div_ceil(u64::from(abi::PRODUCTS_A_WORD)) as usize;
        if self.bytes() < 4 * words {
            // A set of its own: others may follow.
            let more = words - self.bytes() / 4;
            self.sets.push(&vec![0; more]);
        }
    }

    /// The rows as shaders see them.
    pub fn view(&self) -> RowsView<'_> {
        RowsView {
            rows: &self.rows,
            sets: bytemuck::cast_slice(&self.sets.words),
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
    /// Visits the weights of the first vertices of the ring, so many, in their order.
    pub(crate) fn each_weight(&self, count: usize, mut visit: impl FnMut(usize, f32)) {
        if self.width != 0 {
            (0..count).for_each(|place| visit(place, self.weight(place)));
            return;
        }
        let mut word = 0;
        for place in 0..count {
            let at = self.first as usize + place;
            if place == 0 || at.is_multiple_of(8) {
                word = self.patterns.get(at / 8).copied().unwrap_or_default() >> (4 * (at % 8));
            }
            let weight = self.set.get((word & 15) as usize);
            visit(place, weight.copied().unwrap_or_default());
            word >>= 4;
        }
    }

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
    use crate::plan::stencil_rows::KnownRows;

    #[test]
    fn rows_are_read_as_they_were_pushed_and_kept_once() {
        let (mut packed, mut from_pool) = (PackedRows::default(), PackedRows::default());
        let pool = SharedPool::default();
        let mut push = |corner: Option<u32>, weights: &[f64]| {
            let mut rows = StencilRows::new(weights.len());
            let mut known = KnownRows::default();
            rows.push(0, corner, weights.iter().copied(), false, &mut known);
            packed.append(&rows).expect("they are few");
            let pooled = pool.keep([&rows].into_iter());
            from_pool.append_pooled(&pooled[0]).expect("they are few");
            packed.bytes()
        };
        let narrow = [0.5, -0.25, 0.0, 0.5, -0.0, 0.25];
        let wide: Vec<f64> = (0..300).map(|i| f64::from((i * 7) % 290) - 11.5).collect();
        let rows = [&narrow[..], &wide[..40], &wide, &narrow];
        let corners = [None, Some(0), None, Some(3)];
        let bytes = corners.into_iter().zip(rows);
        let before = bytes.map(|(corner, row)| push(corner, row)).last();
        assert_eq!(
            push(None, &[0.25, 0.5, -0.25, 0.0]) - before.expect("four rows"),
            8 + 4,
            "the same weights elsewhere are a row and a pattern"
        );
        let origins = corners
            .map(|corner| corner.map_or(abi::STENCIL_OWN, |corner| abi::STENCIL_CORNER + corner));
        for (number, (corner, row)) in (0..).zip(origins.into_iter().zip(rows)) {
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
        let words = |packed: &PackedRows| {
            let view = packed.view();
            let sets: Vec<u32> = view.sets.iter().map(|weight| weight.to_bits()).collect();
            (view.rows.to_vec(), sets, view.patterns.to_vec())
        };
        assert_eq!(words(&from_pool), words(&packed));
    }
}
