//! The scan: what a file holds, checked statement by statement while its line is known.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use super::lines::{
    Cursor, Line, READ, SKIPPED, Statement, index, not_an_index, number, quoted, value,
};
use super::tags::Tags;
use crate::error::{Error, Place, Result};

/// So many kinds of warnings are given for a file. What is no OBJ file at all has a kind on every line.
const GREATEST_WARNINGS: usize = 20;

/// What a file holds.
#[derive(Default)]
pub(super) struct Scan {
    pub positions: Vec<DVec3>,
    pub textures: Vec<DVec2>,
    pub face_sizes: Vec<u32>,
    /// The vertex of each corner of each face, counted from 0.
    pub face_vertices: Vec<u32>,
    /// The texture coordinate of each corner, as long as every corner has had one.
    pub face_textures: Vec<u32>,
    /// Whether every corner of every face has a texture coordinate.
    pub textured: bool,
    pub tags: Tags,
    highest_vertex: Highest,
    highest_texture: Highest,
    textured_corners: usize,
    first_untextured: Option<usize>,
    warned: BTreeSet<String>,
}

/// The corner of a face: the numbers of its vertex and texture coordinate, counted from 0.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub vertex: u32,
    pub texture: Option<u32>,
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
        let mut cursor = Cursor::new(file, bytes);
        while !cursor.rest.is_empty() {
            if let Some(length) = scan.plain(cursor.rest, cursor.number) {
                cursor.skip(length);
            } else if let Some(statement) = cursor.statement() {
                scan.statement(&statement)?;
            }
        }
        scan.finish(file, bytes)?;
        Ok(scan)
    }

    /// Takes in a face, none of whose corners names a vertex twice.
    pub(super) fn take_face(&mut self, line: usize, corners: &[Corner]) {
        for corner in corners {
            self.face_vertices.push(corner.vertex);
            self.highest_vertex.raise(line, corner.vertex as usize + 1);
            match corner.texture {
                None => {
                    self.first_untextured.get_or_insert(line);
                }
                Some(texture) => {
                    self.highest_texture.raise(line, texture as usize + 1);
                    self.textured_corners += 1;
                    if self.first_untextured.is_none() {
                        self.face_textures.push(texture);
                    }
                }
            }
        }
        self.face_sizes.push(corners.len() as u32);
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
        let mut position = DVec3::ZERO;
        for (axis, word) in [x, y, z].into_iter().enumerate() {
            position[axis] = number(line, "coordinate", word)?;
        }
        // Colours may be anything that exporters write for numbers.
        for word in rest {
            value(line, "coordinate", word)?;
        }
        // A fourth value alone is a weight, three more are a colour.
        if let [weight] = rest
            && value(line, "weight", weight)? != Some(1.0)
        {
            self.warn_once(line, "v", "the fourth value, a weight, is ignored");
        }
        self.positions.push(position);
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
        let mut given = [0.0; 2];
        for (i, word) in words.iter().enumerate() {
            let value = value(line, "texture coordinate", word)?;
            finite &= value.is_some() || i > 1;
            if let (Some(value), Some(place)) = (value, given.get_mut(i)) {
                *place = value;
            }
        }
        if !finite {
            given = [0.0; 2];
            let note = "a texture coordinate is not finite: (0, 0) instead";
            self.warn_once(line, "vt", note);
        }
        self.textures.push(given.into());
        Ok(())
    }

    fn face(&mut self, line: Line, words: &[&str]) -> Result<()> {
        if words.len() < 3 {
            return Err(line.error(
                format!("the face has {} vertices", words.len()),
                "faces need three or more vertices",
            ));
        }
        let corners = words.iter().map(|word| self.face_corner(line, word));
        let corners = corners.collect::<Result<Vec<Corner>>>()?;
        let mut vertices: Vec<u32> = corners.iter().map(|corner| corner.vertex).collect();
        vertices.sort_unstable();
        if let Some(pair) = vertices.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(line.error(
                format!("the face names vertex {} twice", u64::from(pair[0]) + 1),
                "remove the repeated vertex, or split the face",
            ));
        }
        if u32::try_from(words.len()).is_err() {
            return Err(line.error("the face has too many vertices", "split the face"));
        }
        self.take_face(line.number, &corners);
        Ok(())
    }

    /// Checks `v`, `v/vt`, `v//vn` or `v/vt/vn` and hands out the numbers of vertex and texture coordinate.
    fn face_corner(&mut self, line: Line, word: &str) -> Result<Corner> {
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
        // No file has so many as do not fit, which is said once it is known how many there are.
        let from_zero = |number: usize| u32::try_from(number - 1).unwrap_or(u32::MAX);
        let vertex = index(line, "vertex", vertex, self.positions.len())?;
        self.highest_vertex.raise(line.number, vertex);
        let texture = match texture {
            "" => None,
            texture => {
                let texture = index(line, "texture coordinate", texture, self.textures.len())?;
                self.highest_texture.raise(line.number, texture);
                Some(from_zero(texture))
            }
        };
        let vertex = from_zero(vertex);
        if !normal.is_empty() && normal.parse::<isize>().is_err() {
            return Err(not_an_index(line, "normal", normal));
        }
        Ok(Corner { vertex, texture })
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
        self.highest_vertex
            .check(file, "vertex", self.positions.len())?;
        self.highest_texture
            .check(file, "texture coordinate", self.textures.len())?;
        self.textured = self.textured_corners > 0 && self.first_untextured.is_none();
        if let (Some(number), 1..) = (self.first_untextured, self.textured_corners) {
            let line = Line { file, number };
            tracing::warn!(
                "{line}: this face lacks texture coordinates that others have: all are ignored"
            );
        }
        Ok(())
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
    fn raise(&mut self, line: usize, number: usize) {
        if number > self.number {
            *self = Highest { number, line };
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
