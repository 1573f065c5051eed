//! The `t` lines: subdivision tags.

use super::lines::{Line, number, quoted};
use crate::error::{Place, Result};
use crate::mesh::{
    BoundaryInterpolation, Corner, Crease, CreaseMethod, SchemeOptions, TriangleSubdivision,
};

/// The tags of a file, each with the number of its line.
#[derive(Default)]
pub(super) struct Tags {
    pub creases: Vec<(usize, Crease)>,
    pub corners: Vec<(usize, Corner)>,
    pub holes: Vec<(usize, u32)>,
    pub options: SchemeOptions,
}

/// The arguments of one tag: `t NAME ints/floats/strings ints.. floats.. strings..`.
struct Arguments<'a> {
    line: Line<'a>,
    name: &'a str,
    ints: &'a [&'a str],
    floats: &'a [&'a str],
    strings: &'a [&'a str],
}

impl Tags {
    /// Takes in one tag. `words` follow the `t`. Hands out a note where the tag has no effect.
    pub fn read(&mut self, line: Line, words: &[&str]) -> Result<Option<&'static str>> {
        let arguments = Arguments::split(line, words)?;
        match arguments.name {
            "crease" => self.crease(&arguments)?,
            "corner" => self.corner(&arguments)?,
            "hole" => self.hole(&arguments)?,
            "interpolateboundary" => {
                self.options.boundary = match arguments.choice(2)? {
                    0 => BoundaryInterpolation::None,
                    1 => BoundaryInterpolation::EdgeAndCorner,
                    _ => BoundaryInterpolation::EdgeOnly,
                }
            }
            "facevaryinginterpolateboundary" => {
                arguments.choice(5)?;
                return Ok(Some(
                    "texture coordinates are interpolated linearly: this tag is ignored",
                ));
            }
            "creasemethod" => {
                self.options.creasing = match arguments.word(["normal", "chaikin"])? {
                    0 => CreaseMethod::Uniform,
                    _ => CreaseMethod::Chaikin,
                }
            }
            "smoothtriangles" => {
                self.options.triangles = match arguments.word(["catmark", "smooth"])? {
                    0 => TriangleSubdivision::CatmullClark,
                    _ => TriangleSubdivision::Smooth,
                }
            }
            "vertexedit" | "edgeedit" | "faceedit" => {
                return Ok(Some("hierarchical edits are ignored"));
            }
            _ => return Ok(Some("this tag is unknown and ignored")),
        }
        Ok(None)
    }

    /// The line of the tag that names `place`.
    pub fn line_of(&self, place: &Place) -> Option<usize> {
        match *place {
            Place::Edge(a, b) => self
                .creases
                .iter()
                .find(|(_, crease)| crease.vertices.map(|v| v as usize) == [a, b])
                .map(|tag| tag.0),
            Place::Vertex(vertex) => self
                .corners
                .iter()
                .find(|(_, corner)| corner.vertex as usize == vertex)
                .map(|tag| tag.0),
            Place::Face(face) => self
                .holes
                .iter()
                .find(|(_, hole)| *hole as usize == face)
                .map(|tag| tag.0),
            _ => None,
        }
    }

    fn crease(&mut self, arguments: &Arguments) -> Result<()> {
        let vertices = arguments.indices("an even number of vertices, two an edge")?;
        let (edges, rest) = vertices.as_chunks::<2>();
        if !rest.is_empty() {
            return Err(arguments.unfit("an even number of vertices, two an edge"));
        }
        for (&vertices, sharpness) in edges.iter().zip(arguments.sharpnesses(edges.len())?) {
            let crease = Crease {
                vertices,
                sharpness,
            };
            self.creases.push((arguments.line.number, crease));
        }
        Ok(())
    }

    fn corner(&mut self, arguments: &Arguments) -> Result<()> {
        let vertices = arguments.indices("one or more vertices")?;
        for (&vertex, sharpness) in vertices.iter().zip(arguments.sharpnesses(vertices.len())?) {
            let corner = Corner { vertex, sharpness };
            self.corners.push((arguments.line.number, corner));
        }
        Ok(())
    }

    fn hole(&mut self, arguments: &Arguments) -> Result<()> {
        let line = arguments.line.number;
        let faces = arguments.indices("one or more faces")?;
        if !arguments.floats.is_empty() || !arguments.strings.is_empty() {
            return Err(arguments.unfit("faces and nothing else"));
        }
        self.holes
            .extend(faces.into_iter().map(|face| (line, face)));
        Ok(())
    }
}

impl<'a> Arguments<'a> {
    fn split(line: Line<'a>, words: &'a [&'a str]) -> Result<Self> {
        const FORM: &str = "write t NAME ints/floats/strings, then as many values of each kind";
        let [name, counts, values @ ..] = words else {
            return Err(line.error("the tag is cut off", FORM));
        };
        let parsed: Vec<usize> = counts
            .split('/')
            .map_while(|count| count.parse().ok())
            .collect();
        let (&[ints, floats, strings], 3) = (parsed.as_slice(), counts.split('/').count()) else {
            let problem = format!("{} is not ints/floats/strings", quoted(counts));
            return Err(line.error(problem, FORM));
        };
        let total = ints.saturating_add(floats).saturating_add(strings);
        if total != values.len() {
            return Err(line.error(
                format!(
                    "the {} tag announces {total} values, but {} follow",
                    quoted(name),
                    values.len()
                ),
                FORM,
            ));
        }
        let (ints, rest) = values.split_at(ints);
        let (floats, strings) = rest.split_at(floats);
        Ok(Arguments {
            line,
            name,
            ints,
            floats,
            strings,
        })
    }

    fn unfit(&self, expected: &str) -> crate::Error {
        self.line.error(
            format!(
                "the {} tag has {} ints, {} floats and {} strings",
                self.name,
                self.ints.len(),
                self.floats.len(),
                self.strings.len()
            ),
            format!("it takes {expected}"),
        )
    }

    /// The ints as indices, at least one.
    fn indices(&self, expected: &str) -> Result<Vec<u32>> {
        if self.ints.is_empty() {
            return Err(self.unfit(expected));
        }
        let read = |word: &&str| {
            word.parse::<u32>().map_err(|_| {
                self.line.error(
                    format!("the index {} is not a whole number", quoted(word)),
                    "indices of tags count from 0",
                )
            })
        };
        self.ints.iter().map(read).collect()
    }

    /// `count` sharpnesses, from one for all or one each.
    fn sharpnesses(&self, count: usize) -> Result<Vec<f32>> {
        let given = self.floats.len();
        if (given != 1 && given != count) || !self.strings.is_empty() {
            return Err(self.unfit("one sharpness for all, or one for each"));
        }
        let mut values = Vec::with_capacity(count);
        for word in self.floats {
            let value = number(self.line, "sharpness", word)?;
            if value < 0.0 {
                return Err(self.line.error(
                    format!("the sharpness {} is negative", quoted(word)),
                    "sharpness goes from 0 (smooth) to 10 (infinite)",
                ));
            }
            values.push((value as f32).min(f32::MAX));
        }
        values.resize(count, values[0]);
        Ok(values)
    }

    /// The only int, from 0 to `greatest`.
    fn choice(&self, greatest: u32) -> Result<u32> {
        let ([word], [], []) = (self.ints, self.floats, self.strings) else {
            return Err(self.unfit("one int"));
        };
        match word.parse() {
            Ok(choice) if choice <= greatest => Ok(choice),
            _ => Err(self.line.error(
                format!("the {} tag has the value {}", self.name, quoted(word)),
                format!("it takes a whole number from 0 to {greatest}"),
            )),
        }
    }

    /// Which of two words the only string is.
    fn word(&self, [first, second]: [&str; 2]) -> Result<usize> {
        match (self.ints, self.floats, self.strings) {
            ([], [], [word]) if *word == first => Ok(0),
            ([], [], [word]) if *word == second => Ok(1),
            ([], [], [word]) => Err(self.line.error(
                format!("the {} tag has the value {}", self.name, quoted(word)),
                format!("it takes {first} or {second}"),
            )),
            _ => Err(self.unfit(&format!("one string, {first} or {second}"))),
        }
    }
}
