//! The bytes of a database file, without a file: a header, then records.
//!
//! | bytes | header | bytes | record, at a multiple of 4 |
//! | ---: | --- | ---: | --- |
//! | 16 | [`MAGIC`] | 4 | [`RECORD`] |
//! | 4 | [`VERSION`], little-endian as all words | 4 | words of key and entry |
//! | 4 | CRC-32 of these | 4 | words of the key alone |
//! | | | 4 | CRC-32 of both counts and all words |
//! | | | | the key's words, then the entry's (`words.rs`) |
//!
//! Records are only ever appended. What a writer left unfinished, or a disk got wrong, is no record; reading goes on at the next that is one, wherever it
//! begins: so neither costs more than itself.

use std::ops::Range;

/// What a database begins with. The line breaks show whether something took it for text.
pub const MAGIC: [u8; 16] = *b"hullform plans\r\n";
/// Of the layout *and* of what builds plans: a file of another version is of no use. `tests/database.rs` tells when it must change.
pub const VERSION: u32 = 4;
/// What a record begins with. Programs of two versions may have one file open, which the newer has begun anew.
const RECORD: u32 = 0x4e41_4c00 + VERSION;
/// The bytes of the header.
pub const HEADER: usize = 24;
/// The bytes of a record in front of its words.
const HEAD: usize = 16;

/// What a file's beginning says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beginning {
    /// Ours.
    Sound,
    /// Nothing, or so little that only a writer that was interrupted can have left it.
    Empty,
    /// A database of another version.
    Version(u32),
    /// Something else.
    Foreign,
}

/// The header.
pub fn header() -> [u8; HEADER] {
    let mut bytes = [0; HEADER];
    bytes[..16].copy_from_slice(&MAGIC);
    bytes[16..20].copy_from_slice(&VERSION.to_le_bytes());
    let sum = crc32fast::hash(&bytes[..20]);
    bytes[20..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..at.checked_add(4)?)?;
    bytes.try_into().ok().map(u32::from_le_bytes)
}

/// What the beginning of a file is.
pub fn beginning(bytes: &[u8]) -> Beginning {
    let own = header();
    let common = bytes.len().min(16);
    if bytes[..common] != MAGIC[..common] {
        return Beginning::Foreign;
    }
    if bytes.len() < HEADER {
        return Beginning::Empty;
    }
    if bytes[..HEADER] == own {
        return Beginning::Sound;
    }
    match (word(bytes, 16), word(bytes, 20)) {
        (Some(version), Some(sum)) if crc32fast::hash(&bytes[..20]) == sum => {
            Beginning::Version(version)
        }
        // A header that was damaged: the records have sums of their own, but may be another version's.
        _ => Beginning::Foreign,
    }
}

/// The bytes of a record.
pub fn record(key: &[u32], entry: &[u32]) -> Vec<u8> {
    let counts = [(key.len() + entry.len()) as u32, key.len() as u32];
    let mut bytes = Vec::with_capacity(HEAD + 4 * counts[0] as usize);
    bytes.extend(RECORD.to_le_bytes());
    counts
        .iter()
        .for_each(|count| bytes.extend(count.to_le_bytes()));
    bytes.extend([0; 4]);
    let words = key.iter().chain(entry);
    words.for_each(|word| bytes.extend(word.to_le_bytes()));
    let sum = sum_of(&bytes);
    bytes[12..HEAD].copy_from_slice(&sum.to_le_bytes());
    bytes
}

fn sum_of(record: &[u8]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(&record[4..12]);
    sum.update(&record[HEAD..]);
    sum.finalize()
}

/// Where the record that begins at a place ends; None where none begins that is whole.
fn end_of(bytes: &[u8], at: usize) -> Option<usize> {
    if word(bytes, at)? != RECORD {
        return None;
    }
    let (all, key) = (word(bytes, at + 4)?, word(bytes, at + 8)?);
    let end = (at + HEAD).checked_add(4 * all as usize)?;
    let record = bytes.get(at..end)?;
    (key <= all && word(record, 12)? == sum_of(record)).then_some(end)
}

fn words(bytes: &[u8]) -> impl ExactSizeIterator<Item = u32> {
    let (words, _) = bytes.as_chunks::<4>();
    words.iter().map(|&word| u32::from_le_bytes(word))
}

/// The words of the key of a record that [`scan`] found.
pub fn key(record: &[u8]) -> Option<Box<[u32]>> {
    let count = word(record, 8)? as usize;
    Some(words(record.get(HEAD..HEAD + 4 * count)?).collect())
}

/// The words of the entry of a whole record that has this key; None where it is none.
pub fn entry(record: &[u8], key: &[u32]) -> Option<Vec<u32>> {
    let is_whole = end_of(record, 0)? == record.len() && word(record, 8)? as usize == key.len();
    let (own, entry) = record.get(HEAD..)?.split_at_checked(4 * key.len())?;
    let is_it = is_whole && words(own).eq(key.iter().copied());
    is_it.then(|| words(entry).collect())
}

/// The records from a place on, each where it begins and ends, and how many bytes are none of any.
pub fn scan(bytes: &[u8], from: usize) -> (Vec<Range<usize>>, usize) {
    let mut at = from.next_multiple_of(4);
    let (mut found, mut lost) = (Vec::new(), at.min(bytes.len()) - from.min(bytes.len()));
    while at < bytes.len() {
        match end_of(bytes, at) {
            Some(end) => {
                found.push(at..end);
                at = end;
            }
            None => {
                lost += 4.min(bytes.len() - at);
                at += 4;
            }
        }
    }
    (found, lost)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(records: &[Vec<u8>]) -> Vec<u8> {
        [&header()[..], &records.concat()].concat()
    }

    #[test]
    fn a_damaged_byte_costs_the_record_that_it_is_in_and_no_other() {
        let records: Vec<Vec<u8>> = (0..5u32)
            .map(|i| record(&[i, 7, RECORD], &vec![RECORD + i; 3 * i as usize]))
            .collect();
        let whole = file(&records);
        let (found, lost) = scan(&whole, HEADER);
        assert_eq!((found.len(), lost), (5, 0));
        for at in HEADER..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 1 << (at % 8);
            let (kept, _) = scan(&damaged, HEADER);
            let untouched = found.iter().filter(|range| !range.contains(&at));
            assert!(untouched.eq(&kept), "byte {at}");
        }
    }

    #[test]
    fn what_was_cut_off_is_lost_and_what_comes_behind_it_is_not() {
        let (one, two) = (record(&[1], &[2, 3, u32::MAX]), record(&[5], &[6]));
        for cut in 0..one.len() {
            let mut bytes = file(&[one[..cut].to_vec()]);
            bytes.resize(bytes.len().next_multiple_of(4), 0);
            let start = bytes.len();
            bytes.extend(&two);
            let (found, _) = scan(&bytes, HEADER);
            assert!(
                matches!(&found[..], [one] if *one == (start..bytes.len())),
                "{cut} bytes"
            );
        }
    }

    #[test]
    fn a_file_of_another_kind_is_told_from_one_of_another_version() {
        assert_eq!(beginning(&header()), Beginning::Sound);
        assert_eq!(beginning(&header()[..9]), Beginning::Empty);
        assert_eq!(beginning(b""), Beginning::Empty);
        assert_eq!(
            beginning(b"# an OBJ file, and not a short one\n"),
            Beginning::Foreign
        );
        let mut other = header();
        other[16] = 9;
        assert_eq!(beginning(&other), Beginning::Foreign);
        let sum = crc32fast::hash(&other[..20]);
        other[20..].copy_from_slice(&sum.to_le_bytes());
        assert_eq!(beginning(&other), Beginning::Version(9));
    }
}
