//! The scan: checks every statement while its line is known and keeps those that `tobj` is to read.

use std::collections::BTreeSet;

use super::lines::{
    Line, READ, SKIPPED, Statement, for_each_statement, index, not_an_index, number, quoted, value,
};
use super::tags::Tags;
use crate::error::{Error, Place, Result};

/// So many kinds of warnings are given for a file. What is no OBJ file at all has a kind on every line.
const GREATEST_WARNINGS: usize = 20;

/// What a file holds, line by line.
#[derive(Default)]
pub(super) struct Scan {
    /// The checked `v`, `vt` and `f` statements, one a line, without comments.
    pub geometry: String,
    pub vertices: usize,
    pub vertex_lines: Vec<usize>,
    pub textures: usize,
    pub texture_lines: Vec<usize>,
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
    /// Scans a file's bytes; `file` is what messages call it.
    pub fn new(file: &str, bytes: &[u8]) -> Result<Scan> {
        let mut scan = Scan::default();
        for_each_statement(file, bytes, |statement| scan.statement(&statement))?;
        scan.finish(file, bytes)?;
        Ok(scan)
    }

    /// The line that a message about `place` should name.
    pub fn line_of(&self, place: &Place) -> Option<usize> {
        match *place {
            Place::Face(face) if face < self.face_lines.len() => Some(self.face_lines[face]),
            _ => self.tags.line_of(place),
        }
    }

    fn statement(&mut self, statement: &Statement) -> Result<()> {
        let line = statement.line;
        let text = String::from_utf8_lossy(&statement.text);
        let mut words = text.split_whitespace();
        let keyword = words.next().unwrap_or_default();
        self.check(statement, keyword)?;
        let words: Vec<&str> = words.collect();
        match keyword {
            "v" => self.vertex(line, &words),
            "vt" => self.texture(line, &words),
            "f" => self.face(line, &words),
            "t" => self.tag(line, &words),
            "" => Ok(()),
            _ if SKIPPED.contains(&keyword) => Ok(()),
            _ => {
                self.warn_once(line, keyword, "this statement is unknown and ignored");
                Ok(())
            }
        }
    }

    /// Refuses a statement that makes the surface and is cut off or no text. Of any other a warning will do.
    fn check(&mut self, statement: &Statement, keyword: &str) -> Result<()> {
        let Statement { line, ref text, .. } = *statement;
        let is_read = READ.contains(&keyword);
        if let (true, Err(error)) = (is_read, std::str::from_utf8(text)) {
            return Err(line.error(
                format!("byte {:#04x} is not UTF-8 text", text[error.valid_up_to()]),
                "write the numbers of OBJ statements as UTF-8 or ASCII",
            ));
        }
        if let Some(number) = statement.swallowed {
            let note =
                "its backslash makes line {} a part of it, which looks like a statement of its own";
            self.warn_once(line, keyword, &note.replace("{}", &number.to_string()));
        }
        if statement.cut_off && is_read {
            return Err(line.error(
                "the file ends where a backslash says that the line goes on",
                "the file may be cut off: write it anew, or remove the backslash",
            ));
        }
        if statement.cut_off {
            self.warn_once(line, keyword, "the file ends behind its backslash");
        }
        Ok(())
    }

    fn vertex(&mut self, line: Line, words: &[&str]) -> Result<()> {
        let [x, y, z, rest @ ..] = words else {
            return Err(line.error(
                format!("the vertex has {} coordinates", words.len()),
                "write three: v x y z",
            ));
        };
        for word in [x, y, z] {
            number(line, "coordinate", word)?;
        }
        // Colours may be anything that exporters write for numbers.
        for word in rest {
            value(line, "coordinate", word)?;
        }
        // A fourth value alone is a weight, three more are a colour. `tobj` would divide by the weight.
        if let [weight] = rest
            && value(line, "weight", weight)? != Some(1.0)
        {
            self.warn_once(line, "v", "the fourth value, a weight, is ignored");
        }
        self.vertices += 1;
        self.vertex_lines.push(line.number);
        self.keep("v", &[x, y, z]);
        Ok(())
    }

    /// `vt u`, `vt u v` or `vt u v w`; what is missing is 0, and so is what some exporter could not compute.
    fn texture(&mut self, line: Line, words: &[&str]) -> Result<()> {
        if words.is_empty() {
            return Err(line.error(
                "the texture coordinate has no value",
                "write one, two or three: vt u v w",
            ));
        }
        let mut finite = true;
        for (i, word) in words.iter().enumerate() {
            finite &= value(line, "texture coordinate", word)?.is_some() || i > 1;
        }
        if !finite {
            let note = "a texture coordinate is not finite: (0, 0) instead";
            self.warn_once(line, "vt", note);
        }
        let read = |i: usize| words.get(i).copied().filter(|_| finite).unwrap_or("0");
        self.textures += 1;
        self.texture_lines.push(line.number);
        self.keep("vt", &[read(0), read(1)]);
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
        let mut corners = Vec::with_capacity(words.len());
        for word in words {
            let (vertex, texture) = self.face_corner(line, word)?;
            vertices.push(vertex);
            corners.push(match texture {
                Some(texture) => format!("{vertex}/{texture}"),
                None => vertex.to_string(),
            });
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
        self.keep("f", &corners);
        Ok(())
    }

    /// Checks `v`, `v/vt`, `v//vn` or `v/vt/vn` and hands out the numbers of vertex and texture coordinate, counted from 1.
    fn face_corner(&mut self, line: Line, word: &str) -> Result<(usize, Option<usize>)> {
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
        let texture = match texture {
            "" => {
                self.first_untextured.get_or_insert(line.number);
                None
            }
            texture => {
                let texture = index(line, "texture coordinate", texture, self.textures)?;
                self.highest_texture.raise(line, texture);
                self.textured_corners += 1;
                Some(texture)
            }
        };
        if !normal.is_empty() && normal.parse::<isize>().is_err() {
            return Err(not_an_index(line, "normal", normal));
        }
        Ok((vertex, texture))
    }

    fn tag(&mut self, line: Line, words: &[&str]) -> Result<()> {
        if let Some(note) = self.tags.read(line, words)? {
            let key = format!("t {}", words.first().copied().unwrap_or_default());
            self.warn_once(line, &key, note);
        }
        Ok(())
    }

    /// What can be checked only when the whole file is known.
    fn finish(&mut self, file: &str, bytes: &[u8]) -> Result<()> {
        if self.face_sizes.is_empty() {
            let (problem, remedy) = match bytes.contains(&0) {
                true => (
                    "there is no face, but there are bytes of 0x00: this is no text, or UTF-16",
                    "name an OBJ file, in UTF-8",
                ),
                false => (
                    "there is no face",
                    "give at least one `f` line with three or more vertices",
                ),
            };
            return Err(Error::input(Place::File(file.to_string()), problem, remedy));
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

    fn keep(&mut self, keyword: &str, words: &[impl AsRef<str>]) {
        self.geometry.push_str(keyword);
        for word in words {
            self.geometry.push(' ');
            self.geometry.push_str(word.as_ref());
        }
        self.geometry.push('\n');
    }

    fn warn_once(&mut self, line: Line, key: &str, note: &str) {
        let known = self.warned.len();
        if known > GREATEST_WARNINGS || !self.warned.insert(format!("{key}: {note}")) {
            return;
        }
        if known == GREATEST_WARNINGS {
            tracing::warn!(
                "{line}: {}: there is more like this: no further warnings",
                quoted(key)
            );
            return;
        }
        tracing::warn!("{line}: {}: {note}", quoted(key));
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
