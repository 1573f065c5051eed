//! The weights of one plan's stencils, packed: what is alike in several is there once. So a database keeps them, in memory and on disk, and so they are laid
//! into the tables that shaders read ([`PackedRows`](super::packed_rows::PackedRows)), set by set and pattern by pattern instead of weight by weight.

use smallvec::SmallVec;

use crate::plan::lists::{KnownLists, Lists};

/// The bits of a number in a pattern: 4, 8 or 16.
pub(super) const WIDTHS: [u32; 3] = [4, 8, 16];

/// Instead of a pattern's number: the row's set has a weight for each vertex of the ring, in their order.
const DENSE: u32 = NUMBER;
/// The bits of numbers of sets and patterns; what is above belongs to the stencil.
const NUMBER: u32 = (1 << SHIFT) - 1;
const SHIFT: u32 = 28;

/// Rows of weights; see [`PackedRows`](super::packed_rows::PackedRows) for what sets and patterns are.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct StencilRows {
    /// Vertices of the ring.
    ring_size: usize,
    /// For each stencil the number of its set and, above, its corner plus 1, or 0; the number of its pattern and, above, its level.
    pub rows: Vec<[u32; 2]>,
    /// The sets, as bits of floats.
    pub sets: Lists,
    /// The patterns: first what [`pattern_head`] tells, then the numbers, packed.
    pub patterns: Lists,
}

/// What tells patterns that have the same words apart: the ring's size and the width of numbers.
fn pattern_head(ring_size: usize, width: u32) -> u32 {
    (ring_size as u32) << 2 | width
}

/// Which sets and patterns a plan has so far. Its memory serves one plan after another.
#[derive(Debug, Default)]
pub(super) struct KnownRows {
    sets: KnownLists,
    patterns: KnownLists,
}

impl KnownRows {
    /// Forgets those of the plan before.
    pub fn clear(&mut self) {
        self.sets.clear();
        self.patterns.clear();
    }
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

/// The bits of the float that has a key.
fn bits_of(key: u32) -> u32 {
    if key >> 31 != 0 {
        key & !(1 << 31)
    } else {
        !key
    }
}

/// Words of a row.
type Words = SmallVec<[u32; 32]>;

/// Rows of so many weights are told apart without a search.
const SHORT: usize = 64;

/// The key of zero, which most rows have several times.
const ZERO: u32 = 1 << 31;

/// Tells a row's weights apart: hands on the different keys, in ascending order, and for each weight the number of its key.
fn numbered<R>(
    weights: impl Iterator<Item = f32>,
    count: usize,
    then: impl FnOnce(&mut [u32], &[u16]) -> R,
) -> R {
    if count > SHORT {
        let keys: Words = weights.map(ascending).collect();
        let mut set = keys.clone();
        set.sort_unstable();
        set.dedup();
        let number = |key: &u32| set.binary_search(key).unwrap_or_default() as u16;
        let numbers: Vec<u16> = keys.iter().map(number).collect();
        return then(&mut set, &numbers);
    }
    let mut keys = [0; SHORT];
    let all = keys.iter_mut().zip(weights);
    all.for_each(|(key, weight)| *key = ascending(weight));
    let keys = &keys[..count];
    // Key and place of those that are not zero.
    let mut others = [0u64; SHORT];
    let mut met = 0;
    for (place, &key) in (0..).zip(keys) {
        others[met % SHORT] = u64::from(key) << 8 | place;
        met += usize::from(key != ZERO);
    }
    let others = &mut others[..met];
    others.sort_unstable();
    let has_zero = met < count;
    let (mut set, mut next) = ([0; SHORT], 0);
    let mut push = |key: u32| {
        set[next % SHORT] = key;
        next += 1;
        next as u16 - 1
    };
    let mut numbers = [0; SHORT];
    let (mut before, mut number) = (ZERO, 0);
    let mut zero = None;
    for &mut entry in others {
        let key = (entry >> 8) as u32;
        if key != before {
            if has_zero && zero.is_none() && key > ZERO {
                zero = Some(push(ZERO));
            }
            (before, number) = (key, push(key));
        }
        numbers[entry as usize % SHORT] = number;
    }
    if has_zero {
        let zero = zero.unwrap_or_else(|| push(ZERO));
        for (number, _) in numbers.iter_mut().zip(keys).filter(|at| *at.1 == ZERO) {
            *number = zero;
        }
    }
    then(&mut set[..next], &numbers[..count])
}

/// Which of the widths numbers of a set have.
fn width_for(set: usize) -> u32 {
    match set {
        0..=16 => 0,
        17..=256 => 1,
        _ => 2,
    }
}

impl StencilRows {
    /// None, over a ring of so many vertices.
    pub fn new(ring_size: usize) -> StencilRows {
        StencilRows {
            ring_size,
            ..StencilRows::default()
        }
    }

    /// What words told; None where these are no rows over a ring of this size.
    pub fn checked(
        ring_size: usize,
        rows: Vec<[u32; 2]>,
        sets: Lists,
        patterns: Lists,
    ) -> Option<StencilRows> {
        // For each pattern how many numbers it uses.
        let used = |list: &[u32]| -> Option<u32> {
            let (&head, words) = list.split_first()?;
            let width = head & 3;
            let bits = *WIDTHS.get(width as usize)?;
            let sound = head == pattern_head(ring_size, width)
                && words.len() == ring_size.div_ceil((32 / bits) as usize);
            sound.then(|| greatest(words, bits) + 1)
        };
        let used: Option<Vec<u32>> = patterns.iter().map(used).collect();
        let used = used?;
        let is_row = |&[set, pattern]: &[u32; 2]| {
            let (set, pattern) = (set & NUMBER, pattern & NUMBER);
            let ends = sets.ends();
            let Some(&end) = ends.get(set as usize) else {
                return false;
            };
            let length = (end - sets.start(set)) as usize;
            match used.get(pattern as usize) {
                Some(&used) => used as usize <= length,
                None => pattern == DENSE && length == ring_size,
            }
        };
        rows.iter().all(is_row).then_some(StencilRows {
            ring_size,
            rows,
            sets,
            patterns,
        })
    }

    /// Appends a row. A dense one has no pattern.
    pub fn push(
        &mut self,
        level: u32,
        corner: Option<u32>,
        weights: impl Iterator<Item = f64>,
        dense: bool,
        known: &mut KnownRows,
    ) {
        let weights = weights.map(|weight| weight as f32 + 0.0);
        let [set, pattern] = if dense {
            let set: Words = weights.map(f32::to_bits).collect();
            [known.sets.number(&mut self.sets, &set), DENSE]
        } else {
            let ring_size = self.ring_size;
            numbered(weights, ring_size, |set, numbers| {
                set.iter_mut().for_each(|key| *key = bits_of(*key));
                let width = width_for(set.len());
                let mut packed = Words::new();
                packed.push(pattern_head(ring_size, width));
                let bits = WIDTHS[width as usize];
                for numbers in numbers.chunks((32 / bits) as usize) {
                    let word = |word: u32, &number: &u16| word << bits | u32::from(number);
                    packed.push(numbers.iter().rev().fold(0, word));
                }
                [
                    known.sets.number(&mut self.sets, set),
                    known.patterns.number(&mut self.patterns, &packed),
                ]
            })
        };
        let corner = corner.map_or(0, |corner| corner + 1);
        self.rows
            .push([set | corner << SHIFT, pattern | level << SHIFT]);
    }

    /// The level of a row.
    pub fn level(row: &[u32; 2]) -> u32 {
        row[1] >> SHIFT
    }

    /// The corner of a row.
    pub fn corner(row: &[u32; 2]) -> Option<u32> {
        (row[0] >> SHIFT).checked_sub(1)
    }

    /// The numbers of a row's set and pattern; a dense one has none.
    pub fn parts(row: &[u32; 2]) -> (u32, Option<u32>) {
        let pattern = row[1] & NUMBER;
        (row[0] & NUMBER, (pattern != DENSE).then_some(pattern))
    }

    /// Width, count and packed numbers of a pattern.
    pub fn pattern(list: &[u32]) -> (u32, u32, &[u32]) {
        (list[0] & 3, list[0] >> 2, &list[1..])
    }

    /// The same row where its set and its pattern have other numbers.
    pub fn renumbered(row: &[u32; 2], sets: &[u32], patterns: &[u32]) -> [u32; 2] {
        let (set, pattern) = StencilRows::parts(row);
        let pattern = pattern.map_or(DENSE, |pattern| patterns[pattern as usize]);
        [
            sets[set as usize] | (row[0] & !NUMBER),
            pattern | (row[1] & !NUMBER),
        ]
    }

    /// The weights of row `number`, one a vertex of the ring.
    pub fn weights(&self, number: usize) -> Vec<f64> {
        let row = &self.rows[number];
        StencilRows::weights_of(row, &self.sets, &self.patterns, self.ring_size)
    }

    /// The weights of a row that has one of these sets and patterns.
    pub fn weights_of(
        row: &[u32; 2],
        sets: &Lists,
        patterns: &Lists,
        ring_size: usize,
    ) -> Vec<f64> {
        let (set, pattern) = StencilRows::parts(row);
        let set = sets.get(set);
        let weight = |number: usize| f64::from(f32::from_bits(set[number]));
        let Some(pattern) = pattern else {
            return (0..ring_size).map(weight).collect();
        };
        let (width, count, words) = StencilRows::pattern(patterns.get(pattern));
        let number = |place| number_at(words, WIDTHS[width as usize], place);
        (0..count as usize)
            .map(|place| weight(number(place)))
            .collect()
    }

    /// For each row the sum of its weights, and that of their magnitudes: how often each of a pattern's numbers stands there is counted once.
    pub fn sums(&self) -> impl Iterator<Item = [f64; 2]> {
        let mut ends = Vec::with_capacity(self.patterns.len());
        let mut counts: Vec<u32> = Vec::new();
        for list in self.patterns.iter() {
            let (width, count, words) = StencilRows::pattern(list);
            let first = counts.len();
            for place in 0..count as usize {
                let number = first + number_at(words, WIDTHS[width as usize], place);
                if number >= counts.len() {
                    counts.resize(number + 1, 0);
                }
                counts[number] += 1;
            }
            ends.push(counts.len());
        }
        self.rows.iter().map(move |row| {
            let (set, pattern) = StencilRows::parts(row);
            let counts = pattern.map(|pattern| {
                let pattern = pattern as usize;
                let start = pattern.checked_sub(1).map_or(0, |before| ends[before]);
                &counts[start..ends[pattern]]
            });
            let mut sums = [0.0; 2];
            for (number, &bits) in self.sets.get(set).iter().enumerate() {
                let count = counts.map_or(1, |counts| counts.get(number).copied().unwrap_or(0));
                let weight = f64::from(f32::from_bits(bits));
                sums[0] += f64::from(count) * weight;
                sums[1] += f64::from(count) * weight.abs();
            }
            sums
        })
    }
}

/// The greatest of packed numbers.
fn greatest(words: &[u32], bits: u32) -> u32 {
    let mask = u32::MAX >> (32 - bits);
    let numbers = |&word: &u32| (0..32 / bits).map(move |i| word >> (bits * i) & mask);
    words.iter().flat_map(numbers).max().unwrap_or(0)
}

/// A number of a packed pattern.
fn number_at(words: &[u32], bits: u32, place: usize) -> usize {
    let each = (32 / bits) as usize;
    (words[place / each] >> (bits as usize * (place % each)) & (u32::MAX >> (32 - bits))) as usize
}
