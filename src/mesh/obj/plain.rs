//! The lines that nearly all of a file consists of, straight from its bytes.
//!
//! Each number is parsed once, where it stands. What is in any way unusual (a comment behind a statement, a backslash, another encoding, a weight, a name
//! of no number, anything that is refused) is left to [`Scan::statement`], which knows every case and has the words for it. So nothing here needs to know
//! what an error says, and both say the same of what both can read.

use glam::{DVec2, DVec3};
use memchr::memchr3;
use smallvec::SmallVec;

use super::lines::end_of_line;
use super::scan::{Corner, Scan};

/// A statement's numbers, and where it ends.
type Read<T> = Option<(T, usize)>;

/// Faces of so many corners are read here; larger ones are seldom, and searched for a vertex that is named twice in another way.
const MOST_CORNERS: usize = 16;

/// The part of a number that f64 holds exactly, and the powers of ten that it holds exactly: one product or quotient of both is correctly rounded
/// (Clinger, How to read floating point numbers accurately, 1990, section 3).
const EXACT: u64 = 1 << 53;
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

impl Scan {
    /// Takes in the line at the beginning of `bytes` if it is plain. Hands out where the next one begins; None, and nothing taken in, where it is not.
    pub(super) fn plain(&mut self, bytes: &[u8], line: usize) -> Option<usize> {
        match *bytes {
            [b'v', b' ' | b'\t', ..] => {
                let (position, end) = vertex(bytes)?;
                self.positions.push(position);
                Some(end)
            }
            [b'v', b't', b' ' | b'\t', ..] => {
                let (value, end) = texture(bytes)?;
                self.textures.push(value);
                Some(end)
            }
            [b'f', b' ' | b'\t', ..] => self.plain_face(bytes, line),
            [b'v', b'n', b' ' | b'\t', ..] | [b'g' | b's' | b'o', b' ', ..] => skipped(bytes),
            [b'#', ..] | [b'\n' | b'\r', ..] => Some(end_of_line(bytes)),
            _ => None,
        }
    }

    fn plain_face(&mut self, bytes: &[u8], line: usize) -> Option<usize> {
        let mut corners: SmallVec<[Corner; MOST_CORNERS]> = SmallVec::new();
        let mut at = blanks(bytes, 2);
        while !is_end(bytes, at) {
            if corners.len() == MOST_CORNERS {
                return None;
            }
            let (corner, next) = self.plain_corner(bytes, at)?;
            let is_twice = corners.iter().any(|known| known.vertex == corner.vertex);
            if is_twice {
                return None;
            }
            corners.push(corner);
            at = blanks(bytes, next);
        }
        if corners.len() < 3 {
            return None;
        }
        self.take_face(line, &corners);
        Some(at + end_of_line(&bytes[at..]))
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn plain_corner(&self, bytes: &[u8], at: usize) -> Read<Corner> {
        let (vertex, mut at) = whole(bytes, at)?;
        let vertex = numbered(vertex, self.positions.len())?;
        let mut texture = None;
        if byte(bytes, at) == b'/' {
            at += 1;
            if byte(bytes, at) != b'/' {
                let (number, end) = whole(bytes, at)?;
                texture = Some(numbered(number, self.textures.len())?);
                at = end;
            }
            if byte(bytes, at) == b'/' {
                at = whole(bytes, at + 1)?.1;
            }
        }
        is_word_end(bytes, at).then_some((Corner { vertex, texture }, at))
    }
}

/// Three coordinates, and perhaps three numbers of a colour.
fn vertex(bytes: &[u8]) -> Read<DVec3> {
    let mut at = blanks(bytes, 1);
    let mut position = DVec3::ZERO;
    for axis in 0..3 {
        (position[axis], at) = number(bytes, at)?;
        at = blanks(bytes, at);
    }
    if !is_end(bytes, at) {
        for _ in 0..3 {
            at = blanks(bytes, number(bytes, at)?.1);
        }
    }
    is_end(bytes, at).then(|| (position, at + end_of_line(&bytes[at..])))
}

/// Two numbers, and perhaps a third that is 0 or not.
fn texture(bytes: &[u8]) -> Read<DVec2> {
    let (u, at) = number(bytes, blanks(bytes, 2))?;
    let (v, at) = number(bytes, blanks(bytes, at))?;
    let mut at = blanks(bytes, at);
    if !is_end(bytes, at) {
        at = blanks(bytes, number(bytes, at)?.1);
    }
    is_end(bytes, at).then(|| (DVec2::new(u, v), at + end_of_line(&bytes[at..])))
}

/// Where a line ends that has no bearing on the surface, nor a backslash.
fn skipped(bytes: &[u8]) -> Option<usize> {
    let end = memchr3(b'\n', b'\r', b'\\', bytes).unwrap_or(bytes.len());
    (byte(bytes, end) != b'\\').then(|| end + end_of_line(&bytes[end..]))
}

/// The byte there; behind the last a line ends.
fn byte(bytes: &[u8], at: usize) -> u8 {
    bytes.get(at).copied().unwrap_or(b'\n')
}

fn blanks(bytes: &[u8], mut at: usize) -> usize {
    while matches!(byte(bytes, at), b' ' | b'\t') {
        at += 1;
    }
    at
}

fn is_end(bytes: &[u8], at: usize) -> bool {
    matches!(byte(bytes, at), b'\n' | b'\r')
}

fn is_word_end(bytes: &[u8], at: usize) -> bool {
    matches!(byte(bytes, at), b' ' | b'\t' | b'\n' | b'\r')
}

/// Digits from a place on, as a number and as their count; beyond nineteen the number has overflown.
fn digits(bytes: &[u8], mut at: usize, mut number: u64) -> (u64, usize) {
    loop {
        let digit = byte(bytes, at).wrapping_sub(b'0');
        if digit > 9 {
            return (number, at);
        }
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
}

/// A whole number of up to nine digits.
fn whole(bytes: &[u8], at: usize) -> Read<i64> {
    let negative = byte(bytes, at) == b'-';
    let first = at + usize::from(negative);
    let (number, end) = digits(bytes, first, 0);
    if !(1..=9).contains(&(end - first)) {
        return None;
    }
    let number = number as i64;
    Some((if negative { -number } else { number }, end))
}

/// What a number of a face names, counted from 0, when `count` have been given so far.
fn numbered(number: i64, count: usize) -> Option<u32> {
    let from_zero = match number {
        0 => return None,
        1.. => number - 1,
        _ => count as i64 + number,
    };
    u32::try_from(from_zero).ok()
}

/// A finite decimal number, correctly rounded.
fn number(bytes: &[u8], start: usize) -> Read<f64> {
    let negative = byte(bytes, start) == b'-';
    let first = start + usize::from(negative);
    let (mantissa, mut at) = digits(bytes, first, 0);
    let (mut mantissa, mut count) = (mantissa, at - first);
    let mut exponent = 0;
    if byte(bytes, at) == b'.' {
        let point = at + 1;
        (mantissa, at) = digits(bytes, point, mantissa);
        count += at - point;
        exponent = -((at - point) as i64);
    }
    if matches!(byte(bytes, at), b'e' | b'E') {
        let (shift, end) = signed(bytes, at + 1)?;
        exponent += shift;
        at = end;
    }
    if count == 0 || !is_word_end(bytes, at) {
        return None;
    }
    let is_exact = count <= 19 && mantissa <= EXACT;
    let value: f64 = match POWERS.get(exponent.unsigned_abs() as usize) {
        Some(power) if is_exact && exponent < 0 => mantissa as f64 / power,
        Some(power) if is_exact => mantissa as f64 * power,
        _ => std::str::from_utf8(&bytes[first..at]).ok()?.parse().ok()?,
    };
    let signed = if negative { -value } else { value };
    value.is_finite().then_some((signed, at))
}

/// An exponent.
fn signed(bytes: &[u8], at: usize) -> Read<i64> {
    match byte(bytes, at) {
        b'+' if byte(bytes, at + 1) != b'-' => whole(bytes, at + 1),
        b'+' => None,
        _ => whole(bytes, at),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_standard_library() {
        let words = [
            "0",
            "-0",
            "1",
            "-1.5",
            "2.",
            ".5",
            "-.25",
            "1e3",
            "1E+3",
            "12.5e-7",
            "0.1",
            "0.3",
            "123456.789012",
            "9007199254740993",
            "0.000000000000000000000000001",
            "1e22",
            "1e23",
            "8.5e-23",
            "1e-300",
            "4.9e-324",
            "123456789012345678901234567890",
            "0.12345678901234567890123",
            "1e308",
            "00000000000000000000001.5",
            "3.4028235e38",
        ];
        for word in words {
            let expected: f64 = word.parse().expect("a number");
            for text in [word.to_string(), format!("{word} 7"), format!("{word}\r\n")] {
                let (value, end) = number(text.as_bytes(), 0).expect(word);
                assert_eq!(
                    (value.to_bits(), end),
                    (expected.to_bits(), word.len()),
                    "{word}"
                );
            }
        }
        let mut state = 1u64;
        for _ in 0..100_000 {
            // Any double, in as many digits as it takes.
            state = state
                .wrapping_mul(0x5851_f42d_4c95_7f2d)
                .wrapping_add(0x1405_7b7e_f767_814f);
            let value = f64::from_bits(state ^ state >> 29);
            for word in [format!("{value:e}"), format!("{:.6}", value % 1000.0)] {
                let read = number(word.as_bytes(), 0).map(|read| read.0.to_bits());
                let expected: f64 = word.parse().expect("a number");
                assert_eq!(
                    read,
                    expected.is_finite().then_some(expected.to_bits()),
                    "{word}"
                );
            }
        }
    }

    #[test]
    fn what_is_no_plain_number_is_left_alone() {
        for word in [
            "", "-", ".", "e5", "1e", "1e+", "1e+-5", "+1", "--1", "1.2.3", "1x", "nan", "inf",
            "1e400", "1\u{b}",
        ] {
            assert_eq!(number(word.as_bytes(), 0), None, "{word:?}");
        }
        for word in ["", "-", "+1", "1234567890", "9223372036854775808"] {
            assert_eq!(whole(word.as_bytes(), 0), None, "{word:?}");
        }
        assert_eq!(
            [0, 1, -1, -4, -5].map(|number| numbered(number, 4)),
            [None, Some(0), Some(3), Some(0), None]
        );
        assert_eq!(numbered(-1, 0), None);
    }
}
