//! Everything that can go wrong, in words that speak of the user's own file.

mod misuse;

use std::borrow::Cow;
use std::fmt;
use std::path::PathBuf;

pub use misuse::Misuse;

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
    /// A face, vertex or edge of the mesh in a file.
    In(String, Box<Place>),
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
            Place::In(file, place) => write!(f, "{file}: {place}"),
        }
    }
}

/// Text with its control characters escaped, among them those that turn the direction of writing. Names of files and devices, and words of files, go
/// through here before they get to a terminal, which obeys such characters.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_control) {
        return Cow::Borrowed(text);
    }
    let escaped = |c: char| {
        let escaped = is_control(c).then(|| c.escape_default().to_string());
        escaped.unwrap_or_else(|| c.into())
    };
    Cow::Owned(text.chars().map(escaped).collect())
}

/// Unicode's control characters (category Cc), the separators of lines and paragraphs, and the explicit directional formatting characters
/// (Unicode Standard Annex 9, section 2).
fn is_control(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{61c}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The same for what is displayed.
fn shown(words: fmt::Arguments<'_>) -> String {
    visible(&words.to_string()).into_owned()
}

/// An error of this crate. Bad input is always one of these, never a panic.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The input says something that has no meaning: where, what, and what to do about it.
    #[error("{}", shown(format_args!("{place}: {problem}; {remedy}")))]
    Input {
        /// Where it stands in the input.
        place: Place,
        /// What is wrong, and what was expected.
        problem: String,
        /// What the user can do.
        remedy: String,
    },
    /// A file could not be read or written.
    #[error("{}: {source}", visible(&path.to_string_lossy()))]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file was there to be written, and then could not be: the disk is full, or the reader has gone.
    #[error("{}: {source}", visible(&path.to_string_lossy()))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// An option has a value outside its range or vocabulary.
    #[error("{}", shown(format_args!("{option}: {problem}; {remedy}")))]
    Option {
        /// The option as the user knows it.
        option: &'static str,
        /// What is wrong with its value.
        problem: String,
        /// What would be right.
        remedy: String,
    },
    /// No Vulkan device can do the work; the text says what each one lacks.
    #[error("no suitable Vulkan device: {}", visible(.0))]
    NoDevice(String),
    /// No window can be opened; the text says why.
    #[error("no window can be opened: {}", visible(.0))]
    NoDisplay(String),
    /// The host or the device has no memory left for a Vulkan call.
    #[error(
        "{call} failed: {result}; free memory, or ask for less: a lower level, a smaller picture or mesh"
    )]
    OutOfMemory {
        /// The call's name.
        call: &'static str,
        /// The result code's name.
        result: String,
    },
    /// The driver gave the device up. Nothing that was made of it can be used any more, but all of it must still be destroyed.
    #[error(
        "{call} failed: {result}; try again, and if it stays so choose another device or update its driver"
    )]
    DeviceLost {
        /// The call that told.
        call: &'static str,
        /// The result code's name.
        result: String,
    },
    /// The window system took back what a window shows pictures in. Surface and swapchain can be made again, see `host::Swapchain::renew`.
    #[error("{call} failed: {result}; open the window again")]
    SurfaceLost {
        /// The call that told.
        call: &'static str,
        /// The result code's name.
        result: String,
    },
    /// Another failure of a Vulkan call.
    #[error("{call} failed: {result}; choose another device, or update its driver")]
    Vulkan {
        /// The call's name.
        call: &'static str,
        /// The result code's name.
        result: String,
    },
    /// Something that was drawn did not arrive: what comes of it would be wrong.
    #[error("the device lost {what}; choose another device, or update its driver")]
    Lost {
        /// What is missing, and of how much.
        what: String,
    },
    /// The library was asked for what cannot be drawn.
    #[error(transparent)]
    Misuse(Misuse),
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

    /// The same of a mesh that came from a file: what is wrong with a face, vertex or edge, or with all of it, names the file. Other errors, and places
    /// that name a file, stay as they are.
    pub fn in_file(self, file: &str) -> Error {
        let Error::Input {
            place,
            problem,
            remedy,
        } = self
        else {
            return self;
        };
        let place = match place {
            Place::Mesh => Place::File(file.to_string()),
            Place::Face(_) | Place::Vertex(_) | Place::Edge(..) => {
                Place::In(file.to_string(), Box::new(place))
            }
            named => named,
        };
        Error::Input {
            place,
            problem,
            remedy,
        }
    }

    /// Whether the device was lost, or the surface of a window: everything that was made of it is of no use any more.
    pub fn is_of_device(&self) -> bool {
        matches!(self, Error::DeviceLost { .. } | Error::SurfaceLost { .. })
    }

    /// The exit code of the command line: 1 failed, 2 bad input or usage, 3 no suitable device, or no display.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Input { .. } | Error::File { .. } | Error::Option { .. } => 2,
            Error::Misuse(_) => 2,
            Error::NoDevice(_) | Error::NoDisplay(_) | Error::SurfaceLost { .. } => 3,
            Error::OutOfMemory { .. }
            | Error::DeviceLost { .. }
            | Error::Vulkan { .. }
            | Error::Lost { .. }
            | Error::Refused(_)
            | Error::Write { .. } => 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_move_the_cursor() {
        let name = "a\u{1b}[2J\n\r\u{7f}\u{9b}\u{202e}b";
        let plain = |words: String| {
            assert!(!words.chars().any(is_control), "{words:?}");
            assert!(words.contains("a\\u{1b}[2J\\n\\r"), "{words}");
        };
        let source = || std::io::Error::other("no");
        let path = || PathBuf::from(name);
        plain(visible(name).into_owned());
        plain(Error::input(Place::Line(name.into(), 1), "is odd", "change it").to_string());
        plain(Error::input(Place::Mesh, format!("'{name}' is odd"), "change it").to_string());
        plain(
            Error::File {
                path: path(),
                source: source(),
            }
            .to_string(),
        );
        plain(
            Error::Write {
                path: path(),
                source: source(),
            }
            .to_string(),
        );
        plain(Error::NoDevice(name.into()).to_string());
        assert_eq!(visible("Größe – 大"), "Größe – 大");
    }

    #[test]
    fn errors_of_meshes_name_their_file_once() {
        let of = |place| {
            let error = Error::input(place, "it is odd", "mend it");
            error.in_file("a.obj").in_file("b.obj").to_string()
        };
        assert_eq!(of(Place::Mesh), "a.obj: it is odd; mend it");
        assert_eq!(of(Place::Face(3)), "a.obj: face 3: it is odd; mend it");
        assert_eq!(of(Place::Edge(1, 2)), "a.obj: edge 1-2: it is odd; mend it");
        assert_eq!(
            of(Place::Line("c.obj".into(), 4)),
            "c.obj:4: it is odd; mend it"
        );
        let other = Error::Refused("no".into()).in_file("a.obj");
        assert_eq!(other.to_string(), "no");
    }
}
