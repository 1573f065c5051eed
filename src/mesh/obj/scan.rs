//! The scan: checks every statement while its line is known and keeps those that `tobj` is to read.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt;

use super::tags::Tags;
use crate::error::{Error, Place, Result};

/// Statements that have no bearing on the surface.
const SKIPPED: &[&str] = &["vn", "vp", "s", "g", "o", "l", "p", "mtllib", "usemtl"];

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

/// What a file holds, line by line.
#[derive(Default)]
pub(super) struct Scan {
    /// The checked `v`, `vt` and `f` statements, one a line, without comments.
    pub geometry: String,
    pub vertices: usize,
    pub textures: usize,
    pub face_sizes: Vec<u32>,
    pub face_lines: Vec<usize>,
    /// Whether every corner of every face has a texture coordinate.
    pub textured: bool,
    pub tags: Tags,
    highest_vertex: Highest,
    highest_texture: Highest,
    textured_corners: usize,
    first_untextured: Option<usize>,
    warned: BTreeSet<String>,
}

/// The greatest number a face names, counted from 1, and the line where it does.
#[derive(Default)]
struct Highest {
    number: usize,
    line: usize,
}

impl Scan {
    /// Scans `text`; `file` is what messages call it.
    pub fn new(file: &str, text: &str) -> Result<Scan> {
        let mut scan = Scan::default();
        for_each_statement(file, text, |line, statement| {
            scan.statement(line, statement)
        })?;
        scan.finish(file)?;
        Ok(scan)
    }

    /// The line that a message about `place` should name.
    pub fn line_of(&self, place: &Place) -> Option<usize> {
        match *place {
            Place::Face(face) if face < self.face_lines.len() => Some(self.face_lines[face]),
            _ => self.tags.line_of(place),
        }
    }

    fn statement(&mut self, line: Line, statement: &str) -> Result<()> {
        let mut words = statement.split_whitespace();
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        let words: Vec<&str> = words.collect();
        match keyword {
            "v" => self.vertex(line, &words),
            "vt" => self.texture(line, &words),
            "f" => self.face(line, &words),
            "t" => self.tag(line, &words),
            _ if SKIPPED.contains(&keyword) => Ok(()),
            _ => {
                self.warn_once(line, keyword, "this statement is unknown and ignored");
                Ok(())
            }
        }
    }

    fn vertex(&mut self, line: Line, words: &[&str]) -> Result<()> {
        let [x, y, z, rest @ ..] = words else {
            return Err(line.error(
                format!("the vertex has {} coordinates", words.len()),
                "write three: v x y z",
            ));
        };
        for word in words {
            number(line, "coordinate", word)?;
        }
        // A fourth value alone is a weight, three more are a colour. `tobj` would divide by the weight.
        if let [weight] = rest
            && number(line, "weight", weight)? != 1.0
        {
            self.warn_once(line, "v", "the fourth value, a weight, is ignored");
        }
        self.vertices += 1;
        self.keep("v", &[x, y, z]);
        Ok(())
    }

    fn texture(&mut self, line: Line, words: &[&str]) -> Result<()> {
        let [u, v, ..] = words else {
            return Err(line.error(
                format!("the texture coordinate has {} values", words.len()),
                "write two: vt u v",
            ));
        };
        for word in words {
            number(line, "texture coordinate", word)?;
        }
        self.textures += 1;
        self.keep("vt", &[u, v]);
        Ok(())
    }

    fn face(&mut self, line: Line, words: &[&str]) -> Result<()> {
        if words.len() < 3 {
            return Err(line.error(
                format!("the face has {} vertices", words.len()),
                "faces need three or more vertices",
            ));
        }
        let mut vertices = Vec::with_capacity(words.len());
        for word in words {
            vertices.push(self.face_corner(line, word)?);
        }
        vertices.sort_unstable();
        if let Some(pair) = vertices.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(line.error(
                format!("the face names vertex {} twice", pair[0]),
                "remove the repeated vertex, or split the face",
            ));
        }
        let size = u32::try_from(words.len())
            .map_err(|_| line.error("the face has too many vertices", "split the face"))?;
        self.face_sizes.push(size);
        self.face_lines.push(line.number);
        self.keep("f", words);
        Ok(())
    }

    /// Checks `v`, `v/vt`, `v//vn` or `v/vt/vn` and hands out the vertex's number, counted from 1.
    fn face_corner(&mut self, line: Line, word: &str) -> Result<usize> {
        let mut parts = word.split('/');
        let vertex = parts.next().unwrap_or_default();
        let texture = parts.next().unwrap_or_default();
        let normal = parts.next().unwrap_or_default();
        if parts.next().is_some() {
            return Err(line.error(
                format!("{} has more than three parts", quoted(word)),
                "write the corner of a face as v, v/vt, v//vn or v/vt/vn",
            ));
        }
        let vertex = index(line, "vertex", vertex, self.vertices)?;
        self.highest_vertex.raise(line, vertex);
        if texture.is_empty() {
            self.first_untextured.get_or_insert(line.number);
        } else {
            let texture = index(line, "texture coordinate", texture, self.textures)?;
            self.highest_texture.raise(line, texture);
            self.textured_corners += 1;
        }
        if !normal.is_empty() && normal.parse::<isize>().is_err() {
            return Err(not_an_index(line, "normal", normal));
        }
        Ok(vertex)
    }

    fn tag(&mut self, line: Line, words: &[&str]) -> Result<()> {
        if let Some(note) = self.tags.read(line, words)? {
            let key = format!("t {}", words.first().copied().unwrap_or_default());
            self.warn_once(line, &key, note);
        }
        Ok(())
    }

    /// What can be checked only when the whole file is known.
    fn finish(&mut self, file: &str) -> Result<()> {
        if self.face_sizes.is_empty() {
            return Err(Error::input(
                Place::File(file.to_string()),
                "there is no face",
                "give at least one `f` line with three or more vertices",
            ));
        }
        self.highest_vertex.check(file, "vertex", self.vertices)?;
        self.highest_texture
            .check(file, "texture coordinate", self.textures)?;
        self.textured = self.textured_corners > 0 && self.first_untextured.is_none();
        if let (Some(number), 1..) = (self.first_untextured, self.textured_corners) {
            let line = Line { file, number };
            tracing::warn!(
                "{line}: this face lacks texture coordinates that others have: all are ignored"
            );
        }
        Ok(())
    }

    fn keep(&mut self, keyword: &str, words: &[&str]) {
        self.geometry.push_str(keyword);
        for word in words {
            self.geometry.push(' ');
            self.geometry.push_str(word);
        }
        self.geometry.push('\n');
    }

    fn warn_once(&mut self, line: Line, key: &str, note: &str) {
        if self.warned.insert(key.to_string()) {
            tracing::warn!("{line}: {}: {note}", quoted(key));
        }
    }
}

impl Highest {
    fn raise(&mut self, line: Line, number: usize) {
        if number > self.number {
            *self = Highest {
                number,
                line: line.number,
            };
        }
    }

    fn check(&self, file: &str, what: &str, count: usize) -> Result<()> {
        if self.number <= count {
            return Ok(());
        }
        let line = Line {
            file,
            number: self.line,
        };
        Err(line.error(
            format!(
                "the face names {what} {}, but the file has {count}",
                self.number
            ),
            format!("{what} numbers of faces go from 1 to the number of them in the file"),
        ))
    }
}

/// Calls `visit` for each statement: comments gone, lines that end with a backslash joined with the next.
fn for_each_statement(
    file: &str,
    text: &str,
    mut visit: impl FnMut(Line, &str) -> Result<()>,
) -> Result<()> {
    let mut lines = (1..).zip(text.lines());
    while let Some((number, first)) = lines.next() {
        let line = Line { file, number };
        let mut statement = Cow::Borrowed(without_comment(first));
        while statement.ends_with('\\') {
            let Some((_, next)) = lines.next() else {
                return Err(line.error(
                    "the file ends where a backslash says that the line goes on",
                    "the file may be cut off: write it anew, or remove the backslash",
                ));
            };
            let joined = statement.to_mut();
            joined.pop();
            joined.push(' ');
            joined.push_str(without_comment(next));
        }
        visit(line, &statement)?;
    }
    Ok(())
}

fn without_comment(line: &str) -> &str {
    line.split('#').next().unwrap_or_default().trim_end()
}

/// A finite number.
pub(super) fn number(line: Line, what: &str, word: &str) -> Result<f64> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(line.error(
            format!("the {what} {} is not finite", quoted(word)),
            "replace NaN, infinite and too large values by numbers",
        )),
        Err(_) => Err(line.error(
            format!("the {what} {} is not a number", quoted(word)),
            "write a decimal number such as -1.5 or 2e-3",
        )),
    }
}

/// The number, counted from 1, that `word` names when `count` of them have been given so far.
fn index(line: Line, what: &str, word: &str, count: usize) -> Result<usize> {
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

fn not_an_index(line: Line, what: &str, word: &str) -> Error {
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
