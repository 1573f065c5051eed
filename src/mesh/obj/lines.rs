//! From bytes to statements: line ends, comments, and lines that a backslash joins.
//!
//! Names of groups, materials and files, and comments, may be in any encoding: nothing here asks for UTF-8.

use std::borrow::Cow;
use std::fmt;

use memchr::memchr2;

use crate::error::{Error, Place, Result};

/// Statements that make the surface, and those that have no bearing on it.
pub(super) const READ: &[&str] = &["v", "vt", "f", "t"];
pub(super) const SKIPPED: &[&str] = &["vn", "vp", "s", "g", "o", "l", "p", "mtllib", "usemtl"];

/// Where a statement stands.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub file: &'a str,
    pub number: usize,
}

impl Line<'_> {
    pub fn error(self, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
        Error::input(
            Place::Line(self.file.to_string(), self.number),
            problem,
            remedy,
        )
    }
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.number)
    }
}

/// A statement: its comments are gone, and the lines that its backslashes join are one.
pub(super) struct Statement<'a> {
    /// Where it begins.
    pub line: Line<'a>,
    pub text: Cow<'a, [u8]>,
    /// The first line joined to it that could be a statement of its own.
    pub swallowed: Option<usize>,
    /// Whether the file ends behind one of its backslashes.
    pub cut_off: bool,
}

/// A place in a file.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'a> {
    pub file: &'a str,
    /// What is still to come.
    pub rest: &'a [u8],
    /// The number of the line at its beginning.
    pub number: usize,
}

impl<'a> Cursor<'a> {
    /// The beginning of a file.
    pub fn new(file: &'a str, bytes: &'a [u8]) -> Cursor<'a> {
        Cursor {
            file,
            rest: bytes,
            number: 1,
        }
    }

    /// Steps over a line of so many bytes, its end included.
    pub fn skip(&mut self, length: usize) {
        self.rest = &self.rest[length..];
        self.number += 1;
    }

    /// The next line, whose end is not part of it.
    fn line(&mut self) -> Option<(usize, &'a [u8])> {
        let line = Lines(self.rest).next()?;
        let number = self.number;
        self.skip(line.len() + end_of_line(&self.rest[line.len()..]));
        Some((number, line))
    }

    /// The next statement. What it consists of may be nothing at all.
    pub fn statement(&mut self) -> Option<Statement<'a>> {
        let (number, first) = self.line()?;
        let line = Line {
            file: self.file,
            number,
        };
        let mut statement = Statement {
            line,
            text: Cow::Borrowed(without_comment(first)),
            swallowed: None,
            cut_off: false,
        };
        while statement.text.ends_with(b"\\") {
            let joined = statement.text.to_mut();
            joined.pop();
            let Some((number, next)) = self.line() else {
                statement.cut_off = true;
                break;
            };
            if is_statement(next) && !joined.trim_ascii().is_empty() {
                statement.swallowed.get_or_insert(number);
            }
            joined.push(b' ');
            joined.extend_from_slice(without_comment(next));
        }
        Some(statement)
    }
}

/// The lines of a text.
struct Lines<'a>(&'a [u8]);

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.0.is_empty() {
            return None;
        }
        let end = memchr2(b'\n', b'\r', self.0).unwrap_or(self.0.len());
        let (line, rest) = self.0.split_at(end);
        self.0 = &rest[end_of_line(rest)..];
        Some(line)
    }
}

/// How many bytes belong to a line from here on, its end included. Lines end as they do on Unix, Windows or old Macs. CR CR LF, which a text file becomes
/// that is written as one twice, is one end.
pub(super) fn end_of_line(bytes: &[u8]) -> usize {
    let text = match bytes {
        [b'\n' | b'\r', ..] | [] => 0,
        _ => memchr2(b'\n', b'\r', bytes).unwrap_or(bytes.len()),
    };
    text + match bytes[text..] {
        [b'\r', b'\r', b'\n', ..] => 3,
        [b'\r', b'\n', ..] => 2,
        [_, ..] => 1,
        [] => 0,
    }
}

/// What stands before a `#`, without blanks at its end. In `1.#QNAN`, as Windows once wrote what is no number, it begins no comment.
fn without_comment(line: &[u8]) -> &[u8] {
    let begins_comment = |&at: &usize| {
        let names = ["QNAN", "SNAN", "IND", "INF", "NAN"];
        let is_name = |name: &&str| line[at + 1..].starts_with(name.as_bytes());
        line[at] == b'#' && !(line[..at].ends_with(b".") && names.iter().any(is_name))
    };
    let end = (0..line.len()).find(begins_comment);
    line[..end.unwrap_or(line.len())].trim_ascii_end()
}

/// Whether a line could be a statement that makes the surface.
fn is_statement(line: &[u8]) -> bool {
    let mut words = line.split(u8::is_ascii_whitespace);
    let first = words.find(|word| !word.is_empty()).unwrap_or_default();
    READ.iter().any(|keyword| keyword.as_bytes() == first)
}

/// A finite number.
pub(super) fn number(line: Line, what: &str, word: &str) -> Result<f64> {
    value(line, what, word)?.ok_or_else(|| not_finite(line, what, word))
}

/// A number; None where the word says that none could be computed: `nan`, `inf`, or what Windows writes for these.
pub(super) fn value(line: Line, what: &str, word: &str) -> Result<Option<f64>> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ if is_name_of_no_number(word) => Ok(None),
        Ok(_) => Err(not_finite(line, what, word)),
        Err(_) => Err(line.error(
            format!("the {what} {} is not a number", quoted(word)),
            "write a decimal number such as -1.5 or 2e-3",
        )),
    }
}

fn not_finite(line: Line, what: &str, word: &str) -> Error {
    line.error(
        format!("the {what} {} is not finite", quoted(word)),
        "replace NaN, infinite and too large values by numbers",
    )
}

/// Such as `NaN`, `-inf`, `-nan(ind)`, `1.#QNAN0`; a number that is too large to be one is none of these.
fn is_name_of_no_number(word: &str) -> bool {
    let plain = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    matches!(plain.as_str(), "nan" | "inf" | "infinity")
        || plain.starts_with("nan(") && plain.ends_with(')')
        || plain.starts_with("1.#")
}

/// The number, counted from 1, that `word` names when `count` of them have been given so far.
pub(super) fn index(line: Line, what: &str, word: &str, count: usize) -> Result<usize> {
    let given = word
        .parse::<isize>()
        .map_err(|_| not_an_index(line, what, word))?;
    if given == 0 {
        return Err(line.error(
            format!("the face names {what} 0"),
            format!("{what} numbers of faces count from 1"),
        ));
    }
    if given > 0 {
        return Ok(given.unsigned_abs());
    }
    let back = given.unsigned_abs();
    if back > count {
        return Err(line.error(
            format!("the face names {what} {given}, but only {count} stand before it"),
            "negative numbers count backwards from the face's own line",
        ));
    }
    Ok(count - back + 1)
}

pub(super) fn not_an_index(line: Line, what: &str, word: &str) -> Error {
    line.error(
        format!("the {what} {} is not a whole number", quoted(word)),
        "write the corner of a face as v, v/vt, v//vn or v/vt/vn",
    )
}

/// `word` in quotes, shortened when it would fill the screen.
pub(super) fn quoted(word: &str) -> String {
    match word.char_indices().nth(40) {
        Some((end, _)) => format!("{:?}...", &word[..end]),
        None => format!("{word:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Vec<&str> {
        let text = Lines(text).map(|line| std::str::from_utf8(line).expect("ASCII"));
        text.collect()
    }

    #[test]
    fn lines_end_as_on_unix_windows_and_old_macs() {
        assert_eq!(lines(b""), [] as [&str; 0]);
        assert_eq!(lines(b"a"), ["a"]);
        assert_eq!(lines(b"a\nb\n"), ["a", "b"]);
        assert_eq!(lines(b"a\r\nb\r\n\r\nc"), ["a", "b", "", "c"]);
        assert_eq!(lines(b"a\rb\r\rc\r"), ["a", "b", "", "c"]);
        assert_eq!(lines(b"a\r\r\nb\r\r\n"), ["a", "b"]);
        assert_eq!(lines(b"a\rb\nc\r\nd\n\re"), ["a", "b", "c", "d", "", "e"]);
    }

    #[test]
    fn comments_begin_with_a_sharp_that_belongs_to_no_number() {
        let kept = |text: &str| without_comment(text.as_bytes()).to_vec();
        assert_eq!(kept("f 1 2 3 # three"), b"f 1 2 3");
        assert_eq!(kept("f 1 2 3#three"), b"f 1 2 3");
        assert_eq!(kept("#"), b"");
        assert_eq!(
            kept("vt -1.#IND00 1.#QNAN \t# 1.#INF"),
            b"vt -1.#IND00 1.#QNAN"
        );
        assert_eq!(kept("v 0 0 1.#no number"), b"v 0 0 1.");
    }
}
