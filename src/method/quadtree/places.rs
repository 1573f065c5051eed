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

/// The words of a list of places in a ring of this size.
pub fn pack(ring: usize, places: &[u32]) -> impl Iterator<Item = u32> {
    let bits = bits(ring);
    places.chunks((32 / bits) as usize).map(move |places| {
        let places = places.iter().rev();
        places.fold(0, |word, &place| word << bits | place)
    })
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
        for (ring, count, words) in [(32, 32, 6), (33, 33, 17), (7, 6, 1), (7, 7, 2)] {
            let places: Vec<u32> = (0..count).map(|i| (i * 7) % ring).collect();
            let packed: Vec<u32> = pack(ring as usize, &places).collect();
            assert_eq!(packed.len(), words);
            let read = (0..places.len()).map(|i| place_at(ring as usize, &packed, i));
            assert!(read.eq(places.iter().copied()), "{ring}");
        }
    }
}
