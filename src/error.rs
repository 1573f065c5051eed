//! Everything that can go wrong, in words that speak of the user's own file.

use std::fmt;
use std::path::PathBuf;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Where in the user's input something is wrong.
///
/// Numbers are those of the user's file: lines count from 1, faces and vertices from 0 in file order.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// A line of a file: its name and the line's number, from 1.
    Line(String, usize),
    /// A whole file.
    File(String),
    /// A face, by its number from 0.
    Face(usize),
    /// A vertex, by its number from 0.
    Vertex(usize),
    /// An edge, by the numbers of its two vertices from 0.
    Edge(usize, usize),
    /// The mesh as a whole.
    Mesh,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(file, line) => write!(f, "{file}:{line}"),
            Place::File(file) => write!(f, "{file}"),
            Place::Face(face) => write!(f, "face {face}"),
            Place::Vertex(vertex) => write!(f, "vertex {vertex}"),
            Place::Edge(a, b) => write!(f, "edge {a}-{b}"),
            Place::Mesh => write!(f, "mesh"),
        }
    }
}

/// An error of this crate. Bad input is always one of these, never a panic.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The input says something that has no meaning: where, what, and what to do about it.
    #[error("{place}: {problem}; {remedy}")]
    Input {
        /// Where it stands in the input.
        place: Place,
        /// What is wrong, and what was expected.
        problem: String,
        /// What the user can do.
        remedy: String,
    },
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file was there to be written, and then could not be: the disk is full, or the reader has gone.
    #[error("{}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// An option has a value outside its range or vocabulary.
    #[error("{option}: {problem}; {remedy}")]
    Option {
        /// The option as the user knows it.
        option: &'static str,
        /// What is wrong with its value.
        problem: String,
        /// What would be right.
        remedy: String,
    },
    /// No Vulkan device can do the work; the text says what each one lacks.
    #[error("no suitable Vulkan device: {0}")]
    NoDevice(String),
    /// A Vulkan call failed.
    #[error("{call} failed: {result}")]
    Vulkan {
        /// The call's name.
        call: &'static str,
        /// The result code's name.
        result: String,
    },
    /// A result was refused because it would be wrong (validation messages, lost patches).
    #[error("{0}")]
    Refused(String),
}

impl Error {
    /// An [`Error::Input`] from its three parts.
    pub fn input(place: Place, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
        Error::Input {
            place,
            problem: problem.into(),
            remedy: remedy.into(),
        }
    }

    /// The exit code of the command line: 1 failed, 2 bad input or usage, 3 no suitable device.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Input { .. } | Error::File { .. } | Error::Option { .. } => 2,
            Error::NoDevice(_) => 3,
            Error::Vulkan { .. } | Error::Refused(_) | Error::Write { .. } => 1,
        }
    }
}
