//! Lists of places in the ring of a patch, as shaders read them. Twin of `place_at` in `glsl/method/quadtree.glsl`.

use crate::abi;

/// How many bits a place in a ring of this size has.
fn bits(ring: usize) -> u32 {
    if ring <= abi::CONTROL_INVOCATIONS as usize {
        abi::PLACE_BITS
    } else {
        abi::LONG_PLACE_BITS
    }
}

/// How many words a list of so many places in a ring of this size takes.
pub fn words(ring: usize, count: usize) -> usize {
    count.div_ceil((32 / bits(ring)) as usize)
}

/// Appends a list of places in a ring of this size.
pub fn push<T: Copy + Into<u32>>(words: &mut impl Extend<u32>, ring: usize, places: &[T]) {
    let bits = bits(ring);
    let packed = |places: &[T]| {
        let places = places.iter().rev();
        places.fold(0, |word, &place| word << bits | place.into())
    };
    words.extend(places.chunks((32 / bits) as usize).map(packed));
}

/// Place `i` of the list that begins with `words`.
pub fn place_at(ring: usize, words: &[u32], i: usize) -> u32 {
    let bits = bits(ring);
    let places = (32 / bits) as usize;
    words[i / places] >> (bits as usize * (i % places)) & ((1 << bits) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_as_they_were_packed() {
        for (ring, count, expected) in [(32, 32, 6), (33, 33, 17), (7, 6, 1), (7, 7, 2)] {
            let places: Vec<u32> = (0..count).map(|i| (i * 7) % ring).collect();
            let mut packed = Vec::new();
            push(&mut packed, ring as usize, &places);
            assert_eq!(packed.len(), expected);
            assert_eq!(words(ring as usize, places.len()), expected);
            let read = (0..places.len()).map(|i| place_at(ring as usize, &packed, i));
            assert!(read.eq(places.iter().copied()), "{ring}");
        }
    }
}
