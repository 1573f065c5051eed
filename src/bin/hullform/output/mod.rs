//! Files that are there completely or not at all.

pub mod csv;
pub mod junit;
pub mod obj;
mod pending;
pub mod picture;
pub mod ply;
pub mod png;
mod target;
mod temporary;

pub use pending::{Contents, Pending, create, write};
pub use temporary::remove_unfinished;

use hullform::error::visible;
use hullform::{Error, Result};
use std::fs;
use std::io::{self, Write};
use std::path::Path;
use temporary::Temporary;

/// Where a picture went, in words: by its whole path, since scripts are called from anywhere.
pub fn wrote(path: &Path) -> String {
    let whole = std::path::absolute(path);
    let whole = whole.as_deref().unwrap_or(path);
    format!("wrote {}", visible(&whole.to_string_lossy()))
}

/// Puts a file with these bytes into the place of what is there, in a folder that is made: whoever looks sees all of the one or all of the other.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    fs::create_dir_all(folder)?;
    let temporary = Temporary::new(folder)?;
    let mut file = temporary.file();
    file.write_all(bytes)?;
    file.sync_all()?;
    temporary.place(path, &mut temporary::still())
}

/// A file format, known by the extension of the file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A picture.
    Png,
    /// Points, one a line.
    Csv,
    /// Triangles as text.
    Obj,
    /// Triangles as bytes.
    Ply,
    /// A drawing.
    Svg,
    /// Facts.
    Json,
}

/// A tessellated surface.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Its points; patches do not share theirs.
    pub points: Vec<Point>,
    /// Its triangles, by the points' numbers from 0.
    pub triangles: Vec<[u32; 3]>,
}

/// A point of a tessellated surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Point {
    /// The ptex face.
    pub face: u32,
    /// Where in the face.
    pub uv: [f32; 2],
    /// Where in space, in the model's own coordinates.
    pub position: [f64; 3],
    /// The surface's unit normal.
    pub normal: [f32; 3],
    /// Texture coordinates; the face's own u and v where the model has none.
    pub texture: [f32; 2],
}

impl Format {
    const ALL: [Format; 6] = [
        Format::Png,
        Format::Csv,
        Format::Obj,
        Format::Ply,
        Format::Svg,
        Format::Json,
    ];

    /// The format that `path`'s extension means, if it is one of `allowed`.
    pub fn of(path: &Path, allowed: &[Format]) -> Result<Format> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        let named = |format: &&Format| format.extension().eq_ignore_ascii_case(&extension);
        let found = Format::ALL.iter().find(named);
        let found = found.copied().filter(|format| allowed.contains(format));
        found.ok_or_else(|| {
            let allowed: Vec<_> = allowed.iter().map(|format| format.extension()).collect();
            Error::Option {
                option: "--output",
                problem: format!("{} has no extension that is known here", path.display()),
                remedy: format!("choose a name that ends in .{}", allowed.join(", .")),
            }
        })
    }

    fn extension(self) -> &'static str {
        match self {
            Format::Png => "png",
            Format::Csv => "csv",
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::Svg => "svg",
            Format::Json => "json",
        }
    }
}

/// What is in a folder, for tests.
#[cfg(test)]
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        let entry = entry.expect("an entry");
        entry.file_name().to_string_lossy().into_owned()
    };
    let mut names: Vec<String> = entries.map(name).collect();
    names.sort();
    names
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// One triangle, with numbers whose text is not obvious.
    pub(crate) fn triangle() -> Surface {
        let point = |face, uv, position| Point {
            face,
            uv,
            position,
            normal: [0.0, 0.0, 1.0],
            texture: uv,
        };
        Surface {
            points: vec![
                point(7, [0.0, 0.0], [0.0, -0.1, 1e-9]),
                point(7, [1.0, 0.0], [1.0, 0.0, 16_777_216.0]),
                point(7, [1.0 / 3.0, 1.0], [0.0, 1.5, 0.0]),
            ],
            triangles: vec![[0, 1, 2]],
        }
    }

    #[test]
    fn extensions_are_known_in_any_case() {
        let of = |name: &str| Format::of(Path::new(name), &[Format::Csv, Format::Obj]);
        assert_eq!(of("a.csv").ok(), Some(Format::Csv));
        assert_eq!(of("a.b.OBJ").ok(), Some(Format::Obj));
        for wrong in ["a.png", "a.txt", "csv", "", ".csv"] {
            let error = of(wrong).expect_err(wrong);
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().ends_with("ends in .csv, .obj"));
        }
    }
}
